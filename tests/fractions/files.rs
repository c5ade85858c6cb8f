//! Bodies from files, by way of scenes.

#[path = "../cli_support/mod.rs"]
mod cli_support;

use std::fs;
use std::path::Path;

use cli_support::{Place, number};
use vofkit::body_file::{self, BodyFileError};
use vofkit::shape::BodyError;

fn shipped(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/bodies").join(name).to_str().expect("UTF-8").to_owned()
}

#[test]
fn shipped_bodies_have_their_volumes() {
    let gear = body_file::read::<2>(Path::new(&shipped("gear.txt"))).expect("two loops");
    assert!(gear.notices().len() == 1 && gear.piece_count() == 40);
    let nut = body_file::read::<3>(Path::new(&shipped("nut.obj"))).expect("closed");
    // The area between a polygon of 24 corners in a circle and a hexagon around one, times the height.
    let ring = 2.0 * 3.0_f64.sqrt() - 12.0 * 0.55_f64.powi(2) * (std::f64::consts::PI / 12.0).sin();
    assert!((nut.volume() - 0.8 * ring).abs() <= 1e-8, "{}", nut.volume());
    let knot = body_file::read::<3>(Path::new(&shipped("knot.stl"))).expect("closed");
    assert!(knot.notices().is_empty() && knot.piece_count() == 2400);
}

#[test]
fn scenes_with_bodies_keep_their_volume() {
    let place = Place::new();
    let cases = [
        ("run", "gear_rotation", 0.16, "mesh.cells=[25,25]"),
        ("run", "knot_deformation", 0.08_f64.powi(3), "mesh.cells=[12,12,12]"),
        ("reconstruct", "static_nut", 0.35_f64.powi(3), "mesh.cells=[12,12,12]"),
    ];
    for (command, scene, scale, cells) in cases {
        let path = shipped(&format!("{scene}.toml"));
        let done = place.vofkit(&[command, &path, "--set", cells, "--out", scene, "--quiet"]);
        assert_eq!((done.code, done.err.as_str()), (Some(0), ""), "{scene}");
        let summary = place.summary(scene);
        let own = match scene {
            "gear_rotation" => {
                body_file::read::<2>(Path::new(&shipped("gear.txt"))).map(|body| body.volume())
            }
            "knot_deformation" => {
                body_file::read::<3>(Path::new(&shipped("knot.stl"))).map(|body| body.volume())
            }
            _ => body_file::read::<3>(Path::new(&shipped("nut.obj"))).map(|body| body.volume()),
        };
        let volume = own.expect("a body") * scale;
        let material = &summary["materials"][0];
        let key = if command == "run" { "volume_initial" } else { "volume" };
        let found = number(&material[key]);
        assert!((found / volume - 1.0).abs() <= 1e-12, "{scene}: {found} of {volume}");
        if command == "run" {
            let drift = number(&material["volume_drift"]);
            assert!(drift.abs() <= 1e-12, "{scene}: drift {drift}");
        }
    }
    // The one surface that is not as its scene needs it is put right, and that is told.
    let notes = place.summary("gear_rotation")["notes"].to_string();
    assert!(notes.contains("cavity") && notes.contains("gear"), "{notes}");
    let error = number(&place.summary("gear_rotation")["materials"][0]["shape_error_relative"]);
    assert!(error <= 0.35, "the exact end of a turn is known: {error}");
}

#[test]
fn surfaces_are_read_as_text_and_as_bytes() {
    let place = Place::new();
    let bytes = fs::read(shipped("knot.stl")).expect("it is there");
    let knot = body_file::read::<3>(Path::new(&shipped("knot.stl"))).expect("closed");
    let mut like_text = bytes.clone();
    like_text[..6].copy_from_slice(b"solid ");
    let again = body_file::read::<3>(&place.file("like_text.STL", &like_text)).expect("closed");
    assert!(again == knot);
    let text = |numbers: std::ops::Range<usize>| {
        let corner = |x: &[f64]| format!("vertex {} {} {}\n", x[0], x[1], x[2]);
        let facet = |i: usize| {
            let corners: String = knot.piece(i).iter().map(|x| corner(x.as_slice())).collect();
            format!("facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n")
        };
        format!("solid\n{}endsolid\n", numbers.map(facet).collect::<String>())
    };
    let halves = text(0..1000) + &text(1000..2400);
    let again = body_file::read::<3>(&place.file("halves.stl", halves)).expect("closed");
    assert!(again == knot);
}

