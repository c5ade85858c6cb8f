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
        assert_refused(&place, &text(mesh, advection, more), pointed, answer);
    }
}

/// Both commands answer with the place of the line that starts with `pointed`, and in these words.
fn assert_refused(place: &Place, text: &str, pointed: &str, answer: &[&str]) {
    place.file("wrong.toml", text);
    let line = text.lines().position(|line| line.starts_with(pointed)).unwrap() + 1;
    for command in ["check", "run"] {
        let done = place.vofkit(&[command, "wrong.toml"]);
        assert_eq!(done.code, Some(1), "{text}: {}", done.err);
        let position = format!("wrong.toml:{line}:");
        for words in answer.iter().copied().chain([position.as_str()]) {
            assert!(done.err.contains(words), "{text}: no {words:?} in\n{}", done.err);
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

#[test]
fn quantities_travel_with_their_materials() {
    let place = Place::new();
    let cell_arrays = |folder: &str| {
        let file = fs::read(place.path(folder).join("fields_0001.vts")).unwrap();
        String::from_utf8_lossy(&file).into_owned()
    };
    for (scene, arrays, settings) in [
        (
            "carried_quantities",
            &["\"density.left\"", "\"density\"", "\"stress.left\"", "\"density.right\""][..],
            &["advection.end_time=0.2"][..],
        ),
        ("remesh_remap", &["\"density.disc\""], &["advection.end_time=1.0"]),
        ("remesh_remap", &["\"density.disc\""], &["advection.scheme=sweeps", "advection.steps=60"]),
    ] {
        let folder = settings.concat().replace('.', "_");
        let summary = place.run(scene, &folder, settings);
        let quantities = summary["quantities"].as_array().unwrap();
        assert!(!quantities.is_empty());
        for quantity in quantities {
            assert!(number(&quantity["conserved"]).abs() <= 1e-13, "{quantity}");
            assert!(number(&quantity["corrected"]) <= 1e-13, "{quantity}");
            let [low, high] = ["minimum", "maximum"].map(|key| number(&quantity[key]));
            let range = match (quantity["name"].as_str().unwrap(), quantity["material"].as_str().unwrap()) {
                ("density", "right") => [7.8 - 1e-11, 7.8 + 1e-11],
                ("velocity", _) => [-2.0 - 1e-11, 1.0 + 1e-11],
                ("stress", _) => [-0.5, 2.0],
                _ => [1.5, 2.5],
            };
            assert!(low >= range[0] && high <= range[1], "{quantity}");
        }
        let written = cell_arrays(&folder);
        for array in arrays {
            assert!(written.contains(&format!("Name={array}")), "{scene}: no {array}");
        }
    }
}

#[test]
fn wisps_are_kept_unless_they_are_to_be_removed() {
    let place = Place::new();
    // Planes along cell faces tear a tail into drops.
    let drawn_out =
        ["mesh.cells=[16,16]", "advection.end_time=4", "output.picture=false", "reconstruction.normal=slic"];
    let run =
        |folder: &str, more: &[&str]| place.run("reversed_vortex", folder, &[&drawn_out, more].concat());
    let kept = run("kept", &[]);
    assert_eq!(number(&kept["materials"][0]["corrections"]["wisps"]), 0.0);
    let removed = run("removed", &["advection.wisps=0.05"]);
    let material = &removed["materials"][0];
    let volume = number(&material["corrections"]["wisps"]);
    let change = number(&material["volume_initial"]) - number(&material["volume_final"]);
    assert!(volume > 0.0 && (volume - change).abs() <= 1e-14, "{volume:e} and {change:e}");
}

#[test]
fn wrong_quantities_are_answered_with_the_line_and_advice() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("name = \"a\"", "[[material.quantity]]", &["missing key `initial`"]),
        (
            "name = \"a\"\ninitial = { constant = { value = [1.0, 2.0] } }",
            "initial",
            &["a list of 2", "give one number"],
        ),
        (
            "name = \"a\"\ninitial = { constant = { value = 1.0 } }\nweighting = \"b\"",
            "weighting",
            &["\"b\" is no density", "name a scalar quantity"],
        ),
        (
            "name = \"a\"\ninitial = { constant = { value = 1.0 } }\nscheme = \"fct\"",
            "scheme",
            &["the scheme of a quantity", "donor"],
        ),
        (
            "name = \"a\"\ninitial = { constant = { value = 1.0 } }\n[boundary]\ninflow = \"disc\"",
            "name = \"a\"",
            &["flows in", "add inflow"],
        ),
    ];
    for (quantity, pointed, answer) in cases {
        let shape = "radius = 0.3 } }\n";
        let with_quantity = format!("{shape}[[material.quantity]]\n{quantity}\n");
        let text = text(WAVE, REMESH, "").replace(shape, &with_quantity);
        assert_refused(&Place::new(), &text, pointed, answer);
    }
}
