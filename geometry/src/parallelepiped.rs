//! The unit square and cube cut by a plane, and the inverse, in closed form (Scardovelli & Zaleski 2000).
//!
//! For the unit cube and a plane with normal `m`, reflecting and sorting the axes makes `0 <= m1 <= m2 <= m3`;
//! with the depth `a` of the plane over the lowest corner, from the nearer end so that `2 a <= m1 + m2 + m3`:
//!
//! ```text
//! V = a^3 / (6 m1 m2 m3)                                          a <= m1
//! V = (3 a (a - m1) + m1^2) / (6 m2 m3) - c(a - m2) - c(a - m3)   m1 < a,  c(t) = max(t, 0)^3 / (6 m1 m2 m3)
//! V = (2 a - m1 - m2) / (2 m3)                                    m1 + m2 <= a <= m3
//! ```
//!
//! The cubic corrections `c` are at most `m1^2 / (6 m2 m3)`, so nothing cancels as `m1` goes to zero, as it
//! does when the second and third line of the usual listing are put over `m1 m2 m3`. A square is a cube with `m1 = 0`.
//!
//! The inverse needs a root of a cubic where corrections count. About its point of inflexion, with `y = -t / r`, the cubic is
//! `y^3 - 3 y + 2 x = 0` in both cases, and the root wanted is the smallest one (Lehmann & Gekle 2022 have its cosine form):
//!
//! ```text
//! a = m1 + m2 + t,                r^2 = 2 m1 m2,                             2 x = 3 (m1 + m2 - 2 m3 V) / (2 r)    m2 < a <= m3
//! a = (m1 + m2 + m3) / 2 + t,     r^2 = m1 m2 - (m1 + m2 - m3)^2 / 4,        2 x = 3 m1 m2 m3 (1/2 - V) / r^3      m3 < a
//! ```
//!
//! Both are exact to rounding as `m1` goes to zero.

use crate::root::Value;
use crate::simd::either;

/// The unit square or cube along one direction `m`.
#[derive(Clone, Copy, Debug)]
pub struct UnitCube {
    m: [f64; 3],
    sum: f64,
}

impl UnitCube {
    /// For the direction `m`; two components for the square, three for the cube.
    pub fn new(m: &[f64]) -> Self {
        let mut magnitudes = [0.0; 3];
        for (magnitude, component) in magnitudes.iter_mut().zip(m) {
            *magnitude = component.abs();
        }
        let [a, b, c] = magnitudes;
        let [a, b] = sorted(a, b);
        let [b, c] = sorted(b, c);
        let [a, b] = sorted(a, b);
        let m = [a, b, c];
        Self { m, sum: m[0] + m[1] + m[2] }
    }

    /// The depth of the highest corner over the lowest.
    pub fn span(&self) -> f64 {
        self.sum
    }

    /// The part of the volume below the depth `a`, and its derivative with respect to `a`.
    #[inline(always)]
    pub fn volume(&self, a: f64) -> Value {
        if a <= 0.0 {
            return Value::default();
        }
        if a >= self.sum {
            return Value { value: 1.0, ..Value::default() };
        }
        if 2.0 * a <= self.sum {
            self.lower_half(a)
        } else {
            let Value { value, derivative, second } = self.lower_half(self.sum - a);
            Value { value: 1.0 - value, derivative, second: -second }
        }
    }

    #[inline(always)]
    fn lower_half(&self, a: f64) -> Value {
        let [m1, m2, m3] = self.m;
        if a < m1 {
            let (r1, r2, r3) = (a / m1, a / m2, a / m3);
            return Value {
                value: r1 * r2 * r3 / 6.0,
                derivative: 0.5 * r1 * r2 / m3,
                second: (r1 / m2) / m3,
            };
        }
        if a >= m1 + m2 && a <= m3 {
            return Value { value: (2.0 * a - m1 - m2) / (2.0 * m3), derivative: 1.0 / m3, second: 0.0 };
        }
        let inverse = 1.0 / (m2 * m3);
        let mut value = (3.0 * a * (a - m1) + m1 * m1) * inverse / 6.0;
        let mut derivative = (a - 0.5 * m1) * inverse;
        let mut second = inverse;
        for m in [m2, m3] {
            let t = a - m;
            if t > 0.0 {
                let linear = (t / m1) * inverse;
                value -= linear * t * t / 6.0;
                derivative -= 0.5 * linear * t;
                second -= linear;
            }
        }
        Value { value, derivative, second }
    }

