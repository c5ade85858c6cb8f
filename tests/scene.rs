//! Scene files: values set from outside, the resolved form, and every way to get one wrong.
#![cfg(all(feature = "cli", feature = "obj", feature = "vtk", feature = "plot"))]

mod cli_support;

use cli_support::{Place, scene, scenes};
use vofkit::scene::{Draft, Scene, SceneError, Stepping, StillScene, Substeps, VelocitySetup};
use vofkit::velocity::Field;

const SCENE: &str = r#"
name = "test"
[mesh]
cells = [12, 12]
[[material]]
name = "disc"
shape = { disc = { centre = [0.3, 0.4], radius = 0.2 } }
[velocity]
field = { uniform = { velocity = [1.0, 0.5] } }
[advection]
end_time = 0.25
"#;

fn parse(text: &str, settings: &[&str]) -> Result<Scene, SceneError> {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    Scene::parse("test.toml", "test", text, &settings)
}

fn plane(settings: &[&str]) -> vofkit::scene::Resolved<2> {
    match parse(SCENE, settings).unwrap() {
        Scene::Plane(scene) => *scene,
        Scene::Space(_) => panic!("two numbers of cells are a plane scene"),
    }
}

#[test]
fn the_usual_normals_go_by_dimension_and_scheme() {
    let of = |text: &str, settings: &[&str]| match parse(text, settings).unwrap() {
        Scene::Plane(scene) => scene.normal_word().to_owned(),
        Scene::Space(scene) => scene.normal_word().to_owned(),
    };
    assert_eq!(of(SCENE, &[]), "swartz");
    for overlapping in ["advection.scheme=isotropic", "advection.sweep_axes=cartesian"] {
        assert_eq!(of(SCENE, &[overlapping]), "youngs");
        assert_eq!(of(SCENE, &[overlapping, "reconstruction.normal=lvira"]), "lvira");
    }
    let space = SCENE
        .replace("[12, 12]", "[6, 6, 6]")
        .replace("disc = { centre = [0.3, 0.4]", "sphere = { centre = [0.3, 0.4, 0.5]")
        .replace("[1.0, 0.5]", "[1.0, 0.5, 0.0]");
    assert_eq!(of(&space, &[]), "youngs");
    assert_eq!(of(&space, &["reconstruction.normal=swartz"]), "swartz");
    // Where nothing moves, in space as well those that reproduce planes.
    match Draft::load(scene("static_sphere"), &[]).unwrap().still().unwrap() {
        StillScene::Space(scene) => assert_eq!(scene.normal_word(), "swartz"),
        StillScene::Plane(_) => panic!("a sphere is in space"),
    }
}

#[test]
fn defaults_are_filled_in() {
    let scene = plane(&[]);
    assert_eq!(scene.mesh.lower.as_slice(), [0.0, 0.0]);
    assert_eq!(scene.mesh.upper.as_slice(), [1.0, 1.0]);
    assert!(scene.mesh.distortion.is_none());
    assert_eq!(scene.advection.substeps, Substeps::Error);
    assert_eq!(scene.advection.stepping, Stepping::CourantToTime { courant: 0.5, end_time: 0.25 });
    assert!(scene.output.history && !scene.output.fields && !scene.output.picture);
}

#[test]
fn a_scene_without_a_name_has_that_of_its_file() {
    assert_eq!(parse(SCENE, &["name="]).unwrap().name(), "test");
}

#[test]
fn values_are_set_at_any_depth() {
    let scene = plane(&[
        "mesh.cells.1=20",
        "mesh.distortion={ wave = { amplitude = 0.1 } }",
        "material.0.name=water",
        "material.0.shape.disc.radius=0.1",
        "velocity.field.uniform.velocity=[2, 3]",
        "boundary.inflow=water",
        "advection.courant=",
        "advection.steps=7",
    ]);
    assert_eq!(scene.mesh.cells, [12, 20]);
    assert_eq!(scene.material_names(), ["water"]);
    assert_eq!(scene.boundary.inflow, Some(0));
    let field = Field::Uniform { velocity: [2.0, 3.0, 0.0].into() };
    assert_eq!(scene.field, VelocitySetup::Formula(field));
    assert_eq!(scene.advection.stepping, Stepping::StepsToTime { steps: 7, end_time: 0.25 });
}

