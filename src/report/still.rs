//! What a reconstruction tells about itself, for `summary.json` and for people.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use super::table;
use crate::interface::Counts;

/// The account of a static reconstruction. Volumes are areas in two dimensions, areas are lengths.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StillSummary {
    /// The name of the scene.
    pub scene: String,
    /// 2 or 3.
    pub dimension: usize,
    /// Number of cells.
    pub cells: usize,
    /// Cells along each direction.
    pub cells_per_direction: Vec<usize>,
    /// Threads that the work was shared among.
    pub threads: usize,
    /// Seconds from the start to the last file, but for this one.
    pub wall_seconds: f64,
    /// Those that the stages took.
    pub seconds: StageSeconds,
    /// The normal method.
    pub normal: String,
    /// Cells in which some material is mixed.
    pub mixed_cells: usize,
    /// The planes of all materials.
    pub planes: CountsByStatus,
    /// Plane constants in closed form.
    pub positions_closed_form: usize,
    /// Plane constants by iteration.
    pub positions_iterative: usize,
    /// Evaluations of truncated volumes per plane constant by iteration; none without any.
    pub evaluations_per_position: Option<f64>,
    /// Plane constants found on the way to a normal, on average over the mixed cells; none without any.
    pub trials_per_plane: Option<f64>,
    /// The same with the plane constants of the planes themselves.
    pub positions_per_plane: Option<f64>,
    /// Microseconds for normal and plane constant of one material in one mixed cell: time that passed, with all threads at work;
    /// none without any.
    pub microseconds_per_plane: Option<f64>,
    /// The mean gap between the facets of neighbouring cells; none without facets that meet.
    pub facet_gap_mean: Option<f64>,
    /// The factor on the coordinates in OBJ files; none where it is 1 or nothing was written.
    pub obj_scale: Option<f64>,
    /// Kinds of files that the scene did not ask for.
    pub skipped_outputs: Vec<String>,
    /// What one might not expect, in words.
    pub notes: Vec<String>,
    /// The materials.
    pub materials: Vec<StillMaterial>,
    /// The files in the output folder, this one included.
    pub files: Vec<String>,
}

/// Seconds by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StageSeconds {
    /// The mesh and what is precomputed of it.
    pub mesh: f64,
    /// Fractions from shapes, or their reading.
    pub fractions: f64,
    /// Normals.
    pub normals: f64,
    /// Plane constants.
    pub positions: f64,
    /// Planes as polygons.
    pub facets: f64,
    /// The comparison with the shapes.
    pub errors: f64,
}

/// The account of one material.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StillMaterial {
    /// Its name.
    pub name: String,
    /// Its volume.
    pub volume: f64,
    /// The area of its interface.
    pub area: f64,
    /// Its planes.
    pub planes: CountsByStatus,
    /// `E`: the volume of the symmetric difference of what its planes leave of their cells and its shape, without what other materials
    /// cover, in the cells where it is not one of several that are cut one after the other; none without a shape.
    pub symmetric_difference: Option<f64>,
    /// The mean Hausdorff distance of its facets in these cells from its disc or sphere; none for other shapes, or covered ones.
    pub hausdorff_mean: Option<f64>,
}

/// Mixed cells, one for each material in them, by [`CellStatus`](crate::interface::CellStatus).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CountsByStatus {
    /// With a plane that the cells around determine.
    pub plane: usize,
    /// With a plane that they do not determine.
    pub undetermined: usize,
    /// Without a normal, among equals.
    pub flat: usize,
    /// Without a normal, alone among equals.
    pub isolated: usize,
    /// Without a normal, between neighbours that differ but pull in no direction.
    pub balanced: usize,
    /// Without the centroid that the method needs.
    pub no_centroid: usize,
    /// Shared with other materials, which are cut one after the other.
    pub nested: usize,
}

impl From<&Counts> for CountsByStatus {
    fn from(counts: &Counts) -> Self {
        Self {
            plane: counts.mixed - counts.no_normal() - counts.undetermined,
            undetermined: counts.undetermined,
            flat: counts.flat,
            isolated: counts.isolated,
            balanced: counts.balanced,
            no_centroid: counts.no_centroid,
            nested: 0,
        }
    }
}

impl CountsByStatus {
    fn text(&self) -> String {
        let Self { plane, undetermined, flat, isolated, balanced, no_centroid, nested } = *self;
        let rare = [
            ("undetermined", undetermined),
            ("flat", flat),
            ("isolated", isolated),
            ("balanced", balanced),
            ("without a centroid", no_centroid),
            ("cut after others", nested),
        ];
        let told =
            rare.iter().filter(|(_, count)| *count > 0).map(|(name, count)| format!(", {count} {name}"));
        format!("{plane} with a plane{}", told.collect::<String>())
    }
}

/// The summary in a few aligned lines.
pub fn text(summary: &StillSummary, folder: &Path) -> String {
    let cells = table::product(&summary.cells_per_direction);
    let positions = summary.positions_closed_form + summary.positions_iterative;
    let mut rows = vec![
        ("scene", format!("{} ({cells} cells)", summary.scene)),
        ("normal", summary.normal.clone()),
        ("mixed cells", summary.mixed_cells.to_string()),
        ("planes", summary.planes.text()),
        ("closed form", format!("{} of {positions} plane constants", summary.positions_closed_form)),
    ];
    if let Some(time) = summary.microseconds_per_plane {
        rows.push(("time", format!("{time:.2} us per mixed cell with {} threads", summary.threads)));
    }
    if let Some(gap) = summary.facet_gap_mean {
        rows.push(("gap", format!("{gap:.3e} of a cell between neighbours, on average")));
    }
    rows.extend(summary.notes.iter().map(|note| ("note", note.clone())));
    let mut text = table::lines(&rows);
    let header = ["material", "volume", "area", "E", "planes", "undetermined", "without"].map(str::to_owned);
    let row = |material: &StillMaterial| {
        let StillMaterial { name, volume, area, planes, symmetric_difference, .. } = material;
        let error = symmetric_difference.map_or_else(|| "-".to_owned(), |error| format!("{error:.3e}"));
        let without = planes.flat + planes.isolated + planes.balanced + planes.no_centroid;
        let counts = [planes.plane, planes.undetermined, without].map(|count| count.to_string());
        [vec![name.clone(), format!("{volume:.6e}"), format!("{area:.6e}"), error], counts.to_vec()].concat()
    };
    let table: Vec<Vec<String>> =
        std::iter::once(header.to_vec()).chain(summary.materials.iter().map(row)).collect();
    text.push('\n');
    text.push_str(&table::columns(&table));
    // Writing to a string cannot fail.
    let _ = writeln!(text, "\n{} files in {}", summary.files.len(), folder.display());
    text
}
