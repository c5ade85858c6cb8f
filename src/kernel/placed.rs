//! Cells far from the origin: a cell is moved to the origin without rounding what it was prepared from, and plane
//! constants go from one place to the other in compensated arithmetic.

use vofkit_geometry::{HalfSpace, Hexahedron, Vector};

type Vector3 = Vector<3>;

/// A cell that was moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed {
    /// The cell in its new place.
    pub(super) cell: Hexahedron,
    /// Where the new origin was.
    pub(super) shift: Vector3,
    /// The first node, before.
    first: Vector3,
}

impl Placed {
    /// The cell where it is.
    pub(super) fn in_place(nodes: &[Vector3; 8]) -> Self {
        Self { cell: Hexahedron::new(*nodes), shift: Vector3::zeros(), first: nodes[0] }
    }

    /// The cell with its first node in the origin.
    pub(super) fn at_origin(nodes: &[Vector3; 8]) -> Self {
        let first = nodes[0];
        Self { cell: Hexahedron::new(*nodes).relative_to_first_node(), shift: first, first }
    }

    /// The half-space with a plane constant relative to the cell's first node, in the new place.
    pub(super) fn half_space(&self, normal: &Vector3, local: f64) -> HalfSpace<3> {
        HalfSpace { normal: *normal, constant: dot_plus(normal, &(self.first - self.shift), local) }
    }

    /// The plane constant relative to the cell's first node, from that in the new place: the inverse of
    /// [`Self::half_space`].
    pub(super) fn local_constant(&self, half_space: &HalfSpace<3>) -> f64 {
        dot_plus(&-half_space.normal, &(self.first - self.shift), half_space.constant)
    }

    /// The plane constant before the cell was moved.
    pub(super) fn constant(&self, normal: &Vector3, local: f64) -> f64 {
        dot_plus(normal, &self.first, local)
    }
}

/// `a.b + c`, as if computed with twice the digits and rounded once (Ogita, Rump & Oishi 2005, Dot2).
pub(super) fn dot_plus(a: &Vector3, b: &Vector3, c: f64) -> f64 {
    let (mut sum, mut lost) = (c, 0.0);
    for axis in 0..3 {
        let product = a[axis] * b[axis];
        lost += a[axis].mul_add(b[axis], -product);
        let [next, rest] = two_sum(sum, product);
        sum = next;
        lost += rest;
    }
    // Overflow alone makes this fail, and the plain sum says so.
    if lost.is_finite() { sum + lost } else { sum }
}

/// What plain arithmetic may make of [`dot_plus`].
pub(super) fn rounding(a: &Vector3, b: &Vector3, c: f64) -> f64 {
    8.0 * f64::EPSILON * (a.component_mul(b).abs().sum() + c.abs())
}

/// `a + b` rounded, and the rest (Knuth).
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let part = sum - a;
    [sum, (a - (sum - part)) + (b - part)]
}
