//! Files that cannot be used.

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use vofkit::import::StructuredGrid;

use crate::file::{Compression, Encoding, File, Placed};

/// The message and the help for a file with this content.
fn refused(bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.vts");
    std::fs::write(&path, bytes).unwrap();
    let error = StructuredGrid::read(&path).unwrap_err();
    let text = format!("{error}; {}", error.help());
    assert!(text.contains(path.to_str().unwrap()), "{text}");
    text
}

fn assert_answered(bytes: &[u8], answer: &[&str]) {
    let text = refused(bytes);
    for words in answer {
        assert!(text.contains(words), "no {words:?} in {text}");
    }
}

/// The file as text, with one part replaced.
fn replaced(from: &str, to: &str) -> Vec<u8> {
    let encoding = Encoding { placed: Placed::Ascii, ..Encoding::default() };
    let text = String::from_utf8(File::solid().bytes(encoding)).unwrap();
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1).into_bytes()
}

#[test]
fn wrong_values_are_named_with_their_place() {
    let mut file = File::solid();
    file.arrays[1].1[5] = f64::NAN;
    assert_answered(
        &file.bytes(Encoding::default()),
        &["`alpha.two`", "NaN", "cell [2, 1, 0]", "between 0 and 1"],
    );
    file.arrays[1].1[5] = 1.0 + 1e-9;
    assert_answered(&file.bytes(Encoding::default()), &["`alpha.two`", "1.000000001", "no volume fraction"]);
    file.arrays[1].1[5] = -0.25;
    assert_answered(&file.bytes(Encoding::default()), &["`alpha.two`", "-0.25", "cell [2, 1, 0]"]);
    file.arrays[0].1[5] = 0.75;
    file.arrays[1].1[5] = 0.5;
    assert_answered(
        &file.bytes(Encoding::default()),
        &["`alpha.two`", "1.25", "cell [2, 1, 0]", "no more than 1"],
    );
    let mut file = File::flat();
    file.points[7][1] = f64::INFINITY;
    assert_answered(&file.bytes(Encoding::default()), &["`Points`", "inf", "node 7", "component 1"]);
    let mut file = File::flat();
    file.points[7][2] = 2.75;
    assert_answered(&file.bytes(Encoding::default()), &["constant z", "node 7", "2.75"]);
    let mut file = File::flat();
    file.arrays[0].1.pop();
    assert_answered(&file.bytes(Encoding::default()), &["`alpha.one`", "88 bytes", "96"]);
}

/// Devices may never end.
#[cfg(unix)]
#[test]
fn devices_and_folders_are_refused() {
    for path in ["/dev/zero", "/dev"] {
        let error = StructuredGrid::read(path).unwrap_err().to_string();
        assert!(error.contains(path) && error.contains("not a file"), "{error}");
    }
}

