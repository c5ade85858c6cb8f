//! What a run tells about itself: the content of `summary.json`, and [`table`] for people; [`still`] is the same for a
//! reconstruction of which nothing moves. Longer reports are a [`document`], with the [`machine`] that made them at its foot.

pub mod document;
pub mod machine;
pub mod still;
pub mod table;

use serde::Serialize;

use crate::interface::Counts;
use crate::stopwatch::PhaseSeconds;

/// The account of a whole run. Volumes are areas in two dimensions.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// The name of the scene.
    pub scene: String,
    /// 2 or 3.
    pub dimension: usize,
    /// Number of cells.
    pub cells: usize,
    /// Cells along each direction.
    pub cells_per_direction: Vec<usize>,
    /// Time steps.
    pub steps: usize,
    /// The end.
    pub end_time: f64,
    /// The time step.
    pub dt: f64,
    /// Threads that the work was shared among.
    pub threads: usize,
    /// Seconds from the start to the last file, but for this one.
    pub wall_seconds: f64,
    /// The same by phase.
    pub seconds: PhaseSeconds,
    /// The Courant number of a step, at the largest amplitude of the velocity.
    pub max_courant: f64,
    /// The largest `|sum of the fluxes out of a cell| dt / V`.
    pub max_divergence: f64,
    /// The largest number of parts that a step was split into.
    pub substeps: usize,
    /// Mixed cells, on average over the steps.
    pub mixed_cells_mean: f64,
    /// Interface planes placed, each for one material in one cell in one sweep.
    pub cells_reconstructed: usize,
    /// Plane constants in closed form.
    pub positions_closed_form: usize,
    /// Plane constants by iteration.
    pub positions_iterative: usize,
    /// Evaluations of truncated volumes per plane constant by iteration; none without any.
    pub evaluations_per_position: Option<f64>,
    /// What became of the normals.
    pub normals: Normals,
    /// Corrections of all materials together.
    pub corrections: Corrections,
    /// What did not have to be done.
    pub skipped: Skipped,
    /// The mean gap between the facets of neighbouring cells at the end; none without facets that meet.
    pub facet_gap_mean: Option<f64>,
    /// The factor on the coordinates in OBJ files; none where it is 1 or nothing was written.
    pub obj_scale: Option<f64>,
    /// What one might not expect, in words: output times and flips that are never reached, odd cells.
    pub notes: Vec<String>,
    /// The materials.
    pub materials: Vec<MaterialSummary>,
    /// The quantities that belong to the materials.
    pub quantities: Vec<QuantitySummary>,
    /// The quantities that belong to the mesh.
    pub fields: Vec<FieldSummary>,
    /// The files in the output folder, this one included.
    pub files: Vec<String>,
}

/// Corrections that concern all materials.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Corrections {
    /// The largest change of a fraction by a correction.
    pub largest_fraction: f64,
    /// The cell, by its index along each direction, where that was.
    pub largest_in_cell: Vec<usize>,
    /// Mixed cells without a normal, counted each time.
    pub no_normal: usize,
    /// Pre-images of the unsplit scheme that were cut and may fold over, counted each time.
    pub preimages_folded: usize,
}

/// Normals by what became of them, counted each time a plane was asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Normals {
    /// Planes that the patch around the cell determines.
    pub determined: usize,
    /// Planes that it does not: they have the normal that the method started from.
    pub undetermined: usize,
    /// Cells without a normal, all fractions around being the same.
    pub flat: usize,
    /// Without a normal, alone among equals.
    pub isolated: usize,
    /// Without a normal, what is around pulling in no direction.
    pub balanced: usize,
    /// Without the centroid that the method needs.
    pub no_centroid: usize,
    /// Plane constants found on the way to a normal, on average; none without any plane.
    pub trials_per_plane: Option<f64>,
}

