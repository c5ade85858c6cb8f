//! What a run leaves on disk for viewers and other programs.
//!
//! - `file`: every file is complete or absent; all exporters write through [`write_file`];
//! - `vtk` (feature `vtk`): meshes with fields (`.vts`), interfaces (`.vtp`) and time series (`.pvd`);
//! - `obj` (feature `obj`): interfaces as triangulated Wavefront OBJ, by way of `triangulation`;
//! - `picture` (feature `plot`): a [`Snapshot`] of mesh, fractions and interfaces as SVG or PNG; `plot`: curves and maps as SVG;
//!   `palette`: the colours of all of them.
//!
//! Values that are not finite are written as they are; names may hold anything.

use std::io;
use std::path::{Path, PathBuf};

mod file;
#[cfg(feature = "obj")]
pub mod obj;
#[cfg(feature = "plot")]
pub(crate) mod palette;
#[cfg(feature = "plot")]
pub mod picture;
#[cfg(feature = "plot")]
pub mod plot;
mod snapshot;
#[cfg(any(feature = "obj", feature = "plot"))]
mod triangulation;
#[cfg(feature = "vtk")]
pub mod vtk;

pub use file::write_file;
pub use snapshot::Snapshot;

/// Why a file was not written. Nothing of it is left on disk, and an older file of that name is untouched.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The file system refused.
    #[error("cannot write {}: {error}; {}", path.display(), self.help())]
    File {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        error: io::Error,
    },
    /// The data do not fit together, or the file cannot hold them.
    #[error("cannot write {}: {reason}", path.display())]
    Data {
        /// The file.
        path: PathBuf,
        /// What does not fit, with its numbers.
        reason: String,
    },
}

impl ExportError {
    /// The file that was not written.
    pub fn path(&self) -> &Path {
        match self {
            Self::File { path, .. } | Self::Data { path, .. } => path,
        }
    }

    /// What would help.
    pub fn help(&self) -> &'static str {
        let Self::File { error, .. } = self else { return "correct the data that are passed in" };
        match error.kind() {
            io::ErrorKind::StorageFull => {
                "the disk is full: free space on it, write elsewhere or write less often"
            }
            io::ErrorKind::QuotaExceeded => "your quota is used up: delete files or write elsewhere",
            io::ErrorKind::FileTooLarge => "the file system cannot hold a file of this size: write elsewhere",
            io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only: write elsewhere",
            io::ErrorKind::PermissionDenied => {
                "you may not write there: change the permissions or write elsewhere"
            }
            io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => "create the folder first",
            io::ErrorKind::IsADirectory => "a folder has this name: choose another one",
            io::ErrorKind::InvalidFilename => "choose a shorter or simpler name",
            _ => "check the disk or write elsewhere",
        }
    }

    #[cfg(any(feature = "obj", feature = "plot", feature = "vtk"))]
    fn data(path: &Path, reason: String) -> Self {
        Self::Data { path: path.to_owned(), reason }
    }
}

/// Refuses facets whose material has no name.
#[cfg(any(feature = "obj", feature = "plot"))]
fn check_materials<const D: usize>(
    path: &Path,
    names: &[String],
    facets: &[crate::facet::Facet<D>],
) -> Result<(), ExportError> {
    match facets.iter().find(|facet| facet.material >= names.len()) {
        None => Ok(()),
        Some(facet) => Err(ExportError::data(
            path,
            format!(
                "the interface in cell {} is of material {}, but {} names are given",
                facet.cell,
                facet.material,
                names.len()
            ),
        )),
    }
}

/// Refuses an array that does not have one value per cell.
#[cfg(any(feature = "plot", feature = "vtk"))]
fn check_length(path: &Path, name: &str, found: usize, cells: usize) -> Result<(), ExportError> {
    if found == cells {
        return Ok(());
    }
    Err(ExportError::data(path, format!("`{name}` has {found} values, the mesh has {cells} cells")))
}

/// The text with a blank for every character that XML forbids or that would break a line.
#[cfg(any(feature = "plot", feature = "vtk"))]
pub(crate) fn printable(text: &str) -> String {
    let forbidden = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars().map(|c| if forbidden(c) { ' ' } else { c }).collect()
}
