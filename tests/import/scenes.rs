//! Scenes on the mesh of a file.

use crate::cli_support::{Place, number, scene};
use crate::file::{Encoding, File};

/// A scene that takes all from a file.
const SCENE: &str =
    "[mesh]\nfile = \"grid.vts\"\n\n[output]\ninterface = [\"obj\", \"vtk\"]\nfields = true\n";

#[test]
fn what_was_reconstructed_is_reconstructed_again() {
    let place = Place::new();
    for name in ["static_disc", "static_sphere"] {
        let distortion = "mesh.distortion.random.amplitude=0.2";
        let first = place.reconstruct(name, name, &[distortion, "output.picture=false"]);
        let fields = std::fs::read(place.path(name).join("fields_0000.vts")).unwrap();
        place.file("grid.vts", fields);
        place.file("again.toml", SCENE);
        let done = place.vofkit(&["reconstruct", "again.toml", "--out", "again", "--force", "--quiet"]);
        assert_eq!((done.code, done.err.as_str()), (Some(0), ""), "{name}");
        let again = place.summary("again");
        for key in ["dimension", "cells", "cells_per_direction", "mixed_cells", "planes"] {
            assert_eq!(first[key], again[key], "{name}: {key}");
        }
        // Without the shape nobody knows how far the planes are from it.
        let mut unjudged = first["materials"].clone();
        for key in ["symmetric_difference", "hausdorff_mean"] {
            assert!(unjudged[0][key].take().is_f64(), "{name}: {key}");
        }
        assert_eq!(unjudged, again["materials"], "{name}");
        for file in ["interface_0000.obj", "interface_0000.vtp", "fields_0000.vts"] {
            let [a, b] = [name, "again"].map(|out| std::fs::read(place.path(out).join(file)).unwrap());
            assert!(a == b, "{name}: {file} differs");
        }
        // The shapes of the scene on the mesh of the file.
        let text = std::fs::read_to_string(scene(name)).unwrap();
        let box_lines = |line: &&str| !["cells", "lower", "upper"].iter().any(|key| line.starts_with(key));
        let text: Vec<&str> = text.lines().filter(box_lines).collect();
        place.file("shapes.toml", text.join("\n").replace("[mesh]", "[mesh]\nfile = \"grid.vts\""));
        let done = place.vofkit(&["reconstruct", "shapes.toml", "--out", "shapes", "--force", "--quiet"]);
        assert_eq!((done.code, done.err.as_str()), (Some(0), ""), "{name}");
        assert_eq!(place.summary("shapes")["materials"], first["materials"], "{name}");
    }
}

#[test]
fn a_run_may_start_from_a_file() {
    let place = Place::new();
    place.reconstruct("disc_rotation", "start", &["mesh.distortion.wave.amplitude=0.2"]);
    let moving = "[velocity]\nfield = { rotation = { centre = [5.0, 5.0], rate = 1.0 } }\n\
                  [advection]\nend_time = 0.2\n";
    place.file("run.toml", format!("[mesh]\nfile = \"start/fields_0000.vts\"\n{moving}"));
    let done = place.vofkit(&["run", "run.toml", "--out", "run", "--quiet"]);
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""));
    let material = &place.summary("run")["materials"][0];
    assert_eq!(material["name"], "disc");
    assert!(number(&material["volume_drift"]).abs() <= 1e-12, "{material}");
    // Where it ends is not known exactly.
    assert!(material["shape_error"].is_null(), "{material}");
    let checked = place.vofkit(&["check", "run.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.err);
    place.file("resolved.toml", &checked.out);
    assert_eq!(place.vofkit(&["check", "resolved.toml"]).out.replace("\"resolved\"", "\"run\""), checked.out);
}

#[test]
fn a_left_handed_file_is_told() {
    let place = Place::new();
    place.file("grid.vts", File::solid().reversed(2).bytes(Encoding::default()));
    place.file("left.toml", SCENE);
    let done = place.vofkit(&["reconstruct", "left.toml", "--out", "o"]);
    assert_eq!(done.code, Some(0), "{}", done.err);
    assert!(done.out.contains("left-handed") && done.out.contains("along z"), "{}", done.out);
    assert_eq!(place.summary("o")["notes"].as_array().unwrap().len(), 1);
}

#[test]
fn what_is_wrong_is_named_with_file_and_line() {
    let place = Place::new();
    place.file("grid.vts", File::flat().bytes(Encoding::default()));
    let mut folded = File::flat();
    folded.points.swap(6, 7);
    place.file("folded.vts", folded.bytes(Encoding::default()));
    let mut bare = File::flat();
    bare.arrays.clear();
    place.file("bare.vts", bare.bytes(Encoding::default()));
    place.file("text.vts", "hello");
    let disc = "[[material]]\nname = \"disc\"\nshape = { disc = { centre = [2.0, 1.5], radius = 1.0 } }\n";
    let cases: &[(&str, &str, usize, &[&str])] = &[
        ("file = \"none.vts\"", "", 2, &["cannot read none.vts", "folder of the scene file"]),
        ("file = \"text.vts\"", "", 2, &["text.vts", "no VTK XML file"]),
        ("file = \"folded.vts\"", disc, 2, &["cells of folded.vts cannot be used", "cell [", "repair them"]),
        ("file = \"bare.vts\"", "", 1, &["neither the scene nor the file", "[[material]]"]),
        (
            "file = \"grid.vts\"\ncells = [4, 3]",
            "",
            2,
            &["mesh.file and mesh.cells are both given", "leave out"],
        ),
        ("file = \"grid.vts\"\nupper = [4.0, 3.0]", "", 2, &["mesh.file and mesh.upper are both given"]),
        (
            "file = \"grid.vts\"\ndistortion = { wave = { amplitude = 0.1 } }",
            "",
            2,
            &["mesh.distortion are both"],
        ),
        ("", disc, 1, &["missing key `cells`", "mesh.file"]),
        (
            "file = \"grid.vts\"",
            "[[material]]\nname = \"salt\"\n",
            4,
            &["grid.vts", "no cell array `alpha.salt`", "alpha.one, alpha.two"],
        ),
        (
            "file = \"grid.vts\"",
            "[[material]]\nname = \"disc\"\nshape = { disc = { centre = [2.0, 1.5], radius = 1.0 } }\n[[material]]\nname = \"one\"\n",
            5,
            &["has a shape, and \"one\" has none", "give all materials shapes, or none"],
        ),
        (
            "file = \"grid.vts\"",
            "[boundary]\nx = [\"periodic\", \"periodic\"]\n",
            4,
            &["the ends of a mesh from a file cannot be joined"],
        ),
    ];
    for (mesh, rest, line, answer) in cases {
        place.file("wrong.toml", format!("[mesh]\n{mesh}\n{rest}"));
        for command in ["reconstruct", "check"] {
            let done = place.vofkit(&[command, "wrong.toml"]);
            assert_eq!(done.code, Some(1), "{mesh} {rest}: {}", done.out);
            let position = format!("wrong.toml:{line}:");
            for words in answer.iter().copied().chain([position.as_str()]) {
                assert!(done.err.contains(words), "{mesh} {rest}: no {words:?} in\n{}", done.err);
            }
            assert!(!place.path("out").exists());
        }
    }
}
