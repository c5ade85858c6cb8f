//! What a step did, and what it corrected.

use crate::interface::Counts;

/// One material's account of a step: fractions before any correction, and every correction.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "cli", derive(serde::Deserialize, serde::Serialize))]
pub struct MaterialLedger {
    /// Smallest fraction before correction, among the cells that a sweep could change.
    pub smallest: f64,
    /// Largest fraction before correction, among the cells that a sweep could change.
    pub largest: f64,
    /// Volume moved by setting fractions below 0 to 0 and above 1 to 1, added up without sign.
    pub clipped: f64,
    /// Volume taken by scaling the fractions of a cell whose sum was above 1.
    pub rescaled: f64,
    /// Volume removed with wisps, where the settings say so.
    pub wisps: f64,
    /// Volume that left through open ends, less what came in.
    pub outflow: f64,
    /// Volume that came from the divergence of the velocity, where the flow dilates: `sum f+ sum F` over the cells.
    pub dilated: f64,
}

impl Default for MaterialLedger {
    fn default() -> Self {
        Self {
            smallest: f64::INFINITY,
            largest: f64::NEG_INFINITY,
            clipped: 0.0,
            rescaled: 0.0,
            wisps: 0.0,
            outflow: 0.0,
            dilated: 0.0,
        }
    }
}

impl MaterialLedger {
    /// Adds another account.
    pub fn add(&mut self, other: &Self) {
        self.smallest = self.smallest.min(other.smallest);
        self.largest = self.largest.max(other.largest);
        self.clipped += other.clipped;
        self.rescaled += other.rescaled;
        self.wisps += other.wisps;
        self.outflow += other.outflow;
        self.dilated += other.dilated;
    }
}

/// The account of a quantity of a material over a step; components are added up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cli", derive(serde::Deserialize, serde::Serialize))]
pub struct QuantityLedger {
    /// What limiting values to the range of those they come from moved, and what corrected fractions took along or brought, added
    /// up without sign.
    pub limited: f64,
    /// What left through open ends, less what came in.
    pub outflow: f64,
}

impl QuantityLedger {
    /// Adds another account.
    pub fn add(&mut self, other: &Self) {
        self.limited += other.limited;
        self.outflow += other.outflow;
    }
}

/// The largest single correction, and where it was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cli", derive(serde::Deserialize, serde::Serialize))]
pub struct LargestCorrection {
    /// The change of a fraction.
    pub fraction: f64,
    /// The cell.
    pub cell: usize,
}

impl LargestCorrection {
    /// Keeps the larger of two corrections; the earlier one of two equal ones.
    pub fn note(&mut self, other: Self) {
        if other.fraction > self.fraction {
            *self = other;
        }
    }
}

/// What a step, or a whole run, did.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cli", derive(serde::Deserialize, serde::Serialize))]
pub struct Ledger {
    /// By material.
    pub materials: Vec<MaterialLedger>,
    /// By quantity; empty where none are carried.
    pub quantities: Vec<QuantityLedger>,
    /// The largest correction of a fraction.
    pub largest_correction: LargestCorrection,
    /// Reconstructions.
    pub counts: Counts,
    /// Sweeps.
    pub sweeps: usize,
    /// Cells of the band, added up over sweeps: those that were looked at.
    pub cells_visited: usize,
    /// Faces through which volume left a cell that the sweep could change, added up over sweeps.
    pub faces_crossed: usize,
    /// Those of them whose swept region was cut by a plane.
    pub faces_cut: usize,
    /// Pre-images of the unsplit scheme that were cut, because they met more than one material or void.
    pub preimages_cut: usize,
    /// Those of them that may fold over: their boundary is not seen from within.
    pub preimages_folded: usize,
}

impl Ledger {
    /// An empty account for a number of materials.
    pub fn new(materials: usize) -> Self {
        Self { materials: vec![MaterialLedger::default(); materials], ..Self::default() }
    }

    /// Adds another account, of the same materials.
    pub fn add(&mut self, other: &Self) {
        for (a, b) in self.materials.iter_mut().zip(&other.materials) {
            a.add(b);
        }
        self.quantities.resize_with(self.quantities.len().max(other.quantities.len()), Default::default);
        for (a, b) in self.quantities.iter_mut().zip(&other.quantities) {
            a.add(b);
        }
        self.largest_correction.note(other.largest_correction);
        self.counts.add(&other.counts);
        self.sweeps += other.sweeps;
        self.cells_visited += other.cells_visited;
        self.faces_crossed += other.faces_crossed;
        self.faces_cut += other.faces_cut;
        self.preimages_cut += other.preimages_cut;
        self.preimages_folded += other.preimages_folded;
    }
}
