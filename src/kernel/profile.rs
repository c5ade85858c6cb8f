//! How the constant of a plane that moves through a cell depends on the volume fraction below it (Fig. 30): not linearly, and for
//! odd cells far from it.
//!
//! **In**: a table with the columns `x0, y0 ... x3, y3`, `nx, ny` and, as far as there are hexahedra, `z0` to `z7`, `x4` to `y7` and
//! `nz`. A row of which these are empty is a quadrilateral. A column `name` is what the curve is called.
//! **Out**: `name, f, d, s, section_area` for fractions from 0 to 1; `s` is `d` between its values at the two ends. Beside it, with the
//! feature `plot`, a picture of `s` over `f`.

#[cfg(feature = "plot")]
use std::path::Path;
use std::path::PathBuf;

use csv::StringRecord;
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, PositionMethod, Quad, Vector};

use super::columns::find;
use super::error::{ColumnsError, RowError};
use super::input::number;
use super::rows::Rows;
use super::{KernelError, check_output};
#[cfg(feature = "plot")]
use crate::export::ExportError;
use crate::export::write_file;

/// Steps of the fraction from 0 to 1.
const STEPS: usize = 100;

/// More cells than this are no picture.
const MOST: usize = 200;

/// Which cells, and where their profiles go.
#[derive(Clone, Debug)]
pub struct ProfileJob {
    /// The table of cells.
    pub input: PathBuf,
    /// The table of profiles; the picture has its name with `.svg` in the place of its extension.
    pub output: PathBuf,
    /// Whether existing files may be replaced.
    pub force: bool,
}

/// The profile of a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// What it is called.
    pub name: String,
    /// From the fraction 0 to 1.
    pub points: Vec<ProfilePoint>,
}

/// The plane below which a fraction lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfilePoint {
    /// The volume fraction.
    pub fraction: f64,
    /// The plane constant, for the normal as it is given.
    pub constant: f64,
    /// The plane constant between those of the fractions 0 and 1.
    pub place: f64,
    /// The area of the section.
    pub section_area: f64,
}

/// Writes the profiles of a table of cells; returns them, and the files.
///
/// # Errors
/// The first thing that is wrong with the files, their header or a row; see [`KernelError`].
pub fn profile(job: &ProfileJob) -> Result<(Vec<Profile>, Vec<PathBuf>), KernelError> {
    let mut rows = Rows::open(&job.input)?;
    let columns = CellColumns::of(rows.header())
        .map_err(|problem| KernelError::Columns { path: job.input.clone(), problem })?;
    let picture = job.output.with_extension("svg");
    let files: Vec<PathBuf> =
        [job.output.clone()].into_iter().chain(cfg!(feature = "plot").then_some(picture)).collect();
    for file in &files {
        check_output(&job.input, file, job.force)?;
    }
    let mut records = Vec::new();
    rows.fill(&mut records, MOST + 1)?;
    let mut profiles = Vec::with_capacity(records.len());
    for (at, record) in records.iter().enumerate() {
        let found = if at < MOST { columns.profile(record, at) } else { Err(RowError::Many(MOST)) };
        profiles.push(found.map_err(|problem| rows.error_at(record, problem))?);
    }
    write_file(&job.output, |out| {
        let mut writer = csv::Writer::from_writer(out);
        writer.write_record(["name", "f", "d", "s", "section_area"])?;
        for Profile { name, points, .. } in &profiles {
            for ProfilePoint { fraction, constant, place, section_area } in points {
                let numbers = [fraction, constant, place, section_area].map(|number| format!("{number:?}"));
                writer.write_record(std::iter::once(name).chain(&numbers))?;
            }
        }
        writer.flush()
    })?;
    #[cfg(feature = "plot")]
    draw(&files[1], &profiles)?;
    Ok((profiles, files))
}

/// The columns of cells; those of quadrilaterals are always there.
struct CellColumns {
    count: usize,
    name: Option<usize>,
    /// By node and axis.
    nodes: [[Option<usize>; 3]; 8],
    normal: [Option<usize>; 3],
}

