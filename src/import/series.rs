//! Which files belong to which time (`.pvd`).

use std::fs;
use std::path::{Path, PathBuf};

use super::error::ImportError;
use crate::tolerance::RANGE;
use crate::whole_file;

const REWRITE: &str = "write the file anew with its own program, as a ParaView collection (.pvd)";

/// A file of a time series.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedFile {
    /// The time.
    pub time: f64,
    /// What the file holds, such as `fields` or `interface`; empty where the series does not say it.
    pub group: String,
    /// The file.
    pub path: PathBuf,
}

impl TimedFile {
    /// Whether the file is there that a series names.
    ///
    /// # Errors
    /// It is not.
    pub(crate) fn check(&self, series: &Path, help: &'static str) -> Result<(), ImportError> {
        fs::metadata(&self.path).map(|_| ()).map_err(|error| {
            let problem = format!("of the time {:?} it names {}: {error}", self.time, self.path.display());
            ImportError::Grid { path: series.to_owned(), problem, help }
        })
    }
}

/// Reads a time series: its files in the order of their times.
///
/// # Errors
/// A file that cannot be read or is no collection, is empty, or has an entry without a file or a time in range.
pub fn read_series(path: impl AsRef<Path>) -> Result<Vec<TimedFile>, ImportError> {
    let path = path.as_ref();
    let mut files = entries(path)?;
    if files.is_empty() {
        let problem = "it names no files".to_owned();
        return Err(ImportError::Grid { path: path.to_owned(), problem, help: REWRITE });
    }
    files.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(files)
}

/// The structured grids (`.vts`, `.vtk`) that a velocity is in: one, or those of a time series (`.pvd`), all of which are there.
///
/// # Errors
/// A series that cannot be read, has no structured grids, whose times do not increase, or of which a file is not there.
pub fn velocity_files(path: impl AsRef<Path>) -> Result<Vec<TimedFile>, ImportError> {
    let path = path.as_ref();
    let has_extension =
        |path: &Path, wanted: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(wanted));
    if !has_extension(path, "pvd") {
        fs::metadata(path).map_err(|error| ImportError::Read { path: path.to_owned(), error })?;
        return Ok(vec![TimedFile { time: 0.0, group: String::new(), path: path.to_owned() }]);
    }
    let wrong =
        |problem: String, help: &'static str| ImportError::Grid { path: path.to_owned(), problem, help };
    let mut files = entries(path)?;
    files.retain(|file| ["vts", "vtk"].iter().any(|wanted| has_extension(&file.path, wanted)));
    if files.is_empty() {
        return Err(wrong(
            "it names no structured grids (.vts or .vtk)".to_owned(),
            "name the files of the velocity in it",
        ));
    }
    for pair in files.windows(2) {
        if !(pair[1].time > pair[0].time) {
            let [a, b] = [&pair[0], &pair[1]].map(|file| (file.path.display(), file.time));
            let problem =
                format!("{} has the time {:?}, which does not follow {:?} of {}", b.0, b.1, a.1, a.0);
            return Err(wrong(problem, "sort its entries by their times, and name one file for each time"));
        }
    }
    let help = "name files that are there; their paths are relative to the folder of the .pvd";
    files.iter().try_for_each(|file| file.check(path, help))?;
    Ok(files)
}

/// The entries of a time series in their own order.
fn entries(path: &Path) -> Result<Vec<TimedFile>, ImportError> {
    let wrong = |problem: String| ImportError::Grid { path: path.to_owned(), problem, help: REWRITE };
    let text = whole_file::text(path).map_err(|error| ImportError::Read { path: path.to_owned(), error })?;
    let xml = roxmltree::Document::parse(&text)
        .map_err(|error| wrong(format!("it is no VTK XML file: {error}")))?;
    let root = xml.root_element();
    let kind = root.attribute("type").unwrap_or("nothing");
    if !root.has_tag_name("VTKFile") || kind != "Collection" {
        return Err(wrong(format!("it holds {kind}, not a Collection")));
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut files = Vec::new();
    for (entry, node) in root.descendants().filter(|node| node.has_tag_name("DataSet")).enumerate() {
        let text = node.attribute("timestep").unwrap_or_default();
        let time = text.trim().parse().ok().filter(|time: &f64| time.is_finite());
        let time =
            time.ok_or_else(|| wrong(format!("entry {entry} has the time \"{text}\", which is no number")))?;
        if time.abs() > *RANGE.end() {
            let most = RANGE.end();
            return Err(wrong(format!(
                "entry {entry} has the time {text}, which is not between -{most:e} and {most:e}"
            )));
        }
        let file = node.attribute("file").filter(|file| !file.is_empty());
        let file = file.ok_or_else(|| wrong(format!("entry {entry} names no file")))?;
        let group = node.attribute("group").unwrap_or_default().to_owned();
        files.push(TimedFile { time, group, path: folder.join(file) });
    }
    Ok(files)
}
