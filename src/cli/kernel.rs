//! Tables of cells and planes through the kernel.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use vofkit_geometry::{PositionMethod, TruncationMethod};

use super::terminal::{self, Failure};
use crate::kernel::profile::{ProfileJob, profile};
use crate::kernel::{self, Job, KernelError, Task};
use crate::run::threads::Pool;

/// What to ask the kernel.
#[derive(Debug, Subcommand)]
pub enum Question {
    /// Truncate the hexahedra of a table by planes.
    ///
    /// The table has a header and the columns x0,y0,z0 to x7,y7,z7, nx,ny,nz, and d or local_constant (d relative to the first
    /// node), in any order. The output has all its columns and cell_volume, truncated_volume, section_area, moment_x,
    /// moment_y, moment_z; columns of these names in the input are compared with.
    Truncate {
        /// The files.
        #[command(flatten)]
        files: Files,
        /// How to truncate.
        #[arg(long, value_enum, default_value_t)]
        method: Truncation,
    },
    /// Find the planes below which the hexahedra of a table have given fractions.
    ///
    /// The table is that of `truncate` with a column f in place of d. The output has besides d, local_constant (d relative to the
    /// first node), residual (relative to the cell's volume) and evaluations.
    Position {
        /// The files.
        #[command(flatten)]
        files: Files,
        /// How to find them.
        #[arg(long, value_enum, default_value_t)]
        method: Position,
    },
    /// Let planes move through the cells of a table: which plane constant belongs to which volume fraction.
    ///
    /// The table has the columns x0,y0 to x3,y3 and nx,ny, and for hexahedra z0 to z7, x4,y4 to x7,y7 and nz, which are empty for
    /// quadrilaterals; a column `name` names the curves. The output has name, f, d, s (d between its ends) and section_area; a
    /// picture of s over f is written beside it.
    Profile {
        /// The table to read, with commas between its columns.
        input: PathBuf,
        /// The table to write; the picture has the same name with .svg.
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
        /// Replace existing output files.
        #[arg(long)]
        force: bool,
        /// Print nothing but errors.
        #[arg(long)]
        quiet: bool,
    },
}

/// From where, to where and how.
#[derive(Debug, Args)]
pub struct Files {
    /// The table to read, with commas between its columns.
    pub input: PathBuf,
    /// The table to write.
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Replace an existing output file.
    #[arg(long)]
    pub force: bool,
    /// Share the work among N threads, one per processor unless it is given; the results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print nothing but errors, and measure nothing.
    #[arg(long)]
    pub quiet: bool,
}

/// Ways to truncate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Truncation {
    /// Ruled faces, exact in every case.
    #[default]
    Exact,
    /// Ruled faces by Kothe's formula with a fall-back; volumes alone.
    Kothe,
    /// Two planar triangles a face; no moments.
    Submesh2,
    /// Four planar triangles a face; no moments.
    Submesh4,
}

/// Ways to find a plane constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Position {
    /// In closed form for parallelepipeds, else by Newton's method.
    #[default]
    Auto,
    /// Newton's method, inside a bracket.
    Newton,
    /// Brent's method.
    Brent,
}

impl From<Truncation> for TruncationMethod {
    fn from(method: Truncation) -> Self {
        match method {
            Truncation::Exact => Self::Exact,
            Truncation::Kothe => Self::Kothe,
            Truncation::Submesh2 => Self::Submesh2,
            Truncation::Submesh4 => Self::Submesh4,
        }
    }
}

impl From<Position> for PositionMethod {
    fn from(method: Position) -> Self {
        match method {
            Position::Auto => Self::Auto,
            Position::Newton => Self::Newton,
            Position::Brent => Self::Brent,
        }
    }
}

impl From<KernelError> for Failure {
    fn from(error: KernelError) -> Self {
        Self::other(error.to_string(), error.help())
    }
}

/// Computes a table and prints the account.
///
/// # Errors
/// See [`kernel::run`].
pub fn ask(question: Question) -> Result<(), Failure> {
    let (files, task) = match question {
        Question::Truncate { files, method } => (files, Task::Truncate(method.into())),
        Question::Position { files, method } => (files, Task::Position(method.into())),
        Question::Profile { input, out, force, quiet } => {
            let (profiles, written) = profile(&ProfileJob { input, output: out, force })?;
            let files =
                written.iter().map(|file| file.display().to_string()).collect::<Vec<_>>().join(" and ");
            let text = format!("the profiles of {} cells written to {files}\n", profiles.len());
            return if quiet { Ok(()) } else { terminal::print(&text) };
        }
    };
    let Files { input, out, force, threads, quiet } = files;
    let job = Job { input, output: out, force, task, timed: !quiet };
    let account = Pool::new(threads)?.install(|| kernel::run(&job))?;
    if quiet { Ok(()) } else { terminal::print(&account.text(&job.output)) }
}
