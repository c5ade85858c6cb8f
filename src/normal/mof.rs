//! Moment of fluid (Dyadechko & Shashkov 2005): the plane that leaves the cell its volume with the centroid nearest to the
//! material's own,
//!
//! ```text
//! |c(m) - c_ref|^2 -> min,
//! ```
//!
//! in the frame of the cell. It looks at no neighbour. Derivatives are differences over a small turn.

use vofkit_geometry::{Cell, HalfSpace, PositionMethod, Vector};

use super::descent::{Sample, descend};
use super::frame::Frame;
use super::youngs;
use super::{Around, Direction, Found, NoNormal};
use crate::tolerance::CENTROID_TURN;

pub(super) fn normal<C: Cell<D>, const D: usize>(
    around: &Around<'_, C, D>,
    position: PositionMethod,
) -> Found<D> {
    let centroids = around.material.centroids.ok_or(NoNormal::NoCentroid)?;
    let frame = Frame::new(around.cell);
    let anchor = around.material.mesh.anchor(around.index);
    let corner = |at: [usize; D]| around.cell.map(&Vector::from_fn(|k, _| at[k] as f64));
    let unit = C::from_corners(|at| frame.point(&corner(at)));
    let mut fit = Fit {
        fraction: around.fraction(),
        wanted: frame.point(&(centroids[around.index] - anchor)),
        unit,
        position,
        slopes: [Vector::zeros(); D],
        trials: 0,
    };
    // From the material's middle to the cell's the way leads out of the material.
    let outward = fit.middle() - fit.wanted;
    let mut starts = Vec::new();
    if outward.norm() > 0.0 {
        starts.push(outward.normalize());
    }
    if let Ok(direction) = youngs::physical(around) {
        starts.push(frame.normal(&direction.normal));
    }
    let descents = starts.into_iter().filter_map(|start| descend(start, |m, fresh| fit.sample(m, fresh)));
    let best = descents.reduce(|a, b| if b.misfit < a.misfit { b } else { a });
    let best = best.ok_or(NoNormal::Balanced)?;
    let normal = frame.in_space(&best.normal);
    Ok(Direction { normal, determined: best.determined, trials: fit.trials })
}

/// The misfit of centroids in one cell.
struct Fit<C, const D: usize> {
    /// The cell in its frame.
    unit: C,
    fraction: f64,
    wanted: Vector<D>,
    position: PositionMethod,
    /// Derivatives of each component of the centroid, as far as they were computed.
    slopes: [Vector<D>; D],
    trials: usize,
}

impl<C: Cell<D>, const D: usize> Fit<C, D> {
    /// The centroid of the whole cell.
    fn middle(&self) -> Vector<D> {
        let everything = HalfSpace { normal: Vector::zeros(), constant: 1.0 };
        self.unit.first_moment(&everything) / self.unit.volume()
    }

    /// The centroid of what the plane with this normal leaves.
    fn centroid(&mut self, normal: &Vector<D>) -> Option<Vector<D>> {
        self.trials += 1;
        let constant = self.unit.plane_constant(normal, self.fraction, self.position).ok()?.constant;
        let moment = self.unit.first_moment(&HalfSpace { normal: *normal, constant });
        Some(moment / (self.fraction * self.unit.volume()))
    }

    fn sample(&mut self, normal: &Vector<D>, fresh: bool) -> Option<Sample<D>> {
        let centroid = self.centroid(normal)?;
        if fresh {
            self.slopes = [Vector::zeros(); D];
            for turn in turns(normal).into_iter().flatten() {
                let turned = self.centroid(&(normal + turn * CENTROID_TURN).normalize())?;
                let change = (turned - centroid) / CENTROID_TURN;
                for (slope, change) in self.slopes.iter_mut().zip(change.iter()) {
                    *slope += turn * *change;
                }
            }
        }
        let mut sample = Sample::default();
        for (residual, slope) in (centroid - self.wanted).iter().zip(&self.slopes) {
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
