//! What the exporters write, read back: byte by byte, by VTK where Python has it, and by small parsers.
#![cfg_attr(not(all(feature = "obj", feature = "plot", feature = "vtk")), allow(dead_code))]

#[cfg(feature = "obj")]
mod obj;
#[cfg(feature = "plot")]
mod picture;
#[cfg(any(feature = "obj", feature = "vtk"))]
mod python;
#[cfg(feature = "vtk")]
mod vtk;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use vofkit::export::{ExportError, write_file};
use vofkit::facet::Facet;
use vofkit::geometry::{Cell, Vector};
use vofkit::mesh::{Distortion, Grid, Mesh};

/// A name that XML, OBJ and file listings could stumble over.
const ODD_NAME: &str = "salt \"&\" <water>\n#1";

fn mesh<C: Cell<D>, const D: usize>(cells: [usize; D]) -> Mesh<C, D> {
    let lower = Vector::<D>::from_fn(|axis, _| 1e6 + axis as f64);
    let upper = lower.add_scalar(2.0);
    Mesh::new(Grid::new(cells, [false; D]), lower, upper, &Distortion::Wave { amplitude: 0.3 }).unwrap()
}

fn names() -> Vec<String> {
    vec!["disc".to_owned(), ODD_NAME.to_owned()]
}

/// Two materials with fractions from 0 to 1, one of them not a number.
fn fractions(cells: usize) -> Vec<Vec<f64>> {
    let first: Vec<f64> = (0..cells).map(|cell| cell as f64 / (cells - 1) as f64).collect();
    let mut second: Vec<f64> = first.iter().map(|f| (1.0 - f) / 3.0).collect();
    second[0] = f64::NAN;
    vec![first, second]
}

fn facet<const D: usize>(cell: usize, material: usize, loops: Vec<Vec<[f64; D]>>) -> Facet<D> {
    let mut normal = Vector::zeros();
    normal[D - 1] = 1.0;
    let loops = loops.into_iter().map(|points| points.into_iter().map(Vector::from).collect()).collect();
    Facet {
        cell,
        material,
        normal,
        plane_constant: 0.1,
        determined: material == 0,
        area: 3.0 + cell as f64 / 3.0,
        loops,
    }
}

/// A segment, two segments in one cell, and a facet without points.
fn segments() -> Vec<Facet<2>> {
    let far = |x: f64, y: f64| [1e6 + x, 1e6 + 1.0 + y];
    vec![
        facet(4, 1, vec![vec![far(1.0, 0.5), far(0.0, 0.4)]]),
        facet(0, 0, vec![vec![far(2.0, 1.0), far(1.0, 1.0)], vec![far(1.0, 1.5), far(0.5, 1.5)]]),
        facet(7, 0, vec![vec![]]),
    ]
}

/// A pentagon that is not convex, and two triangles in one cell of which one is twice the other.
fn polygons() -> Vec<Facet<3>> {
    let dent = vec![[0.0, 0.0, 0.1], [2.0, 0.0, 0.1], [1.0, 0.5, 0.1], [2.0, 2.0, 0.1], [0.0, 2.0, 0.1]];
    let triangle = |size: f64| vec![[0.0, 0.0, 0.1], [size, 0.0, 0.1], [0.0, 1.0, 0.1]];
    vec![
        facet(3, 0, vec![dent]),
        facet(1, 1, vec![triangle(1.0), triangle(-2.0).into_iter().rev().collect()]),
    ]
}

fn files_in(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn a_file_is_complete_or_absent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    let failing = |kind: io::ErrorKind| {
        write_file(&path, |writer| {
            writer.write_all(&[b'x'; 200_000])?;
            Err(kind.into())
        })
        .unwrap_err()
    };
    assert!(failing(io::ErrorKind::StorageFull).to_string().contains("free space"));
    assert_eq!(files_in(folder.path()), [] as [PathBuf; 0]);

    write_file(&path, |writer| writer.write_all(b"old")).unwrap();
    assert!(failing(io::ErrorKind::ReadOnlyFilesystem).to_string().contains("read-only"));
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    write_file(&path, |writer| writer.write_all(b"new")).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"new");
    assert_eq!(files_in(folder.path()), std::slice::from_ref(&path));

    let error = write_file(folder.path().join("no/such/b.txt"), |_| Ok(())).unwrap_err();
    assert!(error.to_string().contains("create the folder"), "{error}");
    for not_a_file in [folder.path(), Path::new(""), Path::new("/dev/null"), Path::new("..")] {
        write_file(not_a_file, |_| Ok(())).unwrap_err();
    }
    assert_eq!(files_in(folder.path()), [path]);
}

/// The partial file is a link to a device that is always full, so that the kernel itself reports the lack of
/// space: while the buffer is emptied, and when it is flushed at the end.
#[test]
#[cfg(target_os = "linux")]
fn nothing_stays_of_a_file_on_a_full_disk() {
    let folder = tempfile::tempdir().unwrap();
    for size in [10, 1_000_000] {
        std::os::unix::fs::symlink("/dev/full", folder.path().join("a.txt.partial")).unwrap();
        let error = write_file(folder.path().join("a.txt"), |writer| writer.write_all(&vec![b'x'; size]))
            .unwrap_err();
        assert!(
            matches!(&error, ExportError::File { error, .. } if error.kind() == io::ErrorKind::StorageFull)
        );
        assert_eq!(files_in(folder.path()), [] as [PathBuf; 0]);
    }
}
