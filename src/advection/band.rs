//! The band of cells that a step can change: all others are left alone.
//!
//! A sweep changes a cell only where it is mixed or differs from a neighbour across one of the sweep's faces. Cells that are or
//! do so at the start of a step, and those that later sweeps can reach from them, make up the band.

use super::boundary::{Boundary, End};
use crate::interface::is_mixed;
use crate::mesh::Grid;
use crate::parallel;

/// A cell of the band.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<const D: usize> {
    pub(super) cell: u32,
    /// The cell's index along each axis.
    pub(super) offset: [u32; D],
}

impl<const D: usize> Place<D> {
    pub(super) fn cell(&self) -> usize {
        self.cell as usize
    }

    pub(super) fn offset(&self) -> [usize; D] {
        self.offset.map(|at| at as usize)
    }
}

/// The cells of the band in ascending order, and the slot of each cell in it.
#[derive(Clone, Debug)]
pub(super) struct Band<const D: usize> {
    places: Vec<Place<D>>,
    slot: Vec<u32>,
    /// Whether a row along the first axis has cells of the band.
    touched: Vec<bool>,
}

/// A cell outside the band.
const OUTSIDE: u32 = u32::MAX;

/// Cells that are compared at once.
const CHUNK: usize = 8;

impl<const D: usize> Band<D> {
    pub(super) fn new() -> Self {
        Self { places: Vec::new(), slot: Vec::new(), touched: Vec::new() }
    }

    /// The cells, ascending.
    pub(super) fn places(&self) -> &[Place<D>] {
        &self.places
    }

    /// Their indices.
    pub(super) fn cells(&self) -> Vec<u32> {
        self.places.iter().map(|place| place.cell).collect()
    }

    /// The slot of a cell, if it is in the band.
    pub(super) fn slot(&self, cell: usize) -> Option<usize> {
        let slot = self.slot[cell];
        (slot != OUTSIDE).then_some(slot as usize)
    }

    /// Collects all cells at most `reach` steps along each axis away from one that is not settled. Cells that hold a material with
    /// quantities, by `carried`, never are.
    pub(super) fn collect(
        &mut self,
        grid: &Grid<D>,
        fractions: &[Vec<f64>],
        carried: &[bool],
        boundary: &Boundary<D>,
        reach: [usize; D],
    ) {
        let row = grid.cells()[0];
        self.clear(grid);
        let seeds =
            parallel::map(grid.len() / row, |r| unsettled(grid, fractions, carried, boundary, r * row));
        for (r, seeds) in seeds.iter().enumerate().filter(|(_, seeds)| !seeds.is_empty()) {
            let offset = grid.offset(r * row);
            for_each_row(grid, offset, reach, |target| {
                self.touched[target] = true;
                for &seed in seeds {
                    for step in 0..=2 * reach[0] {
                        let mut at = [0; D];
                        at[0] = seed as usize;
                        let mut steps = [0; D];
                        steps[0] = step as isize - reach[0] as isize;
                        self.slot[target * row + grid.stepped(at, steps)[0]] = 0;
                    }
                }
            });
        }
        for r in (0..self.touched.len()).filter(|&r| self.touched[r]) {
            let mut offset = grid.offset(r * row).map(|at| at as u32);
            for (i, slot) in self.slot[r * row..(r + 1) * row].iter_mut().enumerate() {
                if *slot == 0 {
                    *slot = self.places.len() as u32;
                    offset[0] = i as u32;
                    self.places.push(Place { cell: (r * row + i) as u32, offset });
                }
            }
        }
    }

    /// Collects all cells.
    pub(super) fn collect_all(&mut self, grid: &Grid<D>) {
        self.clear(grid);
        for (cell, slot) in self.slot.iter_mut().enumerate() {
            *slot = cell as u32;
            self.places.push(Place { cell: cell as u32, offset: grid.offset(cell).map(|at| at as u32) });
        }
    }

    fn clear(&mut self, grid: &Grid<D>) {
        for place in &self.places {
            self.slot[place.cell()] = OUTSIDE;
        }
        self.places.clear();
        self.slot.resize(grid.len(), OUTSIDE);
        self.touched.clear();
        self.touched.resize(grid.len() / grid.cells()[0], false);
    }
}