#[test]
fn what_is_wrong_with_a_file_is_told_with_its_place() {
    let place = Place::new();
    let scene = |file: &str, more: &str| {
        format!(
            "[mesh]\ncells = [4, 4, 4]\n[[material]]\nname = \"a\"\nshape = {{ body = {{ file = \"{file}\"{more} }} }}\n"
        )
    };
    let mut open = fs::read(shipped("knot.stl")).expect("it is there");
    open.truncate(84 + 50 * 2399);
    open[80..84].copy_from_slice(&2399_u32.to_le_bytes());
    place.file("open.stl", &open);
    let mut odd = open.clone();
    odd[84 + 50 * 7 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    place.file("odd.stl", &odd);
    place.file("cut.stl", &open[..1000]);
    let once = fs::read(shipped("knot.stl")).expect("it is there");
    let mut twice = [&once[..], &once[84..]].concat();
    twice[80..84].copy_from_slice(&4800_u32.to_le_bytes());
    place.file("twice.stl", &twice);
    place.file("empty.obj", "# nothing\n");
    place.file("away.obj", "v 0 0 0\nf 1 2 3\n");
    place.file("gear.txt", "0, 0\n1, 0\n");
    let cases = [
        ("none.stl", "", "none.stl"),
        ("open.stl", "", "no other one shares"),
        ("odd.stl", "", "triangle 8 has a coordinate that is not finite"),
        ("cut.stl", "", "no STL file"),
        (
            "twice.stl",
            "",
            "triangle 1 lies where the surface overlaps or is turned over: it winds 2 times around one side",
        ),
        ("empty.obj", "", "no triangles"),
        ("away.obj", "", "no OBJ file"),
        ("gear.txt", "", "no file of a body in space"),
        ("open.stl", ", scale = -1.0", "the scale of the body is -1"),
        ("open.stl", ", translation = [1.0]", "the translation of the body is a list of 1"),
    ];
    for (file, more, told) in cases {
        place.file("scene.toml", scene(file, more));
        let done = place.vofkit(&["reconstruct", "scene.toml"]);
        assert_eq!(done.code, Some(1), "{file}");
        let words = done.told();
        assert!(words.contains(told) && words.contains("scene.toml:5"), "{file}: {}", done.err);
        assert!(!place.path("out").exists());
    }
    let wrong = |text: &str| body_file::read::<2>(&place.file("points.txt", text)).expect_err("no polygon");
    assert!(wrong("0 0\n1 0\n1 1\n\n3, x\n").to_string().contains("line 5"));
    assert!(wrong("0 0\n1 0\n\n").to_string().contains("before line 3 has 2 points"));
    assert!(matches!(wrong("# none\n"), BodyFileError::Surface { error: BodyError::Empty, .. }));
    let eight = wrong("0 0\n1 0\n1 1\n\n# eight\n0 0\n3 3\n3 0\n0 3\n").to_string();
    assert!(eight.contains("the segments from lines 6, 8 run through each other"), "{eight}");
    for odd in ["nan 1", "1, -inf"] {
        let told = wrong(&format!("# one\n0 0\n{odd}\n1 1\n")).to_string();
        assert!(told.contains(&format!("line 3 is \"{odd}\", not two finite numbers")), "{told}");
    }
    for size in ["1e150", "1e-150"] {
        let error = wrong(&format!("0 0\n{size} 0\n0 {size}\n"));
        let told = format!("is {size} long: its volume is outside the range");
        assert!(error.to_string().contains(&told) && error.help().contains("other units"), "{error}");
    }
    assert!(matches!(wrong("0 0\n1 1\n2 2\n"), BodyFileError::Surface { error: BodyError::Flat { .. }, .. }));
}
