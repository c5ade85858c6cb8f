//! Moment of fluid (Dyadechko & Shashkov 2005, in the plane; Ahn & Shashkov 2007, in space): of the planes that leave a material its
//! volume, the one whose centroid `c` is nearest to the material's own,
//!
//! ```text
//! |c(m) - c_ref|^2 -> min,
//! ```
//!
//! in the frame of the cell. No fractions of neighbours enter the misfit, so that it is as good at walls, corners and films as anywhere; planes
//! are reproduced. What lies on the other side has the centroid `c'` with `f c + (1 - f) c' = const`: its misfit is the same but for a
//! factor, and the misfit of the smaller part is the one that is taken,
//!
//! ```text
//! r = (c - c_ref) max(1, f / (1 - f)),
//! ```
//!
//! since the other one is all rounding where next to nothing is missing. Derivatives are differences over a small turn.

use vofkit_geometry::{Cell, HalfSpace, PositionMethod, Vector};

use super::descent::{Damping, Descent, Sample, descend};
use super::frame::Frame;
use super::youngs;
use super::{Around, Direction, Found, NoNormal};
use crate::tolerance::{CENTROID_DESCENTS, CENTROID_NEAR, CENTROID_TURN};

pub(super) fn normal<C: Cell<D>, const D: usize>(
    around: &Around<'_, C, D>,
    position: PositionMethod,
) -> Found<D> {
    let given = around.material.centroids.and_then(|centroids| centroids.get(around.index));
    let centroid = given.filter(|centroid| centroid.iter().all(|c| c.is_finite()));
    let centroid = centroid.ok_or(NoNormal::NoCentroid)?;
    let frame = Frame::new(around.cell);
    let corner = |at: [usize; D]| around.cell.map(&Vector::from_fn(|k, _| at[k] as f64));
    let unit = C::from_corners(|at| frame.point(&corner(at)));
    let (volume, fraction) = (unit.volume(), around.fraction());
    let wanted = frame.point(&(centroid - around.material.mesh.anchor(around.index)));
    let everything = HalfSpace { normal: Vector::zeros(), constant: 1.0 };
    let middle = unit.first_moment(&everything) / volume;
    let gradient = youngs::physical(around).ok().map(|direction| frame.normal(&direction.normal));
    let below = |normal: &Vector<D>| {
        let constant = unit.plane_constant(normal, fraction, position).ok()?.constant;
        Some(unit.first_moment(&HalfSpace { normal: *normal, constant }) / (fraction * volume))
    };
    // From the material's middle to the cell's the way leads out of the material.
    let outward = (middle - wanted).try_normalize(0.0);
    let (sign, smaller) = match fraction <= 0.5 {
        true => (1.0, wanted),
        false => (-1.0, (middle - wanted * fraction) / (1.0 - fraction)),
    };
    let cuts = cuts(&unit, &smaller).map(|normal| normal.map(|normal| normal * sign));
    let starts = cuts.into_iter().chain([outward, gradient]).flatten();
    let fitted = fit(starts, &wanted, fraction, below).ok_or(NoNormal::Balanced)?;
    let Fitted { normal, determined, trials, .. } = fitted;
    Ok(Direction { normal: frame.in_space(&normal), determined, trials })
}

/// The normals of the planes that cut off the corner of a cell next to a centroid, the edge and the face. What a plane cuts off a corner with
/// edges along `e_k` is a simplex with the centroid `sum w_k e_k`, and meets the edges at `(D + 1) w_k`, so that
///
/// ```text
/// n.e_k = 1 / w_k
/// ```
///
/// up to a factor. The part along an edge or a face of the corner is a prism, and `n.e_k = 0` where `w_k` is largest. So one of them is next
/// to the plane of a small part, whose misfit has long valleys that lead there from nowhere else.
fn cuts<C: Cell<D>, const D: usize>(cell: &C, centroid: &Vector<D>) -> [Option<Vector<D>>; D] {
    let node = |at: &[usize; D]| cell.map(&Vector::from_fn(|k, _| at[k] as f64));
    let distance = |at: &[usize; D]| (node(at) - centroid).norm_squared();
    let Some(nearest) = C::OFFSETS.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
        return [None; D];
    };
    let corner = node(nearest);
    let edges: [Vector<D>; D] = std::array::from_fn(|axis| {
        let mut end = *nearest;
        end[axis] = 1 - end[axis];
        node(&end) - corner
    });
    let around = C::from_corners(|at| (0..D).map(|axis| edges[axis] * at[axis] as f64).sum());
    let mut along = Frame::new(&around).point(&(centroid - corner)).map(|part| part.abs().recip());
    std::array::from_fn(|_| {
        let normal = around.physical_gradient(&along);
        let least = (0..D).filter(|&k| along[k] > 0.0).min_by(|&a, &b| along[a].total_cmp(&along[b]));
        least.into_iter().for_each(|k| along[k] = 0.0);
        let normal = normal / normal.amax();
        normal.iter().all(|n| n.is_finite()).then(|| normal.normalize())
    })
}

