//! Volumes that cross faces, from integrals of the potential along edges.
//!
//! By Stokes' theorem the flux through a face, plane or ruled, is the circulation of the vector potential around its edges; in
//! 2D the difference of the stream function between its two nodes. Each edge has one number that all its faces share, so
//! the fluxes of a closed cell cancel. They cancel *exactly*, not to rounding, because for a step these numbers are rounded to multiples
//! of one power of two: sums of them are then exact, and a cell's volume returns to the bit after the sweeps of a step. Only in cells at
//! the joined ends of a periodic axis, whose common face is counted once, a rounding remains.

use vofkit_geometry::{Cell, Vector};

use super::Field;
use super::sampled::SampledFluxes;
use crate::mesh::{Grid, Mesh};
use crate::parallel;
use crate::quanta::Quanta;
use crate::space::spatial;
use crate::tolerance::RANGE;

/// Points and weights on `[0, 1]` for the integral of the potential along an edge.
const EDGE_POINTS: usize = 5;

/// Integrals of a field's potential along all edges of a mesh: its face fluxes at full amplitude, per time.
#[derive(Clone, Debug)]
pub struct FaceFluxes<const D: usize> {
    grid: Grid<D>,
    /// For each direction of edges (2D: z alone, at the nodes), the integral along the edge that starts at each node place.
    edges: Vec<EdgeIntegrals<D>>,
    largest: f64,
}

/// The integrals along all edges of one direction.
#[derive(Clone, Debug)]
struct EdgeIntegrals<const D: usize> {
    axis: usize,
    /// Distance in `values` from one edge to the next along each axis.
    strides: [usize; D],
    values: Vec<f64>,
}

/// A velocity whose fluxes cannot be counted in double precision.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the velocity's potential adds up to {largest:e} along an edge of the mesh, outside the range of double precision"
)]
pub struct FluxRange {
    /// The largest integral along an edge, without sign; NaN if any is.
    pub largest: f64,
}

/// The volumes that cross the faces in one step.
#[derive(Clone, Copy, Debug)]
pub struct StepFluxes<'a, const D: usize>(Source<'a, D>);

#[derive(Clone, Copy, Debug)]
enum Source<'a, const D: usize> {
    Edges(EdgeFluxes<'a, D>),
    Sampled(SampledFluxes<'a, D>),
}

/// Those of a field with a potential.
#[derive(Clone, Copy, Debug)]
struct EdgeFluxes<'a, const D: usize> {
    source: &'a FaceFluxes<D>,
    duration: f64,
    quanta: Quanta,
}

/// Directions of the edges that carry the potential: in 2D z alone, whose edges are the nodes.
fn edge_axes<const D: usize>() -> std::ops::Range<usize> {
    if D == 2 { 2..3 } else { 0..3 }
}

impl<const D: usize> FaceFluxes<D> {
    /// Integrates the field's potential along every edge of the mesh, with five Gauss points.
    ///
    /// # Errors
    /// Integrals that are not finite, or so large or small that their sums and differences would not be.
    pub fn new<C: Cell<D>>(mesh: &Mesh<C, D>, field: &Field) -> Result<Self, FluxRange> {
        let grid = mesh.grid().clone();
        let cells = grid.cells();
        let rule = gauss_quad::legendre::GaussLegendre::new(
            EDGE_POINTS.try_into().expect("the number of points is not zero"),
        );
        let points: Vec<(f64, f64)> = rule.iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect();
        // Uniform fields have the same fluxes wherever the origin is; their potentials are small near it.
        let origin = if let Field::Uniform { .. } = field { mesh.bounds()[0] } else { Vector::zeros() };
        let embedded = |x: &Vector<D>| spatial(&(x - origin));
        let edges: Vec<EdgeIntegrals<D>> = edge_axes::<D>()
            .map(|axis| {
                // There is one edge fewer than nodes along its own direction.
                let extent: [usize; D] = std::array::from_fn(|k| cells[k] + usize::from(k != axis));
                let strides = std::array::from_fn(|k| extent[..k].iter().product());
                let values = parallel::map(extent.iter().product(), |index| {
                    let at = std::array::from_fn(|k| index / strides[k] % extent[k]);
                    let start = embedded(&mesh.nodes()[grid.node_index(at)]);
                    if axis >= D {
                        return field.potential(&start)[axis];
                    }
                    let mut next = at;
                    next[axis] += 1;
                    let edge = embedded(&mesh.nodes()[grid.node_index(next)]) - start;
                    points.iter().map(|&(t, w)| w * field.potential(&(start + edge * t)).dot(&edge)).sum()
                });
                EdgeIntegrals { axis, strides, values }
            })
            .collect();
        let largest = edges.iter().flat_map(|e| &e.values).fold(0.0_f64, |largest, value| {
            // Not `max`, which drops NaN.
            if value.abs() <= largest { largest } else { value.abs() }
        });
        if largest != 0.0 && !RANGE.contains(&largest) {
            return Err(FluxRange { largest });
        }
        Ok(Self { grid, edges, largest })
    }

    /// The Courant number of a step per unit of time: the largest face flux over the volume of its donor, at full amplitude.
    pub fn courant_rate<C: Cell<D>>(&self, mesh: &Mesh<C, D>) -> f64 {
        self.step(1.0).courant(mesh)
    }

    /// The largest sum of the fluxes out of a cell in a step of this duration, relative to its volume, without sign.
    pub fn largest_divergence<C: Cell<D>>(&self, mesh: &Mesh<C, D>, duration: f64) -> f64 {
        self.step(duration).largest_divergence(mesh)
    }

