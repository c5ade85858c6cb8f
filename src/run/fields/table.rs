//! `fields.csv`: the measures of all fields after every step, complete when the run is.

use std::path::Path;

use super::Measure;
use crate::export::ExportError;
use crate::run::table::Table;

/// The name of the table.
pub(in crate::run) const FIELD_TABLE: &str = "fields.csv";

/// The table while the run goes on.
#[derive(Debug)]
pub(in crate::run) struct FieldTable(pub(in crate::run) Table);

impl FieldTable {
    /// Starts a table in a folder.
    pub(in crate::run) fn create<'a>(
        folder: &Path,
        names: impl Iterator<Item = &'a str>,
    ) -> Result<Self, ExportError> {
        let columns = ["amount", "minimum", "maximum", "total_variation", "l1_error"];
        let header = names.flat_map(|name| columns.map(|column| format!("{name}.{column}")));
        let fixed = ["step", "time"].map(str::to_owned);
        Table::create(folder, FIELD_TABLE, fixed.into_iter().chain(header)).map(Self)
    }

    /// Adds a line; errors that are not known are left empty.
    pub(in crate::run) fn add(
        &mut self,
        step: usize,
        time: f64,
        measures: &[Measure],
    ) -> Result<(), ExportError> {
        let of_field = |measure: &Measure| {
            let [low, high] = measure.extremes;
            let amount = measure.amounts.iter().sum::<f64>();
            let known = [amount, low, high, measure.total_variation].map(|number| format!("{number:?}"));
            let error = measure.l1_error.map_or(String::new(), |error| format!("{error:?}"));
            known.into_iter().chain([error])
        };
        let fixed = [step.to_string(), format!("{time:?}")];
        self.0.record(fixed.into_iter().chain(measures.iter().flat_map(of_field)))
    }
}
