//! Planes that move through odd cells: the curves of Fig. 30, and tables that give none.

use std::fs;

use vofkit::geometry::{Cell, HalfSpace, Hexahedron, Quad, Vector};

use crate::cli_support::{Done, Place};
use crate::table::Table;

const ODD_CELLS: &str = include_str!("../../tables/odd_cells.csv");

fn profile(place: &Place, arguments: &[&str]) -> Done {
    place.vofkit(&[&["kernel", "profile", "in.csv", "--out", "out.csv"], arguments].concat())
}

/// The nodes and the normal in a row of cells; the number of nodes.
fn cell(row: &str) -> (Vec<Vector<3>>, Vector<3>) {
    let numbers: Vec<Option<f64>> = row.split(',').skip(1).map(|field| field.parse().ok()).collect();
    let vector = |at: &[Option<f64>]| Vector::<3>::from_fn(|k, _| at[k].unwrap_or(0.0));
    let nodes = numbers[..24].chunks(3).filter(|node| node[0].is_some()).map(vector).collect();
    (nodes, vector(&numbers[24..]))
}

fn fraction<C: Cell<D>, const D: usize>(nodes: &[Vector<3>], normal: &Vector<3>, constant: f64) -> f64 {
    let narrow = |x: &Vector<3>| Vector::<D>::from_fn(|k, _| x[k]);
    let node = |offset: [usize; D]| C::OFFSETS.iter().position(|own| *own == offset).unwrap();
    let cell = C::from_corners(|offset| narrow(&nodes[node(offset)]));
    cell.truncate(&HalfSpace { normal: narrow(normal), constant }).volume / cell.volume()
}

#[test]
fn every_constant_leaves_its_fraction() {
    let place = Place::new();
    place.file("in.csv", ODD_CELLS);
    let done = profile(&place, &[]);
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""));
    let table = Table::read(&place, "out.csv");
    assert_eq!(table.header, ["name", "f", "d", "s", "section_area"]);
    let (names, [f, d, s]) = (table.column("name"), ["f", "d", "s"].map(|name| table.numbers(name)));
    let rows: Vec<&str> = ODD_CELLS.lines().skip(1).collect();
    assert_eq!(f.len(), 101 * rows.len());
    for (cell_of, row) in rows.iter().enumerate() {
        let (nodes, normal) = cell(row);
        let range = 101 * cell_of..101 * (cell_of + 1);
        assert!(row.starts_with(names[range.start]), "{row}");
        assert_eq!((s[range.start], s[range.end - 1]), (0.0, 1.0), "{row}");
        for at in range.clone() {
            let found = match nodes.len() {
                4 => fraction::<Quad, 2>(&nodes, &normal, d[at]),
                _ => fraction::<Hexahedron, 3>(&nodes, &normal, d[at]),
            };
            assert!((found - f[at]).abs() <= 1e-14, "{row}: {found} for {}", f[at]);
            assert!(at == range.start || s[at] > s[at - 1], "{row}: {} after {}", s[at], s[at - 1]);
        }
    }
    // The square and the cube are the same from both sides.
    for symmetric in [0, 4] {
        let own = &s[101 * symmetric..101 * (symmetric + 1)];
        assert!((0..=100).all(|at| (own[at] + own[100 - at] - 1.0).abs() <= 1e-14));
    }
    if cfg!(feature = "plot") {
        let picture = fs::read_to_string(place.path("out.svg")).unwrap();
        assert!(picture.contains("almost a pyramid") && picture.contains("polyline"));
    }
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let header = ODD_CELLS.lines().next().unwrap();
    let square = ODD_CELLS.lines().nth(1).unwrap();
    let row = |from: &str, to: &str| format!("{header}\n{square}\n{}\n", square.replacen(from, to, 1));
    let cases = [
        (String::new(), &["the file is empty"][..]),
        (header.replacen("x3,", "a,", 1), &["missing column: x3"]),
        (header.replacen("x3,", "x2,", 1), &["`x2` is there twice"]),
        (row("square,0,0", "bow-tie,1,1"), &["line 3", "a cell that cannot be used", "VTK_HEXAHEDRON"]),
        (row("square,0,0", "odd,nan,0"), &["line 3", "`x0`", "nan"]),
        (row("square,0,0", "odd,zero,0"), &["line 3", "`x0`", "zero"]),
        (row("0.8,0.6", "0,0"), &["line 3", "normal"]),
        (row("square,", "square,1,"), &["line 3", "fields"]),
    ];
    for (text, words) in cases {
        let place = Place::new();
        place.file("in.csv", &text);
        let done = profile(&place, &[]);
        assert_eq!(done.code, Some(1), "{text}: {}", done.err);
        assert!(!done.err.contains("panicked"), "{}", done.err);
        for words in words {
            assert!(done.err.contains(words), "no {words:?} in\n{}", done.err);
        }
        assert_eq!(place.listed("."), ["in.csv"], "{}", done.err);
    }
    let place = Place::new();
    let many: String = std::iter::repeat_n(format!("{square}\n"), 201).collect();
    place.file("in.csv", format!("{header}\n{many}"));
    assert!(profile(&place, &[]).err.contains("more than 200 cells"));
}

#[test]
fn existing_files_stay() {
    let place = Place::new();
    place.file("in.csv", ODD_CELLS);
    let picture = if cfg!(feature = "plot") { "out.svg" } else { "out.csv" };
    place.file(picture, "mine");
    let done = profile(&place, &[]);
    assert!(done.code == Some(1) && done.err.contains("exists already"), "{}", done.err);
    assert_eq!(fs::read_to_string(place.path(picture)).unwrap(), "mine");
    let done = profile(&place, &["--force", "--quiet"]);
    assert_eq!((done.code, done.out.as_str(), done.err.as_str()), (Some(0), "", ""));
    let own = place.vofkit(&["kernel", "profile", "in.csv", "--out", "in.csv", "--force"]);
    assert!(own.code == Some(1) && own.err.contains("input file"), "{}", own.err);
}
