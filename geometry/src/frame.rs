//! A hexahedron's own frame, for the methods that are kept for comparison: what they compute there is theirs alone,
//! and the frame is no excuse for digits lost on slivers, tiny cells and cells far from the origin.

use nalgebra::Matrix3;

use crate::Vector;
use crate::half_space::{compensated_dot, compensated_height, largest_and_direction};

type Vector3 = Vector<3>;

/// A cell in its own frame, `x = first + origin + J y`.
pub(crate) struct Frame<'a> {
    /// The first node, not in the frame.
    pub(crate) first: &'a Vector3,
    /// The frame's origin, relative to the first node.
    pub(crate) origin: &'a Vector3,
    pub(crate) jacobian: &'a Matrix3<f64>,
    pub(crate) determinant: f64,
    /// The nodes in the frame.
    pub(crate) nodes: &'a [Vector3; 8],
}

/// A normal in the frame, with what its plane constants need.
pub(crate) struct Direction {
    /// `J^T n / size`.
    pub(crate) m: Vector3,
    /// The largest component of `J^T n`.
    pub(crate) size: f64,
    /// `n.x` of the first node.
    base: [f64; 2],
    /// `n.x` of the frame's origin over the first node.
    offset: f64,
}

impl Frame<'_> {
    pub(crate) fn along(&self, normal: &Vector3) -> Direction {
        let (size, m) = largest_and_direction(&self.jacobian.tr_mul(normal));
        Direction { m, size, base: compensated_dot(normal, self.first), offset: normal.dot(self.origin) }
    }
}

impl Direction {
    /// `m.y` on the plane `n.x = constant`.
    pub(crate) fn level(&self, constant: f64) -> f64 {
        -compensated_height(self.base, self.offset, constant) / self.size
    }

    /// The plane constant of `sign n` for the plane `m.y = level`.
    pub(crate) fn constant(&self, level: f64, sign: f64) -> f64 {
        sign * (self.base[0] + (self.base[1] + (self.offset + level * self.size)))
    }
}
