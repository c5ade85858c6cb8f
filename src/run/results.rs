//! States of a run, read back from its output folder.

use std::fs;
use std::path::{Path, PathBuf};

use vofkit_geometry::Cell;

use super::RunError;
use super::folder::refused;
use super::moment::Moment;
use crate::import::{ImportError, StructuredGrid, TimedFile, read_facets, read_series};
use crate::mesh::{Grid, Mesh};

/// What a run left in its output folder.
#[derive(Clone, Debug)]
pub struct Results {
    folder: PathBuf,
    series: PathBuf,
    /// One at least, in the order of their times.
    files: Vec<TimedFile>,
}

/// A state whose mesh was read, and whose dimension is known.
#[derive(Clone, Debug)]
pub struct Stored {
    time: f64,
    grid: StructuredGrid,
    interface: PathBuf,
}

impl Results {
    /// Finds the results of a folder.
    ///
    /// # Errors
    /// A folder without results, or with those of several runs.
    pub fn open(folder: &Path) -> Result<Self, RunError> {
        let series = series(folder)?;
        let files = read_series(&series)?;
        Ok(Self { folder: folder.to_owned(), series, files })
    }

    /// The name of the scene.
    pub fn name(&self) -> String {
        self.series.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    }

    /// The times of the states, in order.
    pub fn times(&self) -> Vec<f64> {
        let mut times: Vec<f64> = self.files.iter().map(|file| file.time).collect();
        times.dedup();
        times
    }

    /// Opens the state that is nearest to a time, or the last one.
    ///
    /// # Errors
    /// A time before the first or after the last state, a state without interface or fields, and files that cannot be read.
    pub fn state(&self, time: Option<f64>) -> Result<Stored, RunError> {
        let Self { folder, series, files } = self;
        let [first, last] = [0, files.len() - 1].map(|at| files[at].time);
        let wanted = time.unwrap_or(last);
        if !(first <= wanted && wanted <= last) {
            let problem = format!("has nothing of time {wanted}: its states go from {first} to {last}");
            return Err(refused(
                folder,
                problem,
                "give a time in between, or leave it out for the last state",
            ));
        }
        let nearest = files.iter().map(|file| file.time).fold(first, |nearest, time| {
            if (time - wanted).abs() < (nearest - wanted).abs() { time } else { nearest }
        });
        let file = |group: &str, setting: &str| {
            let found = |file: &&TimedFile| file.time == nearest && file.group == group;
            let file = files.iter().find(found).ok_or_else(|| {
                let name = series.display();
                let problem = format!("has no {group} at time {nearest}: there are none in {name}");
                refused(folder, problem, format!("run the scene again with {setting} in its [output]"))
            })?;
            file.check(series, "put it back, or run the scene again")?;
            Ok::<_, RunError>(file.path.clone())
        };
        let interface = file("interface", "interface = [\"vtk\"]")?;
        let grid = StructuredGrid::read(file("fields", "fields = true")?)?;
        Ok(Stored { time: nearest, grid, interface })
    }
}

impl Stored {
    /// 2 or 3.
    pub fn dimension(&self) -> usize {
        self.grid.dimension()
    }

    /// The state, in its dimension.
    ///
    /// # Errors
    /// Files that cannot be read, or do not fit together.
    pub fn moment<C: Cell<D>, const D: usize>(&self) -> Result<Moment<C, D>, RunError> {
        let grid = &self.grid;
        let mesh = Mesh::<C, D>::from_nodes(Grid::new(grid.cells(), [false; D]), grid.nodes());
        let mesh = mesh.map_err(|error| ImportError::Grid {
            path: grid.path().to_owned(),
            problem: error.to_string(),
            help: "run the scene again",
        })?;
        let names: Vec<String> = grid.materials().map(str::to_owned).collect();
        let fractions = names.iter().map(|name| grid.fractions(name).map(<[f64]>::to_vec));
        let fractions = fractions.collect::<Result<_, ImportError>>()?;
        let facets = read_facets(&self.interface)?;
        Ok(Moment { time: self.time, mesh, names, fractions, facets })
    }
}

/// The time series of a run in a folder.
fn series(folder: &Path) -> Result<PathBuf, RunError> {
    let failed =
        |error: std::io::Error| refused(folder, format!("cannot be read: {error}"), "name another one");
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|extension| extension == "pvd") {
            found.push(path);
        }
    }
    match found.as_slice() {
        [series] => Ok(series.clone()),
        [] => Err(refused(
            folder,
            "has no time series (.pvd), which runs write with their fields and interfaces",
            "run the scene with interface = [\"vtk\"] and fields = true in its [output], or draw the scene itself",
        )),
        more => Err(refused(
            folder,
            format!("has {} time series (.pvd), not one", more.len()),
            "leave only that of the run to be drawn",
        )),
    }
}
