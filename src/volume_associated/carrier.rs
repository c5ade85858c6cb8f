//! What carries the quantities from cell to cell in a pass: volume (Eq. 48-50) or mass (Eq. 51-52).

use super::face_volumes::{FaceVolumes, Pass};
use super::runs::Lines;
use crate::mesh::Grid;
use crate::parallel;
use crate::tolerance::OUTFLOW_EXCESS;

/// The amounts of volume or mass in the cells before and after a pass, and what crosses the faces.
#[derive(Clone, Debug)]
pub(super) struct Carrier<const D: usize> {
    /// Across each face towards higher indices; only the axes of the pass count.
    pub(super) through: [Vec<f64>; D],
    /// `|through|` over the amount in the cell that gives, at most 1.
    pub(super) courant: [Vec<f64>; D],
    pub(super) before: Vec<f64>,
    pub(super) after: Vec<f64>,
    /// One over `after`; 0 where there is nothing, so that a cell without volume or mass keeps its values.
    pub(super) inverse_after: Vec<f64>,
}

/// A cell that would give away more than it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Overdrawn {
    pub(super) cell: usize,
    pub(super) holds: f64,
    pub(super) outflow: f64,
}

impl<const D: usize> Carrier<D> {
    pub(super) fn new(grid: &Grid<D>) -> Self {
        let faces: [Vec<f64>; D] = FaceVolumes::zero(grid).through;
        let cells = vec![0.0; grid.len()];
        Self {
            through: faces.clone(),
            courant: faces,
            before: cells.clone(),
            after: cells.clone(),
            inverse_after: cells,
        }
    }

    /// Makes it the volume of the cells, `volumes + change`, of which the pass takes its part of the step's volumes; `change` is then that
    /// after the pass. Sums of the volumes of a step are exact in flow mode, so that `change` returns to 0 to the bit.
    pub(super) fn set_volume(
        &mut self,
        grid: &Grid<D>,
        pass: Pass,
        step: &FaceVolumes<D>,
        volumes: &[f64],
        change: &mut [f64],
    ) {
        for axis in pass.axes() {
            let row = Lines::new(grid, axis).face_row();
            parallel::for_each_chunk(&mut self.through[axis], row, |r, faces| {
                for (face, &volume) in faces.iter_mut().zip(&step.through[axis][r * row..]) {
                    *face = pass.part * volume;
                }
            });
        }
        let row = grid.cells()[0];
        add(&mut self.before, row, volumes, change);
        let through = &self.through;
        parallel::for_each_chunk(change, row, |r, change| {
            for axis in pass.axes() {
                for run in Lines::new(grid, axis).cell_runs(r) {
                    let [lower, upper] =
                        [run.lower, run.upper].map(|face| &through[axis][face..face + run.len]);
                    let change = &mut change[run.start..run.start + run.len];
                    for i in 0..run.len {
                        change[i] -= upper[i] - lower[i];
                    }
                }
            }
        });
        add(&mut self.after, row, volumes, change);
        self.complete(grid, pass);
    }

    /// Makes it the mass of the cells: `density` and `new_density` before and after the pass, and the face values of the density that the
    /// volume `carrier` took along.
    pub(super) fn set_mass(
        &mut self,
        grid: &Grid<D>,
        pass: Pass,
        carrier: &Self,
        density: [&[f64]; 2],
        face_density: &[Vec<f64>; D],
    ) {
        for axis in pass.axes() {
            let row = Lines::new(grid, axis).face_row();
            multiply(&mut self.through[axis], row, &carrier.through[axis], &face_density[axis]);
        }
        let row = grid.cells()[0];
        multiply(&mut self.before, row, &carrier.before, density[0]);
        multiply(&mut self.after, row, &carrier.after, density[1]);
        self.complete(grid, pass);
    }

    /// Courant numbers and inverses, from the amounts.
    fn complete(&mut self, grid: &Grid<D>, pass: Pass) {
        let (through, before, after) = (&self.through, &self.before, &self.after);
        let row = grid.cells()[0];
        parallel::for_each_chunk(&mut self.inverse_after, row, |r, inverse| {
            for (inverse, &after) in inverse.iter_mut().zip(&after[r * row..]) {
                *inverse = if after > 0.0 { after.recip() } else { 0.0 };
            }
        });
        for axis in pass.axes() {
            let lines = Lines::new(grid, axis);
            parallel::for_each_chunk(&mut self.courant[axis], lines.face_row(), |r, courant| {
                let through = &through[axis][lines.row_start(r)..];
                for run in lines.face_runs(r) {
                    // At an open end what comes in has no cell to come from.
                    let [below, above] = [run.below.or(run.above), run.above.or(run.below)].map(|cell| {
                        let cell = cell.unwrap_or_default();
                        &before[cell..cell + run.len]
                    });
                    let through = &through[run.start..run.start + run.len];
                    let courant = &mut courant[run.start..run.start + run.len];
                    for i in 0..run.len {
                        let held = if through[i] > 0.0 { below[i] } else { above[i] };
                        let part = through[i].abs() / held.max(f64::MIN_POSITIVE);
                        courant[i] = part.min(1.0);
                    }
                }
            });
        }
    }

    /// The first cell that gives away more than it holds.
    pub(super) fn overdrawn(&self, grid: &Grid<D>, pass: Pass, volumes: &[f64]) -> Option<Overdrawn> {
        let row = grid.cells()[0];
        let of_row = |r: usize| {
            let mut first: Option<Overdrawn> = None;
            for i in 0..row {
                let cell = r * row + i;
                let mut outflow = 0.0;
                for axis in pass.axes() {
                    let [lower, upper] = Lines::new(grid, axis).faces_of(r, i);
                    outflow += self.through[axis][upper].max(0.0) - self.through[axis][lower].min(0.0);
                }
                let holds = self.before[cell];
                if outflow > holds + OUTFLOW_EXCESS * volumes[cell] {
                    first = first.or(Some(Overdrawn { cell, holds, outflow }));
                }
            }
            first
        };
        parallel::map(grid.len() / row, of_row).into_iter().flatten().next()
    }
}

fn add(sum: &mut [f64], row: usize, a: &[f64], b: &[f64]) {
    parallel::for_each_chunk(sum, row, |r, sum| {
        for ((sum, a), b) in sum.iter_mut().zip(&a[r * row..]).zip(&b[r * row..]) {
            *sum = a + b;
        }
    });
}

fn multiply(product: &mut [f64], row: usize, a: &[f64], b: &[f64]) {
    parallel::for_each_chunk(product, row, |r, product| {
        for ((product, a), b) in product.iter_mut().zip(&a[r * row..]).zip(&b[r * row..]) {
            *product = a * b;
        }
    });
}
