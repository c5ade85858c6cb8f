//! The band of cells that a step can change: all others are left alone.
//!
//! A fraction can only change where it differs from a neighbour's. In one sweep along mesh lines, at Courant numbers up to 1,
//! material reaches the next cell along the sweep's axis and no further.

use vofkit_geometry::Cell;

use super::boundary::{Boundary, End};
use crate::mesh::{Grid, Mesh};
use crate::parallel;

/// A cell outside the band.
const OUTSIDE: u32 = u32::MAX;

/// The cells of the band in ascending order, and the place of each cell in it.
#[derive(Clone, Debug)]
pub(super) struct Band {
    cells: Vec<u32>,
    slot: Vec<u32>,
}

impl Band {
    pub(super) fn new(cells: usize) -> Self {
        Self { cells: Vec::new(), slot: vec![OUTSIDE; cells] }
    }

    /// The cells, ascending.
    pub(super) fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// The place of a cell in [`Band::cells`].
    pub(super) fn slot(&self, cell: usize) -> Option<usize> {
        let slot = self.slot[cell];
        (slot != OUTSIDE).then_some(slot as usize)
    }

    /// Collects all cells within `radius` cells, along every axis, of one whose fractions are not settled.
    pub(super) fn collect<C: Cell<D>, const D: usize>(
        &mut self,
        mesh: &Mesh<C, D>,
        fractions: &[Vec<f64>],
        boundary: &Boundary<D>,
        radius: usize,
    ) {
        for &cell in &self.cells {
            self.slot[cell as usize] = OUTSIDE;
        }
        self.cells.clear();
        let grid = mesh.grid();
        let row = grid.cells()[0];
        let rows = grid.len() / row;
        let seeds: Vec<Vec<u32>> = parallel::map(rows, |r| unsettled_in_row(grid, fractions, boundary, r));
        for &seed in seeds.iter().flatten() {
            self.add_around(grid, seed as usize, radius);
        }
        self.cells.sort_unstable();
        for (slot, &cell) in self.cells.iter().enumerate() {
            self.slot[cell as usize] = slot as u32;
        }
    }

    fn add_around<const D: usize>(&mut self, grid: &Grid<D>, seed: usize, radius: usize) {
        let at = grid.offset(seed);
        let width = 2 * radius + 1;
        for place in 0..width.pow(D as u32) {
            let mut rest = place;
            let step: [isize; D] = std::array::from_fn(|_| {
                let step = (rest % width) as isize - radius as isize;
                rest /= width;
                step
            });
            // Steps beyond an end come back to its last cell, which is in the band anyway.
            let cell = grid.index(grid.stepped(at, step));
            if self.slot[cell] == OUTSIDE {
                self.slot[cell] = 0;
                self.cells.push(cell as u32);
            }
        }
    }
}

/// The cells of one row along the first axis that are mixed, or differ from a neighbour or from what flows in.
fn unsettled_in_row<const D: usize>(
    grid: &Grid<D>,
    fractions: &[Vec<f64>],
    boundary: &Boundary<D>,
    row: usize,
) -> Vec<u32> {
    let cells = grid.cells();
    let start = row * cells[0];
    let first = grid.offset(start);
    let mut unsettled = Vec::new();
    for (material, f) in fractions.iter().enumerate() {
        let inflow = if boundary.inflow == Some(material) { 1.0 } else { 0.0 };
        // The rows next to this one across the other axes.
        for axis in 1..D {
            for side in 0..2 {
                match grid.neighbour(start, axis, side) {
                    Some(next) => {
                        let pairs = f[start..start + cells[0]].iter().zip(&f[next..next + cells[0]]);
                        mark(&mut unsettled, start, pairs.map(|(a, b)| a != b));
                    }
                    None if boundary.ends[axis][side] == End::Outflow => {
                        mark(&mut unsettled, start, f[start..start + cells[0]].iter().map(|&a| a != inflow));
                    }
                    None => {}
                }
            }
        }
        for i in 0..cells[0] {
            let value = f[start + i];
            let end = [i == 0, i + 1 == cells[0]];
            let differs = |side: usize| {
                if !end[side] {
                    return value != f[if side == 0 { start + i - 1 } else { start + i + 1 }];
                }
                match grid.neighbour(start + i, 0, side) {
                    Some(next) => value != f[next],
                    None => boundary.ends[0][side] == End::Outflow && value != inflow,
                }
            };
            if (value != 0.0 && value != 1.0) || differs(0) || differs(1) {
                unsettled.push((start + i) as u32);
            }
        }
    }
    debug_assert_eq!(first[0], 0, "rows start at the lower end of the first axis");
    unsettled.sort_unstable();
    unsettled.dedup();
    unsettled
}

fn mark(list: &mut Vec<u32>, start: usize, wanted: impl Iterator<Item = bool>) {
    for (i, wanted) in wanted.enumerate() {
        if wanted {
            list.push((start + i) as u32);
        }
    }
}
