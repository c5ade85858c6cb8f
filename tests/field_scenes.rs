//! Scenes with fields: what their summaries, tables and files say, and every way to get a field wrong.
#![cfg(all(feature = "cli", feature = "obj", feature = "vtk", feature = "plot"))]

mod cli_support;

use std::fs;

use cli_support::{Place, number, scene};
use serde_json::Value;
use vofkit::scene::{Scene, SceneError};

fn field<'a>(summary: &'a Value, name: &str) -> &'a Value {
    let fields = summary["fields"].as_array().unwrap();
    fields
        .iter()
        .find(|field| field["name"] == name)
        .unwrap_or_else(|| panic!("no field {name} in {summary}"))
}

#[test]
fn square_waves_do_what_the_paper_says() {
    let place = Place::new();
    let donor = place.run("fields/square_wave_donor", "d", &[]);
    let lax_wendroff = place.run("fields/square_wave_lax_wendroff", "l", &[]);
    let tvd = place.run("fields/square_wave_tvd", "t", &[]);
    let all =
        [(&donor, "donor"), (&lax_wendroff, "fct"), (&tvd, "tvd"), (&tvd, "van_leer"), (&tvd, "superbee")];
    for (summary, name) in all {
        let field = field(summary, name);
        assert!(number(&field["conserved"]).abs() <= 1e-13, "{field}");
        assert!(number(&field["minimum"]) >= -1e-12 && number(&field["maximum"]) <= 1.0 + 1e-12, "{field}");
        let [start, end] = ["initial", "final"].map(|when| number(&field[format!("total_variation_{when}")]));
        assert!((start - 2.0).abs() <= 1e-12 && end <= start + 1e-12, "{field}");
    }
    // With one value per cell on equal cells Galerkin's form is the same.
    let galerkin = field(&lax_wendroff, "galerkin");
    for key in ["l1_error", "minimum", "maximum"] {
        let [a, b] = [galerkin, field(&lax_wendroff, "lax_wendroff")].map(|field| number(&field[key]));
        assert!((a - b).abs() <= 1e-12, "{key}: {a} {b}");
    }
    let oscillates = field(&lax_wendroff, "lax_wendroff");
    assert!(number(&oscillates["maximum"]) >= 1.1 && number(&oscillates["minimum"]) <= -0.1, "{oscillates}");
    assert!(number(&oscillates["conserved"]).abs() <= 1e-13, "{oscillates}");
    let error = |summary: &Value, name: &str| number(&field(summary, name)["l1_error"]);
    assert!(error(&donor, "donor") >= 0.1);
    assert!(error(&tvd, "tvd") <= 0.2 * error(&donor, "donor"));
    assert!(error(&tvd, "van_leer") <= 0.5 * error(&donor, "donor"));
    let table = fs::read_to_string(place.path("t").join("fields.csv")).unwrap();
    assert_eq!(table.lines().count(), 102);
    assert!(table.starts_with("step,time,tvd.amount,tvd.minimum,"), "{table}");
    for file in ["field_tvd_first.svg", "field_tvd_last.svg"] {
        assert!(fs::read_to_string(place.path("t").join(file)).unwrap().contains("<polyline"));
    }
}

/// Fig. 6 and 7.
#[test]
fn the_direct_scheme_does_what_the_paper_says() {
    let place = Place::new();
    let summary = place.run("fields/square_wave_direct", "d", &[]);
    let [plain, smoothed] = ["plain", "smoothed"].map(|name| field(&summary, name));
    // It breaks up without smoothing; with it, it leaves the bounds and is rounded off.
    assert!(number(&plain["maximum"]) >= 2.0 && number(&plain["minimum"]) <= -1.0, "{plain}");
    assert!(number(&plain["total_variation_final"]) >= 10.0, "{plain}");
    assert!(number(&smoothed["maximum"]) <= 1.5 && number(&smoothed["minimum"]) >= -0.5, "{smoothed}");
    assert!(number(&smoothed["l1_error"]) < 0.5 * number(&plain["l1_error"]), "{plain} {smoothed}");
    let faster = ["advection.courant=0.7", "advection.steps=43", "field.0.alpha=1.7"];
    for (folder, settings) in [("slow", &[][..]), ("fast", &faster)] {
        let summary = place.run("fields/square_wave_weighted", folder, settings);
        let weighted = field(&summary, "weighted");
        assert!(number(&weighted["l1_error"]) <= 0.15, "{folder} {weighted}");
        assert!(number(&weighted["minimum"]) <= -0.1, "{folder} {weighted}");
        assert!(number(&weighted["conserved"]).abs() <= 1e-13, "{folder} {weighted}");
        let consistent = field(&summary, "consistent");
        assert_eq!(number(&consistent["l1_error"]) <= 0.15, folder == "slow", "{folder} {consistent}");
    }
}

