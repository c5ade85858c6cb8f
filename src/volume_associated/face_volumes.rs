//! The volumes that cross all faces, and the parts of them that the sweeps of a step take.

use super::runs::Lines;
use crate::mesh::{Grid, SweptVolumes};
use crate::parallel;
use crate::velocity::StepFluxes;

/// The volume that crosses each face towards higher indices, by the axis that the face lies across.
#[derive(Clone, Debug)]
pub struct FaceVolumes<const D: usize> {
    pub(super) through: [Vec<f64>; D],
}

impl<const D: usize> FaceVolumes<D> {
    /// Nothing crosses any face.
    pub fn zero(grid: &Grid<D>) -> Self {
        Self { through: std::array::from_fn(|axis| vec![0.0; Lines::new(grid, axis).faces()]) }
    }

    /// The volumes of a step in flow mode.
    pub fn set_flow(&mut self, grid: &Grid<D>, fluxes: &StepFluxes<'_, D>) {
        self.fill(grid, |axis, at| fluxes.through(at, axis, 0));
    }

    /// What the faces of a moving mesh sweep in a step.
    pub fn set_swept(&mut self, grid: &Grid<D>, swept: &SweptVolumes<D>) {
        self.fill(grid, |axis, at| swept.through(at, axis, 0));
    }

    fn fill(&mut self, grid: &Grid<D>, volume: impl Fn(usize, [usize; D]) -> f64 + Sync + Send) {
        let cells = grid.cells();
        for (axis, through) in self.through.iter_mut().enumerate() {
            let mut extent = cells;
            extent[axis] += 1;
            parallel::for_each_chunk(through, extent[0], |row, faces| {
                let mut rest = row;
                let mut at = [0; D];
                for k in 1..D {
                    at[k] = rest % extent[k];
                    rest /= extent[k];
                }
                for (i, face) in faces.iter_mut().enumerate() {
                    at[0] = i;
                    *face = volume(axis, at);
                }
            });
        }
    }
}

/// The order of the sweeps of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Splitting {
    /// All faces at once: no sweeps.
    Isotropic,
    /// One sweep along each axis, in an order that changes from step to step.
    #[default]
    Alternating,
    /// Half a sweep along each axis but the last one, a whole one along that, and the halves backwards (Strang 1968): second order.
    Symmetric,
}

/// One pass of a step: the axes whose faces are crossed, and the part of their volumes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pass {
    /// The first axis.
    pub(super) first: usize,
    /// The number of axes: 1 or all.
    pub(super) count: usize,
    /// The part of the volumes of the step: a half is exact.
    pub(super) part: f64,
}

impl Pass {
    pub(super) fn axes(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.count
    }
}

impl Splitting {
    /// The passes of a step whose sweeps follow `order`.
    pub(super) fn passes<const D: usize>(self, order: [usize; D]) -> impl Iterator<Item = Pass> {
        let last = D - 1;
        let along = |axis: usize, part: f64| Pass { first: axis, count: 1, part };
        let count = match self {
            Self::Isotropic => 1,
            Self::Alternating => D,
            Self::Symmetric => 2 * D - 1,
        };
        (0..count).map(move |i| match self {
            Self::Isotropic => Pass { first: 0, count: D, part: 1.0 },
            Self::Alternating => along(order[i], 1.0),
            Self::Symmetric if i == last => along(order[last], 1.0),
            Self::Symmetric => along(order[i.min(2 * last - i)], 0.5),
        })
    }
}