#[test]
fn settings_that_fit_nowhere_are_refused() {
    let wrong = [
        ("mesh", "no `=`"),
        ("=3", "not a dotted key"),
        ("material.4.name=x", "not a place"),
        ("name.first=x", "no table"),
        ("mesh.cells.0.1=x", "no table"),
    ];
    for (setting, expected) in wrong {
        let error = parse(SCENE, &[setting]).unwrap_err();
        assert!(error.message().contains(expected), "{setting}: {error}");
        assert!(error.message().contains(setting), "{setting}: {error}");
    }
    let error = parse(SCENE, &["mesh.sells=[3, 3]"]).unwrap_err();
    assert!(error.message().contains("unknown key `sells`"), "{error}");
}

#[test]
fn sections_are_set_as_a_whole_and_removed() {
    let two = ["material.0={name=\"a\",shape={disc={centre=[0.5,0.5],radius=0.1}}}", "material.0.name=b"];
    assert_eq!(plane(&two).material_names(), ["b"]);
    let error = parse(SCENE, &["material.0=x"]).unwrap_err();
    assert!(
        error.message().contains("whole section") && error.message().contains("material.0.name"),
        "{error}"
    );
    let error = parse(SCENE, &["material.0="]).unwrap_err();
    assert!(error.message().contains("no material and no field"), "{error}");
    let error = parse(SCENE, &["material.2="]).unwrap_err();
    assert!(error.message().contains("list of 1"), "{error}");
}

#[test]
fn a_key_in_a_distortion_takes_the_place_of_none() {
    let none = SCENE.replace("[mesh]", "[mesh]\ndistortion = \"none\"");
    for text in [SCENE, &none] {
        let Scene::Plane(scene) = parse(text, &["mesh.distortion.random.amplitude=0.2"]).unwrap() else {
            panic!("two numbers of cells are a plane scene")
        };
        assert_eq!(scene.mesh.distortion, vofkit::mesh::Distortion::Random { amplitude: 0.2, seed: 0 });
    }
}

#[test]
fn values_that_look_like_toml_must_be_toml() {
    for value in ["[1, 2", "{random={amplitude=0.2}", "\"many", "12x", "+", "-many", ".5.", "'a"] {
        let setting = format!("mesh.cells={value}");
        let error = parse(SCENE, &[&setting]).unwrap_err();
        assert!(error.message().contains("no TOML") && error.message().contains(&setting), "{error}");
    }
    assert_eq!(parse(SCENE, &["name=many words"]).unwrap().name(), "many words");
    assert_eq!(parse(SCENE, &["name=\"2d\""]).unwrap().name(), "2d");
}

#[test]
fn errors_outside_of_what_was_set_point_at_the_file() {
    let text = SCENE.replace(END, "end_time = -1.0");
    let line = text.lines().position(|line| line == "end_time = -1.0").unwrap() + 1;
    // Lines before it come and go.
    let settings = ["mesh.distortion={wave={amplitude=0.1}}", "name="];
    let error = parse(&text, &settings).unwrap_err();
    assert_eq!(error.line(), Some(line));
    let shown = |error: SceneError| format!("{:?}", miette::Report::new(error));
    assert!(!shown(error).contains("--set"));
    // What is set is shown as it was set.
    let error = parse(SCENE, &["advection.end_time=-1.0"]).unwrap_err();
    assert!(shown(error).contains("(with --set)"));
}

