//! Numbers that say how good a result is.

mod field;
mod fragments;
mod gap;
mod hausdorff;
mod planes;

pub use field::{absolute_integral, extremes, integral, total_variation};
pub use fragments::{Fragments, Pieces, fragments, pieces};
pub use gap::facet_gap_mean;
pub use hausdorff::hausdorff_mean;
pub use planes::plane_errors;

use vofkit_geometry::Cell;

use crate::mesh::Mesh;
use crate::parallel;

/// The volume of a material, `sum f V`.
pub fn material_volume<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, fractions: &[f64]) -> f64 {
    integral(mesh, fractions)
}

/// The error of a shape, `E = sum |f - f_exact| V`, in the unit of volume.
pub fn shape_error<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, fractions: &[f64], exact: &[f64]) -> f64 {
    parallel::sum(fractions.len(), |i| (fractions[i] - exact[i]).abs() * mesh.volumes()[i])
}
