//! The fractions around a cell.

use vofkit_geometry::Vector;

use super::{NoNormal, youngs};
use crate::mesh::Grid;
use crate::tolerance::GRADIENT_FLAT;

/// The fractions of one material in the 3^D cells around a cell. Beyond a wall or an open end stands the mirror image of the
/// first layer inside.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<const D: usize> {
    /// By `sum (step_k + 1) 3^k`; the first `3^D` are used.
    pub(super) values: [f64; 27],
}

/// Cells of the stencil.
pub(super) const fn stencil_cells(dimension: usize) -> usize {
    3_usize.pow(dimension as u32)
}

impl<const D: usize> Stencil<D> {
    /// Collects the stencil of the cell at `offset`.
    pub fn new(grid: &Grid<D>, fractions: &[f64], offset: [usize; D]) -> Self {
        let cells = grid.cells();
        let mut values = [0.0; 27];
        let inner = (0..D).all(|k| offset[k] > 0 && offset[k] + 1 < cells[k]);
        let slots = &mut values[..stencil_cells(D)];
        if inner {
            // Inside, the cells of the stencil lie in rows of three.
            let lowest = grid.index(offset.map(|at| at - 1));
            for (row, slots) in slots.chunks_exact_mut(3).enumerate() {
                let start: usize = (1..D).map(|k| row / 3_usize.pow(k as u32 - 1) % 3 * grid.stride(k)).sum();
                slots.copy_from_slice(&fractions[lowest + start..lowest + start + 3]);
            }
        } else {
            for (place, slot) in slots.iter_mut().enumerate() {
                *slot = fractions[grid.index(grid.stepped(offset, step_of::<D>(place)))];
            }
        }
        Self { values }
    }

    /// The values with the step that leads to each of them.
    pub fn iter(&self) -> impl Iterator<Item = ([isize; D], f64)> + '_ {
        self.values[..stencil_cells(D)].iter().enumerate().map(|(place, &f)| (step_of::<D>(place), f))
    }

    /// The same value everywhere.
    pub fn uniform(value: f64) -> Self {
        Self { values: [value; 27] }
    }

    /// The value of the cell itself.
    pub fn middle(&self) -> f64 {
        self.values[stencil_cells(D) / 2]
    }

    /// The sum with a multiple of another stencil.
    pub fn plus(mut self, other: &Self, factor: f64) -> Self {
        self.values.iter_mut().zip(&other.values).for_each(|(value, other)| *value += other * factor);
        self
    }

    /// The gradient in cells, along the logical axes, by [Youngs'](super::NormalMethod::Youngs) differences.
    ///
    /// # Errors
    /// Why there is none, where it is no more than rounding.
    pub fn slopes(&self) -> Result<Vector<D>, NoNormal> {
        youngs::slopes(self)
    }

    /// The largest value.
    pub fn largest(&self) -> f64 {
        self.values[..stencil_cells(D)].iter().fold(0.0, |a, &b| a.max(b))
    }

    /// Why values whose gradient vanishes have none.
    pub(super) fn why_flat(&self) -> NoNormal {
        let centre = stencil_cells(D) / 2;
        let near = |a: f64, b: f64| (a - b).abs() <= GRADIENT_FLAT * self.largest();
        let others = self.values[..stencil_cells(D)].iter().enumerate().filter(|&(place, _)| place != centre);
        if !others.clone().all(|(_, &value)| near(value, self.values[0])) {
            NoNormal::Balanced
        } else if near(self.values[centre], self.values[0]) {
            NoNormal::Flat
        } else {
            NoNormal::Isolated
        }
    }
}

/// The step that leads to a place of the stencil.
pub(super) fn step_of<const D: usize>(place: usize) -> [isize; D] {
    std::array::from_fn(|k| (place / 3_usize.pow(k as u32) % 3) as isize - 1)
}
