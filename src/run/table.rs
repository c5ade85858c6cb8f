//! A table that grows line by line, as comma-separated values.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::folder::PARTIAL;
use crate::export::ExportError;

/// The table while the run goes on. Its name ends in `.partial` until it is finished; without that it is removed.
#[derive(Debug)]
pub(super) struct Table {
    path: PathBuf,
    partial: PathBuf,
    writer: Option<csv::Writer<File>>,
}

impl Table {
    /// Starts a table in a folder.
    pub(super) fn create(
        folder: &Path,
        name: &str,
        header: impl Iterator<Item = String>,
    ) -> Result<Self, ExportError> {
        let path = folder.join(name);
        let partial = folder.join(format!("{name}{PARTIAL}"));
        let file = File::create(&partial).map_err(|error| ExportError::File { path: path.clone(), error })?;
        let mut table = Self { path, partial, writer: Some(csv::Writer::from_writer(file)) };
        table.record(header)?;
        Ok(table)
    }

    /// Goes on with a table that had so many bytes; what came after them is cut off.
    pub(super) fn reopen(folder: &Path, name: &str, length: u64) -> Result<Self, ExportError> {
        let path = folder.join(name);
        let partial = folder.join(format!("{name}{PARTIAL}"));
        let open = || {
            if !partial.exists() {
                // A run that failed completes its tables.
                fs::rename(&path, &partial)?;
            }
            let mut file = OpenOptions::new().write(true).open(&partial)?;
            let found = file.metadata()?.len();
            if found < length {
                return Err(io::Error::other(format!("{found} bytes of {length} are there")));
            }
            file.set_len(length)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        let file = open().map_err(|error| ExportError::File { path: path.clone(), error })?;
        Ok(Self { path, partial, writer: Some(csv::Writer::from_writer(file)) })
    }

    /// How many bytes there are.
    pub(super) fn length(&self) -> Result<u64, ExportError> {
        let length = fs::metadata(&self.partial).map(|metadata| metadata.len());
        length.map_err(|error| ExportError::File { path: self.path.clone(), error })
    }

    /// Leaves the table as it is, to be gone on with.
    pub(super) fn leave(mut self) {
        // Every line is on its way to the disk already.
        self.writer = None;
    }

    /// Adds a line.
    pub(super) fn record(&mut self, fields: impl Iterator<Item = String>) -> Result<(), ExportError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        // Each line goes to the disk, so that one can follow the run, and a full disk shows up.
        let written = writer.write_record(fields).map_err(io::Error::from).and_then(|()| writer.flush());
        written.map_err(|error| ExportError::File { path: self.path.clone(), error })
    }

    /// Gives the table its name.
    pub(super) fn finish(mut self) -> Result<(), ExportError> {
        self.settle().map_err(|error| ExportError::File { path: self.path.clone(), error })
    }

    fn settle(&mut self) -> io::Result<()> {
        let Some(writer) = self.writer.take() else { return Ok(()) };
        let done = writer
            .into_inner()
            .map_err(csv::IntoInnerError::into_error)
            .and_then(|file| file.sync_all())
            .and_then(|()| fs::rename(&self.partial, &self.path));
        if done.is_err() {
            let _ = fs::remove_file(&self.partial);
        }
        done
    }
}

impl Drop for Table {
    fn drop(&mut self) {
        if self.writer.take().is_some() {
            let _ = fs::remove_file(&self.partial);
        }
    }
}
