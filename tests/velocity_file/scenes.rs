//! Scenes whose velocity comes from files.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use vofkit::export::vtk::{CellArray, Collection, write_structured_grid_with_nodes};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Quad, Vector};
use vofkit::mesh::{Distortion, Mesh};
use vofkit::run::{Checkpoints, RunError, RunOptions, Silent, run_with_checkpoints};
use vofkit::scene::Scene;
use vofkit::shape::Shape;
use vofkit::velocity::Field;

use crate::cli_support::{Place, assert_files, assert_sound, number};
use crate::common::{Mesh2, Mesh3, unit_mesh};
use crate::wrong::vts;
use crate::{sampled, write};

const WAVE: Distortion = Distortion::Wave { amplitude: 0.3 };

fn scene(mesh: &str, velocity: &str, rest: &str) -> String {
    format!(
        "[mesh]\n{mesh}\ndistortion = {{ wave = {{ amplitude = 0.3 }} }}\n\n[[material]]\nname = \"disc\"\n\
         shape = {{ disc = {{ centre = [0.5, 0.6], radius = 0.2 }} }}\n\n[velocity]\n{velocity}\n\n\
         [advection]\nend_time = 0.2\n{rest}\n"
    )
}

/// Runs a scene and returns its summary.
fn run(place: &Place, text: &str, out: &str, more: &[&str]) -> serde_json::Value {
    place.file(&format!("{out}.toml"), text);
    let name = format!("{out}.toml");
    let arguments = [&["run", &name, "--out", out, "--force", "--quiet"], more].concat();
    let done = place.vofkit(&arguments);
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""), "{text}");
    place.summary(out)
}

#[test]
fn a_file_does_what_its_formula_does() {
    let place = Place::new();
    let mesh: Mesh2 = unit_mesh(16, WAVE);
    let uniform = Field::Uniform { velocity: [0.5, -0.3, 0.0].into() };
    write(&place.path("flow.vts"), &mesh, &sampled(&mesh, &uniform));
    let cells = "cells = [16, 16]";
    let formula = scene(cells, "field = { uniform = { velocity = [0.5, -0.3] } }", "");
    let files = scene(cells, "field = { file = { path = \"flow.vts\" } }", "");
    let [formula, files] =
        [("formula", formula), ("files", files)].map(|(out, text)| run(&place, &text, out, &[]));
    for key in ["steps", "end_time"] {
        assert_eq!(formula[key], files[key], "{key}");
    }
    for key in ["volume_final", "boundary_volume"] {
        let [a, b] = [&formula, &files].map(|summary| number(&summary["materials"][0][key]));
        assert!((a - b).abs() <= 1e-12, "{key}: {a} {b}");
    }
    assert_sound(&place, "files", &files);
    // What was shifted by a formula is known exactly.
    assert!(files["materials"][0]["shape_error"].is_null());
}

#[test]
fn a_reversal_brings_it_back() {
    let place = Place::new();
    let mesh: Mesh2 = unit_mesh(20, WAVE);
    write(&place.path("flow.vts"), &mesh, &sampled(&mesh, &Field::ReversedVortex));
    let velocity = "field = { file = { path = \"flow.vts\", divergence = \"project\" } }\nreversal = { cosine = { period = 0.2 } }";
    let rest = "[output]\ninterface = [\"obj\", \"vtk\"]\nfields = true\n";
    let summary = run(&place, &scene("cells = [20, 20]", velocity, rest), "back", &[]);
    assert_sound(&place, "back", &summary);
    let formula = "field = { reversed_vortex = { period = 0.2 } }";
    let formula = run(&place, &scene("cells = [20, 20]", formula, rest), "formula", &[]);
    let [error, best] =
        [&summary, &formula].map(|summary| number(&summary["materials"][0]["shape_error_relative"]));
    assert!((error / best - 1.0).abs() <= 0.05, "{error} {best}");
}

/// A run writes its velocity by cell; another run can take that.
#[test]
fn a_run_can_be_driven_by_what_another_one_wrote() {
    let place = Place::new();
    let cells = "cells = [16, 16]";
    let output = "[output]\ninterface = [\"vtk\"]\nfields = true\ntimes = [0.0, 0.1, 0.2]\n";
    run(&place, &scene(cells, "field = { reversed_vortex = { period = 2.0 } }", output), "first", &[]);
    let velocity = "field = { file = { path = \"first/first.pvd\", divergence = \"project\" } }";
    let second =
        run(&place, &scene(cells, velocity, "[boundary]\nx = [\"outflow\", \"outflow\"]"), "second", &[]);
    let material = &second["materials"][0];
    assert!(number(&material["volume_drift"]).abs() <= 1e-12, "{material}");
}

