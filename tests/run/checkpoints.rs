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

use crate::cli_support::{Done, Place, scene};

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
    let stopped = Done::from(child.wait_with_output().unwrap());
    let told = stopped.told();
    assert_eq!(stopped.code, Some(1), "{told}");
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
        let words = done.told();
        assert!(done.code == Some(1) && words.contains(told), "{}", done.err);
    }
    fs::remove_file(&path).unwrap();
    assert!(place.vofkit(&["run", "--resume", "a"]).told().contains("cannot be read"));
    for arguments in
        [&["run", "--resume", "a", "b.toml"][..], &["run"], &["run", "b.toml", "--checkpoint", "0"]]
    {
        assert_eq!(place.vofkit(arguments).code, Some(2), "{arguments:?}");
    }
    // A table that is shorter than the checkpoint says.
    fs::write(&path, &good).unwrap();
    fs::write(folder.join("history.csv.partial"), "step").unwrap();
    let done = place.vofkit(&["run", "--resume", "a"]);
    assert!(done.code == Some(1) && done.told().contains("bytes of"), "{}", done.err);
}

#[test]
fn runs_do_not_go_on_without_their_files() {
    let place = Place::new();
    let (scene, folder) = (Scene::load(scene("fields/mmale_step"), &[]).unwrap(), place.path("a"));
    go(&scene, &folder, None, 2).unwrap_err();
    for name in ["history.csv.partial", "fields.csv.partial", "fields_0000.vts"] {
        let [file, kept] = [folder.join(name), place.path("kept")];
        fs::rename(&file, &kept).unwrap();
        let done = place.vofkit(&["run", "--resume", "a"]);
        let told = format!("goes on with a/{name}, which is not there");
        assert!(done.code == Some(1) && done.told().contains(&told), "{}", done.err);
        assert!(done.told().contains("start over"), "{}", done.err);
        fs::rename(&kept, &file).unwrap();
    }
    assert_eq!(place.vofkit(&["run", "--resume", "a", "--quiet"]).code, Some(0));
}

#[test]
fn runs_go_on_only_with_the_files_that_they_had() {
    let place = Place::new();
    let body = |name: &str| format!("{{ body = {{ file = \"{name}\" }} }}");
    let vortex = "[velocity]\nfield = { reversed_vortex = { period = 1.0 } }\n[advection]\nend_time = 1.0\n";
    let remesh = "[advection]\nmode = \"remesh\"\ncourant = 0.1\n";
    let square = "0.4 0.4\n0.7 0.4\n0.7 0.7\n0.4 0.7\n";
    let nodes = "x,y\n0,0\n1,0\n2,0\n0,1\n1.2,1\n2,1\n0,2\n1,2\n2,2\n";
    let disc = "{ disc = { centre = [0.6, 0.6], radius = 0.2 } }";
    let cases = [
        ("body.txt", square, square.replace("0.7", "0.8"), "[8, 8]", body("body.txt"), vortex.to_owned()),
        (
            "field.txt",
            square,
            square.replace("0.7", "0.8"),
            "[8, 8]",
            disc.to_owned(),
            format!(
                "{vortex}[[field]]\nname = \"c\"\nscheme = \"donor\"\ninitial = {{ inclusions = {{ shapes = [{{ shape = {}, value = 1.0 }}] }} }}\n",
                body("field.txt")
            ),
        ),
        (
            "nodes.csv",
            nodes,
            nodes.replace("1.2", "1.3"),
            "[2, 2]\nupper = [2.0, 2.0]\nmotion = { nodes = [\"nodes.csv\"] }",
            disc.to_owned(),
            remesh.to_owned(),
        ),
    ];
    for (file, was, is, mesh, shape, rest) in cases {
        place.file(file, was);
        let text = format!("[mesh]\ncells = {mesh}\n[[material]]\nname = \"a\"\nshape = {shape}\n{rest}");
        let path = place.file(&format!("{file}.toml"), text);
        let out = format!("out_{file}");
        go(&Scene::load(path, &[]).unwrap(), &place.path(&out), None, 1).unwrap_err();
        place.file(file, is);
        let done = place.vofkit(&["run", "--resume", &out]);
        let told = "belongs to other nodes, fractions, bodies or velocities";
        assert!(done.code == Some(1) && done.told().contains(told), "{file}: {}", done.err);
        place.file(file, was);
        assert_eq!(place.vofkit(&["run", "--resume", &out, "--quiet"]).code, Some(0), "{file}");
    }
}
