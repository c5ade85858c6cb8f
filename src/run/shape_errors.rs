//! How far the planes of a material are from the shape that it was made from.

use vofkit_geometry::Cell;

use crate::facet::Facet;
use crate::mesh::Mesh;
use crate::metrics::{hausdorff_mean, plane_errors};
use crate::shape::Shape;

/// Distances of one material; none where its shape is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ShapeErrors {
    /// The volume of the symmetric difference in the cells with a plane.
    pub(crate) symmetric_difference: Option<f64>,
    /// The mean Hausdorff distance per facet from a disc or sphere that nothing covers.
    pub(crate) hausdorff_mean: Option<f64>,
}

impl ShapeErrors {
    /// For the facets of the material with the last of these shapes; the others cover it.
    pub(crate) fn new<C: Cell<D>, const D: usize>(
        mesh: &Mesh<C, D>,
        facets: &[Facet<D>],
        shapes: &[Shape<D>],
    ) -> Self {
        let Some((own, cover)) = shapes.split_last() else { return Self::default() };
        let hausdorff_mean = match own {
            Shape::Sphere { centre, radius } if cover.is_empty() => {
                hausdorff_mean(mesh, facets, centre, *radius)
            }
            _ => None,
        };
        let difference = |shape: &Shape<D>| plane_errors(mesh, facets, shape).iter().sum();
        let symmetric_difference = if cover.is_empty() {
            difference(own)
        } else {
            difference(&Shape::Difference(Box::new(own.clone()), cover.to_vec()))
        };
        Self { symmetric_difference: Some(symmetric_difference), hausdorff_mean }
    }
}
