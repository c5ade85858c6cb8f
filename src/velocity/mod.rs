//! Velocities, and their integrals over faces and steps.
//!
//! - [`Field`]: steady fields, each the curl of a vector potential (2D: of a stream function along z), so that the volume that crosses a face is a sum
//!   over its edges ([`FaceFluxes`]) and vanishes when summed over a closed cell, on any mesh;
//! - this file: a [`Velocity`], which is a field times a function of time ([`Reversal`]);
//! - [`Sampled`]: velocities at the nodes of a mesh and at given times in place of a field, with `faces`: their fluxes, and `projection`: these made
//!   free of divergence;
//! - [`Flow`]: either on a mesh, which is all that advection sees; `trace`: where what is at the nodes comes from.

mod faces;
mod field;
mod flow;
mod flux;
mod projection;
mod sampled;
mod trace;

pub use field::Field;
pub use flow::{Flow, FlowStep};
pub use flux::{FaceFluxes, FluxRange, StepFluxes};
pub use sampled::{Divergence, Sampled, SampledError};
pub(crate) use trace::NodalMotion;

use std::f64::consts::PI;

use vofkit_geometry::Vector;

use crate::tolerance::REVERSAL_ROUNDING;

/// How the velocity changes in time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Reversal {
    /// Not at all.
    #[default]
    None,
    /// Times `cos(pi t / period)`: everything is back at its place after one period.
    Cosine {
        /// The period.
        period: f64,
    },
    /// Times 1 before `time` and -1 after.
    Flip {
        /// When the direction changes.
        time: f64,
    },
}

/// A field and how it changes in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Velocity {
    /// The field at its largest amplitude.
    pub field: Field,
    /// How its amplitude changes in time.
    pub reversal: Reversal,
}

impl Reversal {
    /// The integral of the amplitude from `start` to `end`: for how long the steady field would have to act.
    pub fn duration(&self, start: f64, end: f64) -> f64 {
        match *self {
            Self::None => end - start,
            Self::Cosine { period } => {
                let middle = PI * (start + end) / (2.0 * period);
                2.0 * period / PI * middle.cos() * (PI * (end - start) / (2.0 * period)).sin()
            }
            Self::Flip { time } => {
                let before = |t: f64| if t <= time { t } else { 2.0 * time - t };
                before(end) - before(start)
            }
        }
    }

    /// The amplitude at one time.
    pub fn amplitude(&self, time: f64) -> f64 {
        match *self {
            Self::None => 1.0,
            Self::Cosine { period } => (PI * time / period).cos(),
            Self::Flip { time: flip } => {
                if time < flip {
                    1.0
                } else {
                    -1.0
                }
            }
        }
    }
}

impl Velocity {
    /// See [`Reversal::duration`].
    pub fn duration(&self, start: f64, end: f64) -> f64 {
        self.reversal.duration(start, end)
    }

    /// See [`Reversal::amplitude`].
    pub fn amplitude(&self, time: f64) -> f64 {
        self.reversal.amplitude(time)
    }
}

/// Where a velocity takes every point over some time, where that is a rigid motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RigidMotion {
    /// Everything is back at its place.
    Identity,
    /// A shift.
    Translation {
        /// The shift.
        shift: Vector<3>,
    },
    /// A rotation.
    Rotation {
        /// A point of the axis.
        centre: Vector<3>,
        /// The direction of the axis, of any length but zero.
        axis: Vector<3>,
        /// The angle in radians, right-handed about the axis.
        angle: f64,
    },
}

impl Velocity {
    /// The rigid motion from `start` to `end`; none where shapes deform.
    pub fn rigid_motion(&self, start: f64, end: f64) -> Option<RigidMotion> {
        let duration = self.duration(start, end);
        // What is left of a reversal after rounding moves nothing.
        if duration.abs() <= REVERSAL_ROUNDING * (end - start).abs() {
            return Some(RigidMotion::Identity);
        }
        match self.field {
            Field::Uniform { velocity } => Some(RigidMotion::Translation { shift: velocity * duration }),
            Field::Rotation { centre, angular_velocity } => {
                let rate = angular_velocity.norm();
                let angle = rate * duration;
                Some(if rate > 0.0 {
                    RigidMotion::Rotation { centre, axis: angular_velocity, angle }
                } else {
                    RigidMotion::Identity
                })
            }
            _ => None,
        }
    }
}
