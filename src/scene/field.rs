//! `[[field]]`: quantities that belong to the mesh, where they are, how they start and how they are moved.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use toml::Spanned;
use vofkit_geometry::Vector;

use super::context::{Context, Numbers, default};
use super::error::SceneError;
use super::mesh::MeshSetup;
use super::shape::{self, ShapeChoice};
use super::wording::check_name;
use crate::mesh::axis_name;
use crate::nodal::NodalScheme;
use crate::profile::Profile;
use crate::shape::{Rotation, Shape};
use crate::volume_associated::{Limiter, Scheme};

/// The limiter of scenes that give none, as for the library.
const DEFAULT_LIMITER: &str = "van_leer";

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a table with name, kind, location, initial, scheme, limiter, alpha, nodal, weighting, inflow"
)]
pub(super) struct FieldSection {
    pub(super) name: Spanned<String>,
    #[serde(default = "scalar")]
    kind: Spanned<String>,
    #[serde(default = "cell")]
    location: Spanned<String>,
    initial: Spanned<ProfileChoice>,
    #[serde(default = "muscl")]
    scheme: Spanned<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    limiter: Option<Spanned<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha: Option<Spanned<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    nodal: Option<Spanned<String>>,
    #[serde(default = "volume")]
    weighting: Spanned<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inflow: Option<Spanned<Amount>>,
}

fn word(text: &str) -> Spanned<String> {
    default(text.to_owned())
}

fn scalar() -> Spanned<String> {
    word("scalar")
}

fn cell() -> Spanned<String> {
    word("cell")
}

fn muscl() -> Spanned<String> {
    word("muscl")
}

fn volume() -> Spanned<String> {
    word(VOLUME)
}

/// What carries fields that no density carries.
const VOLUME: &str = "volume";

/// One number, or one for each component.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(untagged, expecting = "a number, or a list of one for each component")]
enum Amount {
    One(f64),
    Each(Vec<f64>),
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum ProfileChoice {
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
struct InclusionSection {
    shape: Spanned<ShapeChoice>,
    value: Spanned<Amount>,
}

fn zero() -> Spanned<Amount> {
    default(Amount::One(0.0))
}

fn no_phase() -> Spanned<f64> {
    default(0.0)
}

/// What a field is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Scalar,
    /// A vector.
    Vector,
    /// A symmetric tensor: its diagonal, then xy, in three dimensions yz and xz too.
    Tensor,
}

impl Kind {
    /// The number of components.
    pub fn components(self, dimension: usize) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vector => dimension,
            Self::Tensor => dimension * (dimension + 1) / 2,
        }
    }
}

/// Where the values of a field are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// One mean value for each cell.
    Cell,
    /// One value at each node.
    Node(NodalScheme),
    /// One value at each of the `2^D` integration points of a cell.
    Points,
}

/// A field in the words of the toolkit.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldSetup<const D: usize> {
    /// The name.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// Where its values are.
    pub location: Location,
    /// The start, by component.
    pub initial: Vec<Profile<D>>,
    /// How it is moved.
    pub scheme: Scheme,
    /// The field, by its place in the scene, whose mass carries it; none for volume.
    pub density: Option<usize>,
    /// The value in what flows in, by component; none for that of the cell it flows into.
    pub inflow: Option<Vec<f64>>,
}

/// All fields of a scene.
pub(super) fn resolve_all<const D: usize>(
    sections: &mut [FieldSection],
    mesh: &MeshSetup<D>,
    context: Context<'_>,
) -> Result<Vec<FieldSetup<D>>, SceneError> {
    let mut fields: Vec<FieldSetup<D>> = Vec::new();
    for section in sections.iter_mut() {
        check_name("the field", &section.name, context)?;
        if fields.iter().any(|other| other.name == *section.name.get_ref()) {
            return Err(context.error(
                section.name.span(),
                format!("there are two fields called \"{}\"", section.name.get_ref()),
                "give each field a name of its own",
            ));
        }
        fields.push(section.resolve(mesh, context)?);
    }
    for k in 0..fields.len() {
        fields[k].density = density(&sections[k], &fields, context)?;
    }
    Ok(fields)
}

/// The density that carries a field.
fn density<const D: usize>(
    section: &FieldSection,
    fields: &[FieldSetup<D>],
    context: Context<'_>,
) -> Result<Option<usize>, SceneError> {
    let wanted = section.weighting.get_ref();
    if wanted == VOLUME {
        return Ok(None);
    }
    let wrong = |what: &str| {
        context.error(
            section.weighting.span(),
            format!("the weighting \"{wanted}\" {what}"),
            "name a scalar field at cells or points that is weighted with \"volume\", or write \"volume\"",
        )
    };
    let Some(k) = fields.iter().position(|field| field.name == *wanted) else {
        return Err(wrong("is neither \"volume\" nor the name of a field"));
    };
    let density = &fields[k];
    if density.kind != Kind::Scalar || matches!(density.location, Location::Node(_)) {
        return Err(wrong("is no density: it is not a scalar, or is at the nodes"));
    }
    if density.name == *section.name.get_ref() {
        return Err(wrong("is the field itself"));
    }
    Ok(Some(k))
}

