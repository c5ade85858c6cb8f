//! Legacy files (`.vtk`): the same grids as from XML, and everything that can be wrong.

use std::fmt::Write;

use proptest::prelude::*;
use vofkit::geometry::{Cell, Hexahedron, Quad};
use vofkit::import::{NodalVelocity, StructuredGrid, velocity_files};
use vofkit::mesh::{Grid, Mesh};

use crate::cli_support::Place;
use crate::file::{Encoding, File, Placed};

/// How a legacy file is written.
#[derive(Clone, Copy, Debug)]
struct Form {
    binary: bool,
    /// The arrays in a `FIELD`, not as `SCALARS`.
    field: bool,
    /// `EXTENT` in place of `DIMENSIONS`.
    extent: bool,
    kind: &'static str,
}

const TEXT: Form = Form { binary: false, field: false, extent: false, kind: "double" };
const BINARY: Form = Form { binary: true, ..TEXT };

impl Form {
    fn head(self) -> String {
        let form = if self.binary { "BINARY" } else { "ASCII" };
        format!("# vtk DataFile Version 3.0\nmade by hand\n{form}\nDATASET STRUCTURED_GRID\n")
    }

    fn numbers(self, kind: &str, values: &[f64]) -> Vec<u8> {
        if !self.binary {
            return values.iter().flat_map(|value| format!("{value}\n").into_bytes()).collect();
        }
        let number = |&value: &f64| match kind {
            "double" => value.to_be_bytes().to_vec(),
            "float" => (value as f32).to_be_bytes().to_vec(),
            _ => {
                let bytes = match kind {
                    "char" | "unsigned_char" => 1,
                    "short" | "unsigned_short" => 2,
                    "int" | "unsigned_int" | "vtkIdType" => 4,
                    _ => 8,
                };
                (value as i64).to_be_bytes()[8 - bytes..].to_vec()
            }
        };
        let mut bytes: Vec<u8> = values.iter().flat_map(number).collect();
        bytes.push(b'\n');
        bytes
    }

    /// The lines of an array that is nothing of interest, in all kinds.
    fn others(self, count: usize) -> Vec<u8> {
        let mut bytes = Vec::new();
        let nan = |components: usize| self.numbers("double", &vec![f64::NAN; components * count]);
        for (line, components) in
            [("VECTORS v", 3), ("NORMALS n", 3), ("TENSORS t", 9), ("TENSORS6 s", 6), ("GLOBAL_IDS g", 1)]
        {
            bytes.extend(format!("{line} double\n").into_bytes());
            bytes.extend(nan(components));
        }
        bytes.extend(b"METADATA\nCOMPONENT_NAMES\nx\nINFORMATION 0\n\n");
        bytes.extend(b"SCALARS w double 2\nLOOKUP_TABLE own\n");
        bytes.extend(nan(2));
        bytes.extend(b"texture_coordinates c 2 double\n");
        bytes.extend(nan(2));
        for (line, values) in [("COLOR_SCALARS alpha.c 4", 4 * count), ("LOOKUP_TABLE own 2", 8)] {
            bytes.extend(format!("{line}\n").into_bytes());
            let kind = if self.binary { "unsigned_char" } else { "float" };
            bytes.extend(self.numbers(kind, &vec![1.0; values]));
        }
        bytes
    }

    /// A field of values that belong to nothing, such as programs put in front of the grid.
    fn loose(self) -> Vec<u8> {
        let mut bytes = b"FIELD FieldData 3\nTIME 1 1 double\n".to_vec();
        bytes.extend(self.numbers("double", &[1.5]));
        bytes.extend(b"METADATA\nINFORMATION 0\n\nbits 1 9 bit\n");
        bytes.extend(if self.binary { b"\x01\x80\n".to_vec() } else { b"1 0 1 0 1 0 1 0 1\n".to_vec() });
        bytes.extend(b"words 1 3 string\n");
        let long = "CELL_DATA 7\\n".repeat(10);
        if self.binary {
            let length = (2_u16 << 14 | long.len() as u16).to_be_bytes();
            bytes.extend([b"\xc5POINT\xc0".as_slice(), &length, long.as_bytes(), b"\n"].concat());
        } else {
            bytes.extend(format!("POINTS 3\n\n{long}\n").into_bytes());
        }
        bytes
    }

