//! Pictures, of the meshes that have them.

use std::path::Path;

use vofkit_geometry::{Cell, Hexahedron, Quad};

use crate::export::ExportError;
use crate::facet::Facet;
use crate::mesh::Mesh;

/// The state of a run, for a picture.
#[derive(Clone, Copy, Debug)]
pub struct View<'a, C, const D: usize> {
    /// The mesh.
    pub mesh: &'a Mesh<C, D>,
    /// The names of the materials.
    pub names: &'a [String],
    /// Their fractions.
    pub fractions: &'a [Vec<f64>],
    /// Their interfaces.
    pub facets: &'a [Facet<D>],
    /// What stands above the picture.
    pub title: &'a str,
}

/// Cells whose meshes may be drawn.
pub trait Draw<const D: usize>: Cell<D> {
    /// Writes a picture; returns false where there is none.
    ///
    /// # Errors
    /// Whatever the file system reports.
    fn draw(path: &Path, view: &View<'_, Self, D>) -> Result<bool, ExportError>;
}

impl Draw<2> for Quad {
    #[cfg(feature = "plot")]
    fn draw(path: &Path, view: &View<'_, Self, 2>) -> Result<bool, ExportError> {
        let View { mesh, names, fractions, facets, title } = *view;
        crate::export::picture::write_picture(path, mesh, names, fractions, facets, title).map(|()| true)
    }

    #[cfg(not(feature = "plot"))]
    fn draw(_: &Path, _: &View<'_, Self, 2>) -> Result<bool, ExportError> {
        Ok(false)
    }
}

impl Draw<3> for Hexahedron {
    fn draw(_: &Path, _: &View<'_, Self, 3>) -> Result<bool, ExportError> {
        Ok(false)
    }
}
