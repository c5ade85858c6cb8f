//! Advection of the volume fractions of materials.
//!
//! [`Transport`] holds what stays the same over a run; each [`Transport::step`] moves the fractions in place and returns a
//! [`Ledger`] of what it did. Read [`boundary`], [`ledger`], [`motion`], then [`sweeps`].

mod band;
pub mod boundary;
pub mod ledger;
pub mod motion;
pub mod sweeps;

pub use boundary::{Boundary, End, WallCrossed};
pub use ledger::{Ledger, MaterialLedger};
pub use sweeps::{StepError, SweepAxes, Transport};
