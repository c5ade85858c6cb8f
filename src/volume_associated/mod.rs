//! Advection of quantities that belong to the mesh and not to a material: strains, densities, energies (Sect. 4 of the paper).
//!
//! Cell means are moved by what crosses the faces. A step is one pass over all faces, or a sequence of sweeps along mesh lines
//! ([`Splitting`]); in each, volume or mass carries the quantities:
//!
//! 1. `runs`: the order of cells and faces in memory; `spacing`: distances along mesh lines;
//! 2. [`face_volumes`]: the volumes that cross the faces, in flow mode and for moving nodes; `carrier`: volume and mass of a pass;
//! 3. [`scheme`] and [`limiter`]: the names of the methods; `slopes`, `face_values`, `fct`: what they do;
//! 4. `update`: the new means; [`transport`]: whole steps;
//! 5. [`points`]: from means to integration points and back; [`pointwise`]: the schemes there that need no faces.

mod carrier;
mod face_values;
pub mod face_volumes;
mod fct;
pub mod limiter;
pub mod points;
pub mod pointwise;
mod runs;
pub mod scheme;
mod slopes;
mod spacing;
pub mod transport;
mod update;

pub use face_volumes::{FaceVolumes, Splitting};
pub use limiter::{AlphaRange, Limiter, courant_alpha};
pub use pointwise::{PointError, PointScheme, PointTransport, Smoothing, VolumeMatrix};
pub use scheme::Scheme;
pub use transport::{FieldLedger, Quantity, TransportError, VolumeTransport, Weighting};