    /// The depth below which the part `fraction` in `[0, 1]` of the volume lies: the inverse of [`UnitCube::volume`].
    #[inline(always)]
    pub fn position(&self, fraction: f64) -> f64 {
        if fraction <= 0.5 {
            self.lower_position(fraction)
        } else {
            self.sum - self.lower_position(1.0 - fraction)
        }
    }

    #[inline(always)]
    fn lower_position(&self, fraction: f64) -> f64 {
        let [m1, m2, m3] = self.m;
        let corner = m1 * m1 / (6.0 * m2 * m3);
        if fraction <= 0.0 {
            return 0.0;
        }
        if fraction < corner {
            return (6.0 * m1 * m2 * m3 * fraction).cbrt();
        }
        // m2 = 0 makes corner NaN: the section is then always a full one.
        if corner.is_nan() || (m1 + m2 <= m3 && fraction >= (m1 + m2) / (2.0 * m3)) {
            return m3 * fraction + 0.5 * (m1 + m2);
        }
        let a = 0.5 * (m1 + (m1 * m1 + 8.0 * m2 * m3 * (fraction - corner)).sqrt());
        if a <= m2 {
            return a;
        }
        // c(a - m2) alone: about the middle m1 + m2 of the strip's linear part.
        let middle = m1 + m2;
        let r = (2.0 * m1 * m2).sqrt();
        let a = middle - r * middle_root(0.75 * (middle - 2.0 * m3 * fraction) / r);
        if a <= m3 {
            return a;
        }
        // Both: about the centre of the cube.
        let excess = middle - m3;
        let square = m1 * m2 - 0.25 * excess * excess;
        let r = square.sqrt();
        0.5 * self.sum - r * middle_root(1.5 * m1 * m2 * m3 * (0.5 - fraction) / (square * r))
    }
}

/// Two numbers, the smaller one first.
#[inline(always)]
fn sorted(a: f64, b: f64) -> [f64; 2] {
    let swap = b < a;
    [either(swap, b, a), either(swap, a, b)]
}

/// The smallest root `2 sin(asin(x) / 3)` of `y^3 - 3 y + 2 x`, for `x` from 0 to [`MIDDLE_END`].
///
/// A cubic in `x^2` is right to a thousandth, and each of two of Halley's steps triples the digits.
#[inline(always)]
fn middle_root(x: f64) -> f64 {
    let x = if x < MIDDLE_END { x } else { MIDDLE_END };
    let x = if x > 0.0 { x } else { 0.0 };
    let square = x * x;
    let [c0, c1, c2, c3] = MIDDLE_START;
    let start = x * (c0 + square * (c1 + square * (c2 + square * c3)));
    (0..2).fold(start, |y, _| {
        let (value, slope) = (2.0 * x - y * (3.0 - y * y), 3.0 * (y * y - 1.0));
        y - value * slope / (slope * slope - 3.0 * y * value)
    })
}

/// The largest argument of [`middle_root`]: where the root is `1 / sqrt 2`, for `m1 = m2` at the depth `m2`.
const MIDDLE_END: f64 = 0.883_883_476_483_184_5;

/// What [`middle_root`] starts from, interpolated at the Chebyshev points of `x^2`.
const MIDDLE_START: [f64; 4] =
    [0.666_388_474_343_566_1, 0.109_935_641_312_489_97, -0.020_020_179_625_308_707, 0.124_001_053_160_190_58];
