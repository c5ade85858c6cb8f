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

mod account;
mod mixed;
mod pieces;
mod sweep;

use vofkit_geometry::Cell;

use self::account::Account;
use self::mixed::Mixed;
use self::pieces::Crossing;
use self::sweep::Sweep;
use super::band::{Band, Place};
use super::boundary::Boundary;
use super::carry::{Along, Cargo, Carry};
use super::ledger::{Ledger, MaterialLedger};
use super::stage::{Outward, Stage};
use super::transport::StepError;
use crate::interface::Reconstruction;
use crate::mesh::Grid;
use crate::parallel;
use crate::quanta::Quanta;
use crate::stopwatch::Stopwatch;

/// What holds for all sweeps of a step.
pub(super) struct Rules<'a, const D: usize> {
    pub(super) grid: &'a Grid<D>,
    pub(super) boundary: &'a Boundary<D>,
    /// The volumes of the cells at the start of the step.
    pub(super) volumes: &'a [f64],
    /// What the fluxes are multiples of.
    pub(super) quanta: Quanta,
    pub(super) reconstruction: Reconstruction,
    /// Whether cells may give away more than they hold.
    pub(super) overdraft: bool,
    /// Whether there are quantities of each material.
    pub(super) carried: &'a [bool],
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
    carry: Carry<D>,
}

impl<const D: usize> Default for Sweeps<D> {
    fn default() -> Self {
        Self {
            members: Vec::new(),
            outward: Vec::new(),
            contents: Vec::new(),
            accounts: Vec::new(),
            mixed: Mixed::new(),
            carry: Carry::new(),
        }
    }
}

impl<const D: usize> Sweeps<D> {
    /// Does the sweeps of a step. `outward` says what leaves the cell at an offset, by component. Fractions and quantities stay
    /// as they are if a sweep cannot be done.
    pub(super) fn run<C: Cell<D>>(
        &mut self,
        rules: &Rules<'_, D>,
        stages: &[Stage<'_, C, D>],
        band: &mut Band<D>,
        cargo: &mut Cargo<'_>,
        stopwatch: &mut Stopwatch,
        outward: impl Fn([usize; D], &mut [Outward]) + Sync + Send,
    ) -> Result<Ledger, StepError> {
        let mut ledger = Ledger::new(cargo.fractions.len());
        band.collect(rules.grid, cargo.fractions, rules.carried, rules.boundary, reach(stages));
        self.begin(rules, band, cargo.fractions, outward);
        let carries = !cargo.quantities.is_empty();
        if carries {
            let cells = band.places().iter().map(Place::cell);
            self.carry.begin(cargo.quantities, cargo.fractions, rules.volumes, cells);
        }
        for stage in stages {
            if let Err(error) = self.advance(rules, stage, band, cargo, &mut ledger, stopwatch) {
                self.restore(band, cargo.fractions);
                if carries {
                    self.carry.restore(cargo.quantities);
                }
                return Err(error);
            }
        }
        if carries {
            let volume = |slot: usize| {
                let member = &self.members[slot];
                member.start + if rules.holding == Holding::Fixed { 0.0 } else { member.volume_change }
            };
            self.carry.finish(&band.cells(), volume, cargo.fractions, cargo.quantities, &mut ledger);
        }
        Ok(ledger)
    }

    /// Starts a step from these fractions: `outward` is what leaves the cell at an offset, by component.
    fn begin(
        &mut self,
        rules: &Rules<'_, D>,
        band: &Band<D>,
        fractions: &[Vec<f64>],
        outward: impl Fn([usize; D], &mut [Outward]) + Sync + Send,
    ) {
        let places = band.places();
        self.members.clear();
        self.members.resize(places.len(), Member::default());
        self.outward.resize(places.len() * rules.components, [0.0; 6]);
        self.mixed.resize(places.len());
        self.contents.resize(places.len() * fractions.len(), Content::default());
        let Self { members, outward: all, contents, .. } = self;
        parallel::for_each_with_chunk(members, all, |slot, member, all| {
            member.start = rules.volumes[places[slot].cell()];
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
        cargo: &mut Cargo<'_>,
        ledger: &mut Ledger,
        stopwatch: &mut Stopwatch,
    ) -> Result<(), StepError> {
        stopwatch.lap(|seconds| &mut seconds.update);
        let Cargo { fractions, quantities } = cargo;
        let materials = fractions.len();
        let Self { members, outward, contents, accounts, mixed, carry } = self;
        let sweep = Sweep { rules, stage, band, outward, fractions };
        mixed.collect(&sweep, contents, ledger, stopwatch)?;
        mixed.give(&sweep, members, ledger)?;
        stopwatch.lap(|seconds| &mut seconds.fluxes);
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
        if !quantities.is_empty() {
            let cells = band.cells();
            carry.find_slopes(stage.mesh, sweep.fractions, quantities, &cells, Along::Lines);
            carry.pass(&cells, &Crossing { sweep: &sweep, mixed }, None, quantities, ledger);
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
