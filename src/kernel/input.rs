//! A row as a cell and a plane.

use csv::StringRecord;
use vofkit_geometry::Vector;

use super::columns::{Columns, Given, OF_ALL_TASKS};
use super::compensated;
use super::error::RowError;

/// Characters of a wrong field that are shown.
const SHOWN: usize = 40;

/// A cell, a normal, and a plane or a fraction.
#[derive(Clone, Debug)]
pub(super) struct Input {
    pub(super) nodes: [Vector<3>; 8],
    pub(super) normal: Vector<3>,
    pub(super) given: Given<f64>,
    pub(super) references: [Option<f64>; OF_ALL_TASKS],
}

impl Input {
    /// Reads a row.
    pub(super) fn parse(record: &StringRecord, columns: &Columns) -> Result<Self, RowError> {
        if record.len() != columns.count {
            return Err(RowError::Fields { found: record.len(), wanted: columns.count });
        }
        let number = |at: usize| field_number(record, columns, at);
        let mut values = [0.0; 27];
        for (value, &at) in values.iter_mut().zip(&columns.cell) {
            *value = number(at)?;
        }
        let vector = |i: usize| Vector::<3>::new(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
        let (nodes, normal): ([_; 8], _) = (std::array::from_fn(vector), vector(8));
        if normal == Vector::<3>::zeros() {
            return Err(RowError::Normal);
        }
        let given = match columns.given {
            Given::Constant(at) => Given::Constant(number(at)?),
            Given::Local(at) => Given::Local(number(at)?),
            Given::Fraction(at) => Given::Fraction(number(at)?),
        };
        if let (Given::Local(local), Some(at)) = (given, columns.agrees) {
            let (constant, from_local) = (number(at)?, compensated::dot_plus(&normal, &nodes[0], local));
            if !((constant - from_local).abs() <= compensated::rounding(&normal, &nodes[0], local)) {
                return Err(RowError::Constants { constant, from_local });
            }
        }
        let mut references = [None; OF_ALL_TASKS];
        for (reference, at) in references.iter_mut().zip(columns.references) {
            *reference = at.map_or(Ok(None), |at| reference_number(record, columns, at))?;
        }
        Ok(Self { nodes, normal, given, references })
    }
}

fn field_number(record: &StringRecord, columns: &Columns, at: usize) -> Result<f64, RowError> {
    number(record.get(at).unwrap_or_default().trim(), columns.name(at))
}

/// The finite number in a field of a column.
pub(super) fn number(field: &str, column: &str) -> Result<f64, RowError> {
    let wrong = || (column.to_owned(), field.chars().take(SHOWN).collect());
    match field.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => {
            let (column, text) = wrong();
            Err(RowError::NotFinite { column, text })
        }
        Err(_) => {
            let (column, text) = wrong();
            Err(RowError::Number { column, text })
        }
    }
}

/// A number to compare with, if there is one.
fn reference_number(record: &StringRecord, columns: &Columns, at: usize) -> Result<Option<f64>, RowError> {
    let field = record.get(at).unwrap_or_default().trim();
    if field.is_empty() || field.eq_ignore_ascii_case("nan") {
        return Ok(None);
    }
    field_number(record, columns, at).map(Some)
}
