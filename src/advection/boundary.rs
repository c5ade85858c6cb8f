//! What happens at the faces on the boundary of the mesh.

use vofkit_geometry::Cell;

use super::transport::StepError;
use crate::mesh::{Grid, Mesh, axis_name};
use crate::velocity::Flow;

/// What one end of an axis is. Periodic axes are a matter of the [grid](crate::mesh::Grid).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Nothing crosses.
    Wall,
    /// Material leaves with the flow; what flows in is named by [`Boundary::inflow`].
    Outflow,
}

/// The ends of all axes, `[lower, upper]` each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Boundary<const D: usize> {
    /// What each end is.
    pub ends: [[End; 2]; D],
    /// The material that flows in through open ends; none for void.
    pub inflow: Option<usize>,
}

/// A wall that the velocity crosses.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the velocity crosses the wall at the {} end of {}: up to {rate:.3e} volume per time through one face",
    ["lower", "upper"][*side],
    axis_name(*axis)
)]
pub struct WallCrossed {
    /// The axis.
    pub axis: usize,
    /// 0 for its lower end, 1 for its upper.
    pub side: usize,
    /// The largest flux through one of its faces, at full amplitude.
    pub rate: f64,
}

impl<const D: usize> Boundary<D> {
    /// Checks that what flows in is one of so many materials.
    pub(super) fn check_inflow(&self, materials: usize) -> Result<(), StepError> {
        match self.inflow {
            Some(material) if material >= materials => Err(StepError::Inflow { material, materials }),
            _ => Ok(()),
        }
    }

    /// The fraction of a material in what flows in through open ends.
    pub fn inflow_fraction(&self, material: usize) -> f64 {
        if self.inflow == Some(material) { 1.0 } else { 0.0 }
    }

    /// Fills in the ends that are not given: a wall where no face is crossed, else open.
    ///
    /// # Errors
    /// A wall that was asked for, but is crossed.
    pub(super) fn resolve<C: Cell<D>>(
        mesh: &Mesh<C, D>,
        flow: &Flow<D>,
        asked: [[Option<End>; 2]; D],
        inflow: Option<usize>,
    ) -> Result<Self, WallCrossed> {
        Self::where_crossed(mesh, asked, inflow, |offset, axis, side| flow.largest_flux(offset, axis, side))
    }

    /// The same for whatever volume crosses the faces at the ends.
    pub(super) fn where_crossed<C: Cell<D>>(
        mesh: &Mesh<C, D>,
        asked: [[Option<End>; 2]; D],
        inflow: Option<usize>,
        crossing: impl Fn([usize; D], usize, usize) -> f64,
    ) -> Result<Self, WallCrossed> {
        let mut ends = [[End::Outflow; 2]; D];
        for axis in (0..D).filter(|&axis| !mesh.grid().periodic()[axis]) {
            for side in 0..2 {
                let rate = boundary_layer(mesh, axis, side)
                    .map(|offset| crossing(offset, axis, side))
                    .fold(0.0, f64::max);
                ends[axis][side] = match asked[axis][side] {
                    None if rate == 0.0 => End::Wall,
                    None => End::Outflow,
                    Some(End::Wall) if rate > 0.0 => return Err(WallCrossed { axis, side, rate }),
                    Some(end) => end,
                };
            }
        }
        Ok(Self { ends, inflow })
    }

    /// Whether a face of the cell at `offset` is a wall.
    pub(super) fn is_wall(&self, grid: &Grid<D>, offset: [usize; D], axis: usize, side: usize) -> bool {
        let last = if side == 1 { grid.cells()[axis] - 1 } else { 0 };
        offset[axis] == last && !grid.periodic()[axis] && self.ends[axis][side] == End::Wall
    }
}

/// The offsets of the cells at one end of an axis.
fn boundary_layer<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    axis: usize,
    side: usize,
) -> impl Iterator<Item = [usize; D]> {
    let cells = mesh.grid().cells();
    let mut extent = cells;
    extent[axis] = 1;
    let count: usize = extent.iter().product();
    (0..count).map(move |mut rest| {
        let mut offset = extent.map(|n| {
            let i = rest % n;
            rest /= n;
            i
        });
        if side == 1 {
            offset[axis] = cells[axis] - 1;
        }
        offset
    })
}