impl FieldSection {
    fn resolve<const D: usize>(
        &mut self,
        mesh: &MeshSetup<D>,
        context: Context<'_>,
    ) -> Result<FieldSetup<D>, SceneError> {
        let kinds = [("scalar", Kind::Scalar), ("vector", Kind::Vector), ("tensor", Kind::Tensor)];
        let kind = context.word("the kind of field", &self.kind, &kinds, &[])?;
        let nodal = match &self.nodal {
            None => NodalScheme::default(),
            Some(nodal) => {
                let known = [("his", NodalScheme::HalfIndexShift), ("sale", NodalScheme::Averaging)];
                context.word("the nodal scheme", nodal, &known, &[])?
            }
        };
        let locations =
            [("cell", Location::Cell), ("node", Location::Node(nodal)), ("points", Location::Points)];
        let location = context.word("the location", &self.location, &locations, &[])?;
        match (&self.nodal, location) {
            (Some(nodal), Location::Cell | Location::Points) => {
                return Err(context.error(
                    nodal.span(),
                    "a nodal scheme is of use for fields at the nodes only",
                    "leave it out, or set location = \"node\"",
                ));
            }
            (None, Location::Node(_)) => self.nodal = Some(word("his")),
            _ => {}
        }
        let scheme = self.scheme(context)?;
        let components = kind.components(D);
        let inflow = self.inflow.as_ref().map(|inflow| amounts("the inflow", inflow, components, context));
        let place = self.initial.span();
        Ok(FieldSetup {
            name: self.name.get_ref().clone(),
            kind,
            location,
            initial: profiles(self.initial.get_ref(), place, components, mesh, context)?,
            scheme,
            density: None,
            inflow: inflow.transpose()?,
        })
    }

    fn scheme(&mut self, context: Context<'_>) -> Result<Scheme, SceneError> {
        let off = Limiter::Off;
        let schemes = [
            ("donor", Scheme::Donor),
            ("lax_wendroff", Scheme::LaxWendroff),
            ("fct", Scheme::Fct),
            ("tvd", Scheme::Tvd(off)),
            ("muscl", Scheme::Muscl(off)),
        ];
        let scheme =
            context.word("the scheme", &self.scheme, &schemes, &["direct", "lax_wendroff_galerkin"])?;
        if scheme.limiter().is_none() {
            let odd = self.limiter.as_ref().map(Spanned::span).or(self.alpha.as_ref().map(Spanned::span));
            return match odd {
                None => Ok(scheme),
                Some(place) => Err(context.error(
                    place,
                    format!("the scheme \"{}\" has no limiter", self.scheme.get_ref()),
                    "leave out limiter and alpha, or use the scheme \"tvd\" or \"muscl\"",
                )),
            };
        }
        let limiter = self.limiter.get_or_insert_with(|| word(DEFAULT_LIMITER));
        let known = [
            ("superbee", Limiter::Superbee),
            ("min_mod", Limiter::MinMod),
            ("woodward", Limiter::Woodward),
            ("van_leer", Limiter::VanLeer),
            ("scaled_min_mod", Limiter::ScaledMinMod { alpha: f64::NAN }),
            ("courant_min_mod", Limiter::CourantMinMod),
            ("off", off),
        ];
        let mut limiter = context.word("the limiter", limiter, &known, &[])?;
        match (&mut limiter, &self.alpha) {
            (Limiter::ScaledMinMod { alpha }, Some(given)) => {
                *alpha = *given.get_ref();
                limiter.check().map_err(|range| {
                    context.error(given.span(), range.to_string(), "give a number from 0 to 2")
                })?;
            }
            (Limiter::ScaledMinMod { .. }, None) => {
                return Err(context.error(
                    self.limiter.as_ref().map(Spanned::span).unwrap_or_default(),
                    "the limiter \"scaled_min_mod\" needs its factor alpha",
                    "add alpha = 1.0, or any number from 0 to 2",
                ));
            }
            (_, Some(alpha)) => {
                return Err(context.error(
                    alpha.span(),
                    "alpha is the factor of the limiter \"scaled_min_mod\" only",
                    "leave it out, or set limiter = \"scaled_min_mod\"",
                ));
            }
            (_, None) => {}
        }
        Ok(if let Scheme::Tvd(_) = scheme { Scheme::Tvd(limiter) } else { Scheme::Muscl(limiter) })
    }
}

/// As many finite numbers as there are components.
fn amounts(
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
fn profiles<const D: usize>(
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
