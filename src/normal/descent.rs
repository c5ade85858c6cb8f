//! The search for the unit normal with the least misfit: Gauss-Newton steps on the sphere of directions, damped (Levenberg)
//! where they do not descend.
//!
//! With the residuals `r_j(m)` and their derivatives `p_j` by a turn of `m`, `|r|^2 -> min` asks for the step `s` across `m`
//!
//! ```text
//! (sum p p^T + damping) s = - sum r p
//! ```
//!
//! with a damping of one's [choice](Damping).
//!
//! A turn costs little to judge, its derivatives cost more: they are computed at every other point and taken from the last one in
//! between, which halves the cost and still squares the error every two steps.

use nalgebra::SMatrix;
use vofkit_geometry::Vector;

use crate::tolerance::{
    DESCENT_DAMPING, DESCENT_GAIN, DESCENT_POINTS, DESCENT_TURN, MISFIT_CURVED, MISFIT_NONE, MISFIT_ROUNDING,
    NORMAL_EQUATIONS, PLANE_DETERMINED,
};

/// The misfit at one normal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample<const D: usize> {
    /// `sum r^2`.
    pub(super) misfit: f64,
    /// `sum r p`.
    pub(super) gradient: Vector<D>,
    /// `sum p p^T`.
    pub(super) curvature: SMatrix<f64, D, D>,
}

impl<const D: usize> Default for Sample<D> {
    fn default() -> Self {
        Self { misfit: 0.0, gradient: Vector::zeros(), curvature: SMatrix::zeros() }
    }
}

impl<const D: usize> Sample<D> {
    /// Adds a residual with its derivative.
    pub(super) fn add(&mut self, residual: f64, slope: &Vector<D>) {
        self.misfit += residual * residual;
        self.gradient += slope * residual;
        self.curvature += slope * slope.transpose();
    }

    /// Whether a turn may make the misfit vanish: by the derivatives little of it is left. Only the square of the turn speaks against them.
    pub(super) fn may_vanish(&self, normal: &Vector<D>) -> bool {
        let gain = -step(self, normal, 0.0, Damping::Alike).dot(&self.gradient);
        self.misfit - gain <= (MISFIT_CURVED * self.misfit).max(MISFIT_NONE)
    }
}

/// Where a descent ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent<const D: usize> {
    pub(super) normal: Vector<D>,
    pub(super) misfit: f64,
    /// Whether the misfit rises in every direction from there.
    pub(super) determined: bool,
    /// Whether it ended before all points were used.
    pub(super) arrived: bool,
}

/// What is added to the curvature where a step does not descend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Damping {
    /// The same in all directions (Levenberg).
    Alike,
    /// A part of the curvature itself: steps become shorter and keep their direction, so that they go on along narrow valleys.
    Scaled,
}

/// Descends from `start`. `evaluate` is given a normal and whether to compute derivatives anew; none where it has no value.
pub(super) fn descend<const D: usize>(
    start: Vector<D>,
    kind: Damping,
    mut evaluate: impl FnMut(&Vector<D>, bool) -> Option<Sample<D>>,
) -> Option<Descent<D>> {
    let (mut normal, mut here, mut fresh) = (start, evaluate(&start, true)?, true);
    let (mut points, mut damping) = (1, 0.0);
    while points < DESCENT_POINTS {
        let step = step(&here, &normal, damping, kind);
        // What the linear model promises.
        let gain = -step.dot(&here.gradient);
        if !(gain > (DESCENT_GAIN * here.misfit).max(MISFIT_ROUNDING)) {
            if fresh {
                break;
            }
            (here, fresh) = (evaluate(&normal, true)?, true);
            points += 1;
            continue;
        }
        let trial = (normal + step).normalize();
        points += 1;
        match evaluate(&trial, !fresh) {
            Some(next) if next.misfit < here.misfit => {
                (normal, here, fresh) = (trial, next, !fresh);
                damping *= 0.1;
            }
            _ if fresh => damping = (10.0 * damping).max(DESCENT_DAMPING),
            _ => {
                (here, fresh) = (evaluate(&normal, true)?, true);
                points += 1;
            }
        }
    }
    let determined = least_curvature(&across(&here.curvature, &normal)) > PLANE_DETERMINED;
    Some(Descent { normal, misfit: here.misfit, determined, arrived: points < DESCENT_POINTS })
}

/// A matrix without what it has along the normal.
fn across<const D: usize>(matrix: &SMatrix<f64, D, D>, normal: &Vector<D>) -> SMatrix<f64, D, D> {
    let projection = SMatrix::identity() - normal * normal.transpose();
    projection * matrix * projection
}

fn step<const D: usize>(sample: &Sample<D>, normal: &Vector<D>, damping: f64, kind: Damping) -> Vector<D> {
    let gradient = sample.gradient - normal * normal.dot(&sample.gradient);
    let damper = match kind {
        Damping::Alike => SMatrix::identity() * across(&sample.curvature, normal).trace(),
        Damping::Scaled => sample.curvature,
    };
    let solved = solve_across(&(sample.curvature + damper * damping), &gradient, normal);
    let size = solved.norm();
    if size > DESCENT_TURN { solved * (-DESCENT_TURN / size) } else { -solved }
}

/// The vector `s` across the normal with `matrix s = right`.
pub(super) fn solve_across<const D: usize>(
    matrix: &SMatrix<f64, D, D>,
    right: &Vector<D>,
    normal: &Vector<D>,
) -> Vector<D> {
    let across = across(matrix, normal);
    let trace = across.trace();
    let full =
        across + normal * normal.transpose() * trace + SMatrix::identity() * (NORMAL_EQUATIONS * trace);
    let solved = full.try_inverse().map_or_else(Vector::zeros, |inverse| inverse * right);
    solved - normal * normal.dot(&solved)
}

/// The smallest eigenvalue of a symmetric matrix among the directions across the one that it maps to zero.
pub(super) fn least_curvature<const D: usize>(across: &SMatrix<f64, D, D>) -> f64 {
    let trace = across.trace();
    if D == 2 {
        return trace;
    }
    // Two eigenvalues have the sum `trace` and the sum of squares `|matrix|^2`.
    let apart = (2.0 * across.norm_squared() - trace * trace).max(0.0).sqrt();
    0.5 * (trace - apart)
}
