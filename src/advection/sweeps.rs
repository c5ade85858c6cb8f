//! Advection by alternating sweeps (Algorithm 5.1 of the paper), one per direction and step.
//!
//! Within a step every cell of the band has a *tracked volume* `V* = V - sum of fluxes so far`, and holds the volume
//! `f V*` of a material. A sweep reconstructs the interface from the fractions `f` on the cell's own geometry. For a face
//! with the outward flux volume `phi` the swept region of volume `phi V / V*` is cut by the donor's plane, and what is found there,
//! times `V* / V`, crosses the face. At the last sweep `V*` is back at `V`.
//!
//! Along mesh lines the two swept regions of a cell are disjoint slabs of it, so fractions stay in `[0, 1]` and volume is conserved to
//! rounding. Along Cartesian axes on a distorted mesh the regions of a cell may overlap or reach beyond it; what that costs is
//! corrected as in Sect. 5.2.3 and entered in the [`Ledger`].

use vofkit_geometry::Cell;

use super::band::{Across, Band};
use super::boundary::Boundary;
use super::ledger::{LargestCorrection, Ledger, MaterialLedger};
use super::motion::{Motion, NodalMotion, Outward};
use crate::interface::{self, Counts, Placed, Reconstruction, ReconstructionError, is_mixed};
use crate::mesh::Mesh;
use crate::parallel;
use crate::tolerance::{FRACTION_ROUNDING, OUTFLOW_EXCESS};
use crate::velocity::{FaceFluxes, Velocity};

/// The directions of the sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SweepAxes {
    /// One Cartesian component of the displacement per sweep, over all faces: the paper's.
    #[default]
    Cartesian,
    /// Along mesh lines, over two opposite faces of every cell.
    Logical,
}

/// A step that cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// A cell gives away more than it holds.
    #[error(
        "the time step is too large: cell {cell:?} holds the volume {volume:.6e} and would lose {outflow:.6e} in one sweep"
    )]
    Overdrawn {
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// Its tracked volume.
        volume: f64,
        /// What leaves it in the sweep.
        outflow: f64,
    },
    /// A plane that was not found.
    #[error(transparent)]
    Reconstruction(#[from] ReconstructionError),
}

/// One cell of the band, as it stands through the sweeps of a step.
#[derive(Clone, Debug)]
struct Member<const D: usize> {
    cell: usize,
    offset: [usize; D],
    across: [Across; 6],
    outward: Outward<D>,
}

/// What a cell did when it gave volume away in a sweep.
#[derive(Clone, Debug, Default)]
struct Giving {
    counts: Counts,
    crossed: usize,
    cut: usize,
    error: Option<StepError>,
}

/// One material in one cell of the band.
#[derive(Clone, Copy, Debug, Default)]
struct Content {
    /// Its fraction at the start of the step.
    initial: f64,
    /// What came in since, as a volume.
    change: f64,
    fraction: f64,
    ledger: MaterialLedger,
    correction: f64,
}

/// Moves the fractions of materials through a mesh that stands still.
#[derive(Debug)]
pub struct Transport<'a, C, const D: usize> {
    mesh: &'a Mesh<C, D>,
    velocity: Velocity,
    fluxes: FaceFluxes<D>,
    boundary: Boundary<D>,
    reconstruction: Reconstruction,
    /// For Cartesian sweeps on distorted meshes; on undistorted ones they are the same as those along mesh lines.
    nodes: Option<NodalMotion<D>>,
    overdraft: bool,
    band: Band,
    state: State<D>,
}

/// The band during a step, kept to reuse its memory. Everything is by place in the band.
#[derive(Clone, Debug)]
struct State<const D: usize> {
    members: Vec<Member<D>>,
    /// The change of the tracked volume since the start of the step.
    volume_change: Vec<f64>,
    givings: Vec<Giving>,
    /// What was given away in the sweep, by face and material.
    given: Vec<f64>,
    /// By material.
    contents: Vec<Content>,
}

impl<const D: usize> Default for State<D> {
    fn default() -> Self {
        Self {
            members: Vec::new(),
            volume_change: Vec::new(),
            givings: Vec::new(),
            given: Vec::new(),
            contents: Vec::new(),
        }
    }
}

