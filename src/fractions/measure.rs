//! What is integrated over the part of a cell inside a region: its volume alone, or with its first moment.
//!
//! Along a line of constant `v` a point is `x = x0 + x1 w` and the Jacobian determinant `q0 + q1 w + q2 w^2`, so that both integrals
//! are polynomials in `w`:
//!
//! ```text
//! U0(w) = int q     = w   (q0     + w (q1 / 2 + w q2 / 3))
//! U1(w) = int w q   = w^2 (q0 / 2 + w (q1 / 3 + w q2 / 4))
//! int x q           = x0 U0 + x1 U1
//! ```
//!
//! The first moment is that about the anchor of a brick's coordinates. A caller that wants volumes alone pays for nothing else: the
//! quadrature is compiled once for each.

use std::iter::Sum;
use std::ops::{Add, Mul, Sub};

use vofkit_geometry::Vector;
use vofkit_geometry::clip::{self, Region};

use super::brick::{Brick, CORNERS, Weight, coefficients, patch, weight};
use super::quadrature::{Amount, tail};

/// An integral over a part of a cell.
pub(super) trait Measure<const D: usize>: Amount + Sub<Output = Self> + Sum {
    /// What is the same for all lines of a patch of constant `u`.
    type Patch;

    /// The patch of constant `u` of a brick with coefficients `x`; coordinates count in units of `length`.
    fn patch(x: &[Vector<D>; CORNERS], u: f64, length: f64) -> Self::Patch;

    /// The integral along the line at `v` from 0 to `w`.
    fn along(patch: &Self::Patch, v: f64) -> impl Fn(f64) -> Self;

    /// The same integral with coordinates in units of 1.
    fn of_length(self, length: f64) -> Self;

    /// That of a whole brick.
    fn of_brick(brick: &Brick<D>) -> Self;

    /// That of a whole piece.
    fn of_piece(piece: &impl Region<D>) -> Self;

    /// That of a piece with these moments.
    fn of_moments(moments: &clip::Moments<D>) -> Self;
}

impl<const D: usize> Measure<D> for f64 {
    type Patch = Weight;

    fn patch(x: &[Vector<D>; CORNERS], u: f64, _: f64) -> Weight {
        weight(x, u)
    }

    fn along(weight: &Weight, v: f64) -> impl Fn(f64) -> f64 {
        let q = determinant(weight, v);
        move |w| w * (q[0] + w * (q[1] / 2.0 + w * (q[2] / 3.0)))
    }

    fn of_length(self, _: f64) -> f64 {
        self
    }

    fn of_brick(brick: &Brick<D>) -> f64 {
        brick.volume()
    }

    fn of_piece(piece: &impl Region<D>) -> f64 {
        piece.volume()
    }

    fn of_moments(moments: &clip::Moments<D>) -> f64 {
        moments.volume
    }
}

/// A volume with its first moment about the anchor of the coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moments<const D: usize> {
    pub(super) volume: f64,
    /// The integral of position.
    pub(super) first: Vector<D>,
}

impl<const D: usize> Measure<D> for Moments<D> {
    type Patch = (Weight, [Vector<D>; 4]);

    fn patch(x: &[Vector<D>; CORNERS], u: f64, length: f64) -> Self::Patch {
        (weight(x, u), patch(x, u).map(|k| k / length))
    }

    fn along((weight, k): &Self::Patch, v: f64) -> impl Fn(f64) -> Self {
        let q = determinant(weight, v);
        let (start, slope) = (k[0] + k[2] * v, k[1] + k[3] * v);
        move |w| {
            let volume = w * (q[0] + w * (q[1] / 2.0 + w * (q[2] / 3.0)));
            let lever = w * w * (q[0] / 2.0 + w * (q[1] / 3.0 + w * (q[2] / 4.0)));
            Self { volume, first: start * volume + slope * lever }
        }
    }

    fn of_length(self, length: f64) -> Self {
        Self { first: self.first * length, ..self }
    }

    fn of_brick(brick: &Brick<D>) -> Self {
        let x = coefficients(&brick.corners, [1, 0, 2]);
        let section = |u: f64| {
            let (weight, k) = <Self as Measure<D>>::patch(&x, u, 1.0);
            let integral = |dv: usize, dw: usize| {
                let term = |n: usize| weight[n / 3][n % 3] / ((n / 3 + 1 + dv) * (n % 3 + 1 + dw)) as f64;
                (0..9).map(term).sum::<f64>()
            };
            let volume = integral(0, 0);
            let first = k[0] * volume + k[1] * integral(0, 1) + k[2] * integral(1, 0) + k[3] * integral(1, 1);
            Self { volume, first }
        };
        // The determinant times a coordinate is cubic: Simpson's rule is exact.
        if D == 2 { section(0.0) } else { (section(0.0) + section(0.5) * 4.0 + section(1.0)) * (1.0 / 6.0) }
    }

    fn of_piece(piece: &impl Region<D>) -> Self {
        Self::of_moments(&piece.moments())
    }

    fn of_moments(moments: &clip::Moments<D>) -> Self {
        Self { volume: moments.volume, first: moments.first }
    }
}

/// The coefficients of the Jacobian determinant as a polynomial in `w` on the line at `v`.
fn determinant(weight: &Weight, v: f64) -> [f64; 3] {
    std::array::from_fn(|j| weight[0][j] + v * (weight[1][j] + v * weight[2][j]))
}

impl<const D: usize> Default for Moments<D> {
    fn default() -> Self {
        Self { volume: 0.0, first: Vector::zeros() }
    }
}

impl<const D: usize> Amount for Moments<D> {
    fn tail(last: [Self; 2], middle: [Self; 2]) -> f64 {
        let of_axis = |k: usize| tail(last.map(|m| m.first[k]), middle.map(|m| m.first[k]));
        let volume = tail(last.map(|m| m.volume), middle.map(|m| m.volume));
        (0..D).map(of_axis).fold(volume, f64::max)
    }
}

impl<const D: usize> Add for Moments<D> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { volume: self.volume + other.volume, first: self.first + other.first }
    }
}

impl<const D: usize> Sub for Moments<D> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { volume: self.volume - other.volume, first: self.first - other.first }
    }
}

impl<const D: usize> Mul<f64> for Moments<D> {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { volume: self.volume * factor, first: self.first * factor }
    }
}

impl<const D: usize> Sum for Moments<D> {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), Add::add)
    }
}
