//! The output folder: made late, cleared with care, and gone again if nothing was written.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use super::RunError;
use super::checkpoint::CHECKPOINT;
use super::fields::{FIELD_TABLE, is_field_picture};
use super::history::HISTORY;
use super::output::{FIRST, LAST, POINTS, STATES, picture_file, state_file};

/// The name of the account of a run.
pub(super) const SUMMARY: &str = "summary.json";

/// What the names of files end in until they are complete.
pub(super) const PARTIAL: &str = ".partial";

/// Bytes of a time series within which its first file is named.
const HEAD: u64 = 4096;

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

    /// Makes the folder. An existing one, with `force`, loses the files that runs write, and nothing else.
    pub(super) fn open(path: &Path, force: bool) -> Result<Self, RunError> {
        let mut folder = Self { path: path.to_owned(), made: Vec::new() };
        match folder.make(force) {
            Ok(()) => Ok(folder),
            Err(error) => {
                folder.remove_if_empty();
                Err(error)
            }
        }
    }

    /// The folder of a run that goes on.
    pub(super) fn of_run(path: &Path) -> Self {
        Self { path: path.to_owned(), made: Vec::new() }
    }

    fn make(&mut self, force: bool) -> Result<(), RunError> {
        let path = self.path.clone();
        Self::check(&path, force)?;
        let above = path.ancestors().skip(1).filter(|above| !above.as_os_str().is_empty());
        let missing: Vec<&Path> = above.take_while(|above| !above.exists()).collect();
        for above in missing.into_iter().rev() {
            self.make_one(above)?;
        }
        // With `..` in the path, the folder may be there only now that those above it are.
        Self::check(&path, force)?;
        if path.is_dir() { self.clear() } else { self.make_one(&path) }
    }

    fn make_one(&mut self, path: &Path) -> Result<(), RunError> {
        match fs::create_dir(path) {
            Ok(()) => self.made.push(path.to_owned()),
            Err(_) if path.is_dir() => {}
            Err(error) => return Err(failed(path, &error)),
        }
        Ok(())
    }

    /// The folder.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    fn clear(&self) -> Result<(), RunError> {
        let entries = fs::read_dir(&self.path).map_err(|error| failed(&self.path, &error))?;
        for entry in entries {
            let entry = entry.map_err(|error| failed(&self.path, &error))?;
            let path = entry.path();
            let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
            if is_file && entry.file_name().to_str().is_some_and(|name| is_of_a_run(name, &path)) {
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

/// Whether a run, finished or not, writes files of this name; a time series must have the content of one, too.
fn is_of_a_run(name: &str, path: &Path) -> bool {
    let name = name.strip_suffix(PARTIAL).unwrap_or(name);
    let tables = [SUMMARY, HISTORY, FIELD_TABLE, CHECKPOINT].map(str::to_owned);
    let pictures =
        [FIRST, LAST].into_iter().flat_map(|when| [picture_file::<2>(when), picture_file::<3>(when)]);
    let fixed = tables.into_iter().chain(pictures);
    fixed.into_iter().any(|own| own == name)
        || is_state(name)
        || is_field_picture(name)
        || Path::new(name).extension().is_some_and(|extension| extension == "pvd") && names_states(path)
}

/// Whether it is `fields_0000.vts` or the like, with any number.
fn is_state(name: &str) -> bool {
    STATES.iter().chain([&POINTS]).any(|(stem, extension)| {
        let number = name
            .strip_prefix(stem)
            .and_then(|rest| rest.strip_prefix('_'))
            .and_then(|rest| rest.strip_suffix(extension))
            .and_then(|rest| rest.strip_suffix('.'))
            .and_then(|digits| digits.parse().ok());
        number.is_some_and(|number| state_file(stem, number, extension) == name)
    })
}

/// Whether the first file that a time series names is one of a run.
fn names_states(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD).read_to_end(&mut head));
    let text = String::from_utf8_lossy(&head);
    let first = text.split_once(" file=\"").and_then(|(_, rest)| rest.split_once('"'));
    read.is_ok() && first.is_some_and(|(name, _)| is_state(name))
}

pub(super) fn refused(path: &Path, problem: impl Into<String>, help: impl Into<String>) -> RunError {
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