#[test]
fn every_scene_passes_the_check_and_so_does_its_resolved_form() {
    let place = Place::new();
    assert_eq!(scenes().len(), 24);
    for name in scenes() {
        let path = scene(&name);
        let small: &[&str] = if name.ends_with("3d") { &["--set", "mesh.cells=[10, 10, 20]"] } else { &[] };
        let first = place.vofkit(&[&["check", path.to_str().unwrap()], small].concat());
        assert_eq!((first.code, first.err.as_str()), (Some(0), ""), "{name}");
        let resolved = place.file("resolved.toml", &first.out);
        let second = place.vofkit(&["check", resolved.to_str().unwrap()]);
        assert_eq!((second.code, &second.out), (Some(0), &first.out), "{name}: {}", second.err);
    }
}

/// What a wrong line in the place of a right one must be answered with: the line, and words of message and advice.
struct Wrong {
    right: &'static str,
    wrong: &'static str,
    answer: &'static [&'static str],
}

const fn wrong(right: &'static str, wrong: &'static str, answer: &'static [&'static str]) -> Wrong {
    Wrong { right, wrong, answer }
}

const CELLS: &str = "cells = [12, 12]";
const SHAPE: &str = "shape = { disc = { centre = [0.3, 0.4], radius = 0.2 } }";
const FIELD: &str = "field = { uniform = { velocity = [1.0, 0.5] } }";
const END: &str = "end_time = 0.25";
const NAME: &str = "name = \"disc\"";

const WRONG: &[Wrong] = &[
    wrong(CELLS, "sells = [12, 12]", &["unknown key `sells`", "`cells`, `lower`, `upper`, `distortion`"]),
    wrong(CELLS, "cells = \"many\"", &["invalid type: string \"many\"", "expected a list"]),
    wrong(CELLS, "cells = [12.5, 12]", &["expected a whole number"]),
    wrong(CELLS, "cells = [0, 12]", &["0 cells along x", "at least 1"]),
    wrong(CELLS, "cells = [12, -3]", &["-3 cells along y", "at least 1"]),
    wrong(CELLS, "cells = [12]", &["a list of 1", "2 numbers", "3 for hexahedra"]),
    wrong(CELLS, "cells = [100000, 100000]", &["1.000e10 cells", "no more than 1000000000"]),
    wrong(CELLS, "cells = [9223372036854775807, 9223372036854775807]", &["do not fit into memory"]),
    wrong(CELLS, "cells = [12, 12]]", &["expected newline"]),
    wrong(SHAPE, "shape = { disc = { centre = [0.3, 0.4], radius = -0.2 } }", &["radius", "-0.2", "above 0"]),
    wrong(SHAPE, "shape = { disc = { centre = [0.3, 0.4], radius = 0 } }", &["radius", "above 0"]),
    wrong(SHAPE, "shape = { disc = { centre = [0.3, 0.4], radius = nan } }", &["NaN", "above 0"]),
    wrong(SHAPE, "shape = { disc = { centre = [0.3, inf], radius = 0.2 } }", &["inf", "finite"]),
    wrong(SHAPE, "shape = { disc = { centre = [0.3], radius = 0.2 } }", &["a list of 1", "give 2 numbers"]),
    wrong(SHAPE, "shape = { disc = { centre = [0.3, 0.4] } }", &["missing key `radius`"]),
    wrong(
        SHAPE,
        "shape = { dics = { centre = [0.3, 0.4], radius = 0.2 } }",
        &["unknown word `dics`", "`sphere`"],
    ),
    wrong(SHAPE, "shape = { union = [] }", &["no shapes", "at least one"]),
    wrong(
        SHAPE,
        "shape = { difference = [{ disc = { centre = [0.3, 0.4], radius = 0.2 } }] }",
        &["the difference is a list of 1", "at least one"],
    ),
    wrong(SHAPE, "shape = \"disc\"", &["`disc` needs values: { disc = { centre = [..], radius = 0.2 } }"]),
    wrong(SHAPE, "shape = \"union\"", &["`union` needs values: { union = ["]),
    wrong(SHAPE, "shape = { disc = 3 }", &["integer `3`, expected a table of values"]),
    wrong(FIELD, "field = \"reversed_vortex\"", &["`reversed_vortex` needs values", "{ period = 3.0 }"]),
    wrong(SHAPE, "shape = { half_space = { normal = [0, 0], constant = 1 } }", &["zero length", "not 0"]),
    wrong(
        SHAPE,
        "shape = { box = { centre = [0, 0], lengths = [1, 1], axis = [0, 0, 1], angle = 1 } }",
        &["axis", "three dimensions", "leave it out"],
    ),
    wrong(
        SHAPE,
        "shape = { slotted_disc = { centre = [0.5, 0.5], radius = 0.2, slot_width = 0.5, bridge = 0.1 } }",
        &["slot width", "twice the radius"],
    ),
    wrong(
        SHAPE,
        "shape = { disc = { centre = [3.0, 0.4], radius = 0.2 } }",
        &["nothing of the material \"disc\"", "allow_empty = true"],
    ),
    wrong(NAME, "name = \"void\"", &["\"void\"", "another name"]),
    wrong(NAME, "name = \"\"", &["is empty"]),
    wrong(FIELD, "field = \"eq102\"", &["unknown word `eq102`", "`eq101`"]),
    wrong(FIELD, "field = { uniform = { velocity = [1.0, 0.5, 0.0] } }", &["a list of 3", "give 2 numbers"]),
    wrong(FIELD, "field = { deformation_3d = { period = 3.0 } }", &["three dimensions", "reversed_vortex"]),
    wrong(FIELD, "field = { reversed_vortex = { period = 0.0 } }", &["period is 0", "above 0"]),
    wrong(
        FIELD,
        "field = { reversed_vortex = { period = 1e-320 } }",
        &["period is 1e-320", "from 1e-250 to 1e250"],
    ),
    wrong(FIELD, "field = { uniform = { velocity = [0.0, 0.0] } }", &["velocity is zero", "advection.steps"]),
    wrong(END, "end_time = -1.0", &["end_time is -1", "above 0"]),
    wrong(END, "steps = 0", &["steps is 0", "at least 1"]),
    wrong(END, "end_time = 1e200", &["steps", "shorten"]),
    wrong(END, "end_time = 1e300", &["end_time is 1e300", "from 1e-250 to 1e250"]),
];