#[test]
fn at_a_courant_number_of_one_the_wave_is_shifted() {
    let place = Place::new();
    let settings = ["advection.courant=1.0", "advection.steps=30"];
    for (scene, names) in [
        ("square_wave_donor", &["donor"][..]),
        ("square_wave_lax_wendroff", &["lax_wendroff", "galerkin", "fct"]),
        ("square_wave_tvd", &["tvd", "van_leer", "superbee"]),
    ] {
        let summary = place.run(&format!("fields/{scene}"), scene, &settings);
        for name in names {
            let error = number(&field(&summary, name)["l1_error"]);
            assert!(error <= 1e-13, "{name}: {error:e}");
        }
    }
}

#[test]
fn a_circular_wave_spreads_less_in_sweeps_than_all_at_once() {
    let place = Place::new();
    for (folder, distortion) in
        [("u", "mesh.distortion=none"), ("d", "mesh.distortion={random={amplitude=0.2,seed=1}}")]
    {
        let run = |way: &str| {
            let setting = format!("advection.scheme={way}");
            place.run("fields/circular_wave", &format!("{folder}_{way}"), &[distortion, &setting])
        };
        let (sweeps, at_once) = (run("sweeps"), run("isotropic"));
        for name in ["tvd", "muscl"] {
            for summary in [&sweeps, &at_once] {
                assert!(number(&field(summary, name)["conserved"]).abs() <= 1e-13, "{name}");
            }
        }
        let [low, high] = ["minimum", "maximum"].map(|key| number(&field(&sweeps, "muscl")[key]));
        assert!(low >= -1e-12 && high <= 1.0 + 1e-12, "{low} {high}");
        // The paper's scheme; `muscl` is as good either way at this Courant number.
        let [in_sweeps, isotropic] = [&sweeps, &at_once].map(|summary| field(summary, "tvd"));
        assert!(number(&in_sweeps["l1_error"]) < number(&isotropic["l1_error"]), "{in_sweeps} {isotropic}");
        assert!(place.path(&format!("{folder}_isotropic")).join("fields_0001.vts").exists());
    }
    // More than cells hold: refused, unless it is said to go on.
    let settings = ["advection.scheme=isotropic", "advection.courant=0.7", "advection.substeps=off"];
    let beyond = place.run("fields/circular_wave", "beyond", &settings);
    assert!(number(&field(&beyond, "muscl")["conserved"]).abs() <= 1e-13, "{beyond}");
}

#[test]
fn a_fraction_disperses_as_a_field_and_not_as_a_material() {
    let place = Place::new();
    let summary = place.run("fields/disc_disperses", "o", &[]);
    let total = 100.0;
    let material = number(&summary["materials"][0]["shape_error"]);
    let [donor, tvd] = ["donor", "tvd"].map(|name| number(&field(&summary, name)["l1_error"]) * total);
    assert!(material <= 0.5 * tvd && tvd < donor, "{material} {tvd} {donor}");
}

#[test]
fn nodes_and_points_are_carried_with_materials() {
    let place = Place::new();
    let summary = place.run("fields/nodal_velocity", "n", &["mesh.cells=[16,16]"]);
    let [his, sale] = ["his", "sale"].map(|name| field(&summary, name));
    for field in [his, sale, field(&summary, "density")] {
        assert!(number(&field["conserved"]).abs() <= 1e-13, "{field}");
    }
    assert!(number(&his["l1_error"]) < 0.5 * number(&sale["l1_error"]), "{his} {sale}");
}

