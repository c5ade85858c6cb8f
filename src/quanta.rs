//! Volumes rounded to multiples of one power of two, so that sums of them are exact in any order.

use crate::tolerance::FLUX_BITS;

/// The power of two of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quanta {
    /// Adding and subtracting this rounds to whole quanta.
    rounder: f64,
}

impl Quanta {
    /// The quanta for volumes of this size, without sign.
    pub(crate) fn new(largest: f64) -> Self {
        let exponent = largest.max(f64::MIN_POSITIVE).log2().ceil() as i32;
        // 1.5 * 2^52 quanta: the sum with a number below 2^51 quanta is rounded to whole quanta.
        Self { rounder: 1.5 * 2.0_f64.powi(52 + exponent - FLUX_BITS) }
    }

    /// The nearest number of whole quanta.
    pub(crate) fn round(self, volume: f64) -> f64 {
        (volume + self.rounder) - self.rounder
    }

    /// The larger of two.
    pub(crate) fn coarser(self, other: Self) -> Self {
        if self.rounder >= other.rounder { self } else { other }
    }
}
