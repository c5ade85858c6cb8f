//! A hexahedron along one normal: its truncated volume as a function of the depth of the plane.

use crate::centroid;
use crate::frame::Direction;
use crate::moment::{self, PartMoment};
use crate::parallelepiped::UnitCube;
use crate::plane_constant::Monotone;
use crate::root::Value;

use super::profile::{Profile, Shadow};
use super::{Hexahedron, Vector3};

/// A hexahedron along one normal, in its frame: heights of the nodes over the lowest of them, in units of `size`.
pub(super) struct Along<'a> {
    pub(super) cell: &'a Hexahedron,
    /// The normal in the frame; its size is the unit of all heights and depths here.
    pub(super) direction: Direction<3>,
    /// `m.y` of the lowest node.
    pub(super) low: f64,
    pub(super) heights: [f64; 8],
}

impl<'a> Along<'a> {
    #[inline(always)]
    pub(super) fn new(cell: &'a Hexahedron, normal: &Vector3) -> Self {
        let direction = cell.direction(normal);
        let mut heights = cell.local.map(|y| direction.m.dot(&y));
        let low = smallest(&heights);
        heights.iter_mut().for_each(|h| *h -= low);
        Self { cell, direction, low, heights }
    }

    /// The depth of a plane over the lowest node.
    #[inline(always)]
    pub(super) fn depth(&self, constant: f64) -> f64 {
        self.direction.level(constant) - self.low
    }

    /// Volume and section below one depth.
    #[inline(always)]
    pub(super) fn volume(&self, depth: f64) -> Value {
        let heights = self.heights.map(|h| h - depth);
        let whole = self.cell.local_volume;
        let Some(side) = smaller_side(&heights) else {
            return Value { value: if heights[0] > 0.0 { 0.0 } else { whole }, ..Value::default() };
        };
        let m = self.direction.m * side;
        let Value { value, derivative, second } =
            Profile::new(&heights.map(|s| s * side), &self.cell.local, &m).volume(0.0);
        Value { value: if side > 0.0 { value } else { whole - value }, derivative, second: side * second }
    }

    /// Volume and first moment below one depth, in the frame.
    pub(super) fn moment(&self, depth: f64) -> PartMoment<3> {
        moment::of_hexahedron(&self.cell.local, &self.direction.m, &self.heights.map(|h| h - depth))
    }

    /// The centroid of the section at one depth, in the frame.
    #[inline(always)]
    pub(super) fn section_centroid(&self, depth: f64) -> Option<Vector3> {
        let heights = self.heights.map(|h| h - depth);
        let m = &self.direction.m;
        if self.cell.affine {
            return centroid::of_parallelepiped(&self.cell.local, m, &heights);
        }
        let side = smaller_side(&heights)?;
        let heights = heights.map(|s| s * side);
        // Relative to the lowest node of that side, which keeps the digits of small sections.
        let lowest = (1..8).fold(0, |best, i| if heights[i] < heights[best] { i } else { best });
        let origin = self.cell.local[lowest];
        let shadow = Shadow::new(&self.cell.local.map(|y| y - origin), &(m * side));
        let [area, first, second] = Profile::over(&heights, &shadow).section(&shadow);
        let [axis, j, k] = shadow.axes;
        let mut centroid = Vector3::zeros();
        (centroid[j], centroid[k]) = (-side * m[axis] * first / area, second / area);
        // On the plane: `m` is 1 or -1 along the axis.
        centroid[axis] = -m[axis] * (side * heights[lowest] + m[j] * centroid[j] + m[k] * centroid[k]);
        // An area of zero where the plane touches a node or an edge.
        centroid.iter().all(|c| c.is_finite()).then(|| origin + centroid)
    }

    /// The same, prepared for many depths.
    #[inline(always)]
    pub(super) fn rising(&self) -> Rising {
        let profile = Profile::new(&self.heights, &self.cell.local, &self.direction.m);
        Rising { profile, range: Range::new(&self.direction.m, &self.heights), total: self.cell.local_volume }
    }
}

/// For heights of the nodes over a plane, 1 if most of them are above it and -1 if most are below: on that side of the plane is the
/// smaller part, which is the one to compute, for its relative accuracy. None where all are on one side.
#[inline(always)]
fn smaller_side(heights: &[f64; 8]) -> Option<f64> {
    match heights.iter().filter(|&&s| s <= 0.0).count() {
        0 | 8 => None,
        below => Some(if below <= 4 { 1.0 } else { -1.0 }),
    }
}

/// The smallest of eight numbers, in pairs.
#[inline(always)]
fn smallest(numbers: &[f64; 8]) -> f64 {
    let smaller = |a: f64, b: f64| if b < a { b } else { a };
    let [a, b, c, d, e, f, g, h] = *numbers;
    smaller(smaller(smaller(a, b), smaller(c, d)), smaller(smaller(e, f), smaller(g, h)))
}

/// The depths of a plane that rises through a cell.
pub(super) struct Range {
    /// The cell without its twists, along the same normal.
    cube: UnitCube,
    /// Height of the highest node, and the mean height.
    pub(super) span: f64,
    middle: f64,
}

impl Range {
    /// For heights of the nodes over the lowest of them.
    #[inline(always)]
    pub(super) fn new(m: &Vector3, heights: &[f64; 8]) -> Self {
        Self {
            cube: UnitCube::new(m.as_slice()),
            span: -smallest(&heights.map(|h| -h)),
            middle: heights.iter().sum::<f64>() / 8.0,
        }
    }

    /// A first guess for the depth of a part of the volume, from the affine part of the cell: for small parts with the lowest corners in
    /// one place and the heights stretched, for others with the middles in one place; over the first sixteenth of the cell the one
    /// gives way to the other.
    #[inline(always)]
    pub(super) fn start(&self, fraction: f64) -> f64 {
        let depth = self.cube.position(fraction);
        let stretched = depth * (self.span / self.cube.span());
        let centred = depth + (self.middle - 0.5 * self.cube.span());
        let weight = (16.0 * fraction).min(1.0);
        (stretched + weight * (centred - stretched)).clamp(0.0, self.span)
    }
}

/// The volume below a plane as it rises.
pub(super) struct Rising {
    profile: Profile,
    range: Range,
    total: f64,
}

impl Monotone for Rising {
    #[inline(always)]
    fn span(&self) -> f64 {
        self.range.span
    }

    #[inline(always)]
    fn total(&self) -> f64 {
        self.total
    }

    #[inline(always)]
    fn volume(&mut self, depth: f64) -> Value {
        self.profile.volume(depth)
    }

    #[inline(always)]
    fn start(&self, fraction: f64) -> f64 {
        self.range.start(fraction)
    }

    fn closed_form(&mut self, _fraction: f64) -> Option<(f64, usize)> {
        None
    }
}
