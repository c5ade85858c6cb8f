//! A hexahedron along one normal: its truncated volume as a function of the depth of the plane.
//!
//! This is what one plane needs; [`super::profile`] prepares for many planes with the same normal.

use crate::cell::Cell;
use crate::centroid;
use crate::face_part::{FaceMoments, FaceSum, WHOLE_FACE, face_part};
use crate::frame::Direction;
use crate::moment::{self, PartMoment};
use crate::root::Value;
use crate::ruled_face::SurfaceElement;

use super::{Hexahedron, Vector3};

/// A hexahedron along one normal, in its frame: heights of the nodes over the lowest of them, in units of `size`.
pub(super) struct Along<'a> {
    pub(super) cell: &'a Hexahedron,
    /// The normal in the frame; its size is the unit of all heights and depths here.
    pub(super) direction: Direction<3>,
    pub(super) lowest: usize,
    /// `m.y` of the lowest node.
    low: f64,
    pub(super) heights: [f64; 8],
}

impl<'a> Along<'a> {
    #[inline]
    pub(super) fn new(cell: &'a Hexahedron, normal: &Vector3) -> Self {
        let direction = cell.direction(normal);
        let mut heights = cell.local.map(|y| direction.m.dot(&y));
        let lowest = (1..8).fold(0, |best, i| if heights[i] < heights[best] { i } else { best });
        let low = heights[lowest];
        heights.iter_mut().for_each(|h| *h -= low);
        Self { cell, direction, lowest, low, heights }
    }

    /// The depth of a plane over the lowest node.
    pub(super) fn depth(&self, constant: f64) -> f64 {
        self.direction.level(constant) - self.low
    }

    /// The plane constant of a depth.
    pub(super) fn constant(&self, depth: f64) -> f64 {
        self.direction.constant(self.low + depth)
    }

    /// Volume and section below one depth.
    pub(super) fn volume(&self, depth: f64) -> Value {
        let s = self.heights.map(|h| h - depth);
        match s.iter().filter(|&&s| s <= 0.0).count() {
            0 => Value { value: 0.0, derivative: 0.0 },
            8 => Value { value: self.cell.local_volume, derivative: 0.0 },
            1..=4 => self.lower_part(&s, 1.0),
            _ => {
                // The smaller part is the one to compute: less to do, and it keeps its relative accuracy.
                let Value { value, derivative } = self.lower_part(&s.map(|s| -s), -1.0);
                Value { value: self.cell.local_volume - value, derivative }
            }
        }
    }

    /// Volume and first moment below one depth, in the frame.
    pub(super) fn moment(&self, depth: f64) -> PartMoment<3> {
        moment::of_hexahedron(&self.cell.local, &self.direction.m, &self.heights.map(|h| h - depth))
    }

    /// The centroid of the section at one depth, in the frame.
    pub(super) fn section_centroid(&self, depth: f64) -> Option<Vector3> {
        centroid::of_hexahedron(&self.cell.local, &self.direction.m, &self.heights.map(|h| h - depth))
    }

    /// Volume and section where the heights `s` over a plane with normal `sign m` are not positive.
    fn lower_part(&self, s: &[f64; 8], sign: f64) -> Value {
        let y = &self.cell.local;
        let m2 = self.direction.m.norm_squared();
        // A point of the plane next to the part that is wanted keeps small parts accurate.
        let lowest = (1..8).fold(0, |best, i| if s[i] < s[best] { i } else { best });
        let p = y[lowest] - self.direction.m * (sign * s[lowest] / m2);
        let mask = inside_mask(s);
        let mut sum = Sum { y, p, face: Hexahedron::FACE_NODES[0], triple: 0.0, k: Vector3::zeros() };
        for (i, &face) in Hexahedron::FACE_NODES.iter().enumerate() {
            sum.face = face;
            face_part(FACE_MASKS[i][mask], std::array::from_fn(|i| s[face[i]]), &mut sum);
        }
        let Sum { triple, k, .. } = sum;
        Value { value: triple / 3.0, derivative: -sign * self.direction.m.dot(&k) / m2 }
    }
}

/// Which nodes have a height that is not positive, one bit each.
#[inline]
pub(super) fn inside_mask(heights: &[f64; 8]) -> usize {
    heights.iter().enumerate().fold(0, |mask, (i, &s)| mask | (usize::from(s <= 0.0) << i))
}

/// For each face the bits of its four nodes, by the bits of the cell's eight.
pub(super) static FACE_MASKS: [[u8; 256]; 6] = {
    let mut masks = [[0; 256]; 6];
    let mut entry = 0;
    while entry < 6 * 256 {
        let (face, nodes) = (entry / 256, entry % 256);
        let mut i = 0;
        while i < 4 {
            masks[face][nodes] |= ((nodes >> Hexahedron::FACE_NODES[face][i] & 1) << i) as u8;
            i += 1;
        }
        entry += 1;
    }
    masks
};

/// The sums over faces for one plane.
struct Sum<'a> {
    y: &'a [Vector3; 8],
    /// A point of the plane.
    p: Vector3,
    face: &'a [usize],
    triple: f64,
    k: Vector3,
}

impl FaceSum for Sum<'_> {
    fn whole(&mut self) {
        self.part(0, 1.0, &WHOLE_FACE);
    }

    fn part(&mut self, first: usize, sign: f64, moments: &FaceMoments) {
        let corner = |i: usize| &self.y[self.face[(first + i) & 3]];
        let SurfaceElement { q0, q_alpha, q_beta, nu } =
            SurfaceElement::new([corner(0), corner(1), corner(2), corner(3)]);
        let part = q0 * moments.k00 + q_alpha * moments.k10 + q_beta * moments.k01;
        self.k += part * sign;
        self.triple += sign * ((corner(0) - self.p).dot(&part) - nu * moments.k11);
    }
}
