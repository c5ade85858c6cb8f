//! Drawings of a study as SVG: points and lines over logarithmic axes, and stacked bars.

use std::fmt::Display;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;

use super::labels::{Labels, leader};
use crate::export::palette::{GREY, LINES, rgb};
use crate::export::plot::drawn;
use crate::export::printable;

/// Pixels: of the whole, of the part with the axes, of a line of the legend.
const SIZE: (u32, u32) = (1080, 560);
const AXES: u32 = 760;
const LINE: i32 = 19;
const MARGIN: u32 = 14;
const LABELS: u32 = 60;
const TEXT: (&str, u32) = ("sans-serif", 15);
const SMALL: (&str, u32) = ("sans-serif", 12);

/// Colours of series.
const COLOURS: usize = LINES.len() + 1;

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Symbols alone.
    Points,
    /// Symbols and a line through them.
    Joined,
    /// A dashed line.
    Dashed,
    /// Diamonds in black: what others published.
    Marks,
}

/// A point of a series.
#[derive(Clone, Debug)]
pub struct Mark {
    /// To the right.
    pub x: f64,
    /// Upwards.
    pub y: f64,
    /// From where to where `x` was measured.
    pub range: Option<[f64; 2]>,
    /// What stands beside it.
    pub label: Option<String>,
}

impl Mark {
    /// A bare point.
    pub fn at(x: f64, y: f64) -> Self {
        Self { x, y, range: None, label: None }
    }
}

/// A line of the legend and its points.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The name in the legend.
    pub name: String,
    /// The points.
    pub marks: Vec<Mark>,
    /// How they are drawn.
    pub style: Style,
}

/// Curves over axes. What does not fit on a logarithmic axis is left out.
#[derive(Clone, Debug)]
pub struct Chart<'a> {
    /// Under the horizontal axis.
    pub x: &'a str,
    /// Beside the vertical one.
    pub y: &'a str,
    /// Whether the vertical axis is logarithmic; the horizontal one is.
    pub y_is_log: bool,
    /// Numbers that stand under the horizontal axis; round ones without any.
    pub ticks: Vec<f64>,
    /// The curves.
    pub curves: Vec<Curve>,
}

impl Chart<'_> {
    /// The drawing; none where there is nothing to draw.
    pub fn svg(&self) -> Option<String> {
        let fits = |mark: &&Mark| {
            mark.x > 0.0 && mark.x.is_finite() && mark.y.is_finite() && (mark.y > 0.0 || !self.y_is_log)
        };
        let marks = || self.curves.iter().flat_map(|curve| &curve.marks).filter(fits);
        marks().next()?;
        let [left, right] = decades(marks().flat_map(|mark| mark.range.unwrap_or([mark.x; 2])));
        let drawing = drawn(SIZE, |root| {
            let (axes, legend) = root.split_horizontally(AXES);
            let mut builder = ChartBuilder::on(&axes);
            builder
                .margin(MARGIN)
                .set_all_label_area_size(0)
                .x_label_area_size(LABELS)
                .y_label_area_size(LABELS + 20);
            let across = (left..right).log_scale();
            if self.y_is_log {
                let [low, high] = decades(marks().map(|mark| mark.y));
                self.fill(&mut builder, across, (low..high).log_scale(), low, fits)?;
            } else {
                let high = marks().map(|mark| mark.y).fold(0.0, f64::max);
                self.fill(&mut builder, across, 0.0..1.15 * high.max(f64::MIN_POSITIVE), 0.0, fits)?;
            }
            self.legend(&legend)
        });
        drawing.ok()
    }

    fn fill<'b, X: AsRangedCoord<Value = f64>, Y: AsRangedCoord<Value = f64>>(
        &self,
        builder: &mut ChartBuilder<'_, 'b, SVGBackend<'b>>,
        x: X,
        y: Y,
        bottom: f64,
        fits: impl Fn(&&Mark) -> bool,
    ) -> Result<(), Failed>
    where
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let mut chart = builder.build_cartesian_2d(x, y).map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .x_desc(self.x)
            .y_desc(self.y)
            .label_style(TEXT)
            .x_label_formatter(&|x| if self.ticks.is_empty() { number(*x) } else { String::new() })
            .y_label_formatter(&|y| number(*y))
            .x_labels(if self.ticks.is_empty() { 10 } else { 0 })
            .draw()
            .map_err(failed)?;
        let ticks = self.ticks.iter().map(|&x| {
            EmptyElement::at((x, bottom))
                + Text::new(number(x), (-8, 8), TEXT)
                + PathElement::new([(0, 0), (0, 5)], BLACK)
        });
        chart.draw_series(ticks).map_err(failed)?;
        for (place, curve) in self.curves.iter().enumerate() {
            let colour = colour(place, curve.style);
            let marks: Vec<&Mark> = curve.marks.iter().filter(&fits).collect();
            let points = || marks.iter().map(|mark| (mark.x, mark.y));
            match curve.style {
                Style::Joined => drop(
                    chart.draw_series(LineSeries::new(points(), colour.stroke_width(2))).map_err(failed)?,
                ),
                Style::Dashed => {
                    let line = DashedLineSeries::new(points(), 6, 4, colour.stroke_width(1));
                    chart.draw_series(line).map_err(failed)?;
                    continue;
                }
                Style::Points | Style::Marks => {}
            }
            let ranges = marks.iter().filter_map(|mark| mark.range.map(|[a, b]| [(a, mark.y), (b, mark.y)]));
            chart
                .draw_series(ranges.map(|ends| PathElement::new(ends, colour.stroke_width(1))))
                .map_err(failed)?;
            for point in points() {
                let symbol = EmptyElement::at(point) + Symbol { place, style: curve.style }.element();
                chart.draw_series(std::iter::once(symbol)).map_err(failed)?;
            }
        }
        let (across, down) = chart.plotting_area().get_pixel_range();
        let marks = || self.curves.iter().flat_map(|curve| &curve.marks).filter(&fits);
        let pixel = |mark: &Mark| chart.backend_coord(&(mark.x, mark.y));
        let mut labels = Labels::new([across.start, down.start], [across.end, down.end], marks().map(pixel));
        let labelled: Vec<_> = marks()
            .filter_map(|mark| {
                let label = printable(mark.label.as_deref()?);
                let place = labels.place(pixel(mark), &label);
                Some(((mark.x, mark.y), label, place))
            })
            .collect();
        let drawn = labelled.into_iter().map(|(at, label, place)| {
            EmptyElement::at(at)
                + PathElement::new([(0, 0), leader(place).unwrap_or((0, 0))], RGBColor(150, 150, 150))
                + Text::new(label, place, SMALL)
        });
        chart.draw_series(drawn).map_err(failed)?;
        Ok(())
    }

    fn legend(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), Failed> {
        for (place, curve) in self.curves.iter().enumerate() {
            let y = 26 + LINE * place as i32;
            if curve.style == Style::Dashed {
                let line = PathElement::new([(4, y), (24, y)], colour(place, curve.style).stroke_width(1));
                area.draw(&line).map_err(failed)?;
            } else {
                area.draw(&(EmptyElement::at((14, y)) + Symbol { place, style: curve.style }.element()))
                    .map_err(failed)?;
            }
            area.draw(&Text::new(printable(&curve.name), (30, y - 7), SMALL)).map_err(failed)?;
        }
        Ok(())
    }
}

