//! A mesh and what lies on it at one time.

use crate::facet::Facet;
use crate::mesh::Mesh;

/// A mesh, the materials on it and their interfaces at one time.
#[derive(Clone, Copy, Debug)]
pub struct Snapshot<'a, C, const D: usize> {
    /// The mesh.
    pub mesh: &'a Mesh<C, D>,
    /// The names of the materials.
    pub names: &'a [String],
    /// Their fractions: one value per cell for each name.
    pub fractions: &'a [Vec<f64>],
    /// Their interfaces.
    pub facets: &'a [Facet<D>],
    /// What stands above a picture of it.
    pub title: &'a str,
}
