//! Centroids from files: what was written is read again to the bit, and what is wrong is named.

use vofkit::geometry::Vector;
use vofkit::import::StructuredGrid;

use crate::cli_support::Place;

/// Two unit squares side by side, half full and full; `{}` stands for more cell data.
fn squares(more: &str) -> String {
    format!(
        "<VTKFile type=\"StructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\">\
         <StructuredGrid WholeExtent=\"0 2 0 1 0 0\"><Piece Extent=\"0 2 0 1 0 0\">\
         <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\
         0 0 0 1 0 0 2 0 0 0 1 0 1 1 0 2 1 0</DataArray></Points><CellData>\
         <DataArray type=\"Float64\" Name=\"alpha.oil\" format=\"ascii\">0.5 1</DataArray>{more}\
         </CellData></Piece></StructuredGrid></VTKFile>"
    )
}

fn centroids(components: usize, numbers: &str) -> String {
    squares(&format!(
        "<DataArray type=\"Float64\" Name=\"centroid.oil\" NumberOfComponents=\"{components}\" \
         format=\"ascii\">{numbers}</DataArray>"
    ))
}

/// The centroids in a file, or the message and the help.
fn read(place: &Place, text: &str) -> Result<Vec<Vector<2>>, String> {
    let path = place.file("grid.vts", text);
    let grid = StructuredGrid::read(path).map_err(|error| error.to_string())?;
    grid.centroids::<2>("oil").map_err(|error| format!("{error}; {}", error.help()))
}

#[test]
fn centroids_are_read_where_cells_are_mixed() {
    let place = Place::new();
    let found = read(&place, &centroids(3, "0.25 0.5 0 7 7 7")).unwrap();
    assert_eq!(found, [Vector::from([0.25, 0.5]), Vector::from([7.0, 7.0])]);
    // The rounding of single precision is none of anybody's fault.
    assert!(read(&place, &centroids(3, "0.25 1.0000001 0 7 7 7")).is_ok());
}

#[test]
fn what_is_wrong_with_centroids_is_named() {
    let place = Place::new();
    let wrong: &[(String, &[&str])] = &[
        (squares(""), &["grid.vts", "no cell array `centroid.oil`", "none", "three numbers each"]),
        (centroids(2, "0.25 0.5 7 7"), &["grid.vts", "`centroid.oil`", "has 2 components, not 3"]),
        (centroids(3, "0.25 0.5 0"), &["grid.vts", "`centroid.oil`", "3 numbers"]),
        (
            centroids(3, "0.25 NaN 0 1.5 0.5 0"),
            &["grid.vts", "`centroid.oil`", "[0.25, NaN]", "mixed cell [0, 0]", "the middle of"],
        ),
        (
            centroids(3, "0.25 1.001 0 1.5 0.5 0"),
            &["[0.25, 1.001]", "mixed cell [0, 0]", "between [0.0, 0.0] and [1.0, 1.0]"],
        ),
        (centroids(3, "0.25 inf 0 1.5 0.5 0"), &["[0.25, inf]", "mixed cell [0, 0]"]),
    ];
    for (text, answer) in wrong {
        let error = read(&place, text).unwrap_err();
        for words in *answer {
            assert!(error.contains(words), "no {words:?} in {error}");
        }
    }
    // The scene says which line asks for them.
    place.file("grid.vts", squares(""));
    let oil = "[mesh]\nfile = \"grid.vts\"\n[[material]]\nname = \"oil\"\n";
    place.file("mof.toml", format!("{oil}[reconstruction]\nnormal = \"mof\"\n"));
    let done = place.vofkit(&["reconstruct", "mof.toml"]);
    assert_eq!(done.code, Some(1));
    for words in ["no cell array `centroid.oil`", "mof.toml:4:"] {
        assert!(done.err.contains(words), "no {words:?} in {}", done.err);
    }
    // Nobody else misses them.
    place.file("swartz.toml", oil);
    assert_eq!(place.vofkit(&["reconstruct", "swartz.toml", "--quiet"]).code, Some(0));
}

#[test]
fn planes_from_centroids_are_found_again() {
    let place = Place::new();
    let mof = "reconstruction.normal=mof";
    let distortion = "mesh.distortion.random.amplitude=0.2";
    let scenes: &[(&str, &[&str])] = &[
        ("static_mof", &[distortion]),
        ("static_sphere", &[distortion, mof]),
        ("seven_discs", &["mesh.cells=[30,30]", distortion, mof, "output.times=[0.0]"]),
    ];
    for (name, settings) in scenes {
        let settings = [settings, &["output.picture=false"][..]].concat();
        let first = place.reconstruct(name, name, &settings);
        assert_eq!(first["planes"]["no_centroid"], 0, "{name}");
        place.file("grid.vts", std::fs::read(place.path(name).join("fields_0000.vts")).unwrap());
        let output = "[output]\ninterface = [\"obj\", \"vtk\"]\nfields = true\n";
        place.file(
            "again.toml",
            format!("[mesh]\nfile = \"grid.vts\"\n[reconstruction]\nnormal = \"mof\"\n{output}"),
        );
        let done = place.vofkit(&["reconstruct", "again.toml", "--out", "again", "--force", "--quiet"]);
        assert_eq!((done.code, done.err.as_str()), (Some(0), ""), "{name}");
        assert_eq!(first["planes"], place.summary("again")["planes"], "{name}");
        for file in ["interface_0000.vtp", "fields_0000.vts"] {
            let [a, b] = [name, "again"].map(|out| std::fs::read(place.path(out).join(file)).unwrap());
            assert!(a == b, "{name}: {file} differs");
        }
    }
}
