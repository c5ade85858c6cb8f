//! Whole runs of the scenes: volume, bounds, coherence, accuracy, and the same bits with any number of threads.
#![cfg(all(feature = "cli", feature = "obj", feature = "vtk", feature = "plot"))]

mod checkpoints;
#[path = "../cli_support/mod.rs"]
mod cli_support;

use std::fs;

use cli_support::{Place, assert_sound, moving_scenes, number, scene};
use serde_json::Value;

/// Settings that make a scene small.
fn small(name: &str) -> Vec<&'static str> {
    let mut settings = match name {
        "zalesak_disc" => vec!["mesh.cells=[50,50]", "advection.steps=600"],
        "shear_3d" => vec!["mesh.cells=[16,16,32]"],
        // On fewer cells the disc is drawn out to less than a cell.
        "reversed_vortex" => vec!["mesh.cells=[32,32]"],
        "deformation_3d" | "sphere_diagonal" | "sphere_rotation" => vec!["mesh.cells=[12,12,12]"],
        "remesh_smooth" => vec!["mesh.cells=[10,10,10]"],
        "remesh_random" => vec!["mesh.cells=[10,10,10]", "mesh.motion.random.swings=1"],
        "remesh_wave" => vec!["mesh.cells=[20,20]", "mesh.motion.wave.swings=4"],
        _ => vec!["mesh.cells=[20,20]"],
    };
    if ["rudman_shear", "vortex_there_and_back"].contains(&name) {
        settings.extend(["advection.steps=60", "velocity.reversal.flip.step=30"]);
    }
    settings
}

#[test]
fn every_scene_runs_and_tells_the_truth() {
    let place = Place::new();
    for name in moving_scenes() {
        let summary = place.run(&name, &name, &small(&name));
        assert_sound(&place, &name, &summary);
        assert_eq!(summary["scene"], name.as_str());
        let courant = number(&summary["max_courant"]);
        // Remapping has no limit.
        assert!(courant > 0.0 && (courant <= 1.0 || name == "remesh_remap"), "{name}: {courant}");
        // All these motions are rigid or end where they started, or the material rests.
        let error = number(&summary["materials"][0]["shape_error_relative"]);
        assert!((0.0..=1.5).contains(&error), "{name}: {error}");
        let skipped = &summary["skipped"]["reconstructions"];
        let done = number(&summary["cells_reconstructed"]);
        assert!(
            done > 0.0 && number(&skipped["skipped"]) + done == number(&skipped["of"]),
            "{name}: {skipped}"
        );
        let history = fs::read_to_string(place.path(&name).join("history.csv")).unwrap();
        assert_eq!(history.lines().count() as u64, summary["steps"].as_u64().unwrap() + 2);
    }
}

/// In space they are PNG, and those of an earlier run go with its other files.
#[cfg(feature = "plot")]
#[test]
fn runs_in_space_draw_their_start_and_end() {
    let place = Place::new();
    let summary = place.run("sphere_diagonal", "o", &small("sphere_diagonal"));
    for name in ["picture_first.png", "picture_last.png"] {
        assert!(summary["files"].as_array().unwrap().contains(&Value::from(name)), "{}", summary["files"]);
        let picture = fs::read(place.path("o").join(name)).unwrap();
        assert!(picture.starts_with(b"\x89PNG\r\n\x1a\n"), "{name}");
    }
    let file = scene("sphere_diagonal").display().to_string();
    let less = ["--set", "mesh.cells=[6,6,6]", "--set", "output.picture=false"];
    let again = place.vofkit(&[&["run", &file, "--out", "o", "--force"], &less[..]].concat());
    assert!(again.code == Some(0) && !place.path("o/picture_last.png").exists(), "{}", again.err);
}

