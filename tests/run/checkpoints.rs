//! Runs that stop and go on come to the same bits as those that do not.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use serde_json::Value;
use vofkit::geometry::{Hexahedron, Quad};
use vofkit::run::{self, Checkpoint, Checkpoints, Progress, RunError, RunOptions};
use vofkit::scene::Scene;

use crate::cli_support::{Place, scene};

/// Sets a flag after some step.
struct StopAfter {
    step: usize,
    flag: Arc<AtomicBool>,
}

impl Progress for StopAfter {
    fn stage(&mut self, _: &str) {}

    fn begin(&mut self, _: usize) {}

    fn step(&mut self, done: usize, _: f64, _: usize) {
        if done == self.step {
            self.flag.store(true, Ordering::Relaxed);
        }
    }

    fn end(&mut self) {}
}

/// Runs a scene into a folder, from the start or its checkpoint, until it is complete or stops after a step.
fn go(scene: &Scene, folder: &Path, from: Option<Checkpoint>, stop_after: usize) -> Result<(), RunError> {
    let options = RunOptions { folder: folder.to_owned(), force: false, threads: 1 };
    let flag = Arc::new(AtomicBool::new(false));
    let checkpoints = Checkpoints { every: 0, stop: Some(flag.clone()) };
    let mut progress = StopAfter { step: stop_after, flag };
    match scene {
        Scene::Plane(scene) => {
            run::run_with_checkpoints::<Quad, 2>(scene, &options, &checkpoints, from, &mut progress)
        }
        Scene::Space(scene) => {
            run::run_with_checkpoints::<Hexahedron, 3>(scene, &options, &checkpoints, from, &mut progress)
        }
    }
    .map(|_| ())
}

/// All files of a folder; of the summary all but what differs from run to run.
fn content(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let read = |entry: fs::DirEntry| {
        let name = entry.file_name().into_string().unwrap();
        let mut bytes = fs::read(entry.path()).unwrap();
        if name == "summary.json" {
            let mut summary: Value = serde_json::from_slice(&bytes).unwrap();
            for key in ["wall_seconds", "seconds", "threads"] {
                assert!(summary.as_object_mut().unwrap().remove(key).is_some(), "{key}");
            }
            bytes = summary.to_string().into_bytes();
        }
        (name, bytes)
    };
    fs::read_dir(folder).unwrap().map(|entry| read(entry.unwrap())).collect()
}

fn assert_same(name: &str, one: &Path, other: &Path) {
    let [one, other] = [one, other].map(content);
    assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>(), "{name}");
    for (file, bytes) in &one {
        assert!(bytes == &other[file], "{name}: {file} differs");
    }
}

#[test]
fn stopped_runs_come_to_the_same_bits() {
    let cases: [(&str, &[&str]); 9] = [
        (
            "reversed_vortex",
            &["mesh.cells=[16,16]", "mesh.distortion.random.amplitude=0.2", "output.times=[0,0.2,0.6]"],
        ),
        ("reversed_vortex", &["mesh.cells=[16,16]", "advection.courant=1.5", "advection.substeps=auto"]),
        (
            "reversed_vortex",
            &["mesh.cells=[12,12]", "advection.scheme=unsplit", "reconstruction.normal=swartz"],
        ),
        ("deformation_3d", &["mesh.cells=[8,8,8]", "mesh.distortion.wave.amplitude=0.3"]),
        ("seven_discs", &["mesh.cells=[20,20]"]),
        ("remesh_wave", &["mesh.cells=[12,12]"]),
        ("fields/mmale_step", &["mesh.cells=[12,12]", "advection.courant=0.1"]),
        ("carried_quantities", &["mesh.cells=[12,12]"]),
        ("fields/disc_disperses", &["mesh.cells=[16,16]"]),
    ];
    let place = Place::new();
    for (number, (name, settings)) in cases.into_iter().enumerate() {
        let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
        let scene = Scene::load(scene(name), &settings).unwrap();
        let [whole, parts] = ["whole", "parts"].map(|kind| place.path(&format!("{kind}{number}")));
        go(&scene, &whole, None, 0).unwrap();
        let mut from = None;
        for stop in [1, 4] {
            let stopped = go(&scene, &parts, from, stop).unwrap_err();
            assert!(matches!(stopped, RunError::Stopped { step, .. } if step == stop), "{name}: {stopped}");
            from = Some(Checkpoint::read(&parts).unwrap());
        }
        let again = from.as_ref().unwrap().scene().unwrap();
        go(&again, &parts, from, 0).unwrap();
        assert_same(name, &whole, &parts);
    }
}