/// Two materials, each with a density, a density of all, a strain at points and velocities at nodes over one moving mesh.
#[test]
fn a_whole_transport_step_keeps_everything() {
    let place = Place::new();
    let summary = place.run("fields/mmale_step", "m", &["mesh.cells=[16,16]"]);
    for name in ["total_density", "strain", "velocity"] {
        assert!(number(&field(&summary, name)["conserved"]).abs() <= 1e-13, "{name}");
    }
    let quantities = summary["quantities"].as_array().unwrap();
    assert_eq!(quantities.len(), 2);
    for quantity in quantities {
        assert_eq!(quantity["name"], "density");
        assert!(number(&quantity["conserved"]).abs() <= 1e-13, "{quantity}");
    }
    for material in summary["materials"].as_array().unwrap() {
        assert!(number(&material["volume_drift"]).abs() <= 1e-12, "{material}");
    }
    assert_eq!(summary["materials"].as_array().unwrap().len(), 2);
    let points = fs::read(place.path("m").join("points_0001.vtp")).unwrap();
    let text = String::from_utf8_lossy(&points);
    assert!(
        text.contains("NumberOfPoints=\"1024\"") && text.contains("Name=\"strain\" NumberOfComponents=\"6\"")
    );
    let grid = fs::read(place.path("m").join("fields_0001.vts")).unwrap();
    let text = String::from_utf8_lossy(&grid);
    assert!(text.contains("<PointData>") && text.contains("Name=\"velocity\" NumberOfComponents=\"3\""));
    // The second run with --force clears what the first one wrote.
    let again = place.run("fields/mmale_step", "m", &["mesh.cells=[8,8]", "output.fields=false"]);
    assert!(!place.path("m").join("points_0001.vtp").exists());
    assert_eq!(again["files"].as_array().unwrap().len(), fs::read_dir(place.path("m")).unwrap().count());
}

#[test]
fn fields_rest_while_the_mesh_moves() {
    let place = Place::new();
    let motions = ["{random={amplitude=0.2,seed=3,swings=2}}", "{wave={amplitude=0.5,swings=2}}"];
    for (folder, motion) in motions.iter().enumerate() {
        let motion = format!("mesh.motion={motion}");
        let summary =
            place.run("fields/remesh_fields", &folder.to_string(), &[&motion, "mesh.cells=[16,16]"]);
        for name in ["constant_muscl", "constant_fct", "constant_direct", "constant_node"] {
            let [low, high] = ["minimum", "maximum"].map(|key| number(&field(&summary, name)[key]));
            assert!(0.7 - low <= 1e-13 && high - 0.7 <= 1e-13, "{name} {motion}: {low} {high}");
        }
        for name in ["wave", "tvd", "velocity"] {
            assert!(number(&field(&summary, name)["conserved"]).abs() <= 1e-13, "{name} {motion}");
        }
        let [low, high] = ["minimum", "maximum"].map(|key| number(&field(&summary, "wave")[key]));
        assert!(low >= 1.0 - 1e-12 && high <= 2.0 + 1e-12, "{motion}: {low} {high}");
        assert!(number(&field(&summary, "wave")["l1_error"]) <= 0.1, "{motion}");
    }
}

#[test]
fn the_number_of_threads_changes_no_bit_of_a_field() {
    let place = Place::new();
    for name in ["mmale_step", "remesh_fields", "circular_wave", "square_wave_weighted"] {
        let path = scene(&format!("fields/{name}"));
        for threads in ["1", "2"] {
            let arguments =
                ["run", path.to_str().unwrap(), "--threads", threads, "--force", "--quiet", "--out"];
            // More than one thread has something to do from 4096 cells on.
            let size = ["--set", "mesh.cells=[72,60]"];
            let steps = ["--set", "advection.courant=0.4", "--set", "output.fields=true"];
            let done = place.vofkit(&[&arguments[..], &[threads], &size, &steps].concat());
            assert_eq!(done.code, Some(0), "{}", done.err);
        }
        for file in place.listed("1").iter().filter(|file| *file != "summary.json") {
            let [one, two] = ["1", "2"].map(|folder| fs::read(place.path(folder).join(file)).unwrap());
            assert!(one == two, "{name} {file} differs");
        }
    }
}

const SCENE: &str = r#"
name = "test"
[mesh]
cells = [12, 12]
[[field]]
name = "phi"
initial = { constant = { value = 1.0 } }
[[field]]
name = "v"
kind = "vector"
location = "node"
initial = { constant = { value = [1.0, 2.0] } }
[velocity]
field = { uniform = { velocity = [1.0, 0.5] } }
[advection]
end_time = 0.25
"#;

fn refused(settings: &[&str]) -> SceneError {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    Scene::parse("test.toml", "test", SCENE, &settings).expect_err("a wrong field")
}

