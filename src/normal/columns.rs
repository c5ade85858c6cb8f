//! Heights of the columns of a stencil: the fractions of three cells in a row, added up.
//!
//! Where the interface can be seen as a function of height over the layer across an axis, `H` of a column is where it stands, in
//! cells, and `-dH/dx_j` with the direction of the axis is a normal in cells.

use vofkit_geometry::Vector;

use super::stencil::{Stencil, step_of};

/// The columns along one axis.
pub(super) struct Columns<const D: usize> {
    axis: usize,
    /// 1 where the material lies at the lower end, -1 where at the upper.
    side: f64,
    /// Heights one column before, here, and one after, along each other axis.
    heights: [[f64; 3]; D],
}

impl<const D: usize> Columns<D> {
    pub(super) fn new(stencil: &Stencil<D>, axis: usize) -> Self {
        let (mut heights, mut ends) = ([[0.0; 3]; D], [0.0; 2]);
        for (place, &f) in stencil.values[..3_usize.pow(D as u32)].iter().enumerate() {
            let step = step_of::<D>(place);
            match step[axis] {
                -1 => ends[0] += f,
                1 => ends[1] += f,
                _ => {}
            }
            for along in (0..D).filter(|&k| k != axis) {
                let in_row = (0..D).all(|k| k == axis || k == along || step[k] == 0);
                if in_row {
                    heights[along][(step[along] + 1) as usize] += f;
                }
            }
        }
        Self { axis, side: if ends[0] >= ends[1] { 1.0 } else { -1.0 }, heights }
    }

    /// The normal in cells for a choice of difference (0 backward, 1 central, 2 forward) along each other axis.
    pub(super) fn normal(&self, difference: impl Fn(usize) -> usize) -> Vector<D> {
        Vector::from_fn(|k, _| {
            let [before, here, after] = self.heights[k];
            match (k == self.axis, difference(k)) {
                (true, _) => self.side,
                (_, 0) => before - here,
                (_, 1) => 0.5 * (before - after),
                _ => here - after,
            }
        })
    }
}
