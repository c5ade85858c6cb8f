//! Limited slopes along mesh lines.

use super::limiter::{Limiter, larger, min_mod, smaller, superbee, van_leer, woodward};
use super::runs::Lines;
use super::spacing::Spacing;
use crate::mesh::Grid;
use crate::parallel;

/// Half the limited slope times the length of the cell along an axis (Eq. 65): the line has `phi - half` at its lower and `phi + half` at its
/// upper end. The two one-sided values come from real distances; wherever a limiter is on, neither end leaves the interval of the means of
/// the cell and its neighbour there. Cells at open ends have none.
pub(super) fn half_increments<const D: usize>(
    grid: &Grid<D>,
    spacing: &Spacing<D>,
    axis: usize,
    limiter: Limiter,
    values: &[f64],
    half: &mut [f64],
) {
    let lines = Lines::new(grid, axis);
    let share = &spacing.below[axis];
    match limiter {
        Limiter::Superbee => limited(lines, grid, share, values, half, Some(1.0), superbee),
        Limiter::MinMod => limited(lines, grid, share, values, half, Some(1.0), min_mod),
        Limiter::Woodward => limited(lines, grid, share, values, half, Some(1.0), woodward),
        Limiter::VanLeer => limited(lines, grid, share, values, half, Some(1.0), van_leer),
        Limiter::ScaledMinMod { alpha } => {
            limited(lines, grid, share, values, half, Some(1.0), |a, b| alpha * min_mod(a, b));
        }
        // The factor, at most 2, comes later, with the face.
        Limiter::CourantMinMod => limited(lines, grid, share, values, half, Some(0.5), min_mod),
        Limiter::Off => {
            limited(lines, grid, share, values, half, None, |a, b| 0.5 * (a + b));
        }
    }
}

/// `limit(lower, upper)` of the one-sided half increments, at most `reach` times the smaller difference of the means on either side.
fn limited<const D: usize>(
    lines: Lines,
    grid: &Grid<D>,
    share: &[f64],
    values: &[f64],
    half: &mut [f64],
    reach: Option<f64>,
    limit: impl Fn(f64, f64) -> f64 + Sync + Send,
) {
    let row = grid.cells()[0];
    parallel::for_each_chunk(half, row, |r, half| {
        let centre = &values[r * row..(r + 1) * row];
        for run in lines.cell_runs(r) {
            let half = &mut half[run.start..][..run.len];
            let (Some(below), Some(above)) = (run.below, run.above) else {
                half.fill(0.0);
                continue;
            };
            let centre = &centre[run.start..][..half.len()];
            let [below, above] = [below, above].map(|cell| &values[cell..][..half.len()]);
            let [lower, upper] = [run.lower, run.upper].map(|face| &share[face..][..half.len()]);
            for i in 0..half.len() {
                let [down, up] = [centre[i] - below[i], above[i] - centre[i]];
                let wanted = limit((1.0 - lower[i]) * down, upper[i] * up);
                half[i] = match reach {
                    None => wanted,
                    Some(reach) => {
                        let most = reach * smaller(down.abs(), up.abs());
                        larger(smaller(wanted, most), -most)
                    }
                };
            }
        }
    });
}
