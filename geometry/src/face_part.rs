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
//! Several parts stand side by side and go through this arithmetic without branches, so that the compiler makes vector
//! instructions of it; each gets what it would get alone.

use crate::hyperbola::{Argument, Integrals};
use crate::root::Value;

/// A part of a face, as far as it does not depend on the level of the plane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// Heights of the first two of the face's corners.
    pub(crate) near: f64,
    pub(crate) next: f64,
    /// `L = base + |s1| per_next`, `R = |s2| per_across`.
    pub(crate) base: f64,
    pub(crate) per_next: f64,
    pub(crate) per_across: f64,
    /// `c` and its inverse.
    pub(crate) rise: f64,
    pub(crate) per_rise: f64,
    /// `t`, with the sign of the part: `c' - c = L t`.
    pub(crate) twist: f64,
    /// `g1`, `g2 - g1`, `g4 - g1`.
    pub(crate) density: [f64; 3],
    /// 1 for the part itself, -1 for the rest of its face, the whole face left out.
    ///
    /// Passing to the rest changes the sign of the integrals, and that of `s`, so that of `A` alone remains.
    pub(crate) sign: f64,
}

/// `N` parts side by side.
#[derive(Clone, Debug)]
pub(crate) struct Parts<const N: usize> {
    near: [f64; N],
    next: [f64; N],
    base: [f64; N],
    per_next: [f64; N],
    per_across: [f64; N],
    rise: [f64; N],
    per_rise: [f64; N],
    twist: [f64; N],
    density: [[f64; N]; 3],
    sign: [f64; N],
}

impl<const N: usize> Parts<N> {
    /// Parts that add nothing.
    #[inline(always)]
    pub(crate) fn new() -> Self {
        let (zero, one) = ([0.0; N], [1.0; N]);
        Self {
            near: zero,
            next: zero,
            base: zero,
            per_next: zero,
            per_across: zero,
            rise: one,
            per_rise: zero,
            twist: zero,
            density: [zero; 3],
            sign: zero,
        }
    }

    /// Puts a part in its place.
    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, part: Part) {
        self.near[i] = part.near;
        self.next[i] = part.next;
        self.base[i] = part.base;
        self.per_next[i] = part.per_next;
        self.per_across[i] = part.per_across;
        self.rise[i] = part.rise;
        self.per_rise[i] = part.per_rise;
        self.twist[i] = part.twist;
        for (column, density) in self.density.iter_mut().zip(part.density) {
            column[i] = density;
        }
        self.sign[i] = part.sign;
    }

    /// Adds the integrals over all parts, `V`, `A` and `dA/dlevel`, to a sum. `quotient` is asked for `c'` and `c`, or numbers in the
    /// same ratio, of a part where their difference does not tell the smaller one.
    #[inline(always)]
    pub(crate) fn integrate(&self, level: f64, sum: &mut Value, quotient: impl Fn(usize) -> [f64; 2]) {
        let mut lengths = [0.0; N];
        let mut widenings = [0.0; N];
        let mut arguments = [[0.0; N]; 4];
        let mut far = false;
        for i in 0..N {
            let length = self.base[i] + (self.near[i] - level).abs() * self.per_next[i];
            let (rise, widening) = (self.rise[i], length * self.twist[i]);
            // Rounding may pass the end where heights are rounding themselves.
            let widening = if widening > -rise { widening } else { -rise };
            let Argument { z, minus, plus, even } = Argument::near(widening / (2.0 * rise + widening));
            lengths[i] = length;
            widenings[i] = widening;
            (arguments[0][i], arguments[1][i], arguments[2][i], arguments[3][i]) = (z, minus, plus, even);
            far |= Argument::is_far(z);
        }
        if far {
            for i in 0..N {
                if Argument::is_far(arguments[0][i]) {
                    let Argument { minus, plus, even, .. } = Argument::far(arguments[0][i], quotient(i));
                    (arguments[1][i], arguments[2][i], arguments[3][i]) = (minus, plus, even);
                }
            }
        }
        let mut sums = [[0.0; N]; 3];
        for i in 0..N {
            let [z, minus, plus, even] = [0, 1, 2, 3].map(|field| arguments[field][i]);
            let one = self.one(i, level, lengths[i], widenings[i], Argument { z, minus, plus, even });
            (sums[0][i], sums[1][i], sums[2][i]) = (one.value, one.derivative, one.second);
        }
        for i in 0..N {
            *sum += Value { value: sums[0][i], derivative: sums[1][i], second: sums[2][i] };
        }
    }

    #[inline(always)]
    fn one(&self, i: usize, level: f64, length: f64, widening: f64, argument: Argument) -> Value {
        let [g1, alpha, beta] = [self.density[0][i], self.density[1][i] * length, self.density[2][i]];
        let Integrals { m00, m10, e, f, n0, n1 } = argument.integrals();
        let (rise, per_rise) = (self.rise[i], self.per_rise[i]);
        let right = (self.next[i] - level).abs() * self.per_across[i];
        let step = (self.near[i] - level).abs() * per_rise - right;
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
            derivative: self.sign[i]
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
