//! Unsplit advection: the content of every cell of the band after the step is the content of its [pre-image](super::preimage) before
//! it.
//!
//! That is the balance of the swept regions of all faces at once, each cut by every cell that it meets and by the planes in that
//! cell: the lateral faces of neighbouring swept regions are the same and cancel, and what remains is the pre-image. Computed
//! as one piece, a content is between nothing and the whole, to rounding, wherever pre-images do not fold over, and fractions
//! need no correction. Pre-images fill the mesh, folded or not, so the volume of a material changes by rounding alone.
//!
//! What crosses the ends of the mesh is counted by the swept regions of the faces there. That goes for walls, too: no volume crosses
//! them in all, but where nodes leave a wall what goes out on one side comes in on the other.
//!
//! The account is as good as the volumes of the pre-images, which are known beforehand: a step in which one has lost its digits,
//! because nodes come from too far away, is refused.
//!
//! Where materials rest while the mesh moves, the pre-image of a cell is the cell at its new place.

use vofkit_geometry::clip::{Full, Region, bounds};
use vofkit_geometry::{Cell, Vector};

use super::band::Band;
use super::boundary::{Boundary, End};
use super::carry::{Along, Cargo, Carry, carried};
use super::content::{Finding, Held, Load, Scratch, Source};
use super::ledger::Ledger;
use super::nested::Nested;
use super::preimage::{TracedFace, Traces, corner_node, preimage};
use super::settle::settle;
use super::transport::StepError;
use crate::interface::{Reconstruction, RegionOf};
use crate::mesh::Mesh;
use crate::mesh::locate::Locator;
use crate::parallel;
use crate::quantity::State;
use crate::stopwatch::Stopwatch;
use crate::tolerance::{FRACTION_EXCESS, LARGEST_RADIUS, PREIMAGE_ROUNDING};

/// What stays from step to step.
#[derive(Clone, Debug)]
pub(super) struct Unsplit<const D: usize> {
    locator: Locator<D>,
    nested: Nested<D>,
    traces: Traces<D>,
    findings: Vec<Finding<D>>,
    /// By place in the band: the volumes of the materials, then what of them left through open ends, then space for a face.
    volumes: Vec<f64>,
    carry: Carry<D>,
}

/// The volume that crosses face `2 axis + side` of the cell at an offset towards higher indices, by offset, axis and side.
pub(crate) type Through<'a, const D: usize> = &'a (dyn Fn([usize; D], usize, usize) -> f64 + Sync);

/// One step.
pub(super) struct Step<'a, C, const D: usize> {
    pub(super) mesh: &'a Mesh<C, D>,
    /// The volumes of the cells after it.
    pub(super) volumes: &'a [f64],
    pub(super) boundary: &'a Boundary<D>,
    /// How far what is at a node has come: it came from the node's place minus this.
    pub(super) displacement: &'a (dyn Fn(usize) -> Vector<D> + Sync),
    /// What crosses the faces; none where it is what they sweep.
    pub(super) through: Option<Through<'a, D>>,
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

    /// The volume that leaves a cell through a face; none where it is what the face sweeps.
    fn outward(&self, offset: [usize; D], face: usize) -> Option<f64> {
        let through = self.through?;
        if self.end(offset, face) == Some(End::Wall) {
            return Some(0.0);
        }
        let flux = through(offset, face / 2, face % 2);
        Some(if face % 2 == 1 { flux } else { -flux })
    }

    /// Finds what a cell holds after the step, and what of it crosses open ends.
    fn find(
        &self,
        cell: usize,
        traces: &Traces<D>,
        source: &Source<'_, C, D>,
        scratch: &mut Scratch<RegionOf<C, D>, D>,
        finding: &mut Finding<D>,
        volumes: &mut [f64],
    ) -> Result<(), Full> {
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
        let volume = self.volumes[cell];
        let found = region.volume();
        if !is_kept(found, volume, &nodes[0][..C::OFFSETS.len()]) {
            finding.wrong_volume = Some(found);
            return Ok(());
        }
        let held = source.contents(&region, &origin, volume, scratch, contents, &mut finding.arriving)?;
        for (face, traced) in faces[..C::FACES].iter().enumerate() {
            if self.end(offset, face).is_some() {
                let swept = traced.swept::<C>();
                let flux = self.outward(offset, face).unwrap_or_else(|| swept.volume());
                source.contents(&swept, &origin, flux, scratch, crossing, &mut finding.leaving)?;
                // Relative to what flows in: ends at which nothing else crosses need not be looked at.
                for (k, (sum, part)) in outflow.iter_mut().zip(&*crossing).enumerate() {
                    *sum += part - self.boundary.inflow_fraction(k) * flux;
                }
            }
        }
        let centre = nodes[1][..C::OFFSETS.len()].iter().sum::<Vector<D>>() / C::OFFSETS.len() as f64;
        finding.held = Ok(held);
        finding.is_folded = held == Held::Several && !region.is_seen_from(&centre);
        Ok(())
    }
}

