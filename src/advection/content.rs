//! What a region holds of each material, wherever it lies in a mesh: the region cut by every cell that it meets and by the planes
//! in that cell.
//!
//! The parts of a region are taken from the cells' [tiles](vofkit_geometry::clip::tile), which fill the mesh, and the materials and
//! the void of a cell fill its tile. So what the materials and the void have of a region adds up to the region, to rounding. The
//! one that takes most work is therefore found as what the others leave; and a region that meets one of them alone needs no cut.

use vofkit_geometry::clip::{Full, Region, Side, Tile, Workspace, bounds};
use vofkit_geometry::{Cell, Vector};

use super::nested::Nested;
use crate::interface::{RegionOf, Share};
use crate::mesh::Mesh;
use crate::mesh::locate::{Candidate, Locator};

/// A mesh with its materials before a step.
pub(super) struct Source<'a, C, const D: usize> {
    pub(super) mesh: &'a Mesh<C, D>,
    pub(super) locator: &'a Locator<D>,
    pub(super) fractions: &'a [Vec<f64>],
    pub(super) nested: &'a Nested<D>,
    /// The material outside the mesh; none for void.
    pub(super) outside: Option<usize>,
}

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
}

impl<C: Cell<D>, const D: usize> Cut<'_, C, D> {
    /// Gives a component what a region has in common with the cell.
    fn give(&mut self, component: usize, density: f64, region: &RegionOf<C, D>) -> Result<(), Full> {
        let mut volume = 0.0;
        self.tile.common(region, self.work, &mut |sign, part| volume += sign * part.volume())?;
        self.amounts[component] += density * volume;
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

    /// The volume of each material in `region`, whose points are relative to `origin` and whose volume is `whole`.
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
            if let Some(component) = pure.iter().position(|&count| count > 0)
                && component < void
            {
                contents[component] = whole;
            }
            return Ok(Held::One);
        }
        // What lies outside is found as what does not lie inside.
        let most = (0..=void).max_by_key(|&component| pure[component]);
        let left_out = outside.or(most).unwrap_or(void);
        scratch.begin(void + 1);
        if self.add(region, origin, left_out, scratch).is_err() {
            scratch.begin(void + 1);
            let mut result = Ok(());
            region.simplices(&mut |simplex| {
                if result.is_ok() {
                    result = self.add(simplex, origin, left_out, scratch);
                }
            });
            result?;
        }
        let amounts = &scratch.amounts;
        contents.copy_from_slice(&amounts[..void]);
        if left_out < void {
            contents[left_out] = whole - amounts.iter().sum::<f64>();
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
    ) -> Result<(), Full> {
        let Scratch { candidates, amounts, parts, work, .. } = scratch;
        for candidate in &*candidates {
            let pure = self.pure(candidate.cell);
            if pure == Some(left_out) {
                continue;
            }
            let shift = candidate.shift - origin;
            let tile = C::Tile::new(&self.mesh.shifted_cell(candidate.cell, &shift));
            let mut cut = Cut::<C, D> { tile, work, amounts };
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
