//! Meshes and volume fractions from someone else's VTK structured grids (`.vts`, or legacy `.vtk`), and what `vofkit run` wrote.
//!
//! - this file: a [`StructuredGrid`] as a file gives it, and as a mesh takes it; `velocity`: a [`NodalVelocity`] on such a grid;
//! - `poly_data`: interfaces (`.vtp`); `series`: which files belong to which time (`.pvd`);
//! - `document`: the parts of a file, of XML; `legacy`: the same of a legacy file, whose words are in `legacy_text`;
//! - `array`: the numbers, from every encoding that VTK writes but LZMA;
//! - `centroids`: those of the materials, for normals that need them;
//! - [`error`]: what can be wrong, with file, array and cell.
//!
//! Only nodes, fractions (cell data `alpha.<material>`) and, where they are asked for, centroids (`centroid.<material>`) and the velocity
//! `U` are decoded; everything else in the file costs nothing. The numbers come
//! out as they went in, but for fractions that add up to more than 1 by the rounding of other programs. No file makes this fail but with an error.

mod array;
mod centroids;
mod document;
pub mod error;
mod legacy;
mod legacy_text;
mod poly_data;
mod series;
mod velocity;

use std::path::{Path, PathBuf};

use vofkit_geometry::{Cell, Hexahedron, Quad, Vector};

use crate::mesh::{Grid, axis_name};
use crate::tolerance::{FRACTION_SUM, PLANAR};
use crate::whole_file;
use document::{Document, Wanted};
pub use error::ImportError;
pub use poly_data::read_facets;
pub use series::{TimedFile, read_series, velocity_files};
pub use velocity::NodalVelocity;

/// What the names of fractions start with.
const ALPHA: &str = "alpha.";

/// A structured grid with fractions, in the node order of a mesh.
#[derive(Clone, Debug)]
pub struct StructuredGrid {
    path: PathBuf,
    /// Cells along the axes that have any: two or three.
    cells: Vec<usize>,
    /// Nodes, the first axis fastest.
    nodes: Vec<Vector<3>>,
    /// Materials and their fractions by cell, in the order of the file.
    fractions: Vec<(String, Vec<f64>)>,
    reversed: bool,
    /// Cells whose fractions added up to a little more than 1.
    divided: usize,
}