    fn grid(self, made: &File) -> Vec<u8> {
        let counts = made.counts;
        let mut bytes = self.loose();
        let line = match (self.extent, counts) {
            (false, [x, y, z]) => format!("DIMENSIONS {x} {y} {z}\n"),
            (true, [x, y, z]) => format!("EXTENT 0 {} -3 {} 5 {}\n", x - 1, y as i64 - 4, z + 4),
        };
        let kind = if self.kind == "float" { "float" } else { "double" };
        bytes.extend(format!("{line}POINTS {} {kind}\n", made.points.len()).into_bytes());
        bytes.extend(self.numbers(kind, made.points.as_flattened()));
        bytes
    }

    /// A whole file.
    fn bytes(self, made: &File) -> Vec<u8> {
        let cells: usize = made.counts.iter().map(|&count| (count - 1).max(1)).product();
        let mut bytes = [self.head().into_bytes(), self.grid(made)].concat();
        bytes.extend(format!("POINT_DATA {}\n", made.points.len()).into_bytes());
        bytes.extend(self.others(made.points.len()));
        bytes.extend(format!("CELL_DATA {cells}\n").into_bytes());
        bytes.extend(self.others(cells));
        if self.field {
            bytes.extend(format!("FIELD FieldData {}\n", made.arrays.len()).into_bytes());
        }
        for (name, values) in &made.arrays {
            let name = name.replace('%', "%25").replace(' ', "%20");
            let line = match self.field {
                true => format!("{name} 1 {} {}\n", values.len(), self.kind),
                false => format!("SCALARS {name} {}\nLOOKUP_TABLE default\n", self.kind),
            };
            bytes.extend(line.into_bytes());
            bytes.extend(self.numbers(self.kind, values));
            bytes.extend(b"METADATA\nINFORMATION 0\n\n");
        }
        bytes
    }
}

/// Numbers that need all digits, and names that need to be encoded.
fn uneven(mut made: File) -> File {
    made.points.as_flattened_mut().iter_mut().for_each(|x| *x /= 3.0);
    for (_, values) in &mut made.arrays {
        values.iter_mut().for_each(|value| *value /= 3.0);
    }
    made.arrays[1].0 = "alpha.salt, 5% water".to_owned();
    made
}

/// Dimension, whether it is reversed, and the bits of nodes and fractions.
type Content = (usize, bool, Vec<[u64; 3]>, Vec<(String, Vec<u64>)>);

/// Everything that a grid has.
fn content(place: &Place, name: &str, bytes: &[u8]) -> Content {
    let read = StructuredGrid::read(place.file(name, bytes)).unwrap_or_else(|error| panic!("{error}"));
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let nodes = read.nodes::<3>().iter().map(|x| [x.x, x.y, x.z].map(f64::to_bits)).collect();
    let fractions = read.materials().map(|name| (name.to_owned(), bits(read.fractions(name).unwrap())));
    (read.dimension(), read.is_reversed(), nodes, fractions.collect())
}

#[test]
fn the_same_grid_has_the_same_bits_as_from_xml() {
    let place = Place::new();
    for right in [File::flat(), File::solid()].map(uneven) {
        let axis = if right.counts[2] == 1 { 1 } else { 2 };
        for made in [right.reversed(axis), right] {
            let xml = content(&place, "grid.vts", &made.bytes(Encoding::default()));
            for binary in [false, true] {
                for (field, extent) in [(false, false), (false, true), (true, false)] {
                    let form = Form { binary, field, extent, kind: "double" };
                    let bytes = form.bytes(&made);
                    assert!(content(&place, "grid.vtk", &bytes) == xml, "{form:?}");
                    // The name does not matter.
                    assert!(content(&place, "grid.vts", &bytes) == xml, "{form:?}");
                }
            }
            let text = String::from_utf8(TEXT.bytes(&made)).unwrap();
            let lines = text.replace("\n\n", "\n \n").replace('\n', "\r\n");
            assert!(content(&place, "grid.vtk", lines.as_bytes()) == xml, "lines of Windows");
        }
    }
}

