//! The section of a plane with a cell: polygons with straight chords along hyperbolic edges.

use crate::{HalfSpace, Vector};

pub(crate) fn of_hexahedron(_nodes: &[Vector<3>; 8], _half_space: &HalfSpace<3>) -> Vec<Vec<Vector<3>>> {
    Vec::new()
}

pub(crate) fn of_quad(_nodes: &[Vector<2>; 4], _half_space: &HalfSpace<2>) -> Vec<Vec<Vector<2>>> {
    Vec::new()
}
