//! Moments of the regions that a hyperbola `u + v + w u v = 1`, `w > -1`, cuts from the corner of a square.
//!
//! With `r = 1 + w` and `S_k = sum (-w)^n / (n + k)`:
//!
//! ```text
//! M00(w) = int int du dv             = S1 - S2                 = sum (-w)^n / ((n+1)(n+2))
//! M10(w) = int int u du dv           = S2 - S3                 = sum (-w)^n / ((n+2)(n+3))
//! M11(w) = int int u v du dv         = 3/2 (S3 - S4) - M10 / 2 = sum (n+1)(-w)^n / ((n+2)(n+3)(n+4))
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
    let sum = numerator + denominator;
    // Where the products of heights underflow the quotient may leave its range.
    let z = (difference / sum).clamp(-1.0, 1.0);
    let z2 = z * z;
    if z2 <= SHORT {
        return from_even_part(z, 1.0 - z, 1.0 + z, short_polynomial(z2));
    }
    if z2 <= WIDE {
        let a = EVEN_WIDE.iter().rev().fold(0.0, |sum, c| sum * z2 + c);
        return from_even_part(z, 1.0 - z, 1.0 + z, a);
    }
    let ratio = (numerator / denominator).clamp(RATIO_RANGE[0], RATIO_RANGE[1]);
    let ln = ratio.ln();
    let w = difference / denominator;
    if w > LARGE_W {
        let w = w.min(RATIO_RANGE[1]);
        let v = 1.0 / w;
        let m00 = ((1.0 + v) * ln - 1.0) * v;
        let m10 = (0.5 - m00) * v;
        let m11 = ((ln * (0.5 + v * (2.0 + 1.5 * v)) - 1.25 - 1.5 * v) * v) * v;
        return Moments { m00, m10, m11 };
    }
    let inverse = 1.0 / z2;
    let a = ((0.5 * ln / z - 1.0) * inverse - 1.0 / 3.0) * inverse;
    // Here 1 - z and 1 + z may cancel.
    from_even_part(z, 2.0 * denominator / sum, 2.0 * numerator / sum, a)
}

/// The polynomial with the terms [`EVEN`], in pairs (Estrin), which shortens the chain of operations that wait for each other.
fn short_polynomial(x: f64) -> f64 {
    let pair = |i: usize| EVEN[i] + EVEN[i + 1] * x;
    let x2 = x * x;
    let x4 = x2 * x2;
    (pair(0) + pair(2) * x2) + x4 * ((pair(4) + pair(6) * x2) + pair(8) * x4)
}

fn from_even_part(z: f64, one_minus_z: f64, one_plus_z: f64, a: f64) -> Moments {
    let z2 = z * z;
    let b = 1.0 / 3.0 - one_minus_z * one_plus_z * a;
    Moments {
        m00: 0.5 * one_minus_z * (1.0 + z * one_plus_z * (1.0 / 3.0 + z2 * a)),
        m10: 0.25 * one_minus_z * (2.0 / 3.0 + z2 * b),
        m11: one_minus_z / 48.0 * (2.0 - 3.0 * z * b * (3.0 - z)),
    }
}
