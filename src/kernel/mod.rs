//! The kernel in batch: tables of hexahedra and planes in, tables of what the kernel says of them out.
//!
//! - this file: a [`Job`] from one file to the other;
//! - [`error`]: what can be wrong with a table; `columns`: which column is what; `rows`: the table in pieces;
//! - `input`: a row as a cell and a plane; `compensated`: plane constants far from the origin;
//!   `evaluate`: what the kernel says;
//! - [`account`]: errors against reference columns, and everything for the terminal; `timing`: nanoseconds per cell;
//! - [`profile`]: planes that move through cells.
//!
//! **In**: a header and, in any order, the columns `x0, y0, z0, ... x7, y7, z7` (nodes in the order of
//! `VTK_HEXAHEDRON`), `nx, ny, nz` (normal, out of the material, of any length but zero), and
//!
//! - for [`Task::Truncate`]: `d`, the plane constant of `n.x <= d`, or `local_constant`, that relative to the cell's
//!   first node, `d - n.x0`. With both, `local_constant` counts, and `d` must agree with it up to rounding;
//! - for [`Task::Position`]: `f`, the volume fraction below the plane.
//!
//! **Out**: all columns that were there, and `cell_volume`, `truncated_volume`, `section_area`, `moment_x`, `moment_y`,
//! `moment_z`, for positions also `d`, `local_constant`, `residual`, `evaluations`, in the place of columns of the same name
//! or behind the others. Numbers have as many digits as it takes to read the same number back. What a method does
//! not give is left empty.
//!
//! - `section_area` is the area of plane and cell, for normals of any length. Where a whole face lies in the plane it is
//!   finite, but means nothing;
//! - the `moment` is the integral of position, in the coordinates of the table, over the part of the cell below the
//!   plane: moment over truncated volume is the centroid of that part;
//! - for positions, volume, area and moment are those of the plane at `local_constant`, and `residual` is how far `truncated_volume`,
//!   relative to `cell_volume`, is from `f`.
//!
//! Where the input has columns with the names of computed ones, they are references: the account compares with them,
//! by the column `category` if there is one. An empty field or `nan` is no reference.

pub mod account;
mod columns;
mod compensated;
pub mod error;
mod evaluate;
mod input;
pub mod profile;
mod rows;
mod timing;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use vofkit_geometry::{PositionMethod, TruncationMethod};

pub use account::Account;
pub use error::KernelError;

use crate::export::write_file;
use crate::parallel;
use columns::{Columns, Field};
use error::RowError;
use evaluate::{Values, evaluate};
use input::Input;
use rows::Rows;

/// Rows that are in memory at a time.
const CHUNK: usize = 4096;

/// What the kernel is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// What a plane leaves of a cell.
    Truncate(TruncationMethod),
    /// Which plane leaves a given fraction.
    Position(PositionMethod),
}

/// One table to make from another.
#[derive(Clone, Debug)]
pub struct Job {
    /// The table to read.
    pub input: PathBuf,
    /// The table to write.
    pub output: PathBuf,
    /// Whether an existing file may be replaced.
    pub force: bool,
    /// What to compute.
    pub task: Task,
    /// Whether to measure how long it takes.
    pub timed: bool,
}

/// Computes a table. The output file is complete or absent, and does not depend on the number of threads.
///
/// # Errors
/// The first thing that is wrong with the files, their header or a row; see [`KernelError`].
pub fn run(job: &Job) -> Result<Account, KernelError> {
    let mut rows = Rows::open(&job.input)?;
    let columns = Columns::of(rows.header(), job.task)
        .map_err(|problem| KernelError::Columns { path: job.input.clone(), problem })?;
    check_output(&job.input, &job.output, job.force)?;
    let mut account = Account::new(job.task, &columns);
    let mut failure = None;
    let written = write_file(&job.output, |out| {
        fill(job, &mut rows, &columns, &mut account, out).map_err(|stop| match stop {
            Stop::Writing(error) => error,
            Stop::Reading(error) => io::Error::other(failure.insert(error).to_string()),
        })
    });
    match failure {
        Some(error) => Err(error),
        None => Ok(written.map(|()| account)?),
    }
}

/// Refuses an output file that exists, or that would take the place of the input.
fn check_output(input: &Path, output: &Path, force: bool) -> Result<(), KernelError> {
    let refused = |problem, help| Err(KernelError::Output { path: output.to_owned(), problem, help });
    // The place of the file while it is not complete.
    let mut partial = output.to_owned().into_os_string();
    partial.push(".partial");
    let input = fs::canonicalize(input).ok();
    let is_input = |path: &Path| input.is_some() && fs::canonicalize(path).ok() == input;
    if is_input(output) || is_input(Path::new(&partial)) {
        return refused("would take the place of the input file", "choose another one with --out");
    }
    if !force && fs::symlink_metadata(output).is_ok() {
        return refused("exists already", "choose another one with --out, or replace it with --force");
    }
    Ok(())
}

/// Why no more rows are written.
enum Stop {
    Reading(KernelError),
    Writing(io::Error),
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        Self::Writing(error)
    }
}

/// What is known of a row when it has been computed.
struct Outcome {
    values: Values,
    errors: account::RowErrors,
}

fn fill(
    job: &Job,
    rows: &mut Rows,
    columns: &Columns,
    account: &mut Account,
    out: &mut impl Write,
) -> Result<(), Stop> {
    let mut writer = csv::Writer::from_writer(out);
    let error = |error: csv::Error| Stop::Writing(error.into());
    writer.write_record(columns.output_header()).map_err(error)?;
    let mut chunk = Vec::new();
    let mut number = String::new();
    loop {
        let read = rows.fill(&mut chunk, CHUNK);
        if job.timed && account.timing.is_none() {
            account.timing = timing::measure(job.task, &inputs(&chunk, columns));
        }
        let outcomes = parallel::map(chunk.len(), |i| outcome(job.task, &chunk[i], columns));
        for (record, outcome) in chunk.iter().zip(outcomes) {
            let outcome = outcome.map_err(|problem| Stop::Reading(rows.error_at(record, problem)))?;
            account.add(columns.category(record), &outcome.values, &outcome.errors);
            for field in columns.output() {
                let text = match *field {
                    Field::Input(at) => record.get(at).unwrap_or_default(),
                    Field::Computed(quantity) => outcome.values.print(quantity, &mut number),
                };
                writer.write_field(text).map_err(error)?;
            }
            writer.write_record(None::<&[u8]>).map_err(error)?;
        }
        read.map_err(Stop::Reading)?;
        if chunk.len() < CHUNK {
            break;
        }
    }
    Ok(writer.flush()?)
}

fn outcome(task: Task, record: &csv::StringRecord, columns: &Columns) -> Result<Outcome, RowError> {
    let input = Input::parse(record, columns)?;
    let values = evaluate(task, &input)?;
    let errors = account::compare(&input, &values);
    Ok(Outcome { values, errors })
}

/// The cells of a chunk that can be computed.
fn inputs(chunk: &[csv::StringRecord], columns: &Columns) -> Vec<Input> {
    let step = chunk.len().div_ceil(timing::CELLS).max(1);
    chunk.iter().step_by(step).filter_map(|record| Input::parse(record, columns).ok()).collect()
}
