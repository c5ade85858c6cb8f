//! Points with values as `.vtp`, such as integration points.

use std::path::Path;

use vofkit_geometry::Vector;

use super::appended::{Document, Values};
use super::components;
use super::structured_grid::{CellArray, add_arrays};
use crate::export::{ExportError, write_file};

/// Writes points and any number of arrays of values at them as VTK poly data.
///
/// # Errors
/// An array that does not have one value per point, and whatever the file system reports.
pub fn write_points<const D: usize>(
    path: impl AsRef<Path>,
    points: &[Vector<D>],
    arrays: &[CellArray<'_, D>],
) -> Result<(), ExportError> {
    let (path, count) = (path.as_ref(), points.len());
    arrays.iter().try_for_each(|CellArray { name, values }| values.check(path, name, count))?;
    let mut document = Document::new("PolyData");
    document.open("PolyData", "");
    document.open(
        "Piece",
        &format!(
            "NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" \
             NumberOfPolys=\"0\""
        ),
    );
    document.open("Points", "");
    document.array("Points", 3, count, Values::float(points.iter().flat_map(components)));
    document.close();
    document.open("Verts", "");
    document.array("connectivity", 1, count, Values::index(0..count));
    document.array("offsets", 1, count, Values::index(1..count + 1));
    document.close();
    document.open("PointData", "");
    add_arrays(&mut document, arrays, count);
    write_file(path, |writer| document.write(writer))
}