/// Whether the volume of a pre-image is that of its cell, but for the rounding that a cell with these nodes has.
fn is_kept<const D: usize>(found: f64, wanted: f64, nodes: &[Vector<D>]) -> bool {
    let [low, high] = bounds(nodes);
    (found - wanted).abs() <= PREIMAGE_ROUNDING * (high - low).product().max(wanted)
}

/// Volumes of each material that a step keeps for each cell.
const KEPT: usize = 3;

impl<const D: usize> Unsplit<D> {
    pub(super) fn new<C: Cell<D>>(mesh: &Mesh<C, D>) -> Self {
        Self {
            locator: Locator::new(mesh),
            nested: Nested::new(mesh.grid().len()),
            traces: Traces::new(mesh.grid().node_count()),
            findings: Vec::new(),
            volumes: Vec::new(),
            carry: Carry::new(),
        }
    }

    /// Does one step. Fractions and quantities change only if it can be done.
    pub(super) fn advance<C: Cell<D>>(
        &mut self,
        step: &Step<'_, C, D>,
        cargo: &mut Cargo<'_>,
        ledger: &mut Ledger,
        stopwatch: &mut Stopwatch,
    ) -> Result<(), StepError> {
        stopwatch.lap(|seconds| &mut seconds.update);
        let Cargo { fractions, quantities } = cargo;
        let Self { locator, nested, traces, findings, volumes, carry } = self;
        let materials = fractions.len();
        let cells = &step.band.cells()[..];
        let band = || cells.iter().map(|&cell| cell as usize);
        ledger.counts.add(&nested.place(step.mesh, fractions, band(), step.reconstruction, stopwatch)?);
        let tiles = &nested.tiles(step.mesh);
        traces.trace(step.mesh, step.displacement, cells);
        let carried = carried(quantities, materials);
        if !quantities.is_empty() {
            carry.begin(quantities, fractions, step.mesh.volumes(), band());
            carry.find_slopes(step.mesh, fractions, quantities, cells, Along::Space);
        }
        let load = Load { carry, quantities, carried: &carried };
        let load = (!quantities.is_empty()).then_some(load);
        let source = Source {
            mesh: step.mesh,
            locator,
            fractions,
            nested,
            tiles,
            outside: step.boundary.inflow,
            load,
        };
        findings.resize_with(cells.len(), Finding::new);
        volumes.clear();
        volumes.resize(cells.len() * KEPT * materials, 0.0);
        parallel::for_each_with_scratch(
            findings,
            volumes,
            Scratch::new,
            |scratch, slot, finding, volumes| {
                finding.reset();
                if step.find(cells[slot] as usize, traces, &source, scratch, finding, volumes).is_err() {
                    finding.held = Err(Full);
                }
            },
        );
        stopwatch.lap(|seconds| &mut seconds.fluxes);
        let offset = |slot: usize| step.mesh.grid().offset(cells[slot] as usize).to_vec();
        if let Some(slot) = findings.iter().position(|finding| finding.held.is_err()) {
            return Err(StepError::Folded { cell: offset(slot), fraction: f64::NAN });
        }
        let wrong =
            findings.iter().enumerate().find_map(|(slot, finding)| Some((slot, finding.wrong_volume?)));
        if let Some((slot, found)) = wrong {
            let volume = step.volumes[cells[slot] as usize];
            return Err(StepError::Scattered { cell: offset(slot), volume, found });
        }
        if !step.overdraft {
            let kept = volumes.chunks(KEPT * materials);
            for (slot, (volumes, cell)) in kept.zip(band()).enumerate() {
                let within = -FRACTION_EXCESS..=1.0 + FRACTION_EXCESS;
                let fraction = |k: usize| volumes[k] / step.volumes[cell];
                if let Some(k) = (0..materials).find(|&k| !within.contains(&fraction(k))) {
                    return Err(StepError::Folded { cell: offset(slot), fraction: fraction(k) });
                }
            }
        }
        ledger.sweeps += 1;
        ledger.cells_visited += cells.len();
        ledger.preimages_cut += findings.iter().filter(|finding| finding.held == Ok(Held::Several)).count();
        ledger.preimages_folded += findings.iter().filter(|finding| finding.is_folded).count();
        for (cell, volumes) in band().zip(volumes.chunks(KEPT * materials)) {
            settle(cell, step.volumes[cell], &volumes[..materials], fractions, ledger);
            for (account, outflow) in ledger.materials.iter_mut().zip(&volumes[materials..]) {
                account.outflow += outflow;
            }
        }
        if !quantities.is_empty() {
            carry.pass(cells, &findings[..], None, quantities, ledger);
            carry.finish(cells, |slot| step.volumes[cells[slot] as usize], fractions, quantities, ledger);
        }
        Ok(())
    }
}

