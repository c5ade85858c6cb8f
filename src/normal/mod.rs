//! Interface normals from the fractions around a cell: one file per method, an enum at the edge.

mod youngs;

use vofkit_geometry::{Cell, Vector};

use crate::mesh::{Grid, Mesh};

/// How the normal of the interface in a mixed cell is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NormalMethod {
    /// Youngs' gradient over the 3^D stencil, taken to physical space with the Jacobian of the same stencil.
    #[default]
    Youngs,
    /// The paper's form of Youngs' gradient: the logical axes stand for the Cartesian ones (Eq. 82).
    YoungsLogical,
}

/// The fractions of one material in the 3^D cells around a cell. Beyond a wall or an open end stands the mirror image of the
/// first layer inside.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<const D: usize> {
    /// By `sum (step_k + 1) 3^k`; the first `3^D` are used.
    values: [f64; 27],
}

/// Cells of the stencil.
const fn stencil_cells(dimension: usize) -> usize {
    3_usize.pow(dimension as u32)
}

impl<const D: usize> Stencil<D> {
    /// Collects the stencil of the cell at `offset`.
    pub fn new(grid: &Grid<D>, fractions: &[f64], offset: [usize; D]) -> Self {
        let cells = grid.cells();
        let mut values = [0.0; 27];
        let inner = (0..D).all(|k| offset[k] > 0 && offset[k] + 1 < cells[k]);
        let slots = &mut values[..stencil_cells(D)];
        if inner {
            // Inside, the cells of the stencil lie in rows of three.
            let lowest = grid.index(offset.map(|at| at - 1));
            for (row, slots) in slots.chunks_exact_mut(3).enumerate() {
                let start: usize = (1..D).map(|k| row / 3_usize.pow(k as u32 - 1) % 3 * grid.stride(k)).sum();
                slots.copy_from_slice(&fractions[lowest + start..lowest + start + 3]);
            }
        } else {
            for (place, slot) in slots.iter_mut().enumerate() {
                *slot = fractions[grid.index(grid.stepped(offset, step_of::<D>(place)))];
            }
        }
        Self { values }
    }

    /// The values with the step that leads to each of them.
    pub fn iter(&self) -> impl Iterator<Item = ([isize; D], f64)> + '_ {
        self.values[..stencil_cells(D)].iter().enumerate().map(|(place, &f)| (step_of::<D>(place), f))
    }

    /// The largest value.
    pub fn largest(&self) -> f64 {
        self.values[..stencil_cells(D)].iter().fold(0.0, |a, &b| a.max(b))
    }
}

fn step_of<const D: usize>(place: usize) -> [isize; D] {
    std::array::from_fn(|k| (place / 3_usize.pow(k as u32) % 3) as isize - 1)
}

impl NormalMethod {
    /// The unit normal in the cell at `offset`, out of the material; none where the fractions around it do not give one.
    /// `cell` is [`Mesh::local_cell`].
    pub fn normal<C: Cell<D>, const D: usize>(
        self,
        mesh: &Mesh<C, D>,
        offset: [usize; D],
        cell: &C,
        stencil: &Stencil<D>,
    ) -> Option<Vector<D>> {
        match self {
            Self::Youngs => youngs::physical(mesh, offset, cell, stencil),
            Self::YoungsLogical => youngs::logical(cell, stencil),
        }
    }
}
