//! The value of a quantity in what crosses each face, by the schemes that need no more than the cells next to it.

use super::carrier::Carrier;
use super::face_volumes::Pass;
use super::limiter::{Limiter, courant_alpha};
use super::runs::Lines;
use super::scheme::Scheme;
use super::slopes::half_increments;
use super::spacing::Spacing;
use crate::mesh::Grid;
use crate::parallel;

/// The mean values of a quantity and what they lie on.
#[derive(Clone, Copy)]
pub(super) struct Means<'a, const D: usize> {
    pub(super) grid: &'a Grid<D>,
    pub(super) spacing: &'a Spacing<D>,
    pub(super) values: &'a [f64],
    /// The value of what flows in through open ends; none for that of the cell it flows into.
    pub(super) inflow: Option<f64>,
}

/// Writes the face values of the axes of a pass; `half` is memory for the slopes, empty for schemes without.
pub(super) fn set<const D: usize>(
    means: Means<'_, D>,
    scheme: Scheme,
    carrier: &Carrier<D>,
    pass: Pass,
    half: &mut [f64],
    faces: &mut [Vec<f64>; D],
) {
    for axis in pass.axes() {
        if let Some(limiter) = scheme.limiter() {
            half_increments(means.grid, means.spacing, axis, limiter, means.values, half);
        }
        let line = Line { means, axis, carrier, half };
        let out = &mut faces[axis];
        match scheme {
            Scheme::Donor => line.donor(out),
            // The flux-corrected scheme starts from Lax-Wendroff.
            Scheme::LaxWendroff | Scheme::Fct => line.lax_wendroff(out),
            Scheme::Tvd(Limiter::CourantMinMod) => line.sloped(out, courant_alpha),
            Scheme::Tvd(_) => line.sloped(out, |_| 1.0),
            Scheme::Muscl(Limiter::CourantMinMod) => {
                line.sloped(out, |courant| courant_alpha(courant) * (1.0 - courant));
            }
            Scheme::Muscl(_) => line.sloped(out, |courant| 1.0 - courant),
        }
    }
}

/// The faces across one axis.
#[derive(Clone, Copy)]
struct Line<'a, const D: usize> {
    means: Means<'a, D>,
    axis: usize,
    carrier: &'a Carrier<D>,
    half: &'a [f64],
}

/// What the loops over faces read of a face.
#[derive(Clone, Copy)]
struct Face {
    through: f64,
    courant: f64,
    share: f64,
    below: f64,
    above: f64,
    half_below: f64,
    half_above: f64,
}

impl<const D: usize> Line<'_, D> {
    fn donor(&self, out: &mut [f64]) {
        self.each(out, |face| if face.through > 0.0 { face.below } else { face.above });
    }

    fn lax_wendroff(&self, out: &mut [f64]) {
        self.each(out, |face| {
            let ahead = (1.0 - face.courant) * (face.above - face.below);
            let [up, down] = [face.below + ahead * face.share, face.above - ahead * (1.0 - face.share)];
            if face.through > 0.0 { up } else { down }
        });
    }

    /// The giving cell's mean and `factor(Cr)` of its half increment towards the face.
    fn sloped(&self, out: &mut [f64], factor: impl Fn(f64) -> f64 + Sync + Send) {
        self.each(out, |face| {
            let factor = factor(face.courant);
            let [up, down] = [face.below + factor * face.half_below, face.above - factor * face.half_above];
            if face.through > 0.0 { up } else { down }
        });
    }

    fn each(&self, out: &mut [f64], value: impl Fn(Face) -> f64 + Sync + Send) {
        let Self { means, axis, carrier, half } = *self;
        let lines = Lines::new(means.grid, axis);
        // Schemes without slopes do not look at them.
        let half = if half.is_empty() { means.values } else { half };
        parallel::for_each_chunk(out, lines.face_row(), |row, out| {
            let first = lines.row_start(row);
            for run in lines.face_runs(row) {
                let out = &mut out[run.start..][..run.len];
                let n = out.len();
                let face = first + run.start;
                let through = &carrier.through[axis][face..][..n];
                let [Some(below), Some(above)] = [run.below, run.above] else {
                    self.at_end([run.below, run.above], through, out);
                    continue;
                };
                let [courant, share] =
                    [&carrier.courant[axis], &means.spacing.below[axis]].map(|of_face| &of_face[face..][..n]);
                let of_cells = |cell: usize| [&means.values[cell..][..n], &half[cell..][..n]];
                let ([below, half_below], [above, half_above]) = (of_cells(below), of_cells(above));
                for i in 0..n {
                    out[i] = value(Face {
                        through: through[i],
                        courant: courant[i],
                        share: share[i],
                        below: below[i],
                        above: above[i],
                        half_below: half_below[i],
                        half_above: half_above[i],
                    });
                }
            }
        });
    }

    /// At an open end what leaves has the mean of the last cell, and what comes in the inflow value.
    fn at_end(&self, [below, above]: [Option<usize>; 2], through: &[f64], out: &mut [f64]) {
        let leaves_upwards = below.is_some();
        let cell = below.or(above).unwrap_or_default();
        for (i, (out, &through)) in out.iter_mut().zip(through).enumerate() {
            let inside = self.means.values[cell + i];
            let leaves = (through > 0.0) == leaves_upwards;
            *out = if leaves { inside } else { self.means.inflow.unwrap_or(inside) };
        }
    }
}
