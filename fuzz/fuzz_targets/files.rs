//! Any bytes as a file of another program, its kind told by the first of them: an error that says what is wrong, or a grid, a
//! velocity, a series, facets or a body that hold together.
#![no_main]

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use vofkit::body_file;
use vofkit::geometry::{Cell, Hexahedron, Quad};
use vofkit::import::{NodalVelocity, StructuredGrid, read_facets, read_series, velocity_files};
use vofkit::mesh::{Grid, Mesh};
use vofkit_fuzz::Folder;

/// Meshes with more cells than this are not made.
const CELLS: usize = 1000;

static FOLDER: LazyLock<Folder> = LazyLock::new(Folder::default);

/// What a reader gave; an error says something.
fn told<T, E: std::fmt::Display>(result: Result<T, E>) -> Option<T> {
    result.inspect_err(|error| assert!(!error.to_string().is_empty())).ok()
}

fn grid(path: &Path) {
    let velocity = told(NodalVelocity::read(path));
    let Some(grid) = told(StructuredGrid::read(path)) else { return };
    match grid.dimension() {
        2 => mesh::<Quad, 2>(&grid, velocity),
        _ => mesh::<Hexahedron, 3>(&grid, velocity),
    }
}

fn mesh<C: Cell<D>, const D: usize>(grid: &StructuredGrid, velocity: Option<NodalVelocity>) {
    let cells = grid.cells::<D>();
    let count: usize = cells.iter().product();
    for material in grid.materials() {
        if let Some(fractions) = told(grid.fractions(material)) {
            assert!(fractions.len() == count && fractions.iter().all(|f| (0.0..=1.0).contains(f)));
        }
    }
    if count > CELLS {
        return;
    }
    let Some(mesh) = told(Mesh::<C, D>::from_nodes(Grid::new(cells, [false; D]), grid.nodes())) else {
        return;
    };
    assert!(mesh.volumes().iter().all(|volume| *volume > 0.0 && volume.is_finite()));
    if let Some(values) = velocity.and_then(|velocity| told(velocity.on(&mesh))) {
        assert!(values.len() == mesh.nodes().len() && values.iter().flatten().all(|u| u.is_finite()));
    }
}

fn body<const D: usize>(path: &Path) {
    if let Some(body) = told(body_file::read::<D>(path)) {
        assert!(body.volume() > 0.0 && body.volume().is_finite());
    }
}

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, content)) = bytes.split_first() else { return };
    let (name, read): (_, &dyn Fn(&Path)) = match kind {
        b'v' => ("grid.vts", &grid),
        b'l' => ("grid.vtk", &grid),
        b'p' => ("facets.vtp", &|path| {
            told(read_facets::<2>(path));
            told(read_facets::<3>(path));
        }),
        b'd' => ("series.pvd", &|path| {
            let files = told(read_series(path));
            assert!(files.is_none_or(|files| files.is_sorted_by_key(|file| file.time)));
            told(velocity_files(path));
        }),
        b's' => ("body.stl", &body::<3>),
        b'o' => ("body.obj", &body::<3>),
        b'x' => ("outline.txt", &body::<2>),
        _ => return,
    };
    let path = FOLDER.join(name);
    fs::write(&path, content).expect("a file to read");
    read(&path);
});