#[test]
fn numbers_of_every_type_are_read() {
    let place = Place::new();
    let mut made = File::solid();
    let float = Encoding { kind: "Float32", ..Encoding::default() };
    let xml = content(&place, "grid.vts", &made.bytes(float));
    assert!(content(&place, "grid.vtk", &Form { kind: "float", ..BINARY }.bytes(&made)) == xml);
    made.arrays.truncate(1);
    made.arrays[0].1.iter_mut().enumerate().for_each(|(cell, value)| *value = (cell % 2) as f64);
    let xml = content(&place, "grid.vts", &made.bytes(Encoding::default()));
    let whole = ["char", "unsigned_char", "short", "unsigned_short", "int", "unsigned_int", "vtkIdType"];
    for kind in whole.into_iter().chain(["long", "unsigned_long", "vtktypeint64", "vtktypeuint64"]) {
        for binary in [false, true] {
            let bytes = Form { kind, binary, ..TEXT }.bytes(&made);
            assert!(content(&place, "grid.vtk", &bytes) == xml, "{kind}");
        }
    }
}

/// The XML file with vectors in a section.
fn xml_with(made: &File, section: &str, name: &str, values: &[f64]) -> String {
    let mut array = format!(
        "<{section}>\n<DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"3\" format=\"ascii\">"
    );
    values.iter().for_each(|value| write!(array, "{value} ").unwrap());
    let xml = made.bytes(Encoding { placed: Placed::Ascii, ..Encoding::default() });
    let xml = String::from_utf8(xml).unwrap();
    xml.replacen(&format!("<{section}>"), &format!("{array}</DataArray>"), 1)
}

/// A velocity at the nodes or in the cells, of a file in each format.
fn velocities<C: Cell<D>, const D: usize>(place: &Place, made: &File, cells: [usize; D]) {
    for at_nodes in [true, false] {
        let count = if at_nodes { made.points.len() } else { cells.iter().product() };
        let values: Vec<f64> = (0..3 * count).map(|at| (at % 17) as f64 / 7.0 - 1.0).collect();
        let xml = xml_with(made, if at_nodes { "PointData" } else { "CellData" }, "U", &values);
        let read = StructuredGrid::read(place.file("u.vts", &xml)).unwrap();
        let mesh = Mesh::<C, D>::from_nodes(Grid::new(cells, [false; D]), read.nodes()).unwrap();
        let wanted = NodalVelocity::read(place.path("u.vts")).unwrap().on(&mesh).unwrap();
        for form in [TEXT, BINARY] {
            let section = if at_nodes { "POINT_DATA" } else { "CELL_DATA" };
            for line in ["VECTORS U double".to_owned(), format!("FIELD f 1\nU 3 {count} double")] {
                let mut bytes = [form.head().into_bytes(), form.grid(made)].concat();
                bytes.extend(format!("{section} {count}\n{line}\n").into_bytes());
                bytes.extend(form.numbers("double", &values));
                let read = NodalVelocity::read(place.file("u.vtk", bytes)).unwrap();
                assert!(read.on(&mesh).unwrap() == wanted, "{form:?} {line}");
            }
        }
    }
}

#[test]
fn the_same_velocity_has_the_same_bits_as_from_xml() {
    let place = Place::new();
    for (flat, solid) in
        [(File::flat(), File::solid()), (File::flat().reversed(1), File::solid().reversed(2))]
    {
        velocities::<Quad, 2>(&place, &uneven_points(flat), [4, 3]);
        velocities::<Hexahedron, 3>(&place, &uneven_points(solid), [3, 2, 4]);
    }
}