/// Calls `work` with each row along the first axis that lies at most `reach` away from the one at `offset`. Beyond the ends of
/// the mesh stands the last row inside.
fn for_each_row<const D: usize>(
    grid: &Grid<D>,
    offset: [usize; D],
    reach: [usize; D],
    mut work: impl FnMut(usize),
) {
    let width = reach.map(|reach| 2 * reach + 1);
    for mut place in 0..width[1..].iter().product() {
        let mut steps = [0; D];
        for axis in 1..D {
            steps[axis] = (place % width[axis]) as isize - reach[axis] as isize;
            place /= width[axis];
        }
        work(grid.index(grid.stepped(offset, steps)) / grid.cells()[0]);
    }
}

/// A row of cells along the first axis and what lies beside it.
struct Row<'a, const D: usize> {
    boundary: &'a Boundary<D>,
    start: usize,
    length: usize,
    /// Where the rows beside it start, by face of the other axes.
    beside: [Option<usize>; 4],
    /// The cells before its first and after its last.
    ends: [Option<usize>; 2],
}

/// The cells of the row along the first axis from `start` that are mixed in some material, or in which it differs from a
/// neighbour or from what flows in, or is there and carried; ascending, as places in the row.
fn unsettled<const D: usize>(
    grid: &Grid<D>,
    fractions: &[Vec<f64>],
    carried: &[bool],
    boundary: &Boundary<D>,
    start: usize,
) -> Vec<u32> {
    let length = grid.cells()[0];
    let beside = std::array::from_fn(|i| {
        let (axis, side) = (1 + i / 2, i % 2);
        if axis < D { grid.neighbour(start, axis, side) } else { None }
    });
    let ends = [grid.neighbour(start, 0, 0), grid.neighbour(start + length - 1, 0, 1)];
    let row = Row { boundary, start, length, beside, ends };
    let inflow = |material: usize| boundary.inflow_fraction(material);
    let mut found = Vec::new();
    for from in (0..length).step_by(CHUNK) {
        let to = (from + CHUNK).min(length);
        let holds = |k: usize, i: usize| carried[k] && fractions[k][start + i] > 0.0;
        let may_hold = |k: usize| carried[k] && (from..to).any(|i| holds(k, i));
        let each = || fractions.iter().enumerate();
        if each().any(|(k, f)| row.may_change(f, inflow(k), from, to) || may_hold(k)) {
            let changes = |&i: &usize| each().any(|(k, f)| row.changes(f, inflow(k), i) || holds(k, i));
            found.extend((from..to).filter(changes).map(|i| i as u32));
        }
    }
    found
}

impl<const D: usize> Row<'_, D> {
    fn is_open(&self, face: usize) -> bool {
        self.boundary.ends[face / 2][face % 2] == End::Outflow
    }

    /// Whether a cell is mixed, or differs from a neighbour.
    fn changes(&self, f: &[f64], inflow: f64, i: usize) -> bool {
        let own = f[self.start + i];
        let differs = |next: Option<usize>, face: usize| match next {
            Some(next) => f[next] != own,
            None => self.is_open(face) && own != inflow,
        };
        let before = if i == 0 { self.ends[0] } else { Some(self.start + i - 1) };
        let after = if i + 1 == self.length { self.ends[1] } else { Some(self.start + i + 1) };
        let beside = &self.beside[..2 * (D - 1)];
        is_mixed(own)
            || differs(before, 0)
            || differs(after, 1)
            || beside.iter().enumerate().any(|(k, row)| differs(row.map(|row| row + i), k + 2))
    }

    /// Whether some cell from `from` up to `to` is mixed or differs from a neighbour, or lies at the end of the row.
    fn may_change(&self, f: &[f64], inflow: f64, from: usize, to: usize) -> bool {
        if from == 0 || to == self.length {
            return true;
        }
        let own = &f[self.start + from..self.start + to];
        let mixed = own.iter().fold(false, |any, &f| any | is_mixed(f));
        let shifted = |first: usize| differ(own, &f[first..first + to - from]);
        let beside = |(k, row): (usize, &Option<usize>)| match *row {
            Some(row) => shifted(row + from),
            None => self.is_open(k + 2) && own.iter().any(|&f| f != inflow),
        };
        mixed
            || shifted(self.start + from - 1)
            || shifted(self.start + from + 1)
            || self.beside[..2 * (D - 1)].iter().enumerate().any(beside)
    }
}

/// Whether two slices differ anywhere. All are looked at, which is faster than to stop.
fn differ(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).fold(false, |any, (a, b)| any | (a != b))
}
