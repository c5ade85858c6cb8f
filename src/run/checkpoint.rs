//! The state of a run between two steps, on disk, so that the run can go on from there to the same bits.
//!
//! A checkpoint holds the scene as text and everything that changes from step to step; the rest follows from the scene. The numbers
//! are stored as they are. The file is complete or absent, and ends with a check sum.

use std::borrow::Cow;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf, absolute};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use super::RunError;
use super::fields::{FIELD_TABLE, FieldValues};
use super::folder::PARTIAL;
use super::history::HISTORY;
use super::output::Written;
use super::quantities::QuantityValues;
use super::tally::Tally;
use crate::export::{ExportError, write_file};
use crate::scene::{Resolved, Scene, SceneError};

/// The name of a checkpoint.
pub(super) const CHECKPOINT: &str = "checkpoint.bin";

/// What a checkpoint starts with. What is stored depends on the version and on what it can write.
const START: &str = match cfg!(feature = "vtk") {
    true => concat!("vofkit checkpoint of version ", env!("CARGO_PKG_VERSION"), " with VTK files\n"),
    false => concat!("vofkit checkpoint of version ", env!("CARGO_PKG_VERSION"), "\n"),
};

/// Why a checkpoint may not fit its own scene.
const CHANGED: &str = "the files that the scene names have changed: run it anew";

/// When to write checkpoints; by default never.
#[derive(Clone, Debug, Default)]
pub struct Checkpoints {
    /// After every so many steps; 0 for none.
    pub every: usize,
    /// Set from outside, it makes a run write a checkpoint after the step at hand and stop.
    pub stop: Option<Arc<AtomicBool>>,
}

impl Checkpoints {
    pub(super) fn is_stopped(&self) -> bool {
        self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Whether one is due after a number of steps.
    pub(super) fn includes(&self, step: usize) -> bool {
        self.every > 0 && step.is_multiple_of(self.every)
    }
}

/// Where a run stands between two steps.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct State<'a> {
    /// The [check sum](super::inputs::inputs) of what the files of the scene gave.
    pub(super) inputs: u64,
    pub(super) step: usize,
    pub(super) substeps: usize,
    pub(super) fractions: Cow<'a, [Vec<f64>]>,
    pub(super) fields: FieldValues<'a>,
    pub(super) quantities: QuantityValues<'a>,
    pub(super) tally: Cow<'a, Tally>,
    pub(super) written: Written,
    /// Bytes of the tables so far.
    pub(super) history: Option<u64>,
    pub(super) field_table: Option<u64>,
}

/// A checkpoint that was read.
#[derive(Clone, Debug)]
pub struct Checkpoint {
    path: PathBuf,
    text: SceneText<'static>,
    pub(super) state: State<'static>,
}

/// The scene of a run.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct SceneText<'a> {
    name: Cow<'a, str>,
    /// Other files are named relative to this one.
    file: PathBuf,
    text: Cow<'a, str>,
}

/// Adds up what goes through it (FNV-1a, by Fowler, Noll and Vo).
struct Summed<W> {
    inner: W,
    sum: u64,
}

impl<W> Summed<W> {
    fn new(inner: W) -> Self {
        Self { inner, sum: 0xcbf2_9ce4_8422_2325 }
    }
}

