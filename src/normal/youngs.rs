//! Youngs' normal (Youngs 1982, 1984; Eq. 82-84 of the paper): the gradient of the fractions by central differences of
//! layers, each layer averaged with weights 1, 2, 1 in every direction along it.
//!
//! `df/dxi_k = (fbar_{k+1} - fbar_{k-1}) / 2` per cell; in 3D the layer's weights are 1 at its corners, 2 at its edges and 4 in the
//! middle, over 16 (Eq. 83); in 2D 1, 2, 1 over 4 (Eq. 84). The normal points out of the material: `n = -grad f / |grad f|`.

use nalgebra::SMatrix;
use vofkit_geometry::{Cell, Vector};

use super::stencil::{Stencil, stencil_cells};
use super::{Around, Direction, Found, NoNormal};
use crate::mesh::Mesh;
use crate::tolerance::GRADIENT_FLAT;

/// The gradient in cells, along the logical axes.
fn logical_gradient<const D: usize>(stencil: &Stencil<D>) -> Vector<D> {
    // One axis after the other is summed up, the fastest first: with weights 1, 2, 1 in `layers` and in the slopes along
    // earlier axes, as a difference in the slope along it.
    let mut layers = stencil.values;
    let mut slopes = [[0.0; 27]; D];
    let mut count = stencil_cells(D);
    for axis in 0..D {
        count /= 3;
        let averaged = |row: &[f64; 27], i: usize| row[3 * i] + 2.0 * row[3 * i + 1] + row[3 * i + 2];
        for i in 0..count {
            for slope in &mut slopes[..axis] {
                slope[i] = averaged(slope, i);
            }
            slopes[axis][i] = layers[3 * i + 2] - layers[3 * i];
            layers[i] = averaged(&layers, i);
        }
    }
    // Each of the D - 1 directions along a layer averages with a quarter; the difference is over two cells.
    let scale = 0.5 * 0.25_f64.powi(D as i32 - 1);
    Vector::from_fn(|axis, _| slopes[axis][0] * scale)
}

/// The gradient in cells, along the logical axes; why there is none where it is no more than rounding.
pub(super) fn slopes<const D: usize>(stencil: &Stencil<D>) -> Result<Vector<D>, NoNormal> {
    let gradient = logical_gradient(stencil);
    if gradient.amax() <= GRADIENT_FLAT * stencil.largest() {
        return Err(stencil.why_flat());
    }
    Ok(gradient)
}

/// The unit normal against a gradient.
pub(super) fn against<const D: usize>(gradient: Vector<D>) -> Found<D> {
    let size = gradient.norm();
    if size > 0.0 && size.is_finite() {
        Ok(Direction::direct(gradient / -size))
    } else {
        Err(NoNormal::Balanced)
    }
}

/// The physical gradient `J^-T df/dxi`. The differences that make up `df/dxi` lie a cell apart, so `J` is made of the same
/// differences of the cells' middles: with the cell's own Jacobian a distorted mesh would turn the normal.
pub(super) fn in_space<C: Cell<D>, const D: usize>(
    around: &Around<'_, C, D>,
    gradient: &Vector<D>,
) -> Vector<D> {
    let mesh = around.material.mesh;
    if mesh.is_undistorted() {
        return around.cell.physical_gradient(gradient);
    }
    let jacobian = SMatrix::from_columns(&stencil_jacobian(mesh, around.offset));
    jacobian.transpose().try_inverse().map_or(Vector::zeros(), |inverse| inverse * gradient)
}

/// Youngs' normal in space.
pub(super) fn physical<C: Cell<D>, const D: usize>(around: &Around<'_, C, D>) -> Found<D> {
    let gradient = slopes(&around.stencil)?;
    against(in_space(around, &gradient))
}

/// The derivatives of position along the logical axes, by the differences of [`logical_gradient`] between the middles of
/// the cells (the means of their nodes). Over the `4^D` nodes of the stencil these have the weights -1, -1, 1, 1
/// over 4 along the axis and 1, 3, 3, 1 over 8 along the others.
fn stencil_jacobian<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, offset: [usize; D]) -> [Vector<D>; D] {
    const SLOPE: [f64; 4] = [-0.25, -0.25, 0.25, 0.25];
    const MEAN: [f64; 4] = [0.125, 0.375, 0.375, 0.125];
    let grid = mesh.grid();
    let inner = (0..D).all(|k| offset[k] > 0 && offset[k] + 1 < grid.cells()[k]);
    let mut columns = [Vector::<D>::zeros(); D];
    // Rows of four nodes along the first axis.
    for row in 0..4_usize.pow(D as u32 - 1) {
        let step: [usize; D] =
            std::array::from_fn(|axis| if axis == 0 { 0 } else { row >> (2 * (axis - 1)) & 3 });
        let nodes: [Vector<D>; 4] = if inner {
            let first = grid.node_index(std::array::from_fn(|axis| offset[axis] + step[axis] - 1));
            std::array::from_fn(|i| mesh.nodes()[first + i])
        } else {
            let at = |axis: usize, i: usize| {
                (offset[axis] + step[axis] + if axis == 0 { i } else { 0 }) as isize - 1
            };
            std::array::from_fn(|i| extended_node(mesh, std::array::from_fn(|axis| at(axis, i))))
        };
        let [a, b, c, d] = nodes;
        let (slope, mean) = (((c + d) - (a + b)) * SLOPE[2], (a + d) * MEAN[0] + (b + c) * MEAN[1]);
        for (axis, column) in columns.iter_mut().enumerate() {
            let weight = |k: usize| if k == axis { SLOPE[step[k]] } else { MEAN[step[k]] };
            let along = if axis == 0 { slope } else { mean };
            *column += along * (1..D).map(weight).product::<f64>();
        }
    }
    columns
}

/// The node at an index, or, one layer beyond an end, where the mesh would go on evenly.
fn extended_node<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, at: [isize; D]) -> Vector<D> {
    let cells = mesh.grid().cells();
    let outside = (0..D).find(|&axis| at[axis] < 0 || at[axis] > cells[axis] as isize);
    let Some(axis) = outside else {
        return mesh.nodes()[mesh.grid().node_index(at.map(|i| i as usize))];
    };
    let inward = if at[axis] < 0 { 1 } else { -1 };
    let moved = |steps: isize| {
        let mut to = at;
        to[axis] += inward * steps;
        extended_node(mesh, to)
    };
    moved(1) * 2.0 - moved(2)
}

/// The components `(df/dxi_k) / h_k` with the cell's mean edge lengths `h_k`, taken as Cartesian ones (Eq. 82).
pub(super) fn logical<C: Cell<D>, const D: usize>(around: &Around<'_, C, D>) -> Found<D> {
    let gradient = slopes(&around.stencil)?;
    against(Vector::from_fn(|k, _| gradient[k] / around.cell.mean_edge(k).norm()))
}
