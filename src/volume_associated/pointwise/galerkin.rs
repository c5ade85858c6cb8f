//! Lax-Wendroff with second derivatives by a projection of the gradient on the nodes (Eq. 57-59). With the gradient `gamma = sum_I N_I gamma_I`
//! and the displacement `u = dt c`
//!
//! ```text
//! phi+ = phi - u . gamma + 1/2 u . grad gamma . u
//! ```

use vofkit_geometry::{Cell, Vector};

use super::element::{Basis, CORNERS, Element};
use crate::mesh::Mesh;
use crate::volume_associated::points::{corner, count};

/// For each cell the right-hand sides `- int phi grad N_I dv`, and those of faces at the ends of the mesh, `int N_I phi n da` (Eq. 58), of
/// its corners. On a face `phi` is taken from the integration point next to the corner, so that a constant has no gradient.
pub(super) fn sides<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    points: &[Basis<D>],
    faces: &[Vec<Basis<D>>],
    values: &[Vec<f64>],
    parts: &mut [[Vector<D>; CORNERS]],
) {
    let grid = mesh.grid();
    super::each(parts, grid, |cell| {
        let element = Element::new(mesh, cell);
        let at = grid.offset(cell);
        let value = |number: usize| values[number % values.len()][cell];
        let mut part = [Vector::<D>::zeros(); CORNERS];
        for (number, point) in points.iter().enumerate() {
            let frame = element.frame(point);
            for (corner, part) in part.iter_mut().enumerate().take(count(D)) {
                *part -= frame.weighted_gradient(point, corner) * (value(number) / count(D) as f64);
            }
        }
        for axis in (0..D).filter(|&axis| !grid.periodic()[axis]) {
            for side in 0..2 {
                if at[axis] != side * (grid.cells()[axis] - 1) {
                    continue;
                }
                let face = &faces[2 * axis + side];
                let outward = if side == 1 { 1.0 } else { -1.0 } / face.len() as f64;
                for point in face {
                    let area = element.frame(point).areas[axis] * outward;
                    for number in (0..count(D)).filter(|&number| corner::<D>(number)[axis] == side) {
                        part[number] += area * (point.values[number] * value(number));
                    }
                }
            }
        }
        part
    });
}