impl From<&Counts> for Normals {
    fn from(counts: &Counts) -> Self {
        let planes = counts.mixed - counts.no_normal();
        Self {
            determined: planes - counts.undetermined,
            undetermined: counts.undetermined,
            flat: counts.flat,
            isolated: counts.isolated,
            balanced: counts.balanced,
            no_centroid: counts.no_centroid,
            trials_per_plane: (planes > 0).then(|| counts.trials as f64 / planes as f64),
        }
    }
}

/// What did not have to be done.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Skipped {
    /// Cells, materials and sweeps without a plane.
    pub reconstructions: Share,
    /// Faces, materials and sweeps whose swept region was not cut; unsplit: cells and steps whose pre-image was not.
    pub cuts: Share,
    /// Kinds of files that the scene did not ask for.
    pub outputs: Vec<String>,
    /// Output times after the end.
    pub times_after_end: Vec<f64>,
}

/// How many of how many were skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Share {
    /// Those that were skipped.
    pub skipped: usize,
    /// All that there were.
    pub of: usize,
}

impl Share {
    /// The share of which `done` were done.
    pub fn without(done: usize, of: usize) -> Self {
        Self { skipped: of.saturating_sub(done), of }
    }
}

/// The account of one material.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MaterialSummary {
    /// Its name.
    pub name: String,
    /// Its volume at the start.
    pub volume_initial: f64,
    /// Its volume at the end.
    pub volume_final: f64,
    /// What left through the boundary, less what came in.
    pub boundary_volume: f64,
    /// `(final - initial + boundary) / initial`; none if there was nothing.
    pub volume_drift: Option<f64>,
    /// The smallest fraction over the run, before correction.
    pub fraction_min: f64,
    /// The largest fraction over the run, before correction.
    pub fraction_max: f64,
    /// `sum |f - f_exact| V` against the exact final shape; none where that is not known.
    pub shape_error: Option<f64>,
    /// The same over the initial volume.
    pub shape_error_relative: Option<f64>,
    /// Fragments at the end: connected pieces that hold more than 1e-4 of the material.
    pub fragments: usize,
    /// The part of the volume outside the largest piece.
    pub stray_volume: f64,
    /// Corrections over the run.
    pub corrections: MaterialCorrections,
}

/// The account of one quantity of a material; components are added up.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct QuantitySummary {
    /// Its name.
    pub name: String,
    /// The name of its material.
    pub material: String,
    /// The drift of `sum phi f V`, or of `sum phi rho f V` where a density weighs it, less what crossed the boundary, relative to the
    /// initial sum of its magnitudes; none if that was 0.
    pub conserved: Option<f64>,
    /// The least value over the run, where there is material.
    pub minimum: f64,
    /// The largest value over the run, where there is material.
    pub maximum: f64,
    /// What limiting values and correcting fractions moved, without sign, relative to the same sum.
    pub corrected: Option<f64>,
}

/// The account of one field; components are added up.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct FieldSummary {
    /// Its name.
    pub name: String,
    /// The drift of `sum phi V`, or of `sum phi rho V` where a density carries the field, less what crossed the boundary, relative to the
    /// initial sum of its magnitudes; none if that was 0.
    pub conserved: Option<f64>,
    /// The least value over the run.
    pub minimum: f64,
    /// The largest value over the run.
    pub maximum: f64,
    /// The total variation along mesh lines at the start.
    pub total_variation_initial: f64,
    /// The total variation at the end.
    pub total_variation_final: f64,
    /// `sum |phi - phi_exact| V` over the volume of the mesh; none where the exact values are not known.
    pub l1_error: Option<f64>,
}

/// Corrections of one material over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MaterialCorrections {
    /// Volume moved by setting fractions below 0 to 0 and above 1 to 1, added up without sign.
    pub clipped: f64,
    /// Volume taken where the fractions of a cell added up to more than 1.
    pub rescaled: f64,
    /// Volume removed with wisps.
    pub wisps: f64,
    /// Volume that came from the divergence of a velocity from files, where the scene lets it dilate materials.
    pub dilated: f64,
}
