//! What a sweep did to the cells of the band, and the corrections that keep fractions within bounds.

use super::Content;
use crate::advection::ledger::{LargestCorrection, Ledger, MaterialLedger};
use crate::advection::transport::StepError;
use crate::tolerance::FRACTION_ROUNDING;

/// What a block of the band did in a sweep.
#[derive(Clone, Debug, Default)]
pub(super) struct Account {
    pub(super) crossed: usize,
    pub(super) cut: usize,
    pub(super) error: Option<StepError>,
    pub(super) materials: Vec<MaterialLedger>,
    pub(super) largest: LargestCorrection,
}

impl Account {
    pub(super) fn new(materials: usize) -> Self {
        Self { materials: vec![MaterialLedger::default(); materials], ..Self::default() }
    }

    /// Empties the account, and keeps its memory.
    pub(super) fn reset(&mut self) {
        let mut materials = std::mem::take(&mut self.materials);
        materials.fill(MaterialLedger::default());
        *self = Self { materials, ..Self::default() };
    }

    pub(super) fn enter(&self, ledger: &mut Ledger) {
        ledger.faces_crossed += self.crossed;
        ledger.faces_cut += self.cut;
        for (total, part) in ledger.materials.iter_mut().zip(&self.materials) {
            total.add(part);
        }
        ledger.largest_correction.note(self.largest);
    }
}

/// The new fractions in a cell of this tracked volume, with the corrections of Sect. 5.2.3: into `[0, 1]`, and their sum to
/// at most 1.
///
/// A cell that exchanged nothing but what it is full of keeps its fractions to the bit.
pub(super) fn correct(volume: f64, contents: &mut [Content], cell: usize, account: &mut Account) {
    if volume <= 0.0 {
        // Overdrawn: there are no fractions until volume comes in.
        return;
    }
    let mut sum = 0.0;
    for (content, ledger) in contents.iter_mut().zip(&mut account.materials) {
        let raw = content.initial + content.excess / volume;
        ledger.smallest = ledger.smallest.min(raw);
        ledger.largest = ledger.largest.max(raw);
        content.fraction = if raw <= FRACTION_ROUNDING {
            0.0
        } else if raw >= 1.0 - FRACTION_ROUNDING {
            1.0
        } else {
            raw
        };
        sum += content.fraction;
        if content.fraction != raw {
            content.excess = (content.fraction - content.initial) * volume;
            ledger.clipped += (content.fraction - raw).abs() * volume;
            account.largest.note(LargestCorrection { fraction: (content.fraction - raw).abs(), cell });
        }
    }
    if sum > 1.0 + FRACTION_ROUNDING {
        for (content, ledger) in contents.iter_mut().zip(&mut account.materials) {
            let scaled = content.fraction / sum;
            ledger.rescaled += (content.fraction - scaled) * volume;
            account.largest.note(LargestCorrection { fraction: content.fraction - scaled, cell });
            content.fraction = scaled;
            content.excess = (scaled - content.initial) * volume;
        }
    }
}
