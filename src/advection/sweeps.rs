//! Advection by sweeps (Algorithm 5.1 of the paper), one [`Stage`] after the other.
//!
//! Within a step every cell of the band has a *tracked volume* `V* = V - sum of fluxes so far`, and holds the volume
//! `f V*` of a material. A sweep reconstructs the interface from the fractions `f` on the cell's own geometry. For a face
//! with the outward flux volume `phi` the swept region of volume `phi V / V*` is cut by the donor's plane, and what is found there,
//! times `V* / V`, crosses the face. At the last sweep `V*` is back at `V`; where the mesh moves, it is the new cell's volume.
//!
//! Along mesh lines the two swept regions of a cell are disjoint slabs of it, so fractions stay in `[0, 1]` and volume is conserved to
//! rounding. Along Cartesian axes on a distorted mesh, and over all faces at once, the regions of a cell may overlap or reach beyond
//! it; what that costs is corrected as in Sect. 5.2.3 and entered in the [`Ledger`].
//!
//! With *fixed* volumes (Weymouth & Yue 2010) cells keep `V` throughout, and what the fluxes of a sweep add to or take from
//! a cell counts as full of the material where it was at least half full at the start of the step, else as free of it. These terms
//! cancel over the step.
//!
//! Several materials in a cell are cut one after the other. Along mesh lines the slabs and what they leave of the cell are cut
//! together, so that what leaves adds up to what the faces carry and what stays to what the cell holds. Where planes are independent, or regions
//! overlap, what leaves is fitted to what the cell holds (`share`), so that neither volume nor the fullness of a cell is lost.

use vofkit_geometry::Cell;

use super::band::Band;
use super::boundary::Boundary;
use super::ledger::{LargestCorrection, Ledger, MaterialLedger};
use super::schedule::Share;
use super::share::share;
use super::stage::{Outward, Stage};
use super::transport::StepError;
use crate::interface::{
    Counts, Dissector, Placed, Reconstruction, ReconstructionError, Shared, is_mixed, planes_of_all, region,
};
use crate::mesh::Grid;
use crate::parallel;
use crate::quanta::Quanta;
use crate::tolerance::{FRACTION_ROUNDING, OUTFLOW_EXCESS};

/// What holds for all sweeps of a step.
pub(super) struct Rules<'a, const D: usize> {
    pub(super) grid: &'a Grid<D>,
    pub(super) boundary: &'a Boundary<D>,
    /// What the fluxes are multiples of.
    pub(super) quanta: Quanta,
    pub(super) reconstruction: Reconstruction,
    /// Whether cells may give away more than they hold.
    pub(super) overdraft: bool,
    pub(super) holding: Holding,
    /// How many volumes a cell has: one for each component.
    pub(super) components: usize,
}

/// What a cell is taken to hold during a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Holding {
    /// Its tracked volume.
    Tracked,
    /// The same, and all faces are moved in one sweep: each of them may take as much as the cell holds.
    AtOnce,
    /// Its volume at the start of the step (Weymouth & Yue).
    Fixed,
}

/// What a block of the band did in a sweep.
#[derive(Clone, Debug, Default)]
struct Account {
    crossed: usize,
    cut: usize,
    error: Option<StepError>,
    materials: Vec<MaterialLedger>,
    largest: LargestCorrection,
}

impl Account {
    fn new(materials: usize) -> Self {
        Self { materials: vec![MaterialLedger::default(); materials], ..Self::default() }
    }

    /// Empties the account, and keeps its memory.
    fn reset(&mut self) {
        let mut materials = std::mem::take(&mut self.materials);
        materials.fill(MaterialLedger::default());
        *self = Self { materials, ..Self::default() };
    }

    fn enter(&self, ledger: &mut Ledger) {
        ledger.faces_crossed += self.crossed;
        ledger.faces_cut += self.cut;
        for (total, part) in ledger.materials.iter_mut().zip(&self.materials) {
            total.add(part);
        }
        ledger.largest_correction.note(self.largest);
    }
}

