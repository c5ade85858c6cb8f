//! Runs the binary `vofkit` in a folder of its own.
#![allow(dead_code, reason = "each test program uses a part of it")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// The path of a scene of the repository.
pub(crate) fn scene(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{name}.toml"))
}

/// The names of all scenes of materials of the repository.
pub(crate) fn scenes() -> Vec<String> {
    let folder = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes")).unwrap();
    // Those with fields are in a folder of their own.
    let files = folder.map(|file| file.unwrap().path()).filter(|path| path.is_file());
    let mut names: Vec<String> =
        files.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    names.sort();
    names
}

/// The names of the scenes of the repository in which something moves.
pub(crate) fn moving_scenes() -> Vec<String> {
    scenes().into_iter().filter(|name| moves(name)).collect()
}

/// The names of the other ones.
pub(crate) fn still_scenes() -> Vec<String> {
    scenes().into_iter().filter(|name| !moves(name)).collect()
}

fn moves(name: &str) -> bool {
    fs::read_to_string(scene(name)).unwrap().contains("[advection]")
}

/// A folder in which `vofkit` is run.
pub(crate) struct Place {
    folder: TempDir,
}

/// What a command did.
#[derive(Debug)]
pub(crate) struct Done {
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Place {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    pub(crate) fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        fs::write(&path, content).unwrap();
        path
    }

    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_vofkit"));
        command.current_dir(self.folder.path());
        command
    }

    /// Runs `vofkit` with these arguments.
    pub(crate) fn vofkit(&self, arguments: &[&str]) -> Done {
        Done::from(self.command().args(arguments).output().unwrap())
    }

    /// Runs a scene of the repository into `out`, and reads its summary.
    pub(crate) fn run(&self, name: &str, out: &str, settings: &[&str]) -> Value {
        self.go("run", name, out, settings)
    }

    /// Reconstructs a scene of the repository into `out`, and reads the summary.
    pub(crate) fn reconstruct(&self, name: &str, out: &str, settings: &[&str]) -> Value {
        self.go("reconstruct", name, out, settings)
    }

    fn go(&self, command: &str, name: &str, out: &str, settings: &[&str]) -> Value {
        let path = scene(name);
        let mut arguments = vec![command, path.to_str().unwrap(), "--out", out, "--force", "--quiet"];
        for setting in settings {
            arguments.extend(["--set", setting]);
        }
        let done = self.vofkit(&arguments);
        assert_eq!((done.code, done.out.as_str(), done.err.as_str()), (Some(0), "", ""), "{arguments:?}");
        self.summary(out)
    }

    /// The summary in a folder.
    pub(crate) fn summary(&self, out: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(out).join("summary.json")).unwrap()).unwrap()
    }

    /// What is in the folder, sorted.
    pub(crate) fn listed(&self, name: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(name)).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

impl Done {
    /// The error as the terminal shows it, without its line breaks.
    pub(crate) fn told(&self) -> String {
        self.err.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
    }
}

impl From<Output> for Done {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

/// A number of a summary.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// Volume, bounds and files of a summary are as they must be on an undistorted mesh or along mesh lines.
pub(crate) fn assert_sound(place: &Place, out: &str, summary: &Value) {
    for material in summary["materials"].as_array().unwrap() {
        let drift = number(&material["volume_drift"]);
        assert!(drift.abs() <= 1e-12, "{out}: drift {drift}");
        let [min, max] = ["fraction_min", "fraction_max"].map(|key| number(&material[key]));
        assert!(min >= -1e-11 && max <= 1.0 + 1e-11, "{out}: fractions from {min} to {max}");
    }
    let divergence = number(&summary["max_divergence"]);
    assert!(divergence <= 1e-12, "{out}: divergence {divergence}");
    assert_files(place, out, summary);
}

/// The files in a folder are those that the summary names.
pub(crate) fn assert_files(place: &Place, out: &str, summary: &Value) {
    let mut files: Vec<&str> =
        summary["files"].as_array().unwrap().iter().map(|name| name.as_str().unwrap()).collect();
    files.sort_unstable();
    assert_eq!(place.listed(out), files);
}
