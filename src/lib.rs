//! Volume-of-fluid interface reconstruction and advection on distorted quadrilateral and hexahedral meshes.
#![allow(missing_docs)]

pub use vofkit_geometry as geometry;

pub mod advection;
pub mod export;
pub mod facet;
pub mod fractions;
pub mod interface;
pub mod mesh;
pub mod metrics;
pub mod normal;
pub mod parallel;

#[cfg(feature = "cli")]
pub mod report;
#[cfg(feature = "cli")]
pub mod run;
#[cfg(feature = "cli")]
pub mod scene;
pub mod shape;
pub mod tolerance;
pub mod velocity;
