//! The polygon: a closed walk of straight edges.

use super::{Full, Heights, Moments, Region, Side};
use crate::{Cell, HalfSpace, Quad, Vector};

type Vector2 = Vector<2>;

/// Corners that a polygon has room for. A cell's pre-image has eight; each cut of a convex one adds one.
const POINTS: usize = 32;

/// A polygon with straight edges, counter-clockwise where it counts positive. It may cross itself.
#[derive(Clone, Debug)]
pub struct Polygon {
    points: [Vector2; POINTS],
    count: usize,
}

impl Polygon {
    /// The polygon with these corners.
    ///
    /// # Errors
    /// More than there is room for.
    pub fn new(corners: &[Vector2]) -> Result<Self, Full> {
        let mut polygon = Self::empty();
        corners.iter().try_for_each(|x| polygon.push(*x))?;
        Ok(polygon)
    }

    fn push(&mut self, x: Vector2) -> Result<(), Full> {
        *self.points.get_mut(self.count).ok_or(Full)? = x;
        self.count += 1;
        Ok(())
    }

    fn heights(&self, half_space: &HalfSpace<2>) -> Heights<POINTS> {
        Heights::new(&self.points[..self.count], (1 << self.count) - 1, half_space)
    }

    fn part(&self, heights: &Heights<POINTS>, below: bool, part: &mut Self) -> Result<(), Full> {
        part.count = 0;
        for i in 0..self.count {
            let next = if i + 1 == self.count { 0 } else { i + 1 };
            let kept = heights.is_below(i) == below;
            if kept {
                part.push(self.points[i])?;
            }
            if kept != (heights.is_below(next) == below) {
                let (lower, upper) = if kept == below { (i, next) } else { (next, i) };
                part.push(heights.crossing(&self.points, lower, upper))?;
            }
        }
        Ok(())
    }

    /// Twice the areas of the triangles from the first corner, with their two other corners relative to it.
    fn fan(&self) -> impl Iterator<Item = (f64, Vector2, Vector2)> + '_ {
        let first = self.points[0];
        self.points[..self.count].windows(2).skip(1).map(move |side| {
            let (a, b) = (side[0] - first, side[1] - first);
            (a[0] * b[1] - a[1] * b[0], a, b)
        })
    }
}

impl Region<2> for Polygon {
    fn empty() -> Self {
        Self { points: [Vector2::new(0.0, 0.0); POINTS], count: 0 }
    }

    fn fans(nodes: &[Vector2], middles: &[Vector2]) -> Self {
        assert!(nodes.len() == 4 && middles.len() == 4, "a quadrilateral has four nodes and four faces");
        let mut polygon = Self::empty();
        // Around the cell, every other corner is a node: that with which the face begins.
        for (place, face) in AROUND.into_iter().enumerate() {
            polygon.points[2 * place] = nodes[Quad::FACE_NODES[face][0]];
            polygon.points[2 * place + 1] = middles[face];
        }
        polygon.count = 8;
        polygon
    }

    fn corners(&self) -> impl Iterator<Item = &Vector2> {
        self.points[..self.count].iter()
    }

    fn translate(&mut self, shift: &Vector2) {
        self.points[..self.count].iter_mut().for_each(|x| *x += shift);
    }

    fn volume(&self) -> f64 {
        0.5 * self.fan().map(|(twice, ..)| twice).sum::<f64>()
    }

    fn moments(&self) -> Moments<2> {
        let (mut sum, mut first) = (0.0, Vector2::zeros());
        for (twice, a, b) in self.fan() {
            sum += twice;
            first += (a + b) * (twice / 6.0);
        }
        let volume = 0.5 * sum;
        Moments { volume, first: first + self.points[0] * volume }
    }

    fn side(&self, half_space: &HalfSpace<2>) -> Side {
        self.heights(half_space).side
    }

    fn cut(&self, half_space: &HalfSpace<2>, below: &mut Self) -> Result<Side, Full> {
        let heights = self.heights(half_space);
        if heights.side == Side::Across {
            self.part(&heights, true, below)?;
        }
        Ok(heights.side)
    }

    fn split(&self, half_space: &HalfSpace<2>, below: &mut Self, above: &mut Self) -> Result<Side, Full> {
        let heights = self.heights(half_space);
        if heights.side == Side::Across {
            self.part(&heights, true, below)?;
            self.part(&heights, false, above)?;
        }
        Ok(heights.side)
    }

    fn is_seen_from(&self, point: &Vector2) -> bool {
        (0..self.count).all(|i| {
            let next = if i + 1 == self.count { 0 } else { i + 1 };
            let (a, b) = (self.points[i] - point, self.points[next] - point);
            a[0] * b[1] - a[1] * b[0] >= 0.0
        })
    }

    fn simplices(&self, visit: &mut dyn FnMut(&Self)) {
        let mut triangle = Self::empty();
        triangle.count = 3;
        for i in 2..self.count {
            triangle.points[..3].copy_from_slice(&[self.points[0], self.points[i - 1], self.points[i]]);
            visit(&triangle);
        }
    }
}

/// The faces of a quadrilateral in the order in which its boundary meets them.
const AROUND: [usize; 4] = [2, 1, 3, 0];