fn uneven_points(mut made: File) -> File {
    made.points.as_flattened_mut().iter_mut().for_each(|x| *x /= 3.0);
    made.arrays.clear();
    made
}

#[test]
fn scenes_take_legacy_files_wherever_they_take_others() {
    let place = Place::new();
    let mut made = File::solid();
    made.arrays.truncate(1);
    let mut vectors = format!("POINT_DATA {}\nVECTORS U double\n", made.points.len()).into_bytes();
    vectors.extend(BINARY.numbers("double", &[0.5, 0.25, -0.125].repeat(made.points.len())));
    place.file("grid.vts", made.bytes(Encoding::default()));
    place.file("grid.vtk", [BINARY.bytes(&made), vectors].concat());
    let entry = |time: f64| format!("<DataSet timestep=\"{time}\" file=\"grid.vtk\"/>");
    let series = [entry(0.0), entry(1.0)].concat();
    let series = format!("<VTKFile type=\"Collection\"><Collection>{series}</Collection></VTKFile>");
    let series = place.file("flow.pvd", series);
    assert!(velocity_files(series).unwrap().iter().all(|file| file.path == place.path("grid.vtk")));
    let fields = [
        ("grid.vts", "{ uniform = { velocity = [0.5, 0.25, -0.125] } }"),
        ("grid.vtk", "{ file = { path = \"grid.vtk\" } }"),
        ("grid.vtk", "{ file = { path = \"flow.pvd\" } }"),
    ];
    let volumes = fields.map(|(mesh, field)| {
        let scene =
            format!("[mesh]\nfile = \"{mesh}\"\n[velocity]\nfield = {field}\n[advection]\nend_time = 0.5\n");
        place.file("scene.toml", scene);
        let done = place.vofkit(&["run", "scene.toml", "--out", "o", "--force", "--quiet"]);
        assert_eq!((done.code, done.err.as_str()), (Some(0), ""), "{field}");
        crate::cli_support::number(&place.summary("o")["materials"][0]["volume_final"])
    });
    assert!(volumes.iter().all(|volume| (volume - volumes[0]).abs() <= 1e-12 * volumes[0]), "{volumes:?}");
}

#[test]
fn the_same_centroids_have_the_same_bits_as_from_xml() {
    let place = Place::new();
    for mut made in [File::solid(), File::solid().reversed(2)] {
        made.arrays.truncate(1);
        // A little off the middle of each cell.
        let corner = |cell: usize| cell % 3 + 4 * (cell / 3 % 2 + 3 * (cell / 6));
        let middle = |cell: usize| {
            let opposite = [0, 1, 2].map(|k| made.points[corner(cell) + 17][k]);
            [0, 1, 2].map(|k| 0.5 * (made.points[corner(cell)][k] + opposite[k]) + 0.01 / (cell as f64 + 3.0))
        };
        let values: Vec<f64> = (0..24).flat_map(middle).collect();
        let xml = xml_with(&made, "CellData", "centroid.one", &values);
        let wanted = StructuredGrid::read(place.file("grid.vts", xml)).unwrap();
        let wanted = wanted.centroids::<3>("one").unwrap();
        for form in [TEXT, BINARY] {
            let mut bytes = form.bytes(&made);
            bytes.extend(b"VECTORS centroid.one double\n");
            bytes.extend(form.numbers("double", &values));
            let read = StructuredGrid::read(place.file("grid.vtk", bytes)).unwrap();
            assert!(read.centroids::<3>("one").unwrap() == wanted, "{form:?}");
        }
    }
}

/// A small grid as text.
const SMALL: &str = "# vtk DataFile Version 2.0\n\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 3 2 1\nPOINTS 6 float\n\
                     0 0 0 1 0 0 2 0 0\n0 1 0 1 1 0 2 1 0\nCELL_DATA 2\nSCALARS alpha.a double 1\nLOOKUP_TABLE default\n\
                     0.25 0.75\nFIELD f 2\np 2 2 float\nnan 1 -inf 2\nalpha.b 1 2 float\n0.5 0\n";

