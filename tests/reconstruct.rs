//! The static job: what is written, what is told, and what is refused.
#![cfg(all(feature = "cli", feature = "obj", feature = "vtk", feature = "plot"))]

mod cli_support;

use std::fs;

use cli_support::{Place, assert_files, number, scene, still_scenes};
use serde_json::Value;

#[test]
fn a_still_interface_is_the_one_that_a_run_starts_from() {
    let place = Place::new();
    let settings = ["mesh.cells=[30,30]", "advection.end_time=0.1", "output.times=[0.0]"];
    place.run("seven_discs", "run", &settings);
    let summary = place.reconstruct("seven_discs", "still", &settings);
    for file in ["interface_0000.vtp", "interface_0000.obj"] {
        let [run, still] = ["run", "still"].map(|folder| fs::read(place.path(folder).join(file)).unwrap());
        assert!(run == still, "{file} differs");
    }
    let nested = summary["materials"].as_array().unwrap().iter().map(|m| number(&m["planes"]["nested"]));
    assert!(nested.sum::<f64>() >= 2.0, "{summary}");
}

/// The sum of the counts by status.
fn total(counts: &Value) -> u64 {
    counts.as_object().unwrap().values().map(|count| count.as_u64().unwrap()).sum()
}

/// The exact volume of the material of a scene.
fn volume(name: &str) -> f64 {
    use std::f64::consts::PI;
    match name {
        "static_disc" => PI * 10.24,
        "static_square" => 25.0,
        "static_sphere" => 4.0 / 3.0 * PI * 32.768,
        "static_cube" => 125.0,
        "static_two_discs" => PI * 8.0,
        "static_film" => 14.0 / 9.0,
        "static_mof" => PI * 4.0,
        _ => panic!("{name}: its volume is not known here"),
    }
}

#[test]
fn every_still_scene_tells_the_truth_on_every_mesh() {
    let place = Place::new();
    let distortions =
        [&[][..], &["mesh.distortion.random.amplitude=0.2"], &["mesh.distortion.wave.amplitude=0.3"]];
    for name in still_scenes() {
        for settings in distortions {
            let tell = format!("{name} {settings:?}");
            let summary = place.reconstruct(&name, "o", settings);
            assert_files(&place, "o", &summary);
            assert_eq!(summary["scene"], name.as_str());
            let material = &summary["materials"][0];
            assert_eq!(material["planes"], summary["planes"], "{tell}");
            assert_eq!(total(&summary["planes"]), summary["mixed_cells"].as_u64().unwrap(), "{tell}");
            let found = number(&material["volume"]);
            assert!((found / volume(&name) - 1.0).abs() <= 1e-9, "{tell}: {found}");
            assert!(number(&summary["microseconds_per_plane"]) > 0.0, "{tell}");
            assert!(number(&summary["positions_per_plane"]) > 0.0, "{tell}");
            let stages = summary["seconds"].as_object().unwrap();
            assert!(stages.len() == 6 && stages.values().all(|seconds| number(seconds) >= 0.0), "{tell}");
            let round = ["static_disc", "static_sphere"].contains(&name.as_str());
            assert_eq!(material["hausdorff_mean"].is_number(), round, "{tell}");
            let error = number(&material["symmetric_difference"]);
            // A film's cells have no plane, or one of its two: anything but the two volumes themselves is possible.
            let most = if name == "static_film" { 2.0 * found } else { 0.05 * found };
            assert!(error <= most, "{tell}: {error}");
            fs::remove_dir_all(place.path("o")).unwrap();
        }
    }
}

#[test]
fn the_area_of_a_disc_and_a_sphere_is_theirs() {
    let place = Place::new();
    let area = |name: &str, cells: &str| {
        let summary = place.reconstruct(name, "o", &[cells, "output.fields=false", "output.interface=[]"]);
        number(&summary["materials"][0]["area"])
    };
    let circle = area("static_disc", "mesh.cells=[30,30]") / (6.4 * std::f64::consts::PI);
    assert!((circle - 1.0).abs() <= 0.01, "{circle}");
    let sphere = area("static_sphere", "mesh.cells=[24,24,24]") / (40.96 * std::f64::consts::PI);
    assert!((sphere - 1.0).abs() <= 0.01, "{sphere}");
}

#[test]
fn errors_are_those_of_the_shape() {
    let place = Place::new();
    let error = |normal: &str, cells: usize, quantity: &str| {
        let settings = [&format!("mesh.cells=[{cells},{cells}]"), &format!("reconstruction.normal={normal}")];
        let summary = place.reconstruct("static_disc", "o", &settings.map(String::as_str));
        number(&summary["materials"][0][quantity])
    };
    for quantity in ["symmetric_difference", "hausdorff_mean"] {
        // A method of second order; one that takes the axis of the cells for the normal.
        let [coarse, fine] = [15, 60].map(|cells| error("swartz", cells, quantity));
        assert!(fine <= coarse / 10.0, "{quantity}: {coarse} {fine}");
        let slic = error("slic", 60, quantity);
        assert!(slic >= 10.0 * fine, "{quantity}: {slic} {fine}");
    }
}

#[test]
fn cells_of_a_film_without_a_direction_are_told_apart() {
    let place = Place::new();
    let summary = place.reconstruct("static_film", "o", &["output.fields=false"]);
    let planes = &summary["planes"];
    assert!(planes["balanced"].as_u64().unwrap() >= 5, "{planes}");
    assert_eq!(planes["flat"], 0, "{planes}");
    // Across the cells there is a direction almost everywhere.
    let tilted = ["material.0.shape.box.angle=0.3", "output.fields=false"];
    let planes = place.reconstruct("static_film", "o", &tilted)["planes"].clone();
    assert!(2 * planes["balanced"].as_u64().unwrap() < total(&planes), "{planes}");
}

