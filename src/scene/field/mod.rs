//! `[[field]]`: quantities that belong to the mesh, where they are, how they start (`profile`) and how they are moved (`method`).

mod method;
mod profile;

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::context::{Context, default};
use super::error::SceneError;
use super::mesh::MeshSetup;
use super::wording::check_name;
use crate::nodal::NodalScheme;
use crate::profile::Profile;
use crate::volume_associated::{Limiter, PointScheme, Scheme};
pub(super) use profile::{Amount, ProfileChoice, amounts, profiles};

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(
    deny_unknown_fields,
    expecting = "a table with name, kind, location, initial, scheme, limiter, smoothing, alpha, volume_matrix, nodal, weighting, inflow"
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
    smoothing: Option<Spanned<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    alpha: Option<Spanned<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    volume_matrix: Option<Spanned<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    nodal: Option<Spanned<String>>,
    #[serde(default = "volume")]
    weighting: Spanned<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inflow: Option<Spanned<Amount>>,
}

pub(super) fn word(text: &str) -> Spanned<String> {
    default(text.to_owned())
}

pub(super) fn scalar() -> Spanned<String> {
    word("scalar")
}

fn cell() -> Spanned<String> {
    word("cell")
}

pub(super) fn muscl() -> Spanned<String> {
    word("muscl")
}

pub(super) fn volume() -> Spanned<String> {
    word(VOLUME)
}

/// What carries fields that no density carries.
pub(super) const VOLUME: &str = "volume";

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

/// The words for them.
pub(super) const KINDS: [(&str, Kind); 3] =
    [("scalar", Kind::Scalar), ("vector", Kind::Vector), ("tensor", Kind::Tensor)];

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

/// How a field is moved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// By what crosses the faces of cells.
    Faces(Scheme),
    /// At integration points: where the field has its values there all of them, else in the middle of each cell.
    Points(PointScheme),
}

impl Method {
    /// The limiter of the slopes, where the scheme has slopes.
    pub fn limiter(&self) -> Option<Limiter> {
        match self {
            Self::Faces(scheme) => scheme.limiter(),
            Self::Points(_) => None,
        }
    }
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
    pub method: Method,
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
    if let Method::Points(_) = density.method {
        return Err(wrong("is no density whose mass is conserved: its scheme moves no volumes"));
    }
    if density.name == *section.name.get_ref() {
        return Err(wrong("is the field itself"));
    }
    Ok(Some(k))
}

impl FieldSection {
    /// Where it says how the field starts.
    pub(super) fn initial_place(&self) -> std::ops::Range<usize> {
        self.initial.span()
    }

    fn resolve<const D: usize>(
        &mut self,
        mesh: &MeshSetup<D>,
        context: Context<'_>,
    ) -> Result<FieldSetup<D>, SceneError> {
        let kind = context.word("the kind of field", &self.kind, &KINDS)?;
        let nodal = match &self.nodal {
            None => NodalScheme::default(),
            Some(nodal) => {
                let known = [("his", NodalScheme::HalfIndexShift), ("sale", NodalScheme::Averaging)];
                context.word("the nodal scheme", nodal, &known)?
            }
        };
        let locations =
            [("cell", Location::Cell), ("node", Location::Node(nodal)), ("points", Location::Points)];
        let location = context.word("the location", &self.location, &locations)?;
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
        let method = self.method(context)?;
        let components = kind.components(D);
        let inflow = self.inflow.as_ref().map(|inflow| amounts("the inflow", inflow, components, context));
        let place = self.initial.span();
        Ok(FieldSetup {
            name: self.name.get_ref().clone(),
            kind,
            location,
            initial: profiles(self.initial.get_ref(), place, components, mesh, context)?,
            method,
            density: None,
            inflow: inflow.transpose()?,
        })
    }
}
