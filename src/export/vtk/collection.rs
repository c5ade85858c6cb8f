//! Which files belong to which time, as `.pvd`.

use std::io::Write;
use std::path::{Path, PathBuf, absolute};

use super::escaped;
use crate::export::{ExportError, write_file};

/// A time series of VTK files.
///
/// The file is written anew with each time, so that a run that ends early leaves a valid one.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "cli", derive(serde::Deserialize, serde::Serialize))]
pub struct Collection {
    path: PathBuf,
    entries: Vec<Entry>,
}

#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "cli", derive(serde::Deserialize, serde::Serialize))]
struct Entry {
    time: f64,
    group: String,
    part: usize,
    file: String,
}

impl Collection {
    /// An empty series. The file is not touched before the first time is added.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), entries: Vec::new() }
    }

    /// The same series in another place; its files must be there too.
    #[must_use]
    pub fn moved_to(self, path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), ..self }
    }

    /// The `.pvd` file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds the files of one time, each with the name of its group (such as `mesh` or `interface`), and
    /// writes the series.
    ///
    /// # Errors
    /// A file that does not lie in the folder of the series or below it (then nothing is added), and whatever
    /// the file system reports.
    pub fn add(&mut self, time: f64, files: &[(&str, &Path)]) -> Result<(), ExportError> {
        let entry = |(part, &(group, file)): (usize, &(&str, &Path))| {
            Ok(Entry { time, group: group.to_owned(), part, file: self.relative(file)? })
        };
        let entries: Vec<Entry> = files.iter().enumerate().map(entry).collect::<Result<_, ExportError>>()?;
        self.entries.extend(entries);
        write_file(&self.path, |writer| self.write(writer))
    }

    /// The file's name seen from the folder of the series, with slashes.
    fn relative(&self, file: &Path) -> Result<String, ExportError> {
        let outside = || {
            let reason =
                format!("{} is not in the same folder or below it, or is not Unicode", file.display());
            ExportError::data(&self.path, reason)
        };
        let whole = |path: &Path| absolute(path).map_err(|_| outside());
        let [series, file] = [whole(&self.path)?, whole(file)?];
        let folder = series.parent().ok_or_else(outside)?;
        let below = file.strip_prefix(folder).map_err(|_| outside())?;
        let parts: Option<Vec<&str>> = below.iter().map(|part| part.to_str()).collect();
        Ok(parts.ok_or_else(outside)?.join("/"))
    }

    fn write(&self, writer: &mut impl Write) -> std::io::Result<()> {
        writeln!(writer, "<?xml version=\"1.0\"?>")?;
        writeln!(writer, "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">")?;
        writeln!(writer, "  <Collection>")?;
        for Entry { time, group, part, file } in &self.entries {
            let [group, file] = [group, file].map(|text| escaped(text));
            writeln!(
                writer,
                "    <DataSet timestep=\"{time:?}\" group=\"{group}\" part=\"{part}\" file=\"{file}\"/>"
            )?;
        }
        writeln!(writer, "  </Collection>")?;
        writeln!(writer, "</VTKFile>")
    }
}
