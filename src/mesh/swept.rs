//! The volumes that the faces of a mesh sweep while its nodes move: exact, and one number for both cells of a face.
//!
//! Between its old and its new place a face sweeps the cell with four (2D: two) old and four new nodes, all of whose faces
//! are ruled. Neighbouring faces share the lateral ones, so that on any mesh
//!
//! ```text
//! V_new = V_old - sum over faces of what crosses outward
//! ```
//!
//! to rounding, where what crosses a face is minus the volume that it sweeps outward (the paper's remesh mode, Eq. 49).

use vofkit_geometry::{Cell, Vector};

use super::{Grid, Mesh, MotionError};
use crate::parallel;
use crate::quanta::Quanta;

/// What crosses the faces of a mesh while its nodes move and the material rests. Like
/// [`StepFluxes`](crate::velocity::StepFluxes), these are multiples of one power of two, so that sums of them are exact.
#[derive(Clone, Debug)]
pub struct SweptVolumes<const D: usize> {
    grid: Grid<D>,
    /// By axis, then by face; the faces across an axis are one more than the cells along it.
    values: Vec<Vec<f64>>,
    quanta: Quanta,
}

/// Faces across an axis, along each axis.
fn extent<const D: usize>(grid: &Grid<D>, axis: usize) -> [usize; D] {
    let mut extent = grid.cells();
    extent[axis] += 1;
    extent
}

impl<const D: usize> SweptVolumes<D> {
    /// The volumes between two places of one mesh.
    ///
    /// # Errors
    /// Meshes whose cells are not counted alike.
    pub fn new<C: Cell<D>>(from: &Mesh<C, D>, to: &Mesh<C, D>) -> Result<Self, MotionError> {
        let grid = from.grid();
        if grid != to.grid() {
            return Err(MotionError::OtherGrid {
                from: grid.cells().to_vec(),
                to: to.grid().cells().to_vec(),
            });
        }
        let mut values: Vec<Vec<f64>> = (0..D)
            .map(|axis| {
                let extent = extent(grid, axis);
                parallel::map(extent.iter().product(), |mut face| {
                    let offset = extent.map(|n| {
                        let at = face % n;
                        face /= n;
                        at
                    });
                    swept(from, to, offset, axis)
                })
            })
            .collect();
        let largest = values.iter().flatten().fold(0.0_f64, |largest, volume| largest.max(volume.abs()));
        let quanta = Quanta::new(largest);
        for volume in values.iter_mut().flatten() {
            *volume = quanta.round(*volume);
        }
        Ok(Self { grid: grid.clone(), values, quanta })
    }

    /// The volume that crosses face `2 axis + side` of the cell at `offset` towards higher indices: what the face sweeps
    /// towards lower ones.
    pub fn through(&self, mut offset: [usize; D], axis: usize, side: usize) -> f64 {
        let cells = self.grid.cells();
        offset[axis] += side;
        if self.grid.periodic()[axis] && offset[axis] == cells[axis] {
            // The two ends are one face.
            offset[axis] = 0;
        }
        let extent = extent(&self.grid, axis);
        self.values[axis][(0..D).rev().fold(0, |index, k| index * extent[k] + offset[k])]
    }

    /// A volume rounded to the same power of two, for parts that are to be added exactly.
    pub fn round(&self, volume: f64) -> f64 {
        self.quanta.round(volume)
    }

    /// What the volumes are multiples of.
    pub(crate) fn quanta(&self) -> Quanta {
        self.quanta
    }

    /// The Courant number: the largest volume that crosses a face, over that of the cell which it leaves.
    pub fn courant<C: Cell<D>>(&self, from: &Mesh<C, D>) -> f64 {
        self.largest_over_cells(|index, outward| {
            (0..2 * D).map(outward).fold(0.0, f64::max) / from.volumes()[index]
        })
    }

    /// The largest difference between a cell's new volume and its old one less what crosses outward, relative to the new
    /// one: rounding.
    pub fn mismatch<C: Cell<D>>(&self, from: &Mesh<C, D>, to: &Mesh<C, D>) -> f64 {
        self.largest_over_cells(|index, outward| {
            let (old, new) = (from.volumes()[index], to.volumes()[index]);
            (old - (0..2 * D).map(outward).sum::<f64>() - new).abs() / new
        })
    }

    fn largest_over_cells(&self, amount: impl Fn(usize, &dyn Fn(usize) -> f64) -> f64 + Sync + Send) -> f64 {
        let of_cell = |index: usize| {
            let offset = self.grid.offset(index);
            let outward = |face: usize| {
                let crossing = self.through(offset, face / 2, face % 2);
                if face % 2 == 1 { crossing } else { -crossing }
            };
            amount(index, &outward)
        };
        parallel::map(self.grid.len(), of_cell).into_iter().fold(0.0, f64::max)
    }
}

/// What crosses the lower face, across `axis`, of the cell at `offset`.
fn swept<C: Cell<D>, const D: usize>(
    from: &Mesh<C, D>,
    to: &Mesh<C, D>,
    offset: [usize; D],
    axis: usize,
) -> f64 {
    let index = C::FACE_NODES[2 * axis];
    let nodes = index
        .iter()
        .map(|&corner| from.grid().node_index(std::array::from_fn(|k| offset[k] + C::OFFSETS[corner][k])));
    // Relative to a node, so that no digits are lost to the place of the mesh.
    let mut origin = None;
    let (mut back, mut front) = ([Vector::<D>::zeros(); 4], [Vector::<D>::zeros(); 4]);
    let mut moves = false;
    for (i, node) in nodes.enumerate() {
        let (old, new) = (from.nodes()[node], to.nodes()[node]);
        let origin = *origin.get_or_insert(old);
        (back[i], front[i]) = (old - origin, new - origin);
        moves |= old != new;
    }
    // In outward order, which is towards lower indices.
    if moves { C::swept_volume(&back[..index.len()], &front[..index.len()]) } else { 0.0 }
}
