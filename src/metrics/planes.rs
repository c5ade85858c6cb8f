//! How far the planes of a reconstruction are from the shape that the fractions came from.

use vofkit_geometry::{Cell, HalfSpace};

use crate::facet::Facet;
use crate::fractions::symmetric_difference;
use crate::mesh::Mesh;
use crate::parallel;
use crate::shape::Shape;

/// The volume (2D: area) of the symmetric difference of the reconstructed material and its shape, in each facet's cell: to about a
/// thousandth, and zero to rounding where they coincide.
pub fn plane_errors<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    facets: &[Facet<D>],
    shape: &Shape<D>,
) -> Vec<f64> {
    parallel::map(facets.len(), |i| {
        let Facet { cell, normal, plane_constant, .. } = &facets[i];
        let half_space = HalfSpace { normal: *normal, constant: *plane_constant };
        symmetric_difference(&mesh.cell(*cell), &half_space, shape)
    })
}
