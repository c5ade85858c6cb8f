//! Structured grids of other programs: every encoding, both dimensions, and everything that can be wrong with a file.
#![cfg(all(feature = "cli", feature = "import", feature = "obj", feature = "vtk", feature = "plot"))]

mod centroids;
#[path = "../cli_support/mod.rs"]
mod cli_support;
mod file;
mod legacy;
mod results;
mod scenes;
mod wrong;

use std::path::Path;
use std::process::Command;

use file::{Compression, Encoding, File, Placed};
use vofkit::export::vtk::{fraction_arrays, write_structured_grid};
use vofkit::geometry::{Cell, Hexahedron, Quad};
use vofkit::import::StructuredGrid;
use vofkit::mesh::{Distortion, Grid, Mesh};

/// Everything that a mesh of this kind has comes back with the same bits.
fn round_trip<C: Cell<D>, const D: usize>(cells: [usize; D]) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.vts");
    let mesh = Mesh::<C, D>::unit(cells, &Distortion::Wave { amplitude: 0.3 }).unwrap();
    let names = ["disc".to_owned(), "salt \"&\" <water>".to_owned()];
    let count = mesh.grid().len();
    let fraction = |part: f64| (0..count).map(|cell| part * cell as f64 / count as f64).collect::<Vec<_>>();
    let fractions = [fraction(0.7), fraction(0.3)];
    let mut arrays = fraction_arrays(&names, &fractions);
    arrays.insert(1, vofkit::export::vtk::CellArray::scalar("volume", mesh.volumes()));
    write_structured_grid(&path, &mesh, &arrays).unwrap();
    let read = StructuredGrid::read(&path).unwrap();
    assert_eq!((read.dimension(), read.cells(), read.is_reversed()), (D, cells, false));
    assert_eq!(read.materials().collect::<Vec<_>>(), names.each_ref().map(String::as_str));
    for (name, fractions) in names.iter().zip(&fractions) {
        assert_eq!(read.fractions(name).unwrap(), fractions);
    }
    let again = Mesh::<C, D>::from_nodes(Grid::new(cells, [false; D]), read.nodes()).unwrap();
    assert_eq!((again.nodes(), again.volumes()), (mesh.nodes(), mesh.volumes()));
}

#[test]
fn what_vofkit_writes_it_reads() {
    round_trip::<Quad, 2>([5, 3]);
    round_trip::<Hexahedron, 3>([3, 4, 2]);
}

/// Checks a file against what it was made from.
fn check(path: &Path, made: &File, tell: &str) {
    let read = StructuredGrid::read(path).unwrap_or_else(|error| panic!("{tell}: {error}"));
    let nodes: Vec<[f64; 3]> = read.nodes::<3>().iter().map(|x| (*x).into()).collect();
    assert_eq!(nodes, made.points, "{tell}");
    for (name, values) in &made.arrays {
        assert_eq!(read.fractions(name.strip_prefix("alpha.").unwrap()).unwrap(), values, "{tell}");
    }
}

#[test]
fn every_encoding_gives_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.vts");
    for made in [File::flat(), File::solid()] {
        for placed in [Placed::Ascii, Placed::Inline, Placed::AppendedRaw, Placed::AppendedBase64] {
            for compression in [Compression::None, Compression::Zlib, Compression::Lz4] {
                for (big_endian, word) in [(false, 4), (false, 8), (true, 4), (true, 8)] {
                    for kind in ["Float64", "Float32"] {
                        let encoding = Encoding { placed, compression, big_endian, word, kind, excess: 0 };
                        std::fs::write(&path, made.bytes(encoding)).unwrap();
                        check(&path, &made, &format!("{encoding:?}"));
                    }
                }
            }
        }
    }
}

#[test]
fn pure_cells_may_be_whole_numbers_and_extents_may_start_anywhere() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.vts");
    let mut made = File::solid();
    for (_, values) in &mut made.arrays {
        values.iter_mut().enumerate().for_each(|(cell, value)| *value = (cell % 2) as f64);
    }
    made.arrays.truncate(1);
    for kind in ["Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"] {
        let encoding = Encoding { kind, ..Encoding::default() };
        let text = made.bytes(encoding);
        std::fs::write(&path, text).unwrap();
        check(&path, &made, kind);
    }
    made.first = [-3, 5, 7];
    std::fs::write(&path, made.bytes(Encoding::default())).unwrap();
    check(&path, &made, "another first node");
}

#[test]
fn a_left_handed_order_is_reversed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.vts");
    for right in [File::flat(), File::solid()] {
        let axis = if right.counts[2] == 1 { 1 } else { 2 };
        let left = right.reversed(axis);
        std::fs::write(&path, left.bytes(Encoding::default())).unwrap();
        check(&path, &right, "reversed");
        let read = StructuredGrid::read(&path).unwrap();
        let notes = read.notes();
        assert!(read.is_reversed() && notes.len() == 1 && notes[0].contains("left-handed"), "{notes:?}");
    }
}

#[test]
fn fractions_that_rounding_makes_too_large_are_divided_by_their_sum() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grid.vts");
    let mut made = File::flat();
    (made.arrays[0].1[3], made.arrays[1].1[3]) = (0.25 + 1e-7, 0.75);
    std::fs::write(&path, made.bytes(Encoding::default())).unwrap();
    let read = StructuredGrid::read(&path).unwrap();
    let found = ["one", "two"].map(|name| read.fractions(name).unwrap());
    for (found, (_, made)) in found.iter().zip(&made.arrays) {
        let others = (0..made.len()).filter(|&cell| cell != 3);
        assert!(others.into_iter().all(|cell| found[cell] == made[cell]));
        assert!((found[3] - made[3] / (1.0 + 1e-7)).abs() <= 1e-15, "{}", found[3]);
    }
    assert!((found[0][3] + found[1][3] - 1.0).abs() <= 1e-15);
    let notes = read.notes();
    assert!(notes.len() == 1 && notes[0].contains("in 1 cells"), "{notes:?}");
}

#[test]
fn files_that_vtk_writes_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/python/write_vts.py");
    let output = match Command::new("python3").arg(script).arg(folder.path()).output() {
        Ok(output) if output.status.code() != Some(3) => output,
        Ok(output) => {
            return eprintln!("SKIPPED: no files of VTK: {}", String::from_utf8_lossy(&output.stderr));
        }
        Err(error) => return eprintln!("SKIPPED: no files of VTK: python3: {error}"),
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let names = String::from_utf8(output.stdout).unwrap();
    assert!(names.lines().count() >= 20, "{names}");
    for name in names.lines() {
        let path = folder.path().join(name);
        if name.contains("lzma") {
            let error = StructuredGrid::read(&path).unwrap_err();
            assert!(error.to_string().contains("vtkLZMADataCompressor"), "{error}");
            continue;
        }
        let made = if name.contains("flat") { File::flat() } else { File::solid() };
        check(&path, &made, name);
    }
}
