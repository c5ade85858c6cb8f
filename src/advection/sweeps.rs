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

use super::band::Band;
use super::boundary::{Boundary, End};
use super::ledger::{LargestCorrection, Ledger, MaterialLedger};
use super::motion::{Cartesian, NodalMotion, Sweep};
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

/// What leaves one cell in a sweep.
#[derive(Clone, Debug, Default)]
struct Outflow {
    /// Volume through each face; zero where it enters.
    volume: [f64; 6],
    counts: Counts,
    crossed: usize,
    cut: usize,
    error: Option<StepError>,
}

/// One material in one cell of the band.
#[derive(Clone, Copy, Debug, Default)]
struct Content {
    /// Its volume at the start of the step.
    start: f64,
    /// What came in since.
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
    /// By place in the band: the change of the tracked volume since the start of the step.
    volume_change: Vec<f64>,
    outflows: Vec<Outflow>,
    /// By place in the band, face and material.
    material_outflow: Vec<f64>,
    /// By place in the band and material.
    contents: Vec<Content>,
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
            volume_change: Vec::new(),
            outflows: Vec::new(),
            material_outflow: Vec::new(),
            contents: Vec::new(),
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
        self.begin(fractions);
        let order = sweep_order::<D>(step);
        for (sweep, &axis) in order.iter().enumerate() {
            let taken = (sweep + 1 == D).then_some(&order[..sweep]);
            self.sweep(fractions, duration, axis, taken, &mut ledger)?;
        }
        Ok(ledger)
    }

    fn begin(&mut self, fractions: &[Vec<f64>]) {
        let (cells, materials) = (self.band.cells().len(), fractions.len());
        self.volume_change.clear();
        self.volume_change.resize(cells, 0.0);
        self.outflows.resize_with(cells, Outflow::default);
        self.material_outflow.resize(cells * materials * C::FACES, 0.0);
        self.contents.clear();
        for &cell in self.band.cells() {
            let volume = self.mesh.volumes()[cell as usize];
            self.contents.extend(fractions.iter().map(|f| {
                let fraction = f[cell as usize];
                Content { start: fraction * volume, fraction, ..Content::default() }
            }));
        }
    }

    fn sweep(
        &mut self,
        fractions: &mut [Vec<f64>],
        duration: f64,
        axis: usize,
        taken: Option<&[usize]>,
        ledger: &mut Ledger,
    ) -> Result<(), StepError> {
        let sweep = Sweep {
            mesh: self.mesh,
            fluxes: self.fluxes.step(duration),
            axis,
            cartesian: self.nodes.as_ref().map(|nodes| Cartesian { nodes, taken }),
        };
        let mut outflows = std::mem::take(&mut self.outflows);
        let mut material_outflow = std::mem::take(&mut self.material_outflow);
        parallel::for_each_with_chunk(&mut outflows, &mut material_outflow, |slot, outflow, materials| {
            *outflow = Outflow::default();
            materials.fill(0.0);
            if let Err(error) = self.give(&sweep, fractions, slot, outflow, materials) {
                outflow.error = Some(error);
            }
        });
        self.outflows = outflows;
        self.material_outflow = material_outflow;
        for outflow in &mut self.outflows {
            if let Some(error) = outflow.error.take() {
                return Err(error);
            }
            ledger.counts.add(&outflow.counts);
            ledger.faces_crossed += outflow.crossed;
            ledger.faces_cut += outflow.cut;
        }
        let mut volume_change = std::mem::take(&mut self.volume_change);
        let mut contents = std::mem::take(&mut self.contents);
        parallel::for_each_with_chunk(&mut volume_change, &mut contents, |slot, change, contents| {
            self.take(&sweep, fractions, slot, change, contents);
        });
        self.volume_change = volume_change;
        self.contents = contents;
        self.settle(fractions, ledger);
        Ok(())
    }

    /// What leaves one cell in a sweep: volume by face, material by face and material.
    fn give(
        &self,
        sweep: &Sweep<'_, C, D>,
        fractions: &[Vec<f64>],
        slot: usize,
        outflow: &mut Outflow,
        materials: &mut [f64],
    ) -> Result<(), StepError> {
        let index = self.band.cells()[slot] as usize;
        let offset = self.mesh.grid().offset(index);
        let volume = self.mesh.volumes()[index];
        let tracked = volume + self.volume_change[slot];
        let mut total = 0.0;
        for face in sweep.faces() {
            let flux = self.outward(sweep, index, offset, face);
            if flux > 0.0 {
                outflow.volume[face] = flux;
                outflow.crossed += 1;
                total += flux;
            }
        }
        if total > tracked + OUTFLOW_EXCESS * volume && !self.overdraft {
            let cell = offset.to_vec();
            return Err(StepError::Overdrawn { cell, volume: tracked, outflow: total });
        }
        if total == 0.0 {
            return Ok(());
        }
        let mut cell = None;
        for (material, f) in fractions.iter().enumerate() {
            let fraction = f[index];
            let mut amount = |face: usize, part: f64| materials[face * fractions.len() + material] = part;
            let mut placed = Placed::NoNormal;
            if is_mixed(fraction) {
                let cell = cell.get_or_insert_with(|| self.mesh.local_cell(index));
                placed = interface::place(self.mesh, f, index, cell, self.reconstruction)?;
                outflow.counts.count(&placed);
            }
            for face in sweep.faces() {
                let flux = outflow.volume[face];
                if flux == 0.0 {
                    continue;
                }
                let (Placed::Plane { half_space, .. }, Some(cell)) = (&placed, &cell) else {
                    amount(face, fraction * flux);
                    continue;
                };
                let wanted = (flux * (volume / tracked)).min(volume);
                let region = sweep.region(cell, offset, face, wanted);
                let inside = region.truncate(half_space).volume.clamp(0.0, wanted);
                outflow.cut += 1;
                amount(face, (inside * (tracked / volume)).min(flux));
            }
        }
        Ok(())
    }

    /// The volume that leaves a cell through a face in a sweep; walls pass nothing.
    fn outward(&self, sweep: &Sweep<'_, C, D>, index: usize, offset: [usize; D], face: usize) -> f64 {
        let (axis, side) = (face / 2, face % 2);
        let at_end = self.mesh.grid().neighbour(index, axis, side).is_none();
        if at_end && self.boundary.ends[axis][side] == End::Wall {
            return 0.0;
        }
        sweep.outward(offset, face)
    }

    /// Collects what one cell lost and gained in a sweep, and corrects its fractions.
    fn take(
        &self,
        sweep: &Sweep<'_, C, D>,
        fractions: &[Vec<f64>],
        slot: usize,
        volume_change: &mut f64,
        contents: &mut [Content],
    ) {
        let index = self.band.cells()[slot] as usize;
        let offset = self.mesh.grid().offset(index);
        let count = contents.len();
        for content in contents.iter_mut() {
            content.ledger = MaterialLedger::default();
            content.correction = 0.0;
        }
        for face in sweep.faces() {
            let neighbour = self.mesh.grid().neighbour(index, face / 2, face % 2);
            let out = self.outflows[slot].volume[face];
            if out > 0.0 {
                *volume_change -= out;
                for (k, content) in contents.iter_mut().enumerate() {
                    let part = self.material_outflow[(slot * C::FACES + face) * count + k];
                    content.change -= part;
                    if neighbour.is_none() {
                        content.ledger.outflow += part - self.inflow(k) * out;
                    }
                }
                continue;
            }
            match neighbour.map(|n| (n, self.band.slot(n))) {
                Some((_, Some(donor))) => {
                    let flux = self.outflows[donor].volume[face ^ 1];
                    *volume_change += flux;
                    for (k, content) in contents.iter_mut().enumerate() {
                        content.change += self.material_outflow[(donor * C::FACES + (face ^ 1)) * count + k];
                    }
                }
                Some((donor, None)) => {
                    let flux = -self.outward(sweep, index, offset, face);
                    *volume_change += flux;
                    for (content, f) in contents.iter_mut().zip(fractions) {
                        content.change += f[donor] * flux;
                    }
                }
                None => {
                    let flux = -self.outward(sweep, index, offset, face);
                    *volume_change += flux;
                    for (k, content) in contents.iter_mut().enumerate() {
                        content.change += self.inflow(k) * flux;
                    }
                }
            }
        }
        correct(self.mesh.volumes()[index] + *volume_change, contents);
    }

    /// The fraction of a material in what flows in through open ends.
    fn inflow(&self, material: usize) -> f64 {
        if self.boundary.inflow == Some(material) { 1.0 } else { 0.0 }
    }

    /// Writes the new fractions and adds up the accounts, in the order of the band.
    fn settle(&self, fractions: &mut [Vec<f64>], ledger: &mut Ledger) {
        ledger.sweeps += 1;
        ledger.cells_visited += self.band.cells().len();
        let count = fractions.len();
        for (&cell, contents) in self.band.cells().iter().zip(self.contents.chunks(count)) {
            for (k, content) in contents.iter().enumerate() {
                fractions[k][cell as usize] = content.fraction;
                ledger.materials[k].add(&content.ledger);
                if content.correction > ledger.largest_correction.fraction {
                    ledger.largest_correction =
                        LargestCorrection { fraction: content.correction, cell: cell as usize };
                }
            }
        }
    }
}

/// The corrections of Sect. 5.2.3: fractions into `[0, 1]`, and their sum to at most 1.
fn correct(volume: f64, contents: &mut [Content]) {
    let mut sum = 0.0;
    for content in contents.iter_mut() {
        let raw = (content.start + content.change) / volume;
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
            content.change = content.fraction * volume - content.start;
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
