//! The command line: templates, folders, failures, and what is left behind.
#![cfg(all(feature = "cli", feature = "obj", feature = "vtk", feature = "plot"))]

mod cli_support;

use std::fs;
use std::io::BufReader;
use std::path::Path;

use cli_support::{Place, assert_sound, scene};

/// A scene that runs in no time.
fn small() -> String {
    scene("disc_diagonal").to_str().unwrap().to_owned()
}

#[test]
fn templates_explain_every_key_and_can_be_run() {
    let place = Place::new();
    for kind in ["disc", "sphere", "vortex"] {
        let template = place.vofkit(&["new", kind]);
        assert_eq!((template.code, template.err.as_str()), (Some(0), ""));
        assert!(!template.out.contains('@'), "{}", template.out);
        for line in template.out.lines().filter(|line| !line.starts_with('#')) {
            assert!(line.find("  # ").is_none_or(|_| line.find('#') == Some(29)), "{line}");
        }
        place.file("new.toml", &template.out);
        let checked = place.vofkit(&["check", "new.toml"]);
        assert_eq!(checked.code, Some(0), "{}", checked.err);
        let keys = checked.out.lines().filter_map(|line| line.split_once(" = ")).map(|(key, _)| key);
        for key in keys.filter(|key| !key.starts_with('#')) {
            let explained = |line: &str| line.trim_start_matches("# ").starts_with(&format!("{key} = "));
            assert!(template.out.lines().any(explained), "{key} is not in the template {kind}");
        }
        let cells = if kind == "sphere" { "mesh.cells=[8,8,8]" } else { "mesh.cells=[12,12]" };
        let ran = place.vofkit(&["run", "new.toml", "--set", cells, "--out", kind]);
        assert_eq!(ran.code, Some(0), "{}", ran.err);
        assert_sound(&place, kind, &place.summary(kind));
    }
}

#[test]
fn the_default_folder_carries_the_name_of_the_scene() {
    let place = Place::new();
    let done = place.vofkit(&["run", &small(), "--set", "name=my disc"]);
    assert_eq!(done.code, Some(0), "{}", done.err);
    assert_eq!(place.listed("out"), ["my disc"]);
    assert!(place.listed("out/my disc").contains(&"my disc.pvd".to_owned()));
}

#[test]
fn progress_is_told_in_lines_and_quiet_tells_nothing() {
    let place = Place::new();
    let done = place.vofkit(&["run", &small(), "--out", "a"]);
    assert_eq!(done.code, Some(0));
    let lines = done.err.lines().filter(|line| line.contains("step") && line.contains("left")).count();
    assert!((8..=12).contains(&lines), "{}", done.err);
    assert!(done.out.contains("drift") && done.out.contains("disc"), "{}", done.out);
    let quiet = place.vofkit(&["run", &small(), "--out", "b", "--quiet"]);
    assert_eq!((quiet.code, quiet.out.as_str(), quiet.err.as_str()), (Some(0), "", ""));
}

#[test]
fn an_existing_folder_is_left_alone_without_force() {
    let place = Place::new();
    fs::create_dir(place.path("there")).unwrap();
    fs::write(place.path("there/notes.txt"), "mine").unwrap();
    let done = place.vofkit(&["run", &small(), "--out", "there"]);
    assert_eq!(done.code, Some(1));
    assert!(done.err.contains("exists already") && done.err.contains("--force"), "{}", done.err);
    assert_eq!(place.listed("there"), ["notes.txt"]);
    place.file("file", "mine");
    let done = place.vofkit(&["run", &small(), "--out", "file", "--force"]);
    assert_eq!(done.code, Some(1));
    assert!(done.err.contains("not a folder"), "{}", done.err);
}