impl<'a, C: Cell<D>, const D: usize> Transport<'a, C, D> {
    /// Prepares the transport through `mesh` by `velocity`, whose face fluxes are given.
    pub fn new(
        mesh: &'a Mesh<C, D>,
        velocity: Velocity,
        fluxes: FaceFluxes<D>,
        boundary: Boundary<D>,
        reconstruction: Reconstruction,
        axes: SweepAxes,
    ) -> Self {
        let cartesian = axes == SweepAxes::Cartesian && !mesh.is_undistorted();
        Self {
            mesh,
            velocity,
            fluxes,
            boundary,
            reconstruction,
            nodes: cartesian.then(|| NodalMotion::new(mesh, &velocity.field)),
            overdraft: false,
            band: Band::new(mesh.grid().len()),
            state: State::default(),
        }
    }

    /// Goes on where a cell would give away more than it holds, instead of returning [`StepError::Overdrawn`]; what cannot be given
    /// shows up in the ledger.
    pub fn allow_overdraft(&mut self) {
        self.overdraft = true;
    }

    /// The Courant number of a step per unit of time: the largest face flux over the volume of its donor, at full amplitude.
    pub fn courant_rate(&self) -> f64 {
        let unit = self.fluxes.step(1.0);
        let rates = parallel::map(self.mesh.grid().len(), |index| {
            let offset = self.mesh.grid().offset(index);
            let outward = |face: usize| {
                let flux = unit.through(offset, face / 2, face % 2);
                if face % 2 == 1 { flux } else { -flux }
            };
            (0..C::FACES).map(outward).fold(0.0, f64::max) / self.mesh.volumes()[index]
        });
        rates.into_iter().fold(0.0, f64::max)
    }

    /// The largest sum of the fluxes out of a cell in a step of this duration, relative to its volume, without sign.
    pub fn largest_divergence(&self, duration: f64) -> f64 {
        let fluxes = self.fluxes.step(duration);
        let sums = parallel::map(self.mesh.grid().len(), |index| {
            let offset = self.mesh.grid().offset(index);
            let net: f64 =
                (0..D).map(|axis| fluxes.through(offset, axis, 1) - fluxes.through(offset, axis, 0)).sum();
            net.abs() / self.mesh.volumes()[index]
        });
        sums.into_iter().fold(0.0, f64::max)
    }

    /// What happens at the ends of the axes.
    pub fn boundary(&self) -> &Boundary<D> {
        &self.boundary
    }

    /// Advances `fractions[material][cell]` from `start` to `end`. The order of the sweeps alternates with `step`.
    ///
    /// # Errors
    /// A time step that is too large, or a plane that was not found; the fractions are then those of the last finished sweep.
    pub fn step(
        &mut self,
        fractions: &mut [Vec<f64>],
        step: usize,
        start: f64,
        end: f64,
    ) -> Result<Ledger, StepError> {
        let mut ledger = Ledger::new(fractions.len());
        let duration = self.velocity.duration(start, end);
        if duration == 0.0 || fractions.is_empty() {
            return Ok(ledger);
        }
        // Along mesh lines a cell's content moves by one cell per axis; with Cartesian sweeps, each over all faces, by D.
        let radius = if self.nodes.is_some() { D } else { 1 };
        self.band.collect(self.mesh, fractions, &self.boundary, radius);
        let motion = Motion {
            mesh: self.mesh,
            boundary: &self.boundary,
            fluxes: self.fluxes.step(duration),
            order: sweep_order(step),
            nodes: self.nodes.as_ref(),
        };
        let mut state = std::mem::take(&mut self.state);
        state.begin(&motion, &self.band, fractions);
        let done = motion
            .order
            .iter()
            .try_for_each(|&axis| self.sweep(&motion, axis, &mut state, fractions, &mut ledger));
        self.state = state;
        done.map(|()| ledger)
    }