fn refused(place: &Place, name: &str, bytes: &[u8]) -> String {
    let path = place.file(name, bytes);
    let error = StructuredGrid::read(&path).expect_err(&String::from_utf8_lossy(bytes));
    let text = format!("{error}; {}", error.help());
    assert!(text.contains(path.to_str().unwrap()), "{text}");
    text
}

#[test]
fn what_is_wrong_is_named_with_its_place() {
    let place = Place::new();
    assert_eq!(StructuredGrid::read(place.file("small.vtk", SMALL)).unwrap().materials().count(), 2);
    let cases: &[(&str, &str, &[&str])] = &[
        ("# vtk DataFile", "# DataFile", &["no legacy VTK file", "does not start with"]),
        ("ASCII", "TEXT", &["its third line is \"TEXT\"", "neither ASCII nor BINARY"]),
        (
            "STRUCTURED_GRID",
            "RECTILINEAR_GRID",
            &["it holds RECTILINEAR_GRID, not a STRUCTURED_GRID", "convert"],
        ),
        ("DATASET", "DATA", &["\"DATA STRUCTURED_GRID\" at byte 34"]),
        ("DIMENSIONS 3 2 1", "DIMENSIONS 3 two 1", &["its DIMENSIONS \"3 two 1\" count no nodes"]),
        ("DIMENSIONS 3 2 1", "DIMENSIONS 3 2", &["its DIMENSIONS \"3 2\" count no nodes"]),
        ("DIMENSIONS 3 2 1", "DIMENSIONS 3 0 1", &["its DIMENSIONS \"3 0 1\" count no nodes"]),
        ("DIMENSIONS 3 2 1", "EXTENT 0 2 0 1 0 -1", &["its EXTENT \"0 2 0 1 0 -1\" count no nodes"]),
        ("DIMENSIONS 3 2 1", "DIMENSIONS 3 2 1\nDIMENSIONS 3 2 1", &["\"DIMENSIONS 3 2 1\" at byte 75"]),
        ("DIMENSIONS 3 2 1\n", "", &["no DIMENSIONS before"]),
        ("DIMENSIONS 3 2 1", "DIMENSIONS 3 3 1", &["its POINTS announces 6, the grid has 9 nodes"]),
        ("DIMENSIONS 3 2 1", "DIMENSIONS 6 1 1", &["its CELL_DATA announces 2, the grid has 5 cells"]),
        ("POINTS 6 float", "POINTS 6 string", &["`Points` announces 18 strings, the file ends after 11"]),
        ("POINTS 6 float", "POINTS 6", &["the line \"POINTS 6\" at byte"]),
        ("POINTS 6 float", "POINTS six float", &["the line \"POINTS six float\" at byte"]),
        ("2 0 0\n", "2 0\n", &["`Points` has the word \"CELL_DATA\" after 17 of its 18 numbers"]),
        ("2 0 0\n", "2 0 0 0\n", &["\"0\" at byte", "behind the array `Points`"]),
        ("2 0 0\n", "2 nan 0\n", &["`Points` has NaN in node 2, component 1", "finite coordinates"]),
        ("2 0 0\n", "2 0 0.5\n", &["constant z", "node 2", "0.5"]),
        ("2 0 0\n", "2 0 0,5\n", &["`Points` holds \"0,5\", which is no number"]),
        ("2 0 0\n", "2 0 much\n", &["`Points` has the word \"much\" after 8 of its 18"]),
        ("alpha.a double 1", "alpha.a double 3", &["`alpha.a` has the word \"FIELD\" after 2 of its 6"]),
        ("alpha.a double 1", "alpha.a", &["the line \"SCALARS alpha.a\" at byte"]),
        ("alpha.a double 1", "alpha.a double one", &["the line \"SCALARS alpha.a double one\""]),
        ("alpha.a double 1", "alpha.a bit", &["`alpha.a` has the type \"bit\""]),
        ("LOOKUP_TABLE default\n", "", &["`alpha.a` has no line LOOKUP_TABLE"]),
        ("0.25", "1.25", &["`alpha.a` has 1.25 in cell [0, 0]", "no volume fraction", "between 0 and 1"]),
        ("0.25", "nan", &["`alpha.a` has NaN in cell [0, 0]"]),
        ("0.25", "0.75", &["`alpha.b` has 1.25 in cell [0, 0]", "no more than 1"]),
        ("FIELD f 2", "FIELD f", &["the line \"FIELD f\"", "behind the array `alpha.a`"]),
        ("FIELD f 2", "FIELD f 3", &["it ends within a FIELD"]),
        ("FIELD f 2", "FIELD f 1", &["\"alpha.b 1 2 float\"", "behind the array `p`"]),
        ("FIELD f 2", "FIELDS f 2", &["the line \"FIELDS f 2\""]),
        ("p 2 2 float", "p 2 two float", &["the line \"p 2 two float\""]),
        ("p 2 2 float", "p 18446744073709551615 2 float", &["`p` is too long"]),
        ("alpha.b 1 2", "alpha.b 1 3", &["`alpha.b` announces 3 values, the grid needs 2"]),
        ("alpha.b 1 2", "alpha.b 2 2", &["`alpha.b` announces 4 numbers, the file ends after 2"]),
        ("alpha.b 1 2 float\n0.5 0", "alpha.b 2 2 float\n0.5 0 0 0", &["`alpha.b` has 2 components, not 1"]),
        ("alpha.b 1 2", "alpha.a 1 2", &["`alpha.a` is there twice"]),
        ("CELL_DATA 2", "CELL_DATA", &["the line \"CELL_DATA\" at byte"]),
        ("CELL_DATA 2\n", "", &["the line \"SCALARS alpha.a double 1\" at byte"]),
    ];
    for (from, to, answer) in cases {
        assert!(SMALL.contains(from), "{from}");
        let text = refused(&place, "grid.vtk", SMALL.replacen(from, to, 1).as_bytes());
        for words in *answer {
            assert!(text.contains(words), "{to}: no {words:?} in {text}");
        }
    }
    for (bytes, answer) in [
        ("", "no legacy VTK file"),
        ("hello", "no legacy VTK file"),
        ("# vtk DataFile Version 3.0", "ends behind its title"),
        ("# vtk DataFile Version 3.0\n\nASCII\n", "has no DATASET"),
        ("# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_GRID\n", "has no DIMENSIONS"),
        ("# vtk DataFile Version 3.0\n\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\n", "has no points"),
    ] {
        let text = refused(&place, "grid.vtk", bytes.as_bytes());
        assert!(text.contains(answer), "{text}");
    }
    let made = File::flat();
    let mut whole = BINARY.bytes(&made);
    whole.truncate(whole.len() - 30);
    let text = refused(&place, "grid.vtk", &whole);
    assert!(text.contains("`alpha.two` announces 96 bytes, the file ends after"), "{text}");
}