#[test]
fn force_replaces_the_files_of_the_earlier_run_and_nothing_else() {
    let place = Place::new();
    let first = place.vofkit(&["run", &small(), "--out", "o", "--quiet"]);
    assert_eq!(first.code, Some(0), "{}", first.err);
    place.file("o/notes.txt", "mine");
    place.file("outside.txt", "mine");
    let mine = [
        "notes.txt",
        "fields_1.vts",
        "fields_00001.vts",
        "interface_0000.stl",
        "picture_last.svg.old",
        "mine.pvd",
    ];
    for name in mine {
        place.file(&format!("o/{name}"), "<DataSet file=\"fields_mine.vts\"/>");
    }
    // A summary that somebody has meddled with.
    let mut summary = place.summary("o");
    let files = summary["files"].as_array_mut().unwrap();
    let absolute = place.path("outside.txt");
    for name in ["notes.txt", "../outside.txt", absolute.to_str().unwrap(), ".", "..", "", "gone.txt"] {
        files.push(name.into());
    }
    place.file("o/summary.json", summary.to_string());
    let left = |place: &Place| {
        let listed = place.listed("o");
        listed.into_iter().filter(|name| !mine.contains(&name.as_str())).collect::<Vec<_>>()
    };
    let settings =
        ["--set", "output.interface=[]", "--set", "output.picture=false", "--set", "output.fields=false"];
    let again =
        place.vofkit(&[&["run", &small(), "--out", "o", "--force", "--quiet"], &settings[..]].concat());
    assert_eq!(again.code, Some(0), "{}", again.err);
    assert_eq!(left(&place), ["history.csv", "summary.json"]);
    assert_eq!(place.listed("o").len(), mine.len() + 2);
    assert!(place.path("outside.txt").exists());
    // A wrong scene does not cost the earlier results.
    let wrong = place.vofkit(&["run", &small(), "--out", "o", "--force", "--set", "advection.courant=3.0"]);
    assert_eq!(wrong.code, Some(1));
    assert_eq!(left(&place), ["history.csv", "summary.json"]);
}

#[test]
fn force_clears_what_an_aborted_run_left() {
    let place = Place::new();
    let first = place.vofkit(&["run", &small(), "--out", "o", "--quiet", "--set", "name=earlier"]);
    assert_eq!(first.code, Some(0), "{}", first.err);
    fs::remove_file(place.path("o/summary.json")).unwrap();
    fs::copy(place.path("o/earlier.pvd"), place.path("o/earliest.pvd.partial")).unwrap();
    for name in
        ["history.csv.partial", "fields_0017.vts.partial", "interface_12345.obj", "summary.json.partial"]
    {
        place.file(&format!("o/{name}"), "half");
    }
    fs::create_dir(place.path("o/fields_0003.vts")).unwrap();
    let settings =
        ["--set", "output.interface=[]", "--set", "output.picture=false", "--set", "output.fields=false"];
    let again =
        place.vofkit(&[&["run", &small(), "--out", "o", "--force", "--quiet"], &settings[..]].concat());
    assert_eq!(again.code, Some(0), "{}", again.err);
    assert_eq!(place.listed("o"), ["fields_0003.vts", "history.csv", "summary.json"]);
}

#[test]
fn folders_above_that_are_not_there_yet_are_made() {
    let place = Place::new();
    let done = place.vofkit(&["run", &small(), "--out", "new/../x/y", "--quiet"]);
    assert_eq!(done.code, Some(0), "{}", done.err);
    assert!(place.listed("x/y").contains(&"summary.json".to_owned()));
    // The same folder by a path that is not there yet.
    let again = place.vofkit(&["run", &small(), "--out", "newer/../x/y", "--quiet"]);
    assert_eq!(again.code, Some(1));
    assert!(again.err.contains("exists already"), "{}", again.err);
    assert_eq!(place.listed("."), ["new", "x"]);
    let forced = place.vofkit(&["run", &small(), "--out", "newer/../x/y", "--quiet", "--force"]);
    assert_eq!(forced.code, Some(0), "{}", forced.err);
}

#[test]
fn arguments_that_make_no_sense_are_refused() {
    let place = Place::new();
    let wrong: &[&[&str]] = &[
        &[],
        &["fly"],
        &["run"],
        &["new", "cube"],
        &["run", "a.toml", "--threads", "0"],
        &["run", "a.toml", "--threads", "-1"],
        &["run", "a.toml", "--threads", "many"],
        &["run", "a.toml", "--fast"],
    ];
    for arguments in wrong {
        let done = place.vofkit(arguments);
        assert_eq!(done.code, Some(2), "{arguments:?}: {}", done.err);
    }
    assert_eq!(place.vofkit(&["--help"]).code, Some(0));
    assert_eq!(place.vofkit(&["--version"]).out.trim(), concat!("vofkit ", env!("CARGO_PKG_VERSION")));
    assert!(place.listed(".").is_empty());
}

