//! The new means from what crossed the faces (Eq. 48 and 51).

use super::carrier::Carrier;
use super::face_volumes::Pass;
use super::runs::Lines;
use crate::mesh::Grid;
use crate::parallel;

/// Writes the means after a pass,
///
/// ```text
/// phi+ = phi - sum over faces of G (phi_face - phi) / M+
/// ```
///
/// with the amounts `G` that leave through the faces and `M+` that is in the cell then: the same as
/// `phi+ M+ = phi M - sum G phi_face`, but a constant stays the same to the bit.
pub(super) fn advance<const D: usize>(
    grid: &Grid<D>,
    pass: Pass,
    carrier: &Carrier<D>,
    values: &[f64],
    faces: &[Vec<f64>; D],
    next: &mut [f64],
) {
    let row = grid.cells()[0];
    parallel::for_each_chunk(next, row, |r, next| {
        let values = &values[r * row..(r + 1) * row];
        let inverse = &carrier.inverse_after[r * row..(r + 1) * row];
        for axis in pass.axes() {
            for run in Lines::new(grid, axis).cell_runs(r) {
                let next = &mut next[run.start..][..run.len];
                let n = next.len();
                let [into, out] = [run.lower, run.upper].map(|face| &carrier.through[axis][face..][..n]);
                let [below, above] = [run.lower, run.upper].map(|face| &faces[axis][face..][..n]);
                let [values, inverse] = [values, inverse].map(|of_row| &of_row[run.start..][..n]);
                let loss = |i: usize| {
                    (out[i] * (above[i] - values[i]) - into[i] * (below[i] - values[i])) * inverse[i]
                };
                if axis == pass.first {
                    (0..n).for_each(|i| next[i] = values[i] - loss(i));
                } else {
                    (0..n).for_each(|i| next[i] -= loss(i));
                }
            }
        }
    });
}

/// What left through the open ends of the axes of a pass, less what came in.
pub(super) fn left<const D: usize>(
    grid: &Grid<D>,
    pass: Pass,
    carrier: &Carrier<D>,
    faces: &[Vec<f64>; D],
) -> f64 {
    let mut left = 0.0;
    for axis in pass.axes().filter(|&axis| !grid.periodic()[axis]) {
        let (inner, last) = (grid.stride(axis), grid.cells()[axis]);
        let block = inner * (last + 1);
        for outer in 0..faces[axis].len() / block {
            for i in 0..inner {
                let [lower, upper] = [outer * block + i, outer * block + last * inner + i];
                let amount = |face: usize| carrier.through[axis][face] * faces[axis][face];
                left += amount(upper) - amount(lower);
            }
        }
    }
    left
}
