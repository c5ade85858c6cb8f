//! The velocity `U` of a structured grid.

use std::cell::RefCell;
use std::path::Path;

use vofkit_geometry::{Cell, Vector};

use super::document::Document;
use super::error::ImportError;
use super::{StructuredGrid, reverse_layers, take_apart};
use crate::mesh::Mesh;
use crate::parallel;
use crate::tolerance::SAME_NODE;
use crate::whole_file;

/// The name of the array.
const VELOCITY: &str = "U";

/// Velocities at the nodes of a structured grid, or in its cells.
#[derive(Clone, Debug)]
pub struct NodalVelocity {
    grid: StructuredGrid,
    values: Vec<Vector<3>>,
    at_nodes: bool,
}

impl NodalVelocity {
    /// Reads the array `U` of a file: point data, or if there are none cell data, with three components, in the plane two or three.
    ///
    /// # Errors
    /// A file that cannot be read or is no structured grid in one piece, an array that is not there or has another size, and
    /// numbers that are not finite.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ImportError> {
        let path = path.as_ref();
        let bytes =
            whole_file::bytes(path).map_err(|error| ImportError::Read { path: path.to_owned(), error })?;
        let others = RefCell::new(Vec::new());
        let wanted = |section: &str, name: &str| {
            let kind = match section {
                "Points" => return true,
                "PointData" => "point data",
                "CellData" => "cell data",
                _ => return false,
            };
            others.borrow_mut().push(format!("{kind} `{name}`"));
            name == VELOCITY
        };
        let document = take_apart(path, &bytes, &wanted)?;
        let grid = StructuredGrid::of(path, &document)?;
        let at_nodes = document.array("PointData", VELOCITY)?.is_some();
        let section = if at_nodes { "PointData" } else { "CellData" };
        let Some(array) = document.array(section, VELOCITY)? else {
            let others = others.into_inner();
            let others = if others.is_empty() { "none".to_owned() } else { others.join(", ") };
            return Err(grid.error(
                format!("there is no array `{VELOCITY}`; there are: {others}"),
                "write the velocity as point data or cell data called U",
            ));
        };
        let layers: Vec<usize> = grid.cells.iter().map(|cells| cells + usize::from(at_nodes)).collect();
        let width = if grid.dimension() == 2 && Document::width(array) == 2 { 2 } else { 3 };
        let numbers =
            document.numbers(array, width, layers.iter().product()).map_err(|error| match error {
                ImportError::Array { path, array, problem, .. } => {
                    let help = "give it three components for every node or cell, in the plane two or three";
                    ImportError::Array { path, array, problem, help }
                }
                error => error,
            })?;
        if let Some(at) = numbers.iter().position(|number| !number.is_finite()) {
            let (mut rest, place) = (at / width, if at_nodes { "node" } else { "cell" });
            let split = |&n: &usize| {
                let at = rest % n;
                rest /= n;
                at
            };
            let offset: Vec<usize> = layers.iter().map(split).collect();
            let problem = format!("has {:?} in {place} {offset:?}, component {}", numbers[at], at % width);
            return Err(document.array_error(array, problem, "give every node or cell a finite velocity"));
        }
        let vector = |u: &[f64]| Vector::<3>::from_fn(|k, _| u.get(k).copied().unwrap_or(0.0));
        let mut values: Vec<Vector<3>> = numbers.chunks_exact(width).map(vector).collect();
        if grid.is_reversed() {
            reverse_layers(&mut values, layers[..layers.len() - 1].iter().product());
        }
        Ok(Self { grid, values, at_nodes })
    }

    /// What a user might not expect of what was read.
    pub fn notes(&self) -> Vec<String> {
        self.grid.notes()
    }

    /// The velocities at the nodes of a mesh, which must be that of the file. Those of cells are averaged over the cells around each node,
    /// weighted with their volumes.
    ///
    /// # Errors
    /// Other cells, or a node that is elsewhere.
    pub fn on<C: Cell<D>, const D: usize>(&self, mesh: &Mesh<C, D>) -> Result<Vec<Vector<D>>, ImportError> {
        let (grid, cells) = (mesh.grid(), mesh.grid().cells());
        if self.grid.cells != cells {
            return Err(self.grid.error(
                format!("it has {:?} cells along its axes, the mesh of the scene {cells:?}", self.grid.cells),
                "give the velocity on the mesh of the scene: mesh.file may name the same file",
            ));
        }
        let [lower, upper] = mesh.bounds();
        let most = SAME_NODE * (upper - lower).amax();
        let nodes = self.grid.nodes::<D>();
        let is_elsewhere = |(here, there): (&Vector<D>, &Vector<D>)| !((here - there).amax() <= most);
        if let Some(node) = nodes.iter().zip(mesh.nodes()).position(is_elsewhere) {
            return Err(self.grid.error(
                format!(
                    "its node {:?} is at {:?}, that of the mesh of the scene at {:?}",
                    grid.node_offset(node),
                    nodes[node].as_slice(),
                    mesh.nodes()[node].as_slice()
                ),
                "give the velocity on the mesh of the scene: mesh.file may name the same file",
            ));
        }
        let velocity = |index: usize| Vector::<D>::from_fn(|k, _| self.values[index][k]);
        Ok(parallel::map(nodes.len(), |node| {
            if self.at_nodes {
                return velocity(node);
            }
            let (mut sum, mut volume) = (Vector::zeros(), 0.0);
            for (_, cell) in grid.around_node(node) {
                sum += velocity(cell) * mesh.volumes()[cell];
                volume += mesh.volumes()[cell];
            }
            sum / volume
        }))
    }
}
