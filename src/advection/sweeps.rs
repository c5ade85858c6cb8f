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
//!
//! Several materials are cut each by a plane of its own, and what leaves is then fitted to what the cell holds (`share`), so
//! that neither volume nor the fullness of a cell is lost where their planes do not match.

use vofkit_geometry::Cell;

use super::band::{Across, Band};
use super::ledger::{LargestCorrection, Ledger, MaterialLedger};
use super::motion::{Motion, Outward};
use super::transport::StepError;
use crate::interface::{self, Placed, Reconstruction, is_mixed};
use crate::normal::Material;
use crate::parallel;
use crate::tolerance::{FRACTION_ROUNDING, OUTFLOW_EXCESS};

/// One cell of the band, as it stands through the sweeps of a step.
#[derive(Clone, Debug)]
struct Member<const D: usize> {
    slot: usize,
    cell: usize,
    offset: [usize; D],
    across: [Across; 6],
    outward: Outward<D>,
}

/// What a cell did when it gave volume away in a sweep.
#[derive(Clone, Debug, Default)]
struct Giving {
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

/// The band during a step, kept to reuse its memory. Everything is by place in the band.
#[derive(Clone, Debug)]
pub(super) struct Sweeps<const D: usize> {
    members: Vec<Member<D>>,
    /// The change of the tracked volume since the start of the step.
    volume_change: Vec<f64>,
    /// The planes of the sweep, by material, where one is needed.
    planes: Vec<Option<Placed<D>>>,
    givings: Vec<Giving>,
    /// What was given away in the sweep, by face and material.
    given: Vec<f64>,
    /// By material.
    contents: Vec<Content>,
}

impl<const D: usize> Default for Sweeps<D> {
    fn default() -> Self {
        Self {
            members: Vec::new(),
            volume_change: Vec::new(),
            planes: Vec::new(),
            givings: Vec::new(),
            given: Vec::new(),
            contents: Vec::new(),
        }
    }
}

/// One sweep of a step.
pub(super) struct Sweep<'a, C, const D: usize> {
    pub(super) motion: &'a Motion<'a, C, D>,
    pub(super) axis: usize,
    pub(super) reconstruction: Reconstruction,
    /// Whether cells may give away more than they hold.
    pub(super) overdraft: bool,
}

impl<C: Cell<D>, const D: usize> Sweep<'_, C, D> {
    /// What leaves one cell in a sweep, by face and material.
    fn give(
        &self,
        member: &Member<D>,
        volume_change: f64,
        fractions: &[Vec<f64>],
        planes: &[Option<Placed<D>>],
        giving: &mut Giving,
        given: &mut [f64],
    ) -> Result<(), StepError> {
        let Member { cell: index, offset, outward, .. } = *member;
        let motion = self.motion;
        let volume = motion.mesh.volumes()[index];
        let tracked = volume + volume_change;
        let outward = &outward[self.axis];
        let outflow: f64 = outward.iter().map(|flux| flux.max(0.0)).sum();
        if outflow == 0.0 {
            return Ok(());
        }
        if outflow > tracked + OUTFLOW_EXCESS * volume && !self.overdraft {
            return Err(StepError::Overdrawn { cell: offset.to_vec(), volume: tracked, outflow });
        }
        giving.crossed = outward.iter().filter(|&&flux| flux > 0.0).count();
        let cell = planes.iter().any(Option::is_some).then(|| motion.mesh.local_cell(index));
        for (material, f) in fractions.iter().enumerate() {
            let fraction = f[index];
            for face in motion.faces(self.axis).filter(|&face| outward[face] > 0.0) {
                let flux = outward[face];
                given[face * fractions.len() + material] = match (&planes[material], &cell) {
                    // Only with overdraft there may be nothing left to give from.
                    (Some(Placed::Plane { half_space, .. }), Some(cell)) if tracked > 0.0 => {
                        giving.cut += 1;
                        let wanted = (flux * (volume / tracked)).min(volume);
                        let region = motion.region(self.axis, cell, offset, face, wanted);
                        let inside = region.truncate(half_space).volume.clamp(0.0, wanted);
                        (inside * (tracked / volume)).min(flux)
                    }
                    _ => fraction * flux,
                };
            }
        }
        if fractions.len() > 1 && tracked > 0.0 {
            let held = |material: usize| fractions[material][index] * tracked;
            share(outward, tracked, held, fractions.len(), given);
        }
        Ok(())
    }

    /// What one cell loses and gains in a sweep.
    fn exchange(&self, member: &Member<D>, given: &[f64], volume_change: &mut f64, contents: &mut [Content]) {
        let materials = contents.len();
        let inflow = |k: usize| self.motion.boundary.inflow_fraction(k);
        let given = |slot: usize, face: usize, k: usize| given[(slot * C::FACES + face) * materials + k];
        for content in contents.iter_mut() {
            content.ledger = MaterialLedger::default();
            content.correction = 0.0;
        }
        for face in self.motion.faces(self.axis) {
            let flux = member.outward[self.axis][face];
            *volume_change -= flux;
            let across = member.across[face];
            for (k, content) in contents.iter_mut().enumerate() {
                if flux > 0.0 {
                    let part = given(member.slot, face, k);
                    content.change -= part;
                    if across == Across::End {
                        content.ledger.outflow += part - inflow(k) * flux;
                    }
                } else {
                    content.change += match across {
                        Across::Member(donor) => given(donor as usize, face ^ 1, k),
                        Across::Outside => content.initial * -flux,
                        Across::End => inflow(k) * -flux,
                    };
                }
            }
        }
    }
}

