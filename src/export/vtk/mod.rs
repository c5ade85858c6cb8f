//! VTK XML files: what ParaView, VisIt and pyvista read.
//!
//! - [`structured_grid`]: a mesh with values at its cells and nodes (`.vts`);
//! - [`poly_data`]: interface facets, [`points`]: points with values (`.vtp`);
//! - [`collection`]: which files belong to which time (`.pvd`);
//! - `appended`: the common form of the first three, XML followed by raw little-endian numbers.
//!
//! Numbers are 64 bits wide and not compressed; reading them back gives the same bits. Two-dimensional points
//! and vectors get a third component 0.

mod appended;
pub mod collection;
pub mod points;
pub mod poly_data;
pub mod structured_grid;

pub use collection::Collection;
pub use points::write_points;
pub use poly_data::write_poly_data;
pub use structured_grid::{
    CellArray, CellValues, fraction_arrays, write_structured_grid, write_structured_grid_with_nodes,
};

use vofkit_geometry::Vector;

use super::printable;
use crate::space::spatial;

/// The three components of a point or direction.
fn components<const D: usize>(x: &Vector<D>) -> [f64; 3] {
    spatial(x).into()
}

/// The text as it may stand in an attribute of XML.
fn escaped(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
