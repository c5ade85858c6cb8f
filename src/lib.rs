//! Volume-of-fluid interface reconstruction and advection on distorted quadrilateral and hexahedral meshes.
#![allow(missing_docs)]

pub use vofkit_geometry as geometry;

pub mod mesh;
pub mod parallel;
