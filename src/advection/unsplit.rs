//! Unsplit advection: the content of every cell of the band after the step is the content of its [pre-image](super::preimage) before
//! it.
//!
//! That is the balance of the swept regions of all faces at once, each cut by every cell that it meets and by the planes in that
//! cell: the lateral faces of neighbouring swept regions are the same and cancel, and what remains is the pre-image. Computed
//! as one piece, a content is between nothing and the whole, to rounding, wherever pre-images do not fold over, and fractions
//! need no correction. Pre-images fill the mesh, folded or not, so the volume of a material changes by rounding alone.
//!
//! What crosses open ends is counted by the swept regions of the faces there.

use vofkit_geometry::clip::{Full, Region};
use vofkit_geometry::{Cell, Vector};

use super::band::Band;
use super::boundary::{Boundary, End};
use super::content::{Held, Scratch, Source};
use super::ledger::Ledger;
use super::nested::Nested;
use super::preimage::{TracedFace, Traces, preimage};
use super::settle::settle;
use super::transport::StepError;
use crate::interface::{Reconstruction, RegionOf};
use crate::mesh::Mesh;
use crate::mesh::locate::Locator;
use crate::parallel;
use crate::space::{planar, spatial};
use crate::tolerance::{FRACTION_EXCESS, LARGEST_RADIUS};
use crate::velocity::{Field, StepFluxes};

/// How the pre-image of one cell of the band was dealt with.
#[derive(Clone, Copy, Debug, Default)]
struct Finding {
    is_cut: bool,
    is_folded: bool,
    is_full: bool,
}

/// What stays from step to step.
#[derive(Clone, Debug)]
pub(super) struct Unsplit<const D: usize> {
    /// Cells per time that the fastest node moves along an axis of a cell, at full amplitude.
    reach: f64,
    locator: Locator<D>,
    nested: Nested<D>,
    traces: Traces<D>,
    findings: Vec<Finding>,
    /// By place in the band: the volumes of the materials, then what of them left through open ends, then space for a face.
    volumes: Vec<f64>,
}

/// One step.
pub(super) struct Step<'a, C, const D: usize> {
    pub(super) mesh: &'a Mesh<C, D>,
    pub(super) boundary: &'a Boundary<D>,
    pub(super) fluxes: StepFluxes<'a, D>,
    pub(super) field: &'a Field,
    pub(super) band: &'a Band<D>,
    pub(super) reconstruction: Reconstruction,
    /// Whether contents may be out of bounds where pre-images fold; they are then corrected.
    pub(super) overdraft: bool,
}

impl<C: Cell<D>, const D: usize> Step<'_, C, D> {
    /// What is at an end of the mesh beyond a face of a cell; none inside.
    fn end(&self, offset: [usize; D], face: usize) -> Option<End> {
        let grid = self.mesh.grid();
        let (axis, side) = (face / 2, face % 2);
        let last = if side == 1 { grid.cells()[axis] - 1 } else { 0 };
        let at_end = offset[axis] == last && !grid.periodic()[axis];
        at_end.then(|| self.boundary.ends[axis][side])
    }

    /// The volume that leaves a cell through a face.
    fn outward(&self, offset: [usize; D], face: usize) -> f64 {
        if self.end(offset, face) == Some(End::Wall) {
            return 0.0;
        }
        let flux = self.fluxes.through(offset, face / 2, face % 2);
        if face % 2 == 1 { flux } else { -flux }
    }

    /// Finds what a cell holds after the step, and what of it crosses open ends.
    fn find(
        &self,
        cell: usize,
        traces: &Traces<D>,
        source: &Source<'_, C, D>,
        scratch: &mut Scratch<RegionOf<C, D>, D>,
        volumes: &mut [f64],
    ) -> Result<Finding, Full> {
        let materials = source.fractions.len();
        let (contents, rest) = volumes.split_at_mut(materials);
        let (outflow, crossing) = rest.split_at_mut(materials);
        let offset = self.mesh.grid().offset(cell);
        let origin = self.mesh.anchor(cell);
        let nodes = traces.nodes(self.mesh, offset);
        let faces: [TracedFace<D>; 6] = std::array::from_fn(|face| match face < C::FACES {
            true => TracedFace::new::<C>(&nodes, face, self.outward(offset, face)),
            false => TracedFace::default(),
        });
        let region = preimage::<C, D>(&nodes, &faces[..C::FACES]);
        let volume = self.mesh.volumes()[cell];
        let held = source.contents(&region, &origin, volume, scratch, contents)?;
        for (face, traced) in faces[..C::FACES].iter().enumerate() {
            if self.end(offset, face) == Some(End::Outflow) {
                let flux = self.outward(offset, face);
                source.contents(&traced.swept::<C>(), &origin, flux, scratch, crossing)?;
                // Relative to what flows in: ends at which nothing else crosses need not be looked at.
                for (k, (sum, part)) in outflow.iter_mut().zip(&*crossing).enumerate() {
                    *sum += part - self.boundary.inflow_fraction(k) * flux;
                }
            }
        }
        let is_cut = held == Held::Several;
        let centre = nodes[1][..C::OFFSETS.len()].iter().sum::<Vector<D>>() / C::OFFSETS.len() as f64;
        Ok(Finding { is_cut, is_folded: is_cut && !region.is_seen_from(&centre), is_full: false })
    }
}