#[test]
fn files_that_do_not_fit_are_refused() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("type=\"StructuredGrid\"", "type=\"PolyData\"", &["PolyData", "not a StructuredGrid"]),
        ("<VTKFile", "<VTK", &["no VTK XML file"]),
        ("</Points>", "", &["no VTK XML file"]),
        ("BigEndian", "MiddleEndian", &["byte order is \"MiddleEndian\""]),
        ("header_type=\"UInt64\"", "header_type=\"UInt16\"", &["header type is \"UInt16\""]),
        (
            "header_type=\"UInt64\"",
            "compressor=\"vtkLZMADataCompressor\"",
            &["vtkLZMADataCompressor", "zlib or LZ4"],
        ),
        (
            "<Piece Extent=\"0 3 0 2 0 4\"",
            "<Piece Extent=\"0 3 0 2\"",
            &["extent \"0 3 0 2\"", "six whole numbers"],
        ),
        ("<Piece Extent=\"0 3 0 2 0 4\"", "<Piece Extent=\"0 -3 0 2 0 4\"", &["counts no nodes"]),
        (
            "<Piece Extent=\"0 3 0 2 0 4\"",
            "<Piece Extent=\"0 9223372036854775807 0 9223372036854775807 0 4\"",
            &["counts no nodes"],
        ),
        (
            "<Piece Extent=\"0 3 0 2 0 4\"",
            "<Piece Extent=\"0 3 0 2 0 5\"",
            &["`Points`", "180 numbers", "needs 216"],
        ),
        (
            "Name=\"Points\" NumberOfComponents=\"3\"",
            "Name=\"Points\" NumberOfComponents=\"2\"",
            &["2 components, not 3"],
        ),
        (
            "Name=\"alpha.one\" NumberOfComponents=\"1\"",
            "Name=\"alpha.one\" NumberOfComponents=\"3\"",
            &["`alpha.one`", "3 components, not 1"],
        ),
        ("Name=\"alpha.two\"", "Name=\"alpha.one\"", &["`alpha.one`", "there twice"]),
        (
            "type=\"Float64\" Name=\"alpha.one\"",
            "type=\"String\" Name=\"alpha.one\"",
            &["`alpha.one`", "type \"String\""],
        ),
        (
            "Name=\"alpha.one\" NumberOfComponents=\"1\" format=\"ascii\"",
            "Name=\"alpha.one\" NumberOfComponents=\"1\" format=\"binary\"",
            &["`alpha.one`", "no base64"],
        ),
        (
            "Name=\"alpha.one\" NumberOfComponents=\"1\" format=\"ascii\"",
            "Name=\"alpha.one\" NumberOfComponents=\"1\" format=\"other\"",
            &["`alpha.one`", "format \"other\""],
        ),
        (
            "Name=\"alpha.one\" NumberOfComponents=\"1\" format=\"ascii\"",
            "Name=\"alpha.one\" NumberOfComponents=\"1\" format=\"appended\" offset=\"9\"",
            &["`alpha.one`", "\"9\" of the appended data", "not there"],
        ),
        ("0.125", "much", &["\"much\"", "no number"]),
    ];
    for (from, to, answer) in cases {
        if *from == "BigEndian" {
            assert_answered(&replaced("LittleEndian", to), answer);
        } else {
            assert_answered(&replaced(from, to), answer);
        }
    }
    let mut line = File::solid();
    line.counts = [60, 1, 1];
    line.arrays.clear();
    assert_answered(&line.bytes(Encoding::default()), &["[60, 1, 1] nodes", "two or three axes"]);
    let missing = replaced("<Points>", "<Points name=\"a\">");
    let missing = String::from_utf8(missing).unwrap();
    let (start, end) = (missing.find("<Points").unwrap(), missing.find("</Points>").unwrap());
    assert_answered(format!("{}{}", &missing[..start], &missing[end + 9..]).as_bytes(), &["no points"]);
    let piece = "<Piece Extent=\"0 3 0 2 0 4\"><Points></Points></Piece>";
    assert_answered(&replaced("<Piece", &format!("{piece}<Piece")), &["2 pieces, not one"]);
    assert_answered(b"", &["no VTK XML file"]);
    assert_answered(b"\xff\xfe", &["not UTF-8 at byte 0"]);
    assert_answered(b"<AppendedData", &["no start"]);
}

/// A few bytes that say that they stand for half a terabyte.
#[test]
fn announced_sizes_are_checked_before_memory_is_taken() {
    let bytes = 100_001_u64 * 100_001 * 2 * 24;
    let header = [1, bytes, bytes, 3].map(u64::to_le_bytes).concat();
    let points = [header.as_slice(), &[120, 156, 3]].map(|part| BASE64_STANDARD.encode(part)).concat();
    for compressor in ["vtkZLibDataCompressor", "vtkLZ4DataCompressor"] {
        let text = format!(
            "<VTKFile type=\"StructuredGrid\" header_type=\"UInt64\" compressor=\"{compressor}\"><StructuredGrid>\
             <Piece Extent=\"0 100000 0 100000 0 1\"><Points><DataArray type=\"Float64\" Name=\"Points\" \
             NumberOfComponents=\"3\" format=\"binary\">{points}</DataArray></Points></Piece></StructuredGrid></VTKFile>"
        );
        assert_answered(text.as_bytes(), &["`Points`", &bytes.to_string(), "in 3 compressed ones"]);
    }
}

#[test]
fn blocks_hold_no_more_than_they_announce() {
    for excess in [1, 1000] {
        let encoding = Encoding { compression: Compression::Zlib, excess, ..Encoding::default() };
        assert_answered(&File::flat().bytes(encoding), &["`Points`", "a block of 96 bytes has more"]);
    }
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let error = StructuredGrid::read(folder.path().join("none.vts")).unwrap_err();
    assert!(error.to_string().contains("none.vts") && error.help().contains("existing file"), "{error}");
    StructuredGrid::read(folder.path()).unwrap_err();
}

/// Files that end early, or in which a byte is another one, are read or refused, and nothing else.
#[test]
fn broken_files_never_end_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.vts");
    let mut outcomes = [0, 0];
    for placed in [Placed::Inline, Placed::AppendedRaw, Placed::AppendedBase64] {
        for compression in [Compression::None, Compression::Zlib, Compression::Lz4] {
            let encoding = Encoding { placed, compression, word: 4, ..Encoding::default() };
            let whole = File::flat().bytes(encoding);
            for at in (0..whole.len()).step_by(7) {
                std::fs::write(&path, &whole[..at]).unwrap();
                // What ends behind the last number may do.
                outcomes[usize::from(StructuredGrid::read(&path).is_ok())] += 1;
                for byte in [0, b'9', 0xff] {
                    let mut broken = whole.clone();
                    broken[at] = byte;
                    std::fs::write(&path, &broken).unwrap();
                    outcomes[usize::from(StructuredGrid::read(&path).is_ok())] += 1;
                }
            }
        }
    }
    assert!(outcomes[0] > 1000 && outcomes[1] > 100, "{outcomes:?}");
}
