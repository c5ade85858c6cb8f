//! Lines and polygons as the compact text of an SVG path.

use std::fmt::Write;

/// A point in hundredths of a pixel, x to the right and y down.
pub(super) type Pixel = [i64; 2];

/// The `d` attribute of an SVG path: absolute starts, relative lines, whole numbers.
#[derive(Default)]
pub(super) struct PathText {
    text: String,
}

impl PathText {
    /// Adds a line through the points, closed to a polygon if `closed`. Points that change nothing are left
    /// out.
    pub(super) fn add(&mut self, points: impl IntoIterator<Item = Pixel>, closed: bool) {
        let mut kept: Vec<Pixel> = Vec::new();
        for point in points {
            if kept.last() == Some(&point) {
                continue;
            }
            if let [.., a, b] = kept[..]
                && goes_straight_on(a, b, point)
            {
                kept.pop();
            }
            kept.push(point);
        }
        let Some(start) = kept.first().filter(|_| kept.len() > 1) else { return };
        // Writing to a string cannot fail.
        let _ = write!(self.text, "M{} {}l", start[0], start[1]);
        for (at, step) in kept.windows(2).enumerate() {
            let [x, y] = [step[1][0] - step[0][0], step[1][1] - step[0][1]];
            let _ = write!(self.text, "{}{x}{}{y}", separator(at > 0 && x >= 0), separator(y >= 0));
        }
        if closed {
            self.text.push('z');
        }
    }

    /// Whether there is nothing to draw.
    pub(super) fn is_empty(&self) -> bool {
        self.text.is_empty()
    }

    /// The attribute.
    pub(super) fn into_text(self) -> String {
        self.text
    }
}

/// A minus sign parts two numbers as well as a blank does.
fn separator(needed: bool) -> &'static str {
    if needed { " " } else { "" }
}

/// Whether `b` lies on the straight way from `a` to `c`. Coordinates are limited to 1e8, so that nothing
/// overflows.
fn goes_straight_on(a: Pixel, b: Pixel, c: Pixel) -> bool {
    let [u, v] = [[b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]];
    u[0] * v[1] == u[1] * v[0] && u[0] * v[0] + u[1] * v[1] > 0
}

#[cfg(test)]
mod tests {
    use super::PathText;

    #[test]
    fn points_that_change_nothing_are_left_out() {
        let mut path = PathText::default();
        path.add([[5, 5]], false);
        path.add([[5, 5], [5, 5]], true);
        assert!(path.is_empty());
        path.add([[0, 0], [10, 0], [10, 0], [25, 0], [25, -10], [20, -10]], false);
        path.add([[1, 2], [3, 2], [1, 2]], true);
        assert_eq!(path.into_text(), "M0 0l25 0 0-10-5 0M1 2l2 0-2 0z");
    }
}
