//! What a region holds of each material, wherever it lies in a mesh: the region cut by every cell that it meets and by the planes
//! in that cell.
//!
//! The parts of a region are taken from the cells' [tiles](vofkit_geometry::clip::tile), which fill the mesh, and the materials and
//! the void of a cell fill its tile. So what the materials and the void have of a region adds up to the region, to rounding. The
//! one that takes most work is therefore found as what the others leave; and a region that meets one of them alone needs no cut.

use vofkit_geometry::clip::{Full, Region, Side, Tile, Workspace, bounds};
use vofkit_geometry::{Cell, Vector};

use super::carry::{Carry, Piece, Pieces};
use super::nested::Nested;
use crate::interface::{RegionOf, Share};
use crate::mesh::Mesh;
use crate::mesh::locate::{Candidate, Locator};
use crate::quantity::MaterialQuantity;

/// A mesh with its materials before a step.
pub(super) struct Source<'a, C: Cell<D>, const D: usize> {
    pub(super) mesh: &'a Mesh<C, D>,
    pub(super) locator: &'a Locator<D>,
    pub(super) fractions: &'a [Vec<f64>],
    pub(super) nested: &'a Nested<D>,
    /// The [tiles](Nested::tiles) of its cells.
    pub(super) tiles: &'a [C::Tile],
    /// The material outside the mesh; none for void.
    pub(super) outside: Option<usize>,
    /// The quantities of the materials; none where there are none.
    pub(super) load: Option<Load<'a, D>>,
}

/// The quantities of the materials of a source.
#[derive(Clone, Copy)]
pub(super) struct Load<'a, const D: usize> {
    pub(super) carry: &'a Carry<D>,
    pub(super) quantities: &'a [MaterialQuantity],
    /// Whether there are any, by material.
    pub(super) carried: &'a [bool],
}

/// The pieces that a region is made of, with their materials.
pub(super) type Record<const D: usize> = Vec<(usize, Piece<D>)>;

/// What was found about a region that a cell gets.
#[derive(Clone, Debug)]
pub(super) struct Finding<const D: usize> {
    pub(super) held: Result<Held, Full>,
    /// Whether it was cut and may fold over.
    pub(super) is_folded: bool,
    /// Its volume, where that is not what it should be: its contents were not looked for then.
    pub(super) wrong_volume: Option<f64>,
    /// Its pieces, and those of what crosses open ends; none where no quantities are carried.
    pub(super) arriving: Record<D>,
    pub(super) leaving: Record<D>,
}

impl<const D: usize> Finding<D> {
    pub(super) fn new() -> Self {
        Self {
            held: Ok(Held::One),
            is_folded: false,
            wrong_volume: None,
            arriving: Vec::new(),
            leaving: Vec::new(),
        }
    }

    /// Forgets what was found, and keeps the memory.
    pub(super) fn reset(&mut self) {
        self.arriving.clear();
        self.leaving.clear();
        (self.held, self.is_folded, self.wrong_volume) = (Ok(Held::One), false, None);
    }
}

impl<const D: usize> Pieces<D> for [Finding<D>] {
    fn arriving(&self, _: &[Vec<f64>], place: usize, material: usize, visit: &mut dyn FnMut(Piece<D>)) {
        self[place].arriving.iter().filter(|(of, _)| *of == material).for_each(|(_, piece)| visit(*piece));
    }

    fn leaving(&self, _: &[Vec<f64>], place: usize, material: usize, visit: &mut dyn FnMut(Piece<D>)) {
        self[place].leaving.iter().filter(|(of, _)| *of == material).for_each(|(_, piece)| visit(*piece));
    }
}

/// No component: all are cut.
const NONE: usize = usize::MAX;

/// What is kept from one region to the next, to save memory and time.
pub(super) struct Scratch<R, const D: usize> {
    candidates: Vec<Candidate<D>>,
    /// By component: candidates that hold nothing else.
    pure: Vec<usize>,
    /// By component: what it has of the region.
    amounts: Vec<f64>,
    parts: [R; 3],
    work: Workspace<R>,
}

impl<R: Region<D>, const D: usize> Scratch<R, D> {
    pub(super) fn new() -> Self {
        Self {
            candidates: Vec::new(),
            pure: Vec::new(),
            amounts: Vec::new(),
            parts: [R::empty(), R::empty(), R::empty()],
            work: Workspace::new(),
        }
    }

    fn begin(&mut self, components: usize) {
        self.amounts.clear();
        self.amounts.resize(components, 0.0);
    }
}

/// What was found about a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Held {
    /// One material, or void, and nothing else.
    One,
    /// Several: the region was cut.
    Several,
}

/// One cell, while it is cut out of a region.
struct Cut<'a, C: Cell<D>, const D: usize> {
    tile: C::Tile,
    work: &'a mut Workspace<RegionOf<C, D>>,
    /// By component.
    amounts: &'a mut [f64],
    /// Where pieces of carried materials are entered.
    record: Option<(Donor<D>, &'a [bool], &'a mut Record<D>)>,
}

