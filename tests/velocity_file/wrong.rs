//! Files that are no velocity.

use vofkit::import::{ImportError, NodalVelocity, velocity_files};

use crate::cli_support::Place;

/// Nodes of 2 x 2 cells.
const POINTS: &str = "0 0 0 1 0 0 2 0 0 0 1 0 1 1 0 2 1 0 0 2 0 1 2 0 2 2 0";
const VALUES: &str = "0 0 0 1 0 0 2 0 0 0 1 0 1 1 0 2 1 0 0 2 0 1 2 0 2 2 0";

/// A structured grid as text, with a velocity at its nodes.
pub(crate) fn vts(extent: &str, points: &str, values: &str) -> String {
    format!(
        "<VTKFile type=\"StructuredGrid\"><StructuredGrid WholeExtent=\"{extent}\"><Piece Extent=\"{extent}\">\n\
         <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n{points}\n</DataArray></Points>\n\
         <CellData><DataArray type=\"Float64\" Name=\"p\" format=\"ascii\">nan</DataArray></CellData>\n\
         <PointData><DataArray type=\"Float64\" Name=\"U\" NumberOfComponents=\"3\" format=\"ascii\">\n{values}\n\
         </DataArray></PointData>\n</Piece></StructuredGrid></VTKFile>\n"
    )
}

fn good() -> String {
    vts("0 2 0 2 0 0", POINTS, VALUES)
}

fn assert_answered(error: &ImportError, answer: &[&str]) {
    let text = format!("{error}; {}", error.help());
    for words in answer {
        assert!(text.contains(words), "no {words:?} in {text}");
    }
}

#[test]
fn what_is_wrong_with_a_velocity_is_named_with_its_place() {
    let place = Place::new();
    let cases: &[(&str, &str, &[&str])] = &[
        ("\"U\"", "\"V\"", &["no array `U`", "cell data `p`, point data `V`", "called U"]),
        (
            "\"U\" NumberOfComponents=\"3\"",
            "\"U\"",
            &["`U` has 1 components, not 3", "in the plane two or three"],
        ),
        (
            "\"U\" NumberOfComponents=\"3\"",
            "\"U\" NumberOfComponents=\"2\"",
            &["`U` has 27 numbers", "needs 18"],
        ),
        (
            "0 0 0 1 0 0 2 0 0 0 1 0 1 1 0 2 1 0 0 2 0 1 2 0 2 2 0\n</DataArray></P",
            "0</DataArray></P",
            &["`Points`", "has 1 numbers, the grid needs 27"],
        ),
        (
            "2 1 0 0 2 0 1 2 0 2 2 0\n</DataArray></PointData>",
            "2 nan 0 0 2 0 1 2 0 2 2 0\n</DataArray></PointData>",
            &["`U` has NaN in node [2, 1], component 1", "finite velocity"],
        ),
        (
            "2 2 0\n</DataArray></PointData>",
            "2 -inf 0\n</DataArray></PointData>",
            &["`U` has -inf in node [2, 2], component 1"],
        ),
        (
            "2 2 0\n</DataArray></PointData>",
            "2 2\n</DataArray></PointData>",
            &["`U` has 26 numbers", "needs 27"],
        ),
        ("2 2 0\n</DataArray></PointData>", "2 2 x\n</DataArray></PointData>", &["`U` holds \"x\""]),
        (
            "type=\"StructuredGrid\"",
            "type=\"UnstructuredGrid\"",
            &["it holds UnstructuredGrid, not a StructuredGrid"],
        ),
        ("</VTKFile>", "", &["no VTK XML file"]),
    ];
    for (from, to, answer) in cases {
        let text = good();
        assert!(text.contains(from), "{from}");
        let path = place.file("flow.vts", text.replacen(from, to, 1));
        let error = NodalVelocity::read(&path).expect_err(to);
        assert_answered(&error, &[answer, &[path.to_str().unwrap()][..]].concat());
    }
    // Cells are named like nodes.
    let cells = good().replace("<PointData>", "<CellData>").replace("</PointData>", "</CellData>").replace(
        VALUES, // The first one is that of the points.
        "@",
    );
    let cells = cells.replacen('@', POINTS, 1).replacen('@', "1 1 1 2 2 2 3 inf 3 4 4 4", 1);
    let error = NodalVelocity::read(place.file("cells.vts", cells)).expect_err("inf");
    assert_answered(&error, &["`U` has inf in cell [0, 1], component 1"]);
}

#[test]
fn two_components_are_enough_in_the_plane() {
    let place = Place::new();
    let flat = vts("0 2 0 2 0 0", POINTS, "1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8 9");
    let flat = flat.replace("\"U\" NumberOfComponents=\"3\"", "\"U\" NumberOfComponents=\"2\"");
    assert!(NodalVelocity::read(place.file("flat.vts", flat)).is_ok());
}

