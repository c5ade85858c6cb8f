//! VTK files.

use super::*;
use crate::python::{Found, floats, get, read_by_vtk};
use std::collections::HashMap;
use vofkit::export::vtk::{CellArray, Collection, fraction_arrays, write_poly_data, write_structured_grid};
use vofkit::geometry::{Hexahedron, Quad};

/// The name, the number of components and the words of each array, in the order of the file, after checking
/// that they fill the appended data without gaps.
fn arrays(path: &Path) -> Vec<(String, usize, Vec<[u8; 8]>)> {
    let bytes = std::fs::read(path).unwrap();
    let find = |what: &[u8]| bytes.windows(what.len()).position(|window| window == what).unwrap();
    let mark = b"<AppendedData encoding=\"raw\">\n_";
    let header = std::str::from_utf8(&bytes[..find(mark)]).unwrap();
    let (start, mut at) = (find(mark) + mark.len(), 0);
    let mut arrays = Vec::new();
    for line in header.lines().filter(|line| line.contains("<DataArray")) {
        let attribute =
            |name: &str| line.split(&format!(" {name}=\"")).nth(1).unwrap().split('"').next().unwrap();
        assert_eq!(attribute("offset").parse::<usize>().unwrap(), at);
        let word = |at: usize| <[u8; 8]>::try_from(&bytes[start + at..start + at + 8]).unwrap();
        let size = u64::from_le_bytes(word(at)) as usize;
        let words = (at + 8..at + 8 + size).step_by(8).map(word).collect();
        arrays.push((attribute("Name").to_owned(), attribute("NumberOfComponents").parse().unwrap(), words));
        at += 8 + size;
    }
    assert_eq!(&bytes[start + at..], b"\n  </AppendedData>\n</VTKFile>\n");
    arrays
}

fn padded<const D: usize>(points: &[Vector<D>]) -> Vec<f64> {
    points.iter().flat_map(|p| (0..3).map(|k| if k < D { p[k] } else { 0.0 })).collect()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| if value.is_nan() { f64::NAN } else { *value }.to_bits()).collect()
}

/// Writes a grid with fractions, volumes and a velocity.
fn write_grid<C: Cell<D>, const D: usize>(path: &Path, mesh: &Mesh<C, D>) -> Vec<Vector<D>> {
    let velocity: Vec<Vector<D>> =
        (0..mesh.grid().len()).map(|cell| mesh.anchor(cell).map(|x| x / 3.0)).collect();
    let fractions = fractions(mesh.grid().len());
    let mut arrays = fraction_arrays(&names(), &fractions);
    arrays.push(CellArray::scalar("volume", mesh.volumes()));
    arrays.push(CellArray::vector("U", &velocity));
    write_structured_grid(path, mesh, &arrays).unwrap();
    velocity
}

#[test]
fn arrays_lie_where_the_header_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.vts");
    let mesh = mesh::<Hexahedron, 3>([3, 2, 4]);
    write_grid(&path, &mesh);
    let found = arrays(&path);
    let shape = |(name, components, words): &(String, usize, Vec<[u8; 8]>)| {
        (name.clone(), *components, words.len() / components)
    };
    let shapes: Vec<_> = found.iter().map(shape).collect();
    let escaped = "alpha.salt &quot;&amp;&quot; &lt;water&gt; #1";
    let expected =
        [("Points", 3, 60), ("alpha.disc", 1, 24), (escaped, 1, 24), ("volume", 1, 24), ("U", 3, 24)];
    assert_eq!(shapes, expected.map(|(name, components, tuples)| (name.to_owned(), components, tuples)));
    let points: Vec<f64> = found[0].2.iter().map(|word| f64::from_le_bytes(*word)).collect();
    assert_eq!(points, padded(mesh.nodes()));
    assert_eq!(files_in(folder.path()), [path]);
}

#[test]
fn facets_with_several_loops_share_their_area() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("interface.vtp");
    write_poly_data(&path, &polygons()).unwrap();
    let found: HashMap<_, _> = arrays(&path).into_iter().map(|(name, _, words)| (name, words)).collect();
    let whole = |name: &str| found[name].iter().map(|word| i64::from_le_bytes(*word)).collect::<Vec<_>>();
    assert_eq!(whole("offsets"), [5, 8, 11]);
    assert_eq!(whole("cell"), [3, 1, 1]);
    assert_eq!(whole("material"), [0, 1, 1]);
    let area: Vec<f64> = found["area"].iter().map(|word| f64::from_le_bytes(*word)).collect();
    assert_eq!(area, [4.0, (10.0 / 3.0) * (0.5 / 1.5), (10.0 / 3.0) * (1.0 / 1.5)]);
}

#[test]
fn arrays_that_do_not_fit_and_files_elsewhere_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.vts");
    let error = write_structured_grid(&path, &mesh::<Quad, 2>([3, 2]), &[CellArray::scalar("a", &[1.0])])
        .unwrap_err();
    assert!(error.to_string().contains("`a` has 1 values, the mesh has 6 cells"), "{error}");
    let mut series = Collection::new(folder.path().join("run.pvd"));
    series.add(0.0, &[("mesh", Path::new("/elsewhere/mesh.vts"))]).unwrap_err();
    assert_eq!(files_in(folder.path()), [] as [PathBuf; 0]);
}

