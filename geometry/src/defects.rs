//! What can be wrong with a cell.

use std::fmt;

use crate::Vector;

/// Something wrong with a cell, or odd about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Defect {
    /// A node's coordinate is NaN or infinite.
    NotFinite {
        /// The node's place in the cell.
        node: usize,
    },
}

impl Defect {
    /// Whether the cell cannot be used; otherwise it is legal, and only noticed.
    pub fn is_error(&self) -> bool {
        true
    }
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:?}")
    }
}

pub(crate) fn of_hexahedron(_nodes: &[Vector<3>; 8]) -> Vec<Defect> {
    Vec::new()
}

pub(crate) fn of_quad(_nodes: &[Vector<2>; 4]) -> Vec<Defect> {
    Vec::new()
}
