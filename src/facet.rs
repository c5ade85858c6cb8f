//! A piece of reconstructed interface: what reconstruction hands to export and to metrics.

use vofkit_geometry::Vector;

/// The interface of one material in one cell: the section of the cell with the material's plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet<const D: usize> {
    /// Index of the cell.
    pub cell: usize,
    /// Index of the material.
    pub material: usize,
    /// Unit normal, out of the material.
    pub normal: Vector<D>,
    /// The plane constant `d` of the material's half-space `n.x <= d`, in the coordinates of the mesh.
    pub plane_constant: f64,
    /// Whether the cells around determine the plane: see [`crate::normal::Direction::determined`].
    pub determined: bool,
    /// Exact area (2D: length) of the section; its curved edges are sampled in `loops`, so that their area
    /// may differ slightly.
    pub area: f64,
    /// The section as closed polygons (2D: segments of two points), counter-clockwise seen from outside the
    /// material.
    pub loops: Vec<Vec<Vector<D>>>,
}
