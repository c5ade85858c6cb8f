//! `[boundary]`: the ends of the axes, and what flows in.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::context::{Context, default};
use super::error::SceneError;
use crate::advection::{Boundary, End};
use crate::mesh::axis_name;

/// The name of no material.
pub(super) const VOID: &str = "void";

#[derive(Clone, Debug, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default, expecting = "a table with x, y, z, inflow")]
pub(super) struct BoundarySection {
    #[serde(skip_serializing_if = "Option::is_none")]
    x: Option<Spanned<Vec<Spanned<String>>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    y: Option<Spanned<Vec<Spanned<String>>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    z: Option<Spanned<Vec<Spanned<String>>>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    inflow: Option<Spanned<String>>,
}

/// What the scene says about the boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoundarySetup<const D: usize> {
    /// The ends that are given; the others become walls where nothing crosses them.
    pub ends: [[Option<End>; 2]; D],
    /// The axes whose ends are joined.
    pub periodic: [bool; D],
    /// The material that flows in; none for void.
    pub inflow: Option<usize>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Open(End),
    Periodic,
}

impl BoundarySection {
    fn axis(&self, axis: usize) -> Option<&Spanned<Vec<Spanned<String>>>> {
        [&self.x, &self.y, &self.z][axis].as_ref()
    }

    pub(super) fn resolve<const D: usize>(
        &mut self,
        materials: &[String],
        context: Context<'_>,
    ) -> Result<BoundarySetup<D>, SceneError> {
        if let (2, Some(z)) = (D, &self.z) {
            return Err(context.error(
                z.span(),
                "there is no z direction in two dimensions",
                "leave out boundary.z",
            ));
        }
        let mut setup = BoundarySetup { ends: [[None; 2]; D], periodic: [false; D], inflow: None };
        for axis in 0..D {
            let Some(list) = self.axis(axis) else { continue };
            match ends(axis, list, context)? {
                [Kind::Open(lower), Kind::Open(upper)] => setup.ends[axis] = [Some(lower), Some(upper)],
                _ => setup.periodic[axis] = true,
            }
        }
        let inflow = self.inflow.get_or_insert_with(|| default(VOID.to_owned()));
        let known: Vec<(&str, Option<usize>)> = std::iter::once((VOID, None))
            .chain(materials.iter().enumerate().map(|(k, name)| (name.as_str(), Some(k))))
            .collect();
        setup.inflow = context.word("the inflow material", inflow, &known)?;
        Ok(setup)
    }

    /// The place of what the scene says about an axis.
    pub(super) fn place(&self, axis: usize) -> std::ops::Range<usize> {
        self.axis(axis).map_or(0..0, Spanned::span)
    }

    /// Writes down what each end turned out to be.
    pub(super) fn fill<const D: usize>(&mut self, periodic: [bool; D], boundary: &Boundary<D>) {
        let word = |axis: usize, side: usize| match boundary.ends[axis][side] {
            _ if periodic[axis] => "periodic",
            End::Wall => "wall",
            End::Outflow => "outflow",
        };
        let words = |axis: usize| {
            (axis < D).then(|| default([0, 1].map(|side| default(word(axis, side).to_owned())).to_vec()))
        };
        [self.x, self.y, self.z] = [words(0), words(1), words(2)];
    }
}

fn ends(
    axis: usize,
    list: &Spanned<Vec<Spanned<String>>>,
    context: Context<'_>,
) -> Result<[Kind; 2], SceneError> {
    let known = [
        ("wall", Kind::Open(End::Wall)),
        ("outflow", Kind::Open(End::Outflow)),
        ("periodic", Kind::Periodic),
    ];
    let name = axis_name(axis);
    let [lower, upper] = list.get_ref().as_slice() else {
        return Err(context.error(
            list.span(),
            format!("boundary.{name} is a list of {}", list.get_ref().len()),
            "give two, for the lower and the upper end, such as [\"wall\", \"outflow\"]",
        ));
    };
    let meaning = |word| context.word("the boundary", word, &known);
    let kinds = [meaning(lower)?, meaning(upper)?];
    if kinds.contains(&Kind::Periodic) && kinds[0] != kinds[1] {
        return Err(context.error(
            list.span(),
            format!("boundary.{name} is periodic at one end only"),
            format!("write {name} = [\"periodic\", \"periodic\"], or no periodic end"),
        ));
    }
    Ok(kinds)
}
