//! Triangles and lines of which the nearer ones hide the farther ones.

use resvg::tiny_skia::{Pixmap, PremultipliedColorU8};

use crate::export::palette::Colour;

/// Samples of a pixel along each axis, whose mean is its colour.
const SAMPLES: usize = 2;

/// A point on the sheet: pixels to the right and down, and how near it is.
pub(super) type Place = [f64; 3];

/// What is seen so far.
pub(super) struct Canvas {
    /// Samples along each axis.
    size: [usize; 2],
    /// How near what is seen in each sample is.
    near: Vec<f32>,
    colour: Vec<Colour>,
}

impl Canvas {
    /// A white canvas of some pixels.
    pub(super) fn new([width, height]: [u32; 2]) -> Self {
        let size = [width, height].map(|length| length as usize * SAMPLES);
        let count = size[0] * size[1];
        Self { size, near: vec![f32::NEG_INFINITY; count], colour: vec![[255; 3]; count] }
    }

    /// Draws a triangle of one colour.
    pub(super) fn triangle(&mut self, corners: [Place; 3], colour: Colour) {
        let [a, b, c] = corners.map(|[x, y, near]| [x * SAMPLES as f64, y * SAMPLES as f64, near]);
        // Twice the signed area.
        let area = turn(a, b, [c[0], c[1]]);
        if !(area.abs() > 0.0) {
            return;
        }
        let range = |axis: usize| {
            let [low, high] = [f64::min, f64::max].map(|pick| pick(pick(a[axis], b[axis]), c[axis]));
            // Samples whose middles lie between; conversions keep to what there is.
            (low - 0.5).ceil().max(0.0) as usize
                ..((high - 0.5).floor() + 1.0).clamp(0.0, self.size[axis] as f64) as usize
        };
        for row in range(1) {
            for column in range(0) {
                let at = [column as f64 + 0.5, row as f64 + 0.5];
                let parts = [turn(b, c, at), turn(c, a, at), turn(a, b, at)].map(|part| part / area);
                if parts.iter().any(|&part| part < 0.0) {
                    continue;
                }
                let near = (parts[0] * a[2] + parts[1] * b[2] + parts[2] * c[2]) as f32;
                let sample = row * self.size[0] + column;
                if near > self.near[sample] {
                    self.near[sample] = near;
                    self.colour[sample] = colour;
                }
            }
        }
    }

    /// Draws a straight line of some pixels' width.
    pub(super) fn line(&mut self, [a, b]: [Place; 2], width: f64, colour: Colour) {
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        let length = x.hypot(y);
        if !(length > 0.0) {
            return;
        }
        let [x, y] = [x, y].map(|part| 0.5 * width * part / length);
        // Half a width longer at both ends, so that lines meet in corners.
        let corner = |[px, py, near]: Place, along: f64, across: f64| {
            [px + along * x - across * y, py + along * y + across * x, near]
        };
        let corners =
            [corner(a, -1.0, -1.0), corner(b, 1.0, -1.0), corner(b, 1.0, 1.0), corner(a, -1.0, 1.0)];
        self.triangle([corners[0], corners[1], corners[2]], colour);
        self.triangle([corners[0], corners[2], corners[3]], colour);
    }

    /// Puts what is seen into the pixels of a picture of this size.
    pub(super) fn show(&self, picture: &mut Pixmap) {
        let columns = self.size[0] / SAMPLES;
        for (at, pixel) in picture.pixels_mut().iter_mut().enumerate() {
            let first = at / columns * SAMPLES * self.size[0] + at % columns * SAMPLES;
            let samples = (0..SAMPLES * SAMPLES).map(|k| first + k / SAMPLES * self.size[0] + k % SAMPLES);
            let sum = samples.fold([0_usize; 3], |sum, sample| {
                std::array::from_fn(|k| sum[k] + usize::from(self.colour[sample][k]))
            });
            let [r, g, b] = sum.map(|part| (part / (SAMPLES * SAMPLES)) as u8);
            if let Some(colour) = PremultipliedColorU8::from_rgba(r, g, b, u8::MAX) {
                *pixel = colour;
            }
        }
    }
}

/// Twice the signed area of a triangle.
fn turn(a: Place, b: Place, c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
