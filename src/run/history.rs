//! `history.csv`: one line per step, complete when the run is.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use crate::export::ExportError;

/// The name of the table.
pub(super) const HISTORY: &str = "history.csv";

/// One line of the table.
#[derive(Clone, Debug)]
pub(super) struct Line {
    pub(super) step: usize,
    pub(super) time: f64,
    pub(super) dt: f64,
    pub(super) courant: f64,
    pub(super) mixed_cells: usize,
    /// By material: volume, smallest and largest fraction before correction, volume clipped and rescaled.
    pub(super) materials: Vec<[f64; 5]>,
}

/// The table while the run goes on. Its name ends in `.partial` until it is finished; without that it is removed.
#[derive(Debug)]
pub(super) struct History {
    path: PathBuf,
    partial: PathBuf,
    writer: Option<csv::Writer<File>>,
}

impl History {
    /// Starts a table in a folder, with the line for the start.
    pub(super) fn create(folder: &Path, materials: &[String], first: &Line) -> Result<Self, ExportError> {
        let path = folder.join(HISTORY);
        let partial = folder.join(format!("{HISTORY}.partial"));
        let file = File::create(&partial).map_err(|error| ExportError::File { path: path.clone(), error })?;
        let mut history = Self { path, partial, writer: Some(csv::Writer::from_writer(file)) };
        let fixed = ["step", "time", "dt", "courant", "mixed_cells"].map(str::to_owned);
        let columns = ["volume", "min", "max", "clipped", "rescaled"];
        let of_material = |name: &String| columns.map(|column| format!("{name}.{column}"));
        history.record(fixed.into_iter().chain(materials.iter().flat_map(of_material)))?;
        history.add(first)?;
        Ok(history)
    }

    /// Adds a line. Numbers are written with as many digits as it takes to read the same number back.
    pub(super) fn add(&mut self, line: &Line) -> Result<(), ExportError> {
        let number = |value: &f64| format!("{value:?}");
        let fixed = [
            line.step.to_string(),
            number(&line.time),
            number(&line.dt),
            number(&line.courant),
            line.mixed_cells.to_string(),
        ];
        self.record(fixed.into_iter().chain(line.materials.iter().flatten().map(number)))
    }

    /// Gives the table its name.
    pub(super) fn finish(mut self) -> Result<(), ExportError> {
        self.settle().map_err(|error| ExportError::File { path: self.path.clone(), error })
    }

    fn record(&mut self, fields: impl Iterator<Item = String>) -> Result<(), ExportError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        // Each line goes to the disk, so that one can follow the run, and a full disk shows up.
        let written = writer.write_record(fields).map_err(io::Error::from).and_then(|()| writer.flush());
        written.map_err(|error| ExportError::File { path: self.path.clone(), error })
    }

    fn settle(&mut self) -> io::Result<()> {
        let Some(writer) = self.writer.take() else { return Ok(()) };
        let done = writer
            .into_inner()
            .map_err(csv::IntoInnerError::into_error)
            .and_then(|file| file.sync_all())
            .and_then(|()| fs::rename(&self.partial, &self.path));
        if done.is_err() {
            let _ = fs::remove_file(&self.partial);
        }
        done
    }
}

impl Drop for History {
    fn drop(&mut self) {
        if self.writer.take().is_some() {
            let _ = fs::remove_file(&self.partial);
        }
    }
}