#[test]
fn the_summary_has_all_its_fields() {
    let place = Place::new();
    let summary = place.run("disc_diagonal", "o", &[]);
    let keys = [
        "scene",
        "dimension",
        "cells",
        "steps",
        "threads",
        "wall_seconds",
        "seconds",
        "max_courant",
        "max_divergence",
        "mixed_cells_mean",
        "cells_reconstructed",
        "positions_closed_form",
        "positions_iterative",
        "evaluations_per_position",
        "skipped",
        "facet_gap_mean",
        "files",
        "materials",
    ];
    let material_keys = [
        "name",
        "volume_initial",
        "volume_final",
        "boundary_volume",
        "volume_drift",
        "fraction_min",
        "fraction_max",
        "shape_error",
        "shape_error_relative",
        "fragments",
        "stray_volume",
        "corrections",
    ];
    let has = |value: &Value, keys: &[&str]| keys.iter().all(|key| value.get(key).is_some());
    assert!(has(&summary, &keys), "{summary}");
    assert!(has(&summary["materials"][0], &material_keys), "{summary}");
    let header = fs::read_to_string(place.path("o/history.csv")).unwrap();
    assert_eq!(
        header.lines().next().unwrap(),
        "step,time,dt,courant,mixed_cells,largest_correction,largest_in_cell,disc.volume,disc.min,disc.max,disc.clipped,disc.rescaled"
    );
}

#[test]
fn the_phases_of_a_run_take_all_its_time() {
    let place = Place::new();
    let steps = ["normals", "positions", "fluxes", "update"];
    let cases: [(&str, &[&str], &[&str]); 5] = [
        ("reversed_vortex", &["mesh.cells=[20,20]"], &steps),
        ("reversed_vortex", &["mesh.cells=[20,20]", "advection.scheme=unsplit"], &steps),
        ("remesh_wave", &["mesh.cells=[20,20]", "mesh.motion.wave.swings=4"], &steps),
        ("remesh_remap", &["mesh.cells=[20,20]"], &steps),
        ("fields/square_wave_tvd", &[], &["fields"]),
    ];
    for (name, settings, busy) in cases {
        let summary = place.run(name, "o", settings);
        let seconds = summary["seconds"].as_object().unwrap();
        let sum: f64 = seconds.values().map(number).sum();
        let whole = number(&summary["wall_seconds"]);
        assert!(seconds.len() == 7 && sum <= 1.01 * whole && sum >= 0.5 * whole, "{name}: {summary}");
        for phase in busy.iter().chain(&["initialise", "output"]) {
            assert!(number(&seconds[*phase]) > 0.0, "{name}: {phase} of {summary}");
        }
        fs::remove_dir_all(place.path("o")).unwrap();
    }
}

#[test]
fn discs_and_spheres_stay_in_one_piece() {
    let place = Place::new();
    for name in ["disc_diagonal", "disc_rotation", "sphere_diagonal", "sphere_rotation"] {
        for courant in [0.3, 0.5, 0.7] {
            let setting = format!("advection.courant={courant}");
            let summary = place.run(name, "o", &[&setting, "output.fields=false", "output.interface=[]"]);
            assert_sound(&place, "o", &summary);
            let material = &summary["materials"][0];
            assert_eq!(material["fragments"], 1, "{name} at {courant}");
            let stray = number(&material["stray_volume"]);
            assert!(stray <= 1e-4, "{name} at {courant}: {stray}");
        }
    }
}

#[test]
fn distorted_meshes_conserve_volume_along_mesh_lines() {
    let place = Place::new();
    let distortions = ["{random={amplitude=0.2,seed=1}}", "{wave={amplitude=0.3}}", "{twist={angle=0.5}}"];
    for name in ["disc_rotation", "sphere_rotation"] {
        for distortion in distortions {
            let setting = format!("mesh.distortion={distortion}");
            let mut settings = small(name);
            settings.push(&setting);
            let summary = place.run(name, "o", &settings);
            assert_sound(&place, "o", &summary);
            settings.push("advection.sweep_axes=cartesian");
            let material = &place.run(name, "o", &settings)["materials"][0];
            let [drift, clipped] =
                [&material["volume_drift"], &material["corrections"]["clipped"]].map(number);
            assert!(drift.abs() <= 0.05 && clipped > 0.0, "{name} {distortion}: {material}");
        }
    }
}

