//! LVIRA (Puckett 1991; Eq. 85): of all planes that leave the cell its own volume, the one whose truncated volumes match the
//! fractions of the patch best,
//!
//! ```text
//! sum over neighbours of w (V_tr / V - f)^2 -> min,   w = 1 / (|y - y_0|^2 sqrt(f (1 - f) + e)).
//! ```
//!
//! The paper has `w = 1`. Where a curved interface leaves the patch sooner on one side than on the other, its sag on the longer
//! side then turns the plane. These weights let near cells count more, and those that hold little or are nearly full, which the
//! interface only just enters: on circles they halve the error of the normal.
//!
//! Volumes are exact on ruled cells, so planes are reproduced to rounding. Turning the normal by `dm` with the volume of the cell kept
//! moves the plane by `dm.(c_0 - y)` at its point `y`, with the middle `c_0` of the cell's own section; so a neighbour with
//! section area `A` and section middle `c` has `d(V_tr / V)/dm = -(A / V) (c - c_0)`.
//!
//! The misfit has several minima where the patch holds a corner or two interfaces (Sect. 5.1 of the paper), and where the cell is all
//! but full or empty: a plane that has to leave it a tiny part turns about one of its corners, and each corner has a minimum of its own,
//! even for a patch that a single plane cuts. Where the minimum that Youngs' normal leads to is poor, the descent starts again from other
//! guesses, and the least of the minima is taken. One of these guesses is what the descent finds that keeps the volume of the cell of the
//! patch that is nearest to half full, instead of the middle one.

use vofkit_geometry::{Cell, HalfSpace, PositionMethod, Vector};

use super::descent::{Damping, Descent, Sample, descend};
use super::patch::{Met, Patch};
use super::{Around, Direction, Found};
use super::{elvira, least_squares, youngs};
use crate::tolerance::{CELL_PART, MISFIT_NONE, MISFIT_POOR, SPREAD_LEAST, STARTS_APART};

/// The normal of the plane near another one that fits the patch to rounding, if there is one: where the derivatives at the other one
/// leave a misfit, there is none.
pub(super) fn exact<C: Cell<D>, const D: usize>(
    around: &Around<'_, C, D>,
    position: PositionMethod,
    start: &Vector<D>,
) -> Option<Direction<D>> {
    let mut fit = Fit::new(around, position);
    let start = fit.patch.frame.normal(start);
    if !fit.sample(&start, true)?.may_vanish(&start) {
        return None;
    }
    let Descent { normal, misfit, determined, .. } = fit.descend(start)?;
    (determined && misfit <= MISFIT_NONE).then(|| {
        let normal = fit.patch.frame.in_space(&normal);
        Direction { normal, determined, trials: fit.trials }
    })
}

pub(super) fn normal<C: Cell<D>, const D: usize>(
    around: &Around<'_, C, D>,
    position: PositionMethod,
) -> Found<D> {
    let start = youngs::physical(around)?;
    let mut fit = Fit::new(around, position);
    let Some(mut best) = fit.descend(fit.patch.frame.normal(&start.normal)) else {
        return Ok(Direction { determined: false, trials: fit.trials, ..start });
    };
    if best.misfit > MISFIT_POOR * fit.patch.neighbours().count() as f64 {
        // In 3D there are 27 candidates of ELVIRA, and none of them is better than a gradient.
        let elvira = if D == 2 { elvira::best(around, &mut fit).ok() } else { None };
        let guesses = [elvira, least_squares::fitted(&fit.patch).ok()];
        let guesses = guesses.map(|guess| {
            let guess = fit.patch.frame.normal(&guess?.normal);
            (guess.dot(&best.normal) <= STARTS_APART).then_some(guess)
        });
        let fraction = around.fraction();
        let balanced = if fraction.min(1.0 - fraction) < CELL_PART {
            fit.descend_keeping(fit.most_balanced(), best.normal)
        } else {
            None
        };
        for guess in guesses.into_iter().chain([balanced.map(|found| found.normal)]).flatten() {
            match fit.descend(guess) {
                Some(descent) if descent.misfit < best.misfit => best = descent,
                _ => {}
            }
        }
    }
    let normal = if best.determined { fit.patch.frame.in_space(&best.normal) } else { start.normal };
    Ok(Direction { normal, determined: best.determined, trials: fit.trials })
}

