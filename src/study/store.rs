//! The results on disk: one line of `results.jsonl` each, as soon as it is there, below a first line that tells of which study they are.

use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::StudyOptions;
use super::file::Study;
use super::measure::Record;
use crate::export::ExportError;
use crate::run::RunError;

/// The name of the file.
pub(super) const LINES: &str = "results.jsonl";

/// What the results belong to: with anything else they would be others.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Head {
    study: String,
    scene: String,
    quick: bool,
    version: String,
}

/// The results so far.
pub(super) struct Store {
    file: File,
    path: std::path::PathBuf,
    records: Vec<Option<Record>>,
}

impl Store {
    /// Makes the folder and the file, or reads the results that are there.
    pub(super) fn open(study: &Study, options: &StudyOptions, count: usize) -> Result<Self, RunError> {
        let folder = &options.folder;
        let path = folder.join(LINES);
        if folder.exists() && !options.resume {
            let help = "choose another one with --out, or go on behind the results in it with --resume";
            return Err(refused(folder, "exists already", help));
        }
        let unusable = |error: std::io::Error| {
            refused(folder, &format!("cannot be used: {error}"), "choose another one with --out")
        };
        let head = Head {
            study: study.text().to_owned(),
            scene: study.subject_text.clone(),
            quick: study.quick,
            version: env!("CARGO_PKG_VERSION").to_owned(),
        };
        let old = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
            Err(error) => return Err(unusable(error)),
        };
        let (records, kept) = kept(&old, &head, count).map_err(|what| {
            let problem = format!("holds the results of another study: {what}");
            refused(folder, &problem, "choose another one with --out")
        })?;
        fs::create_dir_all(folder).map_err(unusable)?;
        let mut file = OpenOptions::new().create(true).append(true).open(&path).map_err(unusable)?;
        // A line that was being written when the study was interrupted goes.
        file.set_len(kept as u64).map_err(unusable)?;
        if kept == 0 {
            write_line(&mut file, &head).map_err(unusable)?;
        }
        Ok(Self { file, path, records })
    }

    pub(super) fn has(&self, number: usize) -> bool {
        self.records[number].is_some()
    }

    /// Keeps a result.
    pub(super) fn add(&mut self, record: Record) -> Result<(), ExportError> {
        write_line(&mut self.file, &record)
            .map_err(|error| ExportError::File { path: self.path.clone(), error })?;
        let number = record.number;
        self.records[number] = Some(record);
        Ok(())
    }

    /// All results, in the order of the plan.
    pub(super) fn records(self) -> Vec<Record> {
        self.records.into_iter().flatten().collect()
    }
}

fn refused(folder: &Path, problem: &str, help: &str) -> RunError {
    RunError::Folder { path: folder.to_owned(), problem: problem.to_owned(), help: help.to_owned() }
}

fn write_line(file: &mut File, value: &impl Serialize) -> std::io::Result<()> {
    let line = serde_json::to_string(value)? + "\n";
    file.write_all(line.as_bytes())
}

/// The results in a text, and the bytes up to the end of the last whole one; what is different if they are of another study.
fn kept(text: &str, head: &Head, count: usize) -> Result<(Vec<Option<Record>>, usize), &'static str> {
    let mut records = vec![None; count];
    let whole = |line: &&str| line.ends_with('\n');
    let mut lines = text.split_inclusive('\n').take_while(whole);
    let Some(first) = lines.next() else { return Ok((records, 0)) };
    let old: Head = serde_json::from_str(first).map_err(|_| "its first line is of no study")?;
    let differences = [
        (old.study != head.study, "the study file has changed"),
        (old.scene != head.scene, "the scene has changed"),
        (old.quick != head.quick, "only one of them is quick"),
        (old.version != head.version, "they are of another version of vofkit"),
    ];
    if let Some((_, what)) = differences.iter().find(|(differs, _)| *differs) {
        return Err(what);
    }
    let mut end = first.len();
    for line in lines {
        let record: Option<Record> = serde_json::from_str(line).ok();
        let Some(record) = record.filter(|record| record.number < count) else { break };
        end += line.len();
        let number = record.number;
        records[number] = Some(record);
    }
    Ok((records, end))
}
