//! Numbers that judge the values of a quantity that belongs to the mesh.

use vofkit_geometry::Cell;

use crate::mesh::{Grid, Mesh};
use crate::parallel;

/// `sum phi V`.
pub fn integral<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, values: &[f64]) -> f64 {
    parallel::sum(values.len(), |cell| values[cell] * mesh.volumes()[cell])
}

/// `sum |phi| V`: what drifts are relative to.
pub fn absolute_integral<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, values: &[f64]) -> f64 {
    parallel::sum(values.len(), |cell| values[cell].abs() * mesh.volumes()[cell])
}

/// The total variation `sum |phi_{i+1} - phi_i|` (Eq. 62) of a mesh line, joined ends included: the mean over the lines along an axis, added
/// up over the axes.
pub fn total_variation<const D: usize>(grid: &Grid<D>, values: &[f64]) -> f64 {
    let along = |axis: usize| {
        let jump = |cell: usize| {
            grid.neighbour(cell, axis, 1).map_or(0.0, |next| (values[next] - values[cell]).abs())
        };
        let lines = grid.len() / grid.cells()[axis];
        parallel::sum(grid.len(), jump) / lines as f64
    };
    (0..D).map(along).sum()
}

/// The smallest and the largest value.
pub fn extremes(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)])
}
