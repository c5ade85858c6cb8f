//! `[[material]]`: what there is, and where it is at the start.

use std::ops::Range;

use serde::{Deserialize, Serialize};
use toml::Spanned;
use vofkit_geometry::Vector;

use super::context::{Context, default};
use super::error::SceneError;
use super::quantity::{QuantitySection, QuantitySetup};
use super::wording::check_text;
use super::{boundary, shape};
use crate::import::{ImportError, StructuredGrid};
use crate::interface::Reconstruction;
use crate::shape::Shape;

/// A material and where it is at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialSetup<const D: usize> {
    /// The name.
    pub name: String,
    /// The shape that it fills; none where the file of the mesh has the fractions.
    pub shape: Option<Shape<D>>,
    /// Whether there may be nothing of it in the domain.
    pub allow_empty: bool,
    /// What belongs to it.
    pub quantities: Vec<QuantitySetup<D>>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "a table with name, shape, allow_empty, quantity")]
pub(super) struct MaterialSection {
    pub(super) name: Spanned<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shape: Option<Spanned<shape::ShapeChoice>>,
    #[serde(default)]
    allow_empty: bool,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) quantity: Vec<QuantitySection>,
}

impl MaterialSection {
    /// A material whose fractions a file has.
    pub(super) fn from_file(name: &str) -> Self {
        Self { name: default(name.to_owned()), shape: None, allow_empty: true, quantity: Vec::new() }
    }

    /// The place of what says where the material is.
    pub(super) fn place(&self) -> Range<usize> {
        self.shape.as_ref().map_or_else(|| self.name.span(), Spanned::span)
    }
}

/// The materials; only those of a mesh from a file may do without a shape.
pub(super) fn resolve<const D: usize>(
    sections: &[MaterialSection],
    from_file: bool,
    context: Context<'_>,
) -> Result<Vec<MaterialSetup<D>>, SceneError> {
    let mut materials: Vec<MaterialSetup<D>> = Vec::new();
    for MaterialSection { name, shape, allow_empty, .. } in sections {
        let text = name.get_ref();
        check_text("the material", name, context)?;
        if text == boundary::VOID {
            return Err(context.error(
                name.span(),
                "a material cannot be called \"void\": that is where no material is",
                "choose another name",
            ));
        }
        if materials.iter().any(|other| other.name == *text) {
            return Err(context.error(
                name.span(),
                format!("there are two materials called \"{text}\""),
                "give each material a name of its own",
            ));
        }
        let shape = match shape {
            Some(shape) => Some(shape::resolve(shape, context)?),
            None if from_file => None,
            None => {
                return Err(context.error(
                    name.span(),
                    format!("missing key `shape`: nothing says where the material \"{text}\" is"),
                    "give the [[material]] a shape, such as { disc = { centre = [0.5, 0.5], radius = 0.2 } }",
                ));
            }
        };
        let quantities = Vec::new();
        materials.push(MaterialSetup { name: text.clone(), shape, allow_empty: *allow_empty, quantities });
    }
    Ok(materials)
}

/// What the file of a mesh has of all materials, by material and cell.
#[derive(Clone, Debug, PartialEq)]
pub struct FileParts<const D: usize> {
    /// Their fractions.
    pub fractions: Vec<Vec<f64>>,
    /// Their centroids, where the normal method reads them.
    pub centroids: Option<Vec<Vec<Vector<D>>>>,
}

/// What the file of the mesh has of all materials; nothing if they have shapes.
pub(super) fn parts<const D: usize>(
    sections: &[MaterialSection],
    grid: &StructuredGrid,
    method: Reconstruction,
    mesh: Range<usize>,
    context: Context<'_>,
) -> Result<Option<FileParts<D>>, SceneError> {
    let shaped = sections.iter().find_map(|section| section.shape.as_ref());
    let bare = sections.iter().find(|section| section.shape.is_none());
    match (shaped, bare) {
        (_, None) => Ok(None),
        (None, Some(_)) => {
            let wrong = |section: &MaterialSection, error: ImportError| {
                let place = section.name.span();
                let place = if place.is_empty() { mesh.clone() } else { place };
                context.error(place, error.to_string(), error.help())
            };
            let fractions = |section: &MaterialSection| {
                let found = grid.fractions(section.name.get_ref());
                found.map(<[f64]>::to_vec).map_err(|error| wrong(section, error))
            };
            let centroids = |section: &MaterialSection| {
                grid.centroids(section.name.get_ref()).map_err(|error| wrong(section, error))
            };
            let fractions = sections.iter().map(fractions).collect::<Result<_, _>>()?;
            let all = || sections.iter().map(centroids).collect::<Result<_, _>>();
            Ok(Some(FileParts {
                fractions,
                centroids: method.normal.reads_centroids().then(all).transpose()?,
            }))
        }
        (Some(shaped), Some(bare)) => Err(context.error(
            shaped.span(),
            format!("this material has a shape, and \"{}\" has none", bare.name.get_ref()),
            "give all materials shapes, or none: then the file of the mesh has their fractions",
        )),
    }
}
