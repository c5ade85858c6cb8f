//! The geometry kernel of vofkit: what a plane leaves of a cell, and which plane leaves a given part of it.
//!
//! Words and signs, the same everywhere:
//!
//! - a **half-space** is `{x : n.x <= d}`, the material side; its *normal* `n` points out of the material and
//!   `d` is its *plane constant*;
//! - the **truncated volume** is the volume (in 2D the area) of cell and half-space together;
//! - the **section** is plane and cell together; its area (in 2D its length) is the derivative of the
//!   truncated volume with respect to `d`;
//! - a **cell** is a [`Quad`] (nodes counter-clockwise) or a [`Hexahedron`] (nodes in the order of
//!   `VTK_HEXAHEDRON`) whose faces are ruled surfaces; the nodes may lie anywhere;
//! - a **swept region** is the cell between a face and the same face displaced;
//! - a **region** is a polygon or polyhedron with plane faces that planes cut pieces off.
//!
//! Read in this order: [`half_space`], [`cell`], [`quad`], [`hexahedron`], [`ruled_face`], [`hyperbola`],
//! [`second_moments`], [`parallelepiped`], [`plane_constant`], [`section`], [`defects`], [`tolerance`]; [`clip`] for regions; and, for comparison
//! with the exact truncation, [`method`], [`kothe`], [`submesh`]. What is private is told in `frame` (the cell's own affine
//! frame), `compensated` (its digits on rotated slivers), `affine`, `face_part`, `moment`, `centroid` and `simd`.
//!
//! Checking and computing are apart: [`Cell::defects`] lists everything that is wrong with a cell, all other
//! calls trust their input and return the algebraic (winding) volume of whatever they are given.
//!
//! ```
//! use vofkit_geometry::{Cell, HalfSpace, Hexahedron, PositionMethod, Vector};
//!
//! let cell = Hexahedron::from_corners(|[i, j, k]| {
//!     let bump = if [i, j, k] == [1, 1, 1] { 0.3 } else { 0.0 };
//!     Vector::<3>::new(i as f64 + bump, j as f64, k as f64 - bump)
//! });
//! let normal = Vector::<3>::new(2.0, -1.0, 2.0) / 3.0;
//! let position = cell.plane_constant(&normal, 0.25, PositionMethod::Auto)?;
//! let half_space = HalfSpace { normal, constant: position.constant };
//! let truncation = cell.truncate(&half_space);
//! assert!((truncation.volume - 0.25 * cell.volume()).abs() <= 1e-14 * cell.volume());
//! # Ok::<(), vofkit_geometry::PositionError>(())
//! ```
#![forbid(unsafe_code)]

mod affine;
pub mod cell;
mod centroid;
pub mod clip;
mod compensated;
pub mod defects;
mod face_part;
mod frame;
pub mod half_space;
pub mod hexahedron;
pub mod hyperbola;
mod jacobian;
pub mod kothe;
pub mod method;
mod moment;
pub mod parallelepiped;
pub mod plane_constant;
pub mod quad;
pub mod root;
pub mod ruled_face;
pub mod second_moments;
pub mod section;
mod simd;
pub mod submesh;
pub mod tolerance;

pub use cell::{Cell, Truncation, Wanted};
pub use defects::Defect;
pub use half_space::HalfSpace;
pub use hexahedron::Hexahedron;
pub use method::{MethodTruncation, TruncationMethod};
pub use plane_constant::{PlaneConstant, PositionError, PositionMethod};
pub use quad::Quad;

/// A point or a direction in `D` dimensions.
pub type Vector<const D: usize> = nalgebra::SVector<f64, D>;
