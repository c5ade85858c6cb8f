//! Quantities at the integration points of the cells: one in each corner, the Gauss points of second order.
//!
//! Values are kept as `points[corner][cell]`, the corners in the order of [`corner`].

use vofkit_geometry::{Cell, Vector};

use super::limiter::Limiter;
use super::slopes::half_increments;
use super::spacing::Spacing;
use crate::mesh::Mesh;
use crate::parallel;

/// The upper one of the two Gauss points on `[-1, 1]`, `1 / sqrt 3`.
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// Integration points of a cell, and its corners.
pub const fn count(dimension: usize) -> usize {
    1 << dimension
}

/// The offset, 0 or 1 along each axis, of a corner of a cell.
pub fn corner<const D: usize>(number: usize) -> [usize; D] {
    std::array::from_fn(|axis| number >> axis & 1)
}

/// The logical coordinates of an integration point in `[-1, 1]^D`.
fn logical<const D: usize>(number: usize) -> Vector<D> {
    let offset = corner::<D>(number);
    Vector::from_fn(|axis, _| if offset[axis] == 1 { GAUSS } else { -GAUSS })
}

/// The coordinates of an integration point in `[0, 1]^D`.
pub fn local<const D: usize>(number: usize) -> Vector<D> {
    logical::<D>(number).map(|xi| 0.5 * (1.0 + xi))
}

/// The volume that belongs to an integration point, `w det J`: together they are that of the cell.
pub fn weight<C: Cell<D>, const D: usize>(cell: &C, number: usize) -> f64 {
    cell.jacobian_determinant(&local(number)) / count(D) as f64
}

/// The mean values over the cells (Eq. 46).
pub fn cell_means<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, points: &[Vec<f64>]) -> Vec<f64> {
    parallel::map(mesh.grid().len(), |index| {
        let cell = mesh.local_cell(index);
        let (mut volume, mut integral) = (0.0, 0.0);
        for (number, values) in points.iter().enumerate() {
            let weight = weight(&cell, number);
            volume += weight;
            integral += weight * values[index];
        }
        integral / volume
    })
}

/// The values at the integration points from means and limited slopes (Eq. 73-74),
///
/// ```text
/// phi_g = phi + sum over axes of s l (xi_g - xi_c) / 2
/// ```
///
/// with the offsets from the volume centroid `xi_c` of the points, so that their mean is `phi` on any cell. Without a limiter there is no
/// slope.
pub fn redistribute<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    limiter: Option<Limiter>,
    means: &[f64],
) -> Vec<Vec<f64>> {
    let grid = mesh.grid();
    let spacing = Spacing::new(mesh);
    let half: Vec<Vec<f64>> = limiter.map_or(Vec::new(), |limiter| {
        let of_axis = |axis: usize| {
            let mut half = vec![0.0; grid.len()];
            half_increments(grid, &spacing, axis, limiter, means, &mut half);
            half
        };
        (0..D).map(of_axis).collect()
    });
    let mut points = vec![vec![0.0; grid.len()]; count(D)];
    if half.is_empty() {
        points.iter_mut().for_each(|values| values.copy_from_slice(means));
        return points;
    }
    let centroids = parallel::map(grid.len(), |index| {
        let cell = mesh.local_cell(index);
        let (mut volume, mut moment) = (0.0, Vector::<D>::zeros());
        for number in 0..count(D) {
            let weight = weight(&cell, number);
            volume += weight;
            moment += logical::<D>(number) * weight;
        }
        moment / volume
    });
    for (number, values) in points.iter_mut().enumerate() {
        let xi = logical::<D>(number);
        for (index, value) in values.iter_mut().enumerate() {
            let offset = xi - centroids[index];
            *value = means[index] + (0..D).map(|axis| half[axis][index] * offset[axis]).sum::<f64>();
        }
    }
    points
}