#[test]
fn what_is_wrong_with_a_series_is_named() {
    let place = Place::new();
    place.file("a.vts", good());
    place.file("b.vts", good());
    let pvd = |entries: &str| {
        let text = format!("<VTKFile type=\"Collection\"><Collection>{entries}</Collection></VTKFile>");
        place.file("flow.pvd", text)
    };
    let entry = |time: &str, file: &str| format!("<DataSet timestep=\"{time}\" file=\"{file}\"/>");
    let cases = [
        (String::new(), vec!["names no structured grids (.vts or .vtk)"]),
        (entry("0", "a.vtp"), vec!["names no structured grids (.vts or .vtk)"]),
        (entry("soon", "a.vts"), vec!["entry 0 has the time \"soon\""]),
        (entry("0", ""), vec!["entry 0 names no file"]),
        (
            entry("-1e308", "a.vts") + &entry("1e308", "b.vts"),
            vec!["entry 0 has the time -1e308", "between -1e250 and 1e250"],
        ),
        (
            entry("1", "a.vts") + &entry("0.5", "b.vts"),
            vec!["b.vts has the time 0.5", "follow 1.0 of", "a.vts", "sort"],
        ),
        (
            entry("1", "a.vts") + &entry("1", "b.vts"),
            vec!["b.vts has the time 1.0", "one file for each time"],
        ),
        (
            entry("1", "a.vts") + &entry("2", "c.vts"),
            vec!["of the time 2.0", "c.vts", "relative to the folder of the .pvd"],
        ),
    ];
    for (entries, answer) in cases {
        let path = pvd(&entries);
        let error = velocity_files(&path).expect_err(&entries);
        assert_answered(&error, &[&answer[..], &["flow.pvd"]].concat());
    }
    // Interfaces beside the grids are passed over.
    let path = pvd(&(entry("0", "a.vts") + &entry("0", "i.vtp") + &entry("1", "b.vts")));
    assert_eq!(velocity_files(path).unwrap().len(), 2);
    assert_answered(&velocity_files(place.path("none.vts")).unwrap_err(), &["cannot read", "none.vts"]);
}

#[test]
fn scenes_point_at_what_is_wrong() {
    let place = Place::new();
    place.file("flow.vts", good());
    place.file("fast.vts", vts("0 2 0 2 0 0", POINTS, &"1e200 0 0 ".repeat(9)));
    let scene = |velocity: &str| {
        format!(
            "[mesh]\ncells = [2, 2]\nupper = [2.0, 2.0]\n[[material]]\nname = \"disc\"\n\
             shape = {{ disc = {{ centre = [1.0, 1.0], radius = 0.5 }} }}\n[velocity]\n{velocity}\n[advection]\nend_time = 0.1\n"
        )
    };
    let cases: &[(&str, &[&str])] = &[
        (
            "field = { file = { path = \"none.vts\" } }",
            &["cannot read", "none.vts", "folder of the scene file"],
        ),
        (
            "field = { file = { path = \"flow.vts\" } }",
            &["flow.vts", "not free of divergence", "cell [", "\"project\"", "\"dilate\""],
        ),
        (
            "field = { file = { path = \"fast.vts\" } }",
            &["fast.vts", "velocities of up to 1e200", "outside the range", "other units"],
        ),
        (
            "field = { file = { path = \"flow.vts\", divergence = \"ignore\" } }",
            &["divergence \"ignore\"", "error, project, dilate"],
        ),
        ("field = \"file\"", &["`file` needs values: { file = { path = \"flow.vts\" } }"]),
        ("field = { file = {} }", &["missing key `path`"]),
    ];
    for (velocity, answer) in cases {
        place.file("wrong.toml", scene(velocity));
        let done = place.vofkit(&["check", "wrong.toml"]);
        assert_eq!(done.code, Some(1), "{velocity}: {}", done.out);
        for words in answer.iter().copied().chain(["wrong.toml:8:"]) {
            assert!(done.err.contains(words), "{velocity}: no {words:?} in\n{}", done.err);
        }
    }
    // A wall that the velocity crosses.
    let walls = scene("field = { file = { path = \"flow.vts\", divergence = \"project\" } }")
        + "[boundary]\nx = [\"wall\", \"wall\"]\n";
    place.file("wrong.toml", walls);
    let done = place.vofkit(&["check", "wrong.toml"]);
    assert!(done.err.contains("crosses the wall at the upper end of x"), "{}", done.err);
}

#[test]
fn no_bytes_make_it_fail_but_with_an_error() {
    let place = Place::new();
    let text = good().into_bytes();
    for end in 0..text.len() {
        let _ = NodalVelocity::read(place.file("cut.vts", &text[..end])).map(|_| ());
    }
    for at in (0..text.len()).step_by(3) {
        for byte in [b'0', b'9', b'-', b'<', 0xff] {
            let mut broken = text.clone();
            broken[at] = byte;
            let _ = NodalVelocity::read(place.file("broken.vts", &broken)).map(|_| ());
        }
    }
}
