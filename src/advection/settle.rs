//! From contents to fractions, with an account of every correction.

use super::ledger::{LargestCorrection, Ledger};
use crate::tolerance::FRACTION_ROUNDING;

/// Writes the fractions of a cell that holds these volumes of the materials: into `[0, 1]`, and their sum to at most 1. Where no
/// region folds over, only rounding is corrected.
pub(super) fn settle(
    cell: usize,
    volume: f64,
    held: &[f64],
    fractions: &mut [Vec<f64>],
    ledger: &mut Ledger,
) {
    for (k, f) in fractions.iter_mut().enumerate() {
        let raw = held[k] / volume;
        let fraction = rounded(raw);
        let account = &mut ledger.materials[k];
        account.smallest = account.smallest.min(raw);
        account.largest = account.largest.max(raw);
        account.clipped += (fraction - raw).abs() * volume;
        f[cell] = fraction;
        ledger.largest_correction.note(LargestCorrection { fraction: (fraction - raw).abs(), cell });
    }
    let sum: f64 = fractions.iter().map(|f| f[cell]).sum();
    if sum > 1.0 + FRACTION_ROUNDING {
        for (k, f) in fractions.iter_mut().enumerate() {
            let excess = f[cell] * (1.0 - 1.0 / sum);
            f[cell] -= excess;
            ledger.materials[k].rescaled += excess * volume;
            ledger.largest_correction.note(LargestCorrection { fraction: excess, cell });
        }
    }
}

/// A fraction that is within `[0, 1]`, and exactly 0 or 1 where it is so but for rounding.
fn rounded(raw: f64) -> f64 {
    if raw <= FRACTION_ROUNDING {
        0.0
    } else if raw >= 1.0 - FRACTION_ROUNDING {
        1.0
    } else {
        raw
    }
}