/// Volumes of each material that a step keeps for each cell.
const KEPT: usize = 3;

impl<const D: usize> Unsplit<D> {
    pub(super) fn new<C: Cell<D>>(mesh: &Mesh<C, D>, field: &Field) -> Self {
        Self {
            reach: reach(mesh, field),
            locator: Locator::new(mesh),
            nested: Nested::new(mesh.grid().len()),
            traces: Traces::new(mesh.grid().node_count()),
            findings: Vec::new(),
            volumes: Vec::new(),
        }
    }

    /// How many cells away from one that is not settled contents can change.
    pub(super) fn radius(&self, duration: f64) -> usize {
        let cells = (self.reach * duration.abs()).ceil();
        // Not a number where a cell's mean edges fall together: then anywhere.
        if cells <= LARGEST_RADIUS { (cells as usize).max(1) } else { LARGEST_RADIUS as usize }
    }

    /// Does one step. The fractions change only if it can be done.
    pub(super) fn advance<C: Cell<D>>(
        &mut self,
        step: &Step<'_, C, D>,
        fractions: &mut [Vec<f64>],
        ledger: &mut Ledger,
    ) -> Result<(), StepError> {
        let Self { locator, nested, traces, findings, volumes, .. } = self;
        let cells = &step.band.cells()[..];
        let band = cells.iter().map(|&cell| cell as usize);
        ledger.counts.add(&nested.place(step.mesh, fractions, band, step.reconstruction)?);
        traces.trace(step.mesh, step.field, step.fluxes.duration(), cells);
        let source = Source { mesh: step.mesh, locator, fractions, nested, outside: step.boundary.inflow };
        findings.clear();
        findings.resize(cells.len(), Finding::default());
        volumes.clear();
        volumes.resize(cells.len() * KEPT * fractions.len(), 0.0);
        parallel::for_each_with_scratch(
            findings,
            volumes,
            Scratch::new,
            |scratch, slot, finding, volumes| {
                let found = step.find(cells[slot] as usize, traces, &source, scratch, volumes);
                *finding = found.unwrap_or(Finding { is_full: true, ..Finding::default() });
            },
        );
        let offset = |slot: usize| step.mesh.grid().offset(cells[slot] as usize).to_vec();
        if let Some(slot) = findings.iter().position(|finding| finding.is_full) {
            return Err(StepError::Folded { cell: offset(slot), fraction: f64::NAN });
        }
        if !step.overdraft {
            let kept = volumes.chunks(KEPT * fractions.len());
            for (slot, (volumes, &cell)) in kept.zip(cells).enumerate() {
                let within = -FRACTION_EXCESS..=1.0 + FRACTION_EXCESS;
                let volume = step.mesh.volumes()[cell as usize];
                let fraction = |k: usize| volumes[k] / volume;
                if let Some(k) = (0..fractions.len()).find(|&k| !within.contains(&fraction(k))) {
                    return Err(StepError::Folded { cell: offset(slot), fraction: fraction(k) });
                }
            }
        }
        ledger.sweeps += 1;
        ledger.cells_visited += cells.len();
        ledger.preimages_cut += findings.iter().filter(|finding| finding.is_cut).count();
        ledger.preimages_folded += findings.iter().filter(|finding| finding.is_folded).count();
        let materials = fractions.len();
        for (&cell, volumes) in cells.iter().zip(volumes.chunks(KEPT * materials)) {
            let cell = cell as usize;
            settle(cell, step.mesh.volumes()[cell], &volumes[..materials], fractions, ledger);
            for (account, outflow) in ledger.materials.iter_mut().zip(&volumes[materials..]) {
                account.outflow += outflow;
            }
        }
        Ok(())
    }
}

/// The largest component of the velocity in the logical coordinates of a cell, at a node of it.
fn reach<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, field: &Field) -> f64 {
    let of_cell = |index: usize| {
        let cell = mesh.local_cell(index);
        let along =
            |axis: usize| cell.physical_gradient(&Vector::from_fn(|k, _| if k == axis { 1.0 } else { 0.0 }));
        let axes: [Vector<D>; D] = std::array::from_fn(along);
        let at_node = |x: &Vector<D>| {
            let velocity = planar::<D>(&field.velocity(&spatial(&(x + mesh.anchor(index)))));
            axes.iter().map(|axis| axis.dot(&velocity).abs()).fold(0.0, f64::max)
        };
        cell.nodes().iter().map(at_node).fold(0.0, f64::max)
    };
    parallel::map(mesh.grid().len(), of_cell).into_iter().fold(0.0, f64::max)
}