    fn sweep(
        &self,
        motion: &Motion<'_, C, D>,
        axis: usize,
        state: &mut State<D>,
        fractions: &mut [Vec<f64>],
        ledger: &mut Ledger,
    ) -> Result<(), StepError> {
        let State { members, volume_change, givings, given, contents } = state;
        parallel::for_each_with_chunk(givings, given, |slot, giving, given| {
            *giving = Giving::default();
            given.fill(0.0);
            let member = &members[slot];
            if let Err(error) = self.give(motion, axis, member, volume_change[slot], fractions, giving, given)
            {
                giving.error = Some(error);
            }
        });
        for giving in givings {
            if let Some(error) = giving.error.take() {
                return Err(error);
            }
            ledger.counts.add(&giving.counts);
            ledger.faces_crossed += giving.crossed;
            ledger.faces_cut += giving.cut;
        }
        parallel::for_each_with_chunk(volume_change, contents, |slot, change, contents| {
            self.exchange(motion, axis, members, slot, given, change, contents);
            let volume = self.mesh.volumes()[members[slot].cell];
            correct(volume, volume + *change, contents);
        });
        ledger.sweeps += 1;
        ledger.cells_visited += members.len();
        settle(members, contents, fractions, ledger);
        Ok(())
    }

    /// What leaves one cell in a sweep, by face and material.
    #[expect(clippy::too_many_arguments, reason = "what a sweep reads and what it makes, kept apart")]
    fn give(
        &self,
        motion: &Motion<'_, C, D>,
        axis: usize,
        member: &Member<D>,
        volume_change: f64,
        fractions: &[Vec<f64>],
        giving: &mut Giving,
        given: &mut [f64],
    ) -> Result<(), StepError> {
        let Member { cell: index, offset, outward, .. } = *member;
        let volume = self.mesh.volumes()[index];
        let tracked = volume + volume_change;
        let outward = &outward[axis];
        let outflow: f64 = outward.iter().map(|flux| flux.max(0.0)).sum();
        if outflow == 0.0 {
            return Ok(());
        }
        if outflow > tracked + OUTFLOW_EXCESS * volume && !self.overdraft {
            return Err(StepError::Overdrawn { cell: offset.to_vec(), volume: tracked, outflow });
        }
        giving.crossed = outward.iter().filter(|&&flux| flux > 0.0).count();
        let mut cell = None;
        for (material, f) in fractions.iter().enumerate() {
            let fraction = f[index];
            let mut placed = Placed::NoNormal;
            if is_mixed(fraction) {
                let cell = cell.get_or_insert_with(|| self.mesh.local_cell(index));
                placed = interface::place(self.mesh, f, index, cell, self.reconstruction)?;
                giving.counts.count(&placed);
            }
            for face in motion.faces(axis).filter(|&face| outward[face] > 0.0) {
                let flux = outward[face];
                given[face * fractions.len() + material] = match (&placed, &cell) {
                    (Placed::Plane { half_space, .. }, Some(cell)) => {
                        giving.cut += 1;
                        let wanted = (flux * (volume / tracked)).min(volume);
                        let region = motion.region(axis, cell, offset, face, wanted);
                        let inside = region.truncate(half_space).volume.clamp(0.0, wanted);
                        (inside * (tracked / volume)).min(flux)
                    }
                    _ => fraction * flux,
                };
            }
        }
        Ok(())
    }

    /// What one cell loses and gains in a sweep.
    #[expect(clippy::too_many_arguments, reason = "what a sweep reads and what it makes, kept apart")]
    fn exchange(
        &self,
        motion: &Motion<'_, C, D>,
        axis: usize,
        members: &[Member<D>],
        slot: usize,
        given: &[f64],
        volume_change: &mut f64,
        contents: &mut [Content],
    ) {
        let materials = contents.len();
        let given = |slot: usize, face: usize, k: usize| given[(slot * C::FACES + face) * materials + k];
        for content in contents.iter_mut() {
            content.ledger = MaterialLedger::default();
            content.correction = 0.0;
        }
        for face in motion.faces(axis) {
            let flux = members[slot].outward[axis][face];
            *volume_change -= flux;
            let across = members[slot].across[face];
            for (k, content) in contents.iter_mut().enumerate() {
                if flux > 0.0 {
                    let part = given(slot, face, k);
                    content.change -= part;
                    if across == Across::End {
                        content.ledger.outflow += part - self.inflow(k) * flux;
                    }
                } else {
                    content.change += match across {
                        Across::Member(donor) => given(donor as usize, face ^ 1, k),
                        Across::Outside => content.initial * -flux,
                        Across::End => self.inflow(k) * -flux,
                    };
                }
            }
        }
    }

