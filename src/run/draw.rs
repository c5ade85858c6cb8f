//! Pictures, of the meshes that have them.

use std::path::Path;

use vofkit_geometry::{Cell, Hexahedron, Quad};

use crate::export::{ExportError, Snapshot};
use crate::mesh::Mesh;

/// Where the values of a field are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Places {
    /// In the cells.
    Cells,
    /// At the nodes.
    Nodes,
}

/// The values of one component of a field, for a picture.
#[derive(Clone, Copy, Debug)]
pub struct FieldView<'a, C, const D: usize> {
    /// The mesh.
    pub mesh: &'a Mesh<C, D>,
    /// Where the values are.
    pub places: Places,
    /// The values.
    pub values: &'a [f64],
    /// Those at the start, if the mesh was as it is now.
    pub start: &'a [f64],
    /// What they should be, where that is known.
    pub exact: Option<&'a [f64]>,
    /// What stands above the picture.
    pub title: &'a str,
}

/// Cells whose meshes may be drawn.
pub trait Draw<const D: usize>: Cell<D> {
    /// Writes a picture, in two dimensions as SVG, in three as PNG; returns false where there is none.
    ///
    /// # Errors
    /// Whatever the file system reports.
    fn draw(path: &Path, snapshot: &Snapshot<'_, Self, D>) -> Result<bool, ExportError>;

    /// Writes a picture of a field: curves along a single row of cells, else a map with lines of equal value. Returns false where there
    /// is none.
    ///
    /// # Errors
    /// Whatever the file system reports.
    fn draw_field(path: &Path, view: &FieldView<'_, Self, D>) -> Result<bool, ExportError>;
}

impl Draw<2> for Quad {
    #[cfg(feature = "plot")]
    fn draw(path: &Path, snapshot: &Snapshot<'_, Self, 2>) -> Result<bool, ExportError> {
        crate::export::picture::write_svg(path, snapshot).map(|()| true)
    }

    #[cfg(not(feature = "plot"))]
    fn draw(_: &Path, _: &Snapshot<'_, Self, 2>) -> Result<bool, ExportError> {
        Ok(false)
    }

    #[cfg(feature = "plot")]
    fn draw_field(path: &Path, view: &FieldView<'_, Self, 2>) -> Result<bool, ExportError> {
        use crate::export::plot::{Curve, write_curves, write_map};
        let FieldView { mesh, places, values, start, exact, title } = *view;
        let [columns, rows] = mesh.grid().cells();
        if rows > 1 || places == Places::Nodes {
            return write_map(path, mesh, values, title).map(|()| true);
        }
        let middle = |cell: usize| mesh.cell(cell).map(&vofkit_geometry::Vector::repeat(0.5))[0];
        let x: Vec<f64> = (0..columns).map(middle).collect();
        let mut curves = vec![Curve { name: "start", values: start }, Curve { name: "now", values }];
        curves.extend(exact.map(|values| Curve { name: "exact", values }));
        write_curves(path, ("x", &x), &curves, title).map(|()| true)
    }

    #[cfg(not(feature = "plot"))]
    fn draw_field(_: &Path, _: &FieldView<'_, Self, 2>) -> Result<bool, ExportError> {
        Ok(false)
    }
}

impl Draw<3> for Hexahedron {
    #[cfg(feature = "plot")]
    fn draw(path: &Path, snapshot: &Snapshot<'_, Self, 3>) -> Result<bool, ExportError> {
        use crate::export::picture::{Look, write_png};
        write_png(path, snapshot, &Look::default()).map(|()| true)
    }

    #[cfg(not(feature = "plot"))]
    fn draw(_: &Path, _: &Snapshot<'_, Self, 3>) -> Result<bool, ExportError> {
        Ok(false)
    }

    fn draw_field(_: &Path, _: &FieldView<'_, Self, 3>) -> Result<bool, ExportError> {
        Ok(false)
    }
}
