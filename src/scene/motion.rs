//! `mesh.motion`: how the mesh moves while the material rests.

use serde::{Deserialize, Serialize};
use toml::Spanned;
use vofkit_geometry::Vector;

use super::context::{Context, Numbers, axis};
use super::error::SceneError;
use crate::mesh::{Distortion, MeshMotion};
use crate::whole_file;

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum MotionChoice {
    Random {
        amplitude: f64,
        #[serde(default)]
        seed: u64,
        #[serde(default = "once")]
        swings: Spanned<i64>,
    },
    Wave {
        amplitude: f64,
        #[serde(default = "once")]
        swings: Spanned<i64>,
    },
    Twist {
        angle: f64,
        #[serde(default = "once")]
        swings: Spanned<i64>,
    },
    Smooth {
        #[serde(default = "once")]
        swings: Spanned<i64>,
    },
    Rotate {
        centre: Numbers,
        angle: Spanned<f64>,
        #[serde(skip_serializing_if = "Option::is_none")]
        axis: Option<Numbers>,
    },
    /// Tables of node places, one file for each.
    Nodes(Vec<Spanned<String>>),
}

fn once() -> Spanned<i64> {
    super::context::default(1)
}

/// More swings than this are a slip in the scene.
const MOST_SWINGS: i64 = 1_000_000;

pub(super) fn resolve<const D: usize>(
    motion: &Spanned<MotionChoice>,
    context: Context<'_>,
) -> Result<MeshMotion<D>, SceneError> {
    let counted = |swings: &Spanned<i64>| match *swings.get_ref() {
        count @ 1..=MOST_SWINGS => Ok(count as usize),
        count => Err(context.error(
            swings.span(),
            format!("the motion of the mesh has {count} swings"),
            format!("give a whole number from 1, which is there and not back, to {MOST_SWINGS}"),
        )),
    };
    let towards = |distortion: Distortion, swings: &Spanned<i64>| {
        Ok(MeshMotion::Distort { distortion, swings: counted(swings)? })
    };
    match motion.get_ref() {
        MotionChoice::Random { amplitude, seed, swings } => {
            towards(Distortion::Random { amplitude: *amplitude, seed: *seed }, swings)
        }
        MotionChoice::Wave { amplitude, swings } => {
            towards(Distortion::Wave { amplitude: *amplitude }, swings)
        }
        MotionChoice::Twist { angle, swings } => towards(Distortion::Twist { angle: *angle }, swings),
        MotionChoice::Smooth { swings } => Ok(MeshMotion::Smooth { swings: counted(swings)? }),
        MotionChoice::Rotate { centre, angle, axis: about } => {
            let centre = context.vector("the centre of the rotation", centre)?;
            let angle = context.finite("the angle", angle)?;
            let axis = match about {
                Some(about) => axis::<D>(about, context)?,
                None => Vector::<3>::z(),
            };
            Ok(MeshMotion::Rotate { centre, axis, angle })
        }
        MotionChoice::Nodes(files) => {
            let sets = files.iter().map(|file| nodes(file, context)).collect::<Result<_, _>>()?;
            Ok(MeshMotion::Through(sets))
        }
    }
}

/// The places of all nodes, the first axis running fastest, from a table with a line `x,y` or `x,y,z` at its head. Relative
/// paths start from the folder of the scene.
fn nodes<const D: usize>(file: &Spanned<String>, context: Context<'_>) -> Result<Vec<Vector<D>>, SceneError> {
    let name = file.get_ref();
    let wrong = |problem: String| {
        let header = &"x,y,z"[..2 * D - 1];
        context.error(
            file.span(),
            format!("the node file {name} {problem}"),
            format!(
                "give a table with the line \"{header}\" and then one line for each node, those along x first"
            ),
        )
    };
    let path = context.source.beside(name);
    let text = whole_file::text(&path).map_err(|error| wrong(format!("cannot be read: {error}")))?;
    let mut lines = text.lines().enumerate();
    let names: Vec<&str> =
        lines.next().map(|(_, line)| line.split(',').map(str::trim).collect()).unwrap_or_default();
    if names != ["x", "y", "z"][..D] {
        return Err(wrong(format!("starts with \"{}\"", names.join(","))));
    }
    let lines = lines.filter(|(_, line)| !line.trim().is_empty());
    lines
        .map(|(number, line)| {
            let values: Result<Vec<f64>, _> = line.split(',').map(|value| value.trim().parse()).collect();
            match values {
                Ok(values) if values.len() == D => Ok(Vector::from_fn(|k, _| values[k])),
                _ => Err(wrong(format!("has the line {}: \"{line}\"", number + 1))),
            }
        })
        .collect()
}
