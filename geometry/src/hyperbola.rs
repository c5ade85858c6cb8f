//! Moments of the regions that a hyperbola `u + v + w u v = 1`, `w > -1`, cuts from the corner of a square.
//!
//! With `r = 1 + w` and `S_k = sum (-w)^n / (n + k)`:
//!
//! ```text
//! M00(w) = int int du dv             = S1 - S2                 = sum (-w)^n / ((n+1)(n+2))
//! M10(w) = int int u du dv           = S2 - S3                 = sum (-w)^n / ((n+2)(n+3))
//! M11(w) = int int u v du dv         = 3/2 (S3 - S4) - M10 / 2 = sum (n+1)(-w)^n / ((n+2)(n+3)(n+4))
//! N0(w)  = int du / (1 + w u)        = S1
//! ```
//!
//! The series converge for `|w| < 1` only, and the logarithms that replace them cancel near `w = 0`. Written
//! in `z = w / (2 + w)`, for which `ln(1 + w) = 2 atanh z`, all three come from one even function
//! `A(z) = (atanh z - z - z^3/3) / z^5 = sum z^(2n) / (2n + 5)` without any cancellation near `w = 0`:
//!
//! ```text
//! M00 = (1-z)/2  (1 + z (1+z) (1/3 + z^2 A))
//! M10 = (1-z)/8  (4/3 + 2 z^2 B)                B = 1/3 - (1 - z^2) A
//! M11 = (1-z)/48 (2 - 3 z B (3 - z))
//! N0  = (1-z)    (1 + z^2 (1/3 + z^2 A))
//! ```
//!
//! `A` is a minimax polynomial for `|z| <= 3/5`, that is `1 + w` in `[1/4, 4]`, a short one for `|z| <= 1/3`, and a
//! logarithm elsewhere: the logarithm cancels like `z^-4`, which at `|z| = 1/3` would cost two digits.

/// The moments of one corner region, see the module's text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// Integral of 1.
    pub m00: f64,
    /// Integral of `u`; by symmetry also that of `v`.
    pub m10: f64,
    /// Integral of `u v`.
    pub m11: f64,
    /// Integral of `1 / (1 + w u)` over `u` from 0 to 1, `ln(1 + w) / w`; that of `u / (1 + w u)` is `N0 - M00`.
    pub n0: f64,
}

/// Minimax polynomial of `A` in `z^2` on `[0, 1/9]`, largest error 4.2e-17.
const EVEN: [f64; 10] = [
    0.19999999999999996,
    0.14285714285721016,
    0.11111111109117215,
    0.09090909319474305,
    0.07692294425174682,
    0.06667107254240345,
    0.05873498029810359,
    0.053722128117075676,
    0.03965979456457848,
    0.07408878029125053,
];

/// End of the short polynomial in `z^2`.
const SHORT: f64 = 1.0 / 9.0;

/// Minimax polynomial of `A` in `z^2` on `[0, 9/25]`, largest error 4.4e-17.
const EVEN_WIDE: [f64; 16] = [
    0.19999999999999998,
    0.1428571428571849,
    0.11111111110142168,
    0.09090909179118646,
    0.07692303480978267,
    0.06666787996825219,
    0.058800650197201744,
    0.05292850539087048,
    0.0448831534171871,
    0.06169055929217375,
    -0.04811081645338914,
    0.3450716730103118,
    -0.7279060758175779,
    1.3108014334421398,
    -1.2953145019155592,
    0.7005326686130751,
];

/// End of the long polynomial in `z^2`.
const WIDE: f64 = 9.0 / 25.0;

/// `1 + w` outside this range is taken at its end: all moments have reached their limits to beyond rounding.
const RATIO_RANGE: [f64; 2] = [1e-300, 1e300];

/// Above this `w` the logarithm's own form of `M11` is used: the common one cancels like `w / ln w`.
const LARGE_W: f64 = 8.0;

/// The moments for `1 + w = numerator / denominator`, both not negative and not both zero, where `difference` is
/// `numerator - denominator`, which the caller has without cancellation.
pub fn moments(numerator: f64, denominator: f64, difference: f64) -> Moments {
    // Where the products of heights underflow the quotient may leave its range.
    let z = (difference / (numerator + denominator)).clamp(-1.0, 1.0);
    let mut argument = Argument::near(z);
    if Argument::is_far(z) {
        argument = Argument::far(z, [numerator, denominator]);
    }
    let minus = argument.minus;
    let Integrals { m00, m10, n0, .. } = argument.integrals();
    let w = (difference / denominator).min(RATIO_RANGE[1]);
    let m11 = if w > LARGE_W {
        let (v, ln) = (1.0 / w, logarithm(numerator, denominator));
        ((ln * (0.5 + v * (2.0 + 1.5 * v)) - 1.25 - 1.5 * v) * v) * v
    } else {
        let [m11, ..] = argument.second_moments();
        minus * m11
    };
    Moments { m00: minus * m00, m10: minus * m10, m11, n0: minus * n0 }
}