#[test]
fn the_reversed_vortex_is_as_accurate_as_it_should_be() {
    let place = Place::new();
    let nothing = ["output.fields=false", "output.interface=[]", "output.picture=false"];
    let error = |cells: &str, courant: &str| {
        let settings = [&[cells, courant], &nothing[..]].concat();
        number(&place.run("reversed_vortex", "o", &settings)["materials"][0]["shape_error"])
    };
    let coarse = error("mesh.cells=[32,32]", "advection.courant=1.0");
    assert!((3.5e-2..=4.1e-2).contains(&coarse), "{coarse}");
    let fine = error("mesh.cells=[64,64]", "advection.courant=0.5");
    assert!((4e-3..=6e-3).contains(&fine), "{fine}");
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let place = Place::new();
    for (name, settings) in [
        ("disc_rotation", "mesh.cells=[40,40]"),
        ("deformation_3d", "mesh.distortion={wave={amplitude=0.2}}"),
    ] {
        let path = scene(name);
        let shared = ["run", path.to_str().unwrap(), "--quiet", "--set", settings];
        let small: &[&str] = if name.ends_with("3d") {
            &[
                "--set",
                "mesh.cells=[16,16,16]",
                "--set",
                "advection.end_time=0.5",
                "--set",
                "output.times=[0.0,0.5]",
            ]
        } else {
            &[]
        };
        for threads in ["1", "2"] {
            let out = format!("{name}{threads}");
            let done = place.vofkit(&[&shared[..], small, &["--threads", threads, "--out", &out]].concat());
            assert_eq!(done.code, Some(0), "{}", done.err);
            assert_eq!(place.summary(&out)["threads"].to_string(), threads);
        }
        let [one, two] = ["1", "2"].map(|threads| format!("{name}{threads}"));
        assert_eq!(place.listed(&one), place.listed(&two));
        for file in place.listed(&one).iter().filter(|file| *file != "summary.json") {
            let [a, b] = [&one, &two].map(|out| fs::read(place.path(out).join(file)).unwrap());
            assert!(a == b, "{name}: {file} differs");
        }
    }
}

#[test]
fn steps_that_are_too_long_are_split_or_accounted_for() {
    let place = Place::new();
    let split = place.run("disc_rotation", "o", &["advection.courant=2.5", "advection.substeps=auto"]);
    assert_sound(&place, "o", &split);
    assert!(split["substeps"].as_u64().unwrap() >= 3, "{split}");
    let off = place.run("disc_rotation", "o", &["advection.courant=1.5", "advection.substeps=off"]);
    let material = &off["materials"][0];
    assert!(number(&material["corrections"]["clipped"]) > 0.0, "{material}");
}

#[test]
fn what_leaves_through_a_periodic_end_comes_in_at_the_other() {
    let place = Place::new();
    let joined = ["boundary.x=[\"periodic\",\"periodic\"]", "boundary.y=[\"periodic\",\"periodic\"]"];
    let settings = [&joined[..], &["advection.end_time=10.0", "output.times=[0,5,10]"]].concat();
    let summary = place.run("disc_diagonal", "o", &settings);
    assert_sound(&place, "o", &summary);
    let material = &summary["materials"][0];
    let error = number(&material["shape_error_relative"]);
    assert!(error > 0.0 && error <= 0.022, "{material}");
    assert_eq!(material["boundary_volume"], 0.0);
    // Half way through the end: the exact shape is in four pieces.
    let half = [&joined[..], &["advection.end_time=7.5", "output.times=[]"]].concat();
    let material = &place.run("disc_diagonal", "o", &half)["materials"][0];
    assert!(number(&material["shape_error_relative"]) <= 0.02, "{material}");
}

