//! The summary of a run as a short table for a terminal.

use std::fmt::Write;
use std::path::Path;

use super::{FieldSummary, MaterialSummary, Normals, Summary};
use crate::stopwatch::PhaseSeconds;

/// Corrections up to this part of a material are rounding and not shown.
const ROUNDING: f64 = 1e-12;

/// The summary in a few aligned lines.
pub fn summary(summary: &Summary, folder: &Path) -> String {
    let cells = product(&summary.cells_per_direction);
    let positions = summary.positions_closed_form + summary.positions_iterative;
    let substeps = match summary.substeps {
        0 | 1 => String::new(),
        parts => format!(", in up to {parts} substeps"),
    };
    let mut rows = vec![
        ("scene", format!("{} ({cells} cells)", summary.scene)),
        ("time", format!("{:.6} in {} steps of {:.6e}", summary.end_time, summary.steps, summary.dt)),
        ("Courant number", format!("{:.4}{substeps}", summary.max_courant)),
        ("divergence", format!("{:.1e}", summary.max_divergence)),
        ("mixed cells", format!("{:.1} on average", summary.mixed_cells_mean)),
        (
            "reconstructed",
            format!("{} of {}", summary.cells_reconstructed, summary.skipped.reconstructions.of),
        ),
        ("normals", normals(&summary.normals)),
        ("closed form", format!("{} of {positions} plane constants", summary.positions_closed_form)),
        ("corrections", format!("{:.1e} of a cell at most", summary.corrections.largest_fraction)),
        ("wall time", format!("{:.2} s with {} threads", summary.wall_seconds, summary.threads)),
        ("of which", phases(&summary.seconds)),
    ];
    rows.extend(summary.notes.iter().map(|note| ("note", note.clone())));
    let mut text = lines(&rows);
    let mut header =
        vec!["material", "volume", "drift", "error", "relative", "f min", "1 - f max", "fragments"];
    let corrected = summary.materials.iter().any(is_corrected);
    if corrected {
        header.extend(["clipped", "rescaled"]);
    }
    let mut table: Vec<Vec<String>> = vec![header.into_iter().map(str::to_owned).collect()];
    for material in &summary.materials {
        let mut row = row(material).to_vec();
        if corrected {
            row.extend(corrections(material).map(|part| format!("{part:.1e}")));
        }
        table.push(row);
    }
    if !summary.materials.is_empty() {
        text.push('\n');
        text.push_str(&columns(&table));
    }
    if !summary.fields.is_empty() {
        text.push('\n');
        text.push_str(&columns(&fields(&summary.fields)));
    }
    let _ = writeln!(text, "\n{} files in {}", summary.files.len(), folder.display());
    text
}

/// Shares of the phases, without those that take no time.
fn phases(seconds: &PhaseSeconds) -> String {
    let named = seconds.named();
    let whole: f64 = named.iter().map(|(_, value)| value).sum();
    let told = named.iter().filter(|(_, value)| *value > 0.0);
    let shares = told.map(|(name, value)| format!("{name} {:.0} %", 100.0 * value / whole));
    shares.collect::<Vec<_>>().join(", ")
}

/// What became of the normals, without what did not occur.
fn normals(normals: &Normals) -> String {
    let others = [
        (normals.undetermined, "not determined by their patch"),
        (normals.flat, "none among equals"),
        (normals.isolated, "none in single cells"),
        (normals.balanced, "none by balance"),
        (normals.no_centroid, "none without centroid"),
    ];
    let mut text = format!("{} determined", normals.determined);
    for (count, what) in others.into_iter().filter(|(count, _)| *count > 0) {
        let _ = write!(text, ", {count} {what}");
    }
    text
}

/// Volume clipped and rescaled, relative to the volume of the material.
fn corrections(material: &MaterialSummary) -> [f64; 2] {
    let volume = material.volume_initial.max(material.volume_final);
    let relative = |part: f64| if part == 0.0 { 0.0 } else { part / volume };
    [material.corrections.clipped, material.corrections.rescaled].map(relative)
}

/// Whether more than rounding was corrected.
fn is_corrected(material: &MaterialSummary) -> bool {
    corrections(material).iter().any(|part| part.abs() > ROUNDING)
}

/// A number, or a dash where there is none.
fn number(value: Option<f64>) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.3e}"))
}

fn fields(fields: &[FieldSummary]) -> Vec<Vec<String>> {
    let header =
        ["field", "drift", "minimum", "maximum", "variation", "at the end", "L1 error"].map(str::to_owned);
    let row = |field: &FieldSummary| {
        vec![
            field.name.clone(),
            number(field.conserved),
            format!("{:.6}", field.minimum),
            format!("{:.6}", field.maximum),
            format!("{:.6}", field.total_variation_initial),
            format!("{:.6}", field.total_variation_final),
            number(field.l1_error),
        ]
    };
    std::iter::once(header.to_vec()).chain(fields.iter().map(row)).collect()
}

fn row(material: &MaterialSummary) -> [String; 8] {
    [
        material.name.clone(),
        format!("{:.6e}", material.volume_final),
        number(material.volume_drift),
        number(material.shape_error),
        number(material.shape_error_relative),
        format!("{:.1e}", material.fraction_min),
        format!("{:.1e}", 1.0 - material.fraction_max),
        material.fragments.to_string(),
    ]
}

/// Cells per direction, such as `30 x 30`.
pub fn product(cells: &[usize]) -> String {
    cells.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ")
}

/// Names and values in two columns.
pub fn lines(rows: &[(&str, String)]) -> String {
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    rows.iter().map(|(name, value)| format!("{name:<width$}  {value}\n")).collect()
}

/// Columns, the first one aligned to the left and the others to the right.
pub fn columns(table: &[Vec<String>]) -> String {
    let count = table.iter().map(Vec::len).max().unwrap_or(0);
    let width = |k: usize| {
        table.iter().filter_map(|row| row.get(k)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..count).map(width).collect();
    let mut text = String::new();
    for row in table {
        let cells = row.iter().zip(&widths).enumerate().map(|(k, (cell, &width))| {
            if k == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}
