//! What was computed, and how far it is from reference columns.

use std::collections::BTreeMap;
use std::path::Path;

use vofkit_geometry::{Cell, Hexahedron, Vector};

use super::Task;
use super::columns::{Columns, Given, QUANTITIES, left_empty};
use super::compensated;
use super::evaluate::Values;
use super::input::Input;
pub use super::timing::Timing;
use crate::report::table;

/// Categories that are told apart; what is beyond goes into one.
const CATEGORIES: usize = 200;

/// A corner where the Jacobian determinant is below this, relative to the largest, is inverted: collapsed edges have zero
/// there up to rounding.
const INVERTED: f64 = -1e-12;

/// Heights of a face's nodes over the plane, relative to the largest height of the cell, that are rounding: the face lies in
/// the plane, where there is no section area.
const IN_PLANE: f64 = 8.0 * f64::EPSILON;

/// Errors relative to a reference: the largest, and the root mean square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// How many there are.
    pub count: usize,
    /// The largest; not a number if any is not.
    pub largest: f64,
    squares: f64,
}

impl Errors {
    /// The root mean square.
    pub fn rms(&self) -> f64 {
        (self.squares / self.count as f64).sqrt()
    }

    fn add(&mut self, error: f64) {
        self.count += 1;
        // Keeps what is not a number.
        self.largest = if error <= self.largest { self.largest } else { error };
        self.squares += error * error;
    }

    fn print(&self) -> [String; 2] {
        [self.largest, self.rms()]
            .map(|error| if self.count > 0 { format!("{error:.1e}") } else { "-".into() })
    }
}

/// The errors of a row, in the order of [`Category::errors`].
pub(super) type RowErrors = [Option<f64>; 4];

/// The rows of one category.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Category {
    /// How many there are.
    pub cells: usize,
    /// Errors against reference columns:
    ///
    /// - cell volume and truncated volume, relative to the cell's volume;
    /// - section area, relative to the larger of itself and the power 2/3 of the cell's volume; rows where a whole face
    ///   lies in the plane do not count;
    /// - first moment, relative to the cell's volume times its largest coordinate.
    ///
    /// For a cell with an inverted corner, the volume of the nodes' bounding box stands for that of the cell.
    pub errors: [Errors; 4],
    /// Residuals of plane constants, relative to the cell's volume.
    pub residual: Errors,
    /// Evaluations of all plane constants.
    pub evaluations: f64,
    /// Plane constants in closed form.
    pub closed_form: usize,
}

/// Everything about a table that was computed.
#[derive(Clone, Debug)]
pub struct Account {
    /// What was computed.
    pub task: Task,
    /// All rows.
    pub total: Category,
    /// The rows by category, if the input has a column of that name.
    pub categories: BTreeMap<String, Category>,
    /// How long it takes, if that was asked for and there are cells.
    pub timing: Option<Timing>,
    has_references: bool,
    local: bool,
}

impl Account {
    pub(super) fn new(task: Task, columns: &Columns) -> Self {
        Self {
            task,
            total: Category::default(),
            categories: BTreeMap::new(),
            timing: None,
            has_references: columns.has_references(),
            local: columns.agrees.is_some(),
        }
    }

    pub(super) fn add(&mut self, category: Option<&str>, values: &Values, errors: &RowErrors) {
        self.total.add(values, errors);
        let Some(name) = category else { return };
        let known = self.categories.contains_key(name) || self.categories.len() < CATEGORIES;
        self.categories
            .entry(if known { name } else { "(other categories)" }.to_owned())
            .or_default()
            .add(values, errors);
    }

    /// The account in a few aligned lines.
    pub fn text(&self, output: &Path) -> String {
        let cells = self.total.cells;
        let mut rows = vec![("cells", cells.to_string())];
        if let Some(Timing { cells, build, evaluate, moment }) = self.timing {
            let per_cell = |time: f64, what: &str| format!("{time:.0} ns per cell: {what}");
            rows.push(("build", per_cell(build, "the cell from its nodes")));
            rows.push(match self.task {
                Task::Truncate(_) => {
                    ("truncate", per_cell(evaluate, "what the method gives of volume and section area"))
                }
                Task::Position(_) => ("position", per_cell(evaluate, "the plane constant")),
            });
            if let Some(moment) = moment {
                rows.push(("moment", per_cell(moment, "the first moment")));
            }
            rows.push((
                "timed",
                format!("medians of repeated passes over {cells} of the cells, on one thread"),
            ));
        }
        if self.local {
            rows.push(("plane", "from `local_constant`; `d` agrees with it in every row".to_owned()));
        }
        if matches!(self.task, Task::Position(_)) && cells > 0 {
            let mean = self.total.evaluations / cells as f64;
            rows.push((
                "residual",
                format!("{:.1e} of the cell's volume at most", self.total.residual.largest),
            ));
            rows.push(("evaluations", format!("{mean:.2} on average")));
            rows.push(("closed form", format!("{} of {cells} plane constants", self.total.closed_form)));
        }
        let empty = left_empty(self.task);
        if !empty.is_empty() {
            rows.push(("left empty", format!("{}, which the method does not give", empty.join(", "))));
        }
        let mut text = table::lines(&rows);
        if self.has_references && cells > 0 {
            text.push_str(&self.errors());
        }
        text.push_str(&format!("\nwritten to {}\n", output.display()));
        text
    }

