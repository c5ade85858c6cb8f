//! `[velocity]`: the field and how it changes in time.

use serde::{Deserialize, Serialize};
use toml::Spanned;
use vofkit_geometry::Vector;

use super::context::{Context, Numbers, axis, default};
use super::error::SceneError;
use crate::import::{TimedFile, velocity_files};
use crate::space::spatial;
use crate::velocity::{Divergence, Field};

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "a table with field, reversal")]
pub(super) struct VelocitySection {
    pub(super) field: Spanned<FieldChoice>,
    #[serde(default = "no_reversal")]
    pub(super) reversal: Spanned<ReversalChoice>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum FieldChoice {
    Uniform {
        velocity: Numbers,
    },
    Rotation {
        centre: Numbers,
        rate: Spanned<f64>,
        #[serde(skip_serializing_if = "Option::is_none")]
        axis: Option<Numbers>,
    },
    Eq101,
    RudmanShear,
    ReversedVortex {
        period: Spanned<f64>,
    },
    #[serde(rename = "deformation_3d")]
    Deformation3d {
        period: Spanned<f64>,
    },
    #[serde(rename = "shear_3d")]
    Shear3d {
        period: Spanned<f64>,
        #[serde(default = "axial_speed")]
        speed: Spanned<f64>,
        #[serde(default = "axial_radius")]
        radius: Spanned<f64>,
    },
    File {
        /// A structured grid or a series of them, its path relative to the folder of the scene file.
        path: Spanned<String>,
        #[serde(default = "no_divergence")]
        divergence: Spanned<String>,
    },
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum ReversalChoice {
    None,
    Cosine { period: Spanned<f64> },
    Flip(FlipChoice),
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "a table with step or time")]
pub(super) struct FlipChoice {
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<Spanned<u64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    time: Option<Spanned<f64>>,
}

fn no_reversal() -> Spanned<ReversalChoice> {
    default(ReversalChoice::None)
}

fn no_divergence() -> Spanned<String> {
    default("error".to_owned())
}

fn axial_speed() -> Spanned<f64> {
    default(1.0)
}

fn axial_radius() -> Spanned<f64> {
    default(0.5)
}

/// Where the velocity comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum VelocitySetup {
    /// A field with a formula, at full amplitude.
    Formula(Field),
    /// Structured grids with a velocity, each with its time.
    Files {
        /// The files in the order of their times.
        files: Vec<TimedFile>,
        /// What becomes of the divergence of the velocity.
        divergence: Divergence,
    },
}

impl VelocitySetup {
    /// Nothing moves.
    pub(super) fn none() -> Self {
        Self::Formula(Field::Uniform { velocity: Vector::<3>::zeros() })
    }

    /// Without the files for before the start at 0 and for after the end, but the last before and the first after: the others have no part in
    /// a run.
    pub(super) fn acting(self, end: Option<f64>) -> Self {
        let Self::Files { mut files, divergence } = self else { return self };
        let last = end.map_or(files.len(), |end| files.partition_point(|file| file.time < end) + 1);
        files.truncate(last);
        let first = files.partition_point(|file| file.time <= 0.0).saturating_sub(1);
        files.drain(..first);
        Self::Files { files, divergence }
    }

    /// The number of files.
    pub(crate) fn files(&self) -> usize {
        if let Self::Files { files, .. } = self { files.len() } else { 0 }
    }
}

/// When the velocity changes its direction, as the scene says it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReversalSetup {
    /// Never.
    None,
    /// Gradually, as `cos(pi t / period)`.
    Cosine {
        /// The period.
        period: f64,
    },
    /// At once, after a step.
    FlipAtStep {
        /// Steps before the change.
        step: u64,
    },
    /// At once, at a time.
    FlipAtTime {
        /// The time.
        time: f64,
    },
}

