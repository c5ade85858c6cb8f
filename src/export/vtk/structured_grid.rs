//! A mesh with cell data as `.vts`.

use std::path::Path;

use vofkit_geometry::{Cell, Vector};

use super::appended::{Document, Values};
use super::components;
use crate::export::{ExportError, check_length, write_file};
use crate::mesh::Mesh;

/// One value per cell, by cell index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CellValues<'a, const D: usize> {
    /// Numbers.
    Scalar(&'a [f64]),
    /// Whole numbers.
    Whole(&'a [i64]),
    /// Vectors, written with three components.
    Vector(&'a [Vector<D>]),
}

/// Cell data with the name that viewers show, such as `alpha.water`, `volume` or `U`.
#[derive(Clone, Debug, PartialEq)]
pub struct CellArray<'a, const D: usize> {
    /// The name.
    pub name: String,
    /// The values.
    pub values: CellValues<'a, D>,
}

impl<'a, const D: usize> CellArray<'a, D> {
    /// One number per cell.
    pub fn scalar(name: impl Into<String>, values: &'a [f64]) -> Self {
        Self { name: name.into(), values: CellValues::Scalar(values) }
    }

    /// One whole number per cell.
    pub fn whole(name: impl Into<String>, values: &'a [i64]) -> Self {
        Self { name: name.into(), values: CellValues::Whole(values) }
    }

    /// One vector per cell.
    pub fn vector(name: impl Into<String>, values: &'a [Vector<D>]) -> Self {
        Self { name: name.into(), values: CellValues::Vector(values) }
    }
}

/// The volume fractions of the materials as arrays `alpha.<material>`.
pub fn fraction_arrays<'a, const D: usize>(
    names: &[String],
    fractions: &'a [Vec<f64>],
) -> Vec<CellArray<'a, D>> {
    let array = |(name, values): (&String, &'a Vec<f64>)| CellArray::scalar(format!("alpha.{name}"), values);
    names.iter().zip(fractions).map(array).collect()
}

/// Writes the nodes of the mesh and any number of cell arrays as a VTK structured grid.
///
/// # Errors
/// An array that does not have one value per cell, and whatever the file system reports.
pub fn write_structured_grid<C: Cell<D>, const D: usize>(
    path: impl AsRef<Path>,
    mesh: &Mesh<C, D>,
    arrays: &[CellArray<'_, D>],
) -> Result<(), ExportError> {
    let path = path.as_ref();
    let cells = mesh.grid().len();
    for CellArray { name, values } in arrays {
        let found = match values {
            CellValues::Scalar(values) => values.len(),
            CellValues::Whole(values) => values.len(),
            CellValues::Vector(values) => values.len(),
        };
        check_length(path, name, found, cells)?;
    }
    let extent = extent(mesh.grid().cells());
    let mut document = Document::new("StructuredGrid");
    document.open("StructuredGrid", &format!("WholeExtent=\"{extent}\""));
    document.open("Piece", &format!("Extent=\"{extent}\""));
    document.open("Points", "");
    let points = Values::float(mesh.nodes().iter().flat_map(components));
    document.array("Points", 3, mesh.nodes().len(), points);
    document.close();
    document.open("CellData", "");
    for CellArray { name, values } in arrays {
        match *values {
            CellValues::Scalar(values) => {
                document.array(name, 1, cells, Values::float(values.iter().copied()));
            }
            CellValues::Whole(values) => {
                document.array(name, 1, cells, Values::int(values.iter().copied()));
            }
            CellValues::Vector(values) => {
                document.array(name, 3, cells, Values::float(values.iter().flat_map(components)));
            }
        }
    }
    write_file(path, |writer| document.write(writer))
}

/// First and last node along x, y and z.
fn extent<const D: usize>(cells: [usize; D]) -> String {
    let last = |axis: usize| cells.get(axis).copied().unwrap_or(0);
    format!("0 {} 0 {} 0 {}", last(0), last(1), last(2))
}
