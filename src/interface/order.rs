//! Which material is cut next from a cell, and the fractions that its normal is found from.
//!
//! What is gone from a cell does not say how the rest of it is divided. So the normal of a material is found from `f + r g`, where `g` is
//! the fraction that is *set aside* and `r` the part that the material has of what is left of the cell: as if what is set aside
//! were filled with the mixture of the rest. What was cut before is set aside or counts as not being the material, whichever fits better:
//! behind a film the material in front of it says nothing of the interface, while bodies that touch each have a shape of their own. So
//! it is with what only the cells around hold: where the interface of two materials ends at a third one, the third says nothing
//! of it; where it goes on as that of the first and the third, it does.
//!
//! **Fit.** On the logical grid, where all cells are unit cubes, the plane with the gradient of `f + r g` leaves a part `t` of each
//! cell around, and should leave `f`, but for what is set aside: the misfit is the sum of `((1 - g) t - f)^2`. It vanishes
//! for a half-space, and for one that is covered in part by materials cut before. What is set aside need not be fitted, so it
//! has to leave a much smaller misfit to be preferred.

use vofkit_geometry::{Cell, HalfSpace, PositionMethod, Vector};

use super::sharing::Materials;
use crate::mesh::Grid;
use crate::normal::{NoNormal, Stencil};
use crate::tolerance::{ASIDE_MISFIT, MISFIT_EQUAL};

/// A material of a cell that has not been cut yet.
#[derive(Clone, Debug)]
pub(super) struct Waiting<const D: usize> {
    /// The material; none for void.
    pub(super) material: Option<usize>,
    pub(super) fraction: f64,
    stencil: Stencil<D>,
    /// Its centroid in the frame of the cell, where it is known.
    pub(super) centroid: Option<Vector<D>>,
    /// Why the method has no normal for it.
    pub(super) refused: Option<NoNormal>,
}

/// The material that is cut next.
#[derive(Clone, Debug)]
pub(super) struct Next<const D: usize> {
    /// Its place among those that wait.
    pub(super) place: usize,
    /// The fractions that its normal is to be found from.
    pub(super) sought: Stencil<D>,
    /// Whether these are its own alone.
    pub(super) is_alone: bool,
}

/// The materials of a cell that have not been cut yet.
#[derive(Clone, Debug)]
pub(super) struct Queue<C, const D: usize> {
    pub(super) waiting: Vec<Waiting<D>>,
    /// The fraction of the cell that is left.
    left: f64,
    /// Whether nothing but what waits is left.
    complete: bool,
    /// What was cut before, as fractions of the cell and those around.
    cut: Stencil<D>,
    /// What only the cells around hold.
    absent: Stencil<D>,
    pub(super) order: Materials,
    unit: C,
}

impl<C: Cell<D>, const D: usize> Queue<C, D> {
    /// An empty queue, to be filled.
    pub(super) fn new() -> Self {
        Self {
            waiting: Vec::new(),
            left: 0.0,
            complete: true,
            cut: Stencil::uniform(0.0),
            absent: Stencil::uniform(0.0),
            order: Materials::Nested,
            unit: C::from_corners(|offset| Vector::from_fn(|axis, _| offset[axis] as f64)),
        }
    }

    /// Starts with all that the cell with this index holds, void among it where the order is free.
    pub(super) fn fill(
        &mut self,
        grid: &Grid<D>,
        fractions: &[Vec<f64>],
        void: f64,
        index: usize,
        order: Materials,
    ) {
        let offset = grid.offset(index);
        self.order = order;
        self.complete = void == 0.0 || order == Materials::Nested;
        self.cut = Stencil::uniform(0.0);
        self.absent = Stencil::uniform(1.0);
        self.waiting.clear();
        let mut around = Stencil::uniform(1.0);
        for (material, f) in fractions.iter().enumerate() {
            let stencil = Stencil::new(grid, f, offset);
            around = around.plus(&stencil, -1.0);
            if f[index] > 0.0 {
                self.absent = self.absent.plus(&stencil, -1.0);
                self.push(Some(material), f[index], stencil);
            }
        }
        self.left = void + self.waiting.iter().map(|waiting| waiting.fraction).sum::<f64>();
        if void > 0.0 {
            self.absent = self.absent.plus(&around, -1.0);
            if order == Materials::Nested {
                self.push(None, void, around);
            }
        }
    }

    fn push(&mut self, material: Option<usize>, fraction: f64, stencil: Stencil<D>) {
        self.waiting.push(Waiting { material, fraction, stencil, centroid: None, refused: None });
    }

    /// The part that a waiting material has of what is left of the cell.
    pub(super) fn share(&self, place: usize) -> f64 {
        if self.is_settled() { 1.0 } else { (self.waiting[place].fraction / self.left).min(1.0) }
    }

    /// Whether a single material takes what is left.
    pub(super) fn is_settled(&self) -> bool {
        self.waiting.len() == 1 && self.complete
    }

    /// What is cut next; none where no material has a direction.
    pub(super) fn next(&self) -> Option<Next<D>> {
        let mut best: Option<(Next<D>, f64)> = None;
        let is_cut = self.cut.largest() > 0.0;
        let alone = is_cut.then(|| Stencil::uniform(0.0));
        let asides = [Some(self.cut), Some(self.cut.plus(&self.absent, 1.0)), alone];
        // The fractions of a material alone are the first or the last of these.
        let is_alone = [!is_cut, false, true];
        for (place, waiting) in self.waiting.iter().enumerate().filter(|(_, w)| w.refused.is_none()) {
            for (aside, is_alone) in asides.iter().zip(is_alone) {
                let Some(aside) = aside else { continue };
                let sought = waiting.stencil.plus(aside, self.share(place));
                if let Some(misfit) = self
                    .misfit(&waiting.stencil, aside, &sought)
                    .map(|misfit| if is_alone { misfit } else { ASIDE_MISFIT * misfit })
                    && best.as_ref().is_none_or(|(_, least)| misfit < *least - MISFIT_EQUAL)
                {
                    best = Some((Next { place, sought, is_alone }, misfit));
                }
            }
            if self.order == Materials::Listed && best.is_some() {
                break;
            }
        }
        best.map(|(next, _)| next)
    }

    fn misfit(&self, own: &Stencil<D>, aside: &Stencil<D>, sought: &Stencil<D>) -> Option<f64> {
        let normal = -sought.slopes().ok()?.normalize();
        let fraction = sought.middle().clamp(0.0, 1.0);
        let constant = self.unit.plane_constant(&normal, fraction, PositionMethod::Auto).ok()?.constant;
        let of_cell = |((step, own), (_, aside)): (([isize; D], f64), (_, f64))| {
            let step = Vector::from_fn(|axis, _| step[axis] as f64);
            let half_space = HalfSpace { normal, constant: constant - normal.dot(&step) };
            ((1.0 - aside) * self.unit.truncate(&half_space).volume - own).powi(2)
        };
        Some(own.iter().zip(aside.iter()).map(of_cell).sum())
    }

    /// Removes a material that was cut.
    pub(super) fn remove(&mut self, place: usize) {
        let Waiting { fraction, stencil, .. } = self.waiting.remove(place);
        self.cut = self.cut.plus(&stencil, 1.0);
        self.left -= fraction;
    }
}
