//! Two-dimensional drawings: cells, mesh lines, interfaces and their normals.

use std::collections::BTreeMap;

use svg::Document;
use svg::node::element::{Group, Path as Line, Rectangle};
use vofkit_geometry::{Cell, Quad, Vector};

use super::path::{PathText, Pixel};
use super::sheet::{DARK, FULL, Sheet, shaded};
use super::{Look, Paint, Pixels, finite_loops, raster};
use crate::export::Snapshot;
use crate::export::palette::Colour;
use crate::facet::Facet;
use crate::mesh::Mesh;

/// Parts of a unit in which the lines are written, as whole numbers.
const UNITS: f64 = 100.0;

/// Mesh lines closer than this many units would be one grey area; then only the outline is drawn.
const CLOSEST_LINES: f64 = 2.5;

/// Units of the rim that tinted areas get.
const SEAM: f64 = 0.6;

/// Fractions are drawn in this many steps.
const LEVELS: f64 = 100.0;

/// Arrows along normals and their heads, relative to the length of a cell.
const ARROW: f64 = 0.8;
const HEAD: f64 = 0.2;

impl Paint<2> for Quad {
    fn pixels(snapshot: &Snapshot<'_, Self, 2>, colours: &[Colour], look: &Look) -> Result<Pixels, String> {
        if look.view.is_some() {
            return Err("the mesh has two dimensions, which are seen from one side only: leave out the view"
                .to_owned());
        }
        if look.slice.is_some() {
            return Err("the mesh has two dimensions, of which there is no slice: leave it out".to_owned());
        }
        let (document, sheet) = document(snapshot, colours, look)?;
        raster::draw(&document, raster::white(&sheet)?, &sheet)
    }
}

/// The picture as SVG, and the sheet that it is on.
///
/// # Errors
/// A size that leaves no room for the drawing.
pub(super) fn document<C: Cell<2>>(
    snapshot: &Snapshot<'_, C, 2>,
    colours: &[Colour],
    look: &Look,
) -> Result<(Document, Sheet), String> {
    let Snapshot { mesh, names, fractions, facets, title } = *snapshot;
    let view = View::new(mesh, names, look)?;
    let mut drawing =
        Group::new().set("transform", format!("scale({})", 1.0 / UNITS)).set("stroke-linecap", "round");
    let colour = |material: usize| colours[material % colours.len()];
    for (material, fractions) in fractions.iter().enumerate() {
        drawing = drawing.add(tint(mesh, &view, fractions, colour(material)));
    }
    if look.mesh {
        drawing = drawing.add(mesh_lines(mesh, &view));
    }
    for material in 0..names.len() {
        let own = || facets.iter().filter(|facet| facet.material == material);
        drawing = drawing.add(interface(&view, own(), colour(material)));
        if look.normals {
            drawing = drawing.add(normals(&view, own(), colour(material)));
        }
    }
    let white = Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white");
    let drawing = Group::new().add(white).add(drawing);
    Ok((view.sheet.document(title, drawing, names, colours, FULL), view.sheet))
}

/// Where the mesh lies on the sheet.
struct View {
    lower: Vector<2>,
    upper: Vector<2>,
    sheet: Sheet,
    /// Units of a cell, on average.
    cell: f64,
}

impl View {
    fn new<C: Cell<2>>(mesh: &Mesh<C, 2>, names: &[String], look: &Look) -> Result<Self, String> {
        let [lower, upper] = mesh.bounds();
        let sheet = Sheet::around((upper - lower).into(), names, look.size)?;
        let cell = sheet.scale * (mesh.total_volume() / mesh.grid().len() as f64).sqrt();
        Ok(Self { lower, upper, sheet, cell })
    }

    fn shows_lines(&self) -> bool {
        self.cell >= CLOSEST_LINES
    }

    /// The place of a point. Points far outside are moved to the rim of a large square.
    fn pixel(&self, point: &Vector<2>) -> Pixel {
        let x = self.sheet.left + (point.x - self.lower.x) * self.sheet.scale;
        let y = self.sheet.top + (self.upper.y - point.y) * self.sheet.scale;
        [x, y].map(|at| (at * UNITS).round().clamp(-1e8, 1e8) as i64)
    }
}

/// The cells that hold the material. Neighbours in a row with the same level are one polygon.
fn tint<C: Cell<2>>(mesh: &Mesh<C, 2>, view: &View, fractions: &[f64], colour: Colour) -> Group {
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
        .set("fill", shaded(colour, 1.0))
        .set("stroke", shaded(colour, 1.0))
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

fn interface<'a>(view: &View, facets: impl Iterator<Item = &'a Facet<2>>, colour: Colour) -> Line {
    let mut path = PathText::default();
    for points in facets.flat_map(finite_loops) {
        path.add(points.iter().map(|point| view.pixel(point)), false);
    }
    stroke(path, shaded(colour, DARK), (0.2 * view.cell).clamp(0.8, 2.4) * UNITS)
}

/// An arrow from the middle of each piece of the interface.
fn normals<'a>(view: &View, facets: impl Iterator<Item = &'a Facet<2>>, colour: Colour) -> Line {
    let length = view.cell / view.sheet.scale;
    let mut path = PathText::default();
    for facet in facets.filter(|facet| facet.normal.iter().all(|x| x.is_finite())) {
        let along = facet.normal * length;
        let across = Vector::<2>::new(-along.y, along.x);
        for points in finite_loops(facet) {
            let foot = points.iter().sum::<Vector<2>>() / points.len() as f64;
            let tip = foot + along * ARROW;
            let side = |sign: f64| tip - (along - across * sign) * HEAD;
            path.add([&foot, &tip].map(|point| view.pixel(point)), false);
            path.add([&side(1.0), &tip, &side(-1.0)].map(|point| view.pixel(point)), false);
        }
    }
    stroke(path, shaded(colour, DARK), (0.1 * view.cell).clamp(0.6, 1.2) * UNITS)
}

fn stroke(path: PathText, colour: String, width: f64) -> Line {
    let line = Line::new().set("fill", "none").set("stroke", colour).set("stroke-width", width.round());
    if path.is_empty() { line } else { line.set("d", path.into_text()) }
}