fn series(place: &Place, entries: &[(f64, &str)]) {
    let mut series = Collection::new(place.path("flow.pvd"));
    for (time, file) in entries {
        series.add(*time, &[("flow", &place.path(file))]).unwrap();
    }
}

fn uniform(mesh: &Mesh2, speed: f64) -> Vec<Vector<2>> {
    sampled(mesh, &Field::Uniform { velocity: [speed, 0.0, 0.0].into() })
}

/// The last file is none, and would be refused.
#[test]
fn files_for_after_the_end_are_not_read() {
    let place = Place::new();
    let mesh: Mesh2 = unit_mesh(16, WAVE);
    write(&place.path("a.vts"), &mesh, &uniform(&mesh, 0.5));
    write(&place.path("b.vts"), &mesh, &uniform(&mesh, 1.0));
    place.file("later.vts", "nothing");
    let text = scene("cells = [16, 16]", "field = { file = { path = \"flow.pvd\" } }", "");
    series(&place, &[(-1.0, "later.vts"), (0.0, "a.vts"), (0.3, "b.vts"), (100.0, "later.vts")]);
    let long = run(&place, &text, "long", &[]);
    series(&place, &[(0.0, "a.vts"), (0.3, "b.vts")]);
    assert_eq!(long["materials"], run(&place, &text, "short", &[])["materials"]);
}

#[test]
fn a_run_does_not_go_on_with_another_velocity() {
    let place = Place::new();
    let mesh: Mesh2 = unit_mesh(16, WAVE);
    write(&place.path("flow.vts"), &mesh, &uniform(&mesh, 0.5));
    let text = scene("cells = [16, 16]", "field = { file = { path = \"flow.vts\" } }", "");
    place.file("scene.toml", text);
    let Scene::Plane(loaded) = Scene::load(place.path("scene.toml"), &[]).expect("a scene") else {
        panic!("it is in the plane")
    };
    let options = RunOptions { folder: place.path("out"), force: false, threads: 1 };
    let stopped = Checkpoints { every: 0, stop: Some(Arc::new(AtomicBool::new(true))) };
    let done = run_with_checkpoints::<Quad, 2>(&loaded, &options, &stopped, None, &mut Silent);
    assert!(matches!(done, Err(RunError::Stopped { step: 1, .. })), "{done:?}");
    write(&place.path("flow.vts"), &mesh, &uniform(&mesh, 0.25));
    let refused = place.vofkit(&["run", "--resume", "out"]);
    assert!(
        refused.code == Some(1) && refused.told().contains("other nodes, fractions, bodies or velocities"),
        "{}",
        refused.err
    );
    write(&place.path("flow.vts"), &mesh, &uniform(&mesh, 0.5));
    let done = place.vofkit(&["run", "--resume", "out", "--quiet"]);
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""));
}

#[test]
fn dilation_is_told_from_drift() {
    let place = Place::new();
    let mesh: Mesh2 = unit_mesh(16, WAVE);
    let away: Vec<Vector<2>> = mesh.nodes().iter().map(|x| x - Vector::repeat(0.5)).collect();
    write(&place.path("flow.vts"), &mesh, &away);
    let velocity = "field = { file = { path = \"flow.vts\", divergence = \"dilate\" } }";
    let summary = run(&place, &scene("cells = [16, 16]", velocity, ""), "grown", &[]);
    let material = &summary["materials"][0];
    let [drift, dilated, volume] = [
        number(&material["volume_drift"]),
        number(&material["corrections"]["dilated"]),
        number(&material["volume_initial"]),
    ];
    let steps = number(&summary["steps"]);
    let growth = (1.0 - 0.4 / steps).powf(-steps) - 1.0;
    assert!((drift / growth - 1.0).abs() <= 0.02, "{drift} {growth}");
    assert!((drift - dilated / volume).abs() <= 1e-12, "{drift} {dilated}");
    let refused = place.file(
        "refused.toml",
        scene("cells = [16, 16]", velocity, "scheme = \"weymouth_yue\"")
            .replace("{ wave = { amplitude = 0.3 } }", "\"none\""),
    );
    let boxes: Mesh2 = unit_mesh(16, Distortion::None);
    let away: Vec<Vector<2>> = boxes.nodes().iter().map(|x| x - Vector::repeat(0.5)).collect();
    write(&place.path("flow.vts"), &boxes, &away);
    let done = place.vofkit(&["check", refused.to_str().unwrap()]);
    assert_eq!(done.code, Some(1));
    assert!(
        done.err.contains("weymouth_yue") && done.err.contains("sweeps, unsplit or isotropic"),
        "{}",
        done.err
    );
}