/// Reads bytes as grid and as velocity, and says whether they are a grid; memory is bounded by the length of the file.
fn read_bounded(place: &Place, bytes: &[u8]) -> bool {
    let path = place.file("hostile.vtk", bytes);
    let mut is_grid = false;
    let memory = allocation_counter::measure(|| {
        is_grid = StructuredGrid::read(&path).is_ok();
        let _ = NodalVelocity::read(&path);
    });
    let most = 10_000 + 80 * bytes.len() as u64;
    assert!(memory.bytes_max <= most, "{} bytes of memory for {} bytes", memory.bytes_max, bytes.len());
    is_grid
}

#[test]
fn no_announced_size_takes_memory() {
    let place = Place::new();
    let huge = "1000000007";
    for binary in [false, true] {
        let grid = SMALL.replace("ASCII", if binary { "BINARY" } else { "ASCII" });
        for (from, to) in [
            ("DIMENSIONS 3 2 1\nPOINTS 6", &*format!("DIMENSIONS {huge} 2 1\nPOINTS 2000000014")),
            ("DIMENSIONS 3 2 1", "DIMENSIONS 4000000000 4000000000 1"),
            ("DIMENSIONS 3 2 1", "DIMENSIONS 9223372036854775807 9223372036854775807 9223372036854775807"),
            ("DIMENSIONS 3 2 1", "EXTENT -9223372036854775808 9223372036854775807 0 1 0 0"),
            ("POINTS 6", &format!("POINTS {huge}")),
            ("CELL_DATA 2", &format!("CELL_DATA {huge}")),
            ("alpha.a double 1", &format!("alpha.a double {huge}")),
            ("FIELD f 2", &format!("FIELD f {huge}")),
            ("p 2 2", &format!("p {huge} {huge}")),
            ("p 2 2 float", &format!("p {huge} 2 string")),
            ("alpha.b 1 2", &format!("alpha.b {huge} 2")),
        ] {
            assert!(!read_bounded(&place, grid.replacen(from, to, 1).as_bytes()), "{to}");
        }
    }
    assert!(read_bounded(&place, SMALL.as_bytes()));
    // What is kept of an array is more than the shortest one.
    let tiny = SMALL.replace("DIMENSIONS 3 2 1", "DIMENSIONS 2 3 1").replace("FIELD f 2", "FIELD f 1032");
    assert!(read_bounded(&place, (tiny + &"U 1 2 x\n1 1\n".repeat(1030)).as_bytes()));
}

