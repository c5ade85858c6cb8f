//! Interfaces as OBJ.

use super::*;
use crate::python::{floats, read_by_vtk};
use vofkit::export::obj::write_obj;

/// Objects with the coordinates of each of their lines and triangles.
fn read(path: &Path) -> Vec<(String, Vec<Vec<[f64; 3]>>)> {
    let text = std::fs::read_to_string(path).unwrap();
    let (mut vertices, mut objects) = (Vec::new(), Vec::<(String, Vec<Vec<[f64; 3]>>)>::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split(' ').collect();
        match words[0] {
            "o" => objects.push((words[1..].join(" "), Vec::new())),
            "v" => vertices.push([1, 2, 3].map(|k| words[k].parse().unwrap())),
            "f" | "l" => {
                let corner = |word: &&str| vertices[word.parse::<usize>().unwrap() - 1];
                objects.last_mut().unwrap().1.push(words[1..].iter().map(corner).collect());
            }
            other => panic!("{other}"),
        }
    }
    objects
}

/// The area of triangles seen from above, the length of lines.
fn measure(faces: &[Vec<[f64; 3]>]) -> f64 {
    let measure = |face: &Vec<[f64; 3]>| {
        let [u, v] = [1, face.len() - 1].map(|k| [0, 1].map(|axis| face[k][axis] - face[0][axis]));
        if face.len() == 2 { u[0].hypot(u[1]) } else { 0.5 * (u[0] * v[1] - u[1] * v[0]) }
    };
    faces.iter().map(measure).sum()
}

#[test]
fn facets_become_triangles_and_lines_by_material() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("interface.obj");
    let scale = write_obj(&path, &names(), &polygons(), 0.1).unwrap();
    let found = read(&path);
    assert_eq!(scale, 1.0);
    assert_eq!([found[0].0.as_str(), found[1].0.as_str()], ["disc", "salt_\"&\"_<water>__1"]);
    assert_eq!([found[0].1.len(), found[1].1.len()], [3, 2]);
    assert_eq!([measure(&found[0].1), measure(&found[1].1)], [3.0, 1.5]);

    write_obj(&path, &names(), &segments(), 0.1).unwrap();
    let found = read(&path);
    assert_eq!([found[0].1.len(), found[1].1.len()], [2, 1]);
    assert!((measure(&found[0].1) - 1.5).abs() <= 1e-6);
}

#[test]
fn small_geometry_is_scaled_by_a_stated_power_of_ten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.obj");
    let tiny = facet(0, 0, vec![vec![[0.0, 0.0, 0.0], [1e-7, 0.0, 0.0], [0.0, 1e-7, 0.0]]]);
    let scale = write_obj(&path, &names()[..1], &[tiny], 1e-7).unwrap();
    assert_eq!(scale, 1e5);
    let found = read(&path);
    assert_eq!(found[0].0, "disc_scale_1e5");
    assert!((measure(&found[0].1) - 0.5e-4).abs() <= 1e-4 * 0.5e-4);
}

#[test]
fn an_empty_interface_is_an_object_without_faces() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none.obj");
    write_obj::<3>(&path, &names()[..1], &[], 1.0).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "o disc\n");
    let error = write_obj(&path, &[], &polygons(), 1.0).unwrap_err();
    assert!(error.to_string().contains("cell 3 is of material 0, but 0 names"), "{error}");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "o disc\n");
}

#[test]
fn vtk_reads_what_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let [solid, flat] = ["3d.obj", "2d.obj"].map(|name| folder.path().join(name));
    write_obj(&solid, &names(), &polygons(), 0.1).unwrap();
    write_obj(&flat, &names(), &segments(), 0.1).unwrap();
    let Some(found) = read_by_vtk(&[&solid, &flat]) else { return };
    assert_eq!(floats(&found[0], "counts")[1], 5.0);
    assert!((floats(&found[0], "sizes")[1] - 4.5).abs() <= 1e-6);
    assert_eq!(floats(&found[1], "counts")[1], 3.0);
}
