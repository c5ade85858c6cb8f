//! Why a file gives no mesh.

use std::io;
use std::path::PathBuf;

/// Why a file gives no mesh.
#[derive(Debug, thiserror::Error)]
pub enum ImportError {
    /// The file system refused.
    #[error("cannot read {}: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        error: io::Error,
    },
    /// It is no structured grid, or one that cannot be used.
    #[error("{}: {problem}", path.display())]
    Grid {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
        /// What would be right.
        help: &'static str,
    },
    /// An array that cannot be used.
    #[error("{}: the array `{array}` {problem}", path.display())]
    Array {
        /// The file.
        path: PathBuf,
        /// The name of the array.
        array: String,
        /// What is wrong with it.
        problem: String,
        /// What would be right.
        help: &'static str,
    },
    /// A fraction that is none, or a sum of fractions above 1.
    #[error(
        "{}: the array `{array}` has {value:?} in cell {cell:?}{}",
        path.display(),
        if *sum { ", added to the materials before it" } else { ", which is no volume fraction" }
    )]
    Fraction {
        /// The file.
        path: PathBuf,
        /// The name of the array.
        array: String,
        /// The cell's index along each axis, in the order of the file.
        cell: Vec<usize>,
        /// The value, or the sum of those of the materials so far.
        value: f64,
        /// Whether it is a sum.
        sum: bool,
    },
    /// A centroid that is no point of the box around its cell.
    #[error("{}: the array `{array}` {odd}", path.display())]
    Centroid {
        /// The file.
        path: PathBuf,
        /// The name of the array.
        array: String,
        /// What is wrong with it.
        odd: Box<OddCentroid>,
    },
}

/// A centroid that is no point of the box around its cell.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("has {centroid:?} in the mixed cell {cell:?}, which lies between {lower:?} and {upper:?}")]
pub struct OddCentroid {
    /// The cell's index along each axis, in the order of the file.
    pub cell: Vec<usize>,
    /// What is given.
    pub centroid: Vec<f64>,
    /// The lowest corner of the box around the cell.
    pub lower: Vec<f64>,
    /// The highest one.
    pub upper: Vec<f64>,
}

impl ImportError {
    /// What would be right.
    pub fn help(&self) -> &'static str {
        match self {
            Self::Read { error, .. } => match error.kind() {
                io::ErrorKind::NotFound => {
                    "name an existing file; its path is relative to the folder of the scene file"
                }
                io::ErrorKind::PermissionDenied => "change its permissions, or name another file",
                _ => "name a readable file",
            },
            Self::Grid { help, .. } | Self::Array { help, .. } => help,
            Self::Centroid { .. } => {
                "give the middle of what the material has of the cell, in the coordinates of the nodes"
            }
            Self::Fraction { sum: true, .. } => "let the fractions of a cell add up to no more than 1",
            Self::Fraction { .. } => "let every fraction lie between 0 and 1",
        }
    }
}