/// An error as the terminal shows it, without its line breaks.
fn unwrapped(text: &str) -> String {
    text.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

/// Starts `vofkit` and waits until a file is there.
fn started(place: &Place, arguments: &[&str], until: &Path) -> Child {
    let mut command = place.command();
    let child = command.args(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let since = Instant::now();
    while !until.exists() {
        assert!(since.elapsed() < Duration::from_secs(60), "{} does not appear", until.display());
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

#[cfg(unix)]
#[test]
fn interrupted_and_killed_runs_go_on() {
    let place = Place::new();
    let path = scene("reversed_vortex");
    let [path, cells, courant] = [path.to_str().unwrap(), "mesh.cells=[24,24]", "advection.courant=0.05"];
    let set = ["--set", cells, "--set", courant, "--quiet"];
    let whole = place.vofkit(&[&["run", path, "--out", "whole"], &set[..]].concat());
    assert_eq!((whole.code, whole.err.as_str()), (Some(0), ""));

    let checkpoint = place.path("parts/checkpoint.bin");
    let child = started(
        &place,
        &[&["run", path, "--out", "parts"], &set[..]].concat(),
        &place.path("parts/history.csv.partial"),
    );
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let stopped = child.wait_with_output().unwrap();
    let told = unwrapped(&String::from_utf8(stopped.stderr).unwrap());
    assert_eq!(stopped.status.code(), Some(1), "{told}");
    assert!(told.contains("--resume parts") && checkpoint.exists(), "{told}");

    let first = fs::read(&checkpoint).unwrap();
    let mut child =
        started(&place, &["run", "--resume", "parts", "--checkpoint", "1", "--quiet"], &checkpoint);
    while fs::read(&checkpoint).unwrap() == first {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    Checkpoint::read(&place.path("parts")).expect("the last good checkpoint is whole");

    let done = place.vofkit(&["run", "--resume", "parts", "--quiet"]);
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""));
    // What was being written when the process was killed.
    for name in place.listed("parts").iter().filter(|name| name.ends_with(".partial")) {
        fs::remove_file(place.path("parts").join(name)).unwrap();
    }
    assert_same("reversed_vortex", &place.path("whole"), &place.path("parts"));
}

#[test]
fn checkpoints_that_are_none_are_refused() {
    let place = Place::new();
    let small = Scene::load(scene("disc_diagonal"), &[]).unwrap();
    let folder = place.path("a");
    go(&small, &folder, None, 2).unwrap_err();
    let path = folder.join("checkpoint.bin");
    let good = fs::read(&path).unwrap();
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 1;
    let cases: [(&[u8], &str); 4] = [
        (&flipped, "check sum is wrong"),
        (&good[..good.len() - 9], "check sum is wrong"),
        (&good[..60], "damaged"),
        (b"something else", "does not start with"),
    ];
    for (bytes, told) in cases {
        fs::write(&path, bytes).unwrap();
        let done = place.vofkit(&["run", "--resume", "a"]);
        let words = unwrapped(&done.err);
        assert!(done.code == Some(1) && words.contains(told), "{}", done.err);
    }
    fs::remove_file(&path).unwrap();
    assert!(unwrapped(&place.vofkit(&["run", "--resume", "a"]).err).contains("cannot be read"));
    for arguments in
        [&["run", "--resume", "a", "b.toml"][..], &["run"], &["run", "b.toml", "--checkpoint", "0"]]
    {
        assert_eq!(place.vofkit(arguments).code, Some(2), "{arguments:?}");
    }
    // A table that is shorter than the checkpoint says.
    fs::write(&path, &good).unwrap();
    fs::write(folder.join("history.csv.partial"), "step").unwrap();
    let done = place.vofkit(&["run", "--resume", "a"]);
    assert!(done.code == Some(1) && unwrapped(&done.err).contains("bytes of"), "{}", done.err);
}