#[test]
fn files_that_are_no_scenes_are_refused() {
    let place = Place::new();
    place.file("binary.toml", b"name = \"a\"\nfoo = \"\xff\"\n");
    place.file("empty.toml", "");
    let long = fs::File::create(place.path("long.toml")).unwrap();
    long.set_len(100 << 20).unwrap();
    fs::create_dir(place.path("folder.toml")).unwrap();
    let cases: &[(&str, &[&str])] = &[
        ("missing.toml", &["cannot read", "vofkit new"]),
        ("folder.toml", &["is a folder"]),
        ("binary.toml", &["not UTF-8", "offset 18", "line 2", "UTF-8 text"]),
        ("long.toml", &["too large", "104857600 bytes", "1048576"]),
        ("empty.toml", &["missing key `mesh`", "empty.toml:1:"]),
    ];
    for (file, answer) in cases {
        let done = place.vofkit(&["run", file]);
        assert_eq!(done.code, Some(1), "{file}");
        for words in answer.iter().chain([file]) {
            assert!(done.err.contains(words), "{file}: no {words:?} in\n{}", done.err);
        }
    }
    assert!(!place.path("out").exists());
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let place = Place::new();
    place.file("file", "");
    let done = place.vofkit(&["run", &small(), "--out", "file/below"]);
    assert_eq!(done.code, Some(1));
    assert!(done.err.contains("file/below") && done.err.contains("--out"), "{}", done.err);
}

#[cfg(unix)]
mod disk {
    use std::os::unix::fs::PermissionsExt;
    use std::process::{Command, Stdio};

    use super::*;
    use cli_support::Done;

    #[test]
    fn a_mesh_that_does_not_fit_into_memory_is_refused() {
        let place = Place::new();
        for command in ["check", "run --out o"] {
            let script = format!(
                "ulimit -v 2000000; exec \"$VOFKIT\" {command} '{}' --set 'mesh.cells=[20000,20000]'",
                small()
            );
            let mut shell = Command::new("sh");
            shell
                .args(["-c", &script])
                .env("VOFKIT", env!("CARGO_BIN_EXE_vofkit"))
                .current_dir(place.path("."));
            let done = Done::from(shell.output().unwrap());
            assert_eq!(done.code, Some(1), "{}", done.err);
            let answer = ["20000 x 20000 cells takes about", "there is", "MB", "fewer cells", "^^"];
            for words in answer {
                assert!(done.err.contains(words), "no {words:?} in {}", done.err);
            }
        }
        assert!(place.listed(".").is_empty());
    }