/// `z` with what the moments are made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Argument {
    pub(crate) z: f64,
    /// `1 - z` and `1 + z`, which cancel far from zero.
    pub(crate) minus: f64,
    pub(crate) plus: f64,
    /// `A(z)`.
    pub(crate) even: f64,
}

/// Moments, their differences and line integrals, all divided by `1 - z`:
///
/// ```text
/// M00 = 1/2 (1 + z (1+z) C)     E = M00 - M10 = 1/3 + z (1+z) C / 2 - z^2 B / 4      C = 1/3 + z^2 A
/// M10 = 1/4 (2/3 + z^2 B)       F = M10 - M11 = 1/8 + 3/16 z (1+z) B
/// N0  = 1 + z^2 C               N1 = N0 - M00 = 1/2 (1 - z (1-z) C)
/// ```
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integrals {
    pub(crate) m00: f64,
    pub(crate) m10: f64,
    pub(crate) e: f64,
    pub(crate) f: f64,
    pub(crate) n0: f64,
    pub(crate) n1: f64,
}

impl Argument {
    /// For `z` in `[-1, 1]`, unless it [is far](Self::is_far) from zero.
    #[inline(always)]
    pub(crate) fn near(z: f64) -> Self {
        Self { z, minus: 1.0 - z, plus: 1.0 + z, even: short_polynomial(z * z) }
    }

    /// Whether `z` is so far from zero that it takes [`Self::far`].
    #[inline(always)]
    pub(crate) fn is_far(z: f64) -> bool {
        z * z > SHORT
    }

    /// For `z` far from zero, whose digits do not tell `1 - z` and `1 + z`, with the numerator and the denominator of `1 + w`.
    #[cold]
    #[inline(never)]
    pub(crate) fn far(z: f64, [numerator, denominator]: [f64; 2]) -> Self {
        let z2 = z * z;
        if z2 <= WIDE {
            return Self { even: EVEN_WIDE.iter().rev().fold(0.0, |sum, c| sum * z2 + c), ..Self::near(z) };
        }
        let inverse = 1.0 / z2;
        let sum = numerator + denominator;
        Self {
            z,
            minus: 2.0 * denominator / sum,
            plus: 2.0 * numerator / sum,
            even: ((0.5 * logarithm(numerator, denominator) / z - 1.0) * inverse - 1.0 / 3.0) * inverse,
        }
    }

    /// `M11`, `M20` and `M21`, divided by `1 - z`; see [`crate::second_moments`]. `M11` far from zero cancels against the larger ones.
    #[inline(always)]
    pub(crate) fn second_moments(self) -> [f64; 3] {
        let Self { z, minus, plus, even } = self;
        let b = 1.0 / 3.0 - minus * plus * even;
        let three = 3.0 * z * b;
        [(1.0 / 48.0) * (2.0 - three * (3.0 - z)), (1.0 / 24.0) * (2.0 - three * minus), 0.125 * minus * b]
    }

    #[inline(always)]
    pub(crate) fn integrals(self) -> Integrals {
        let Self { z, minus, plus, even } = self;
        let z2 = z * z;
        let b = 1.0 / 3.0 - minus * plus * even;
        let c = 1.0 / 3.0 + z2 * even;
        let y = z * plus;
        let (y_b, y_c, z2_b) = (y * b, y * c, z2 * b);
        Integrals {
            m00: 0.5 + 0.5 * y_c,
            m10: 1.0 / 6.0 + 0.25 * z2_b,
            e: 1.0 / 3.0 + (0.5 * y_c - 0.25 * z2_b),
            f: 0.125 + 0.1875 * y_b,
            n0: 1.0 + z2 * c,
            n1: 0.5 - 0.5 * (z * minus) * c,
        }
    }
}

fn logarithm(numerator: f64, denominator: f64) -> f64 {
    (numerator / denominator).clamp(RATIO_RANGE[0], RATIO_RANGE[1]).ln()
}

/// The polynomial with the terms [`EVEN`], in pairs (Estrin), which shortens the chain of operations that wait for each other.
#[inline(always)]
fn short_polynomial(x: f64) -> f64 {
    let pair = |i: usize| EVEN[i] + EVEN[i + 1] * x;
    let x2 = x * x;
    let x4 = x2 * x2;
    (pair(0) + pair(2) * x2) + x4 * ((pair(4) + pair(6) * x2) + pair(8) * x4)
}
