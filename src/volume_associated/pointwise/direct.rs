//! The direct scheme (Eq. 37-42): the advection equation itself at the integration points, with the gradient of a field that is continuous
//! from cell to cell. With the displacement `u = dt c`
//!
//! ```text
//! phi+ = (1 - alpha) phi + sum_I phi_I (alpha N_I - grad N_I . u)
//! ```

use vofkit_geometry::{Cell, Vector};

use super::element::{Basis, CORNERS, Element};
use crate::mesh::Mesh;
use crate::volume_associated::points::count;

/// How the direct scheme is kept from breaking up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Smoothing {
    /// Local smoothing (Eq. 40): the means over the cells are projected on the nodes. Without effect on cells with one value.
    pub local: bool,
    /// The part `alpha` of the projected field in the old values, from 0 to 2 (Eq. 42): 0 none, 1 global smoothing (Eq. 41).
    ///
    /// With one value per cell and lumped volumes, on equal boxes and at a constant velocity, the scheme amplifies no wave where
    /// `2 Cr^2 <= alpha <= 2`; `Cr <= alpha <= 2 Cr` (Eq. 43) is inside for `Cr <= 1/2`.
    pub alpha: f64,
}

/// For each cell the right-hand sides `int N_I phi dv` of its corners.
pub(super) fn sides<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    points: &[Basis<D>],
    local: bool,
    values: &[Vec<f64>],
    parts: &mut [[Vector<1>; CORNERS]],
) {
    super::each(parts, mesh.grid(), |cell| {
        let element = Element::new(mesh, cell);
        let mut weights = [0.0; CORNERS];
        let (mut volume, mut integral) = (0.0, 0.0);
        for (number, point) in points.iter().enumerate() {
            weights[number] = element.frame(point).determinant / count(D) as f64;
            volume += weights[number];
            integral += weights[number] * values[number % values.len()][cell];
        }
        let mut part = [Vector::<1>::zeros(); CORNERS];
        for (number, point) in points.iter().enumerate() {
            let value = if local { integral / volume } else { values[number % values.len()][cell] };
            for (part, basis) in part.iter_mut().zip(point.values) {
                part[0] += weights[number] * basis * value;
            }
        }
        part
    });
}
