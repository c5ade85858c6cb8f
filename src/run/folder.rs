//! The output folder: made late, cleared with care, and gone again if nothing was written.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Component, Path, PathBuf};

use super::RunError;

/// The name of the account of a run.
pub(super) const SUMMARY: &str = "summary.json";

/// An output folder, and which folders were made for it.
#[derive(Debug)]
pub(super) struct Folder {
    path: PathBuf,
    made: Vec<PathBuf>,
}

impl Folder {
    /// Whether the folder could be used; nothing is changed.
    pub(super) fn check(path: &Path, force: bool) -> Result<(), RunError> {
        match fs::metadata(path) {
            Ok(there) if !there.is_dir() => {
                Err(refused(path, "is there, but is not a folder", "choose another one with --out"))
            }
            Ok(_) if !force => Err(refused(
                path,
                "exists already",
                "choose another one with --out, or replace the results in it with --force",
            )),
            Ok(_) => Ok(()),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            Err(error) => Err(failed(path, &error)),
        }
    }

    /// Makes the folder. An existing one, with `force`, loses the files that its summary lists, and nothing else.
    pub(super) fn open(path: &Path, force: bool) -> Result<Self, RunError> {
        Self::check(path, force)?;
        let mut folder = Self { path: path.to_owned(), made: Vec::new() };
        if path.is_dir() {
            folder.clear()?;
            return Ok(folder);
        }
        let missing: Vec<&Path> =
            path.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists()).collect();
        for path in missing.into_iter().rev() {
            if let Err(error) = fs::create_dir(path) {
                folder.remove_if_empty();
                return Err(failed(path, &error));
            }
            folder.made.push(path.to_owned());
        }
        Ok(folder)
    }

    /// The folder.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    fn clear(&self) -> Result<(), RunError> {
        let Ok(text) = fs::read(self.path.join(SUMMARY)) else { return Ok(()) };
        let Ok(summary) = serde_json::from_slice::<serde_json::Value>(&text) else { return Ok(()) };
        let listed = summary["files"].as_array().into_iter().flatten().filter_map(|name| name.as_str());
        for name in listed.filter(|name| is_plain(name)) {
            let path = self.path.join(name);
            if fs::symlink_metadata(&path).is_ok_and(|there| there.is_file()) {
                fs::remove_file(&path).map_err(|error| failed(&path, &error))?;
            }
        }
        Ok(())
    }

    /// Removes the folders that were made, as far as they are empty.
    pub(super) fn remove_if_empty(&self) {
        for path in self.made.iter().rev() {
            if fs::remove_dir(path).is_err() {
                return;
            }
        }
    }
}

/// Whether it is the name of a file and not a path.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    matches!((parts.next(), parts.next()), (Some(Component::Normal(part)), None) if part == name)
}

fn refused(path: &Path, problem: impl Into<String>, help: impl Into<String>) -> RunError {
    RunError::Folder { path: path.to_owned(), problem: problem.into(), help: help.into() }
}

fn failed(path: &Path, error: &io::Error) -> RunError {
    let help = match error.kind() {
        ErrorKind::StorageFull => "the disk is full: free space on it, or write elsewhere with --out",
        ErrorKind::ReadOnlyFilesystem => "the file system is read-only: write elsewhere with --out",
        ErrorKind::PermissionDenied => {
            "you may not write there: change the permissions or write elsewhere with --out"
        }
        _ => "write elsewhere with --out",
    };
    refused(path, format!("cannot be used: {error}"), help)
}