    /// Runs in a shell that lets no file grow beyond a number of blocks of 512 bytes.
    fn limited(place: &Place, blocks: u32, arguments: &str) -> Done {
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$VOFKIT\" {arguments}");
        let mut shell = Command::new("sh");
        shell.args(["-c", &script]).env("VOFKIT", env!("CARGO_BIN_EXE_vofkit")).current_dir(place.path("."));
        Done::from(shell.output().unwrap())
    }

    #[test]
    fn a_disk_that_fills_at_the_start_leaves_nothing() {
        let place = Place::new();
        let done = limited(&place, 8, &format!("run '{}' --out a/b", small()));
        assert_eq!(done.code, Some(1), "{}", done.err);
        assert!(done.err.contains("cannot write") && done.err.contains("fields_0000.vts"), "{}", done.err);
        assert!(place.listed(".").is_empty(), "{:?}", place.listed("."));
    }

    #[test]
    fn a_disk_that_fills_later_leaves_complete_files_only() {
        let place = Place::new();
        let less = "--set 'output.interface=[\"obj\"]' --set output.picture=false --set output.fields=false";
        let steps = "--set advection.courant=0.1 --set output.times=[0.0]";
        let done = limited(&place, 16, &format!("run '{}' --out a {less} {steps}", small()));
        assert_eq!(done.code, Some(1), "{}", done.err);
        assert!(done.err.contains("cannot write") && done.err.contains("history.csv"), "{}", done.err);
        assert_eq!(place.listed("a"), ["interface_0000.obj"]);
        let object = fs::read_to_string(place.path("a/interface_0000.obj")).unwrap();
        assert!(object.starts_with("o disc") && object.ends_with('\n'), "{object}");
    }

    #[test]
    fn a_read_only_folder_is_named() {
        let place = Place::new();
        fs::create_dir(place.path("locked")).unwrap();
        fs::set_permissions(place.path("locked"), fs::Permissions::from_mode(0o555)).unwrap();
        if fs::write(place.path("locked/probe"), "").is_ok() {
            eprintln!("SKIPPED: this user may write to read-only folders");
            return;
        }
        let done = place.vofkit(&["run", &small(), "--out", "locked/below"]);
        assert_eq!(done.code, Some(1));
        assert!(done.err.contains("locked/below") && done.err.contains("permissions"), "{}", done.err);
        assert!(place.listed("locked").is_empty());
    }

    #[test]
    fn a_reader_that_has_had_enough_is_no_failure() {
        let place = Place::new();
        let mut child = place.command().args(["new", "disc"]).stdout(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        assert_eq!(child.wait().unwrap().code(), Some(0));
    }

    #[test]
    fn a_full_standard_output_is_a_failure() {
        let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") else {
            eprintln!("SKIPPED: there is no /dev/full");
            return;
        };
        let place = Place::new();
        let done = Done::from(place.command().args(["new", "disc"]).stdout(full).output().unwrap());
        assert_eq!(done.code, Some(1));
        assert!(done.err.contains("standard output"), "{}", done.err);
    }
}

#[test]
fn pictures_of_results_are_those_of_the_scene() {
    let place = Place::new();
    let settings = ["output.interface=[\"vtk\"]", "output.fields=true", "output.times=[0, 0.2, 0.4]"];
    for name in ["disc_diagonal", "sphere_diagonal"] {
        place.run(name, name, &settings);
        let file = scene(name).to_str().unwrap().to_owned();
        // The middle state is the nearest one.
        for (asked, time) in [("0", "0"), ("0.23", "0.2")] {
            let of_scene =
                place.vofkit(&["picture", &file, "--time", time, "--size", "300x260", "--out", "a.png"]);
            assert_eq!((of_scene.code, of_scene.err.as_str()), (Some(0), ""));
            let of_results =
                place.vofkit(&["picture", name, "--time", asked, "--size", "300x260", "--out", "b.png"]);
            assert_eq!((of_results.code, of_results.err.as_str()), (Some(0), ""));
            let [a, b] = ["a.png", "b.png"].map(|file| fs::read(place.path(file)).unwrap());
            assert!(a == b, "{name}, {time}: {} and {} bytes", a.len(), b.len());
        }
        let last = place.vofkit(&["picture", name]);
        assert!(last.out.starts_with(&format!("{name}.png: {name}, t = ")), "{}", last.out);
    }
    let still = scene("static_two_discs");
    let done = place.vofkit(&["picture", still.to_str().unwrap(), "--fragments", "--normals", "--no-mesh"]);
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""));
    assert_eq!(done.out, "static_two_discs.png: static_two_discs, t = 0\n");
}

/// The frames of a picture that moves, and of one that does not the only one.
fn frames(file: &Path) -> Vec<Vec<u8>> {
    let mut reader = png::Decoder::new(BufReader::new(fs::File::open(file).unwrap())).read_info().unwrap();
    let count = reader.info().animation_control().map_or(1, |control| control.num_frames);
    let mut next = || {
        let mut frame = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut frame).unwrap();
        frame
    };
    let frames = (0..count).map(|_| next()).collect();
    assert!(reader.next_frame(&mut vec![0; reader.output_buffer_size().unwrap()]).is_err());
    frames
}

