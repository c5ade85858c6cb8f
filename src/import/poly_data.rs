//! Interfaces from the poly data (`.vtp`) that a run wrote.

use std::path::Path;

use vofkit_geometry::Vector;

use super::document::Document;
use super::error::ImportError;
use crate::facet::Facet;
use crate::interface::CellStatus;
use crate::space::planar;
use crate::whole_file;

/// Cell data of a facet.
const CELL: &str = "cell";
const MATERIAL: &str = "material";
const NORMAL: &str = "normal";
const CONSTANT: &str = "plane_constant";
const AREA: &str = "area";
const STATUS: &str = "status";

const RERUN: &str = "write the interface anew, with interface = [\"vtk\"] in the [output] of the scene";

/// Reads the interface that a run wrote. Where a facet has several loops, each comes back as a facet with its part of the area.
///
/// # Errors
/// A file that cannot be read, is no poly data in one piece, lacks one of the arrays that runs write, or whose polygons do not fit its
/// points.
pub fn read_facets<const D: usize>(path: impl AsRef<Path>) -> Result<Vec<Facet<D>>, ImportError> {
    let path = path.as_ref();
    let bytes =
        whole_file::bytes(path).map_err(|error| ImportError::Read { path: path.to_owned(), error })?;
    let polygons = if D == 2 { "Lines" } else { "Polys" };
    let arrays = [CELL, MATERIAL, NORMAL, CONSTANT, AREA, STATUS];
    let wanted = |section: &str, name: &str| {
        section == "Points" || section == polygons || section == "CellData" && arrays.contains(&name)
    };
    let document = Document::parse(path, &bytes, "PolyData", &wanted)?;
    let count = document.count(&format!("NumberOf{polygons}"))?;
    let points = document.points(document.count("NumberOfPoints")?)?;
    let numbers = |section: &str, name: &str, components: usize, count: usize| {
        let array = document.array(section, name)?;
        let missing = || ImportError::Grid {
            path: path.to_owned(),
            problem: format!("there is no array `{name}` in its {section}"),
            help: RERUN,
        };
        document.numbers(array.ok_or_else(missing)?, components, count)
    };
    let wrong = |name: &str, problem: String| ImportError::Array {
        path: path.to_owned(),
        array: name.to_owned(),
        problem,
        help: RERUN,
    };
    let index = |name: &str, value: f64, end: usize| {
        // The conversion keeps to what there is, so that it comes back only if it is a whole number.
        let index = Some(value as usize).filter(|&index| index as f64 == value && index < end);
        index.ok_or_else(|| wrong(name, format!("has {value:?}, which is no index below {end}")))
    };
    let ends = numbers(polygons, "offsets", 1, count)?;
    let corners = match ends.last() {
        Some(&end) => index("offsets", end, usize::MAX)?,
        None => 0,
    };
    let corners = numbers(polygons, "connectivity", 1, corners)?;
    let (cells, materials) = (numbers("CellData", CELL, 1, count)?, numbers("CellData", MATERIAL, 1, count)?);
    let (normals, constants) =
        (numbers("CellData", NORMAL, 3, count)?, numbers("CellData", CONSTANT, 1, count)?);
    let (areas, status) = (numbers("CellData", AREA, 1, count)?, numbers("CellData", STATUS, 1, count)?);
    let mut start = 0;
    let mut facets = Vec::with_capacity(count);
    for at in 0..count {
        let end = index("offsets", ends[at], corners.len() + 1)?;
        let own = corners.get(start..end).ok_or_else(|| wrong("offsets", "goes back".to_owned()))?;
        let place = |&corner: &f64| Ok(planar(&points[index("connectivity", corner, points.len())?]));
        facets.push(Facet {
            cell: index(CELL, cells[at], usize::MAX)?,
            material: index(MATERIAL, materials[at], usize::MAX)?,
            normal: Vector::from_fn(|k, _| normals[3 * at + k]),
            plane_constant: constants[at],
            determined: status[at] == CellStatus::Plane.code() as f64,
            area: areas[at],
            loops: vec![own.iter().map(place).collect::<Result<_, ImportError>>()?],
        });
        start = end;
    }
    Ok(facets)
}