/// One cell of the band, as it stands through the sweeps of a step.
#[derive(Clone, Copy, Debug, Default)]
struct Member {
    /// Its volume at the start of the step.
    start: f64,
    /// The change of its tracked volume since.
    volume_change: f64,
    /// Whether the sweep can change it.
    active: bool,
}

/// One material in one cell of the band.
#[derive(Clone, Copy, Debug, Default)]
struct Content {
    /// Its fraction at the start of the step.
    initial: f64,
    /// What came in since, as a volume, less what would have come in at the initial fraction.
    excess: f64,
    fraction: f64,
}

/// The band during a step, kept to reuse its memory. Everything is by slot of the band but what mixed cells give.
#[derive(Clone, Debug)]
pub(super) struct Sweeps<const D: usize> {
    members: Vec<Member>,
    /// By component.
    outward: Vec<Outward>,
    /// By material.
    contents: Vec<Content>,
    /// By block of the band.
    accounts: Vec<Account>,
    mixed: Mixed<D>,
}

/// The mixed cells of the band in a sweep, and what they give.
#[derive(Clone, Debug)]
struct Mixed<const D: usize> {
    /// Their slots, ascending.
    slots: Vec<u32>,
    /// The number of a mixed cell by its slot; for others any.
    number: Vec<u32>,
    /// Their planes, by material, where one is needed.
    planes: Vec<Option<Placed<D>>>,
    /// What they give, by face and material.
    given: Vec<f64>,
    /// By block of mixed cells.
    gifts: Vec<Gifts>,
}

/// What a block of mixed cells did when it gave.
#[derive(Clone, Debug, Default)]
struct Gifts {
    /// Faces whose region was cut.
    cut: usize,
    /// Materials that were cut one after the other.
    counts: Counts,
    error: Option<ReconstructionError>,
}

impl<const D: usize> Default for Sweeps<D> {
    fn default() -> Self {
        Self {
            members: Vec::new(),
            outward: Vec::new(),
            contents: Vec::new(),
            accounts: Vec::new(),
            mixed: Mixed {
                slots: Vec::new(),
                number: Vec::new(),
                planes: Vec::new(),
                given: Vec::new(),
                gifts: Vec::new(),
            },
        }
    }
}

/// A sweep at work.
struct Sweep<'a, C, const D: usize> {
    rules: &'a Rules<'a, D>,
    stage: &'a Stage<'a, C, D>,
    band: &'a Band<D>,
    outward: &'a [Outward],
    fractions: &'a [Vec<f64>],
}