#[test]
fn the_velocity_is_not_needed_and_not_looked_at() {
    let place = Place::new();
    let run = place.run("disc_rotation", "run", &["advection.end_time=0.1", "output.times=[0.0]"]);
    let settings = ["velocity=", "advection="];
    for (out, settings) in [("with", &[][..]), ("without", &settings)] {
        let still = place.reconstruct("disc_rotation", out, settings);
        assert_files(&place, out, &still);
        assert_eq!(still["materials"][0]["volume"], run["materials"][0]["volume_initial"]);
        // The same interface and the same picture as at the start of a run.
        for file in ["interface_0000.obj", "interface_0000.vtp", "picture_first.svg"] {
            let [a, b] = ["run", out].map(|folder| fs::read(place.path(folder).join(file)).unwrap());
            assert!(a == b, "{file} differs");
        }
    }
}

#[test]
fn a_run_of_a_scene_without_a_velocity_is_refused() {
    let place = Place::new();
    let path = scene("static_disc");
    let done = place.vofkit(&["run", path.to_str().unwrap(), "--out", "o"]);
    assert_eq!(done.code, Some(1));
    for words in ["missing key `velocity`", "nothing moves", "vofkit reconstruct", "static_disc.toml:1:"] {
        assert!(done.err.contains(words), "no {words:?} in {}", done.err);
    }
    assert!(place.listed(".").is_empty());
}

#[test]
fn what_is_wrong_with_the_start_is_refused_as_in_a_run() {
    let place = Place::new();
    let path = scene("static_disc");
    let wrong: &[(&str, &[&str])] = &[
        ("mesh.cells=[0,15]", &["0 cells along x", "at least 1"]),
        ("mesh.distortion.random.amplitude=0.95", &["cannot be used", "cell [", "amplitude"]),
        ("material.0.shape.disc.radius=-1.0", &["radius", "above 0"]),
        ("material.0.shape.disc.centre=[99,99]", &["nothing of the material \"disc\"", "allow_empty"]),
        ("reconstruction.normal=young", &["\"young\" is not known", "youngs"]),
    ];
    for (setting, answer) in wrong {
        let done = place.vofkit(&["reconstruct", path.to_str().unwrap(), "--out", "o", "--set", setting]);
        assert_eq!(done.code, Some(1), "{setting}: {}", done.err);
        for words in *answer {
            assert!(done.err.contains(words), "{setting}: no {words:?} in {}", done.err);
        }
        assert!(place.listed(".").is_empty(), "{setting}");
    }
}

#[test]
fn folders_are_treated_as_by_a_run() {
    let place = Place::new();
    let path = scene("static_disc");
    let arguments = ["reconstruct", path.to_str().unwrap(), "--quiet"];
    let done = place.vofkit(&arguments);
    assert_eq!((done.code, done.out.as_str(), done.err.as_str()), (Some(0), "", ""));
    assert!(place.path("out/static_disc/fields_0000.vts").exists());
    let again = place.vofkit(&arguments);
    assert_eq!(again.code, Some(1));
    assert!(again.err.contains("exists already") && again.err.contains("--force"), "{}", again.err);
    place.file("out/static_disc/notes.txt", "mine");
    let less = ["--force", "--set", "output.interface=[]", "--set", "output.fields=false"];
    let forced = place.vofkit(&[&arguments[..], &less].concat());
    assert_eq!(forced.code, Some(0), "{}", forced.err);
    assert_eq!(place.listed("out/static_disc"), ["notes.txt", "picture_first.svg", "summary.json"]);
    assert_eq!(place.summary("out/static_disc")["skipped_outputs"].as_array().unwrap().len(), 3);
}

#[test]
fn the_check_says_what_will_be_written() {
    let place = Place::new();
    for name in still_scenes() {
        let path = scene(&name);
        let done = place.vofkit(&["check", path.to_str().unwrap()]);
        assert_eq!((done.code, done.err.as_str()), (Some(0), ""), "{name}");
        assert!(done.out.contains("vofkit reconstruct: nothing moves"), "{}", done.out);
        assert!(!done.out.contains("[advection]"), "{}", done.out);
        let line = done.out.lines().find_map(|line| line.strip_prefix("# files ")).unwrap();
        let mut files: Vec<&str> = line.split_whitespace().collect();
        files.sort_unstable();
        place.reconstruct(&name, "o", &[]);
        assert_eq!(place.listed("o"), files, "{name}");
        fs::remove_dir_all(place.path("o")).unwrap();
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let place = Place::new();
    let path = scene("static_sphere");
    for threads in ["1", "2"] {
        let setting = "mesh.distortion.random.amplitude=0.2";
        let arguments = ["reconstruct", path.to_str().unwrap(), "--threads", threads, "--out", threads];
        let done = place.vofkit(&[&arguments[..], &["--quiet", "--set", setting]].concat());
        assert_eq!(done.code, Some(0), "{}", done.err);
    }
    for file in place.listed("1").iter().filter(|file| *file != "summary.json") {
        let [a, b] = ["1", "2"].map(|out| fs::read(place.path(out).join(file)).unwrap());
        assert!(a == b, "{file} differs");
    }
}
