//! `history.csv`: one line per step, complete when the run is.

use std::path::Path;

use super::table::Table;
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
    /// The largest correction of a fraction, and its cell; none where nothing was corrected.
    pub(super) largest: Option<(f64, usize)>,
    /// By material: volume, smallest and largest fraction before correction, volume clipped and rescaled.
    pub(super) materials: Vec<[f64; 5]>,
}

/// The table while the run goes on.
#[derive(Debug)]
pub(super) struct History(pub(super) Table);

impl History {
    /// Starts a table in a folder, with the line for the start.
    pub(super) fn create(folder: &Path, materials: &[String], first: &Line) -> Result<Self, ExportError> {
        let fixed = ["step", "time", "dt", "courant", "mixed_cells", "largest_correction", "largest_in_cell"]
            .map(str::to_owned);
        let columns = ["volume", "min", "max", "clipped", "rescaled"];
        let of_material = |name: &String| columns.map(|column| format!("{name}.{column}"));
        let header = fixed.into_iter().chain(materials.iter().flat_map(of_material));
        let mut history = Self(Table::create(folder, HISTORY, header)?);
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
            number(&line.largest.map_or(0.0, |(fraction, _)| fraction)),
            line.largest.map_or_else(String::new, |(_, cell)| cell.to_string()),
        ];
        self.0.record(fixed.into_iter().chain(line.materials.iter().flatten().map(number)))
    }
}