impl<C: Cell<D>, const D: usize> Sweep<'_, C, D> {
    /// The volume that leaves a cell through a face in this sweep.
    #[inline]
    fn flux(&self, slot: usize, face: usize) -> f64 {
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
    fn across(&self, slot: usize, face: usize) -> Option<usize> {
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
    fn give(
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
        if tracked > 0.0 && planes.contains(&Some(Placed::Nested)) {
            let shared = Shared { mesh: stage.mesh, fractions: self.fractions, index, cell: &cell };
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
    fn exchange(
        &self,
        slot: usize,
        mixed: &Mixed<D>,
        member: &mut Member,
        contents: &mut [Content],
        account: &mut Account,
    ) -> Result<(), StepError> {
        let index = self.band.places()[slot].cell();
        // What is left of a cell that changed before is kept in account, too.
        let changed = contents.iter().any(|content| content.fraction != content.initial);
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
        let given = |slot: usize, face: usize, k: usize| {
            mixed.given[(mixed.number[slot] as usize * C::FACES + face) * materials + k]
        };
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

impl<const D: usize> Sweeps<D> {
    /// Does the sweeps of a step. `volumes` are those of the cells at its start; `outward` says what leaves the cell at an
    /// offset, by component. The fractions stay as they are if a sweep cannot be done.
    pub(super) fn run<C: Cell<D>>(
        &mut self,
        rules: &Rules<'_, D>,
        stages: &[Stage<'_, C, D>],
        band: &mut Band<D>,
        volumes: &[f64],
        fractions: &mut [Vec<f64>],
        outward: impl Fn([usize; D], &mut [Outward]) + Sync + Send,
    ) -> Result<Ledger, StepError> {
        let mut ledger = Ledger::new(fractions.len());
        band.collect(rules.grid, fractions, rules.boundary, reach(stages));
        self.begin(rules, band, volumes, fractions, outward);
        for stage in stages {
            if let Err(error) = self.advance(rules, stage, band, fractions, &mut ledger) {
                self.restore(band, fractions);
                return Err(error);
            }
        }
        Ok(ledger)
    }

    /// Starts a step from these fractions: `volumes` are those of the cells, `outward` what leaves the cell at an offset,
    /// by component.
    fn begin(
        &mut self,
        rules: &Rules<'_, D>,
        band: &Band<D>,
        volumes: &[f64],
        fractions: &[Vec<f64>],
        outward: impl Fn([usize; D], &mut [Outward]) + Sync + Send,
    ) {
        let places = band.places();
        self.members.clear();
        self.members.resize(places.len(), Member::default());
        self.outward.resize(places.len() * rules.components, [0.0; 6]);
        self.mixed.number.resize(places.len(), 0);
        self.contents.resize(places.len() * fractions.len(), Content::default());
        let Self { members, outward: all, contents, .. } = self;
        parallel::for_each_with_chunk(members, all, |slot, member, all| {
            member.start = volumes[places[slot].cell()];
            outward(places[slot].offset(), all);
        });
        for (place, contents) in places.iter().zip(contents.chunks_exact_mut(fractions.len())) {
            for (content, f) in contents.iter_mut().zip(fractions) {
                let initial = f[place.cell()];
                *content = Content { initial, excess: 0.0, fraction: initial };
            }
        }
        self.accounts.resize_with(parallel::blocks(places.len()), || Account::new(fractions.len()));
        for account in &mut self.accounts {
            account.materials.resize(fractions.len(), MaterialLedger::default());
        }
    }

    /// Puts the fractions back to those at the start of the step.
    fn restore(&self, band: &Band<D>, fractions: &mut [Vec<f64>]) {
        for (place, contents) in band.places().iter().zip(self.contents.chunks_exact(fractions.len())) {
            for (f, content) in fractions.iter_mut().zip(contents) {
                f[place.cell()] = content.initial;
            }
        }
    }

    /// Does one sweep.
    fn advance<C: Cell<D>>(
        &mut self,
        rules: &Rules<'_, D>,
        stage: &Stage<'_, C, D>,
        band: &Band<D>,
        fractions: &mut [Vec<f64>],
        ledger: &mut Ledger,
    ) -> Result<(), StepError> {
        let materials = fractions.len();
        let Self { members, outward, contents, accounts, mixed } = self;
        let sweep = Sweep { rules, stage, band, outward, fractions };
        mixed.collect(&sweep, contents, ledger)?;
        mixed.give(&sweep, members, ledger)?;
        parallel::for_each_block(members, contents, accounts, |first, members, contents, account| {
            account.reset();
            let cells = members.iter_mut().zip(contents.chunks_exact_mut(materials)).enumerate();
            for (i, (member, contents)) in cells {
                if let Err(error) = sweep.exchange(first + i, mixed, member, contents, account) {
                    account.error = Some(error);
                    return;
                }
            }
        });
        if let Some(error) = accounts.iter_mut().find_map(|account| account.error.take()) {
            return Err(error);
        }
        let changed = band.places().iter().zip(members.iter()).zip(contents.chunks_exact(materials));
        for ((place, _), contents) in changed.filter(|((_, member), _)| member.active) {
            for (f, content) in fractions.iter_mut().zip(contents) {
                f[place.cell()] = content.fraction;
            }
        }
        for account in accounts {
            account.enter(ledger);
        }
        ledger.sweeps += 1;
        ledger.cells_visited += members.len();
        Ok(())
    }
}

impl<const D: usize> Mixed<D> {
    /// Finds the mixed cells of the band, and their planes.
    fn collect<C: Cell<D>>(
        &mut self,
        sweep: &Sweep<'_, C, D>,
        contents: &[Content],
        ledger: &mut Ledger,
    ) -> Result<(), StepError> {
        let materials = sweep.fractions.len();
        let places = sweep.band.places();
        self.slots.clear();
        for (slot, contents) in contents.chunks_exact(materials).enumerate() {
            if contents.iter().any(|content| is_mixed(content.fraction)) {
                self.number[slot] = self.slots.len() as u32;
                self.slots.push(slot as u32);
            }
        }
        let method = sweep.rules.reconstruction;
        let gives = |slot: usize| sweep.stage.faces.clone().any(|face| sweep.flux(slot, face) > 0.0);
        let needed = |&&slot: &&u32| method.normal.reads_neighbours() || gives(slot as usize);
        let (numbers, cells): (Vec<usize>, Vec<usize>) = (self.slots.iter().enumerate())
            .filter(|(_, slot)| needed(slot))
            .map(|(number, &slot)| (number, places[slot as usize].cell()))
            .unzip();
        let mesh = sweep.stage.mesh;
        let placed = planes_of_all(mesh, sweep.fractions, &cells, method, &mut ledger.counts)?;
        self.planes.clear();
        self.planes.resize(self.slots.len() * materials, None);
        for (number, placed) in numbers.into_iter().zip(placed.chunks_exact(materials)) {
            self.planes[number * materials..][..materials].copy_from_slice(placed);
        }
        Ok(())
    }

    /// What they give.
    fn give<C: Cell<D>>(
        &mut self,
        sweep: &Sweep<'_, C, D>,
        members: &[Member],
        ledger: &mut Ledger,
    ) -> Result<(), StepError> {
        let materials = sweep.fractions.len();
        let Self { slots, planes, given, gifts, .. } = self;
        given.resize(slots.len() * C::FACES * materials, 0.0);
        gifts.clear();
        gifts.resize(parallel::blocks(slots.len()), Gifts::default());
        parallel::for_each_block(slots, given, gifts, |first, slots, given, gifts| {
            let mut dissector = None;
            for (i, given) in given.chunks_exact_mut(C::FACES * materials).enumerate() {
                let slot = slots[i] as usize;
                let planes = &planes[(first + i) * materials..][..materials];
                if let Err(error) = sweep.give(slot, &members[slot], planes, &mut dissector, given, gifts) {
                    gifts.error = Some(error);
                    return;
                }
            }
        });
        for gifts in gifts {
            if let Some(error) = gifts.error.take() {
                return Err(error.into());
            }
            ledger.counts.add(&gifts.counts);
            ledger.faces_cut += gifts.cut;
        }
        Ok(())
    }
}

/// How far along each axis a step reaches beyond the cells that its first sweep can change: each later one by the neighbours
/// across its faces.
fn reach<C, const D: usize>(stages: &[Stage<'_, C, D>]) -> [usize; D] {
    let mut reach = [0; D];
    for stage in stages.iter().skip(1) {
        for axis in stage.faces.clone().step_by(2).map(|face| face / 2) {
            reach[axis] += 1;
        }
    }
    reach
}

/// The new fractions in a cell of this tracked volume, with the corrections of Sect. 5.2.3: into `[0, 1]`, and their sum to
/// at most 1.
///
/// A cell that exchanged nothing but what it is full of keeps its fractions to the bit.
fn correct(volume: f64, contents: &mut [Content], cell: usize, account: &mut Account) {
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
