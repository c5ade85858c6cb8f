//! Structured meshes of quadrilaterals (`D = 2`) and hexahedra (`D = 3`).
//!
//! [`grid`] counts cells, nodes and neighbours; [`distortion`] moves nodes; this file joins them to a [`Mesh`] whose cells
//! are all checked when it is made. [`motion`] moves a mesh over a run, and [`swept`] counts what its faces then sweep.
//! [`locate`] finds the cells at a place.

pub mod distortion;
pub mod grid;
pub mod locate;
pub mod motion;
pub mod swept;

use vofkit_geometry::{Cell, Defect, Vector};

pub use distortion::Distortion;
pub use grid::Grid;
pub use motion::{MeshMotion, MeshPath, MotionError, MotionRates};
pub use swept::SweptVolumes;

use crate::parallel;
use crate::tolerance::RANGE;

/// A structured mesh whose cells are all valid.
#[derive(Clone, Debug)]
pub struct Mesh<C, const D: usize> {
    grid: Grid<D>,
    lower: Vector<D>,
    upper: Vector<D>,
    nodes: Vec<Vector<D>>,
    volumes: Vec<f64>,
    notices: Vec<CellDefect>,
    /// Where all cells are boxes of one size.
    boxes: Option<Boxes<C, D>>,
}

/// The cell of a mesh of equal boxes, with its first node at the origin, and its edges along the axes.
#[derive(Clone, Copy, Debug)]
struct Boxes<C, const D: usize> {
    cell: C,
    spacing: Vector<D>,
}

/// A defect of one cell of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct CellDefect {
    /// The cell's index along each axis.
    pub cell: Vec<usize>,
    /// What is wrong or odd.
    pub defect: Defect,
}

/// Why there is no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A direction without cells.
    #[error("the mesh has no cells along {}", axis_name(*axis))]
    NoCells {
        /// The logical axis.
        axis: usize,
    },
    /// More cells than an index can count.
    #[error("the mesh has {cells:?} cells, more than the {limit} that can be numbered")]
    TooManyCells {
        /// Cells per direction.
        cells: Vec<usize>,
        /// The largest number of nodes.
        limit: usize,
    },
    /// A box without extent, or one that is not finite.
    #[error("the box is empty along {}: lower {lower}, upper {upper}", axis_name(*axis))]
    EmptyBox {
        /// The axis.
        axis: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// Nodes that do not make up the cells.
    #[error("a mesh of {cells:?} cells has {wanted} nodes, and {given} are given")]
    NodeCount {
        /// Cells per direction.
        cells: Vec<usize>,
        /// The nodes that they have.
        wanted: usize,
        /// The nodes given.
        given: usize,
    },
    /// An amplitude or an angle out of its range.
    #[error("{0}")]
    Distortion(String),
    /// Cells too large or too small to count in.
    #[error(
        "cell {cell:?} has the volume {volume:e}, outside the range of double precision; choose another unit of length"
    )]
    Range {
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// Its volume.
        volume: f64,
    },
    /// Cells that cannot be used, all of them.
    #[error("{} of {total} cells cannot be used; the first is cell {:?}: {}", bad.len(), bad[0].cell, bad[0].defect)]
    BadCells {
        /// Each defect of each such cell.
        bad: Vec<CellDefect>,
        /// Number of cells of the mesh.
        total: usize,
    },
}

/// The letter of an axis, as scene files write it.
pub fn axis_name(axis: usize) -> &'static str {
    ["x", "y", "z"][axis]
}

/// More nodes than this are refused: cell numbers are kept in 32 bits.
const MOST_NODES: usize = u32::MAX as usize;

