//! A cell's own affine frame: its mean edges become unit vectors, so that weights and turns mean the same for cells of any
//! aspect ratio.

use vofkit_geometry::{Cell, HalfSpace, Vector};

/// Takes points and normals to the frame of a cell and back: `y = J^-1 x`, `m = J^T n`, with the mean edges as columns of `J`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<const D: usize> {
    /// The mean edges.
    columns: [Vector<D>; D],
    /// The rows of `J^-1`.
    rows: [Vector<D>; D],
}

impl<const D: usize> Frame<D> {
    pub(crate) fn new<C: Cell<D>>(cell: &C) -> Self {
        let unit = |axis: usize| Vector::<D>::from_fn(|k, _| f64::from(u8::from(k == axis)));
        Self {
            columns: std::array::from_fn(|axis| cell.mean_edge(axis)),
            rows: std::array::from_fn(|axis| cell.physical_gradient(&unit(axis))),
        }
    }

    /// A difference of points in the frame.
    pub(crate) fn point(&self, x: &Vector<D>) -> Vector<D> {
        Vector::from_fn(|axis, _| self.rows[axis].dot(x))
    }

    /// A normal in the frame, of unit length there.
    pub(crate) fn normal(&self, n: &Vector<D>) -> Vector<D> {
        Vector::<D>::from_fn(|axis, _| self.columns[axis].dot(n)).normalize()
    }

    /// A normal of the frame in space, of unit length there.
    pub(super) fn in_space(&self, m: &Vector<D>) -> Vector<D> {
        self.scaled_in_space(m).normalize()
    }

    /// A half-space of the frame in space, its normal of unit length there.
    pub(crate) fn half_space_in_space(&self, half_space: &HalfSpace<D>) -> HalfSpace<D> {
        let normal = self.scaled_in_space(&half_space.normal);
        let size = normal.norm();
        HalfSpace { normal: normal / size, constant: half_space.constant / size }
    }

    fn scaled_in_space(&self, m: &Vector<D>) -> Vector<D> {
        self.rows.iter().zip(m.iter()).map(|(row, m)| row * *m).sum()
    }
}
