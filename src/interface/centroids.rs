//! Order and normals of cuts by the centroids of what is cut (nested dissection by moment of fluid, Dyadechko & Shashkov 2008).
//!
//! Of what waits, each is fitted to what is left of the cell: of the planes that leave it its volume, the one with the centroid `c` nearest
//! to its own. The one with the least misfit
//!
//! ```text
//! |c - c_ref|^2 / f^(2 / D),
//! ```
//!
//! relative to the size of the material's part, is cut next, the one listed first among equals; with [`Materials::Listed`] the first of the list
//! that has a plane. So straight interfaces that end at one another are reproduced, and films are cut from either side. (Dyadechko and Shashkov
//! try all orders; this is the best next one at a time.) Void has the centroid that the materials leave it:
//!
//! ```text
//! f_void c_void = c_cell - sum f_k c_k
//! ```

use std::cell::RefCell;

use vofkit_geometry::clip::{Moments, Region, Side};
use vofkit_geometry::root::Root;
use vofkit_geometry::{Cell, HalfSpace, Vector};

use super::Materials;
use super::nested::{Chosen, Dissector, RegionOf, Shared};
use crate::normal::frame::Frame;
use crate::normal::mof::{self, Fitted};
use crate::normal::{Direction, NoNormal};
use crate::tolerance::MISFIT_EQUAL;

impl<C: Cell<D>, const D: usize> Dissector<C, D> {
    /// Gives all that waits in a cell its centroid; nothing is cut yet.
    pub(super) fn know_centroids(&mut self, shared: &Shared<'_, C, D>, frame: &Frame<D>) {
        let Some(centroids) = shared.parts.centroids else { return };
        let anchor = shared.mesh.anchor(shared.index);
        let of_material = |material: usize| {
            let centroid = centroids.get(material)?.get(shared.index)?;
            centroid.iter().all(|c| c.is_finite()).then(|| frame.point(&(centroid - anchor)))
        };
        let whole = moments(self.rest.iter().map(|(_, region)| region.moments()));
        let mut left = Some(whole.first / whole.volume);
        for waiting in &mut self.queue.waiting {
            waiting.centroid = match waiting.material {
                Some(material) => of_material(material),
                // It comes last.
                None => left.map(|first| first / waiting.fraction),
            };
            left = left.zip(waiting.centroid).map(|(left, centroid)| left - centroid * waiting.fraction);
        }
    }

    /// What is cut next from the rest; none where nothing that waits has a plane.
    pub(super) fn choose_by_centroid(&mut self) -> Option<Chosen<D>> {
        let rest = moments(self.rest.iter().map(|(_, region)| region.moments()));
        let middle = rest.first / rest.volume;
        let (mut best, mut all_trials) = (None::<(Chosen<D>, f64)>, 0);
        for place in 0..self.queue.waiting.len() {
            let fitted = self.fitted(place, &middle);
            let waiting = &mut self.queue.waiting[place];
            // What has no plane now may have one in what is left later.
            waiting.refused = fitted.as_ref().err().copied();
            let Ok(Fitted { normal, misfit, determined, trials }) = fitted else { continue };
            all_trials += trials;
            let misfit = misfit / waiting.fraction.powf(2.0 / D as f64);
            if best.as_ref().is_none_or(|(_, least)| misfit < *least - MISFIT_EQUAL) {
                best =
                    Some((Chosen { place, direction: Direction { normal, determined, trials: 0 } }, misfit));
            }
            if self.queue.order == Materials::Listed {
                break;
            }
        }
        best.map(|(Chosen { place, direction }, _)| {
            let direction = Direction { trials: all_trials, ..direction };
            Chosen { place, direction }
        })
    }

    /// The plane that suits one that waits best, in what is left around a `middle`.
    fn fitted(&self, place: usize, middle: &Vector<D>) -> Result<Fitted<D>, NoNormal> {
        let wanted = self.queue.waiting[place].centroid.ok_or(NoNormal::NoCentroid)?;
        let share = self.queue.share(place);
        let spare = RefCell::new(RegionOf::<C, D>::empty());
        let below = |normal: &Vector<D>| {
            let Root { position, .. } = self.position(normal, share);
            let half_space = HalfSpace { normal: *normal, constant: position };
            let of_piece = |(_, region): &(usize, RegionOf<C, D>)| {
                moments_below(region, &half_space, &mut spare.borrow_mut())
            };
            let Moments { volume, first } = moments(self.rest.iter().map(of_piece));
            (volume > 0.0).then(|| first / volume)
        };
        let start = (middle - wanted).try_normalize(0.0);
        mof::fit(start, &wanted, share, below).ok_or(NoNormal::Balanced)
    }
}

/// The sum of some moments.
fn moments<const D: usize>(all: impl Iterator<Item = Moments<D>>) -> Moments<D> {
    let nothing = Moments { volume: 0.0, first: Vector::zeros() };
    all.fold(nothing, |sum, m| Moments { volume: sum.volume + m.volume, first: sum.first + m.first })
}

/// The moments of the part of a region in a half-space.
fn moments_below<R: Region<D>, const D: usize>(
    region: &R,
    half_space: &HalfSpace<D>,
    part: &mut R,
) -> Moments<D> {
    match region.cut(half_space, part) {
        Ok(Side::Below) => region.moments(),
        Ok(Side::Above) => Moments { volume: 0.0, first: Vector::zeros() },
        Ok(Side::Across) => part.moments(),
        Err(_) => {
            let mut all = Vec::new();
            region.simplices(&mut |simplex| all.push(moments_below(simplex, half_space, part)));
            moments(all.into_iter())
        }
    }
}
