//! The integrals over the part of a ruled face below a plane.
//!
//! With the height `s` over the plane `m.y = level`, bilinear over the face, and a constant vector `e` with `m.e = 1`,
//! `div (s e) = 1`. The section, where `s = 0`, adds nothing, so volume, section and its derivative are sums over faces
//!
//! ```text
//! V = int -s G,   A = dV/dlevel = int G,   dA/dlevel,       G dalpha dbeta = -e.dGamma
//! ```
//!
//! over the part of the unit square where `s <= 0`; `G = g1 + (g2 - g1) alpha + (g4 - g1) beta` (Eq. 25) with
//! `g_i = -e.X_i` (Eq. 24). That part is a corner under a hyperbola, a strip under one, or the rest of the face without
//! corners. Both are the part `0 <= u <= 1` under `beta = R + S g(u)`, `g = (1 - u) / (1 + w u)`, in `u = alpha / L`:
//!
//! - a strip at the edge from corner 1 to 2 has `L = 1`, `R = s2/(s2-s3)`, `R + S = s1/(s1-s4)`, and with `c = s4-s1`,
//!   `c' = s3-s2` and `t = s1-s2+s3-s4` it has `1 + w = c'/c`, `c' - c = t`;
//! - a corner has `L = s1/(s1-s2)`, `R = 0`, `S = s1/(s1-s4)`, and `c' - c = L t`.
//!
//! With the moments `M_nm` of [`crate::hyperbola`], which belong to `z = w / (2 + w)`, `E = M00 - M10` and `F = M10 - M11`,
//!
//! ```text
//! V = L/2 [ g1 T0 + (g2 - g1) L T1 + (g4 - g1) T2 / 3 ]
//! T0 = R^2 (c + c')/2  + c S (R + S E)
//! T1 = R^2 (c + 2 c')/6 + c S (R/3 + 2/3 S F)
//! T2 = R^3 (c + c')/2  + c S (3/2 R^2 + 3 R S E + 2 S^2 F)
//! A = L [ g1 (R + S M00) + (g2 - g1) L (R/2 + S M10) + (g4 - g1) (R^2/2 + S (R M00 + S M10)) ]
//! dA/dlevel = L/c [ g1 N0 + (g2 - g1) L N1 + (g4 - g1) (R N0 + S N1) ]
//! ```
//!
//! A coordinate `x` across `e` has `div (x e) = 0`, so that the section's shadow along `e` has the moment `int x G`; `x` is bilinear,
//! and with `k_nm` of `u^n beta^m` over the part
//!
//! ```text
//! int x G = x1 W00 + (x2 - x1) L W10 + (x4 - x1) W01 + (x1 - x2 + x3 - x4) L W11
//! W_nm = g1 k_nm + (g2 - g1) L k_n+1,m + (g4 - g1) k_n,m+1
//! k_n0 = L (R/(n+1)     + S M_n0)
//! k_n1 = L (R^2/2/(n+1) + S (R M_n0 + S M_n1))
//! k_n2 = L (R^3/3/(n+1) + S (R^2 M_n0 + 2 R S M_n1 + S^2 M_n2))
//! ```
//!
//! All of it is arithmetic and choices between numbers, without branches: in a loop over faces the compiler makes vector instructions of it.

use crate::hyperbola::{Argument, Integrals};
use crate::root::Value;
use crate::simd::either;

/// A part of a face.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    /// `s1`.
    near: f64,
    /// `g1`, `(g2 - g1) L`, `g4 - g1`.
    density: [f64; 3],
    /// `c` and `c' - c`.
    rise: f64,
    widening: f64,
    length: f64,
    right: f64,
    sign: f64,
}

/// What a coordinate is to be multiplied by for its integral over a part of a face.
#[derive(Clone, Copy)]
pub(crate) struct Weights {
    all: [f64; 4],
    length: f64,
}

impl Weights {
    /// Those of a whole face with densities `g1`, `g2`, `g4`.
    #[inline(always)]
    pub(crate) fn of_whole_face([g1, g2, g4]: [f64; 3]) -> Self {
        let (alpha, beta) = (g2 - g1, g4 - g1);
        let [half, third] = [0.5 * g1, 1.0 / 3.0];
        let all = [
            g1 + 0.5 * (alpha + beta),
            half + third * alpha + 0.25 * beta,
            half + 0.25 * alpha + third * beta,
            0.5 * half + (1.0 / 6.0) * (alpha + beta),
        ];
        Self { all, length: 1.0 }
    }

    /// The integral of `G`.
    #[inline(always)]
    pub(crate) fn area(&self) -> f64 {
        self.all[0]
    }

    /// The integral of `x G` for the values of `x` at the corners.
    #[inline(always)]
    pub(crate) fn integrate(&self, [x1, x2, x3, x4]: [f64; 4]) -> f64 {
        let [w00, w10, w01, w11] = self.all;
        let (alpha, beta) = (x2 - x1, x4 - x1);
        x1 * w00 + beta * w01 + self.length * (alpha * w10 + ((x3 - x4) - alpha) * w11)
    }
}

