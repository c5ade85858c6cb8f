//! What can be wrong with tables and files, one by one: every message says where and what would be right, and no output is left.

use std::fs;

use crate::cli_support::{Done, Place};

const CUBE: &str = "0,0,0,1,0,0,1,1,0,0,1,0,0,0,1,1,0,1,1,1,1,0,1,1";
const NODES: &str = "x0,y0,z0,x1,y1,z1,x2,y2,z2,x3,y3,z3,x4,y4,z4,x5,y5,z5,x6,y6,z6,x7,y7,z7";

/// A table of unit cubes with normals and, behind them, something else.
fn table(columns: &str, rows: &[&str]) -> String {
    let rows: String = rows.iter().map(|row| format!("{CUBE},{row}\n")).collect();
    format!("{NODES},nx,ny,nz,{columns}\n{rows}")
}

/// Runs a question and expects it to fail and to leave nothing.
fn refused(place: &Place, question: &str, words: &[&str]) {
    let done = place.vofkit(&["kernel", question, "in.csv", "--out", "out.csv"]);
    assert_failed(&done, words);
    assert_eq!(place.listed("."), ["in.csv"], "{}", done.err);
}

fn assert_failed(done: &Done, words: &[&str]) {
    assert_eq!(done.code, Some(1), "{}", done.err);
    assert!(done.out.is_empty() && !done.err.contains("panicked"), "{}", done.err);
    for words in words {
        assert!(done.err.contains(words), "no {words:?} in\n{}", done.err);
    }
}

#[test]
fn headers() {
    let good = table("d", &["1,0,0,0.5"]);
    let cases: &[(&str, String, &[&str])] = &[
        ("truncate", String::new(), &["in.csv: the file is empty", "x0,y0,z0"]),
        ("position", "\n\n".to_owned(), &["the file is empty"]),
        (
            "truncate",
            good.replace("x0,", "a,").replace("nz,", "b,"),
            &["missing columns: x0, nz", "first line"],
        ),
        ("truncate", good.replace(',', ";"), &["missing columns: x0, y0", "commas"]),
        ("truncate", table("f", &["1,0,0,0.5"]), &["d (or local_constant)", "vofkit kernel position"]),
        ("position", good.clone(), &["missing column: f", "vofkit kernel truncate"]),
        ("truncate", good.replace("nz,d", "ny,d"), &["`ny` is there twice", "26 and 27", "rename"]),
        ("truncate", table("d,d", &["1,0,0,0.5,0.5"]), &["`d` is there twice", "28 and 29"]),
        ("position", table("f,residual,residual", &["1,0,0,0.5,1,1"]), &["`residual` is there twice"]),
        ("truncate", table("d,category,category", &["1,0,0,0.5,a,b"]), &["`category` is there twice"]),
    ];
    for (question, text, words) in cases {
        let place = Place::new();
        place.file("in.csv", text);
        refused(&place, question, words);
    }
}

#[test]
fn rows() {
    let long = "9".repeat(2 << 20);
    let volume = table("f", &["1,0,0,0.5"]).replace(CUBE, "1,0,0,0,0,0,0,1,0,1,1,0,1,0,1,0,0,1,0,1,1,1,1,1");
    let flat = table("f", &["1,0,0,0.5"]).replace(CUBE, &["0,0,0"; 8].join(","));
    let huge = CUBE.replace('1', "1e200");
    let cases: &[(&str, String, &[&str])] = &[
        ("truncate", table("d", &["1,0,0,0.5", "1,0,0"]), &["in.csv, line 3: 27 fields, the header has 28"]),
        ("truncate", table("d", &["1,0,0,0.5,7"]), &["line 2: 29 fields, the header has 28"]),
        (
            "truncate",
            table("d", &["1,0,0,half"]),
            &["line 2: \"half\" in the column `d` is not a number", "0.25"],
        ),
        ("truncate", table("d", &["1,0,0,"]), &["line 2: \"\" in the column `d` is not a number"]),
        ("truncate", table("d", &["1,0,NaN,1"]), &["line 2: \"NaN\" in the column `nz` is not a finite"]),
        ("truncate", table("d", &["1,0,0,-inf"]), &["\"-inf\" in the column `d` is not a finite number"]),
        (
            "truncate",
            table("d", &["1e999,0,0,1"]),
            &["\"1e999\" in the column `nx` is not a finite", "1.8e308"],
        ),
        ("truncate", table("d", &["1,0,0,1", "0,0,-0.0,1"]), &["line 3: the normal `nx, ny, nz` is zero"]),
        (
            "truncate",
            table("d,local_constant", &["1,0,0,0.5,0.6"]),
            &["line 2: `d` is 0.5", "0.6", "remove one"],
        ),
        ("truncate", table("d,section_area", &["1,0,0,0.5,one"]), &["\"one\" in the column `section_area`"]),
        ("truncate", table("d", &["1,0,0,0.5"]).replace(CUBE, &huge), &["line 2", "is too large", "unit"]),
        (
            "position",
            table("f", &["1,0,0,1", "1,0,0,1.25"]),
            &["line 3: the fraction 1.25", "between 0 and 1"],
        ),
        ("position", table("f", &["1,0,0,-1e-9"]), &["line 2: the fraction -0.000000001", "between 0 and 1"]),
        ("position", table("f", &["1,0,0,nan"]), &["line 2: \"nan\" in the column `f`"]),
        ("position", table("f", &["0,0,0,0.5"]), &["line 2: the normal"]),
        ("position", volume, &["line 2: the cell's volume -1e0 is not positive", "VTK_HEXAHEDRON"]),
        ("position", flat, &["line 2: the cell's volume 0e0 is not positive"]),
        (
            "truncate",
            table("d", &["1,0,0,0.5", &long]),
            &["line 3: a row of more than 1048576 bytes", "quote"],
        ),
        ("truncate", table("d", &["1,0,0,\"0.5", "1,0,0,0.5"]), &["line 2: \"0.5", "is not a number"]),
        // Blank lines count.
        ("truncate", table("d", &["1,0,0,0.5"]) + "\n\n1,2\n", &["line 5: 2 fields"]),
        ("truncate", table("d", &["1,0,0,0.5"]) + "\n\n1,2", &["line 5: 2 fields"]),
        ("truncate", (table("d", &["1,0,0,0.5"]) + "\n1,2").replace('\n', "\r\n"), &["line 4: 2 fields"]),
        (
            "truncate",
            table("note,d", &["1,0,0,\"a\n\nb\",0.5", "1,0,0,a,b"]),
            &["line 5: \"b\" in the column"],
        ),
        // The first of two wrong rows, whatever finds it.
        ("position", table("f", &["1,0,0,2", "1,0"]), &["line 2: the fraction 2 is"]),
        ("position", table("f", &["1,0", "1,0,0,2"]), &["line 2: 26 fields"]),
    ];
    for (question, text, words) in cases {
        let place = Place::new();
        place.file("in.csv", text);
        refused(&place, question, words);
    }
}