#[test]
fn what_is_wrong_is_named_with_its_line_and_what_would_be_right() {
    for Wrong { right, wrong, answer } in WRONG {
        assert_answered(&SCENE.replace(right, wrong), wrong, answer);
    }
}

#[test]
fn no_more_is_shown_than_people_read() {
    let place = Place::new();
    let long = |character: &str| character.repeat(100_000);
    let cases = [
        SCENE.replace("[12, 12]", &format!("{}{}", long("["), long("]"))),
        SCENE.replace("0.4]", &format!("0.4{}]", long(", 0.4"))),
        SCENE.replace("end_time", &long("t")),
        SCENE.replace("\"disc\"", &format!("\"{}\"", long("ü"))),
        SCENE.replace("= 0.25", &format!("= 0.25\nscheme = \"{}\"", long("ß"))),
    ];
    for text in cases {
        let line = text.lines().position(|line| line.len() > 1000).expect("a long line") + 1;
        place.file("long.toml", text);
        let done = place.vofkit(&["check", "long.toml"]);
        let told = done.err.contains(&format!("[long.toml:{line}:"));
        assert!(done.code == Some(1) && told && done.err.len() <= 10_000, "{}", done.err.len());
    }
}

#[test]
fn what_is_wrong_in_added_lines_is_named_too() {
    let added: &[(&str, &str, &[&str])] = &[
        ("[mesh]", "upper = [1.0, 0.0]", &["empty along y", "above the lower end"]),
        ("[mesh]", "distortion = { random = { amplitude = 2.0 } }", &["amplitude 2", "below 1"]),
        (
            "[mesh]",
            "distortion = { random = { amplitude = 0.9 } }",
            &["cannot be used", "cell [", "amplitude"],
        ),
        ("[mesh]", "distortion = { twist = { angle = 20.0 } }", &["cannot be used", "cell [", "angle"]),
        ("[advection]", "courant = 1.5", &["1.5", "above 1", "the limit", "\"auto\""]),
        ("[advection]", "courant = 0.5\nsteps = 3", &["all given", "leave out one"]),
        ("[advection]", "scheme = \"remap\"", &["for meshes that move", "mode"]),
        ("[advection]", "mode = \"remash\"", &["is not known", "available: flow, remesh"]),
        ("[advection]", "substeps = \"maybe\"", &["\"maybe\" is not known", "error, auto, off"]),
        ("[velocity]", "reversal = { flip = {} }", &["either a step or a time", "flip = { step"]),
        ("[velocity]", "reversal = { flip = { step = 0 } }", &["step of the flip is 0", "at least 1"]),
        ("[velocity]", "reversal = { flip = { time = 0 } }", &["time of the flip is 0", "above 0"]),
        ("[velocity]", "reversal = \"flip\"", &["`flip` needs values: { flip = { step = 100 } }"]),
        ("[mesh]", "distortion = \"random\"", &["{ random = { amplitude = 0.2, seed = 1 } }"]),
        ("[mesh]", "lower = [0.0, 1.0]", &["empty along y", "mesh.lower is 1, mesh.upper 1"]),
        ("[velocity]", "reversal = { cosine = { period = -1.0 } }", &["period is -1", "above 0"]),
        ("[velocity]", "reversal = { cosine = { period = 1e-310 } }", &["period is 1e-310", "from 1e-250"]),
        ("[velocity]", "reversal = { flip = { time = 1e-310 } }", &["flip is 1e-310", "from 1e-250"]),
        (
            END,
            "[reconstruction]\nnormal = \"mof\"",
            &["\"mof\" needs the centroids", "use \"swartz\"", "vofkit reconstruct"],
        ),
        (END, "[reconstruction]\nnormal = \"young\"", &["is not known", "youngs, youngs_logical"]),
        (END, "[reconstruction]\nmaterials = \"onion\"", &["is not known", "nested, listed, independent"]),
        (
            END,
            "[boundary]\ninflow = \"water\"",
            &["the inflow material \"water\" is not known", "void, disc"],
        ),
        (END, "[boundary]\nx = [\"wall\", \"wall\"]", &["crosses the wall", "\"outflow\""]),
        (END, "[boundary]\nx = [\"periodic\", \"wall\"]", &["one end only", "[\"periodic\", \"periodic\"]"]),
        (END, "[boundary]\nx = [\"wall\"]", &["boundary.x is a list of 1", "give two"]),
        (END, "[boundary]\nz = [\"wall\", \"wall\"]", &["no z direction", "leave out"]),
        (END, "[output]\ntimes = [-1.0]", &["-1", "at least 0"]),
        (END, "[output]\ninterface = [\"stl\"]", &["\"stl\" is not known", "obj, vtk"]),
        (END, "[[fields]]\nname = \"t\"", &["unknown key `fields`"]),
        (END, "[[field]]\nname = \"t\"", &["missing key `initial`"]),
    ];
    for (after, lines, answer) in added {
        let text = SCENE.replace(after, &format!("{after}\n{lines}"));
        let last = lines.lines().last().unwrap();
        // An unknown or incomplete section is pointed at by its head.
        let named = if lines.starts_with("[[") { lines.lines().next().unwrap() } else { last };
        assert_answered(&text, named, answer);
    }
    // A material that is nowhere is pointed at by its name.
    let text = SCENE.replace(NAME, &format!("{NAME}\n[[material]]\nname = \"disc\""));
    assert_answered(&text, "name = \"disc\"", &["missing key `shape`"]);
}