/// A symbol of a series: its colour and its shape.
struct Symbol {
    place: usize,
    style: Style,
}

impl Symbol {
    fn element(&self) -> Polygon<(i32, i32)> {
        let colour = colour(self.place, self.style);
        let outline: &[(i32, i32)] = match (self.style, self.place / COLOURS % 3) {
            (Style::Marks, _) => &[(0, -6), (6, 0), (0, 6), (-6, 0)],
            (_, 0) => &[(-4, -1), (-2, -4), (2, -4), (4, -1), (4, 1), (2, 4), (-2, 4), (-4, 1)],
            (_, 1) => &[(-4, -4), (4, -4), (4, 4), (-4, 4)],
            _ => &[(0, -5), (5, 4), (-5, 4)],
        };
        Polygon::new(outline.to_vec(), colour.filled())
    }
}

fn colour(place: usize, style: Style) -> RGBColor {
    match style {
        Style::Marks | Style::Dashed => BLACK,
        Style::Points | Style::Joined => rgb(*LINES.get(place % COLOURS).unwrap_or(&GREY)),
    }
}

/// Parts of a whole, one bar each.
#[derive(Clone, Debug)]
pub struct Bars<'a> {
    /// What the parts are, in the order of the numbers.
    pub parts: &'a [String],
    /// Names and numbers.
    pub bars: Vec<(String, Vec<f64>)>,
}

impl Bars<'_> {
    /// The drawing, each bar as long as the others and its parts as shares of it; none where there is nothing to draw.
    pub fn svg(&self) -> Option<String> {
        let bars: Vec<&(String, Vec<f64>)> =
            self.bars.iter().filter(|(_, parts)| parts.iter().sum::<f64>() > 0.0).collect();
        if bars.is_empty() {
            return None;
        }
        let height = 60 + 22 * bars.len() as i32;
        let drawing = drawn((SIZE.0, height as u32), |root| {
            for (k, part) in self.parts.iter().enumerate() {
                let x = 330 + (720 * k / self.parts.len()) as i32;
                let symbol = EmptyElement::at((x, 18)) + Symbol { place: k, style: Style::Points }.element();
                root.draw(&symbol).map_err(failed)?;
                root.draw(&Text::new(printable(part), (x + 12, 11), SMALL)).map_err(failed)?;
            }
            for (row, (name, parts)) in bars.iter().enumerate() {
                let y = 40 + 22 * row as i32;
                root.draw(&Text::new(printable(name), (10, y + 1), SMALL)).map_err(failed)?;
                let whole: f64 = parts.iter().sum();
                let mut at = 0.0;
                for (k, part) in parts.iter().enumerate() {
                    let place = |share: f64| 330 + (720.0 * share / whole).round() as i32;
                    let bar = Rectangle::new(
                        [(place(at), y), (place(at + part), y + 16)],
                        colour(k, Style::Points).filled(),
                    );
                    root.draw(&bar).map_err(failed)?;
                    at += part;
                }
            }
            Ok::<(), Failed>(())
        });
        drawing.ok()
    }
}

/// Drawing failed; there is no picture then.
#[derive(Debug, thiserror::Error)]
#[error("the drawing failed")]
struct Failed;

fn failed(_: impl Display) -> Failed {
    Failed
}

/// A range that holds the values with room around them, at least a decade wide.
fn decades(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let (low, high) =
        values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    let [low, high] = [low / 1.5, high * 1.5];
    let missing = (10.0 * low / high).max(1.0).sqrt();
    [low / missing, high * missing]
}

/// A number with as many digits as an axis has room for.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-2..1e4).contains(&x.abs()) {
        format!("{}", (x * 1e4).round() / 1e4)
    } else {
        format!("{x:.0e}")
    }
}
