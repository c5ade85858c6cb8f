//! A hexahedron along one normal: its truncated volume as a function of the depth of the plane.

use crate::centroid;
use crate::frame::Direction;
use crate::moment::{self, PartMoment};
use crate::parallelepiped::UnitCube;
use crate::plane_constant::Monotone;
use crate::root::Value;

use super::profile::Profile;
use super::{Hexahedron, Vector3};

/// A hexahedron along one normal, in its frame: heights of the nodes over the lowest of them, in units of `size`.
pub(super) struct Along<'a> {
    cell: &'a Hexahedron,
    /// The normal in the frame; its size is the unit of all heights and depths here.
    pub(super) direction: Direction<3>,
    /// `m.y` of the lowest node.
    pub(super) low: f64,
    heights: [f64; 8],
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
        let below = heights.iter().filter(|&&s| s <= 0.0).count();
        let whole = self.cell.local_volume;
        if below % 8 == 0 {
            return Value { value: if below == 0 { 0.0 } else { whole }, ..Value::default() };
        }
        // The smaller part is the one to compute, which keeps its relative accuracy.
        let side = if below <= 4 { 1.0 } else { -1.0 };
        let m = self.direction.m * side;
        let Value { value, derivative, second } =
            Profile::new(&heights.map(|s| s * side), &self.cell.local, &m).volume(0.0);
        Value { value: if below <= 4 { value } else { whole - value }, derivative, second: side * second }
    }

    /// Volume and first moment below one depth, in the frame.
    pub(super) fn moment(&self, depth: f64) -> PartMoment<3> {
        moment::of_hexahedron(&self.cell.local, &self.direction.m, &self.heights.map(|h| h - depth))
    }

    /// The centroid of the section at one depth, in the frame.
    pub(super) fn section_centroid(&self, depth: f64) -> Option<Vector3> {
        let heights = self.heights.map(|h| h - depth);
        let of_cell = if self.cell.affine { centroid::of_parallelepiped } else { centroid::of_hexahedron };
        of_cell(&self.cell.local, &self.direction.m, &heights)
    }

    /// The same, prepared for many depths.
    #[inline(always)]
    pub(super) fn rising(&self) -> Rising {
        let heights = &self.heights;
        Rising {
            profile: Profile::new(heights, &self.cell.local, &self.direction.m),
            cube: UnitCube::new(self.direction.m.as_slice()),
            span: -smallest(&heights.map(|h| -h)),
            middle: heights.iter().sum::<f64>() / 8.0,
            total: self.cell.local_volume,
        }
    }
}

/// The smallest of eight numbers, in pairs.
#[inline(always)]
fn smallest(numbers: &[f64; 8]) -> f64 {
    let smaller = |a: f64, b: f64| if b < a { b } else { a };
    let [a, b, c, d, e, f, g, h] = *numbers;
    smaller(smaller(smaller(a, b), smaller(c, d)), smaller(smaller(e, f), smaller(g, h)))
}

/// The volume below a plane as it rises.
pub(super) struct Rising {
    profile: Profile,
    /// The cell without its twists, along the same normal.
    cube: UnitCube,
    /// Height of the highest node, and the mean height.
    span: f64,
    middle: f64,
    total: f64,
}

impl Monotone for Rising {
    #[inline(always)]
    fn span(&self) -> f64 {
        self.span
    }

    #[inline(always)]
    fn total(&self) -> f64 {
        self.total
    }

    #[inline(always)]
    fn volume(&mut self, depth: f64) -> Value {
        self.profile.volume(depth)
    }

    /// From the affine part: for small parts with the lowest corners in one place and the heights stretched, for others with the
    /// middles in one place; over the first sixteenth of the cell the one gives way to the other.
    #[inline(always)]
    fn start(&self, fraction: f64) -> f64 {
        let depth = self.cube.position(fraction);
        let stretched = depth * (self.span / self.cube.span());
        let centred = depth + (self.middle - 0.5 * self.cube.span());
        let weight = (16.0 * fraction).min(1.0);
        (stretched + weight * (centred - stretched)).clamp(0.0, self.span)
    }

    fn closed_form(&mut self, _fraction: f64) -> Option<(f64, usize)> {
        None
    }
}
