//! Second moments of the regions of [`crate::hyperbola`], which the first moment of a truncated cell needs.
//!
//! On the region `u + v + w u v <= 1`, `w > -1`, of the corner of a square, with `v = (1-u)/(1+w u)` on its edge:
//!
//! ```text
//! M20(w) = int int u^2 du dv     =     int u^2 v   du
//! M21(w) = int int u^2 v du dv   = 1/2 int u^2 v^2 du
//! M22(w) = int int u^2 v^2 du dv = 1/3 int u^2 v^3 du
//! ```
//!
//! In `z = w / (2 + w)`, as for the lower moments, all three are polynomials in `z` and one even function,
//! `C(z) = (atanh z - z - z^3/3 - z^5/5) / z^7 = sum z^(2n) / (2n + 7)`, without any cancellation near `w = 0`:
//!
//! ```text
//! A = 1/5 + z^2 C,   B = 1/3 - (1 - z^2) A
//! M20 = (1-z)/24    (2 - 3 z (1-z) B)
//! M21 = (1-z)^2/8   B
//! M22 = (1-z)^3/720 (4 - 9 z - 3 z^2 + 15 z (1+z) (5 - 2 z - z^2) C)
//! ```
//!
//! `C` is a minimax polynomial for `|z| <= 3/5`, that is `1 + w` in `[1/4, 4]`, and a logarithm elsewhere. The
//! logarithm cancels like `z^-6`, but `M22` is so small a part of a moment of the region that a digit of it is not
//! missed.

/// The second moments of one corner region, see the module's text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondMoments {
    /// Integral of `u^2`; by symmetry also that of `v^2`.
    pub m20: f64,
    /// Integral of `u^2 v`; by symmetry also that of `u v^2`.
    pub m21: f64,
    /// Integral of `u^2 v^2`.
    pub m22: f64,
}

/// Minimax polynomial of `C` in `z^2` on `[0, 9/25]`, largest error 4.9e-17.
const EVEN: [f64; 16] = [
    0.14285714285714282,
    0.11111111111114406,
    0.0909090909013361,
    0.07692307764237412,
    0.0666666317405409,
    0.05882455121271494,
    0.05261203900675059,
    0.047875915208711026,
    0.04108331604847209,
    0.056117915055171004,
    -0.04173663281374392,
    0.3124937959187874,
    -0.6619562647948115,
    1.2043215276560197,
    -1.1984955553407917,
    0.6540389340690381,
];

/// End of the polynomial in `z^2`.
const WIDE: f64 = 9.0 / 25.0;

/// `1 + w` outside this range is taken at its end: all moments have reached their limits to beyond rounding.
const RATIO_RANGE: [f64; 2] = [1e-300, 1e300];

/// The second moments for `1 + w = numerator / denominator`, both not negative and not both zero, where `difference`
/// is `numerator - denominator`, which the caller has without cancellation.
pub fn second_moments(numerator: f64, denominator: f64, difference: f64) -> SecondMoments {
    let sum = numerator + denominator;
    // Beyond its range only where products of subnormal heights have underflowed.
    let z = (difference / sum).clamp(-1.0, 1.0);
    let one_minus_z = 2.0 * denominator / sum;
    let one_plus_z = 2.0 * numerator / sum;
    let z2 = z * z;
    let c = if z2 <= WIDE {
        EVEN.iter().rev().fold(0.0, |sum, c| sum * z2 + c)
    } else {
        let ratio = (numerator / denominator).clamp(RATIO_RANGE[0], RATIO_RANGE[1]);
        let inverse = 1.0 / z2;
        (((0.5 * ratio.ln() / z - 1.0) * inverse - 1.0 / 3.0) * inverse - 0.2) * inverse
    };
    let b = 1.0 / 3.0 - one_minus_z * one_plus_z * (0.2 + z2 * c);
    let cubic = 4.0 - z * (9.0 + 3.0 * z) + 15.0 * z * one_plus_z * (5.0 - z * (2.0 + z)) * c;
    SecondMoments {
        m20: one_minus_z / 24.0 * (2.0 - 3.0 * z * one_minus_z * b),
        m21: one_minus_z * one_minus_z / 8.0 * b,
        m22: one_minus_z * one_minus_z * one_minus_z / 720.0 * cubic,
    }
}
