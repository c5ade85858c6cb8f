//! Regions with straight edges and plane faces, cut by planes: on the stack, of fixed capacity.
//!
//! A [`Region`] is a [`Polygon`] or a [`Polyhedron`]: a closed boundary of straight pieces, and what it encloses is
//! counted by its winding number. So a region need not be convex, and where it folds over it counts negative; every
//! call below is exact for any closed boundary (to rounding, and up to the capacity).
//!
//! **Cutting.** Each face is cut by itself. Where its boundary leaves a half-space and comes back, the gap is closed
//! along the plane, and the same gaps, taken the other way round, bound the new face in the plane. Which way out is
//! joined to which way in does not matter: all lie on one line, and edges along a line enclose nothing. So there is
//! no case that fails, whatever the face looks like. The points on the plane are computed once for both parts, always
//! from the lower end of an edge, so that the two parts add up to the whole.
//!
//! **Degenerate planes.** A point on the plane counts as below it. A cut through a corner, along an edge or a face leaves
//! edges of no length and faces of no area, which enclose nothing.
//!
//! Read [`Polygon`], [`Polyhedron`], then [`tile`]: what a region has in common with a cell.

mod faces;
mod polygon;
mod polyhedron;
pub mod tile;

use std::fmt;

pub use polygon::Polygon;
pub use polyhedron::Polyhedron;
pub use tile::{HexahedronTile, QuadTile, Tile, Workspace};

use crate::tolerance::DIRECTION_NEGLIGIBLE;
use crate::{HalfSpace, Vector};

/// Volume (2D: area) of a region, and its first moment, the integral of position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments<const D: usize> {
    /// The volume; negative where the boundary runs the other way round.
    pub volume: f64,
    /// The integral of position: over the volume, it is the centroid.
    pub first: Vector<D>,
}

/// Where a region lies, seen from a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// All of it in the half-space.
    Below,
    /// None of it in the half-space but for points on the plane.
    Above,
    /// On both sides.
    Across,
}

/// A region that has no room for what a cut would leave: its boundary goes through the plane too often. Its
/// [simplices](Region::simplices) always have room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Full;

impl fmt::Display for Full {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a cut leaves more corners than a region has room for")
    }
}

impl std::error::Error for Full {}

/// A region with a closed boundary: [`Polygon`] for `D = 2`, [`Polyhedron`] for `D = 3`.
pub trait Region<const D: usize>: Clone + Send + Sync + fmt::Debug {
    /// A region of nothing, to be written to.
    fn empty() -> Self;

    /// The region whose boundary runs from the middle of each face of a cell to the face's edges: nodes in node order, one
    /// middle for each face. In 2D each face becomes two segments, in 3D four triangles.
    ///
    /// # Panics
    /// If there are not `2^D` nodes and `2 D` middles.
    fn fans(nodes: &[Vector<D>], middles: &[Vector<D>]) -> Self;

    /// The corners.
    fn corners(&self) -> impl Iterator<Item = &Vector<D>>;

    /// Moves all corners by a vector.
    fn translate(&mut self, shift: &Vector<D>);

    /// The volume, and nothing else.
    fn volume(&self) -> f64;

    /// Volume and first moment.
    fn moments(&self) -> Moments<D>;

    /// Where it lies, seen from the plane of a half-space.
    fn side(&self, half_space: &HalfSpace<D>) -> Side;

    /// Writes the part in the half-space to `below`, but only where the answer is [`Side::Across`].
    ///
    /// # Errors
    /// No room.
    fn cut(&self, half_space: &HalfSpace<D>, below: &mut Self) -> Result<Side, Full>;

    /// Writes the part in the half-space and the rest, but only where the answer is [`Side::Across`].
    ///
    /// # Errors
    /// No room.
    fn split(&self, half_space: &HalfSpace<D>, below: &mut Self, above: &mut Self) -> Result<Side, Full>;

    /// Whether every piece of the boundary turns its inner side to a point: nothing then folds over.
    fn is_seen_from(&self, point: &Vector<D>) -> bool;

    /// Simplices that add up to the region; some may be turned inside out and count negative.
    fn simplices(&self, visit: &mut dyn FnMut(&Self));
}

/// The corners of the box around points.
pub fn bounds<'a, const D: usize>(points: impl IntoIterator<Item = &'a Vector<D>>) -> [Vector<D>; 2] {
    let nothing = [Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY)];
    points.into_iter().fold(nothing, |[low, high], x| [low.inf(x), high.sup(x)])
}

/// Which corners of a region lie below a plane, as bits, with all heights.
struct Heights<const N: usize> {
    heights: [f64; N],
    below: u64,
    side: Side,
}

impl<const N: usize> Heights<N> {
    /// The heights of some points, of which those given as bits are corners.
    #[inline(always)]
    fn new<const D: usize>(points: &[Vector<D>], corners: u64, half_space: &HalfSpace<D>) -> Self {
        let mut heights = [0.0; N];
        let mut below = 0;
        // Heights along a smaller normal would have lost their digits to underflow: it counts as none.
        let negligible = half_space.normal.amax() < DIRECTION_NEGLIGIBLE;
        let normal = if negligible { Vector::zeros() } else { half_space.normal };
        let half_space = HalfSpace { normal, constant: half_space.constant };
        for (i, (height, x)) in heights.iter_mut().zip(points).enumerate() {
            *height = half_space.height(x);
            below |= u64::from(*height <= 0.0) << i;
        }
        below &= corners;
        let side = match below {
            _ if below == corners => Side::Below,
            0 => Side::Above,
            _ => Side::Across,
        };
        Self { heights, below, side }
    }

    fn is_below(&self, point: usize) -> bool {
        self.below >> point & 1 == 1
    }

    /// The point of the plane between a corner below and one above.
    fn crossing<const D: usize>(&self, points: &[Vector<D>], below: usize, above: usize) -> Vector<D> {
        let (low, high) = (self.heights[below], self.heights[above]);
        points[below] + (points[above] - points[below]) * (low / (low - high))
    }
}
