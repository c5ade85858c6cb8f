//! Flux-corrected transport: the limiter of Zalesak (1979), over all faces of a pass at once.
//!
//! The amount `A = G (phi_high - phi_donor)` that the high-order scheme moves beyond the donor scheme is taken, face by face, as far as it makes
//! no cell leave the interval of its own and its neighbours' means, before the pass and after it by the donor scheme. An amount against the
//! gradient of the latter is not taken at all: it would only flatten.

use super::carrier::Carrier;
use super::face_values::Means;
use super::face_volumes::Pass;
use super::runs::{CellRun, Lines};
use super::scheme::Scheme;
use super::{face_values, update};
use crate::mesh::Grid;
use crate::parallel;

/// Memory for the limiter.
#[derive(Clone, Debug)]
pub(super) struct Correction<const D: usize> {
    donor: [Vec<f64>; D],
    /// The means after the pass by the donor scheme.
    low: Vec<f64>,
    /// The part of what would come in, and of what would go out, that fits.
    fits: [Vec<f64>; 2],
}

impl<const D: usize> Correction<D> {
    pub(super) fn new(grid: &Grid<D>) -> Self {
        let cells = vec![0.0; grid.len()];
        Self {
            donor: std::array::from_fn(|axis| vec![0.0; Lines::new(grid, axis).faces()]),
            low: cells.clone(),
            fits: [cells.clone(), cells],
        }
    }

    /// Limits high-order face values in place.
    pub(super) fn limit(
        &mut self,
        means: Means<'_, D>,
        carrier: &Carrier<D>,
        pass: Pass,
        faces: &mut [Vec<f64>; D],
    ) {
        let grid = means.grid;
        face_values::set(means, Scheme::Donor, carrier, pass, &mut [], &mut self.donor);
        update::advance(grid, pass, carrier, means.values, &self.donor, &mut self.low);
        for sign in [1.0, -1.0] {
            let fits = &mut self.fits[usize::from(sign < 0.0)];
            fit(means, carrier, pass, &self.donor, &self.low, faces, sign, fits);
        }
        for axis in pass.axes() {
            let lines = Lines::new(grid, axis);
            let (donor, low, [gain, loss]) = (&self.donor[axis], &self.low, &self.fits);
            parallel::for_each_chunk(&mut faces[axis], lines.face_row(), |row, faces| {
                let first = lines.row_start(row);
                for run in lines.face_runs(row) {
                    for i in run.start..run.start + run.len {
                        let face = first + i;
                        let (Some(b), Some(a)) = (run.below, run.above) else {
                            faces[i] = donor[face];
                            continue;
                        };
                        let (b, a) = (b + i - run.start, a + i - run.start);
                        let extra = faces[i] - donor[face];
                        let amount = carrier.through[axis][face] * extra;
                        let part = if amount * (low[a] - low[b]) < 0.0 {
                            0.0
                        } else if amount > 0.0 {
                            gain[a].min(loss[b])
                        } else {
                            gain[b].min(loss[a])
                        };
                        faces[i] = donor[face] + part * extra;
                    }
                }
            });
        }
    }
}

/// For every cell the part of the extra amounts that would come in (`sign` 1) or go out (`sign` -1) that fits.
#[expect(clippy::too_many_arguments, reason = "the loop reads all of them")]
fn fit<const D: usize>(
    means: Means<'_, D>,
    carrier: &Carrier<D>,
    pass: Pass,
    donor: &[Vec<f64>; D],
    low: &[f64],
    high: &[Vec<f64>; D],
    sign: f64,
    fits: &mut [f64],
) {
    let (grid, values) = (means.grid, means.values);
    let row = grid.cells()[0];
    parallel::for_each_chunk(fits, row, |r, fits| {
        let runs = |axis: usize| Lines::new(grid, axis).cell_runs(r);
        let extra = |axis: usize, face: usize, [below, above]: [Option<usize>; 2]| {
            // Through open ends the donor's amount goes, and through none that is against the gradient anything extra.
            let (Some(b), Some(a)) = (below, above) else { return 0.0 };
            let amount = carrier.through[axis][face] * (high[axis][face] - donor[axis][face]);
            if amount * (low[a] - low[b]) < 0.0 { 0.0 } else { amount }
        };
        // What comes in is added up first, then the room there is.
        fits.fill(0.0);
        for axis in pass.axes() {
            for run in runs(axis) {
                for i in 0..run.len {
                    let cell = r * row + run.start + i;
                    let CellRun { below, above, lower, upper, .. } = run;
                    let [below, above] = [below, above].map(|cell| cell.map(|cell| cell + i));
                    let into = extra(axis, lower + i, [below, Some(cell)]);
                    let out = extra(axis, upper + i, [Some(cell), above]);
                    fits[run.start + i] += (sign * into).max(0.0) + (-sign * out).max(0.0);
                }
            }
        }
        for (i, fits) in fits.iter_mut().enumerate() {
            let cell = r * row + i;
            let bound = |cell: usize| (sign * values[cell]).max(sign * low[cell]);
            let mut most = bound(cell);
            for axis in pass.axes() {
                for side in 0..2 {
                    if let Some(next) = grid.neighbour(cell, axis, side) {
                        most = most.max(bound(next));
                    }
                }
            }
            let room = (most - sign * low[cell]) * carrier.after[cell];
            *fits = if *fits > room { room.max(0.0) / *fits } else { 1.0 };
        }
    });
}
