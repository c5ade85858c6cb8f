//! A hexahedron along one normal, prepared for any number of depths: an evaluation is then a sum of scalars.

use crate::cell::Cell;
use crate::face_part::{Part, Parts};
use crate::root::Value;
use crate::tolerance::HEIGHT_NEGLIGIBLE;

use super::cases::{self, CASES, CORNERS, Place};
use super::{Hexahedron, Vector3};

/// The faces along one normal: what does not depend on the depth of the plane; see [`crate::face_part`].
pub(super) struct Faces {
    /// Heights of the nodes.
    heights: [f64; 8],
    /// Differences of height along the edges, and their inverses; the last are of an edge that is none.
    rise: [f64; 16],
    inverse: [f64; 16],
    /// `g` and `t` of the faces' corners; those of the last face, which is none, are zero.
    density: [f64; 32],
    twist: [f64; 32],
    /// For each whole face, at depth 0, the integral of `-s G`, and the integral of `G`.
    whole: [[f64; 2]; 8],
}

/// The truncated volume by the depth of the plane.
pub(super) struct Profile {
    faces: Faces,
    /// The nodes that were below the plane in the last evaluation, the parts of the faces, and the sum over whole faces: they stay
    /// while no node is passed.
    mask: usize,
    parts: Parts<6>,
    below: [f64; 2],
}

impl Profile {
    /// For nodes with these heights. [`Self::set_faces`] must follow: what is large is filled where it stays.
    #[inline(always)]
    pub(super) fn new(heights: [f64; 8]) -> Self {
        let faces = Faces {
            heights,
            rise: [1.0; 16],
            inverse: [1.0; 16],
            density: [0.0; 32],
            twist: [0.0; 32],
            whole: [[0.0; 2]; 8],
        };
        Self { faces, mask: 0, parts: Parts::new(), below: [0.0; 2] }
    }

    /// Prepares the faces between nodes `y`, whose heights are those along `m`; the largest component of `m` is 1 or -1.
    #[inline(always)]
    pub(super) fn set_faces(&mut self, y: &[Vector3; 8], m: &Vector3) {
        self.faces.set_edges();
        // `e` along the axis of that component: `X_i . e` is then a cross product in the plane of the other two.
        let [x_is_largest, y_is_largest] = [m[0].abs() == 1.0, m[1].abs() == 1.0];
        let axis = if x_is_largest { 0 } else { if y_is_largest { 1 } else { 2 } };
        let (j, k) = if x_is_largest { (1, 2) } else { if y_is_largest { (2, 0) } else { (0, 1) } };
        let down = -m[axis].signum();
        let shadow = std::array::from_fn(|i| [down * y[i].as_slice()[j], y[i].as_slice()[k]]);
        self.faces.set_face::<0>(&shadow);
        self.faces.set_face::<1>(&shadow);
        self.faces.set_face::<2>(&shadow);
        self.faces.set_face::<3>(&shadow);
        self.faces.set_face::<4>(&shadow);
        self.faces.set_face::<5>(&shadow);
    }

    /// The part of the cell below one depth.
    pub(super) fn volume(&mut self, depth: f64) -> Value {
        let s = self.faces.heights.map(|h| h - depth);
        let mask = inside_mask(&s);
        let case = &CASES[mask];
        if mask != self.mask {
            self.mask = mask;
            self.faces.gather(&case.parts, &mut self.parts);
            self.below = self.faces.sum_of_whole(case.whole);
        }
        let [value, middle] = self.below;
        let mut sum = Value { value: value + depth * middle, derivative: middle, second: 0.0 };
        self.parts.integrate(depth, &mut sum, |i| self.faces.quotient(case.parts[i], &s));
        if case.saddles != 0 {
            self.faces.add_saddles(case.saddles, mask, &s, depth, &mut sum);
        }
        sum
    }
}

impl Faces {
    #[inline(always)]
    fn set_edges(&mut self) {
        for (i, [a, b]) in Hexahedron::EDGES.into_iter().enumerate() {
            let difference = (self.heights[b] - self.heights[a]).abs();
            self.rise[i] = if difference > HEIGHT_NEGLIGIBLE { difference } else { HEIGHT_NEGLIGIBLE };
        }
        self.inverse = self.rise.map(f64::recip);
    }

