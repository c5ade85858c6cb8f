//! The cells of the 3^D patch around a cell with their geometry, in the frame of the middle one.
//!
//! The patch is one-sided at walls and open ends, where nothing is known of what lies beyond, and goes on at the joined ends of a
//! periodic axis.

use vofkit_geometry::{Cell, HalfSpace, Vector};

use super::Around;
use super::frame::Frame;
use super::stencil::step_of;
use crate::mesh::Mesh;

/// The most cells and nodes that a patch has.
const CELLS: usize = 27;
const NODES: usize = 64;

/// A patch, prepared for cuts by any number of planes.
pub(super) struct Patch<C, const D: usize> {
    pub(super) frame: Frame<D>,
    /// By `sum (step_k + 1) 4^k`, with steps from -1 to 2; those of the cells that are there.
    nodes: [Vector<D>; NODES],
    /// Places of the neighbours that are there, by `sum (step_k + 1) 3^k`.
    neighbours: [u8; CELLS],
    count: usize,
    /// Fractions by place.
    fractions: [f64; CELLS],
    /// Cells by place; which of them have been made, one bit each.
    cells: [C; CELLS],
    made: u32,
}

/// How a plane meets a cell of the patch.
pub(super) enum Met {
    /// The cell is all inside (1) or all outside (0).
    Not(f64),
    /// The plane crosses it.
    Crossed,
}

impl<C: Cell<D>, const D: usize> Patch<C, D> {
    pub(super) fn new(around: &Around<'_, C, D>) -> Self {
        let (mesh, cell) = (around.material.mesh, around.cell);
        let cells = mesh.grid().cells();
        let frame = Frame::new(cell);
        let mut patch = Self {
            frame,
            nodes: [Vector::zeros(); NODES],
            neighbours: [0; CELLS],
            count: 0,
            fractions: [0.0; CELLS],
            cells: [*cell; CELLS],
            made: 0,
        };
        let anchor = mesh.anchor(around.index);
        for place in 0..4_usize.pow(D as u32) {
            let at = std::array::from_fn(|k| (around.offset[k] + (place >> (2 * k) & 3)) as isize - 1);
            if let Some(node) = node(mesh, at) {
                patch.nodes[place] = frame.point(&(node - anchor));
            }
        }
        for (place, f) in around.stencil.values[..3_usize.pow(D as u32)].iter().enumerate() {
            patch.fractions[place] = *f;
            let step = step_of::<D>(place);
            let there = (0..D).all(|k| {
                let to = around.offset[k] as isize + step[k];
                mesh.grid().periodic()[k] || (0..cells[k] as isize).contains(&to)
            });
            if there && place != Self::MIDDLE {
                patch.neighbours[patch.count] = place as u8;
                patch.count += 1;
            }
        }
        patch
    }

    /// The place of the cell itself.
    pub(super) const MIDDLE: usize = 3_usize.pow(D as u32) / 2;

    /// The places of the neighbours.
    pub(super) fn neighbours(&self) -> impl Iterator<Item = usize> + use<C, D> {
        let places = self.neighbours;
        places.into_iter().take(self.count).map(usize::from)
    }

    /// The fraction at a place.
    pub(super) fn fraction(&self, place: usize) -> f64 {
        self.fractions[place]
    }

    /// The mean of a cell's nodes.
    pub(super) fn middle(&self, place: usize) -> Vector<D> {
        let nodes = (0..1 << D).map(|corner| self.nodes[node_place::<D>(place, corner)]);
        nodes.sum::<Vector<D>>() / (1 << D) as f64
    }

    /// How a plane meets a cell.
    pub(super) fn meet(&self, place: usize, heights: &Heights) -> Met {
        let (mut inside, mut outside) = (true, true);
        for corner in 0..1 << D {
            let height = heights.0[node_place::<D>(place, corner)];
            inside &= height <= 0.0;
            outside &= height >= 0.0;
        }
        match (inside, outside) {
            (true, _) => Met::Not(1.0),
            (_, true) => Met::Not(0.0),
            _ => Met::Crossed,
        }
    }

    /// The heights of all nodes over a plane.
    pub(super) fn heights(&self, half_space: &HalfSpace<D>) -> Heights {
        let mut heights = [0.0; NODES];
        for (height, node) in heights[..4_usize.pow(D as u32)].iter_mut().zip(&self.nodes) {
            *height = half_space.height(node);
        }
        Heights(heights)
    }

    /// A cell, in the frame.
    pub(super) fn cell(&mut self, place: usize) -> &C {
        if self.made & (1 << place) == 0 {
            self.made |= 1 << place;
            let nodes = &self.nodes;
            self.cells[place] = C::from_corners(|corner| {
                let bits = (0..D).map(|k| corner[k] << k).sum();
                nodes[node_place::<D>(place, bits)]
            });
        }
        &self.cells[place]
    }
}

/// Heights of the nodes of a patch.
pub(super) struct Heights([f64; NODES]);

/// The place among nodes of a corner (bit `k`: its offset along axis `k`) of the cell at a place.
fn node_place<const D: usize>(cell: usize, corner: usize) -> usize {
    let mut place = 0;
    let mut rest = cell;
    for k in 0..D {
        place |= (rest % 3 + (corner >> k & 1)) << (2 * k);
        rest /= 3;
    }
    place
}

/// A node, beyond the joined ends of periodic axes too; none beyond other ends.
fn node<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, mut at: [isize; D]) -> Option<Vector<D>> {
    let grid = mesh.grid();
    let mut shift = Vector::zeros();
    for k in 0..D {
        let n = grid.cells()[k] as isize;
        if (0..=n).contains(&at[k]) {
            continue;
        }
        if !grid.periodic()[k] {
            return None;
        }
        let turns = at[k].div_euclid(n);
        at[k] -= turns * n;
        shift += period(mesh, k) * turns as f64;
    }
    Some(mesh.nodes()[grid.node_index(at.map(|i| i as usize))] + shift)
}

/// How far beyond the joined ends of periodic axes the cell lies that is a step away, against where its nodes are kept.
pub(super) fn shift_beyond_ends<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    index: usize,
    step: &[isize; D],
) -> Vector<D> {
    let grid = mesh.grid();
    let mut shift = Vector::zeros();
    if grid.periodic().contains(&true) {
        let offset = grid.offset(index);
        for k in 0..D {
            let turns = (offset[k] as isize + step[k]).div_euclid(grid.cells()[k] as isize);
            shift += period(mesh, k) * turns as f64;
        }
    }
    shift
}

/// From a node at the lower end of a periodic axis to its image at the upper one.
fn period<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, axis: usize) -> Vector<D> {
    let grid = mesh.grid();
    let end = std::array::from_fn(|k| if k == axis { grid.cells()[k] } else { 0 });
    mesh.nodes()[grid.node_index(end)] - mesh.nodes()[0]
}
