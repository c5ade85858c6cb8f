//! A two-dimensional picture of mesh, volume fractions and interfaces as SVG.
//!
//! This file lays the picture out; `path` writes lines and polygons in few characters.

mod path;

use std::collections::BTreeMap;
use std::path::Path;

use svg::Document;
use svg::node::element::{Group, Path as Line, Rectangle, Text};
use vofkit_geometry::{Cell, Vector};

use self::path::{PathText, Pixel};
use super::{ExportError, check_length, check_materials, printable, write_file};
use crate::facet::Facet;
use crate::mesh::Mesh;

/// Pixels of the longer side of the mesh, of the least width of the picture, and around everything.
const SIDE: f64 = 752.0;
const LEAST_WIDTH: f64 = 320.0;
const MARGIN: f64 = 24.0;

/// Pixels of the text and of a line of it.
const TEXT: f64 = 16.0;
const TEXT_LINE: f64 = 30.0;

/// Width of a character relative to the size of the text, a little more than the mean.
const CHARACTER: f64 = 0.6;

/// Units per pixel: two decimals, written as whole numbers.
const UNITS: f64 = 100.0;

/// Mesh lines closer than this many pixels would be one grey area; then only the outline is drawn.
const CLOSEST_LINES: f64 = 2.5;

/// Opacity of a full cell: mesh and interface stay visible on it.
const FULL: f64 = 0.6;

/// Pixels of the rim that tinted areas get.
const SEAM: f64 = 0.6;

/// Fractions are drawn in this many steps.
const LEVELS: f64 = 100.0;

/// Colours that most colour-blind people can tell apart (Okabe & Ito 2008), the strong ones first.
const PALETTE: [[u8; 3]; 7] = [
    [0, 114, 178],
    [230, 159, 0],
    [0, 158, 115],
    [204, 121, 167],
    [213, 94, 0],
    [86, 180, 233],
    [240, 228, 66],
];

/// Writes a picture of a two-dimensional mesh, about 800 pixels wide or high.
///
/// Cells are tinted by each material with its volume fraction as opacity; facets are drawn as lines in a
/// darker shade, unless they have points that are not finite. `fractions` holds one value per cell for each
/// of the `names`. Mesh lines are left out where they would lie closer than 2.5 pixels.
///
/// # Errors
/// Fractions that do not fit names or mesh, a facet whose material has no name, and whatever the file system
/// reports.
pub fn write_picture<C: Cell<2>>(
    path: impl AsRef<Path>,
    mesh: &Mesh<C, 2>,
    names: &[String],
    fractions: &[Vec<f64>],
    facets: &[Facet<2>],
    title: &str,
) -> Result<(), ExportError> {
    let path = path.as_ref();
    check_materials(path, names, facets)?;
    if names.len() != fractions.len() {
        let reason = format!("{} materials have names, {} have fractions", names.len(), fractions.len());
        return Err(ExportError::data(path, reason));
    }
    for (name, fractions) in names.iter().zip(fractions) {
        check_length(path, name, fractions.len(), mesh.grid().len())?;
    }
    let view = View::new(mesh);
    let mut drawing =
        Group::new().set("transform", format!("scale({})", 1.0 / UNITS)).set("stroke-linecap", "round");
    for (material, fractions) in fractions.iter().enumerate() {
        drawing = drawing.add(tint(mesh, &view, fractions, material));
    }
    drawing = drawing.add(mesh_lines(mesh, &view));
    for material in 0..names.len() {
        drawing = drawing.add(interface(&view, facets, material));
    }
    let (legend, legend_height) = legend(names, &view);
    let height = view.top + view.height + legend_height + MARGIN;
    let document = Document::new()
        .set("width", view.width.round())
        .set("height", height.round())
        .set("viewBox", (0, 0, view.width.round(), height.round()))
        .set("font-family", "DejaVu Sans, Verdana, Arial, sans-serif")
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"))
        .add(heading(title, &view))
        .add(drawing)
        .add(legend);
    write_file(path, |writer| svg::write(writer, &document))
}

/// Where the mesh lies in the picture.
struct View {
    lower: Vector<2>,
    upper: Vector<2>,
    /// Pixels per unit of length.
    scale: f64,
    /// Pixels of the whole picture's width, left of the mesh, above it, and of its height.
    width: f64,
    left: f64,
    top: f64,
    height: f64,
    /// Pixels of a cell, on average.
    cell: f64,
}

impl View {
    fn new<C: Cell<2>>(mesh: &Mesh<C, 2>) -> Self {
        let [lower, upper] = mesh.bounds();
        let size = upper - lower;
        let scale = SIDE / size.max();
        let width = (size.x * scale).max(LEAST_WIDTH) + 2.0 * MARGIN;
        let cell = scale * (mesh.total_volume() / mesh.grid().len() as f64).sqrt();
        Self {
            lower,
            upper,
            scale,
            width,
            left: 0.5 * (width - size.x * scale),
            top: MARGIN + TEXT_LINE,
            height: size.y * scale,
            cell,
        }
    }

    fn shows_lines(&self) -> bool {
        self.cell >= CLOSEST_LINES
    }

    /// The place of a point. Points far outside are moved to the rim of a large square.
    fn pixel(&self, point: &Vector<2>) -> Pixel {
        let x = self.left + (point.x - self.lower.x) * self.scale;
        let y = self.top + (self.upper.y - point.y) * self.scale;
        [x, y].map(|at| (at * UNITS).round().clamp(-1e8, 1e8) as i64)
    }
}