    /// The fraction of a material in what flows in through open ends.
    fn inflow(&self, material: usize) -> f64 {
        if self.boundary.inflow == Some(material) { 1.0 } else { 0.0 }
    }
}

impl<const D: usize> State<D> {
    fn begin<C: Cell<D>>(&mut self, motion: &Motion<'_, C, D>, band: &Band, fractions: &[Vec<f64>]) {
        let cells = band.cells();
        let grid = motion.mesh.grid();
        self.members = parallel::map(cells.len(), |slot| {
            let cell = cells[slot] as usize;
            let offset = grid.offset(cell);
            let mut across = [Across::End; 6];
            for (face, across) in across[..C::FACES].iter_mut().enumerate() {
                *across = band.across(grid, cell, face);
            }
            Member { cell, offset, across, outward: motion.outward(offset) }
        });
        self.volume_change.clear();
        self.volume_change.resize(cells.len(), 0.0);
        self.givings.resize_with(cells.len(), Giving::default);
        self.given.resize(cells.len() * C::FACES * fractions.len(), 0.0);
        self.contents.clear();
        self.contents.extend(cells.iter().flat_map(|&cell| {
            fractions.iter().map(move |f| {
                let initial = f[cell as usize];
                Content { initial, fraction: initial, ..Content::default() }
            })
        }));
    }
}

/// Writes the new fractions and adds up the accounts, in the order of the band.
fn settle<const D: usize>(
    members: &[Member<D>],
    contents: &[Content],
    fractions: &mut [Vec<f64>],
    ledger: &mut Ledger,
) {
    for (&Member { cell, .. }, contents) in members.iter().zip(contents.chunks(fractions.len())) {
        for (k, content) in contents.iter().enumerate() {
            fractions[k][cell] = content.fraction;
            ledger.materials[k].add(&content.ledger);
            if content.correction > ledger.largest_correction.fraction {
                ledger.largest_correction = LargestCorrection { fraction: content.correction, cell };
            }
        }
    }
}

/// The new fractions in a cell that had the volume `start` and has `volume`, with the corrections of Sect. 5.2.3: into
/// `[0, 1]`, and their sum to at most 1.
fn correct(start: f64, volume: f64, contents: &mut [Content]) {
    let mut sum = 0.0;
    for content in contents.iter_mut() {
        let raw = (content.initial * start + content.change) / volume;
        content.ledger.smallest = raw;
        content.ledger.largest = raw;
        content.fraction = if raw <= FRACTION_ROUNDING {
            0.0
        } else if raw >= 1.0 - FRACTION_ROUNDING {
            1.0
        } else {
            raw
        };
        content.correction = (content.fraction - raw).abs();
        content.ledger.clipped = content.correction * volume;
        sum += content.fraction;
    }
    let scale = if sum > 1.0 + FRACTION_ROUNDING { 1.0 / sum } else { 1.0 };
    for content in contents {
        if scale < 1.0 {
            let scaled = content.fraction * scale;
            content.ledger.rescaled = (content.fraction - scaled) * volume;
            content.correction += content.fraction - scaled;
            content.fraction = scaled;
        }
        if content.correction > 0.0 {
            content.change = content.fraction * volume - content.initial * start;
        }
    }
}

/// The axes in the order of a step's sweeps: all orders in turn, each followed by its reverse.
fn sweep_order<const D: usize>(step: usize) -> [usize; D] {
    let shift = step / 2 % D;
    std::array::from_fn(|i| {
        let i = if step.is_multiple_of(2) { i } else { D - 1 - i };
        if D == 2 { i } else { (i + shift) % D }
    })
}
