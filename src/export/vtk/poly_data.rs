//! Interface facets as `.vtp`.

use std::path::Path;

use vofkit_geometry::Vector;

use super::appended::{Document, Values};
use super::components;
use crate::export::{ExportError, write_file};
use crate::facet::Facet;
use crate::interface::CellStatus;
use crate::space::spatial;

/// Writes interface facets as VTK poly data: polygons in 3D, lines in 2D, with `cell` and `material`
/// (indices), `normal` (three components), `plane_constant`, `area` and `status` (the number of [`CellStatus::Plane`] or
/// [`CellStatus::Undetermined`]) as cell data.
///
/// Each loop of a facet is a polygon. A facet with one loop has its exact [`Facet::area`]; several loops
/// share it in proportion to the areas of their polygons, so that the areas in the file add up to the
/// interface's. Points are not shared among facets.
/// The curved edges of distorted cells make polygons that are slightly non-convex: `area` is exact for them,
/// whereas the cell sizes that VTK computes are too large.
///
/// # Errors
/// Whatever the file system reports.
pub fn write_poly_data<const D: usize>(
    path: impl AsRef<Path>,
    facets: &[Facet<D>],
) -> Result<(), ExportError> {
    let polygons = || facets.iter().flat_map(|facet| loops(facet).map(move |points| (facet, points)));
    let count = polygons().count();
    let points: usize = polygons().map(|(_, points)| points.len()).sum();
    let (element, [lines, polys]) = if D == 2 { ("Lines", [count, 0]) } else { ("Polys", [0, count]) };

    let mut document = Document::new("PolyData");
    document.open("PolyData", "");
    document.open(
        "Piece",
        &format!(
            "NumberOfPoints=\"{points}\" NumberOfVerts=\"0\" NumberOfLines=\"{lines}\" NumberOfStrips=\"0\" \
             NumberOfPolys=\"{polys}\""
        ),
    );
    document.open("Points", "");
    document.array(
        "Points",
        3,
        points,
        Values::float(polygons().flat_map(|(_, p)| p.iter().flat_map(components))),
    );
    document.close();
    document.open(element, "");
    document.array("connectivity", 1, points, Values::index(0..points));
    let ends = polygons().scan(0, |end, (_, points)| {
        *end += points.len();
        Some(*end)
    });
    document.array("offsets", 1, count, Values::index(ends));
    document.close();
    document.open("CellData", "");
    document.array("cell", 1, count, Values::index(polygons().map(|(facet, _)| facet.cell)));
    document.array("material", 1, count, Values::index(polygons().map(|(facet, _)| facet.material)));
    document.array(
        "normal",
        3,
        count,
        Values::float(polygons().flat_map(|(facet, _)| components(&facet.normal))),
    );
    let constants = polygons().map(|(facet, _)| facet.plane_constant);
    document.array("plane_constant", 1, count, Values::float(constants));
    document.array("area", 1, count, Values::float(facets.iter().flat_map(areas)));
    document.array("status", 1, count, Values::int(polygons().map(|(facet, _)| status(facet).code())));
    write_file(path, |writer| document.write(writer))
}

fn status<const D: usize>(facet: &Facet<D>) -> CellStatus {
    if facet.determined { CellStatus::Plane } else { CellStatus::Undetermined }
}

/// The loops that have points.
fn loops<const D: usize>(facet: &Facet<D>) -> impl Iterator<Item = &Vec<Vector<D>>> {
    facet.loops.iter().filter(|points| !points.is_empty())
}

/// The part of the facet's area in each loop.
fn areas<const D: usize>(facet: &Facet<D>) -> Vec<f64> {
    let own: Vec<f64> = loops(facet).map(|points| area(points, &facet.normal)).collect();
    let total: f64 = own.iter().sum();
    match own.len() {
        1 => vec![facet.area],
        _ if total > 0.0 => own.iter().map(|area| facet.area * (area / total)).collect(),
        _ => own,
    }
}

/// The area of a polygon seen along its normal, in 2D the length of a line.
fn area<const D: usize>(points: &[Vector<D>], normal: &Vector<D>) -> f64 {
    if D == 2 {
        return points.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
    }
    // About the first point, so that no digits are lost to the place of the mesh.
    let [normal, first] = [spatial(normal), spatial(&points[0])];
    let arm = |point: &Vector<D>| spatial(point) - first;
    points.windows(2).map(|ends| 0.5 * arm(&ends[0]).cross(&arm(&ends[1])).dot(&normal)).sum()
}
