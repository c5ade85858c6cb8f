//! Curves along a row of cells, and maps of a quantity on a two-dimensional mesh with lines of equal value, as SVG.

use std::fmt::Display;
use std::io::Write;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use vofkit_geometry::{Cell, Vector};

use super::palette::{GREY, LINES, rgb};
use super::{ExportError, check_length, printable, write_file};
use crate::mesh::Mesh;
use crate::metrics::extremes;

/// Pixels.
const SIZE: (u32, u32) = (800, 600);
const MARGIN: u32 = 16;
const LABELS: u32 = 48;
const TEXT: (&str, u32) = ("sans-serif", 20);

/// From the least to the largest value (viridis, van der Walt & Smith 2015).
const RAMP: [[u8; 3]; 5] = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

/// Lines of equal value.
const LEVELS: usize = 9;

/// Values of one name at the places of a row.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a> {
    /// What stands in the legend.
    pub name: &'a str,
    /// One value for each place.
    pub values: &'a [f64],
}

/// Writes curves over the places `x`, which are called `x_name`; values that are not finite are left out.
///
/// # Errors
/// A curve that does not have one value per place, and whatever the file system reports.
pub fn write_curves(
    path: impl AsRef<Path>,
    (x_name, x): (&str, &[f64]),
    curves: &[Curve<'_>],
    title: &str,
) -> Result<(), ExportError> {
    let path = path.as_ref();
    curves.iter().try_for_each(|curve| check_length(path, curve.name, curve.values.len(), x.len()))?;
    let all = || curves.iter().flat_map(|curve| curve.values.iter().copied());
    let [left, right] = padded(finite_extremes(x.iter().copied()), 0.0);
    let [low, high] = padded(finite_extremes(all()), 0.05);
    draw(path, |root| {
        let mut chart = ChartBuilder::on(root)
            .caption(printable(title), TEXT)
            .margin(MARGIN)
            .set_all_label_area_size(LABELS)
            .build_cartesian_2d(left..right, low..high)?;
        chart.configure_mesh().disable_mesh().x_desc(x_name).draw()?;
        let colours = [GREY].iter().chain(&LINES).map(|&colour| rgb(colour));
        for (curve, colour) in curves.iter().zip(colours.cycle()) {
            let points = x.iter().copied().zip(curve.values.iter().copied()).filter(|(_, y)| y.is_finite());
            chart
                .draw_series(LineSeries::new(points, colour.stroke_width(2)))?
                .label(curve.name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
        }
        chart.configure_series_labels().border_style(BLACK).background_style(WHITE).draw()
    })
}

/// Writes a map of values at the cells or the nodes of a mesh, whichever there are as many of, with lines of equal value.
///
/// # Errors
/// Neither one value per cell nor one per node, and whatever the file system reports.
pub fn write_map<C: Cell<2>>(
    path: impl AsRef<Path>,
    mesh: &Mesh<C, 2>,
    values: &[f64],
    title: &str,
) -> Result<(), ExportError> {
    let path = path.as_ref();
    let grid = mesh.grid();
    let at_nodes = values.len() == mesh.nodes().len();
    if !at_nodes {
        check_length(path, title, values.len(), grid.len())?;
    }
    let nodes: Vec<f64> = if at_nodes { values.to_vec() } else { node_means(mesh, values) };
    let corners = |cell: usize| {
        let at = grid.offset(cell);
        [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| grid.node_index([at[0] + i, at[1] + j]))
    };
    let mean = |cell: usize| {
        if at_nodes { corners(cell).map(|node| nodes[node]).iter().sum::<f64>() / 4.0 } else { values[cell] }
    };
    let range = finite_extremes(values.iter().copied());
    let [low, high] = range;
    let [lower, upper] = mesh.bounds();
    let longest = (upper - lower).amax();
    draw(path, |root| {
        let title = format!("{}  [{low:.4}, {high:.4}]", printable(title));
        let mut chart = ChartBuilder::on(root)
            .caption(title, TEXT)
            .margin(MARGIN)
            .set_all_label_area_size(LABELS)
            .build_cartesian_2d(
                lower[0]..lower[0] + longest * f64::from(SIZE.0) / f64::from(SIZE.1),
                lower[1]..lower[1] + longest,
            )?;
        chart.configure_mesh().disable_mesh().draw()?;
        let place = |x: &Vector<2>| (x[0], x[1]);
        chart.draw_series((0..grid.len()).map(|cell| {
            let outline: Vec<(f64, f64)> =
                corners(cell).iter().map(|&node| place(&mesh.nodes()[node])).collect();
            Polygon::new(outline, colour(mean(cell), range).filled())
        }))?;
        let mut lines = Vec::new();
        for level in 1..=LEVELS {
            let level = low + (high - low) * level as f64 / (LEVELS + 1) as f64;
            for cell in 0..grid.len() {
                let corners = corners(cell);
                let middle = mesh.cell(cell).map(&Vector::repeat(0.5));
                for (i, &node) in corners.iter().enumerate() {
                    let next = corners[(i + 1) % 4];
                    let triangle = [
                        (middle, corners.map(|node| nodes[node]).iter().sum::<f64>() / 4.0),
                        (mesh.nodes()[node], nodes[node]),
                        (mesh.nodes()[next], nodes[next]),
                    ];
                    lines.extend(crossing(triangle, level));
                }
            }
        }
        chart
            .draw_series(
                lines.iter().map(|ends| PathElement::new(ends.each_ref().map(place), BLACK.stroke_width(1))),
            )
            .map(|_| ())
    })
}

/// Where a linear function on a triangle has a value: a segment.
fn crossing(triangle: [(Vector<2>, f64); 3], level: f64) -> Option<[Vector<2>; 2]> {
    let mut ends = [0, 1, 2].into_iter().filter_map(|i| {
        let ((a, f), (b, g)) = (triangle[i], triangle[(i + 1) % 3]);
        ((f < level) != (g < level)).then(|| a + (b - a) * ((level - f) / (g - f)))
    });
    Some([ends.next()?, ends.next()?])
}

/// The mean of the cells around each node.
fn node_means<C: Cell<2>>(mesh: &Mesh<C, 2>, values: &[f64]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); mesh.nodes().len()];
    for (cell, value) in values.iter().enumerate() {
        let at = mesh.grid().offset(cell);
        for corner in C::OFFSETS {
            let (sum, count) = &mut sums[mesh.grid().node_index([at[0] + corner[0], at[1] + corner[1]])];
            *sum += value;
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

fn finite_extremes(values: impl Iterator<Item = f64>) -> [f64; 2] {
    extremes(&values.filter(|value| value.is_finite()).collect::<Vec<f64>>())
}

/// A range with room around it, and of some width even where there is one value or none.
fn padded([low, high]: [f64; 2], part: f64) -> [f64; 2] {
    if low > high {
        return [0.0, 1.0];
    }
    let width = high - low;
    let room = if width > 0.0 { part * width } else { 0.5 * high.abs().max(1.0) };
    [low - room, high + room]
}

fn colour(value: f64, [low, high]: [f64; 2]) -> RGBColor {
    let part =
        if high > low && value.is_finite() { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
    let place = part * (RAMP.len() - 1) as f64;
    let first = (place as usize).min(RAMP.len() - 2);
    let mix = |k: usize| {
        let [a, b] = [first, first + 1].map(|i| f64::from(RAMP[i][k]));
        (a + (b - a) * (place - first as f64)).round() as u8
    };
    RGBColor(mix(0), mix(1), mix(2))
}

/// Draws on a white sheet and writes it.
fn draw<E: Display>(
    path: &Path,
    work: impl FnOnce(&DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), E>,
) -> Result<(), ExportError> {
    let text = drawn(SIZE, work).map_err(|reason| ExportError::data(path, reason))?;
    write_file(path, |writer| writer.write_all(text.as_bytes()))
}

/// The text of an SVG of this many pixels that is drawn on a white sheet.
pub(crate) fn drawn<E: Display>(
    size: (u32, u32),
    work: impl FnOnce(&DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), E>,
) -> Result<String, String> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE).map_err(|error| error.to_string())?;
        work(&root).map_err(|error| error.to_string())?;
        root.present().map_err(|error| error.to_string())?;
    }
    Ok(text)
}