impl<C: Cell<D>, const D: usize> Mesh<C, D> {
    /// The box from `lower` to `upper` cut into equal cells, then distorted. `periodic` axes join their two ends.
    ///
    /// # Errors
    /// Empty directions or boxes, and every cell that is not valid (see [`Cell::defects`]).
    pub fn new(
        grid: Grid<D>,
        lower: Vector<D>,
        upper: Vector<D>,
        distortion: &Distortion,
    ) -> Result<Self, MeshError> {
        let cells = grid.cells();
        if let Some(axis) = (0..D).find(|&axis| cells[axis] == 0) {
            return Err(MeshError::NoCells { axis });
        }
        if cells
            .iter()
            .try_fold(1_usize, |n, &c| n.checked_mul(c.checked_add(1)?))
            .is_none_or(|n| n > MOST_NODES)
        {
            return Err(MeshError::TooManyCells { cells: cells.to_vec(), limit: MOST_NODES });
        }
        for axis in 0..D {
            let (lower, upper) = (lower[axis], upper[axis]);
            if !(upper - lower > 0.0 && (upper - lower).is_finite()) {
                return Err(MeshError::EmptyBox { axis, lower, upper });
            }
        }
        let mut nodes = box_nodes(&grid, &lower, &upper);
        distortion.apply(&grid, &lower, &upper, &mut nodes)?;
        Self::checked(grid, lower, upper, nodes, distortion.is_none())
    }

    /// The unit square or cube with this many cells along each axis, distorted.
    ///
    /// # Errors
    /// As [`Mesh::new`].
    pub fn unit(cells: [usize; D], distortion: &Distortion) -> Result<Self, MeshError> {
        Self::new(Grid::new(cells, [false; D]), Vector::zeros(), Vector::repeat(1.0), distortion)
    }

    /// A mesh on the caller's own nodes, in the order of [`Grid::node_index`].
    ///
    /// # Errors
    /// As [`Mesh::new`].
    pub fn from_nodes(grid: Grid<D>, nodes: Vec<Vector<D>>) -> Result<Self, MeshError> {
        if let Some(axis) = (0..D).find(|&axis| grid.cells()[axis] == 0) {
            return Err(MeshError::NoCells { axis });
        }
        if nodes.len() != grid.node_count() {
            return Err(MeshError::NodeCount {
                cells: grid.cells().to_vec(),
                wanted: grid.node_count(),
                given: nodes.len(),
            });
        }
        let lower = nodes.iter().fold(nodes[0], |a, b| a.inf(b));
        let upper = nodes.iter().fold(nodes[0], |a, b| a.sup(b));
        Self::checked(grid, lower, upper, nodes, false)
    }

    /// The same cells with their nodes elsewhere.
    ///
    /// # Errors
    /// As [`Mesh::from_nodes`].
    pub fn moved(&self, nodes: Vec<Vector<D>>) -> Result<Self, MeshError> {
        Self::from_nodes(self.grid.clone(), nodes)
    }

    fn checked(
        grid: Grid<D>,
        lower: Vector<D>,
        upper: Vector<D>,
        nodes: Vec<Vector<D>>,
        undistorted: bool,
    ) -> Result<Self, MeshError> {
        let boxes = undistorted.then(|| {
            let spacing = Vector::from_fn(|axis, _| (upper[axis] - lower[axis]) / grid.cells()[axis] as f64);
            let corner = |offset: [usize; D]| Vector::from_fn(|axis, _| spacing[axis] * offset[axis] as f64);
            Boxes { cell: C::from_corners(corner), spacing }
        });
        let mut mesh = Self::unchecked(grid, lower, upper, nodes, boxes);
        let total = mesh.grid.len();
        let found: Vec<Vec<Defect>> = if undistorted {
            Vec::new()
        } else {
            parallel::map(total, |index| mesh.local_cell(index).defects())
        };
        let listed = |fatal: bool| -> Vec<CellDefect> {
            let of_cell = |(index, defects): (usize, &Vec<Defect>)| {
                let cell = mesh.grid.offset(index).to_vec();
                let wanted = defects.iter().filter(|d| d.is_error() == fatal).copied().collect::<Vec<_>>();
                wanted.into_iter().map(move |defect| CellDefect { cell: cell.clone(), defect })
            };
            found.iter().enumerate().flat_map(of_cell).collect()
        };
        let bad = listed(true);
        if !bad.is_empty() {
            return Err(MeshError::BadCells { bad, total });
        }
        mesh.notices = listed(false);
        if let Some(index) = mesh.volumes.iter().position(|volume| !RANGE.contains(volume)) {
            return Err(MeshError::Range {
                cell: mesh.grid.offset(index).to_vec(),
                volume: mesh.volumes[index],
            });
        }
        Ok(mesh)
    }