/// Files that end early, or in which a byte is another one, are read or refused, and nothing else.
#[test]
fn broken_files_never_end_the_program() {
    let place = Place::new();
    let mut outcomes = [0, 0];
    for form in [TEXT, BINARY, Form { field: true, ..BINARY }] {
        let whole = form.bytes(&File::flat());
        for at in (0..whole.len()).step_by(41) {
            outcomes[usize::from(read_bounded(&place, &whole[..at]))] += 1;
            for byte in [0, b'9', b'\n', 0xff] {
                let mut broken = whole.clone();
                broken[at] = byte;
                outcomes[usize::from(read_bounded(&place, &broken))] += 1;
            }
        }
    }
    assert!(outcomes[0] > 300 && outcomes[1] > 300, "{outcomes:?}");
}

/// Words that files have, in any order.
fn statements() -> impl Strategy<Value = Vec<u8>> {
    let word = prop_oneof![
        prop::sample::select(vec![
            "DIMENSIONS 2 2 1\n",
            "DIMENSIONS 2 2 2\n",
            "POINTS 4 float\n",
            "POINTS 8 char\n",
            "CELL_DATA 1\n",
            "POINT_DATA 4\n",
            "SCALARS alpha.a char\nLOOKUP_TABLE t\n",
            "VECTORS U char\n",
            "FIELD f 1\n",
            "METADATA\n",
            "alpha.a 1 1 bit\n",
            "U 3 4 char\n",
            "s 1 9 string\n",
            "LOOKUP_TABLE t 9\n",
            "\n",
            " ",
            "\x40",
            "1 0 0 1 ",
            "nan ",
            "-1",
            "999999999999",
            "%4",
            "EXTENT 0 1 0 1 0 0\n",
        ])
        .prop_map(|word| word.as_bytes().to_vec()),
        prop::collection::vec(any::<u8>(), 0..30),
    ];
    prop::collection::vec(word, 0..40).prop_map(|words| words.concat())
}

proptest! {
    #[test]
    fn any_bytes_behind_a_header_are_read_or_refused(binary: bool, bytes in statements()) {
        let form = Form { binary, ..TEXT };
        read_bounded(&Place::new(), &[form.head().into_bytes(), bytes.clone()].concat());
        read_bounded(&Place::new(), &[form.head().into_bytes(), form.grid(&File::flat()), bytes].concat());
    }
}