/// A cell that pieces come from, and its middle where moments about it are wanted.
#[derive(Clone, Copy)]
struct Donor<const D: usize> {
    cell: usize,
    middle: Option<Vector<D>>,
}

impl<const D: usize> Donor<D> {
    fn piece(&self, volume: f64, first: &Vector<D>) -> Piece<D> {
        let moment = self.middle.map_or_else(Vector::zeros, |middle| first - middle * volume);
        Piece { donor: Some(self.cell), volume, moment }
    }
}

impl<C: Cell<D>, const D: usize> Cut<'_, C, D> {
    /// Gives a component what a region has in common with the cell.
    fn give(&mut self, component: usize, density: f64, region: &RegionOf<C, D>) -> Result<(), Full> {
        let mut volume = 0.0;
        let Some((donor, _, record)) =
            self.record.as_mut().filter(|(_, carried, _)| component < carried.len() && carried[component])
        else {
            self.tile.common(region, self.work, &mut |sign, part| volume += sign * part.volume())?;
            self.amounts[component] += density * volume;
            return Ok(());
        };
        let mut first = Vector::zeros();
        self.tile.common(region, self.work, &mut |sign, part| {
            if donor.middle.is_some() {
                let moments = part.moments();
                volume += sign * moments.volume;
                first += moments.first * sign;
            } else {
                volume += sign * part.volume();
            }
        })?;
        self.amounts[component] += density * volume;
        if volume != 0.0 {
            record.push((component, donor.piece(density * volume, &(first * density))));
        }
        Ok(())
    }
}