impl<W> Summed<W> {
    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.sum = (self.sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}

/// The check sum of numbers.
pub(super) fn sum(numbers: impl Iterator<Item = f64>) -> u64 {
    let mut summed = Summed::new(());
    numbers.for_each(|number| summed.add(&number.to_le_bytes()));
    summed.sum
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.inner.write(bytes)?;
        self.add(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// Writes a checkpoint in the place of the one before.
pub(super) fn write<const D: usize>(
    folder: &Path,
    scene: &Resolved<D>,
    state: &State<'_>,
) -> Result<(), ExportError> {
    let (file, text) = scene.text();
    let text = SceneText {
        name: Cow::Borrowed(&scene.name),
        file: absolute(file).unwrap_or_else(|_| file.into()),
        text: Cow::Borrowed(text),
    };
    write_file(folder.join(CHECKPOINT), |writer| {
        writer.write_all(START.as_bytes())?;
        let summed = postcard::to_io(&(&text, state), Summed::new(&mut *writer)).map_err(io::Error::other)?;
        let sum = summed.sum;
        writer.write_all(&sum.to_le_bytes())
    })
}

/// Removes the checkpoint of a run that is complete.
pub(super) fn remove(folder: &Path) -> Result<(), ExportError> {
    let path = folder.join(CHECKPOINT);
    match fs::remove_file(&path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(ExportError::File { path, error }),
        _ => Ok(()),
    }
}

impl Checkpoint {
    /// Reads the checkpoint of a run from its output folder.
    ///
    /// # Errors
    /// None there, or a file that is damaged or none of this version.
    pub fn read(folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(CHECKPOINT);
        let refused =
            |problem: String, help: &'static str| RunError::Checkpoint { path: path.clone(), problem, help };
        let bytes = fs::read(&path).map_err(|error| {
            refused(
                format!("cannot be read: {error}"),
                "name the output folder of a run that wrote checkpoints and is not complete",
            )
        })?;
        let Some(content) = bytes.strip_prefix(START.as_bytes()) else {
            let help = "go on with the version of vofkit that wrote it, or run the scene anew";
            return Err(refused(format!("does not start with \"{}\"", START.trim()), help));
        };
        let anew = "run the scene anew";
        let Some((content, sum)) = content.split_last_chunk() else {
            return Err(refused("is damaged: it ends too early".to_owned(), anew));
        };
        let mut summed = Summed::new(());
        summed.add(content);
        if summed.sum != u64::from_le_bytes(*sum) {
            return Err(refused("is damaged: its check sum is wrong".to_owned(), anew));
        }
        let (text, state) = postcard::from_bytes(content)
            .map_err(|error| refused(format!("cannot be understood: {error}"), anew))?;
        Ok(Self { path, text, state })
    }

    /// The scene of the run.
    ///
    /// # Errors
    /// Files that the scene names and that are not there any more.
    pub fn scene(&self) -> Result<Scene, SceneError> {
        let SceneText { name, file, text } = &self.text;
        Scene::parse(&file.display().to_string(), name, text, &[])
    }

    /// The folder of the run.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// Values that are not those of the scene's fields.
    pub(super) fn refusal(&self) -> RunError {
        let (path, problem) = (self.path.clone(), "has other fields than the scene".to_owned());
        RunError::Checkpoint { path, problem, help: CHANGED }
    }

    /// Whether the state belongs to a mesh of so many cells, as many materials, and files with this [check sum](super::inputs::inputs),
    /// and whether what the run wrote is there.
    ///
    /// # Errors
    /// It does not: files that the scene names have changed. Or a file of the run is missing.
    pub(super) fn check(
        &self,
        cells: usize,
        materials: usize,
        steps: usize,
        inputs: u64,
    ) -> Result<(), RunError> {
        let State { step, fractions, .. } = &self.state;
        let fits =
            fractions.len() == materials && fractions.iter().all(|f| f.len() == cells) && *step <= steps;
        if fits && inputs == self.state.inputs {
            return self.check_files();
        }
        if fits {
            let problem =
                "belongs to other nodes, fractions, bodies or velocities than the files of the scene have"
                    .to_owned();
            return Err(RunError::Checkpoint { path: self.path.clone(), problem, help: CHANGED });
        }
        let found = fractions.first().map_or(0, Vec::len);
        let problem = format!(
            "has {} materials in {found} cells after {step} steps, the scene {materials} in {cells} and {steps} steps",
            fractions.len()
        );
        Err(RunError::Checkpoint { path: self.path.clone(), problem, help: CHANGED })
    }

    /// Whether the files that the run wrote are there.
    fn check_files(&self) -> Result<(), RunError> {
        let State { written, history, field_table, .. } = &self.state;
        let is_there = |name: &str| self.folder().join(name).is_file();
        // A run that failed completes its tables.
        let partial = |name: &str| format!("{name}{PARTIAL}");
        let tables = [(HISTORY, history), (FIELD_TABLE, field_table)].into_iter();
        let tables = tables.filter(|(name, length)| length.is_some() && !is_there(name));
        let mut wanted = written.files().iter().cloned().chain(tables.map(|(name, _)| partial(name)));
        let Some(missing) = wanted.find(|name| !is_there(name)) else { return Ok(()) };
        let problem = format!("goes on with {}, which is not there", self.folder().join(missing).display());
        let help = "put it back, or start over: run the scene without --resume";
        Err(RunError::Checkpoint { path: self.path.clone(), problem, help })
    }
}