/// The misfit of planes over one patch.
pub(super) struct Fit<C, const D: usize> {
    pub(super) patch: Patch<C, D>,
    position: PositionMethod,
    /// The place of the cell whose volume is kept.
    kept: usize,
    /// Square roots of the weights by place.
    weights: [f64; 27],
    /// Derivatives by place, as far as they were computed.
    slopes: [Vector<D>; 27],
    /// Plane constants found.
    pub(super) trials: usize,
}

impl<C: Cell<D>, const D: usize> Fit<C, D> {
    pub(super) fn new(around: &Around<'_, C, D>, position: PositionMethod) -> Self {
        let patch = Patch::new(around);
        let mut weights = [0.0; 27];
        let middle = patch.middle(Patch::<C, D>::MIDDLE);
        for place in patch.neighbours() {
            let f = patch.fraction(place);
            let spread = (f * (1.0 - f) + SPREAD_LEAST).sqrt();
            weights[place] = (spread.sqrt() * (patch.middle(place) - middle).norm()).recip();
        }
        Self {
            patch,
            position,
            kept: Patch::<C, D>::MIDDLE,
            weights,
            slopes: [Vector::zeros(); 27],
            trials: 0,
        }
    }

    /// Descends from a normal of the frame.
    fn descend(&mut self, start: Vector<D>) -> Option<Descent<D>> {
        descend(start, Damping::Alike, |normal, fresh| self.sample(normal, fresh))
    }

    /// The same among the planes that leave the cell at another place its volume.
    fn descend_keeping(&mut self, place: usize, start: Vector<D>) -> Option<Descent<D>> {
        let own = std::mem::replace(&mut self.kept, place);
        let descent = self.descend(start);
        self.kept = own;
        descent
    }

    /// The place of the cell that is nearest to half full.
    fn most_balanced(&self) -> usize {
        let off = |place: &usize| (self.patch.fraction(*place) - 0.5).abs();
        let places = self.patch.neighbours();
        places.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(self.kept)
    }

    /// The plane with a normal of the frame that leaves the cell its volume.
    fn place(&mut self, normal: &Vector<D>) -> Option<HalfSpace<D>> {
        self.trials += 1;
        let fraction = self.patch.fraction(self.kept);
        let cell = self.patch.cell(self.kept);
        let constant = cell.plane_constant(normal, fraction, self.position).ok()?.constant;
        Some(HalfSpace { normal: *normal, constant })
    }

    /// The misfit alone, for a normal of the frame.
    pub(super) fn misfit(&mut self, normal: &Vector<D>) -> Option<f64> {
        let plane = self.place(normal)?;
        let heights = self.patch.heights(&plane);
        let mut misfit = 0.0;
        for place in self.patch.neighbours() {
            let truncated = match self.patch.meet(place, &heights) {
                Met::Not(fraction) => fraction,
                Met::Crossed => {
                    let cell = self.patch.cell(place);
                    cell.truncate(&plane).volume / cell.volume()
                }
            };
            misfit += (self.weights[place] * (truncated - self.patch.fraction(place))).powi(2);
        }
        Some(misfit)
    }

    fn sample(&mut self, normal: &Vector<D>, fresh: bool) -> Option<Sample<D>> {
        let plane = self.place(normal)?;
        let heights = self.patch.heights(&plane);
        let middle = if fresh { Some(self.patch.cell(self.kept).section_centroid(&plane)?) } else { None };
        let mut sample = Sample::default();
        for place in self.patch.neighbours() {
            let (truncated, slope) = match self.patch.meet(place, &heights) {
                Met::Not(fraction) => (fraction, Vector::zeros()),
                Met::Crossed => {
                    let cell = self.patch.cell(place);
                    let (part, volume) = (cell.truncate(&plane), cell.volume());
                    if let Some(middle) = middle {
                        let arm = cell.section_centroid(&plane).map_or_else(Vector::zeros, |c| middle - c);
                        self.slopes[place] = arm * (part.section_area / volume);
                    }
                    (part.volume / volume, self.slopes[place])
                }
            };
            let weight = self.weights[place];
            sample.add(weight * (truncated - self.patch.fraction(place)), &(slope * weight));
        }
        Some(sample)
    }
}
