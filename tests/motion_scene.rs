//! Scenes whose mesh moves: what they may not say, and places of nodes from tables.
#![cfg(all(feature = "cli", feature = "obj", feature = "vtk", feature = "plot"))]

mod cli_support;

use std::fmt::Write;
use std::fs;

use cli_support::{Place, number};

/// A disc at rest; `MESH`, `ADVECTION` and `MORE` are filled in.
const SCENE: &str = "[mesh]\ncells = [6, 6]\nMESH\n[[material]]\nname = \"disc\"\n\
     shape = { disc = { centre = [0.5, 0.5], radius = 0.3 } }\n[advection]\nADVECTION\nMORE\n";

fn text(mesh: &str, advection: &str, more: &str) -> String {
    SCENE.replace("MESH", mesh).replace("ADVECTION", advection).replace("MORE", more)
}

const WAVE: &str = "motion = { wave = { amplitude = 0.3 } }";
const REMESH: &str = "mode = \"remesh\"";

#[test]
fn wrong_motions_are_answered_with_the_line_and_advice() {
    let field = "[velocity]\nfield = { uniform = { velocity = [1.0, 0.0] } }";
    let cases: &[(&str, &str, &str, &str, &[&str])] = &[
        (WAVE, "end_time = 1.0", field, WAVE, &["the mesh moves", "advection.mode", "\"remesh\""]),
        ("", REMESH, "", REMESH, &["no mesh.motion", "motion = { wave"]),
        (WAVE, REMESH, field, "field = ", &["the material rests", "leave out [velocity]"]),
        ("", "end_time = 1.0", "", "[mesh]", &["missing key `velocity`"]),
        (
            "motion = { wave = { amplitude = 1.5 } }",
            REMESH,
            "",
            "motion",
            &["wave amplitude 1.5", "change mesh.motion"],
        ),
        (
            "motion = { random = { amplitude = 0.9 } }",
            REMESH,
            "",
            "motion",
            &["of its motion", "cells cannot be used"],
        ),
        (
            "motion = { smooth = { swings = 0 } }",
            REMESH,
            "",
            "motion",
            &["0 swings", "a whole number from 1"],
        ),
        ("motion = \"smooth\"", REMESH, "", "motion", &["`smooth` needs values"]),
        (
            "motion = { rotate = { centre = [0.5], angle = 1.0 } }",
            REMESH,
            "",
            "motion",
            &["a list of 1", "give 2 numbers"],
        ),
        (
            "motion = { rotate = { centre = [0.5, 0.5], angle = nan } }",
            REMESH,
            "",
            "motion",
            &["the angle is NaN"],
        ),
        (
            "motion = { rotate = { centre = [0.5, 0.5], angle = 1.0, axis = [0, 0, 1] } }",
            REMESH,
            "",
            "motion",
            &["three dimensions only"],
        ),
        (
            "motion = { rotate = { centre = [0.5, 0.5], angle = 1.0 } }",
            REMESH,
            "[boundary]\nx = [\"periodic\", \"periodic\"]",
            "motion",
            &["image at the joined end of x", "move apart"],
        ),
        ("motion = { nodes = [] }", REMESH, "", "motion", &["no places"]),
        (
            "motion = { nodes = [\"none.csv\"] }",
            REMESH,
            "",
            "motion",
            &["none.csv cannot be read", "\"x,y\""],
        ),
        (
            "motion = { nodes = [\"short.csv\"] }",
            REMESH,
            "",
            "motion",
            &["node set 0 has 1 nodes, and the mesh has 49"],
        ),
        (
            "motion = { nodes = [\"odd.csv\"] }",
            REMESH,
            "",
            "motion",
            &["odd.csv has the line 3: \"0.5,half\""],
        ),
        ("motion = { nodes = [\"head.csv\"] }", REMESH, "", "motion", &["starts with \"y,x\""]),
        (WAVE, "mode = \"remesh\"\nscheme = \"weymouth_yue\"", "", "scheme", &["undistorted", "sweeps"]),
        (
            "motion = { wave = { amplitude = 0.3, swings = 9 } }",
            "mode = \"remesh\"\nsteps = 1",
            "",
            "steps",
            &["Courant number", "above 1"],
        ),
        (WAVE, "mode = \"remesh\"\nsweep_order = \"random\"", "", "sweep_order", &["not known", "symmetric"]),
    ];
    for (mesh, advection, more, pointed, answer) in cases {
        let place = Place::new();
        place.file("short.csv", "x,y\n0,0\n");
        place.file("odd.csv", "x,y\n0.0,0.0\n0.5,half\n");
        place.file("head.csv", "y,x\n0,0\n");
        let text = text(mesh, advection, more);
        place.file("wrong.toml", &text);
        let line = text.lines().position(|line| line.starts_with(pointed)).unwrap() + 1;
        for command in ["check", "run"] {
            let done = place.vofkit(&[command, "wrong.toml"]);
            assert_eq!(done.code, Some(1), "{mesh}: {}", done.err);
            let position = format!("wrong.toml:{line}:");
            for words in answer.iter().copied().chain([position.as_str()]) {
                assert!(done.err.contains(words), "{mesh} {advection}: no {words:?} in\n{}", done.err);
            }
        }
    }
}

#[test]
fn nodes_go_to_the_places_of_a_table() {
    let place = Place::new();
    let mut table = "x,y\n".to_owned();
    for j in 0..=6 {
        for i in 0..=6 {
            let [x, y] = [i, j].map(|k| f64::from(k) / 6.0);
            let bump = if (1..6).contains(&i) && (1..6).contains(&j) { 0.04 } else { 0.0 };
            writeln!(table, "{},{}", x + bump, y - 0.5 * bump).unwrap();
        }
    }
    fs::create_dir(place.path("meshes")).unwrap();
    place.file("meshes/there.csv", &table);
    let motion = "motion = { nodes = [\"meshes/there.csv\"] }";
    place.file("scene.toml", text(motion, REMESH, "[output]\nfields = true"));
    let done = place.vofkit(&["run", "scene.toml", "--out", "o", "--quiet"]);
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""));
    let summary = place.summary("o");
    let disc = &summary["materials"][0];
    assert!(number(&disc["volume_drift"]).abs() <= 1e-13, "{disc}");
    assert!(number(&disc["shape_error_relative"]) <= 0.05, "{disc}");
    // The mesh is written where it is.
    let [first, last] =
        ["o/fields_0000.vts", "o/fields_0001.vts"].map(|name| fs::read(place.path(name)).unwrap());
    let moved = (1.0_f64 / 6.0 + 0.04).to_le_bytes();
    let holds = |file: &[u8]| file.windows(8).any(|bytes| bytes == moved);
    assert!(!holds(&first) && holds(&last));
}