impl<const D: usize> Sweeps<D> {
    /// Starts a step from these fractions.
    pub(super) fn begin<C: Cell<D>>(
        &mut self,
        motion: &Motion<'_, C, D>,
        band: &Band,
        fractions: &[Vec<f64>],
    ) {
        let cells = band.cells();
        let grid = motion.mesh.grid();
        self.members = parallel::map(cells.len(), |slot| {
            let cell = cells[slot] as usize;
            let offset = grid.offset(cell);
            let mut across = [Across::End; 6];
            for (face, across) in across[..C::FACES].iter_mut().enumerate() {
                *across = band.across(grid, cell, face);
            }
            Member { slot, cell, offset, across, outward: motion.outward(offset) }
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

    /// Places the planes that a sweep needs: those of the cells that give, or of all where methods read their neighbours.
    fn reconstruct<C: Cell<D>>(
        &mut self,
        sweep: &Sweep<'_, C, D>,
        fractions: &[Vec<f64>],
        ledger: &mut Ledger,
    ) -> Result<(), StepError> {
        let method = sweep.reconstruction;
        let gives = |member: &Member<D>| member.outward[sweep.axis].iter().any(|&flux| flux > 0.0);
        self.planes.clear();
        self.planes.resize(self.members.len() * fractions.len(), None);
        for (material, f) in fractions.iter().enumerate() {
            let needed = |member: &&Member<D>| {
                is_mixed(f[member.cell]) && (method.normal.reads_neighbours() || gives(member))
            };
            let (slots, cells): (Vec<usize>, Vec<usize>) =
                self.members.iter().filter(needed).map(|member| (member.slot, member.cell)).unzip();
            let material_here = Material { mesh: sweep.motion.mesh, fractions: f, centroids: None };
            for (slot, placed) in slots.into_iter().zip(interface::planes(material_here, &cells, method)?) {
                ledger.counts.count(&placed);
                self.planes[slot * fractions.len() + material] = Some(placed);
            }
        }
        Ok(())
    }

    /// Puts the fractions back to those at the start of the step.
    pub(super) fn restore(&self, fractions: &mut [Vec<f64>]) {
        for (member, contents) in self.members.iter().zip(self.contents.chunks(fractions.len())) {
            for (f, content) in fractions.iter_mut().zip(contents) {
                f[member.cell] = content.initial;
            }
        }
    }

    /// Does one sweep.
    pub(super) fn advance<C: Cell<D>>(
        &mut self,
        sweep: &Sweep<'_, C, D>,
        fractions: &mut [Vec<f64>],
        ledger: &mut Ledger,
    ) -> Result<(), StepError> {
        self.reconstruct(sweep, fractions, ledger)?;
        let Self { members, volume_change, planes, givings, given, contents } = self;
        parallel::for_each_with_chunk(givings, given, |slot, giving, given| {
            *giving = Giving::default();
            given.fill(0.0);
            let planes = &planes[slot * fractions.len()..][..fractions.len()];
            giving.error =
                sweep.give(&members[slot], volume_change[slot], fractions, planes, giving, given).err();
        });
        for giving in givings {
            if let Some(error) = giving.error.take() {
                return Err(error);
            }
            ledger.faces_crossed += giving.crossed;
            ledger.faces_cut += giving.cut;
        }
        parallel::for_each_with_chunk(volume_change, contents, |slot, change, contents| {
            sweep.exchange(&members[slot], given, change, contents);
            correct(sweep.motion.mesh.volumes()[members[slot].cell], *change, contents);
        });
        ledger.sweeps += 1;
        ledger.cells_visited += members.len();
        settle(members, contents, fractions, ledger);
        Ok(())
    }
}

/// Fits the amounts of several materials, each cut by a plane of its own, to what the cell holds: `given[face][material]`
/// then adds up to no more than the flux of a face, and the void that leaves is no more than there is. What a material
/// may not give now stays in the cell, so that no volume is lost.
fn share(outward: &[f64; 6], tracked: f64, held: impl Fn(usize) -> f64, materials: usize, given: &mut [f64]) {
    let mut void = [0.0; 6];
    for (face, amounts) in given.chunks_mut(materials).enumerate() {
        let flux = outward[face].max(0.0);
        let sum: f64 = amounts.iter().sum();
        if sum > flux {
            amounts.iter_mut().for_each(|amount| *amount *= flux / sum);
        } else {
            void[face] = flux - sum;
        }
    }
    let left = |given: &[f64], k: usize| {
        (held(k) - given.chunks(materials).map(|face| face[k]).sum::<f64>()).max(0.0)
    };
    let [void_out, held_in_all, left_in_all] = [
        void.iter().sum::<f64>(),
        (0..materials).map(&held).sum(),
        (0..materials).map(|k| left(given, k)).sum(),
    ];
    let excess = (void_out - (tracked - held_in_all).max(0.0)).min(left_in_all);
    if !(excess > FRACTION_ROUNDING * tracked) {
        return;
    }
    // What leaves in place of void is taken from what is left of the materials, face by face.
    for k in 0..materials {
        let part = excess / void_out * (left(given, k) / left_in_all);
        for (face, amounts) in given.chunks_mut(materials).enumerate() {
            amounts[k] += part * void[face];
        }
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

/// The new fractions in a cell of volume `start` that took in `volume_change`, with the corrections of Sect. 5.2.3: into
/// `[0, 1]`, and their sum to at most 1.
///
/// A cell that exchanged nothing but what it is full of keeps its fractions to the bit.
fn correct(start: f64, volume_change: f64, contents: &mut [Content]) {
    let volume = start + volume_change;
    if volume <= 0.0 {
        // Overdrawn: there are no fractions until volume comes in.
        return;
    }
    let mut sum = 0.0;
    for content in contents.iter_mut() {
        let raw = content.initial + (content.change - content.initial * volume_change) / volume;
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
            content.change = (content.fraction - content.initial) * volume + content.initial * volume_change;
        }
    }
}
