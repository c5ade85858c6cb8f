//! Volume-of-fluid interface reconstruction and advection on distorted quadrilateral and hexahedral meshes.
//!
//! Data travels one way, and the rooms below are in that order:
//!
//! 1. [`geometry`]: cells, planes, truncated volumes and plane constants;
//! 2. [`mesh`]: structured meshes, distorted, checked, and moved over a run;
//! 3. [`shape`] and [`fractions`]: from shapes to volume fractions; [`profile`]: quantities at the
//!    start; [`velocity`]: fields and the volumes that cross faces;
//! 4. [`normal`] and [`interface`]: a plane in every mixed cell, and its [`facet`];
//! 5. [`quantity`]: what belongs to a material; [`advection`]: fractions and quantities a step later, with a ledger of what was done;
//!    [`ale`]: the same for arrays of the caller's own;
//! 6. [`volume_associated`] and [`nodal`]: the same for quantities of the mesh and its nodes;
//! 7. [`metrics`]: numbers that judge a result; [`export`]: files for viewers.
//!
//! [`body_file`] reads bodies for shapes. A [`stopwatch`] tells how long the phases of steps take.
//!
//! With the feature `import`, `import` reads meshes, fractions and velocities of other programs. With the feature `cli`, `scene` reads scene files,
//! `run` runs them, `report` sums up, `kernel` takes tables of cells and planes through the geometry kernel, `study` runs combinations of
//! settings and compares them (with the feature `plot`, too), `stress` tries extreme cases, and `cli` is the command line `vofkit`.
//! Numerics never look at these. Two and three dimensions are one code, generic over the dimension `D` and the type of
//! [cell](geometry::Cell).
//!
//! ```
//! use vofkit::prelude::*;
//!
//! let mesh = Mesh::<Quad, 2>::unit([32; 2], &Distortion::Wave { amplitude: 0.3 })?;
//! let mut fractions = volume_fractions(&mesh, &[Shape::Sphere { centre: [0.5, 0.75].into(), radius: 0.15 }]);
//! let velocity = Velocity { field: Field::ReversedVortex, reversal: Reversal::None };
//! let mut transport = Transport::new(&mesh, velocity, Settings::default())?;
//! transport.step(&mut fractions, 0, 0.0, 0.5 / transport.courant_rate())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use vofkit_geometry as geometry;

pub mod advection;
pub mod ale;
pub mod body_file;
#[cfg(feature = "cli")]
pub mod cli;
pub mod export;
pub mod facet;
pub mod fractions;
#[cfg(feature = "import")]
pub mod import;
pub mod interface;
#[cfg(feature = "cli")]
pub mod kernel;
pub mod mesh;
pub mod metrics;
pub mod nodal;
pub mod normal;
pub mod parallel;
pub mod profile;
mod quanta;
pub mod quantity;
#[cfg(feature = "cli")]
pub mod report;
#[cfg(feature = "cli")]
pub mod run;
#[cfg(feature = "cli")]
pub mod scene;
pub mod shape;
mod space;
pub mod stopwatch;
#[cfg(feature = "cli")]
pub mod stress;
#[cfg(all(feature = "cli", feature = "plot"))]
pub mod study;
pub mod tolerance;
pub mod velocity;
pub mod volume_associated;
mod whole_file;

/// What most programs use.
pub mod prelude {
    pub use crate::advection::{
        Ledger, Remesh, Scheme, Settings, StepError, SweepAxes, SweepOrder, Transport, remap,
    };
    pub use crate::ale;
    pub use crate::facet::Facet;
    pub use crate::fractions::{material_moments, volume_fractions};
    pub use crate::geometry::{Cell, HalfSpace, Hexahedron, PositionMethod, Quad, Vector};
    pub use crate::interface::{Interface, Reconstruction, reconstruct};
    pub use crate::mesh::{Distortion, Grid, Mesh, MeshMotion, MeshPath, SweptVolumes};
    pub use crate::metrics::{fragments, material_volume, shape_error};
    pub use crate::normal::NormalMethod;
    pub use crate::quantity::{MaterialQuantity, State};
    pub use crate::shape::{Body, Rotation, Shape};
    pub use crate::velocity::{Divergence, Field, Flow, Reversal, Sampled, Velocity};
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