    /// The same without any look at the cells.
    fn unchecked(
        grid: Grid<D>,
        lower: Vector<D>,
        upper: Vector<D>,
        nodes: Vec<Vector<D>>,
        boxes: Option<Boxes<C, D>>,
    ) -> Self {
        let mut mesh = Self { grid, lower, upper, nodes, volumes: Vec::new(), notices: Vec::new(), boxes };
        mesh.volumes = match boxes {
            Some(boxes) => vec![boxes.cell.volume(); mesh.grid.len()],
            None => parallel::map(mesh.grid.len(), |index| mesh.local_cell(index).volume()),
        };
        mesh
    }

    /// The same cells with their nodes on the way between two places, where they need not be valid.
    pub(crate) fn on_the_way(&self, nodes: Vec<Vector<D>>) -> Self {
        Self::unchecked(self.grid.clone(), self.lower, self.upper, nodes, None)
    }

    /// How cells, nodes and neighbours are counted.
    pub fn grid(&self) -> &Grid<D> {
        &self.grid
    }

    /// The corners of the box that holds the mesh.
    pub fn bounds(&self) -> [Vector<D>; 2] {
        [self.lower, self.upper]
    }

    /// Whether every cell is a box of the same size.
    pub fn is_undistorted(&self) -> bool {
        self.boxes.is_some()
    }

    /// The edges of the cells along the axes, where all are boxes of one size.
    pub fn spacing(&self) -> Option<Vector<D>> {
        self.boxes.map(|boxes| boxes.spacing)
    }

    /// What is legal but odd about cells: collapsed edges, non-convex quadrilaterals.
    pub fn notices(&self) -> &[CellDefect] {
        &self.notices
    }

    /// All nodes, in the order of [`Grid::node_index`].
    pub fn nodes(&self) -> &[Vector<D>] {
        &self.nodes
    }

    /// All cell volumes, by cell index.
    pub fn volumes(&self) -> &[f64] {
        &self.volumes
    }

    /// The volume of the whole mesh.
    pub fn total_volume(&self) -> f64 {
        parallel::sum(self.volumes.len(), |index| self.volumes[index])
    }

    /// The cell's first node: the origin of its local coordinates.
    pub fn anchor(&self, index: usize) -> Vector<D> {
        self.nodes[self.grid.node_index(self.grid.offset(index))]
    }

    /// The cell with its first node at the origin, so that no digits are lost to the place of the mesh.
    pub fn local_cell(&self, index: usize) -> C {
        if let Some(boxes) = self.boxes {
            return boxes.cell;
        }
        let anchor = self.anchor(index);
        let at = self.grid.offset(index);
        C::from_corners(|offset| self.nodes[self.grid.node_index(add(at, offset))] - anchor)
    }

    /// The cell in the coordinates of the mesh.
    pub fn cell(&self, index: usize) -> C {
        self.shifted_cell(index, &Vector::zeros())
    }

    /// The cell with a vector added to all its nodes.
    pub fn shifted_cell(&self, index: usize, shift: &Vector<D>) -> C {
        let at = self.grid.offset(index);
        C::from_corners(|offset| self.nodes[self.grid.node_index(add(at, offset))] + shift)
    }
}

/// The nodes of the box from `lower` to `upper` cut into equal cells.
fn box_nodes<const D: usize>(grid: &Grid<D>, lower: &Vector<D>, upper: &Vector<D>) -> Vec<Vector<D>> {
    let cells = grid.cells();
    let place = |axis: usize, i: usize| {
        let n = cells[axis];
        if i == n { upper[axis] } else { lower[axis] + (upper[axis] - lower[axis]) * (i as f64 / n as f64) }
    };
    (0..grid.node_count())
        .map(|node| {
            let at = grid.node_offset(node);
            Vector::from_fn(|axis, _| place(axis, at[axis]))
        })
        .collect()
}

fn add<const D: usize>(a: [usize; D], b: [usize; D]) -> [usize; D] {
    std::array::from_fn(|axis| a[axis] + b[axis])
}