#[test]
fn mesh_materials_and_velocity_may_come_from_one_file() {
    let place = Place::new();
    let mesh: Mesh3 = unit_mesh(8, WAVE);
    let ball = Shape::Sphere { centre: Vector::repeat(0.4), radius: 0.2 };
    let fractions = volume_fractions(&mesh, &[ball]);
    let turned = Field::Rotation {
        centre: Vector::<3>::repeat(0.5),
        angular_velocity: Vector::<3>::new(0.0, 0.3, 1.0),
    };
    let velocities = sampled(&mesh, &turned);
    let all = (CellArray::scalar("alpha.ball", &fractions[0]), CellArray::vector("U", &velocities));
    write_structured_grid_with_nodes(place.path("all.vts"), &mesh, &[all.0], &[all.1]).unwrap();
    let scene = |velocity: &str| {
        format!("[mesh]\nfile = \"all.vts\"\n[velocity]\nfield = {velocity}\n[advection]\nend_time = 0.3\n")
    };
    let file = run(&place, &scene("{ file = { path = \"all.vts\" } }"), "file", &[]);
    let rotation =
        "{ rotation = { centre = [0.5, 0.5, 0.5], rate = 1.0440306508910551, axis = [0.0, 0.3, 1.0] } }";
    let formula = run(&place, &scene(rotation), "formula", &[]);
    assert_eq!(file["materials"][0]["name"], "ball");
    assert_sound(&place, "file", &file);
    for key in ["volume_final", "boundary_volume"] {
        let [a, b] = [&formula, &file].map(|summary| number(&summary["materials"][0][key]));
        assert!((a - b).abs() <= 1e-11, "{key}: {a} {b}");
    }
    let checked = place.vofkit(&["check", "file.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.err);
    place.file("file.toml", &checked.out);
    assert_eq!(place.vofkit(&["check", "file.toml"]).out, checked.out);
}

#[test]
fn fields_are_driven_too() {
    let place = Place::new();
    let mesh: Mesh2 = unit_mesh(12, WAVE);
    write(&place.path("flow.vts"), &mesh, &sampled(&mesh, &Field::ReversedVortex));
    let fields = "[[field]]\nname = \"heat\"\ninitial = { sine = { waves = [1.0, 1.0], amplitude = 1.0 } }\n\
                  [[field]]\nname = \"speed\"\nlocation = \"node\"\ninitial = { constant = { value = 2.0 } }\n\
                  [[field]]\nname = \"strain\"\nlocation = \"points\"\nscheme = \"direct\"\ninitial = { constant = { value = 1.0 } }\n";
    let velocity = "field = { file = { path = \"flow.vts\", divergence = \"project\" } }";
    let text = scene("cells = [12, 12]", velocity, "") + fields;
    let summary = run(&place, &text, "fields", &[]);
    assert_files(&place, "fields", &summary);
    let fields = summary["fields"].as_array().unwrap();
    assert!(number(&fields[0]["conserved"]).abs() <= 1e-12, "{}", fields[0]);
    for field in &fields[1..] {
        assert!((number(&field["maximum"]) - number(&field["minimum"])).abs() <= 1e-12, "{field}");
    }
}

#[test]
fn threads_and_checkpoints_change_no_bit() {
    let place = Place::new();
    let mesh: Mesh2 = unit_mesh(20, WAVE);
    let mut series = Collection::new(place.path("flow.pvd"));
    for (k, factor) in [1.0, 0.5, -0.7].iter().enumerate() {
        let path = place.path(&format!("flow_{k}.vts"));
        let velocities: Vec<Vector<2>> =
            sampled(&mesh, &Field::ReversedVortex).iter().map(|u| u * *factor).collect();
        write(&path, &mesh, &velocities);
        series.add(0.08 * k as f64, &[("flow", &path)]).unwrap();
    }
    let velocity = "field = { file = { path = \"flow.pvd\", divergence = \"project\" } }";
    let text = scene("cells = [20, 20]", velocity, "scheme = \"unsplit\"\n[output]\nfields = true\n");
    run(&place, &text, "one", &["--threads", "1"]);
    run(&place, &text, "two", &["--threads", "2", "--checkpoint", "3"]);
    for file in ["fields_0001.vts", "history.csv"] {
        let [a, b] = ["one", "two"].map(|out| std::fs::read(place.path(out).join(file)).unwrap());
        assert!(a == b, "{file}");
    }
}

/// Files whose nodes are counted against the hand of the mesh.
#[test]
fn the_order_of_nodes_may_be_left_handed() {
    let place = Place::new();
    let mesh: Mesh2 = unit_mesh(8, Distortion::None);
    let field = Field::Rotation { centre: Vector::<3>::repeat(0.5), angular_velocity: Vector::<3>::z() };
    let turned: Vec<usize> = (0..81).map(|node| node % 9 + 9 * (8 - node / 9)).collect();
    let velocities = sampled(&mesh, &field);
    let numbers = |values: Vec<[f64; 2]>| {
        values.iter().map(|[x, y]| format!("{x:?} {y:?} 0")).collect::<Vec<_>>().join("\n")
    };
    let points = numbers(turned.iter().map(|&node| mesh.nodes()[node].into()).collect());
    let values = numbers(turned.iter().map(|&node| velocities[node].into()).collect());
    let path = place.file("left.vts", crate::wrong::vts("0 8 0 8 0 0", &points, &values));
    let found = vofkit::import::NodalVelocity::read(path).unwrap().on(&mesh).unwrap();
    assert_eq!(found, velocities);
}

#[test]
fn the_scenes_of_the_repository_run() {
    let place = Place::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/velocity");
    let mut count = 0;
    for file in std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()) {
        assert!(std::fs::metadata(&file).unwrap().len() < 50_000, "{}", file.display());
        if file.extension().is_some_and(|extension| extension == "toml") {
            count += 1;
            let name = format!("velocity/{}", file.file_stem().unwrap().to_str().unwrap());
            let summary = place.run(&name, "out", &["advection.end_time=0.5", "output.times=[0.0, 0.5]"]);
            assert_sound(&place, "out", &summary);
        }
    }
    assert!(count > 0);
}

/// Other meshes than that of the file are refused, whatever is wrong about them.
#[test]
fn the_mesh_must_be_that_of_the_file() {
    let place = Place::new();
    let mesh: Mesh<vofkit::geometry::Quad, 2> = unit_mesh(8, Distortion::None);
    write(&place.path("flow.vts"), &mesh, &sampled(&mesh, &Field::ReversedVortex));
    let velocity = "field = { file = { path = \"flow.vts\", divergence = \"project\" } }";
    let cases: [(&str, &[&str]); 2] = [
        ("cells = [8, 9]", &["flow.vts", "it has [8, 8] cells", "[8, 9]", "on the mesh of the scene"]),
        (
            "cells = [8, 8]",
            &["flow.vts", "node [1, 1] is at [0.125, 0.125]", "that of the mesh of the scene at"],
        ),
    ];
    for (cells, answer) in cases {
        place.file("wrong.toml", scene(cells, velocity, ""));
        let done = place.vofkit(&["check", "wrong.toml"]);
        assert_eq!(done.code, Some(1), "{}", done.out);
        for words in answer {
            assert!(done.err.contains(words), "{cells}: no {words:?} in\n{}", done.err);
        }
    }
}

#[test]
fn files_with_left_handed_nodes_are_noted() {
    let place = Place::new();
    let points = "0 2 0 1 2 0 2 2 0 0 1 0 1 1 0 2 1 0 0 0 0 1 0 0 2 0 0";
    place.file("flow.vts", vts("0 2 0 2 0 0", points, &"1 0 0 ".repeat(9)));
    let text = scene("cells = [2, 2]\nupper = [2.0, 2.0]", "field = { file = { path = \"flow.vts\" } }", "");
    let text = text.replace("distortion = { wave = { amplitude = 0.3 } }", "");
    let notes = run(&place, &text, "out", &[])["notes"].to_string();
    let told = "the order of nodes in flow.vts is left-handed";
    assert!(notes.contains(told), "{notes}");
    let checked = place.vofkit(&["check", "out.toml"]);
    assert!(checked.out.contains(told), "{}", checked.out);
}
