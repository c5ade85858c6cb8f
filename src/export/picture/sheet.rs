//! The sheet that a picture is drawn on: its size, the title, the legend, and where the drawing goes.

use svg::Document;
use svg::node::element::{Group, Rectangle, Text};

use crate::export::palette::Colour;
use crate::export::printable;

/// Units of the longer side of the drawing, of the least width of the sheet, and around everything.
const SIDE: f64 = 752.0;
const LEAST_WIDTH: f64 = 320.0;
const MARGIN: f64 = 24.0;

/// Units of the text and of a line of it.
const TEXT: f64 = 16.0;
const TEXT_LINE: f64 = 30.0;

/// Width of a character relative to the size of the text, a little more than the mean.
const CHARACTER: f64 = 0.6;

/// The shorter side in units, of sheets whose size is given: what the text goes by.
const SHORT: f64 = 800.0;

/// Text smaller than this many pixels per unit cannot be read.
const LEAST_PIXELS: f64 = 0.6;

/// A drawing smaller than this many units shows nothing.
const LEAST_DRAWING: f64 = 40.0;

/// The family of the font, which comes with the program, and those that viewers of SVG have.
pub(super) const FONT: &str = "DejaVu Sans";
const FONTS: &str = "DejaVu Sans, Verdana, Arial, sans-serif";

/// Opacity of a full cell: mesh and interface stay visible on it.
pub(super) const FULL: f64 = 0.6;

/// How much darker than their areas lines are.
pub(super) const DARK: f64 = 0.55;

/// A sheet and the places on it, in units.
#[derive(Debug)]
pub(super) struct Sheet {
    /// The whole.
    width: f64,
    height: f64,
    /// The corner of the drawing.
    pub(super) left: f64,
    pub(super) top: f64,
    /// Units per length of what is drawn.
    pub(super) scale: f64,
    /// Pixels per unit.
    pub(super) pixels: f64,
    /// Where the entries of the legend start.
    legend: Vec<[f64; 2]>,
}

impl Sheet {
    /// The sheet around a drawing of some extent: of the size that fits it, or of one in pixels, which the drawing is made to fit.
    ///
    /// # Errors
    /// A size that leaves no room for the drawing.
    pub(super) fn around(extent: [f64; 2], names: &[String], size: Option<[u32; 2]>) -> Result<Self, String> {
        let top = MARGIN + TEXT_LINE;
        let Some(size) = size else {
            let scale = SIDE / extent[0].max(extent[1]);
            let [across, down] = extent.map(|length| length * scale);
            let width = across.max(LEAST_WIDTH) + 2.0 * MARGIN;
            let left = 0.5 * (width - across);
            let legend = entries(names, left.min(0.5 * (width - LEAST_WIDTH)), top + down, width);
            let end = legend.last().map_or(top + down, |entry| entry[1]);
            let [width, height] = [width, end + MARGIN].map(f64::round);
            return Ok(Self { width, height, left, top, scale, pixels: 1.0, legend });
        };
        let [width, height] = size.map(f64::from);
        let pixels = (width.min(height) / SHORT).max(LEAST_PIXELS);
        let [width, height] = [width, height].map(|length| length / pixels);
        let lines = entries(names, MARGIN, 0.0, width).last().map_or(0.0, |entry| entry[1]);
        let room = [width - 2.0 * MARGIN, height - top - lines - MARGIN];
        if !(room[0] >= LEAST_DRAWING && room[1] >= LEAST_DRAWING) {
            let [width, height] = size;
            return Err(format!(
                "{width} x {height} pixels leave no room beside the title and {} names",
                names.len()
            ));
        }
        let scale = (room[0] / extent[0]).min(room[1] / extent[1]);
        let [across, down] = extent.map(|length| length * scale);
        let left = 0.5 * (width - across);
        let top = top + 0.5 * (room[1] - down);
        let legend = entries(names, MARGIN, height - MARGIN - lines, width);
        Ok(Self { width, height, left, top, scale, pixels, legend })
    }

    /// Pixels of the whole.
    pub(super) fn size(&self) -> [u32; 2] {
        [self.width, self.height].map(|length| (length * self.pixels).round() as u32)
    }

    /// The document with drawing, title and legend, whose colours have the opacity of what is full.
    pub(super) fn document(
        &self,
        title: &str,
        drawing: Group,
        names: &[String],
        colours: &[Colour],
        opacity: f64,
    ) -> Document {
        let (width, height) = (self.width, self.height);
        Document::new()
            .set("width", width)
            .set("height", height)
            .set("viewBox", (0, 0, width, height))
            .set("font-family", FONTS)
            .add(drawing)
            .add(self.heading(title))
            .add(self.legend(names, colours, opacity))
    }

    /// The title, small enough to fit.
    fn heading(&self, title: &str) -> Text {
        let title = printable(title);
        let fitting = (self.width - 2.0 * MARGIN) / (CHARACTER * title.chars().count().max(1) as f64);
        Text::new(title)
            .set("x", 0.5 * self.width)
            .set("y", MARGIN + TEXT)
            .set("text-anchor", "middle")
            .set("font-size", (fitting.min(TEXT + 2.0) * 10.0).round() / 10.0)
            .set("fill", "#222222")
    }

    /// The names with their colours.
    fn legend(&self, names: &[String], colours: &[Colour], opacity: f64) -> Group {
        let group = Group::new().set("font-size", TEXT).set("fill", "#222222");
        let entries = self.legend.iter().zip(names).zip(colours.iter().cycle());
        entries.fold(group, |group, ((place, name), &colour)| {
            let [left, base] = place.map(f64::round);
            let swatch = Rectangle::new()
                .set("x", left + 1.0)
                .set("y", base - 13.0)
                .set("width", TEXT)
                .set("height", TEXT)
                .set("fill", shaded(colour, 1.0))
                .set("fill-opacity", opacity)
                .set("stroke", shaded(colour, DARK))
                .set("stroke-width", 2);
            group.add(swatch).add(Text::new(printable(name)).set("x", left + 1.6 * TEXT).set("y", base))
        })
    }
}

/// Where the entries of a legend start, in as many lines as needed below `bottom`.
fn entries(names: &[String], start: f64, bottom: f64, sheet: f64) -> Vec<[f64; 2]> {
    let [mut x, mut y] = [start, bottom];
    let place = |(at, name): (usize, &String)| {
        let width = (3.5 + CHARACTER * printable(name).chars().count() as f64) * TEXT;
        if at == 0 || x + width > sheet {
            [x, y] = [start, y + TEXT_LINE];
        }
        let place = [x, y];
        x += width;
        place
    };
    names.iter().enumerate().map(place).collect()
}

/// The colour times a brightness, as SVG writes it.
pub(super) fn shaded(colour: Colour, brightness: f64) -> String {
    let [r, g, b] = colour.map(|part| (f64::from(part) * brightness).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}