    /// The volumes that cross the faces while the steady field acts for `duration`.
    pub fn step(&self, duration: f64) -> StepFluxes<'_, D> {
        let quanta = Quanta::new(self.largest * duration.abs());
        StepFluxes(Source::Edges(EdgeFluxes { source: self, duration, quanta }))
    }
}

/// The largest volume that `amount` gives for the cell at an offset, relative to that of the cell.
fn largest_over_cells<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    amount: impl Fn([usize; D]) -> f64 + Sync + Send,
) -> f64 {
    let of_cell = |index: usize| amount(mesh.grid().offset(index)) / mesh.volumes()[index];
    parallel::map(mesh.grid().len(), of_cell).into_iter().fold(0.0, f64::max)
}

impl<'a, const D: usize> StepFluxes<'a, D> {
    pub(super) fn sampled(fluxes: SampledFluxes<'a, D>) -> Self {
        Self(Source::Sampled(fluxes))
    }

    /// The volume that crosses face `2 axis + side` of the cell at `offset` towards higher indices.
    pub fn through(&self, offset: [usize; D], axis: usize, side: usize) -> f64 {
        match &self.0 {
            Source::Edges(fluxes) => fluxes.through(offset, axis, side),
            Source::Sampled(fluxes) => fluxes.through(offset, axis, side),
        }
    }

    /// The same through all faces of the cell at `offset`.
    pub fn of_cell(&self, offset: [usize; D]) -> [f64; 6] {
        match &self.0 {
            Source::Edges(fluxes) => fluxes.of_cell(offset),
            Source::Sampled(fluxes) => std::array::from_fn(|face| match face < 2 * D {
                true => fluxes.through(offset, face / 2, face % 2),
                false => 0.0,
            }),
        }
    }

    /// The sum of what leaves the cell at `offset` through all faces.
    pub fn net(&self, offset: [usize; D]) -> f64 {
        (0..D).map(|axis| self.through(offset, axis, 1) - self.through(offset, axis, 0)).sum()
    }

    /// The Courant number: the largest volume that crosses a face over that of its donor.
    pub fn courant<C: Cell<D>>(&self, mesh: &Mesh<C, D>) -> f64 {
        largest_over_cells(mesh, |offset| {
            let outward = |face: usize| {
                let flux = self.through(offset, face / 2, face % 2);
                if face % 2 == 1 { flux } else { -flux }
            };
            (0..C::FACES).map(outward).fold(0.0, f64::max)
        })
    }

    /// The largest sum of what leaves a cell, relative to its volume, without sign.
    pub fn largest_divergence<C: Cell<D>>(&self, mesh: &Mesh<C, D>) -> f64 {
        largest_over_cells(mesh, |offset| self.net(offset).abs())
    }

    /// What the volumes are multiples of.
    pub(crate) fn quanta(&self) -> Quanta {
        match &self.0 {
            Source::Edges(fluxes) => fluxes.quanta,
            Source::Sampled(fluxes) => fluxes.quanta,
        }
    }

    /// A volume rounded to the step's power of two, for fluxes that are to be added exactly.
    pub fn round(&self, volume: f64) -> f64 {
        self.quanta().round(volume)
    }
}

impl<const D: usize> EdgeFluxes<'_, D> {
    /// See [`StepFluxes::through`].
    fn through(&self, mut offset: [usize; D], axis: usize, side: usize) -> f64 {
        let grid = &self.source.grid;
        let cells = grid.cells();
        offset[axis] += side;
        if grid.periodic()[axis] && offset[axis] == cells[axis] {
            // The two ends are one face.
            offset[axis] = 0;
        }
        let mut flux = 0.0;
        for edges in self.source.edges.iter().filter(|edges| edges.axis != axis) {
            let across = 3 - axis - edges.axis;
            if across >= D {
                continue;
            }
            let near: usize = (0..D).map(|k| offset[k] * edges.strides[k]).sum();
            let far = near + edges.strides[across];
            let difference = self.scaled(edges.values[far]) - self.scaled(edges.values[near]);
            // Right-handed (axis, across, edge) gives plus.
            flux += if (across + 3 - axis) % 3 == 1 { difference } else { -difference };
        }
        flux
    }

    /// See [`StepFluxes::of_cell`].
    fn of_cell(&self, offset: [usize; D]) -> [f64; 6] {
        let (cells, periodic) = (self.source.grid.cells(), self.source.grid.periodic());
        let mut through = [0.0; 6];
        if (0..D).any(|k| periodic[k] && offset[k] + 1 == cells[k]) {
            for face in 0..2 * D {
                through[face] = self.through(offset, face / 2, face % 2);
            }
            return through;
        }
        for edges in &self.source.edges {
            // Right-handed (a, b, edge): what crosses a is a difference along b, what crosses b one along a against it.
            let (a, b) = ((edges.axis + 1) % 3, (edges.axis + 2) % 3);
            let near: usize = (0..D).map(|k| offset[k] * edges.strides[k]).sum();
            let at = |i: usize, j: usize| {
                self.scaled(edges.values[near + i * edges.strides[a] + j * edges.strides[b]])
            };
            let corners = [[at(0, 0), at(0, 1)], [at(1, 0), at(1, 1)]];
            for side in 0..2 {
                through[2 * a + side] += corners[side][1] - corners[side][0];
                through[2 * b + side] -= corners[1][side] - corners[0][side];
            }
        }
        through
    }

    fn scaled(&self, edge: f64) -> f64 {
        self.quanta.round(edge * self.duration)
    }
}
