//! Advection of the volume fractions of materials.
//!
//! [`Transport`] holds what stays the same over a run; each [`Transport::step`] moves the fractions in place and returns a
//! [`Ledger`] of what it did. Read [`boundary`], [`ledger`], [`transport`], then the private
//! rooms: the band of cells that a step can change; the motion of its faces and the sweeps; and for unsplit advection the shares that
//! materials have of cells (`nested`), what a region holds of each (`content`), and the regions that cells come from (`preimage`).

mod band;
pub mod boundary;
mod content;
pub mod ledger;
mod motion;
mod nested;
mod preimage;
mod sweeps;
pub mod transport;
mod unsplit;

pub use boundary::{Boundary, End, WallCrossed};
pub use ledger::{Ledger, MaterialLedger};
pub(crate) use transport::sweep_order;
pub use transport::{Scheme, Settings, SetupError, StepError, SweepAxes, Transport};