fn colour(material: usize, shade: f64) -> String {
    let [r, g, b] = PALETTE[material % PALETTE.len()].map(|part| (f64::from(part) * shade).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The cells that hold the material. Neighbours in a row with the same level are one polygon.
fn tint<C: Cell<2>>(mesh: &Mesh<C, 2>, view: &View, fractions: &[f64], material: usize) -> Group {
    let columns = mesh.grid().cells()[0];
    let level = |fraction: &f64| (fraction * LEVELS).round().clamp(0.0, LEVELS) as u8;
    let mut paths = BTreeMap::<u8, PathText>::new();
    for (row, fractions) in fractions.chunks(columns).enumerate() {
        let mut first = 0;
        for run in fractions.chunk_by(|a, b| level(a) == level(b)) {
            let place =
                |at: usize, side: usize| view.pixel(&mesh.nodes()[mesh.grid().node_index([at, row + side])]);
            let last = first + run.len();
            let around =
                (first..=last).map(|at| place(at, 0)).chain((first..=last).rev().map(|at| place(at, 1)));
            if level(&run[0]) > 0 {
                paths.entry(level(&run[0])).or_default().add(around, true);
            }
            first = last;
        }
    }
    // A thin rim closes the light seams between rows; opacity that belongs to a group does not add up in it.
    let group = Group::new()
        .set("fill", colour(material, 1.0))
        .set("stroke", colour(material, 1.0))
        .set("stroke-width", SEAM * UNITS);
    paths.into_iter().fold(group, |group, (level, path)| {
        let opacity = (f64::from(level) / LEVELS * FULL * 1e3).round() / 1e3;
        group.add(Group::new().set("opacity", opacity).add(Line::new().set("d", path.into_text())))
    })
}

fn mesh_lines<C: Cell<2>>(mesh: &Mesh<C, 2>, view: &View) -> Line {
    let [n, m] = mesh.grid().cells();
    let place = |at: [usize; 2]| view.pixel(&mesh.nodes()[mesh.grid().node_index(at)]);
    let drawn = |at: usize, last: usize| at == 0 || at == last || view.shows_lines();
    let mut path = PathText::default();
    (0..=m).filter(|&j| drawn(j, m)).for_each(|j| path.add((0..=n).map(|i| place([i, j])), false));
    (0..=n).filter(|&i| drawn(i, n)).for_each(|i| path.add((0..=m).map(|j| place([i, j])), false));
    let width = UNITS * if view.shows_lines() { (0.06 * view.cell).clamp(0.25, 0.8) } else { 0.8 };
    stroke(path, "#a8a8a8".to_owned(), width)
}

fn interface(view: &View, facets: &[Facet<2>], material: usize) -> Line {
    let finite = |points: &&Vec<Vector<2>>| points.iter().flatten().all(|x| x.is_finite());
    let loops = facets.iter().filter(|facet| facet.material == material).flat_map(|facet| &facet.loops);
    let mut path = PathText::default();
    for points in loops.filter(finite) {
        path.add(points.iter().map(|point| view.pixel(point)), false);
    }
    stroke(path, colour(material, 0.55), (0.2 * view.cell).clamp(0.8, 2.4) * UNITS)
}

fn stroke(path: PathText, colour: String, width: f64) -> Line {
    let line = Line::new().set("fill", "none").set("stroke", colour).set("stroke-width", width.round());
    if path.is_empty() { line } else { line.set("d", path.into_text()) }
}

/// The title, small enough to fit.
fn heading(title: &str, view: &View) -> Text {
    let title = printable(title);
    let fitting = (view.width - 2.0 * MARGIN) / (CHARACTER * title.chars().count().max(1) as f64);
    Text::new(title)
        .set("x", 0.5 * view.width)
        .set("y", MARGIN + TEXT)
        .set("text-anchor", "middle")
        .set("font-size", (fitting.min(TEXT + 2.0) * 10.0).round() / 10.0)
        .set("fill", "#222222")
}

/// The materials with their colours, in as many lines as needed, and the height of these.
fn legend(names: &[String], view: &View) -> (Group, f64) {
    let mut group = Group::new().set("font-size", TEXT).set("fill", "#222222");
    let [mut x, mut y] = [view.left.min(0.5 * (view.width - LEAST_WIDTH)), view.top + view.height];
    let start = x;
    for (material, name) in names.iter().enumerate() {
        let name = printable(name);
        let width = (3.5 + CHARACTER * name.chars().count() as f64) * TEXT;
        if material == 0 || x + width > view.width {
            [x, y] = [start, y + TEXT_LINE];
        }
        let [left, base] = [x, y].map(f64::round);
        let swatch = Rectangle::new()
            .set("x", left + 1.0)
            .set("y", base - 13.0)
            .set("width", TEXT)
            .set("height", TEXT)
            .set("fill", colour(material, 1.0))
            .set("fill-opacity", FULL)
            .set("stroke", colour(material, 0.55))
            .set("stroke-width", 2);
        group = group.add(swatch).add(Text::new(name).set("x", left + 1.6 * TEXT).set("y", base));
        x += width;
    }
    (group, y - view.top - view.height)
}