#[test]
fn pictures_in_space_are_of_materials() {
    let text = "name = \"warm\"\n[mesh]\ncells = [2, 2, 2]\nlower = [0, 0, 0]\nupper = [1, 1, 1]\n\
                [[field]]\nname = \"heat\"\nscheme = \"donor\"\ninitial = { sine = { waves = [1.0, 0.0, 0.0], amplitude = 1.0 } }\n\
                [velocity]\nfield = { uniform = { velocity = [1, 0, 0] } }\n[advection]\nend_time = 0.1\n\
                [output]\npicture = true\n";
    assert_answered(text, "picture = true", &["pictures of materials only", "set picture = false"]);
}

/// Both `check` and `run` fail with file, line and these words, and leave nothing behind.
fn assert_answered(text: &str, wrong: &str, answer: &[&str]) {
    let line = text.lines().position(|line| line == wrong).unwrap() + 1;
    let place = Place::new();
    place.file("wrong.toml", text);
    for command in ["check", "run"] {
        let done = place.vofkit(&[command, "wrong.toml"]);
        assert_eq!(done.code, Some(1), "{wrong}: {}", done.err);
        let position = format!("wrong.toml:{line}:");
        for words in answer.iter().copied().chain([position.as_str()]) {
            assert!(done.err.contains(words), "{wrong}: no {words:?} in\n{}", done.err);
        }
        assert_eq!(place.listed("."), ["wrong.toml"], "{wrong}");
    }
}