#[test]
fn bytes_that_are_no_text() {
    for (content, line) in [(table("d", &["1,0,0,0.5", "1,0,0,?"]), 3), (table("?", &["1,0,0,0.5"]), 1)] {
        let place = Place::new();
        let bytes: Vec<u8> = content.bytes().map(|byte| if byte == b'?' { 0xff } else { byte }).collect();
        place.file("in.csv", bytes);
        refused(&place, "truncate", &[&format!("in.csv, line {line}: not UTF-8"), "UTF-8 text"]);
    }
    let place = Place::new();
    place.file("in.csv", vec![0; 3 << 20]);
    refused(&place, "truncate", &["line 1: a row of more than 1048576 bytes"]);
}

#[test]
fn a_wrong_row_among_many_is_found_at_its_line() {
    let mut rows = vec!["1,0,0,0.5"; 20_000];
    rows[17_000] = "1,0,0,1.5";
    let place = Place::new();
    place.file("in.csv", table("f", &rows));
    refused(&place, "position", &["line 17002: the fraction 1.5"]);
}

#[test]
fn files() {
    let place = Place::new();
    place.file("in.csv", table("d", &["1,0,0,0.5"]));
    place.file("there.csv", "mine");
    place.file("wrong.csv", table("d", &["1,0,0,no"]));
    place.file("a.csv.partial", table("d", &["1,0,0,0.5"]));
    fs::create_dir(place.path("folder")).unwrap();
    let before = place.listed(".");
    let cases: &[(&[&str], &[&str])] = &[
        (&["missing.csv", "--out", "out.csv"], &["cannot read missing.csv", "existing file"]),
        (&["folder", "--out", "out.csv"], &["cannot read folder", "inside the folder"]),
        (&["in.csv", "--out", "there.csv"], &["there.csv exists already", "--force"]),
        (&["in.csv", "--out", "folder"], &["folder exists already"]),
        (&["in.csv", "--out", "folder", "--force"], &["cannot write folder", "choose another one"]),
        (&["in.csv", "--out", "none/out.csv"], &["cannot write none/out.csv", "create the folder"]),
        (&["in.csv", "--out", "in.csv"], &["in.csv would take the place of the input", "--out"]),
        (&["in.csv", "--out", "folder/../in.csv", "--force"], &["would take the place of the input"]),
        (&["a.csv.partial", "--out", "a.csv"], &["would take the place of the input"]),
        (&["wrong.csv", "--out", "there.csv", "--force"], &["wrong.csv, line 2: \"no\""]),
    ];
    for (arguments, words) in cases {
        assert_failed(&place.vofkit(&[&["kernel", "truncate"], *arguments].concat()), words);
        assert_eq!(place.listed("."), before, "{arguments:?}");
        assert_eq!(fs::read(place.path("there.csv")).unwrap(), b"mine");
    }
    let done = place.vofkit(&["kernel", "truncate", "in.csv", "--out", "there.csv", "--force"]);
    assert_eq!(done.code, Some(0), "{}", done.err);
    assert!(fs::read_to_string(place.path("there.csv")).unwrap().ends_with(",1.0,0.5,1.0,0.125,0.25,0.25\n"));
}

#[test]
fn arguments() {
    let place = Place::new();
    place.file("in.csv", table("d", &["1,0,0,0.5"]));
    let wrong: &[&[&str]] = &[
        &["kernel"],
        &["kernel", "cut"],
        &["kernel", "truncate", "in.csv"],
        &["kernel", "truncate", "--out", "out.csv"],
        &["kernel", "truncate", "in.csv", "--out", "out.csv", "--method", "newton"],
        &["kernel", "position", "in.csv", "--out", "out.csv", "--method", "kothe"],
        &["kernel", "truncate", "in.csv", "--out", "out.csv", "--threads", "0"],
    ];
    for arguments in wrong {
        let done = place.vofkit(arguments);
        assert_eq!(done.code, Some(2), "{arguments:?}: {}", done.err);
    }
    assert_eq!(place.listed("."), ["in.csv"]);
}

#[test]
fn a_table_without_rows_is_one() {
    let place = Place::new();
    place.file("in.csv", table("d", &[]));
    let done = place.vofkit(&["kernel", "truncate", "in.csv", "--out", "out.csv"]);
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""));
    assert_eq!(fs::read_to_string(place.path("out.csv")).unwrap().lines().count(), 1);
    assert!(done.out.contains("cells  0") && !done.out.contains("NaN"), "{}", done.out);
}
