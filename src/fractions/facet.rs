//! The part of a triangle (2D: of a segment) in a box or on one side of a plane.

use vofkit_geometry::{HalfSpace, Vector};

use crate::shape::body::normal;

/// Corners that there is room for. A triangle in a box has nine; each plane adds one at most.
const CORNERS: usize = 24;

/// A convex part of a triangle of a body's surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet<const D: usize> {
    /// The number of the surface that it belongs to.
    pub(super) surface: usize,
    /// The half-space under the triangle, with a unit normal.
    pub(super) half_space: HalfSpace<D>,
    corners: [Vector<D>; CORNERS],
    count: usize,
}

impl<const D: usize> Facet<D> {
    /// A whole triangle; none if it has no area.
    pub(super) fn new(surface: usize, triangle: &[Vector<D>; D]) -> Option<Self> {
        let across = normal(triangle);
        let length = across.norm();
        let normal = across / length;
        if !(length > 0.0 && normal.iter().all(|n| n.is_finite())) {
            return None;
        }
        let half_space = HalfSpace { normal, constant: normal.dot(&triangle[0]) };
        let mut corners = [Vector::zeros(); CORNERS];
        corners[..D].copy_from_slice(triangle);
        Some(Self { surface, half_space, corners, count: D })
    }

    /// The part in the box between two corners; none if there is none.
    pub(super) fn within(self, lower: &Vector<D>, upper: &Vector<D>) -> Option<Self> {
        (0..D).try_fold(self, |facet, k| {
            let facet = facet.part(|x| lower[k] - x[k], 0.0)?;
            facet.part(|x| x[k] - upper[k], 0.0)
        })
    }

    /// The length of a segment, the area of a triangle.
    pub(super) fn size(&self) -> f64 {
        let corners = &self.corners[..self.count];
        if D == 2 {
            return (corners[1] - corners[0]).norm();
        }
        let sides = corners.windows(2).skip(1).map(|two| [two[0] - corners[0], two[1] - corners[0]]);
        let squares = sides.map(|[a, b]| a.norm_squared() * b.norm_squared() - a.dot(&b).powi(2));
        0.5 * squares.map(|square| square.max(0.0).sqrt()).sum::<f64>()
    }

    /// The part whose heights are not above zero; none where no height is below zero. Heights up to `negligible` count as zero.
    pub(super) fn part(&self, height: impl Fn(&Vector<D>) -> f64, negligible: f64) -> Option<Self> {
        let corners = &self.corners[..self.count];
        let mut heights = [0.0; CORNERS];
        heights.iter_mut().zip(corners).for_each(|(h, x)| *h = height(x));
        let heights = &heights[..self.count];
        if !heights.iter().any(|&h| h < -negligible) {
            return None;
        }
        // Where there is no room the part is larger than it need be, which costs a cut.
        if heights.iter().all(|&h| h <= negligible) || self.count + 1 >= CORNERS {
            return Some(*self);
        }
        let mut part = Self { count: 0, ..*self };
        let mut add = |x: Vector<D>| {
            part.corners[part.count] = x;
            part.count += 1;
        };
        // A segment does not go back to its start.
        let sides = if D == 2 { 1 } else { self.count };
        for i in 0..self.count {
            let (a, b) = (heights[i], heights[(i + 1) % self.count]);
            if a <= negligible {
                add(corners[i]);
            }
            if i < sides && a.min(b) < -negligible && a.max(b) > negligible {
                add(corners[i] + (corners[(i + 1) % self.count] - corners[i]) * (a / (a - b)));
            }
        }
        Some(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_triangle_and_of_a_segment_add_up() {
        let corners = [[0.1, 0.2, 0.0], [0.9, 0.3, 0.5], [0.2, 0.8, 1.0]].map(|x: [f64; 3]| x.into());
        let triangle = Facet::<3>::new(0, &corners).expect("it has an area");
        for (normal, constant) in [([1.0, 0.0, 0.0], 0.4), ([0.3, -0.5, 0.8], 0.1), ([0.0, 0.0, 1.0], 0.0)] {
            let height = |x: &Vector<3>| Vector::from(normal).dot(x) - constant;
            let parts = [triangle.part(height, 1e-12), triangle.part(|x| -height(x), 1e-12)];
            let sum: f64 = parts.iter().flatten().map(Facet::size).sum();
            assert!((sum - triangle.size()).abs() <= 1e-15, "{sum} of {}", triangle.size());
        }
        let segment = Facet::<2>::new(0, &[[0.0, 0.0].into(), [2.0, 1.0].into()]).expect("it has a length");
        let part = segment.within(&Vector::repeat(0.0), &Vector::repeat(0.5)).expect("it is there");
        assert!((part.size() - 1.25_f64.sqrt() / 2.0).abs() <= 1e-15);
        assert!(segment.within(&Vector::repeat(3.0), &Vector::repeat(4.0)).is_none());
        assert!(Facet::<3>::new(0, &[[0.0; 3].into(), [1.0; 3].into(), [2.0; 3].into()]).is_none());
    }
}