/// One step on its own: what crosses the faces, and how far what is at the nodes has come, are given.
///
/// # Errors
/// A step that cannot be done; the state is then as before.
pub(crate) fn step_with_fluxes<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    through: Through<'_, D>,
    displacements: &[Vector<D>],
    state: &mut State,
    reconstruction: Reconstruction,
) -> Result<Ledger, StepError> {
    let State { fractions, quantities } = state;
    let mut ledger = Ledger::new(fractions.len());
    if fractions.is_empty() {
        return Ok(ledger);
    }
    let crossing = |offset: [usize; D], axis: usize, side: usize| through(offset, axis, side).abs();
    let boundary = Boundary::where_crossed(mesh, [[None; 2]; D], None, crossing)?;
    let around = [radius(reach(mesh, |node| displacements[node])); D];
    let mut band = Band::new();
    band.collect(mesh.grid(), fractions, &carried(quantities, fractions.len()), &boundary, around);
    let step = Step {
        mesh,
        volumes: mesh.volumes(),
        boundary: &boundary,
        displacement: &|node| displacements[node],
        through: Some(through),
        band: &band,
        reconstruction,
        overdraft: false,
    };
    let cargo = &mut Cargo { fractions, quantities };
    Unsplit::new(mesh).advance(&step, cargo, &mut ledger, &mut Stopwatch::default())?;
    Ok(ledger)
}

/// How many cells away from one that is not settled contents can change where nodes have come at most `reach` cells.
pub(super) fn radius(reach: f64) -> usize {
    let cells = reach.abs().ceil();
    // Not a number where a cell's mean edges fall together: then anywhere.
    if cells <= LARGEST_RADIUS { (cells as usize).max(1) } else { LARGEST_RADIUS as usize }
}

/// The largest component of a vector at the nodes in the logical coordinates of a cell that has the node.
pub(super) fn reach<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    at_node: impl Fn(usize) -> Vector<D> + Sync + Send,
) -> f64 {
    let of_cell = |index: usize| {
        let (cell, offset) = (mesh.local_cell(index), mesh.grid().offset(index));
        let along =
            |axis: usize| cell.physical_gradient(&Vector::from_fn(|k, _| if k == axis { 1.0 } else { 0.0 }));
        let axes: [Vector<D>; D] = std::array::from_fn(along);
        let of_corner = |corner: &[usize; D]| {
            let vector = at_node(corner_node(mesh.grid(), offset, corner));
            axes.iter().map(|axis| axis.dot(&vector).abs()).fold(0.0, f64::max)
        };
        C::OFFSETS.iter().map(of_corner).fold(0.0, f64::max)
    };
    parallel::map(mesh.grid().len(), of_cell).into_iter().fold(0.0, f64::max)
}