#[test]
fn wrong_fields_are_refused_where_they_are() {
    assert!(Scene::parse("test.toml", "test", SCENE, &[]).is_ok());
    let wrong: &[(&[&str], &str)] = &[
        (&["field.0.scheme=upwind"], "the scheme \"upwind\" is not known"),
        (&["field.0.limiter=minbee"], "the limiter \"minbee\" is not known"),
        (&["field.0.limiter=scaled_min_mod"], "needs its factor alpha"),
        (&["field.0.limiter=scaled_min_mod", "field.0.alpha=2.5"], "alpha is 2.5, not from 0 to 2"),
        (&["field.0.limiter=scaled_min_mod", "field.0.alpha=nan"], "alpha is NaN, not from 0 to 2"),
        (&["field.0.alpha=1.0"], "this limiter has no factor alpha"),
        (&["field.0.scheme=direct", "field.0.smoothing=much"], "the smoothing \"much\" is not known"),
        (&["field.0.scheme=direct", "field.0.smoothing=weighted"], "this smoothing needs its factor alpha"),
        (&["field.0.scheme=direct", "field.0.smoothing=weighted", "field.0.alpha=-0.1"], "alpha is -0.1"),
        (&["field.0.scheme=direct", "field.0.alpha=1.0"], "this smoothing has no factor alpha"),
        (&["field.0.scheme=direct", "field.0.volume_matrix=full"], "the volume matrix \"full\" is not known"),
        (&["field.0.scheme=direct", "field.0.limiter=superbee"], "has no limiter"),
        (&["field.0.scheme=direct", "field.0.inflow=1"], "has no inflow"),
        (&["field.0.scheme=lax_wendroff_galerkin", "field.0.smoothing=local"], "has no smoothing"),
        (&["field.0.volume_matrix=lumped"], "has no volume matrix"),
        (&["field.1.scheme=direct", "field.1.weighting=phi"], "has no mass"),
        (&["field.0.scheme=direct", "field.1.weighting=phi"], "moves no volumes"),
        (&["field.0.scheme=donor", "field.0.limiter=superbee"], "has no limiter"),
        (&["field.0.kind=matrix"], "the kind of field \"matrix\" is not known"),
        (&["field.0.location=edge"], "the location \"edge\" is not known"),
        (&["field.0.nodal=his"], "at the nodes only"),
        (&["field.1.nodal=mean"], "the nodal scheme \"mean\" is not known"),
        (&["field.1.name=phi"], "two fields called \"phi\""),
        (&["field.1.name=a/b"], "cannot be called"),
        (&["field.0.weighting=mass"], "neither \"volume\" nor the name of a field"),
        (&["field.0.weighting=v"], "is no density"),
        (&["field.0.weighting=phi"], "is the field itself"),
        (&["field.0.initial.constant.value=nan"], "not a finite number"),
        (&["field.0.initial.constant.value=[1.0, 2.0]"], "has 1 components"),
        (&["field.1.initial.constant.value=[1.0, 2.0, 3.0]"], "has 2 components"),
        (&["field.0.inflow=inf"], "the inflow holds inf"),
        (&["field.0.initial={square_wave={from=0.5,to=0.2,value=1}}"], "ends at 0.2"),
        (
            &["field.0.initial={circular_wave={centre=[0.5,0.5],radius=0,value=1}}"],
            "the radius of the wave is 0",
        ),
        (&["field.0.initial={circular_wave={centre=[0.5],radius=0.1,value=1}}"], "is a list of 1"),
        (&["field.0.initial={sine={waves=[1e308,0],amplitude=1}}"], "too many"),
        (&["field.0.initial=constant"], "needs values"),
        (&["advection.sweep_order=twice"], "sweep_order \"twice\" is not known"),
    ];
    for (settings, expected) in wrong {
        let error = refused(settings);
        assert!(error.message().contains(expected), "{settings:?}: {error}");
        assert!(error.line().is_some(), "{settings:?}: {error}");
    }
    // A density below zero that carries something.
    let place = Place::new();
    let text =
        SCENE.replace("value = 1.0", "value = -1.0").replace("location = \"node\"", "weighting = \"phi\"");
    let scene = place.file("s.toml", text);
    let done = place.vofkit(&["run", scene.to_str().unwrap(), "--quiet"]);
    assert_eq!(done.code, Some(1));
    let said = ["masses are not negative", "[0, 0]", ":7:", "at least 0"];
    assert!(said.iter().all(|words| done.err.contains(words)), "{}", done.err);
    assert!(!place.path("out").exists());
}

#[test]
fn a_checked_scene_is_the_same_scene() {
    let place = Place::new();
    let scene = place.file("s.toml", SCENE);
    let done = place.vofkit(&["check", scene.to_str().unwrap()]);
    assert_eq!(done.code, Some(0), "{}", done.err);
    assert!(
        done.out.contains("limiter = \"van_leer\"") && done.out.contains("nodal = \"his\""),
        "{}",
        done.out
    );
    let filled = place.file("t.toml", &done.out);
    let again = place.vofkit(&["check", filled.to_str().unwrap()]);
    assert_eq!(again.out, done.out, "{}", again.err);
}
