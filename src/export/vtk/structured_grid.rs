//! A mesh with cell data as `.vts`.

use std::path::Path;

use vofkit_geometry::{Cell, Vector};

use super::appended::{Document, Values};
use super::components;
use crate::export::{ExportError, check_length, write_file};
use crate::mesh::Mesh;

/// One value per cell, by cell index, or per node.
#[derive(Clone, Debug, PartialEq)]
pub enum CellValues<'a, const D: usize> {
    /// Numbers.
    Scalar(&'a [f64]),
    /// Whole numbers.
    Whole(&'a [i64]),
    /// Vectors, written with three components.
    Vector(&'a [Vector<D>]),
    /// Any number of components; those without values are 0.
    Components(Vec<Option<&'a [f64]>>),
}

impl<const D: usize> CellValues<'_, D> {
    /// Whether there is one value for each of `wanted` cells or nodes.
    pub(super) fn check(&self, path: &Path, name: &str, wanted: usize) -> Result<(), ExportError> {
        match self {
            Self::Scalar(values) => check_length(path, name, values.len(), wanted),
            Self::Whole(values) => check_length(path, name, values.len(), wanted),
            Self::Vector(values) => check_length(path, name, values.len(), wanted),
            Self::Components(parts) => {
                parts.iter().flatten().try_for_each(|part| check_length(path, name, part.len(), wanted))
            }
        }
    }
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

    /// One number, vector or symmetric tensor per cell or node, by component: a tensor as xx, yy, zz, xy, yz, xz in the file.
    pub fn components(name: impl Into<String>, parts: &[&'a [f64]]) -> Self {
        let all = |places: &[Option<usize>]| places.iter().map(|place| place.map(|k| parts[k])).collect();
        let width = parts.len();
        let values = match (D, width) {
            (_, 1) => CellValues::Scalar(parts[0]),
            (2, 2) => CellValues::Components(all(&[Some(0), Some(1), None])),
            (2, 3) => CellValues::Components(all(&[Some(0), Some(1), None, Some(2), None, None])),
            _ => CellValues::Components(parts.iter().map(|&part| Some(part)).collect()),
        };
        Self { name: name.into(), values }
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
    write_structured_grid_with_nodes(path, mesh, arrays, &[])
}

/// The same with arrays of values at the nodes, too.
///
/// # Errors
/// An array that does not have one value per cell or node, and whatever the file system reports.
pub fn write_structured_grid_with_nodes<C: Cell<D>, const D: usize>(
    path: impl AsRef<Path>,
    mesh: &Mesh<C, D>,
    at_cells: &[CellArray<'_, D>],
    at_nodes: &[CellArray<'_, D>],
) -> Result<(), ExportError> {
    let path = path.as_ref();
    let counts = [mesh.grid().len(), mesh.nodes().len()];
    for (arrays, count) in [at_cells, at_nodes].into_iter().zip(counts) {
        arrays.iter().try_for_each(|CellArray { name, values }| values.check(path, name, count))?;
    }
    let extent = extent(mesh.grid().cells());
    let mut document = Document::new("StructuredGrid");
    document.open("StructuredGrid", &format!("WholeExtent=\"{extent}\""));
    document.open("Piece", &format!("Extent=\"{extent}\""));
    document.open("Points", "");
    let points = Values::float(mesh.nodes().iter().flat_map(components));
    document.array("Points", 3, mesh.nodes().len(), points);
    document.close();
    for (element, arrays, count) in [("CellData", at_cells, counts[0]), ("PointData", at_nodes, counts[1])] {
        document.open(element, "");
        add_arrays(&mut document, arrays, count);
        document.close();
    }
    write_file(path, |writer| document.write(writer))
}

/// Announces arrays of `count` values each.
pub(super) fn add_arrays<'a, const D: usize>(
    document: &mut Document<'a>,
    arrays: &'a [CellArray<'_, D>],
    count: usize,
) {
    for CellArray { name, values } in arrays {
        match values {
            CellValues::Scalar(values) => {
                document.array(name, 1, count, Values::float(values.iter().copied()));
            }
            CellValues::Whole(values) => {
                document.array(name, 1, count, Values::int(values.iter().copied()));
            }
            CellValues::Vector(values) => {
                document.array(name, 3, count, Values::float(values.iter().flat_map(components)));
            }
            CellValues::Components(parts) => {
                let values = (0..count)
                    .flat_map(move |i| parts.iter().map(move |part| part.map_or(0.0, |part| part[i])));
                document.array(name, parts.len(), count, Values::float(values));
            }
        }
    }
}

/// First and last node along x, y and z.
fn extent<const D: usize>(cells: [usize; D]) -> String {
    let last = |axis: usize| cells.get(axis).copied().unwrap_or(0);
    format!("0 {} 0 {} 0 {}", last(0), last(1), last(2))
}
