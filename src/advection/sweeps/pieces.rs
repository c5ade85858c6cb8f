//! The pieces that a sweep makes of what the cells hold of a material: what leaves through each face, and what they keep.

use vofkit_geometry::{Cell, Vector};

use super::mixed::Mixed;
use super::sweep::Sweep;
use crate::advection::carry::{Piece, Pieces};
use crate::tolerance::KEPT_ROUNDING;

/// A sweep, seen from what it moves.
pub(super) struct Crossing<'a, C, const D: usize> {
    pub(super) sweep: &'a Sweep<'a, C, D>,
    pub(super) mixed: &'a Mixed<D>,
}

/// What leaves a cell of a material through each face.
struct Portions<const D: usize> {
    cell: usize,
    held: f64,
    leaves: [f64; 6],
    /// On the distances from the middle.
    scale: f64,
}

impl<const D: usize> Portions<D> {
    fn kept(&self) -> f64 {
        self.leaves.iter().fold(self.held, |kept, leaves| kept - leaves)
    }

    /// The integral of position over what leaves: a slab next to the face, in cells from the middle.
    fn moment(&self, face: usize) -> Vector<D> {
        let leaves = self.leaves[face];
        let distance = 0.5 * self.scale * (1.0 - leaves / self.held).max(0.0);
        let outward = if face % 2 == 1 { distance } else { -distance };
        Vector::from_fn(|axis, _| if axis == face / 2 { leaves * outward } else { 0.0 })
    }

    fn kept_moment(&self) -> Vector<D> {
        let leaving = (0..2 * D).filter(|&face| self.leaves[face] > 0.0);
        leaving.fold(Vector::zeros(), |moment, face| moment - self.moment(face))
    }

    fn piece(&self, face: usize) -> Piece<D> {
        Piece { donor: Some(self.cell), volume: self.leaves[face], moment: self.moment(face) }
    }
}

impl<C: Cell<D>, const D: usize> Crossing<'_, C, D> {
    fn portions(&self, held: &[Vec<f64>], slot: usize, material: usize) -> Portions<D> {
        let cell = self.sweep.band.places()[slot].cell();
        let mut portions = Portions::<D> { cell, held: held[material][cell], leaves: [0.0; 6], scale: 1.0 };
        for face in self.sweep.stage.faces.clone() {
            portions.leaves[face] = self.sweep.leaves(self.mixed, slot, face, material);
        }
        if self.sweep.stage.faces.len() > 2 {
            // Slabs next to all faces overlap: the middle of what is kept must not come to lie outside of the cell.
            let kept = portions.kept().max(0.0);
            let distance = portions.kept_moment().lp_norm(1);
            if distance > 0.5 * kept {
                portions.scale = 0.5 * kept / distance;
            }
        }
        portions
    }
}

impl<C: Cell<D>, const D: usize> Pieces<D> for Crossing<'_, C, D> {
    fn arriving(&self, held: &[Vec<f64>], slot: usize, material: usize, visit: &mut dyn FnMut(Piece<D>)) {
        let Self { sweep, .. } = self;
        let own = self.portions(held, slot, material);
        let kept = own.kept();
        if kept.abs() > KEPT_ROUNDING * own.held {
            visit(Piece { donor: Some(own.cell), volume: kept, moment: own.kept_moment() });
        }
        for face in sweep.stage.faces.clone() {
            let flux = sweep.flux(slot, face);
            if flux >= 0.0 {
                continue;
            }
            match sweep.across(slot, face) {
                Some(donor) => {
                    // Outside of the band nothing is carried.
                    let Some(donor) = sweep.band.slot(donor) else { continue };
                    let portions = self.portions(held, donor, material);
                    if portions.leaves[face ^ 1] > 0.0 {
                        visit(portions.piece(face ^ 1));
                    }
                }
                None => {
                    let volume = sweep.rules.boundary.inflow_fraction(material) * -flux;
                    if volume > 0.0 {
                        visit(Piece { donor: None, volume, moment: Vector::zeros() });
                    }
                }
            }
        }
    }

    fn leaving(&self, held: &[Vec<f64>], slot: usize, material: usize, visit: &mut dyn FnMut(Piece<D>)) {
        let Self { sweep, .. } = self;
        for face in sweep.stage.faces.clone().filter(|&face| sweep.across(slot, face).is_none()) {
            let flux = sweep.flux(slot, face);
            if flux > 0.0 {
                let portions = self.portions(held, slot, material);
                if portions.leaves[face] > 0.0 {
                    visit(portions.piece(face));
                }
            } else if sweep.rules.boundary.inflow_fraction(material) > 0.0 && flux < 0.0 {
                visit(Piece { donor: None, volume: flux, moment: Vector::zeros() });
            }
        }
    }
}
