//! Youngs' normal (Youngs 1982, 1984; Eq. 82-84 of the paper): the gradient of the fractions by central differences of
//! layers, each layer averaged with weights 1, 2, 1 in every direction along it.
//!
//! `df/dxi_k = (fbar_{k+1} - fbar_{k-1}) / 2` per cell; in 3D the layer's weights are 1 at its corners, 2 at its edges and 4 in the
//! middle, over 16 (Eq. 83); in 2D 1, 2, 1 over 4 (Eq. 84). The normal points out of the material: `n = -grad f / |grad f|`.

use vofkit_geometry::{Cell, Vector};

use super::Stencil;
use crate::tolerance::GRADIENT_FLAT;

/// The gradient in cells, along the logical axes.
fn logical_gradient<const D: usize>(stencil: &Stencil<D>) -> Vector<D> {
    let mut gradient = Vector::<D>::zeros();
    // Each of the D - 1 directions along a layer halves twice; so does the central difference, once.
    let scale = 0.5 * 0.25_f64.powi(D as i32 - 1);
    for (step, f) in stencil.iter() {
        for axis in 0..D {
            let weight: isize =
                (0..D).filter(|&k| k != axis).map(|k| 2 - step[k].abs()).product::<isize>() * step[axis];
            gradient[axis] += weight as f64 * f;
        }
    }
    gradient * scale
}

/// The unit normal against a gradient, if that is more than rounding.
fn against<const D: usize>(gradient: Vector<D>) -> Option<Vector<D>> {
    let size = gradient.norm();
    (size > 0.0 && size.is_finite()).then(|| gradient / -size)
}

fn is_flat<const D: usize>(gradient: &Vector<D>, stencil: &Stencil<D>) -> bool {
    gradient.amax() <= GRADIENT_FLAT * stencil.largest()
}

/// The physical gradient `J^-T df/dxi` with the cell's mean Jacobian `J`.
pub(super) fn physical<C: Cell<D>, const D: usize>(cell: &C, stencil: &Stencil<D>) -> Option<Vector<D>> {
    let gradient = logical_gradient(stencil);
    if is_flat(&gradient, stencil) {
        return None;
    }
    against(cell.physical_gradient(&gradient))
}

/// The components `(df/dxi_k) / h_k` with the cell's mean edge lengths `h_k`, taken as Cartesian ones (Eq. 82).
pub(super) fn logical<C: Cell<D>, const D: usize>(cell: &C, stencil: &Stencil<D>) -> Option<Vector<D>> {
    let gradient = logical_gradient(stencil);
    if is_flat(&gradient, stencil) {
        return None;
    }
    against(Vector::from_fn(|k, _| gradient[k] / cell.mean_edge(k).norm()))
}
