//! Velocities at nodes, from files: against the formulas that they were sampled from, and what is wrong with files.
#![cfg(all(feature = "cli", feature = "obj", feature = "vtk", feature = "plot"))]

#[path = "../cli_support/mod.rs"]
mod cli_support;
#[path = "../common/mod.rs"]
mod common;
mod dilation;
mod flows;
mod projection;
mod scenes;
mod wrong;

use std::path::Path;

use vofkit::export::vtk::{CellArray, write_structured_grid_with_nodes};
use vofkit::geometry::{Cell, Vector};
use vofkit::mesh::Mesh;
use vofkit::velocity::Field;

/// The velocities of a field at the nodes of a mesh.
fn sampled<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, field: &Field) -> Vec<Vector<D>> {
    let spatial = |x: &Vector<D>| Vector::<3>::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
    let at = |x: &Vector<D>| {
        let u = field.velocity(&spatial(x));
        Vector::from_fn(|k, _| u[k])
    };
    mesh.nodes().iter().map(at).collect()
}

/// Writes velocities at the nodes of a mesh, or in its cells, as `U`.
fn write<C: Cell<D>, const D: usize>(path: &Path, mesh: &Mesh<C, D>, velocities: &[Vector<D>]) {
    let array = [CellArray::vector("U", velocities)];
    let (cells, nodes): (&[_], &[_]) =
        if velocities.len() == mesh.nodes().len() { (&[], &array) } else { (&array, &[]) };
    write_structured_grid_with_nodes(path, mesh, cells, nodes).expect("a writable file");
}
