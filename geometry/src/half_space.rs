//! The half-space `{x : n.x <= d}` that holds the material.

use crate::Vector;
use crate::tolerance::DIRECTION_NEGLIGIBLE;

/// The half-space `{x : n.x <= d}`; the normal points out of it (Eq. 80 and 91 of the paper).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace<const D: usize> {
    /// The outward normal `n`. Unit length where a section area or a distance is wanted.
    pub normal: Vector<D>,
    /// The plane constant `d`, in the unit of length times that of the normal.
    pub constant: f64,
}

impl<const D: usize> HalfSpace<D> {
    /// The height `n.x - d` of a point over the plane: negative or zero inside.
    pub fn height(&self, point: &Vector<D>) -> f64 {
        self.normal.dot(point) - self.constant
    }

    /// The other side of the same plane.
    pub fn complement(&self) -> Self {
        Self { normal: -self.normal, constant: -self.constant }
    }

    /// The half-space moved by `shift`.
    pub fn translated(&self, shift: &Vector<D>) -> Self {
        Self { normal: self.normal, constant: self.constant + self.normal.dot(shift) }
    }
}

/// `a . b` as an unevaluated sum of a rounded value and what rounding took from it (Ogita, Rump & Oishi 2005, Dot2).
///
/// Cells far from the origin of the coordinates need it: `n.x - d` cancels there, and plain arithmetic would leave
/// an error of rounding times the distance instead of rounding times the cell's size.
pub(crate) fn compensated_dot<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> [f64; 2] {
    let (mut sum, mut lost) = (0.0, 0.0);
    for i in 0..D {
        let product = a[i] * b[i];
        lost += a[i].mul_add(b[i], -product);
        let [next, rest] = compensated_sum(sum, product);
        sum = next;
        lost += rest;
    }
    // Only overflow makes this fail, and the plain value is then all there is.
    [sum, if lost.is_finite() { lost } else { 0.0 }]
}

/// `n.x - d` for the plane constant `d`, where `n.(x - x0) = offset` and `n.x0` is given by [`compensated_dot`].
pub(crate) fn compensated_height([sum, lost]: [f64; 2], offset: f64, constant: f64) -> f64 {
    let [difference, rest] = compensated_sum(sum, -constant);
    let small = lost + if rest.is_finite() { rest } else { 0.0 };
    difference + (small + offset)
}

/// `a + b` rounded, and the rest (Knuth's TwoSum).
fn compensated_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let part = sum - a;
    [sum, (a - (sum - part)) + (b - part)]
}

/// The largest component of `m`, and `m` relative to it: products of plain components, or of heights, could over- or
/// underflow.
pub(crate) fn largest_and_direction<const D: usize>(m: &Vector<D>) -> (f64, Vector<D>) {
    let largest = m.amax();
    let size = if largest > 0.0 { largest } else { 1.0 };
    (size, (m / size).map(|c| if c.abs() < DIRECTION_NEGLIGIBLE { 0.0 } else { c }))
}
