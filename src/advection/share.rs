//! How several materials, each cut by a plane of its own, leave a cell together.

use super::stage::Outward;
use crate::tolerance::FRACTION_ROUNDING;

/// Fits the amounts of several materials, each cut by a plane of its own, to what the cell holds: `given[face][material]`
/// then adds up to no more than the flux of a face, and the void that leaves is no more than there is. What a material
/// may not give now stays in the cell, so that no volume is lost.
pub(super) fn share(
    outward: &Outward,
    tracked: f64,
    held: impl Fn(usize) -> f64,
    materials: usize,
    given: &mut [f64],
) {
    let mut void = [0.0; 6];
    for (face, amounts) in given.chunks_mut(materials).enumerate() {
        let flux = outward[face].max(0.0);
        let sum: f64 = amounts.iter().sum();
        if sum > flux {
            amounts.iter_mut().for_each(|amount| *amount *= flux / sum);
        } else {
            void[face] = flux - sum;
        }
    }
    let left = |given: &[f64], k: usize| {
        (held(k) - given.chunks(materials).map(|face| face[k]).sum::<f64>()).max(0.0)
    };
    let [void_out, held_in_all, left_in_all] = [
        void.iter().sum::<f64>(),
        (0..materials).map(&held).sum(),
        (0..materials).map(|k| left(given, k)).sum(),
    ];
    let excess = (void_out - (tracked - held_in_all).max(0.0)).min(left_in_all);
    if !(excess > FRACTION_ROUNDING * tracked) {
        return;
    }
    // What leaves in place of void is taken from what is left of the materials, face by face.
    for k in 0..materials {
        let part = excess / void_out * (left(given, k) / left_in_all);
        for (face, amounts) in given.chunks_mut(materials).enumerate() {
            amounts[k] += part * void[face];
        }
    }
}