    /// Prepares a face, from the nodes projected along `e`.
    #[inline(always)]
    fn set_face<const FACE: usize>(&mut self, shadow: &[[f64; 2]; 8]) {
        let nodes = [0, 1, 2, 3].map(|i| Hexahedron::FACE_NODES[FACE][i]);
        let between = |from: usize, to: usize| {
            let ([a, b], [c, d]) = (shadow[nodes[from]], shadow[nodes[to]]);
            [c - a, d - b]
        };
        let cross = |x: [f64; 2], y: [f64; 2]| x[0] * y[1] - x[1] * y[0];
        let edges = [between(0, 1), between(1, 2), between(2, 3), between(0, 3)];
        let [g1, g2, g3] = [cross(edges[0], edges[3]), cross(edges[0], edges[1]), cross(edges[1], edges[2])];
        let g4 = g1 - g2 + g3;
        let [h1, h2, h3, h4] = nodes.map(|node| self.heights[node]);
        let (lower, upper) = (h2 - h1, h3 - h4);
        let twist = upper - lower;
        let middle = 0.5 * (g1 + g3);
        let mean = 0.25 * ((h1 + h2) + (h3 + h4));
        let across = (h4 - h1) + (h3 - h2);
        let slopes = (lower + upper) * (g2 - g1) + across * (g4 - g1);
        self.density[4 * FACE..4 * FACE + 4].copy_from_slice(&[g1, g2, g3, g4]);
        self.twist[4 * FACE..4 * FACE + 4].copy_from_slice(&[twist, -twist, twist, -twist]);
        self.whole[FACE] = [-(mean * middle + slopes * (1.0 / 24.0)), middle];
    }

    /// The sum over whole faces.
    #[inline(always)]
    fn sum_of_whole(&self, mut faces: u8) -> [f64; 2] {
        let mut sum = [0.0; 2];
        while faces != 0 {
            let [value, middle] = self.whole[faces.trailing_zeros() as usize & 7];
            sum[0] += value;
            sum[1] += middle;
            faces &= faces - 1;
        }
        sum
    }

    /// Adds the faces with opposite nodes below.
    #[cold]
    #[inline(never)]
    fn add_saddles(&self, faces: u8, mask: usize, s: &[f64; 8], depth: f64, sum: &mut Value) {
        for face in (0..6).filter(|face| faces >> face & 1 == 1) {
            let (parts, joined) = cases::saddle(face, mask, s);
            if joined {
                let [value, middle] = self.whole[face];
                *sum += Value { value: value + depth * middle, derivative: middle, second: 0.0 };
            }
            let mut columns = Parts::new();
            self.gather(&parts, &mut columns);
            columns.integrate(depth, sum, |i| self.quotient(parts[i], s));
        }
    }

    /// Puts parts side by side.
    #[inline(always)]
    fn gather<const N: usize>(&self, places: &[Place; N], parts: &mut Parts<N>) {
        for (i, &place) in places.iter().enumerate() {
            parts.set(i, self.part(place));
        }
    }

    #[inline(always)]
    fn part(&self, place: Place) -> Part {
        let index = place.corner();
        let corner = &CORNERS[index];
        let [is_corner, is_strip] = place.kind();
        let g = |step: usize| self.density[(index & !3 | (index + step) & 3) & 31];
        let of_node = |node: u8| self.heights[usize::from(node & 7)];
        Part {
            near: of_node(corner.near),
            next: of_node(corner.next),
            base: is_strip,
            per_next: is_corner * of_edge(&self.inverse, corner.to_next),
            per_across: is_strip * of_edge(&self.inverse, corner.across),
            rise: of_edge(&self.rise, corner.to_last),
            per_rise: of_edge(&self.inverse, corner.to_last),
            twist: place.sign() * self.twist[index],
            density: [g(0), g(1) - g(0), g(3) - g(0)],
            sign: place.sign(),
        }
    }

    /// What [`Parts::integrate`] asks for, with the heights `s` over the plane.
    fn quotient(&self, place: Place, s: &[f64; 8]) -> [f64; 2] {
        let corner = &CORNERS[place.corner()];
        let [s1, s2, s3, s4] =
            [corner.near, corner.next, corner.far, corner.last].map(|node| s[usize::from(node & 7)]);
        if place.kind()[1] == 1.0 {
            [of_edge(&self.rise, corner.across), of_edge(&self.rise, corner.to_last)]
        } else {
            // The product underflows only where the face lies in the plane to beyond rounding, and adds nothing.
            [(s2 * s4 - s1 * s3).max(0.0), ((s2 - s1) * (s4 - s1)).max(f64::MIN_POSITIVE)]
        }
    }
}

#[inline(always)]
fn of_edge(edges: &[f64; 16], edge: u8) -> f64 {
    edges[usize::from(edge & 15)]
}

/// Which nodes have a height that is not positive, one bit each.
#[inline(always)]
fn inside_mask(heights: &[f64; 8]) -> usize {
    heights.iter().enumerate().fold(0, |mask, (i, &s)| mask | (usize::from(s <= 0.0) << i))
}
