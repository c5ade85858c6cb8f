//! The band of cells that a step can change: all others are left alone.
//!
//! A fraction can only change where it differs from a neighbour's. In one sweep along mesh lines, at Courant numbers up to 1,
//! material reaches the next cell along the sweep's axis and no further.

use vofkit_geometry::Cell;

use super::boundary::{Boundary, End};
use crate::mesh::{Grid, Mesh};
use crate::parallel;

/// What lies across a face of a cell of the band.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Across {
    /// The cell at this place in the band.
    Member(u32),
    /// A cell outside the band. Its fractions are those that the cell of the band had at the start of the step, or it would be in
    /// the band.
    Outside,
    /// The end of the mesh.
    End,
}

/// The cells of the band in ascending order, and the place of each cell in it.
#[derive(Clone, Debug)]
pub(super) struct Band {
    cells: Vec<u32>,
    slot: Vec<u32>,
}

/// A cell outside the band.
const OUTSIDE: u32 = u32::MAX;

impl Band {
    pub(super) fn new(cells: usize) -> Self {
        Self { cells: Vec::new(), slot: vec![OUTSIDE; cells] }
    }

    /// The cells, ascending.
    pub(super) fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// What lies across a face of a cell.
    pub(super) fn across<const D: usize>(&self, grid: &Grid<D>, cell: usize, face: usize) -> Across {
        match grid.neighbour(cell, face / 2, face % 2) {
            None => Across::End,
            Some(next) if self.slot[next] == OUTSIDE => Across::Outside,
            Some(next) => Across::Member(self.slot[next]),
        }
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
        let seeds = parallel::map(grid.len() / row, |r| {
            let mut unsettled = Vec::new();
            for (material, f) in fractions.iter().enumerate() {
                let inflow = boundary.inflow_fraction(material);
                unsettled_in_row(grid, f, boundary, inflow, r * row, &mut unsettled);
            }
            unsettled.sort_unstable();
            unsettled.dedup();
            unsettled
        });
        for &seed in seeds.iter().flatten() {
            for cell in grid.around(seed as usize, radius) {
                if self.slot[cell] == OUTSIDE {
                    self.slot[cell] = 0;
                    self.cells.push(cell as u32);
                }
            }
        }
        self.cells.sort_unstable();
        for (slot, &cell) in self.cells.iter().enumerate() {
            self.slot[cell as usize] = slot as u32;
        }
    }
}

/// Adds the cells of the row along the first axis from `start` whose fraction differs from a neighbour's or from what flows in. A
/// cell may come more than once. Where a mixed cell has a normal, one of these is next to it.
fn unsettled_in_row<const D: usize>(
    grid: &Grid<D>,
    f: &[f64],
    boundary: &Boundary<D>,
    inflow: f64,
    start: usize,
    unsettled: &mut Vec<u32>,
) {
    let length = grid.cells()[0];
    let row = &f[start..start + length];
    let mut mark = |i: usize| unsettled.push((start + i) as u32);
    for axis in 1..D {
        for side in 0..2 {
            match grid.neighbour(start, axis, side) {
                Some(next) => {
                    let other = &f[next..next + length];
                    if row != other {
                        (0..length).filter(|&i| row[i] != other[i]).for_each(&mut mark);
                    }
                }
                None if boundary.ends[axis][side] == End::Outflow => {
                    (0..length).filter(|&i| row[i] != inflow).for_each(&mut mark);
                }
                None => {}
            }
        }
    }
    let uniform = row.iter().all(|&value| value == row[0]);
    if !uniform {
        for i in 1..length {
            if row[i - 1] != row[i] {
                mark(i - 1);
                mark(i);
            }
        }
    }
    for (side, i) in [0, length - 1].into_iter().enumerate() {
        let differs = match grid.neighbour(start + i, 0, side) {
            Some(next) => f[next] != row[i],
            None => boundary.ends[0][side] == End::Outflow && row[i] != inflow,
        };
        if differs {
            mark(i);
        }
    }
}
