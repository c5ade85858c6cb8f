//! Flux-corrected transport: the limiter of Zalesak (1979), over all faces of a pass at once.
//!
//! The amount `A = G (phi_high - phi_donor)` that the high-order scheme moves beyond the donor scheme is taken, face by face, as far as it makes
//! no cell leave the interval of its own and its neighbours' means, before the pass and after it by the donor scheme. An amount against the
//! gradient of the latter is not taken at all: it would only flatten.

use super::carrier::Carrier;
use super::face_values::Means;
use super::face_volumes::Pass;
use super::limiter::{larger, smaller};
use super::runs::Lines;
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
    /// What the high-order scheme moves beyond the donor scheme towards higher indices; 0 where that is not taken at all.
    extra: [Vec<f64>; D],
    /// The upper (or minus the lower) bound of each cell, alone and with its neighbours.
    bound: Vec<f64>,
    most: Vec<f64>,
    /// The part of what would come in, and of what would go out, that fits.
    fits: [Vec<f64>; 2],
}

impl<const D: usize> Correction<D> {
    pub(super) fn new(grid: &Grid<D>) -> Self {
        let cells = || vec![0.0; grid.len()];
        let faces: [Vec<f64>; D] = std::array::from_fn(|axis| vec![0.0; Lines::new(grid, axis).faces()]);
        Self {
            donor: faces.clone(),
            low: cells(),
            extra: faces,
            bound: cells(),
            most: cells(),
            fits: [cells(), cells()],
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
        self.set_extra(grid, carrier, pass, faces);
        for sign in [1.0, -1.0] {
            self.bound_cells(means, pass, sign);
            self.fit(grid, carrier, pass, sign);
        }
        for axis in pass.axes() {
            let lines = Lines::new(grid, axis);
            let (donor, extra, [gain, loss]) = (&self.donor[axis], &self.extra[axis], &self.fits);
            parallel::for_each_chunk(&mut faces[axis], lines.face_row(), |row, faces| {
                let first = lines.row_start(row);
                for run in lines.face_runs(row) {
                    let faces = &mut faces[run.start..][..run.len];
                    let n = faces.len();
                    let [donor, extra] = [donor, extra].map(|of_face| &of_face[first + run.start..][..n]);
                    let (Some(below), Some(above)) = (run.below, run.above) else {
                        faces.copy_from_slice(donor);
                        continue;
                    };
                    let of_cells = |cell: usize| [gain, loss].map(|fits| &fits[cell..][..n]);
                    let ([gain_below, loss_below], [gain_above, loss_above]) =
                        (of_cells(below), of_cells(above));
                    for i in 0..n {
                        let up = smaller(gain_above[i], loss_below[i]);
                        let down = smaller(gain_below[i], loss_above[i]);
                        let part = if extra[i] > 0.0 { up } else { down };
                        let part = if extra[i] == 0.0 { 0.0 } else { part };
                        faces[i] = donor[i] + part * (faces[i] - donor[i]);
                    }
                }
            });
        }
    }

    /// The amounts beyond those of the donor scheme that are not against the gradient; none through open ends.
    fn set_extra(&mut self, grid: &Grid<D>, carrier: &Carrier<D>, pass: Pass, faces: &[Vec<f64>; D]) {
        let low = &self.low;
        for axis in pass.axes() {
            let lines = Lines::new(grid, axis);
            let (donor, high, through) = (&self.donor[axis], &faces[axis], &carrier.through[axis]);
            parallel::for_each_chunk(&mut self.extra[axis], lines.face_row(), |row, extra| {
                let first = lines.row_start(row);
                for run in lines.face_runs(row) {
                    let extra = &mut extra[run.start..][..run.len];
                    let n = extra.len();
                    let (Some(below), Some(above)) = (run.below, run.above) else {
                        extra.fill(0.0);
                        continue;
                    };
                    let [donor, high, through] =
                        [donor, high, through].map(|of_face| &of_face[first + run.start..][..n]);
                    let [below, above] = [below, above].map(|cell| &low[cell..][..n]);
                    for i in 0..n {
                        let amount = through[i] * (high[i] - donor[i]);
                        let uphill = amount * (above[i] - below[i]) < 0.0;
                        extra[i] = if uphill { 0.0 } else { amount };
                    }
                }
            });
        }
    }

    /// The largest value (`sign` 1), or minus the least one (`sign` -1), of each cell and its neighbours before and after the donor scheme.
    fn bound_cells(&mut self, means: Means<'_, D>, pass: Pass, sign: f64) {
        let (grid, low, values) = (means.grid, &self.low, means.values);
        let row = grid.cells()[0];
        parallel::for_each_chunk(&mut self.bound, row, |r, bound| {
            let [low, values] = [low.as_slice(), values].map(|of_cell| &of_cell[r * row..][..row]);
            for i in 0..row {
                bound[i] = larger(sign * values[i], sign * low[i]);
            }
        });
        let bound = &self.bound;
        parallel::for_each_chunk(&mut self.most, row, |r, most| {
            most.copy_from_slice(&bound[r * row..][..row]);
            for axis in pass.axes() {
                for run in Lines::new(grid, axis).cell_runs(r) {
                    let most = &mut most[run.start..][..run.len];
                    for next in [run.below, run.above].into_iter().flatten() {
                        let next = &bound[next..][..most.len()];
                        for i in 0..most.len() {
                            most[i] = larger(most[i], next[i]);
                        }
                    }
                }
            }
        });
    }

    /// For every cell the part of the extra amounts that would come in (`sign` 1) or go out (`sign` -1) that fits.
    fn fit(&mut self, grid: &Grid<D>, carrier: &Carrier<D>, pass: Pass, sign: f64) {
        let row = grid.cells()[0];
        let (extra, low, most) = (&self.extra, &self.low, &self.most);
        parallel::for_each_chunk(&mut self.fits[usize::from(sign < 0.0)], row, |r, fits| {
            // What comes in is added up first, then the room there is.
            fits.fill(0.0);
            for axis in pass.axes() {
                for run in Lines::new(grid, axis).cell_runs(r) {
                    let fits = &mut fits[run.start..][..run.len];
                    let n = fits.len();
                    let [into, out] = [run.lower, run.upper].map(|face| &extra[axis][face..][..n]);
                    for i in 0..n {
                        fits[i] += larger(sign * into[i], 0.0) + larger(-sign * out[i], 0.0);
                    }
                }
            }
            let [low, most, after] = [low, most, &carrier.after].map(|of_cell| &of_cell[r * row..][..row]);
            for i in 0..row {
                let room = larger((most[i] - sign * low[i]) * after[i], 0.0);
                fits[i] = if fits[i] > room { room / fits[i] } else { 1.0 };
            }
        });
    }
}