    /// The errors by category as a table.
    fn errors(&self) -> String {
        let position = matches!(self.task, Task::Position(_));
        let mut header =
            vec!["largest and rms error", "cells", "V", "rms", "V_tr", "rms", "A", "rms", "M", "rms"];
        if position {
            header.extend(["residual", "evaluations"]);
        }
        let mut table = vec![header.into_iter().map(str::to_owned).collect::<Vec<_>>()];
        let row = |(name, category): (&str, &Category)| {
            let mut row = vec![name.to_owned(), category.cells.to_string()];
            row.extend(category.errors.iter().flat_map(Errors::print));
            if position {
                let mean = category.evaluations / category.cells.max(1) as f64;
                row.extend([category.residual.print()[0].clone(), format!("{mean:.2}")]);
            }
            row
        };
        let categories = self.categories.iter().map(|(name, category)| (name.as_str(), category));
        table.extend(categories.chain([("all", &self.total)]).map(row));
        format!(
            "\n{}\nV, V_tr: cell and truncated volume, relative to V (inverted cells: to the nodes' bounding box)\n\
             A: section area, relative to max(A, V^(2/3)), where no whole face lies in the plane\n\
             M: first moment, relative to V times the largest coordinate of the nodes\n",
            table::columns(&table)
        )
    }
}

impl Category {
    fn add(&mut self, values: &Values, errors: &RowErrors) {
        self.cells += 1;
        for (sum, error) in self.errors.iter_mut().zip(errors) {
            if let Some(error) = error {
                sum.add(*error);
            }
        }
        if let [Some(residual), Some(evaluations)] = values.numbers[QUANTITIES.len() - 2..] {
            self.residual.add(residual.abs());
            self.evaluations += evaluations;
            self.closed_form += usize::from(values.closed_form);
        }
    }
}

/// How far the numbers of a row are from its references.
pub(super) fn compare(input: &Input, values: &Values) -> RowErrors {
    if input.references.iter().all(Option::is_none) {
        return RowErrors::default();
    }
    let error = |quantity: usize| {
        let (value, reference) = (values.numbers[quantity]?, input.references[quantity]?);
        Some((value - reference).abs())
    };
    let volume = volume_scale(input, values);
    let area = input.references[2].map_or(0.0, f64::abs).max(volume.cbrt().powi(2));
    let far = input.nodes.iter().map(|x| x.amax()).fold(0.0, f64::max);
    let moment = [3, 4, 5].into_iter().filter_map(error).reduce(f64::max);
    [
        relative(error(0), volume),
        relative(error(1), volume),
        relative(error(2).filter(|_| !face_in_plane(input, values)), area),
        relative(moment, volume * far),
    ]
}

fn relative(error: Option<f64>, scale: f64) -> Option<f64> {
    error.map(|error| if error == 0.0 { 0.0 } else { error / scale })
}

/// The volume that errors are relative to.
fn volume_scale(input: &Input, values: &Values) -> f64 {
    let nodes = &input.nodes;
    let cell = Hexahedron::new(*nodes);
    let corner =
        |offset: &[usize; 3]| cell.jacobian_determinant(&Vector::<3>::from_fn(|i, _| offset[i] as f64));
    let (mut lowest, mut highest) = (f64::INFINITY, 0.0_f64);
    for determinant in Hexahedron::OFFSETS.iter().map(corner) {
        lowest = lowest.min(determinant);
        highest = highest.max(determinant.abs());
    }
    if lowest >= INVERTED * highest {
        return input.references[0].or(values.numbers[0]).map_or(0.0, f64::abs);
    }
    let low = nodes.iter().fold(nodes[0], |low, x| low.inf(x));
    let high = nodes.iter().fold(nodes[0], |high, x| high.sup(x));
    (high - low).product()
}

/// Whether a whole face lies in the plane, up to rounding.
fn face_in_plane(input: &Input, values: &Values) -> bool {
    let Input { nodes, normal, .. } = input;
    let local = match input.given {
        Given::Local(local) => local,
        Given::Constant(constant) => compensated::dot_plus(&-normal, &nodes[0], constant),
        Given::Fraction(_) => values.numbers[QUANTITIES.len() - 3].unwrap_or(f64::NAN),
    };
    let over_first = nodes.map(|x| normal.dot(&(x - nodes[0])));
    let largest = over_first.iter().fold(0.0_f64, |largest, height| largest.max(height.abs()));
    let lies = |&node: &usize| (over_first[node] - local).abs() <= IN_PLANE * largest;
    Hexahedron::FACE_NODES.iter().any(|face| face.iter().all(lies))
}