impl CellColumns {
    fn of(header: &StringRecord) -> Result<Self, ColumnsError> {
        if header.iter().all(|name| name.trim().is_empty()) {
            return Err(ColumnsError::Empty);
        }
        let mut missing = Vec::new();
        let mut place = |name: String, needed: bool| -> Result<Option<usize>, ColumnsError> {
            let found = find(header, &name)?;
            if needed && found.is_none() {
                missing.push(name);
            }
            Ok(found)
        };
        let mut nodes = [[None; 3]; 8];
        for (node, places) in nodes.iter_mut().enumerate() {
            for (axis, at) in places.iter_mut().enumerate() {
                *at = place(format!("{}{node}", ["x", "y", "z"][axis]), node < 4 && axis < 2)?;
            }
        }
        let mut normal = [None; 3];
        for (axis, at) in normal.iter_mut().enumerate() {
            *at = place(format!("n{}", ["x", "y", "z"][axis]), axis < 2)?;
        }
        if !missing.is_empty() {
            return Err(ColumnsError::Missing { names: missing, hint: None });
        }
        Ok(Self { count: header.len(), name: find(header, "name")?, nodes, normal })
    }

    fn profile(&self, record: &StringRecord, row: usize) -> Result<Profile, RowError> {
        if record.len() != self.count {
            return Err(RowError::Fields { found: record.len(), wanted: self.count });
        }
        let text = |at: Option<usize>| at.and_then(|at| record.get(at)).unwrap_or_default().trim();
        let name = Some(text(self.name)).filter(|name| !name.is_empty());
        let name = name.map_or_else(|| format!("row {}", row + 1), str::to_owned);
        let of_space = (4..8).any(|node| self.nodes[node].iter().any(|&at| !text(at).is_empty()));
        let points =
            |at: [Option<usize>; 3], what: &dyn Fn(usize) -> String| -> Result<Vector<3>, RowError> {
                let mut point = Vector::<3>::zeros();
                for axis in 0..if of_space { 3 } else { 2 } {
                    point[axis] = number(text(at[axis]), &what(axis))?;
                }
                Ok(point)
            };
        let mut nodes = [Vector::<3>::zeros(); 8];
        for (node, x) in nodes.iter_mut().enumerate().take(if of_space { 8 } else { 4 }) {
            *x = points(self.nodes[node], &|axis| format!("{}{node}", ["x", "y", "z"][axis]))?;
        }
        let normal = points(self.normal, &|axis| format!("n{}", ["x", "y", "z"][axis]))?;
        if normal == Vector::<3>::zeros() {
            return Err(RowError::Normal);
        }
        let points = if of_space {
            along::<Hexahedron, 3>(&nodes, &normal)?
        } else {
            along::<Quad, 2>(&nodes, &normal)?
        };
        Ok(Profile { name, points })
    }
}

/// The planes of a cell, found with its first node at the origin.
fn along<C: Cell<D>, const D: usize>(
    nodes: &[Vector<3>],
    normal: &Vector<3>,
) -> Result<Vec<ProfilePoint>, RowError> {
    let narrow = |x: &Vector<3>| Vector::<D>::from_fn(|k, _| x[k]);
    let place = |offset: [usize; D]| C::OFFSETS.iter().position(|own| *own == offset).unwrap_or(0);
    let cell = C::from_corners(|offset| narrow(&(nodes[place(offset)] - nodes[0])));
    if let Some(defect) = cell.defects().into_iter().find(vofkit_geometry::Defect::is_error) {
        return Err(RowError::Cell(defect));
    }
    let length = normal.norm();
    let unit = narrow(&(normal / length));
    let first = normal.dot(&nodes[0]);
    let mut points = Vec::with_capacity(STEPS + 1);
    for step in 0..=STEPS {
        let fraction = step as f64 / STEPS as f64;
        let found = cell.plane_constant(&unit, fraction, PositionMethod::Auto).map_err(RowError::Position)?;
        let half_space = HalfSpace { normal: unit, constant: found.constant };
        let section_area = cell.truncate(&half_space).section_area;
        points.push(ProfilePoint {
            fraction,
            constant: found.constant * length + first,
            place: found.constant,
            section_area,
        });
    }
    let [low, high] = [points[0].place, points[STEPS].place];
    for point in &mut points {
        point.place = (point.place - low) / (high - low);
    }
    Ok(points)
}

#[cfg(feature = "plot")]
fn draw(path: &Path, profiles: &[Profile]) -> Result<(), ExportError> {
    use crate::export::plot::{Curve, write_curves};
    let fractions: Vec<f64> = (0..=STEPS).map(|step| step as f64 / STEPS as f64).collect();
    let places: Vec<Vec<f64>> =
        profiles.iter().map(|profile| profile.points.iter().map(|point| point.place).collect()).collect();
    let curves: Vec<Curve<'_>> = profiles
        .iter()
        .zip(&places)
        .map(|(profile, places)| Curve { name: &profile.name, values: places })
        .collect();
    write_curves(
        path,
        ("f", &fractions),
        &curves,
        "d from tangent to tangent plane, over the volume fraction f",
    )
}
