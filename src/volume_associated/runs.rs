//! Runs of cells and faces that lie one after the other in memory, with their neighbours along an axis.
//!
//! Faces across an axis are counted like cells, with one more along that axis; at joined ends the first and the last are the
//! same face, counted twice. Along any axis the cells of a row (along the first axis) then have runs of neighbours and of faces, so that the
//! inner loops of all axes and dimensions are the same loop over slices.

use crate::mesh::Grid;

/// Cells one after the other, with what lies below and above each of them along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CellRun {
    /// The first cell, relative to the row.
    pub(crate) start: usize,
    /// The number of cells.
    pub(crate) len: usize,
    /// The first cell's neighbour below; none at an open end.
    pub(crate) below: Option<usize>,
    /// The first cell's neighbour above; none at an open end.
    pub(crate) above: Option<usize>,
    /// The first cell's lower face.
    pub(crate) lower: usize,
    /// The first cell's upper face.
    pub(crate) upper: usize,
}

/// Faces one after the other, with the cells below and above each of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FaceRun {
    /// The first face, relative to the row of faces.
    pub(crate) start: usize,
    /// The number of faces.
    pub(crate) len: usize,
    /// The cell below the first face; none at an open end.
    pub(crate) below: Option<usize>,
    /// The cell above the first face; none at an open end.
    pub(crate) above: Option<usize>,
}

/// The cells and faces of a grid as seen along one axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lines {
    axis: usize,
    /// Cells along the first axis.
    row: usize,
    /// Cells along the axis.
    cells: usize,
    /// Cells from one to the next along the axis.
    stride: usize,
    periodic: bool,
    rows: usize,
}

impl Lines {
    pub(crate) fn new<const D: usize>(grid: &Grid<D>, axis: usize) -> Self {
        let row = grid.cells()[0];
        Self {
            axis,
            row,
            cells: grid.cells()[axis],
            stride: grid.stride(axis),
            periodic: grid.periodic()[axis],
            rows: grid.len() / row,
        }
    }

    /// Faces across the axis.
    pub(crate) fn faces(&self) -> usize {
        self.rows * self.row / self.cells * (self.cells + 1)
    }

    /// Faces in a row of them.
    pub(crate) fn face_row(&self) -> usize {
        if self.axis == 0 { self.row + 1 } else { self.row }
    }

    /// Rows that differ only below the axis, the place along it, and what is above it.
    fn split(&self, row: usize, places: usize) -> [usize; 3] {
        let inner = self.stride / self.row;
        [row % inner, row / inner % places, row / inner / places]
    }

    /// The lower and the upper face of a cell of a row.
    pub(crate) fn faces_of(&self, row: usize, cell: usize) -> [usize; 2] {
        let lower = if self.axis == 0 {
            row * (self.row + 1) + cell
        } else {
            let [inner, at, outer] = self.split(row, self.cells);
            self.row * inner + cell + self.stride * (at + (self.cells + 1) * outer)
        };
        [lower, lower + self.stride]
    }

    /// The runs of a row of cells.
    pub(crate) fn cell_runs(self, row: usize) -> impl Iterator<Item = CellRun> {
        let (n, last) = (self.row, self.cells - 1);
        let run = |start: usize, len: usize, at: usize, lower: usize| {
            let first = row * n + start;
            let wrap = last * self.stride;
            let below =
                if at > 0 { Some(first - self.stride) } else { self.periodic.then_some(first + wrap) };
            let above =
                if at < last { Some(first + self.stride) } else { self.periodic.then(|| first - wrap) };
            CellRun { start, len, below, above, lower, upper: lower + self.stride }
        };
        let [face, _] = self.faces_of(row, 0);
        let runs = if self.axis == 0 {
            let inner = (n > 2).then(|| run(1, n - 2, 1, face + 1));
            [Some(run(0, 1, 0, face)), inner, (n > 1).then(|| run(last, 1, last, face + last))]
        } else {
            let [_, at, _] = self.split(row, self.cells);
            [Some(run(0, n, at, face)), None, None]
        };
        runs.into_iter().flatten()
    }

    /// The runs of a row of faces.
    pub(crate) fn face_runs(self, row: usize) -> impl Iterator<Item = FaceRun> {
        let (n, cells) = (self.row, self.cells);
        // `cell` is the one above the first face, or would be.
        let run = |start: usize, len: usize, at: usize, cell: usize| {
            let below = if at > 0 { Some(cell - self.stride) } else { None };
            let above = if at < cells { Some(cell) } else { None };
            let joined = |other: Option<usize>| other.filter(|_| self.periodic);
            FaceRun {
                start,
                len,
                below: below.or_else(|| joined(Some(cell + (cells - 1) * self.stride))),
                above: above.or_else(|| joined((at > 0).then(|| cell - cells * self.stride))),
            }
        };
        let runs = if self.axis == 0 {
            let cell = row * n;
            let inner = (n > 1).then(|| run(1, n - 1, 1, cell + 1));
            [Some(run(0, 1, 0, cell)), inner, Some(run(n, 1, n, cell + n))]
        } else {
            let [inner, at, outer] = self.split(row, cells + 1);
            let cell = n * inner + self.stride * (at + cells * outer);
            [Some(run(0, n, at, cell)), None, None]
        };
        runs.into_iter().flatten()
    }

    /// The first face of a row of faces.
    pub(crate) fn row_start(&self, row: usize) -> usize {
        row * self.face_row()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_and_face_comes_once_with_its_neighbours() {
        for (cells, periodic) in
            [([4, 3, 2], [true, false, true]), ([1, 2, 3], [true; 3]), ([2, 1, 1], [false; 3])]
        {
            let grid = Grid::<3>::new(cells, periodic);
            for axis in 0..3 {
                let lines = Lines::new(&grid, axis);
                let mut extent = cells;
                extent[axis] += 1;
                let face = |at: [usize; 3]| at[0] + extent[0] * (at[1] + extent[1] * at[2]);
                let mut seen = vec![0; grid.len()];
                for row in 0..grid.len() / cells[0] {
                    for run in lines.cell_runs(row) {
                        for i in 0..run.len {
                            let cell = row * cells[0] + run.start + i;
                            seen[cell] += 1;
                            let [below, above] = [run.below, run.above].map(|cell| cell.map(|cell| cell + i));
                            assert_eq!(below, grid.neighbour(cell, axis, 0));
                            assert_eq!(above, grid.neighbour(cell, axis, 1));
                            let mut at = grid.offset(cell);
                            assert_eq!(run.lower + i, face(at));
                            at[axis] += 1;
                            assert_eq!(run.upper + i, face(at));
                        }
                    }
                }
                assert!(seen.iter().all(|&count| count == 1));
                let mut seen = vec![0; lines.faces()];
                for row in 0..lines.faces() / lines.face_row() {
                    for run in lines.face_runs(row) {
                        for i in 0..run.len {
                            let index = lines.row_start(row) + run.start + i;
                            seen[index] += 1;
                            if let Some(cell) = run.below {
                                let mut at = grid.offset(cell + i);
                                at[axis] += 1;
                                assert!(face(at) == index || at[axis] == cells[axis] && periodic[axis]);
                            }
                            if let Some(cell) = run.above {
                                let at = grid.offset(cell + i);
                                assert!(face(at) == index || at[axis] == 0 && periodic[axis]);
                            }
                            assert!(run.below.is_some() || run.above.is_some());
                        }
                    }
                }
                assert!(seen.iter().all(|&count| count == 1));
            }
        }
    }
}
