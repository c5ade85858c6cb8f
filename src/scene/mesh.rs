//! `[mesh]`: the box, its cells and their distortion.

use std::ops::Range;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use toml::Spanned;
use vofkit_geometry::Vector;

use super::context::{Context, Numbers, default};
use super::error::SceneError;
use super::motion::{self, MotionChoice};
use crate::import::StructuredGrid;
use crate::mesh::{Distortion, MeshMotion, axis_name};

/// More cells than this would need more memory than machines have.
const MOST_CELLS: usize = 1_000_000_000;

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields, expecting = "a table with cells, lower, upper, distortion, motion, file")]
pub(super) struct MeshSection {
    /// Cells per direction; their number, 2 or 3, is the number of dimensions.
    #[serde(skip_serializing_if = "Option::is_none")]
    cells: Option<Spanned<Vec<i64>>>,
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
    /// A structured grid in place of the box, its path relative to the folder of the scene file.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<Spanned<String>>,
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

/// The file has cells, corners and nodes.
fn both(file: &Spanned<String>, other: &str, context: Context<'_>) -> SceneError {
    context.error(
        file.span(),
        format!("mesh.file and mesh.{other} are both given"),
        format!(
            "leave out one of them: the cells and nodes of a file are used as they are, without mesh.{other}"
        ),
    )
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
    /// The nodes of the mesh, where they come from a file: the box is then only what they fill.
    pub file: Option<MeshFile<D>>,
}

/// A mesh from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile<const D: usize> {
    /// The file.
    pub path: PathBuf,
    /// Its nodes, in the order of [`crate::mesh::Grid::node_index`].
    pub nodes: Vec<Vector<D>>,
    /// What one might not expect of it.
    pub notes: Vec<String>,
}

impl MeshSection {
    /// The number of dimensions, 2 or 3.
    pub(super) fn dimension(
        &self,
        cells: &Spanned<Vec<i64>>,
        context: Context<'_>,
    ) -> Result<usize, SceneError> {
        match cells.get_ref().len() {
            dimension @ (2 | 3) => Ok(dimension),
            count => Err(context.error(
                cells.span(),
                format!("mesh.cells is a list of {count}"),
                "give 2 numbers for a mesh of quadrilaterals or 3 for hexahedra",
            )),
        }
    }

    /// The place of what says which cells there are.
    pub(super) fn place(&self) -> Range<usize> {
        let cells = self.cells.as_ref().map(Spanned::span);
        cells.or_else(|| self.file.as_ref().map(Spanned::span)).unwrap_or_default()
    }

    /// The number of dimensions, and the grid that a file gives.
    pub(super) fn shape(
        &self,
        place: Range<usize>,
        context: Context<'_>,
    ) -> Result<(usize, Option<StructuredGrid>), SceneError> {
        match (&self.cells, &self.file) {
            (Some(cells), None) => Ok((self.dimension(cells, context)?, None)),
            (None, Some(file)) => {
                let grid = self.read(file, context)?;
                Ok((grid.dimension(), Some(grid)))
            }
            (Some(_), Some(file)) => Err(both(file, "cells", context)),
            (None, None) => Err(context.error(
                place,
                "missing key `cells`: the mesh has neither cells nor a file",
                "give mesh.cells, such as cells = [32, 32], or mesh.file, a VTK structured grid (.vts or .vtk)",
            )),
        }
    }

    fn read(&self, file: &Spanned<String>, context: Context<'_>) -> Result<StructuredGrid, SceneError> {
        let given = |numbers: &Option<Numbers>| numbers.is_some();
        let distorted = !matches!(self.distortion.get_ref(), DistortionChoice::None);
        let others =
            [("lower", given(&self.lower)), ("upper", given(&self.upper)), ("distortion", distorted)];
        if let Some((other, _)) = others.iter().find(|(_, given)| *given) {
            return Err(both(file, other, context));
        }
        StructuredGrid::read(context.source.beside(file.get_ref()))
            .map_err(|error| context.error(file.span(), error.to_string(), error.help()))
    }

    /// The mesh that a file gives.
    pub(super) fn resolve_file<const D: usize>(
        &self,
        grid: &StructuredGrid,
        context: Context<'_>,
    ) -> Result<MeshSetup<D>, SceneError> {
        let nodes = grid.nodes::<D>();
        let first = nodes.first().copied().unwrap_or_else(Vector::zeros);
        Ok(MeshSetup {
            cells: grid.cells(),
            lower: nodes.iter().fold(first, |low, x| low.inf(x)),
            upper: nodes.iter().fold(first, |high, x| high.sup(x)),
            distortion: Distortion::None,
            motion: self.motion(context)?,
            file: Some(MeshFile { path: grid.path().to_owned(), nodes, notes: grid.notes() }),
        })
    }

    fn motion<const D: usize>(&self, context: Context<'_>) -> Result<Option<MeshMotion<D>>, SceneError> {
        self.motion.as_ref().map(|motion| motion::resolve(motion, context)).transpose()
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
        Ok(MeshSetup { cells, lower, upper: corner, distortion, motion: self.motion(context)?, file: None })
    }

    fn counts<const D: usize>(&self, context: Context<'_>) -> Result<[usize; D], SceneError> {
        let place = self.place();
        let mut counts = [0; D];
        let given = self.cells.iter().flat_map(|cells| cells.get_ref());
        for (axis, (count, &asked)) in counts.iter_mut().zip(given).enumerate() {
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