#[test]
fn a_run_without_an_end_is_refused() {
    // There is no line to point at but the head of the section.
    assert_answered(&SCENE.replace(END, ""), "[advection]", &["neither", "advection.steps"]);
}

#[test]
fn fields_with_a_period_cannot_be_reversed_again() {
    let path = scene("reversed_vortex");
    let place = Place::new();
    let done = place.vofkit(&["check", path.to_str().unwrap(), "--set", "velocity.reversal={flip={step=3}}"]);
    assert_eq!(done.code, Some(1));
    assert!(
        done.err.contains("turns back by itself") && done.err.contains("leave out `reversal`"),
        "{}",
        done.err
    );
}

#[test]
fn velocities_must_match_at_joined_ends() {
    let path = scene("disc_rotation");
    let place = Place::new();
    let joined = "boundary.x=[\"periodic\",\"periodic\"]";
    let done = place.vofkit(&["check", path.to_str().unwrap(), "--set", joined]);
    assert_eq!(done.code, Some(1));
    assert!(done.err.contains("cannot be joined"), "{}", done.err);
}

#[test]
fn a_hidden_material_is_allowed_on_request_only() {
    let text = SCENE.replace(
        "[velocity]",
        "[[material]]\nname = \"hidden\"\nshape = { disc = { centre = [0.3, 0.4], radius = 0.1 } }\n[velocity]",
    );
    let place = Place::new();
    place.file("hidden.toml", &text);
    let refused = place.vofkit(&["check", "hidden.toml"]);
    assert_eq!(refused.code, Some(1));
    assert!(refused.err.contains("nothing of the material \"hidden\""), "{}", refused.err);
    let allowed = place.vofkit(&["check", "hidden.toml", "--set", "material.1.allow_empty=true"]);
    assert_eq!(allowed.code, Some(0), "{}", allowed.err);
}

#[test]
fn all_unusable_cells_are_listed_by_the_check() {
    let place = Place::new();
    place.file("wrong.toml", SCENE);
    let done =
        place.vofkit(&["check", "wrong.toml", "--set", "mesh.distortion={random={amplitude=0.95,seed=3}}"]);
    assert_eq!(done.code, Some(1));
    let listed = done.out.lines().filter(|line| line.starts_with("cell [")).count();
    let more: usize =
        done.err.lines().find_map(|line| line.split("and ").nth(1)?.split(' ').next()?.parse().ok()).unwrap();
    assert_eq!(listed, more + 10);
}
