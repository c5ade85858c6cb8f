//! Sums and products that keep what rounding takes from them: about 32 digits for the few places that need more than 16.
//!
//! There are two. `n.x - d` cancels on cells far from the origin, and what a rotated sliver or needle is like in its own
//! frame hides in the last digits of its coordinates: plain arithmetic loses there a factor of the longest extent over
//! the shortest. Error-free transformations (Knuth's TwoSum, Dekker's TwoProduct; Ogita, Rump & Oishi 2005) find both
//! without a wider type. A number is then a value and a *rest* of the order of its rounding, and the terms of the order of
//! a rest squared are left out. Where coordinates overflow, the rests are not finite, and the plain values are all there is.

use std::ops::{Add, Mul, Sub};

use crate::Vector;

/// `a + b` rounded, and the rest (Knuth's TwoSum).
#[inline(always)]
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let part = sum - a;
    [sum, (a - (sum - part)) + (b - part)]
}

/// `a b` rounded, and the rest: with a fused product where the target has one in hardware, else with Veltkamp's and
/// Dekker's halves, which give the same bits.
#[inline(always)]
fn two_product(a: f64, b: f64) -> [f64; 2] {
    let product = a * b;
    if cfg!(target_feature = "fma") {
        return [product, a.mul_add(b, -product)];
    }
    let halves = |x: f64| {
        let scaled = 134_217_729.0 * x;
        let high = scaled - (scaled - x);
        [high, x - high]
    };
    let ([a1, a2], [b1, b2]) = (halves(a), halves(b));
    [product, a2 * b2 - (((product - a1 * b1) - a2 * b1) - a1 * b2)]
}

/// `a . b` and its rest (Dot2).
#[inline(always)]
pub(crate) fn dot<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> [f64; 2] {
    let [mut sum, mut lost] = two_product(a[0], b[0]);
    for i in 1..D {
        let [product, rest] = two_product(a[i], b[i]);
        let [next, carried] = two_sum(sum, product);
        sum = next;
        lost += rest + carried;
    }
    [sum, if lost.is_finite() { lost } else { 0.0 }]
}

/// `d - a` for a number with its rest.
#[inline(always)]
pub(crate) fn difference(d: f64, [value, lost]: [f64; 2]) -> f64 {
    let [difference, rest] = two_sum(d, -value);
    difference + (if rest.is_finite() { rest } else { 0.0 } - lost)
}

/// A vector and its rest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<const D: usize> {
    pub(crate) value: Vector<D>,
    pub(crate) rest: Vector<D>,
}

impl<const D: usize> Pair<D> {
    /// `a - b`, without error.
    pub(crate) fn difference(a: &Vector<D>, b: &Vector<D>) -> Self {
        let zero = Vector::zeros();
        Self { value: *a, rest: zero } - Self { value: *b, rest: zero }
    }

    /// The scalar product, rounded.
    pub(crate) fn dot(&self, other: &Self) -> f64 {
        let [value, lost] = dot(&self.value, &other.value);
        value + (lost + (self.value.dot(&other.rest) + self.rest.dot(&other.value)))
    }

    /// `a_i b_j - a_j b_i` and its rest.
    fn minor(&self, other: &Self, i: usize, j: usize) -> [f64; 2] {
        let ([p, p_rest], [q, q_rest]) =
            (two_product(self.value[i], other.value[j]), two_product(self.value[j], other.value[i]));
        let [value, carried] = two_sum(p, -q);
        let with_i = self.value[i] * other.rest[j] - self.rest[j] * other.value[i];
        let with_j = self.rest[i] * other.value[j] - self.value[j] * other.rest[i];
        [value, carried + ((p_rest - q_rest) + (with_i + with_j))]
    }
}

impl Pair<2> {
    /// The cross product, rounded.
    pub(crate) fn perp(&self, other: &Self) -> f64 {
        self.minor(other, 0, 1).iter().sum()
    }
}

impl Pair<3> {
    /// The cross product.
    pub(crate) fn cross(&self, other: &Self) -> Self {
        let [x, y, z] = [[1, 2], [2, 0], [0, 1]].map(|[i, j]| self.minor(other, i, j));
        Self { value: Vector::<3>::new(x[0], y[0], z[0]), rest: Vector::<3>::new(x[1], y[1], z[1]) }
    }
}

impl<const D: usize> Add for Pair<D> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let value = self.value + other.value;
        let part = value - self.value;
        let carried = (self.value - (value - part)) + (other.value - part);
        Self { value, rest: carried + (self.rest + other.rest) }
    }
}

impl<const D: usize> Sub for Pair<D> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + Self { value: -other.value, rest: -other.rest }
    }
}

/// By a power of two, without error.
impl<const D: usize> Mul<f64> for Pair<D> {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { value: self.value * factor, rest: self.rest * factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost() {
        let (a, b) = (1.0 + f64::EPSILON, 1.0 - f64::EPSILON);
        assert_eq!(two_product(a, b), [1.0, -f64::EPSILON * f64::EPSILON]);
        assert_eq!(two_sum(1e17, 1.25), [1e17, 1.25]);
        let far = Vector::<3>::new(1e16, 1.0, -1e16);
        assert_eq!(dot(&far, &Vector::<3>::repeat(1.0)).iter().sum::<f64>(), 1.0);
        assert_eq!(difference(1e16, [1e16, 0.5]), -0.5);
    }

    #[test]
    fn products_without_hardware_are_the_same() {
        for i in 1..1000 {
            let (a, b) = ((f64::from(i) * 0.7).sin(), (f64::from(i) * 0.3).exp());
            assert_eq!(two_product(a, b), [a * b, a.mul_add(b, -(a * b))]);
        }
    }

    /// The volume of a parallelepiped whose edges are nearly the same.
    #[test]
    fn determinants_of_almost_parallel_edges() {
        let shift = 2.0_f64.powi(-30) + 2.0_f64.powi(-60);
        let [a, b, c] = [0, 1, 2].map(|axis| {
            let from = Vector::<3>::from_fn(|i, _| if i == axis { -shift } else { 0.0 });
            Pair::difference(&Vector::<3>::repeat(1.0), &from)
        });
        // The determinant of h I + (the matrix of ones).
        let exact = shift * shift * (3.0 + shift);
        let found = a.dot(&b.cross(&c));
        assert!((found - exact).abs() <= 1e-13 * exact, "{found:e} {exact:e}");
    }
}