impl VelocitySection {
    pub(super) fn resolve<const D: usize>(
        &self,
        context: Context<'_>,
    ) -> Result<(VelocitySetup, ReversalSetup), SceneError> {
        let reversal = self.reversal(context)?;
        let (field, period) = self.field::<D>(context)?;
        if D == 2 && matches!(&field, VelocitySetup::Formula(field) if !field.is_planar()) {
            return Err(context.error(
                self.field.span(),
                "this velocity field needs three dimensions",
                "give three numbers of mesh.cells, or use uniform, rotation, eq101, rudman_shear or reversed_vortex",
            ));
        }
        match (period, reversal) {
            (None, reversal) => Ok((field, reversal)),
            (Some(period), ReversalSetup::None) => Ok((field, ReversalSetup::Cosine { period })),
            (Some(_), _) => Err(context.error(
                self.reversal.span(),
                "a field with a period already turns back by itself",
                "leave out `reversal`, or use a field without a period",
            )),
        }
    }

    /// The field and its period.
    fn field<const D: usize>(
        &self,
        context: Context<'_>,
    ) -> Result<(VelocitySetup, Option<f64>), SceneError> {
        let period = |value: &Spanned<f64>| context.positive("the period", value).map(Some);
        let (field, period) = match self.field.get_ref() {
            FieldChoice::Uniform { velocity } => {
                let velocity: Vector<D> = context.vector("the velocity", velocity)?;
                (Field::Uniform { velocity: spatial(&velocity) }, None)
            }
            FieldChoice::Rotation { centre, rate, axis: about } => {
                let centre: Vector<D> = context.vector("the centre of the rotation", centre)?;
                let rate = context.finite("the rate", rate)?;
                let about = match about {
                    Some(about) => axis::<D>(about, context)?.normalize(),
                    None => Vector::<3>::z(),
                };
                (Field::Rotation { centre: spatial(&centre), angular_velocity: about * rate }, None)
            }
            FieldChoice::Eq101 => (Field::Eq101, None),
            FieldChoice::RudmanShear => (Field::RudmanShear, None),
            FieldChoice::ReversedVortex { period: p } => (Field::ReversedVortex, period(p)?),
            FieldChoice::Deformation3d { period: p } => (Field::Deformation3d, period(p)?),
            FieldChoice::Shear3d { period: p, speed, radius } => {
                let speed = context.finite("the speed", speed)?;
                let radius = context.positive("the radius of the axial flow", radius)?;
                (Field::Shear3d { speed, radius }, period(p)?)
            }
            FieldChoice::File { path, divergence } => {
                return Ok((files(path, divergence, context)?, None));
            }
        };
        Ok((VelocitySetup::Formula(field), period))
    }

    fn reversal(&self, context: Context<'_>) -> Result<ReversalSetup, SceneError> {
        match self.reversal.get_ref() {
            ReversalChoice::None => Ok(ReversalSetup::None),
            ReversalChoice::Cosine { period } => {
                Ok(ReversalSetup::Cosine { period: context.positive("the period", period)? })
            }
            ReversalChoice::Flip(FlipChoice { step: Some(step), time: None }) => match *step.get_ref() {
                0 => Err(context.error(
                    step.span(),
                    "the step of the flip is 0",
                    "give a whole number of at least 1, or a velocity in the other direction",
                )),
                step => Ok(ReversalSetup::FlipAtStep { step }),
            },
            ReversalChoice::Flip(FlipChoice { step: None, time: Some(time) }) => {
                Ok(ReversalSetup::FlipAtTime { time: context.positive("the time of the flip", time)? })
            }
            ReversalChoice::Flip(_) => Err(context.error(
                self.reversal.span(),
                "a flip needs either a step or a time",
                "write { flip = { step = 100 } } or { flip = { time = 1.0 } }",
            )),
        }
    }
}

/// The files of a velocity.
fn files(
    path: &Spanned<String>,
    divergence: &Spanned<String>,
    context: Context<'_>,
) -> Result<VelocitySetup, SceneError> {
    let known =
        [("error", Divergence::Error), ("project", Divergence::Project), ("dilate", Divergence::Dilate)];
    let divergence = context.word("the divergence", divergence, &known)?;
    let files = velocity_files(context.source.beside(path.get_ref()))
        .map_err(|error| context.error(path.span(), error.to_string(), error.help()))?;
    Ok(VelocitySetup::Files { files, divergence })
}
