//! Limiters of the slope in a cell (Eq. 66-72).

/// How the slope of a quantity in a cell is limited.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Limiter {
    /// The steepest of all (Eq. 68).
    Superbee,
    /// The smaller one of the two differences (Eq. 69).
    MinMod,
    /// The mean of the two differences, at most twice the smaller one (Eq. 70).
    Woodward,
    /// The harmonic mean of the two differences (van Leer 1974).
    #[default]
    VanLeer,
    /// MinMod times a constant from 0 to 2.
    ScaledMinMod {
        /// The constant `alpha`.
        alpha: f64,
    },
    /// MinMod times `alpha(Cr)` of Eq. 71 (Eq. 72).
    CourantMinMod,
    /// Not at all: the mean of the two differences, which is not monotone.
    Off,
}

/// A factor `alpha` that is not from 0 to 2. That on MinMod would let face values leave the interval of the two cell means, and that of the
/// smoothing of the direct scheme would turn the shortest wave over and let it grow.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("alpha is {alpha}, not from 0 to 2")]
pub struct AlphaRange {
    /// The factor.
    pub alpha: f64,
}

impl AlphaRange {
    /// Whether a factor is in the range.
    ///
    /// # Errors
    /// A factor that is not.
    pub fn check(alpha: f64) -> Result<(), Self> {
        if (0.0..=2.0).contains(&alpha) { Ok(()) } else { Err(Self { alpha }) }
    }
}

/// The factor `alpha` on MinMod for a Courant number: 2 up to 1/2, then `5.75 Cr^2 - 12.6 Cr + 6.9` (Eq. 71).
///
/// Above `Cr = 1/2` the paper's fit jumps to 2.0375 first; it is limited to `[0, 2]`, beyond which no slope is monotone.
pub fn courant_alpha(courant: f64) -> f64 {
    if courant <= 0.5 { 2.0 } else { ((5.75 * courant - 12.6) * courant + 6.9).clamp(0.0, 2.0) }
}

impl Limiter {
    /// Whether the limiter can be used.
    ///
    /// # Errors
    /// A constant factor on MinMod that is not from 0 to 2.
    pub fn check(&self) -> Result<(), AlphaRange> {
        match *self {
            Self::ScaledMinMod { alpha } => AlphaRange::check(alpha),
            _ => Ok(()),
        }
    }

    /// The limiter `L(theta)` by its definition: the slope relative to the difference to the cell above, for the ratio `theta` of the
    /// difference to the cell below to it. For [`Limiter::CourantMinMod`] that of MinMod, whose factor belongs to the face.
    pub fn value(&self, theta: f64) -> f64 {
        match *self {
            Self::Superbee => theta.min(2.0).max((2.0 * theta).min(1.0)).max(0.0),
            Self::MinMod | Self::CourantMinMod => theta.clamp(0.0, 1.0),
            Self::Woodward => 2.0_f64.min(2.0 * theta).min(0.5 * (1.0 + theta)).max(0.0),
            Self::VanLeer => (theta + theta.abs()) / (1.0 + theta.abs()),
            Self::ScaledMinMod { alpha } => alpha * theta.clamp(0.0, 1.0),
            Self::Off => 0.5 * (1.0 + theta),
        }
    }
}

/// The smaller magnitude of two numbers of the same sign, else 0.
#[inline(always)]
pub(super) fn min_mod(a: f64, b: f64) -> f64 {
    signed(a, b, smaller(a.abs(), b.abs()))
}

#[inline(always)]
pub(super) fn superbee(a: f64, b: f64) -> f64 {
    let (p, q) = (a.abs(), b.abs());
    signed(a, b, larger(smaller(p, 2.0 * q), smaller(q, 2.0 * p)))
}

#[inline(always)]
pub(super) fn woodward(a: f64, b: f64) -> f64 {
    let (p, q) = (a.abs(), b.abs());
    signed(a, b, smaller(2.0 * smaller(p, q), 0.5 * (p + q)))
}

#[inline(always)]
pub(super) fn van_leer(a: f64, b: f64) -> f64 {
    let (p, q) = (a.abs(), b.abs());
    // Not 2 a b / (a + b), whose product may underflow. Where both are zero the smallest number keeps the quotient finite.
    let (small, large) = (smaller(p, q), larger(larger(p, q), f64::MIN_POSITIVE));
    signed(a, b, 2.0 * small / (1.0 + small / large))
}

/// `magnitude` with the common sign of `a` and `b`; 0 where they have none.
#[inline(always)]
fn signed(a: f64, b: f64, magnitude: f64) -> f64 {
    if (a > 0.0) == (b > 0.0) { magnitude.copysign(a) } else { 0.0 }
}

/// The smaller number. Unlike [`f64::min`] it says nothing about NaN, which is one instruction.
#[inline(always)]
pub(super) fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger number, likewise.
#[inline(always)]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