/// The plane whose centroid is nearest to a given one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fitted<const D: usize> {
    pub(crate) normal: Vector<D>,
    /// `|c - c_ref|^2`.
    pub(crate) misfit: f64,
    /// Whether the misfit rises in every direction from there.
    pub(crate) determined: bool,
    /// Centroids computed on the way.
    pub(crate) trials: usize,
}

/// Searches, from some unit normals, the best first, for the one with the centroid nearest to `wanted`; those that are left are of use
/// where it is not near. `centroid` is that of the part below the
/// plane with a normal that leaves a `share` of the whole below it; none where there is no such plane.
pub(crate) fn fit<const D: usize>(
    starts: impl IntoIterator<Item = Vector<D>>,
    wanted: &Vector<D>,
    share: f64,
    centroid: impl FnMut(&Vector<D>) -> Option<Vector<D>>,
) -> Option<Fitted<D>> {
    let factor = (share / (1.0 - share)).max(1.0);
    let mut search = Search { wanted, factor, centroid, slopes: [Vector::zeros(); D], trials: 0 };
    let judged = starts.into_iter().filter_map(|start| Some((start, search.sample(&start, false)?.misfit)));
    let mut judged: Vec<(Vector<D>, f64)> = judged.collect();
    judged.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    let size = share.min(1.0 - share).powf(1.0 / D as f64);
    let mut best: Option<Descent<D>> = None;
    for (start, _) in judged {
        let found = search.descent(start)?;
        if best.is_none_or(|best| found.misfit < best.misfit) {
            best = Some(found);
        }
        if found.misfit <= (CENTROID_NEAR * size).powi(2) {
            break;
        }
    }
    let Descent { normal, misfit, determined, .. } = best?;
    Some(Fitted { normal, misfit: misfit / (factor * factor), determined, trials: search.trials })
}

struct Search<'a, F, const D: usize> {
    wanted: &'a Vector<D>,
    /// What makes the misfit that of the smaller part.
    factor: f64,
    centroid: F,
    /// Derivatives of each component of the centroid, as far as they were computed.
    slopes: [Vector<D>; D],
    trials: usize,
}

impl<F: FnMut(&Vector<D>) -> Option<Vector<D>>, const D: usize> Search<'_, F, D> {
    fn centroid(&mut self, normal: &Vector<D>) -> Option<Vector<D>> {
        self.trials += 1;
        (self.centroid)(normal)
    }

    /// The end of the descent from a normal.
    fn descent(&mut self, start: Vector<D>) -> Option<Descent<D>> {
        let mut found = descend(start, Damping::Scaled, |m, fresh| self.sample(m, fresh))?;
        for _ in 1..CENTROID_DESCENTS {
            if found.arrived {
                break;
            }
            found = descend(found.normal, Damping::Scaled, |m, fresh| self.sample(m, fresh))?;
        }
        Some(found)
    }

    fn sample(&mut self, normal: &Vector<D>, fresh: bool) -> Option<Sample<D>> {
        let centroid = self.centroid(normal)?;
        if fresh {
            self.slopes = [Vector::zeros(); D];
            for turn in turns(normal).into_iter().flatten() {
                let turned = self.centroid(&(normal + turn * CENTROID_TURN).normalize())?;
                let change = (turned - centroid) * (self.factor / CENTROID_TURN);
                for (slope, change) in self.slopes.iter_mut().zip(change.iter()) {
                    *slope += turn * *change;
                }
            }
        }
        let mut sample = Sample::default();
        for (residual, slope) in ((centroid - self.wanted) * self.factor).iter().zip(&self.slopes) {
            sample.add(*residual, slope);
        }
        Some(sample)
    }
}

/// Unit vectors across a normal and each other; one of the `D` is missing.
fn turns<const D: usize>(normal: &Vector<D>) -> [Option<Vector<D>>; D] {
    let mut turns = [None; D];
    for axis in (0..D).filter(|&axis| axis != normal.iamax()) {
        let mut turn = Vector::from_fn(|k, _| f64::from(u8::from(k == axis))) - normal * normal[axis];
        for other in turns.iter().flatten() {
            turn -= other * turn.dot(other);
        }
        turns[axis] = Some(turn.normalize());
    }
    turns
}
