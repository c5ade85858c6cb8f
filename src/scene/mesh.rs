//! `[mesh]`: the box, its cells and their distortion.

use serde::{Deserialize, Serialize};
use toml::Spanned;
use vofkit_geometry::Vector;

use super::context::{Context, Numbers, default};
use super::error::SceneError;
use super::motion::{self, MotionChoice};
use crate::mesh::{Distortion, MeshMotion, axis_name};

/// More cells than this would need more memory than machines have.
const MOST_CELLS: usize = 1_000_000_000;

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "a table with cells, lower, upper, distortion, motion")]
pub(super) struct MeshSection {
    /// Cells per direction; their number, 2 or 3, is the number of dimensions.
    pub(super) cells: Spanned<Vec<i64>>,
    /// The lower corner of the box; zeros by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) lower: Option<Numbers>,
    /// The upper corner of the box; ones by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) upper: Option<Numbers>,
    #[serde(default = "no_distortion")]
    pub(super) distortion: Spanned<DistortionChoice>,
    /// How the mesh moves, in mode "remesh".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) motion: Option<Spanned<MotionChoice>>,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum DistortionChoice {
    None,
    Random {
        amplitude: f64,
        #[serde(default)]
        seed: u64,
    },
    Wave {
        amplitude: f64,
    },
    Twist {
        angle: f64,
    },
}

fn no_distortion() -> Spanned<DistortionChoice> {
    default(DistortionChoice::None)
}

/// The box of the scene, its cells and their distortion.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshSetup<const D: usize> {
    /// Cells per direction.
    pub cells: [usize; D],
    /// The lower corner of the box.
    pub lower: Vector<D>,
    /// The upper corner of the box.
    pub upper: Vector<D>,
    /// How nodes are moved.
    pub distortion: Distortion,
    /// How they move over the run; none for a mesh that stands still.
    pub motion: Option<MeshMotion<D>>,
}

impl MeshSection {
    /// The number of dimensions, 2 or 3.
    pub(super) fn dimension(&self, context: Context<'_>) -> Result<usize, SceneError> {
        match self.cells.get_ref().len() {
            dimension @ (2 | 3) => Ok(dimension),
            count => Err(context.error(
                self.cells.span(),
                format!("mesh.cells is a list of {count}"),
                "give 2 numbers for a mesh of quadrilaterals or 3 for hexahedra",
            )),
        }
    }

    pub(super) fn resolve<const D: usize>(
        &mut self,
        context: Context<'_>,
    ) -> Result<MeshSetup<D>, SceneError> {
        let lower = self.lower.get_or_insert_with(|| default(vec![0.0; D]));
        let below = lower.span();
        let lower = context.vector::<D>("mesh.lower", lower)?;
        let upper = self.upper.get_or_insert_with(|| default(vec![1.0; D]));
        let corner = context.vector::<D>("mesh.upper", upper)?;
        // Defaults have no place.
        let place = if upper.span().is_empty() { below } else { upper.span() };
        for axis in 0..D {
            let (low, high) = (lower[axis], corner[axis]);
            if !(high - low > 0.0 && (high - low).is_finite()) {
                let name = axis_name(axis);
                return Err(context.error(
                    place,
                    format!("the box is empty along {name}: mesh.lower is {low}, mesh.upper {high}"),
                    format!("give an upper end along {name} that is above the lower end"),
                ));
            }
        }
        let distortion = match *self.distortion.get_ref() {
            DistortionChoice::None => Distortion::None,
            DistortionChoice::Random { amplitude, seed } => Distortion::Random { amplitude, seed },
            DistortionChoice::Wave { amplitude } => Distortion::Wave { amplitude },
            DistortionChoice::Twist { angle } => Distortion::Twist { angle },
        };
        let cells = self.counts(context)?;
        let motion = self.motion.as_ref().map(|motion| motion::resolve(motion, context)).transpose()?;
        Ok(MeshSetup { cells, lower, upper: corner, distortion, motion })
    }

    fn counts<const D: usize>(&self, context: Context<'_>) -> Result<[usize; D], SceneError> {
        let place = self.cells.span();
        let mut counts = [0; D];
        for (axis, (count, &asked)) in counts.iter_mut().zip(self.cells.get_ref()).enumerate() {
            *count = usize::try_from(asked).ok().filter(|&n| n > 0).ok_or_else(|| {
                context.error(
                    place.clone(),
                    format!("mesh.cells asks for {asked} cells along {}", axis_name(axis)),
                    "give whole numbers of at least 1",
                )
            })?;
        }
        let total = counts.iter().try_fold(1_usize, |total, &count| total.checked_mul(count));
        if total.is_none_or(|total| total > MOST_CELLS) {
            let total: f64 = counts.iter().map(|&count| count as f64).product();
            return Err(context.error(
                place,
                format!("mesh.cells asks for {total:.3e} cells, which do not fit into memory"),
                format!("ask for no more than {MOST_CELLS} cells in all"),
            ));
        }
        Ok(counts)
    }
}