impl StructuredGrid {
    /// Reads a file.
    ///
    /// A grid that is one node thick along an axis is a mesh of quadrilaterals; it must lie in a plane of constant z. Where the order
    /// of the nodes is left-handed, the last axis is [reversed](StructuredGrid::is_reversed).
    ///
    /// # Errors
    /// A file that cannot be read or is no structured grid in one piece, nodes that are not finite numbers, and fractions that are not
    /// numbers, lie outside of `[0, 1]` or add up to more than 1.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ImportError> {
        let path = path.as_ref();
        let bytes =
            whole_file::bytes(path).map_err(|error| ImportError::Read { path: path.to_owned(), error })?;
        let wanted = |section: &str, name: &str| {
            section == "Points" || section == "CellData" && name.starts_with(ALPHA)
        };
        let document = take_apart(path, &bytes, &wanted)?;
        Self::of(path, &document)
    }

    /// The grid of a file with the fractions that were wanted of it.
    fn of(path: &Path, document: &Document<'_>) -> Result<Self, ImportError> {
        let counts = document.node_counts()?;
        let nodes = document.points(counts.iter().product())?;
        let fractions = document.cell_arrays(ALPHA, counts)?;
        let cells: Vec<usize> = counts.iter().filter(|&&count| count > 1).map(|count| count - 1).collect();
        let mut grid = Self { path: path.to_owned(), cells, nodes, fractions, reversed: false, divided: 0 };
        match *grid.cells.as_slice() {
            [n, m] => {
                grid.check_planar()?;
                grid.settle_fractions()?;
                grid.settle::<Quad, 2>([n, m]);
            }
            [n, m, l] => {
                grid.settle_fractions()?;
                grid.settle::<Hexahedron, 3>([n, m, l]);
            }
            _ => {
                return Err(grid.error(
                    format!("{counts:?} nodes along its axes make no quadrilaterals or hexahedra"),
                    "write a grid with at least two nodes along two or three axes",
                ));
            }
        }
        Ok(grid)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// 2 or 3.
    pub fn dimension(&self) -> usize {
        self.cells.len()
    }

    /// Cells along each axis; the others of `D` are left at 0.
    pub fn cells<const D: usize>(&self) -> [usize; D] {
        std::array::from_fn(|axis| self.cells.get(axis).copied().unwrap_or(0))
    }

    /// The nodes in the order of [`Grid::node_index`].
    pub fn nodes<const D: usize>(&self) -> Vec<Vector<D>> {
        self.nodes.iter().map(|x| Vector::from_fn(|k, _| x[k])).collect()
    }

    /// The materials that the file has fractions of: cell data `alpha.<material>`.
    pub fn materials(&self) -> impl Iterator<Item = &str> {
        self.fractions.iter().map(|(name, _)| name.as_str())
    }

    /// The fractions of a material by cell.
    ///
    /// # Errors
    /// There are none.
    pub fn fractions(&self, material: &str) -> Result<&[f64], ImportError> {
        let found = self.fractions.iter().find(|(name, _)| name == material);
        found.map(|(_, values)| values.as_slice()).ok_or_else(|| {
            let there: Vec<String> = self.materials().map(|name| format!("{ALPHA}{name}")).collect();
            let there = if there.is_empty() { "none".to_owned() } else { there.join(", ") };
            self.error(
                format!("there is no cell array `{ALPHA}{material}`; of this kind there are: {there}"),
                "write the fractions as cell data called alpha.<material>, or give every material a shape",
            )
        })
    }

    /// Whether the last axis runs the other way than in the file, whose order of nodes is left-handed.
    pub fn is_reversed(&self) -> bool {
        self.reversed
    }

    fn error(&self, problem: String, help: &'static str) -> ImportError {
        ImportError::Grid { path: self.path.clone(), problem, help }
    }

    /// The place of a cell along each axis, for errors.
    fn offset(&self, mut cell: usize) -> Vec<usize> {
        let split = |&n: &usize| {
            let at = cell % n;
            cell /= n;
            at
        };
        self.cells.iter().map(split).collect()
    }

    fn check_planar(&self) -> Result<(), ImportError> {
        let first = self.nodes[0];
        let size = self.nodes.iter().fold(0.0_f64, |size, x| size.max((x - first).amax()));
        match self.nodes.iter().position(|x| !((x.z - first.z).abs() <= PLANAR * size)) {
            None => Ok(()),
            Some(node) => Err(self.error(
                format!(
                    "it is one node thick, but not in a plane of constant z: node 0 has z = {:?}, node {node} z = {:?}",
                    first.z, self.nodes[node].z
                ),
                "turn it into the plane of x and y",
            )),
        }
    }

    /// Refuses what is no fraction, and divides those that add up to a little more than 1 by their sum.
    fn settle_fractions(&mut self) -> Result<(), ImportError> {
        let wrong = |array: String, cell: usize, value: f64, sum: bool| ImportError::Fraction {
            path: self.path.clone(),
            array,
            cell: self.offset(cell),
            value,
            sum,
        };
        let mut sums = vec![0.0; self.cells.iter().product()];
        for (material, fractions) in &self.fractions {
            for (cell, (&fraction, sum)) in fractions.iter().zip(&mut sums).enumerate() {
                if !(0.0..=1.0).contains(&fraction) {
                    return Err(wrong(format!("{ALPHA}{material}"), cell, fraction, false));
                }
                *sum += fraction;
                if *sum > 1.0 + FRACTION_SUM {
                    return Err(wrong(format!("{ALPHA}{material}"), cell, *sum, true));
                }
            }
        }
        self.divided = sums.iter().filter(|&&sum| sum > 1.0).count();
        for (_, fractions) in &mut self.fractions {
            fractions.iter_mut().zip(&sums).for_each(|(fraction, sum)| *fraction /= sum.max(1.0));
        }
        Ok(())
    }

    /// Reverses the last axis if that makes the volume of the whole positive.
    fn settle<C: Cell<D>, const D: usize>(&mut self, cells: [usize; D]) {
        let grid = Grid::new(cells, [false; D]);
        let nodes = self.nodes::<D>();
        let volume = |index: usize| {
            let at = grid.offset(index);
            let node =
                |offset: [usize; D]| nodes[grid.node_index(std::array::from_fn(|k| at[k] + offset[k]))];
            let anchor = node([0; D]);
            C::from_corners(|offset| node(offset) - anchor).volume()
        };
        if (0..grid.len()).map(volume).sum::<f64>() < 0.0 {
            self.reversed = true;
            let layer = cells[..D - 1].iter().map(|n| n + 1).product();
            reverse_layers(&mut self.nodes, layer);
            for (_, values) in &mut self.fractions {
                reverse_layers(values, cells[..D - 1].iter().product());
            }
        }
    }

    /// What a user might not expect of what was read.
    pub fn notes(&self) -> Vec<String> {
        let (path, last) = (self.path.display(), axis_name(self.dimension() - 1));
        let reversed = self.reversed.then(|| {
            format!("the order of nodes in {path} is left-handed: cells along {last} are counted from the other end")
        });
        let divided = (self.divided > 0).then(|| {
            format!(
                "in {} cells of {path} the fractions add up to more than 1, by rounding: they are divided by their sum",
                self.divided
            )
        });
        reversed.into_iter().chain(divided).collect()
    }
}

/// Takes a structured grid apart, whether it is in an XML or a legacy file; arrays that are not wanted are left out.
fn take_apart<'a>(path: &Path, bytes: &'a [u8], wanted: Wanted<'_>) -> Result<Document<'a>, ImportError> {
    if legacy::is_legacy(path, bytes) {
        legacy::parse(path, bytes, wanted)
    } else {
        Document::parse(path, bytes, "StructuredGrid", wanted)
    }
}

/// Turns the order of equal parts round.
fn reverse_layers<T: Copy>(values: &mut Vec<T>, layer: usize) {
    *values = values.chunks(layer).rev().flatten().copied().collect();
}
