//! Files that are complete or absent.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::ExportError;

/// Bytes collected before they go to the file system.
const BUFFER: usize = 1 << 16;

/// Writes a file through `content`, all of it or nothing.
///
/// The content goes to `NAME.partial` in the same folder, which takes the place of `NAME` only when every
/// byte is on the disk. After a failure the partial file is removed, and a file that was there before stays
/// as it was.
///
/// # Errors
/// Whatever the file system or `content` reports, and names of folders and devices.
pub fn write_file(
    path: impl AsRef<Path>,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), ExportError> {
    let path = path.as_ref();
    replace(path, content).map_err(|error| ExportError::File { path: path.to_owned(), error })
}

fn replace(path: &Path, content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let Some(name) = path.file_name() else {
        return Err(io::Error::new(io::ErrorKind::InvalidFilename, "the path has no file name"));
    };
    match fs::metadata(path) {
        Ok(there) if there.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        // Renaming over a device would put a file in its place.
        Ok(there) if !there.is_file() => return Err(io::Error::other("not a regular file")),
        _ => {}
    }
    let mut partial = name.to_owned();
    partial.push(".partial");
    let partial = path.with_file_name(partial);
    let written = fill(&partial, content).and_then(|()| fs::rename(&partial, path));
    if written.is_err() {
        // The first error is the one to report.
        let _ = fs::remove_file(&partial);
    }
    written
}

fn fill(path: &Path, content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::with_capacity(BUFFER, File::create(path)?);
    content(&mut writer)?;
    writer.flush()?;
    // Some file systems report a lack of space only here.
    writer.get_ref().sync_all()
}