#[test]
fn an_animation_has_the_pictures_of_all_states() {
    let place = Place::new();
    let settings = ["output.interface=[\"vtk\"]", "output.fields=true", "output.times=[0, 0.2, 0.4]"];
    for name in ["disc_diagonal", "sphere_diagonal"] {
        place.run(name, name, &settings);
        let film = place.vofkit(&["picture", name, "--animate=25", "--size", "300x260", "--out", "film.png"]);
        assert_eq!((film.code, film.err.as_str()), (Some(0), ""));
        assert!(film.out.starts_with(&format!("film.png: {name}, 3 states, t = 0 to ")), "{}", film.out);
        let film = frames(&place.path("film.png"));
        assert_eq!(film.len(), 3);
        let times: [&[&str]; 3] = [&["--time", "0"], &["--time", "0.2"], &[]];
        for (time, frame) in times.iter().zip(film) {
            let still = [&["picture", name, "--size", "300x260", "--out", "still.png"], *time].concat();
            let still = place.vofkit(&still);
            assert_eq!((still.code, still.err.as_str()), (Some(0), ""));
            assert!(frames(&place.path("still.png")) == [frame], "{name}, {time:?}");
        }
    }
}

#[test]
fn pictures_that_cannot_be_drawn_are_explained() {
    let place = Place::new();
    place.run("disc_diagonal", "o", &["output.interface=[\"vtk\"]", "output.fields=false"]);
    fs::create_dir(place.path("empty")).unwrap();
    place.run(
        "disc_diagonal",
        "less",
        &["output.interface=[\"vtk\"]", "output.fields=true", "output.times=[0, 5]"],
    );
    fs::remove_file(place.path("less/fields_0001.vts")).unwrap();
    let before = place.listed(".");
    let (still, fields) = (scene("static_disc"), scene("fields/square_wave_donor"));
    let [still, fields] = [&still, &fields].map(|path| path.to_str().unwrap());
    let cases: &[(&[&str], i32, &[&str])] = &[
        (&["absent"], 1, &["absent"]),
        (&["empty"], 1, &["no time series (.pvd)", "fields = true"]),
        (&["o"], 1, &["no fields at time", "fields = true"]),
        (&["less"], 1, &["disc_diagonal.pvd", "it names less/fields_0001.vts", "put it back, or run"]),
        (&["o", "--time", "77"], 1, &["nothing of time 77", "go from 0 to"]),
        (&["o", "--set", "a=1"], 1, &["--set", "holds results"]),
        (&["o", "--animate=0"], 2, &["1..=1000"]),
        (&["o", "--animate", "--time", "0"], 2, &["cannot be used with"]),
        (&["o", "--animate"], 1, &["no fields at time", "fields = true"]),
        (&["less", "--animate"], 1, &["it names less/fields_0001.vts", "put it back, or run"]),
        (&[&small(), "--animate"], 1, &["no folder with results", "many times"]),
        (&[&small(), "--time", "77"], 1, &["no time 77", "from 0 to"]),
        (&[&small(), "--time", "-1"], 1, &["no time -1"]),
        (&[&small(), "--time", "inf"], 2, &["give a number"]),
        (&[&small(), "--size", "800"], 2, &["such as 800x600"]),
        (&[&small(), "--size", "99x100"], 2, &["from 100 to 4096"]),
        (&[&small(), "--view", "above"], 2, &["front, right", "AZIMUTH,ELEVATION"]),
        (&[&small(), "--view", "top"], 1, &["leave out the view"]),
        (&[&small(), "--slice", "z"], 2, &["AXIS=LAYER"]),
        (&[&small(), "--out", "a.svg"], 1, &["a.svg", ".png"]),
        (&[&small(), "--out", "no/such/a.png"], 1, &["create the folder"]),
        (&[still, "--time", "1"], 1, &["nothing moves"]),
        (&[fields], 1, &["no materials", "picture = true"]),
    ];
    for (arguments, code, answer) in cases {
        let done = place.vofkit(&[&["picture"], *arguments].concat());
        assert_eq!((done.code, done.out.as_str()), (Some(*code), ""), "{arguments:?}");
        for words in *answer {
            assert!(done.err.contains(words), "{arguments:?}: no {words:?} in {}", done.err);
        }
    }
    assert_eq!(place.listed("."), before);
}
