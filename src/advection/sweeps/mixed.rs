//! The mixed cells of the band: their planes, and what they give in a sweep.

use vofkit_geometry::Cell;

use super::{Content, Member, Sweep};
use crate::advection::ledger::Ledger;
use crate::advection::transport::StepError;
use crate::interface::{Body, Counts, Placed, ReconstructionError, is_mixed, planes_of_all};
use crate::parallel;
use crate::stopwatch::Stopwatch;

/// The mixed cells of the band in a sweep, and what they give.
#[derive(Clone, Debug)]
pub(super) struct Mixed<const D: usize> {
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
pub(super) struct Gifts {
    /// Faces whose region was cut.
    pub(super) cut: usize,
    /// Materials that were cut one after the other.
    pub(super) counts: Counts,
    error: Option<ReconstructionError>,
}

impl<const D: usize> Mixed<D> {
    pub(super) fn new() -> Self {
        Self {
            slots: Vec::new(),
            number: Vec::new(),
            planes: Vec::new(),
            given: Vec::new(),
            gifts: Vec::new(),
        }
    }

    /// Makes room for a band of this many cells.
    pub(super) fn resize(&mut self, slots: usize) {
        self.number.resize(slots, 0);
    }

    /// What a mixed cell gives of a material, of so many, through a face.
    #[inline]
    pub(super) fn given(&self, slot: usize, face: usize, [material, materials]: [usize; 2]) -> f64 {
        self.given[(self.number[slot] as usize * 2 * D + face) * materials + material]
    }

    /// Finds the mixed cells of the band, and their planes.
    pub(super) fn collect<C: Cell<D>>(
        &mut self,
        sweep: &Sweep<'_, C, D>,
        contents: &[Content],
        ledger: &mut Ledger,
        stopwatch: &mut Stopwatch,
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
        let counts = &mut ledger.counts;
        let placed =
            planes_of_all(Body::Cell, mesh, sweep.fractions.into(), &cells, method, counts, stopwatch)?;
        self.planes.clear();
        self.planes.resize(self.slots.len() * materials, None);
        for (number, placed) in numbers.into_iter().zip(placed.chunks_exact(materials)) {
            self.planes[number * materials..][..materials].copy_from_slice(placed);
        }
        Ok(())
    }

    /// What they give.
    pub(super) fn give<C: Cell<D>>(
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
