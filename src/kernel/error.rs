//! What can be wrong with a table, and what would be right.

use std::fmt;
use std::io;
use std::path::PathBuf;

use vofkit_geometry::{Defect, PositionError};

use crate::export::ExportError;

/// Why a table was not computed. No output is left on disk.
#[derive(Debug, thiserror::Error)]
pub enum KernelError {
    /// The input cannot be read.
    #[error("cannot read {}: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        error: io::Error,
    },
    /// The header does not fit.
    #[error("{}: {problem}", path.display())]
    Columns {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: ColumnsError,
    },
    /// A row does not fit, or there is no result for it.
    #[error("{}, line {line}: {problem}", path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// The line where the row starts, counted from 1.
        line: u64,
        /// What is wrong with it.
        problem: RowError,
    },
    /// The output file cannot be used.
    #[error("the output file {} {problem}", path.display())]
    Output {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: &'static str,
        /// What would be right.
        help: &'static str,
    },
    /// The output was not written.
    #[error(transparent)]
    Export(#[from] ExportError),
}

impl KernelError {
    /// What would be right.
    pub fn help(&self) -> String {
        match self {
            Self::Read { error, .. } => match error.kind() {
                io::ErrorKind::NotFound => "name an existing file",
                io::ErrorKind::PermissionDenied => "change its permissions, or name another file",
                io::ErrorKind::IsADirectory => "name a file inside the folder",
                _ => "name a readable file",
            }
            .to_owned(),
            Self::Columns { problem, .. } => problem.help(),
            Self::Row { problem, .. } => problem.help(),
            Self::Output { help, .. } => (*help).to_owned(),
            // Says so itself.
            Self::Export(_) => String::new(),
        }
    }
}

/// What is wrong with a header.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ColumnsError {
    /// There is none.
    #[error("the file is empty")]
    Empty,
    /// Columns are not there.
    #[error("missing column{}: {}", if names.len() > 1 { "s" } else { "" }, names.join(", "))]
    Missing {
        /// Their names.
        names: Vec<String>,
        /// What else may be meant.
        hint: Option<&'static str>,
    },
    /// A column is there twice.
    #[error("the column `{name}` is there twice, in the places {} and {}", places[0], places[1])]
    Duplicate {
        /// Its name.
        name: String,
        /// Where, counted from 1.
        places: [usize; 2],
    },
}

impl ColumnsError {
    fn help(&self) -> String {
        let columns =
            "the first line names the columns, with commas between them: x0,y0,z0 to x7,y7,z7, nx,ny,nz";
        match self {
            Self::Empty => format!("{columns}, and d, local_constant or f"),
            Self::Missing { hint, .. } => hint.map_or_else(|| columns.to_owned(), str::to_owned),
            Self::Duplicate { .. } => "remove or rename one of them".to_owned(),
        }
    }
}

/// What is wrong with a row.
#[derive(Clone, Debug, PartialEq)]
pub enum RowError {
    /// Not as many fields as the header.
    Fields {
        /// In the row.
        found: usize,
        /// In the header.
        wanted: usize,
    },
    /// Not UTF-8.
    Encoding,
    /// Far too long, with this limit in bytes.
    Long(usize),
    /// Not a number.
    Number {
        /// The name of the column.
        column: String,
        /// What is there instead.
        text: String,
    },
    /// A number, but not a finite one.
    NotFinite {
        /// The name of the column.
        column: String,
        /// What is there.
        text: String,
    },
    /// The normal is zero.
    Normal,
    /// The two plane constants belong to different planes.
    Constants {
        /// The one in the column `d`.
        constant: f64,
        /// The one that `local_constant` stands for.
        from_local: f64,
    },
    /// A cell that cannot be used.
    Cell(Defect),
    /// More cells than this.
    Many(usize),
    /// There is no plane constant.
    Position(PositionError),
    /// The result is too large for a double.
    Overflow(&'static str),
}

impl fmt::Display for RowError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fields { found, wanted } => write!(f, "{found} fields, the header has {wanted}"),
            Self::Encoding => write!(f, "not UTF-8"),
            Self::Long(limit) => write!(f, "a row of more than {limit} bytes"),
            Self::Number { column, text } => write!(f, "{text:?} in the column `{column}` is not a number"),
            Self::NotFinite { column, text } => {
                write!(f, "{text:?} in the column `{column}` is not a finite number")
            }
            Self::Normal => write!(f, "the normal `nx, ny, nz` is zero"),
            Self::Constants { constant, from_local } => write!(
                f,
                "`d` is {constant:?}, but `local_constant` stands for {from_local:?}: these are different planes"
            ),
            Self::Cell(defect) => write!(f, "a cell that cannot be used: {defect}"),
            Self::Many(most) => write!(f, "more than {most} cells"),
            Self::Position(error) => error.fmt(f),
            Self::Overflow(column) => write!(f, "`{column}` is too large for a double"),
        }
    }
}

impl RowError {
    fn help(&self) -> String {
        let fixed = match self {
            Self::Fields { .. } => "give each row a field for each column; text with commas goes in quotes",
            Self::Encoding => "save the file as UTF-8 text",
            Self::Long(_) => "end each row with a line break, and close every quote",
            Self::Number { .. } => "write numbers such as 0.25 or 2.5e-1",
            Self::NotFinite { .. } => "use finite numbers, of magnitude up to 1.8e308",
            Self::Normal => "give a normal of any other length; it points out of the material",
            Self::Constants { .. } => {
                "remove one of the two columns, or let local_constant = d - n.x0 with the cell's first node x0"
            }
            Self::Cell(_) => {
                "give a simple quadrilateral counter-clockwise, or a hexahedron in the order of VTK_HEXAHEDRON"
            }
            Self::Many(_) => "give fewer cells: a picture of more is of no use",
            Self::Position(PositionError::Fraction(_)) => "let f lie between 0 and 1",
            Self::Position(PositionError::Normal) => "give a finite normal that is not zero",
            Self::Position(PositionError::Volume(_)) => {
                "give cells of positive volume, nodes in the order of VTK_HEXAHEDRON"
            }
            Self::Position(PositionError::NoConvergence { .. }) => {
                "give a cell that is not folded: its truncated volume must grow with the plane constant"
            }
            Self::Overflow(_) => "use a larger unit of length",
        };
        fixed.to_owned()
    }
}