impl<C: Cell<D>, const D: usize> Source<'_, C, D> {
    /// The component that a pure cell holds: a material by its number, then void.
    fn pure(&self, cell: usize) -> Option<usize> {
        let mut component = self.fractions.len();
        for (k, f) in self.fractions.iter().enumerate() {
            if f[cell] >= 1.0 {
                component = k;
            } else if f[cell] > 0.0 {
                return None;
            }
        }
        Some(component)
    }

    /// A cell and its middle, in coordinates relative to `origin`.
    fn donor(&self, candidate: &Candidate<D>, origin: &Vector<D>) -> Donor<D> {
        let middle = self.load.and_then(|load| load.carry.middle(candidate.cell));
        let to_region = self.mesh.anchor(candidate.cell) + candidate.shift - origin;
        Donor { cell: candidate.cell, middle: middle.map(|middle| middle + to_region) }
    }

    fn carries(&self, component: usize) -> bool {
        self.load.is_some_and(|load| component < load.carried.len() && load.carried[component])
    }

    /// The one piece of a region in cells that hold nothing but this material, if it has the same values throughout.
    fn one_piece(
        &self,
        region: &RegionOf<C, D>,
        origin: &Vector<D>,
        whole: f64,
        material: usize,
        candidates: &[Candidate<D>],
    ) -> Option<Piece<D>> {
        let load = self.load?;
        let (first, others) = candidates.split_first()?;
        let alike =
            |other: &Candidate<D>| load.carry.alike(load.quantities, material, [first.cell, other.cell]);
        if alike(first) && others.iter().all(alike) {
            return Some(Piece { donor: Some(first.cell), volume: whole, moment: Vector::zeros() });
        }
        let moments = region.moments();
        others.is_empty().then(|| self.donor(first, origin).piece(whole, &moments.first))
    }

    /// The volume of each material in `region`, whose points are relative to `origin` and whose volume is `whole`. Pieces of materials
    /// with quantities are added to `record`.
    ///
    /// # Errors
    /// A region that is folded so often that there is no room for its parts.
    pub(super) fn contents(
        &self,
        region: &RegionOf<C, D>,
        origin: &Vector<D>,
        whole: f64,
        scratch: &mut Scratch<RegionOf<C, D>, D>,
        contents: &mut [f64],
        record: &mut Record<D>,
    ) -> Result<Held, Full> {
        let void = self.fractions.len();
        let around = bounds(region.corners()).map(|corner| corner + origin);
        scratch.candidates.clear();
        self.locator.find(self.mesh, around, &mut scratch.candidates);
        let pure = &mut scratch.pure;
        pure.clear();
        pure.resize(void + 1, 0);
        let mut mixed = false;
        for candidate in &scratch.candidates {
            match self.pure(candidate.cell) {
                Some(component) => pure[component] += 1,
                None => mixed = true,
            }
        }
        let reaches_out = self.locator.reaches_out(self.mesh, &around, &scratch.candidates);
        let outside = reaches_out.then_some(self.outside.unwrap_or(void));
        if let Some(component) = outside {
            pure[component] += 1;
        }
        contents.fill(0.0);
        if !mixed && pure.iter().filter(|&&count| count > 0).count() <= 1 {
            let component = pure.iter().position(|&count| count > 0).filter(|&component| component < void);
            if let Some(component) = component {
                contents[component] = whole;
            }
            let Some(material) = component.filter(|&component| self.carries(component)) else {
                return Ok(Held::One);
            };
            let piece = match outside {
                None => self.one_piece(region, origin, whole, material, &scratch.candidates),
                Some(_) if scratch.candidates.is_empty() => Some(flowing_in(whole)),
                Some(_) => None,
            };
            if let Some(piece) = piece {
                record.push((material, piece));
                return Ok(Held::One);
            }
        }
        // What lies outside is found as what does not lie inside; of what carries quantities each piece is wanted.
        let most = || (0..=void).filter(|&k| !self.carries(k)).max_by_key(|&component| pure[component]);
        let left_out = match outside {
            Some(component) if self.carries(component) => NONE,
            Some(component) => component,
            None => most().unwrap_or(void),
        };
        scratch.begin(void + 1);
        let start = record.len();
        if self.add(region, origin, left_out, scratch, record).is_err() {
            scratch.begin(void + 1);
            record.truncate(start);
            let mut result = Ok(());
            region.simplices(&mut |simplex| {
                if result.is_ok() {
                    result = self.add(simplex, origin, left_out, scratch, record);
                }
            });
            result?;
        }
        let amounts = &scratch.amounts;
        contents.copy_from_slice(&amounts[..void]);
        let rest = whole - amounts.iter().sum::<f64>();
        if left_out < void {
            contents[left_out] = rest;
        } else if let (NONE, Some(material)) = (left_out, outside) {
            contents[material] += rest;
            record.push((material, flowing_in(rest)));
        }
        Ok(Held::Several)
    }

    /// Adds up what each component but one has of a region.
    fn add(
        &self,
        region: &RegionOf<C, D>,
        origin: &Vector<D>,
        left_out: usize,
        scratch: &mut Scratch<RegionOf<C, D>, D>,
        record: &mut Record<D>,
    ) -> Result<(), Full> {
        let Scratch { candidates, amounts, parts, work, .. } = scratch;
        for candidate in &*candidates {
            let pure = self.pure(candidate.cell);
            if pure == Some(left_out) {
                continue;
            }
            let shift = candidate.shift - origin;
            let tile = match self.nested.place_of(candidate.cell) {
                Some(place) => self.tiles[place].translated(&(self.mesh.anchor(candidate.cell) + shift)),
                None => C::Tile::new(&self.mesh.shifted_cell(candidate.cell, &shift)),
            };
            let record = self.load.map(|load| (self.donor(candidate, origin), load.carried, &mut *record));
            let mut cut = Cut::<C, D> { tile, work, amounts, record };
            match pure {
                Some(component) => cut.give(component, 1.0, region)?,
                None => self.add_mixed(candidate.cell, &shift, region, left_out, &mut cut, parts)?,
            }
        }
        Ok(())
    }

    /// Adds up what each component but one has of a region in a mixed cell.
    fn add_mixed(
        &self,
        cell: usize,
        shift: &Vector<D>,
        region: &RegionOf<C, D>,
        left_out: usize,
        cut: &mut Cut<'_, C, D>,
        parts: &mut [RegionOf<C, D>; 3],
    ) -> Result<(), Full> {
        let void = self.fractions.len();
        let Some(shares) = self.nested.of(cell) else {
            // Among equals: no plane was asked for.
            let mut rest = 1.0;
            for (k, f) in self.fractions.iter().enumerate() {
                rest -= f[cell];
                if k != left_out && f[cell] > 0.0 {
                    cut.give(k, f[cell], region)?;
                }
            }
            return if left_out == void { Ok(()) } else { cut.give(void, rest, region) };
        };
        let to_mesh = self.mesh.anchor(cell) + shift;
        let [below, mut rest, mut spare] = parts.each_mut();
        let (mut is_cut, mut density) = (false, 1.0);
        for (place, &(component, share)) in shares.iter().flatten().enumerate() {
            let region = if is_cut { &*rest } else { region };
            let is_wanted = component != left_out;
            match share {
                Share::Even(part) => {
                    if is_wanted {
                        cut.give(component, density * part, region)?;
                    }
                    density *= 1.0 - part;
                }
                Share::Rest => return if is_wanted { cut.give(component, density, region) } else { Ok(()) },
                Share::Below(half_space) => {
                    let half_space = half_space.translated(&to_mesh);
                    let goes_on = shares[place + 1..].iter().flatten().any(|&(later, _)| later != left_out);
                    let side = match (is_wanted, goes_on) {
                        (true, true) => region.split(&half_space, below, spare)?,
                        (true, false) => region.cut(&half_space, below)?,
                        (false, _) => match region.cut(&half_space.complement(), spare)? {
                            Side::Below => Side::Above,
                            Side::Above => Side::Below,
                            Side::Across => Side::Across,
                        },
                    };
                    if is_wanted && side != Side::Above {
                        cut.give(component, density, if side == Side::Below { region } else { below })?;
                    }
                    match side {
                        Side::Below => return Ok(()),
                        Side::Above => {}
                        Side::Across => {
                            std::mem::swap(&mut rest, &mut spare);
                            is_cut = true;
                        }
                    }
                }
            }
        }
        Ok(())
    }
}

/// A piece that comes from outside of the mesh.
fn flowing_in<const D: usize>(volume: f64) -> Piece<D> {
    Piece { donor: None, volume, moment: Vector::zeros() }
}
