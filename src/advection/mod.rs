//! Advection of the volume fractions of materials.
//!
//! [`Transport`] holds what stays the same over a run; each [`Transport::step`] moves the fractions in place and returns a
//! [`Ledger`] of what it did. Read [`boundary`], [`ledger`], [`transport`], then the private
//! rooms: the band of cells that a step can change, the motion of its faces, and the sweeps.

mod band;
pub mod boundary;
pub mod ledger;
mod motion;
mod sweeps;
pub mod transport;

pub use boundary::{Boundary, End, WallCrossed};
pub use ledger::{Ledger, MaterialLedger};
pub use transport::{Settings, SetupError, StepError, SweepAxes, Transport};
