//! How fields start.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use toml::Spanned;
use vofkit_geometry::Vector;

use crate::mesh::axis_name;
use crate::profile::Profile;
use crate::scene::context::{Context, Numbers, default};
use crate::scene::error::SceneError;
use crate::scene::mesh::MeshSetup;
use crate::scene::shape::{self, ShapeChoice};
use crate::shape::{Rotation, Shape};

/// One number, or one for each component.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(untagged, expecting = "a number, or a list of one for each component")]
pub(in crate::scene) enum Amount {
    One(f64),
    Each(Vec<f64>),
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(in crate::scene) enum ProfileChoice {
    Constant {
        value: Spanned<Amount>,
    },
    SquareWave {
        from: Spanned<f64>,
        to: Spanned<f64>,
        value: Spanned<Amount>,
        #[serde(default = "zero")]
        background: Spanned<Amount>,
    },
    CircularWave {
        centre: Numbers,
        radius: Spanned<f64>,
        value: Spanned<Amount>,
        #[serde(default = "zero")]
        background: Spanned<Amount>,
    },
    Sine {
        waves: Numbers,
        #[serde(default = "zero")]
        mean: Spanned<Amount>,
        amplitude: Spanned<Amount>,
        #[serde(default = "no_phase")]
        phase: Spanned<f64>,
    },
    Inclusions {
        shapes: Vec<InclusionSection>,
        #[serde(default = "zero")]
        background: Spanned<Amount>,
    },
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "a table with shape, value")]
pub(in crate::scene) struct InclusionSection {
    shape: Spanned<ShapeChoice>,
    value: Spanned<Amount>,
}

fn zero() -> Spanned<Amount> {
    default(Amount::One(0.0))
}

fn no_phase() -> Spanned<f64> {
    default(0.0)
}

/// As many finite numbers as there are components.
pub(in crate::scene) fn amounts(
    what: &str,
    amount: &Spanned<Amount>,
    components: usize,
    context: Context<'_>,
) -> Result<Vec<f64>, SceneError> {
    let values = match amount.get_ref() {
        Amount::One(value) => vec![*value; components],
        Amount::Each(values) => values.clone(),
    };
    if values.len() != components {
        return Err(context.error(
            amount.span(),
            format!("{what} is a list of {}, and the field has {components} components", values.len()),
            "give one number for all components, or a list of one for each",
        ));
    }
    match values.iter().find(|value| !value.is_finite()) {
        None => Ok(values),
        Some(odd) => Err(context.error(
            amount.span(),
            format!("{what} holds {odd}, which is not a finite number"),
            "give finite numbers",
        )),
    }
}

/// The profile of each component.
pub(in crate::scene) fn profiles<const D: usize>(
    choice: &ProfileChoice,
    place: std::ops::Range<usize>,
    components: usize,
    mesh: &MeshSetup<D>,
    context: Context<'_>,
) -> Result<Vec<Profile<D>>, SceneError> {
    let each = |what: &str, amount: &Spanned<Amount>| amounts(what, amount, components, context);
    let checked = |shape: Shape<D>| match shape.check() {
        Ok(()) => Ok(shape),
        Err(error) => {
            Err(context.error(place.clone(), error.to_string(), "give finite numbers, and lengths above 0"))
        }
    };
    let inclusions = |background: &Spanned<Amount>, shapes: Vec<(Shape<D>, Vec<f64>)>| {
        let background = each("the background", background)?;
        let of_component = |k: usize| Profile::Inclusions {
            background: background[k],
            shapes: shapes.iter().map(|(shape, values)| (shape.clone(), values[k])).collect(),
        };
        Ok((0..components).map(of_component).collect())
    };
    match choice {
        ProfileChoice::Constant { value } => inclusions(value, Vec::new()),
        ProfileChoice::SquareWave { from, to, value, background } => {
            let (low, high) = (context.finite("from", from)?, context.finite("to", to)?);
            if high <= low {
                return Err(context.error(
                    to.span(),
                    format!("the square wave ends at {high}, and starts at {low}"),
                    "give a number above `from`",
                ));
            }
            let (mut lower, mut upper) = (mesh.lower, mesh.upper);
            (lower[0], upper[0]) = (low, high);
            let wave = Shape::Box {
                centre: (lower + upper) * 0.5,
                lengths: upper - lower,
                rotation: Rotation::identity(),
            };
            inclusions(background, vec![(checked(wave)?, each("the value", value)?)])
        }
        ProfileChoice::CircularWave { centre, radius, value, background } => {
            let centre = context.vector("the centre of the wave", centre)?;
            let wave = Shape::Sphere { centre, radius: context.positive("the radius of the wave", radius)? };
            inclusions(background, vec![(wave, each("the value", value)?)])
        }
        ProfileChoice::Sine { waves, mean, amplitude, phase } => {
            let waves: Vector<D> = context.vector("waves of the sine", waves)?;
            let length = mesh.upper - mesh.lower;
            let wave = Vector::from_fn(|axis, _| TAU * waves[axis] / length[axis]);
            if let Some(axis) = (0..D).find(|&axis| !wave[axis].is_finite()) {
                return Err(context.error(
                    place,
                    format!("{} waves along {} are too many", waves[axis], axis_name(axis)),
                    "give fewer waves",
                ));
            }
            let (mean, amplitude) = (each("the mean", mean)?, each("the amplitude", amplitude)?);
            let phase = context.finite("the phase", phase)?;
            let of_component =
                |k: usize| Profile::Sine { mean: mean[k], amplitude: amplitude[k], wave, phase };
            Ok((0..components).map(of_component).collect())
        }
        ProfileChoice::Inclusions { shapes, background } => {
            let resolved = shapes.iter().map(|InclusionSection { shape, value }| {
                Ok((shape::resolve(shape, context)?, each("the value", value)?))
            });
            inclusions(background, resolved.collect::<Result<_, SceneError>>()?)
        }
    }
}
