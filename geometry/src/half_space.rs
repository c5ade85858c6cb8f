//! The half-space `{x : n.x <= d}` that holds the material.

use crate::Vector;

/// The half-space `{x : n.x <= d}`; the normal points out of it (Eq. 80 and 91 of the paper).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace<const D: usize> {
    /// The outward normal `n`. Unit length where a section area or a distance is wanted.
    pub normal: Vector<D>,
    /// The plane constant `d`, in the unit of length times that of the normal.
    pub constant: f64,
}

impl<const D: usize> HalfSpace<D> {
    /// The height `n.x - d` of a point over the plane: negative or zero inside.
    pub fn height(&self, point: &Vector<D>) -> f64 {
        self.normal.dot(point) - self.constant
    }

    /// The other side of the same plane.
    pub fn complement(&self) -> Self {
        Self { normal: -self.normal, constant: -self.constant }
    }

    /// The half-space moved by `shift`.
    pub fn translated(&self, shift: &Vector<D>) -> Self {
        Self { normal: self.normal, constant: self.constant + self.normal.dot(shift) }
    }
}
