//! `[[material.quantity]]`: quantities that belong to a material and travel with it.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::context::Context;
use super::error::SceneError;
use super::field::{Amount, KINDS, Kind, ProfileChoice, VOLUME, amounts, muscl, profiles, scalar, volume};
use super::mesh::MeshSetup;
use super::wording::check_name;
use crate::profile::Profile;
use crate::quantity::Distribution;

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "a table with name, kind, initial, scheme, weighting, inflow")]
pub(super) struct QuantitySection {
    name: Spanned<String>,
    #[serde(default = "scalar")]
    kind: Spanned<String>,
    initial: Spanned<ProfileChoice>,
    #[serde(default = "muscl")]
    scheme: Spanned<String>,
    #[serde(default = "volume")]
    weighting: Spanned<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inflow: Option<Spanned<Amount>>,
}

/// A quantity of a material in the words of the toolkit.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantitySetup<const D: usize> {
    /// The name.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// The start, by component.
    pub initial: Vec<Profile<D>>,
    /// How it is distributed over a cell.
    pub distribution: Distribution,
    /// The density, by its place among the quantities of the material, with whose mass it is conserved; none for volume.
    pub density: Option<usize>,
    /// The values in material that flows in, by component.
    pub inflow: Option<Vec<f64>>,
}

/// The quantities of a material; `flows_in` where it does through open ends.
pub(super) fn resolve_all<const D: usize>(
    sections: &[QuantitySection],
    flows_in: bool,
    mesh: &MeshSetup<D>,
    context: Context<'_>,
) -> Result<Vec<QuantitySetup<D>>, SceneError> {
    let mut quantities: Vec<QuantitySetup<D>> = Vec::new();
    for section in sections {
        check_name("the quantity", &section.name, context)?;
        let name = section.name.get_ref();
        if quantities.iter().any(|other| other.name == *name) {
            return Err(context.error(
                section.name.span(),
                format!("the material has two quantities called \"{name}\""),
                "give each quantity of a material a name of its own",
            ));
        }
        let kind = context.word("the kind of quantity", &section.kind, &KINDS)?;
        let schemes = [("donor", Distribution::Constant), ("muscl", Distribution::Linear)];
        let inflow = section.inflow.as_ref();
        let inflow = inflow.map(|inflow| amounts("the inflow", inflow, kind.components(D), context));
        if flows_in && inflow.is_none() {
            return Err(context.error(
                section.name.span(),
                format!("the material flows in through open ends, and nothing says with which \"{name}\""),
                "add inflow = .. to the quantity",
            ));
        }
        let initial = section.initial.get_ref();
        quantities.push(QuantitySetup {
            name: name.clone(),
            kind,
            initial: profiles(initial, section.initial.span(), kind.components(D), mesh, context)?,
            distribution: context.word("the scheme of a quantity", &section.scheme, &schemes)?,
            density: None,
            inflow: inflow.transpose()?,
        });
    }
    for k in 0..quantities.len() {
        quantities[k].density = density(&sections[k], sections, &quantities, context)?;
    }
    Ok(quantities)
}

/// The density with whose mass a quantity is conserved.
fn density<const D: usize>(
    section: &QuantitySection,
    sections: &[QuantitySection],
    quantities: &[QuantitySetup<D>],
    context: Context<'_>,
) -> Result<Option<usize>, SceneError> {
    let wanted = section.weighting.get_ref();
    if wanted == VOLUME {
        return Ok(None);
    }
    let is_density =
        |k: &usize| quantities[*k].kind == Kind::Scalar && sections[*k].weighting.get_ref() == VOLUME;
    let found = quantities.iter().position(|other| other.name == *wanted).filter(is_density);
    match found {
        Some(k) => Ok(Some(k)),
        None => Err(context.error(
            section.weighting.span(),
            format!("the weighting \"{wanted}\" is no density of the material"),
            "name a scalar quantity of the same material that is weighted with \"volume\", or write \"volume\"",
        )),
    }
}
