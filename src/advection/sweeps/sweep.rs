//! What one sweep takes from a cell and brings to it.

use vofkit_geometry::Cell;

use super::account::{Account, correct};
use super::mixed::{Gifts, Mixed};
use super::{Content, Holding, Member, Rules};
use crate::advection::band::Band;
use crate::advection::schedule::Share;
use crate::advection::share::share;
use crate::advection::stage::{Outward, Stage};
use crate::advection::transport::StepError;
use crate::interface::{Counts, Dissector, Placed, ReconstructionError, Shared, is_mixed, region};
use crate::tolerance::OUTFLOW_EXCESS;

/// A sweep at work.
pub(super) struct Sweep<'a, C, const D: usize> {
    pub(super) rules: &'a Rules<'a, D>,
    pub(super) stage: &'a Stage<'a, C, D>,
    pub(super) band: &'a Band<D>,
    pub(super) outward: &'a [Outward],
    pub(super) fractions: &'a [Vec<f64>],
}

impl<C: Cell<D>, const D: usize> Sweep<'_, C, D> {
    /// The volume that leaves a cell through a face in this sweep.
    #[inline]
    pub(super) fn flux(&self, slot: usize, face: usize) -> f64 {
        let whole = self.outward[slot * self.rules.components + self.stage.component][face];
        let first = || self.rules.quanta.round(0.5 * whole);
        match self.stage.share {
            Share::Whole => whole,
            Share::FirstHalf => first(),
            Share::SecondHalf => whole - first(),
        }
    }

    /// The cell across a face, by the offset of this one.
    #[inline]
    pub(super) fn across(&self, slot: usize, face: usize) -> Option<usize> {
        let place = &self.band.places()[slot];
        let (axis, side) = (face / 2, face % 2);
        let (at, last) = (place.offset[axis] as usize, self.rules.grid.cells()[axis] - 1);
        let stride = self.rules.grid.stride(axis);
        let cell = place.cell();
        match (side, at) {
            (0, 0) => self.rules.grid.periodic()[axis].then(|| cell + last * stride),
            (0, _) => Some(cell - stride),
            (_, at) if at == last => self.rules.grid.periodic()[axis].then(|| cell - last * stride),
            _ => Some(cell + stride),
        }
    }

    /// The volume of a material that leaves a cell through a face.
    #[inline]
    pub(super) fn leaves(&self, mixed: &Mixed<D>, slot: usize, face: usize, material: usize) -> f64 {
        let flux = self.flux(slot, face);
        let cell = self.band.places()[slot].cell();
        if flux <= 0.0 {
            0.0
        } else if self.is_mixed(cell) {
            mixed.given(slot, face, [material, self.fractions.len()])
        } else {
            self.fractions[material][cell] * flux
        }
    }

    /// Whether a cell has a plane in some material.
    #[inline]
    fn is_mixed(&self, cell: usize) -> bool {
        self.fractions.iter().any(|f| is_mixed(f[cell]))
    }

    /// Whether the sweep can change a cell: it is mixed, or differs from what lies across a face.
    #[inline]
    fn is_active(&self, slot: usize, cell: usize) -> bool {
        let differs = |face: usize| {
            let across = self.across(slot, face);
            self.fractions.iter().enumerate().any(|(k, f)| match across {
                Some(next) => f[next] != f[cell],
                None => self.rules.boundary.inflow_fraction(k) != f[cell],
            })
        };
        self.is_mixed(cell) || self.stage.faces.clone().any(differs)
    }

    /// What a cell can give from in this sweep.
    fn tracked(&self, member: &Member) -> f64 {
        match self.rules.holding {
            Holding::Fixed => member.start,
            _ => member.start + member.volume_change,
        }
    }

    /// What leaves a mixed cell, by face and material.
    pub(super) fn give(
        &self,
        slot: usize,
        member: &Member,
        planes: &[Option<Placed<D>>],
        dissector: &mut Option<Dissector<C, D>>,
        given: &mut [f64],
        gifts: &mut Gifts,
    ) -> Result<(), ReconstructionError> {
        let (stage, materials) = (self.stage, self.fractions.len());
        let place = &self.band.places()[slot];
        let index = place.cell();
        let mut outward = [0.0_f64; 6];
        for face in stage.faces.clone() {
            outward[face] = self.flux(slot, face).max(0.0);
        }
        given.fill(0.0);
        let tracked = self.tracked(member);
        let volume = stage.mesh.volumes()[index];
        let cell = stage.mesh.local_cell(index);
        // Only with overdraft there may be nothing left to give from.
        if tracked > 0.0 && planes.iter().flatten().any(Placed::is_nested) {
            let shared =
                Shared { mesh: stage.mesh, parts: self.fractions.into(), planes, index, cell: &cell };
            let wanted = |face: usize| (outward[face] * (volume / tracked)).min(volume);
            let dissector = dissector.get_or_insert_default();
            gifts.counts.add(&self.dissect(dissector, shared, place.offset(), wanted, tracked, given)?);
            gifts.cut += outward.iter().filter(|&&flux| flux > 0.0).count() * planes.iter().flatten().count();
            share(&outward, tracked, |material| self.fractions[material][index] * tracked, materials, given);
            return Ok(());
        }
        for (material, f) in self.fractions.iter().enumerate() {
            for face in stage.faces.clone().filter(|&face| outward[face] > 0.0) {
                let flux = outward[face];
                given[face * materials + material] = match &planes[material] {
                    Some(Placed::Plane { half_space, .. }) if tracked > 0.0 => {
                        gifts.cut += 1;
                        let wanted = (flux * (volume / tracked)).min(volume);
                        let inside = stage.part(&cell, place.offset(), face, wanted, half_space);
                        (inside.clamp(0.0, wanted) * (tracked / volume)).min(flux)
                    }
                    _ => f[index] * flux,
                };
            }
        }
        if materials > 1 && tracked > 0.0 {
            share(&outward, tracked, |material| self.fractions[material][index] * tracked, materials, given);
        }
        Ok(())
    }

    /// What leaves a cell whose materials are cut one after the other.
    fn dissect(
        &self,
        dissector: &mut Dissector<C, D>,
        shared: Shared<'_, C, D>,
        offset: [usize; D],
        wanted: impl Fn(usize) -> f64,
        tracked: f64,
        given: &mut [f64],
    ) -> Result<Counts, ReconstructionError> {
        let (stage, materials) = (self.stage, self.fractions.len());
        let method = self.rules.reconstruction;
        if let Some(slabs) = stage.slabs(shared.cell, &wanted) {
            return dissector.dissect(shared, slabs, method, |slab, material, volume| {
                if slab < 2 {
                    given[(stage.faces.start + slab) * materials + material] += volume * tracked;
                }
            });
        }
        let counts = dissector.dissect(shared, [*shared.cell], method, |_, _, _| {})?;
        let scale = tracked / shared.cell.volume();
        for face in stage.faces.clone().filter(|&face| wanted(face) > 0.0) {
            let piece = stage.region(shared.cell, offset, face, wanted(face));
            dissector.divide(region(&piece, |x| *x), |material, volume| {
                given[face * materials + material] += volume * scale;
            });
            // The parts of a region that folds over may be negative.
            given[face * materials..][..materials].iter_mut().for_each(|amount| *amount = amount.max(0.0));
        }
        Ok(counts)
    }

    /// Whether a cell gives away more than it holds, and through how many faces it gives.
    fn check(&self, slot: usize, member: &Member) -> Result<usize, StepError> {
        let outflows = self.stage.faces.clone().map(|face| self.flux(slot, face).max(0.0));
        let outflow = match self.rules.holding {
            Holding::AtOnce => outflows.clone().fold(0.0, f64::max),
            _ => outflows.clone().sum(),
        };
        let tracked = self.tracked(member);
        if outflow > tracked + OUTFLOW_EXCESS * member.start && !self.rules.overdraft {
            let cell = self.band.places()[slot].offset().to_vec();
            return Err(StepError::Overdrawn { cell, volume: tracked, outflow });
        }
        Ok(outflows.filter(|&flux| flux > 0.0).count())
    }

    /// What one cell loses and gains.
    pub(super) fn exchange(
        &self,
        slot: usize,
        mixed: &Mixed<D>,
        member: &mut Member,
        contents: &mut [Content],
        account: &mut Account,
    ) -> Result<(), StepError> {
        let index = self.band.places()[slot].cell();
        // What is left of a cell that changed before is kept in account, too.
        // So are quantities, which no cell may give away more of than it holds.
        let changed = contents.iter().zip(self.rules.carried).any(|(content, carried)| {
            content.fraction != content.initial || *carried && content.fraction > 0.0
        });
        member.active = changed || self.is_active(slot, index);
        if member.active {
            account.crossed += self.check(slot, member)?;
        }
        let start = member.volume_change;
        for face in self.stage.faces.clone() {
            member.volume_change -= self.flux(slot, face);
        }
        if !member.active {
            return Ok(());
        }
        let materials = contents.len();
        let given = |slot: usize, face: usize, k: usize| mixed.given(slot, face, [k, materials]);
        let is_mixed = self.is_mixed(index);
        let inflow = |k: usize| self.rules.boundary.inflow_fraction(k);
        for face in self.stage.faces.clone() {
            let flux = self.flux(slot, face);
            let across = self.across(slot, face);
            let donor = across.filter(|&next| self.is_mixed(next)).and_then(|next| self.band.slot(next));
            for (k, content) in contents.iter_mut().enumerate() {
                if flux > 0.0 {
                    let part = if is_mixed { given(slot, face, k) } else { content.fraction * flux };
                    content.excess -= part - content.initial * flux;
                    if across.is_none() {
                        account.materials[k].outflow += part - inflow(k) * flux;
                    }
                } else {
                    let part = match (donor, across) {
                        (Some(donor), _) => given(donor, face ^ 1, k),
                        (None, Some(next)) => self.fractions[k][next] * -flux,
                        (None, None) => inflow(k) * -flux,
                    };
                    content.excess += part - content.initial * -flux;
                }
            }
        }
        let volume_change = if self.rules.holding == Holding::Fixed {
            for content in contents.iter_mut() {
                // What the fluxes add counts as full or empty.
                let counted = if content.initial >= 0.5 { 1.0 } else { 0.0 };
                content.excess += (content.initial - counted) * (member.volume_change - start);
            }
            0.0
        } else {
            member.volume_change
        };
        correct(member.start + volume_change, contents, index, account);
        Ok(())
    }
}