/// What a part is made from, counted from one of the face's corners in outward order.
pub(crate) struct Corner {
    /// Heights over the plane of this corner and the next, `s1` and `s2`.
    pub(crate) heights: [f64; 2],
    /// `g1`, `g2` and `g4`.
    pub(crate) density: [f64; 3],
    /// Differences of height, positive, along the edges to the next corner, across from it, and to the last.
    pub(crate) rises: [f64; 3],
    /// `t`.
    pub(crate) twist: f64,
}

impl Part {
    /// The strip along the edge to the next corner, or the region at the corner. `sign` is 1 for the part itself, -1 for the rest of
    /// its face, the whole face left out.
    ///
    /// Passing to the rest changes the sign of the integrals, and that of `s`, so that of `A` alone remains.
    #[inline(always)]
    pub(crate) fn new(corner: Corner, strip: bool, sign: f64) -> Self {
        let Corner { heights: [near, next], density: [g1, g2, g4], rises: [to_next, across, rise], twist } =
            corner;
        let quotient = either(strip, next, near).abs() / either(strip, across, to_next);
        let length = either(strip, 1.0, quotient);
        let widening = length * (sign * twist);
        // Rounding may pass the end where heights are rounding themselves.
        let widening = either(widening > -rise, widening, -rise);
        let density = [g1, (g2 - g1) * length, g4 - g1];
        Self { near, density, rise, widening, length, right: either(strip, quotient, 0.0), sign }
    }

    /// The argument of the moments.
    #[inline(always)]
    pub(crate) fn z(&self) -> f64 {
        self.widening / (2.0 * self.rise + self.widening)
    }

    /// `W00`, `W10`, `W01` and `W11`.
    #[inline(always)]
    pub(crate) fn weights(&self, argument: Argument) -> Weights {
        let Self { near, density: [g1, alpha, beta], rise, length, right, sign, .. } = *self;
        let Integrals { m00, m10, .. } = argument.integrals();
        let [m11, m20, m21] = argument.second_moments();
        let step = near.abs() / rise - right;
        let curved = argument.minus * step;
        let square = right * right;
        let [first, both] = [right * m00 + step * m10, right * m10 + step * m11];
        let second = right * m20 + step * m21;
        let k00 = right + curved * m00;
        let k10 = 0.5 * right + curved * m10;
        let k20 = (1.0 / 3.0) * right + curved * m20;
        let k01 = 0.5 * square + curved * first;
        let k11 = 0.25 * square + curved * both;
        let k21 = (1.0 / 6.0) * square + curved * second;
        let k02 = (1.0 / 3.0) * square * right + curved * (right * (first + step * m10) + step * step * m20);
        let k12 = (1.0 / 6.0) * square * right + curved * (right * (both + step * m11) + step * step * m21);
        let weighted =
            |k: f64, along: f64, across: f64| sign * length * (g1 * k + alpha * along + beta * across);
        Weights {
            all: [
                weighted(k00, k10, k01),
                weighted(k10, k20, k11),
                weighted(k01, k11, k02),
                weighted(k11, k21, k12),
            ],
            length,
        }
    }

    /// The integrals `V`, `A` and `dA/dlevel`.
    #[inline(always)]
    pub(crate) fn integrate(&self, argument: Argument) -> Value {
        let Self { near, density: [g1, alpha, beta], rise, widening, length, right, sign } = *self;
        let Integrals { m00, m10, e, f, n0, n1 } = argument.integrals();
        let per_rise = 1.0 / rise;
        let step = near.abs() * per_rise - right;
        let both = 2.0 * rise + widening;
        let square = right * right;
        let curved = argument.minus * step;
        let lifted = rise * step;
        let (curved_e, curved_f) = (curved * e, curved * f);
        let t0 = 0.5 * square * both + lifted * (right + curved_e);
        let t1 = (1.0 / 6.0) * square * (both + rise + widening)
            + lifted * ((1.0 / 3.0) * right + (2.0 / 3.0) * curved_f);
        let t2 = 0.5 * square * right * both
            + lifted * (1.5 * square + 3.0 * right * curved_e + 2.0 * step * curved_f);
        let area = curved * m00;
        Value {
            value: 0.5 * length * (g1 * t0 + alpha * t1 + (1.0 / 3.0) * beta * t2),
            derivative: sign
                * length
                * (g1 * (right + area)
                    + alpha * (0.5 * right + curved * m10)
                    + beta * (0.5 * square + right * area + step * curved * m10)),
            second: argument.minus
                * length
                * per_rise
                * (g1 * n0 + alpha * n1 + beta * (right * n0 + step * n1)),
        }
    }
}
