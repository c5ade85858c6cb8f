//! Plane constants from one place to another, where `d - n.x` cancels: compensated arithmetic.

use vofkit_geometry::Vector;

type Vector3 = Vector<3>;

/// `a.b + c`, as if computed with twice the digits and rounded once (Ogita, Rump & Oishi 2005, Dot2).
pub(super) fn dot_plus(a: &Vector3, b: &Vector3, c: f64) -> f64 {
    let (mut sum, mut lost) = (c, 0.0);
    for axis in 0..3 {
        let product = a[axis] * b[axis];
        lost += a[axis].mul_add(b[axis], -product);
        let [next, rest] = two_sum(sum, product);
        sum = next;
        lost += rest;
    }
    // Overflow alone makes this fail, and the plain sum says so.
    if lost.is_finite() { sum + lost } else { sum }
}

/// What plain arithmetic may make of [`dot_plus`].
pub(super) fn rounding(a: &Vector3, b: &Vector3, c: f64) -> f64 {
    8.0 * f64::EPSILON * (a.component_mul(b).abs().sum() + c.abs())
}

/// `a + b` rounded, and the rest (Knuth).
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let part = sum - a;
    [sum, (a - (sum - part)) + (b - part)]
}