#[test]
fn what_leaves_through_open_ends_is_in_the_balance() {
    let place = Place::new();
    let summary = place.run("disc_diagonal", "o", &["advection.end_time=7.5", "output.times=[]"]);
    assert_sound(&place, "o", &summary);
    let material = &summary["materials"][0];
    let [initial, left, error] =
        ["volume_initial", "boundary_volume", "shape_error_relative"].map(|key| number(&material[key]));
    assert!(left > 0.5 * initial && left < initial, "{material}");
    assert!(error <= 0.02, "{material}");
    // Through a rotation that cannot be told exactly.
    let place_in_corner = "material.0.shape.sphere.centre=[2.0,2.0]";
    let material = &place.run("disc_rotation", "o", &[place_in_corner])["materials"][0];
    assert!(material["shape_error"].is_null(), "{material}");
}

#[test]
fn the_error_is_not_told_where_a_material_flows_in() {
    let place = Place::new();
    // As much comes in as goes out.
    let full = ["material.0.shape={half_space={normal=[1,0],constant=100}}", "boundary.inflow=disc"];
    let settings = [&full[..], &["output.times=[]", "output.picture=false"]].concat();
    let material = &place.run("disc_diagonal", "o", &settings)["materials"][0];
    assert_eq!(number(&material["boundary_volume"]), 0.0, "{material}");
    assert!(material["shape_error"].is_null() && material["shape_error_relative"].is_null(), "{material}");
    // Nothing comes in where nothing moves, or through ends that are joined.
    let still = ["velocity.field.uniform.velocity=[0,0]", "advection.steps=1", "advection.courant="];
    let joined = ["boundary.x=[\"periodic\",\"periodic\"]", "boundary.y=[\"periodic\",\"periodic\"]"];
    for closed in [&still[..], &joined[..]] {
        let material = &place.run("disc_diagonal", "o", &[&settings[..], closed].concat())["materials"][0];
        assert!(number(&material["shape_error"]) <= 1e-9, "{material}");
    }
}

#[test]
fn what_is_not_reached_and_what_was_corrected_is_told() {
    let place = Place::new();
    let path = scene("disc_diagonal");
    let run = |settings: &[&str]| {
        let mut arguments = vec!["run", path.to_str().unwrap(), "--out", "o", "--force"];
        settings.iter().for_each(|setting| arguments.extend(["--set", setting]));
        let done = place.vofkit(&arguments);
        assert_eq!(done.code, Some(0), "{}", done.err);
        done.out
    };
    let plain = run(&[]);
    assert!(!plain.contains("note") && !plain.contains("rescaled"), "{plain}");
    let late = run(&["output.times=[0,99]", "velocity.reversal={flip={time=9}}"]);
    assert!(late.contains("output time 99 is after the end"), "{late}");
    assert!(late.contains("the flip of the velocity is after the end"), "{late}");
    assert_eq!(place.summary("o")["notes"].as_array().unwrap().len(), 2);
    let off = run(&["advection.courant=1.5", "advection.substeps=off"]);
    assert!(off.contains("clipped") && off.contains("rescaled"), "{off}");
}

#[test]
fn only_what_is_asked_for_is_written() {
    let place = Place::new();
    let nothing =
        ["output.fields=false", "output.interface=[]", "output.picture=false", "output.history=false"];
    let summary = place.run("disc_diagonal", "o", &nothing);
    assert_eq!(place.listed("o"), ["summary.json"]);
    assert_eq!(summary["skipped"]["outputs"].as_array().unwrap().len(), 5);
    let late = place.run("disc_diagonal", "o", &["output.times=[0,1,99]"]);
    assert_eq!(late["skipped"]["times_after_end"].to_string(), "[99.0]");
}

#[test]
fn small_geometry_is_scaled_for_obj() {
    let place = Place::new();
    let settings = [
        "mesh.upper=[1e-4,1e-4]",
        "material.0.shape.sphere.centre=[2.5e-5,2.5e-5]",
        "material.0.shape.sphere.radius=1.5e-5",
        "velocity.field.uniform.velocity=[1e-5,1e-5]",
    ];
    let summary = place.run("disc_diagonal", "o", &settings);
    assert_sound(&place, "o", &summary);
    assert_eq!(number(&summary["obj_scale"]), 1e4);
    let object = fs::read_to_string(place.path("o/interface_0000.obj")).unwrap();
    assert!(object.contains("disc_scale_1e4"), "{object}");
}
