//! Advection of the volume fractions of materials.
//!
//! [`Transport`] moves them through a mesh that stands still, [`Remesh`] from one place of a mesh to the next; each step changes the
//! fractions in place and returns a [`Ledger`] of what it did. [`remap()`] takes fractions to any other mesh. Read [`settings`],
//! [`boundary`], [`ledger`], [`schedule`], [`transport`], [`remesh`], then the private rooms: the band of cells that a step can change; the stages (what a sweep moves and
//! where it comes from; `tracing` asks the nodes), the sweeps, and how several materials share what leaves a cell; and for unsplit advection the shares that
//! materials have of cells (`nested`), what a region holds of each (`content`), and the regions that cells come from (`preimage`). `carry` takes along the
//! [quantities](crate::quantity) of the materials; `wisps` removes what nobody wants to keep, `dilation` accounts for velocities
//! that are not free of divergence.

mod band;
pub mod boundary;
mod carry;
mod content;
mod dilation;
pub mod ledger;
mod nested;
mod places;
mod preimage;
mod remap;
pub mod remesh;
pub mod schedule;
pub mod settings;
mod settle;
mod share;
mod stage;
mod sweeps;
mod tracing;
pub mod transport;
mod unsplit;
mod wisps;

pub use boundary::{Boundary, End, WallCrossed};
pub use ledger::{Ledger, MaterialLedger, QuantityLedger};
pub use remap::{RemapError, remap};
pub use remesh::Remesh;
pub use schedule::SweepOrder;
pub(crate) use schedule::sweep_order;
pub use settings::{Scheme, Settings, SweepAxes};
pub use transport::{SetupError, StepError, Transport};
pub(crate) use unsplit::step_with_fluxes;