#[test]
fn a_series_is_valid_after_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let mut series = Collection::new(folder.path().join("run.pvd"));
    for step in 1..4 {
        let file = folder.path().join(format!("step <{step}>/mesh.vts"));
        series.add(0.1 * f64::from(step), &[("mesh", &file), ("interface", &file)]).unwrap();
        let text = std::fs::read_to_string(series.path()).unwrap();
        assert_eq!(text.matches("<DataSet").count(), 2 * step as usize);
        assert!(text.contains(&format!("part=\"1\" file=\"step &lt;{step}&gt;/mesh.vts\"")), "{text}");
        assert!(text.ends_with("</VTKFile>\n"));
    }
    assert!(std::fs::read_to_string(series.path()).unwrap().contains("timestep=\"0.30000000000000004\""));
    assert_eq!(files_in(folder.path()), [series.path()]);
}

fn check_grid<C: Cell<D>, const D: usize>(found: &Found, mesh: &Mesh<C, D>, velocity: &[Vector<D>]) {
    let cells = mesh.grid().len();
    assert_eq!(get(found, "class"), ["StructuredGrid"]);
    assert_eq!(floats(found, "counts"), [mesh.nodes().len() as f64, cells as f64]);
    assert_eq!(floats(found, "points"), padded(mesh.nodes()));
    let fractions = fractions(cells);
    assert_eq!(floats(found, "values of alpha.disc"), fractions[0]);
    let odd = "alpha.salt \"&\" <water> #1";
    assert_eq!(bits(&floats(found, &format!("values of {odd}"))), bits(&fractions[1]));
    assert_eq!(get(found, &format!("type of {odd}")), ["1", "8"]);
    assert_eq!(floats(found, "values of volume"), mesh.volumes());
    assert_eq!(get(found, "type of U"), ["3", "8"]);
    assert_eq!(floats(found, "values of U"), padded(velocity));
    assert_eq!(floats(found, "last cell"), padded(mesh.cell(cells - 1).nodes()));
    // VTK takes faces apart into triangles, which costs some volume in 3D.
    let allowed = if D == 2 { 1e-9 } else { 0.05 };
    assert!((floats(found, "sizes")[D - 1] / mesh.total_volume() - 1.0).abs() <= allowed);
    assert!(floats(found, "least sizes")[D - 1] > 0.0);
}

#[test]
fn vtk_reads_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name);
    let [flat, solid, lines, polys, none] = ["2d.vts", "3d.vts", "2d.vtp", "3d.vtp", "none.vtp"].map(file);
    let (quads, hexahedra) = (mesh::<Quad, 2>([4, 3]), mesh::<Hexahedron, 3>([3, 2, 4]));
    let flat_velocity = write_grid(&flat, &quads);
    let solid_velocity = write_grid(&solid, &hexahedra);
    write_poly_data(&lines, &segments()).unwrap();
    write_poly_data(&polys, &polygons()).unwrap();
    write_poly_data::<3>(&none, &[]).unwrap();
    let mut series = Collection::new(file("run.pvd"));
    series.add(0.0, &[("mesh", &solid), ("interface", &polys)]).unwrap();
    series.add(0.1, &[("mesh", &flat), ("interface", &lines)]).unwrap();

    let Some(found) = read_by_vtk(&[&flat, &solid, &lines, &polys, &none, series.path()]) else { return };
    check_grid(&found[0], &quads, &flat_velocity);
    check_grid(&found[1], &hexahedra, &solid_velocity);

    assert_eq!(floats(&found[2], "counts"), [6.0, 3.0]);
    assert_eq!(get(&found[2], "values of cell"), ["4", "0", "0"]);
    assert_eq!(get(&found[2], "values of material"), ["1", "0", "0"]);
    assert_eq!(floats(&found[2], "values of normal"), [0.0, 1.0, 0.0].repeat(3));
    assert_eq!(floats(&found[2], "values of area"), [3.0 + 4.0 / 3.0, 2.0, 1.0]);
    assert_eq!(
        floats(&found[2], "points"),
        padded(&segments().into_iter().flat_map(|f| f.loops).flatten().collect::<Vec<_>>())
    );
    assert!((floats(&found[2], "sizes")[0] - 1.01_f64.sqrt() - 1.5).abs() <= 1e-9);

    assert_eq!(floats(&found[3], "counts"), [11.0, 3.0]);
    assert_eq!(get(&found[3], "type of material"), ["1", "8"]);
    assert_eq!(floats(&found[3], "values of normal"), [0.0, 0.0, 1.0].repeat(3));
    assert!((floats(&found[3], "sizes")[1] - (3.0 + 1.5)).abs() <= 1e-6);
    assert_eq!(floats(&found[4], "counts"), [0.0, 0.0]);

    assert_eq!(floats(&found[5], "times"), [0.0, 0.1]);
    let lines_of = |key: &str| {
        found[5].iter().filter(|item| item.0 == key).map(|item| item.1.as_str()).collect::<Vec<_>>()
    };
    assert_eq!(lines_of("groups"), ["mesh interface", "mesh interface"]);
    assert_eq!(lines_of("cells"), ["24 3", "12 3"]);
}
