//! Interfaces and time series that runs write, read back.

use std::path::Path;

use vofkit::export::vtk::{Collection, write_poly_data};
use vofkit::facet::Facet;
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, Hexahedron, Quad};
use vofkit::import::{ImportError, TimedFile, read_facets, read_series};
use vofkit::interface::{Reconstruction, reconstruct};
use vofkit::mesh::{Distortion, Mesh};
use vofkit::shape::Shape;

fn interface<C: Cell<D>, const D: usize>() -> Vec<Facet<D>> {
    let mesh = Mesh::<C, D>::unit([7; D], &Distortion::Random { amplitude: 0.2, seed: 3 }).unwrap();
    let ball = |x: f64, radius: f64| Shape::Sphere { centre: [x; D].into(), radius };
    let fractions = volume_fractions(&mesh, &[ball(0.3, 0.25), ball(0.8, 0.15)]);
    reconstruct(&mesh, &fractions, Reconstruction::default()).unwrap().facets
}

fn round_trip<C: Cell<D>, const D: usize>() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("interface.vtp");
    let mut facets = interface::<C, D>();
    assert!(facets.len() >= 20);
    facets[2].determined = false;
    write_poly_data(&path, &facets).unwrap();
    assert_eq!(read_facets(&path).unwrap(), facets);
    write_poly_data::<D>(&path, &[]).unwrap();
    assert_eq!(read_facets::<D>(&path).unwrap(), []);
}

#[test]
fn interfaces_come_back_to_the_bit() {
    round_trip::<Quad, 2>();
    round_trip::<Hexahedron, 3>();
}

#[test]
fn loops_of_one_facet_come_back_with_their_parts_of_the_area() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("interface.vtp");
    let mut facet = interface::<Quad, 2>().remove(0);
    facet.loops =
        vec![vec![[0.0, 0.0].into(), [1.0, 0.0].into()], vec![[0.0, 1.0].into(), [3.0, 1.0].into()]];
    facet.area = 4.0;
    write_poly_data(&path, std::slice::from_ref(&facet)).unwrap();
    let read = read_facets::<2>(&path).unwrap();
    let parts: Vec<_> = read.iter().map(|facet| (facet.area, facet.loops.clone())).collect();
    assert_eq!(parts, [(1.0, vec![facet.loops[0].clone()]), (3.0, vec![facet.loops[1].clone()])]);
}

fn text(error: &ImportError, path: &Path) -> String {
    let text = format!("{error}; {}", error.help());
    assert!(text.contains(path.to_str().unwrap()), "{text}");
    text
}

#[test]
fn poly_data_that_no_run_wrote_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("interface.vtp");
    let array = |kind: &str, name: &str, components: usize, numbers: &str| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{numbers}</DataArray>"
        )
    };
    let file = |offsets: &str, connectivity: &str, data: &[&str]| {
        let data: String = data.iter().copied().collect();
        format!(
            "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"3\" NumberOfLines=\"2\"><Points>{}</Points>\
             <Lines>{}{}</Lines><CellData>{data}</CellData></Piece></PolyData></VTKFile>",
            array("Float64", "Points", 3, "0 0 0 1 0 0 1 1 0"),
            array("Int64", "connectivity", 1, connectivity),
            array("Int64", "offsets", 1, offsets),
        )
    };
    let scalar = |name: &str, numbers: &str| array("Float64", name, 1, numbers);
    let own = [
        scalar("cell", "0 1"),
        scalar("material", "0 0"),
        array("Float64", "normal", 3, "0 1 0 1 0 0"),
        scalar("plane_constant", "0 1"),
        scalar("area", "1 1"),
        scalar("status", "0 0"),
    ];
    let all: Vec<&str> = own.iter().map(String::as_str).collect();
    let refused = |text_of_file: &str| {
        std::fs::write(&path, text_of_file).unwrap();
        text(&read_facets::<2>(&path).unwrap_err(), &path)
    };
    let whole = file("2 4", "0 1 1 2", &all);
    std::fs::write(&path, &whole).unwrap();
    assert_eq!(read_facets::<2>(&path).unwrap().len(), 2);
    for (missing, name) in
        ["cell", "material", "normal", "plane_constant", "area", "status"].iter().enumerate()
    {
        let mut fewer = all.clone();
        fewer.remove(missing);
        let text = refused(&file("2 4", "0 1 1 2", &fewer));
        assert!(
            text.contains(&format!("no array `{name}` in its CellData")) && text.contains("[output]"),
            "{text}"
        );
    }
    for (offsets, connectivity, answer) in [
        ("2 4", "0 1 1 3", "`connectivity` has 3.0, which is no index below 3"),
        ("2 4", "0 1 1 0.5", "`connectivity` has 0.5"),
        ("2 4", "0 1 -1 0", "`connectivity` has -1.0"),
        ("2 5", "0 1 1 2", "`connectivity` has 4 numbers"),
        ("3 2", "0 1", "`offsets` has 3.0, which is no index below 3"),
        ("2 nan", "0 1", "`offsets` has NaN"),
    ] {
        let text = refused(&file(offsets, connectivity, &all));
        assert!(text.contains(answer), "{text}");
    }
    let text = refused(&whole.replace("NumberOfLines=\"2\"", "NumberOfLines=\"two\""));
    assert!(text.contains("NumberOfLines is \"two\""), "{text}");
    let text = refused(&whole.replace("PolyData", "ImageData"));
    assert!(text.contains("it holds ImageData, not a PolyData"), "{text}");
}

#[test]
fn a_series_comes_back_in_the_order_of_its_times() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.pvd");
    let mut collection = Collection::new(&path);
    let place = |name: &str| folder.path().join(name);
    for (time, name) in [(0.5, "b & c.vts"), (0.1 + 0.2, "a.vts")] {
        collection.add(time, &[("fields", &place(name))]).unwrap();
    }
    let file = |time: f64, name: &str| TimedFile { time, group: "fields".to_owned(), path: place(name) };
    assert_eq!(read_series(&path).unwrap(), [file(0.1 + 0.2, "a.vts"), file(0.5, "b & c.vts")]);
}

#[test]
fn series_that_cannot_be_used_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.pvd");
    assert!(text(&read_series(&path).unwrap_err(), &path).contains("cannot read"));
    let file =
        |entries: &str| format!("<VTKFile type=\"Collection\"><Collection>{entries}</Collection></VTKFile>");
    for (content, answer) in [
        (file(""), "names no files"),
        (file("<DataSet timestep=\"0\"/>"), "entry 0 names no file"),
        (file("<DataSet file=\"a.vts\"/>"), "entry 0 has the time \"\""),
        (file("<DataSet timestep=\"nan\" file=\"a.vts\"/>"), "entry 0 has the time \"nan\""),
        (file("").replace("\"Collection\"", "\"PolyData\""), "it holds PolyData, not a Collection"),
        ("<VTKFile".to_owned(), "no VTK XML file"),
    ] {
        std::fs::write(&path, content).unwrap();
        let text = text(&read_series(&path).unwrap_err(), &path);
        assert!(text.contains(answer), "{text}");
    }
}
