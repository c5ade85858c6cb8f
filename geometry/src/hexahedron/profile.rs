//! Faces side by side, each along the normal of its cell, prepared for any number of depths: the six faces of one cell, or
//! the same face of several cells.

use std::array::from_fn;

use crate::cell::Cell;
use crate::face_part::{Corner, Part, Weights};
use crate::hyperbola::Argument;
use crate::root::Value;
use crate::simd::either;
use crate::tolerance::HEIGHT_NEGLIGIBLE;

use super::{Hexahedron, Vector3};

/// Faces side by side, for the widest vector instructions hold eight numbers: six and two that are nothing, or those of eight cells.
pub(super) const LANES: usize = 8;

/// One number for each face.
pub(super) type Lanes = [f64; LANES];

/// What faces add to the truncated volume by the depth of the plane; see [`crate::face_part`]. What belongs to a corner of a face, or to
/// the edge from it to the next, stands at the place of the corner in outward order.
///
/// Aligned so that eight numbers never straddle two cache lines: the time for a cut would depend on where the stack begins.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Profile {
    /// Heights of the nodes.
    pub(super) heights: [Lanes; 4],
    /// Differences of height along the edges.
    rises: [Lanes; 4],
    /// `g`.
    density: [Lanes; 4],
    /// `t`, counted from the first corner.
    twist: Lanes,
    /// For the whole face, at depth 0, the integral of `-s G`, and the integral of `G`.
    whole: [Lanes; 2],
}

/// Where a face is below the plane.
struct Cut {
    /// Everywhere, or but for one corner.
    whole: bool,
    /// A part of it, or the rest without a part, is below.
    part: bool,
    /// That part is a strip along an edge.
    strip: bool,
    /// It is the rest without a corner.
    rest: bool,
    /// Two opposite corners are below.
    saddle: bool,
    /// Whether the part is counted from one of the last two corners, and from the second or the last.
    turn: [bool; 2],
}

/// A part of a face that has two of them, or a far argument.
struct RarePart {
    cut: Cut,
    part: Part,
    argument: Argument,
}

impl Cut {
    #[inline(always)]
    fn new([a, b, c, d]: [bool; 4]) -> Self {
        let rest = (a & b & (c ^ d)) | ((a ^ b) & c & d);
        let whole = (a & b & c & d) | rest;
        // The corners of the part, and the first of them.
        let [a, b, c, d] = [a ^ rest, b ^ rest, c ^ rest, d ^ rest];
        let [first_a, first_b, first_c, first_d] = [a & !d, b & !a, c & !b, d & !c];
        Self {
            whole,
            part: first_a | first_b | first_c | first_d,
            strip: (a & b) | (b & c) | (c & d) | (d & a),
            rest,
            saddle: (first_a & first_c) | (first_b & first_d),
            turn: [first_c | first_d, first_b | first_d],
        }
    }

    #[inline(always)]
    fn sign(&self) -> f64 {
        either(self.rest, -1.0, 1.0)
    }

    /// Numbers of the four corners, counted from the part's own.
    #[inline(always)]
    fn turned(&self, [a, b, c, d]: [f64; 4]) -> [f64; 4] {
        let [half, quarter] = self.turn;
        let [a, b, c, d] = [either(half, c, a), either(half, d, b), either(half, a, c), either(half, b, d)];
        [either(quarter, b, a), either(quarter, c, b), either(quarter, d, c), either(quarter, a, d)]
    }
}

/// The faces projected along `e`, the axis in which the normal is largest: `X_i . e` is then a cross product in the plane of the other two.
pub(super) struct Shadow {
    /// The axis of `e`, and the other two in cyclic order.
    pub(super) axes: [usize; 3],
    /// Coordinates along the other two; the first with its sign changed where the normal points along the axis.
    x: [[Lanes; 4]; 2],
}

impl Shadow {
    /// Of nodes `y`, along a normal whose largest component is 1 or -1.
    #[inline(always)]
    pub(super) fn new(y: &[Vector3; 8], m: &Vector3) -> Self {
        let axes = axes(m);
        Self { axes, x: projected(y, m, axes).map(|x| corners(&x, 0.0)) }
    }

    /// Both coordinates of the corners of a face.
    #[inline(always)]
    fn face(&self, i: usize) -> [[f64; 4]; 2] {
        [0, 1].map(|axis| [0, 1, 2, 3].map(|corner| self.x[axis][corner][i]))
    }
}

/// The axis in which a normal is largest, with 1 or -1, and the other two in cyclic order.
#[inline(always)]
pub(super) fn axes(m: &Vector3) -> [usize; 3] {
    let [x_is_largest, y_is_largest] = [m[0].abs() == 1.0, m[1].abs() == 1.0];
    if x_is_largest { [0, 1, 2] } else { if y_is_largest { [1, 2, 0] } else { [2, 0, 1] } }
}

/// The two coordinates of the nodes in a shadow.
#[inline(always)]
pub(super) fn projected(y: &[Vector3; 8], m: &Vector3, [axis, j, k]: [usize; 3]) -> [[f64; 8]; 2] {
    let down = -m[axis].signum();
    [from_fn(|i| down * y[i].as_slice()[j]), from_fn(|i| y[i].as_slice()[k])]
}

impl Profile {
    /// No faces.
    pub(super) const EMPTY: Self = Self {
        heights: [[0.0; LANES]; 4],
        rises: [[0.0; LANES]; 4],
        density: [[0.0; LANES]; 4],
        twist: [0.0; LANES],
        whole: [[0.0; LANES]; 2],
    };

    /// For nodes `y` with these heights along `m`, whose largest component is 1 or -1.
    #[inline(always)]
    pub(super) fn new(heights: &[f64; 8], y: &[Vector3; 8], m: &Vector3) -> Self {
        Self::over(heights, &Shadow::new(y, m))
    }

    /// For nodes with these heights and this shadow.
    #[inline(always)]
    pub(super) fn over(heights: &[f64; 8], shadow: &Shadow) -> Self {
        // Never below: for the lanes that are nothing.
        let mut profile = Self { heights: corners(heights, f64::MAX), ..Self::EMPTY };
        profile.prepare(|i| shadow.face(i));
        profile
    }

    /// Fills in the rest, for faces whose heights are given, with these shadows.
    #[inline(always)]
    pub(super) fn prepare(&mut self, shadow: impl Fn(usize) -> [[f64; 4]; 2]) {
        for i in 0..LANES {
            let [x, y] = shadow(i);
            self.set_face(i, [0, 1, 2, 3].map(|corner| [x[corner], y[corner]]));
        }
    }

    /// Prepares a face, from the nodes projected along `e`.
    #[inline(always)]
    fn set_face(&mut self, i: usize, nodes: [[f64; 2]; 4]) {
        let between = |from: usize, to: usize| [nodes[to][0] - nodes[from][0], nodes[to][1] - nodes[from][1]];
        let cross = |x: [f64; 2], y: [f64; 2]| x[0] * y[1] - x[1] * y[0];
        let edges = [between(0, 1), between(1, 2), between(2, 3), between(0, 3)];
        let [g1, g2, g3] = [cross(edges[0], edges[3]), cross(edges[0], edges[1]), cross(edges[1], edges[2])];
        let g4 = g1 - g2 + g3;
        let [h1, h2, h3, h4] = [0, 1, 2, 3].map(|corner| self.heights[corner][i]);
        for (rises, difference) in self.rises.iter_mut().zip([h2 - h1, h3 - h2, h4 - h3, h1 - h4]) {
            let difference = difference.abs();
            rises[i] = either(difference > HEIGHT_NEGLIGIBLE, difference, HEIGHT_NEGLIGIBLE);
        }
        let (lower, upper) = (h2 - h1, h3 - h4);
        let middle = 0.5 * (g1 + g3);
        let mean = 0.25 * ((h1 + h2) + (h3 + h4));
        let across = (h4 - h1) + (h3 - h2);
        let slopes = (lower + upper) * (g2 - g1) + across * (g4 - g1);
        for (density, g) in self.density.iter_mut().zip([g1, g2, g3, g4]) {
            density[i] = g;
        }
        self.twist[i] = upper - lower;
        self.whole[0][i] = -(mean * middle + slopes * (1.0 / 24.0));
        self.whole[1][i] = middle;
    }

    /// The part of the cell below one depth, where the faces are those of one cell.
    #[inline(always)]
    pub(super) fn volume(&self, depth: f64) -> Value {
        let [value, derivative, second] = self.below(&[depth; LANES]).map(|lanes| sum(&lanes));
        Value { value, derivative, second }
    }

    /// What each face adds to volume, derivative and second derivative, each below a depth of its own.
    #[inline(always)]
    pub(super) fn below(&self, depths: &Lanes) -> [Lanes; 3] {
        let mut faces = [[0.0; LANES]; 3];
        let mut rare = [0.0; LANES];
        for i in 0..LANES {
            let depth = depths[i];
            let heights = self.heights(i, depth);
            let cut = Cut::new(heights.map(|s| s <= 0.0));
            let part = self.part(i, heights, &cut);
            let z = part.z();
            let below = part.integrate(Argument::near(z));
            let whole = self.whole(i, depth);
            faces[0][i] = either(cut.part, below.value, 0.0) + either(cut.whole, whole.value, 0.0);
            faces[1][i] = either(cut.part, below.derivative, 0.0) + either(cut.whole, whole.derivative, 0.0);
            faces[2][i] = either(cut.part, below.second, 0.0);
            rare[i] = either(cut.part & (cut.saddle | Argument::is_far(z)), 1.0, 0.0);
        }
        if sum(&rare) > 0.0 {
            for i in (0..LANES).filter(|&i| rare[i] > 0.0) {
                let Value { value, derivative, second } = self.rare_face(i, depths[i]);
                (faces[0][i], faces[1][i], faces[2][i]) = (value, derivative, second);
            }
        }
        faces
    }

    /// Area and first moment of the section at depth 0, both projected along `e`, with the coordinates of the shadow.
    #[inline(always)]
    pub(super) fn section(&self, shadow: &Shadow) -> [f64; 3] {
        let mut faces = [[0.0; LANES]; 3];
        let mut rare = [0.0; LANES];
        for i in 0..LANES {
            let heights = self.heights(i, 0.0);
            let cut = Cut::new(heights.map(|s| s <= 0.0));
            let part = self.part(i, heights, &cut);
            let z = part.z();
            let weights = part.weights(Argument::near(z));
            let whole = self.whole_weights(i);
            let x = shadow.face(i);
            let sum = |whole: f64, part: f64| either(cut.part, part, 0.0) + either(cut.whole, whole, 0.0);
            faces[0][i] = sum(whole.area(), weights.area());
            for axis in 0..2 {
                faces[axis + 1][i] = sum(whole.integrate(x[axis]), weights.integrate(cut.turned(x[axis])));
            }
            rare[i] = either(cut.part & (cut.saddle | Argument::is_far(z)), 1.0, 0.0);
        }
        if sum(&rare) > 0.0 {
            for i in (0..LANES).filter(|&i| rare[i] > 0.0) {
                for (lanes, value) in faces.iter_mut().zip(self.rare_section(i, shadow)) {
                    lanes[i] = value;
                }
            }
        }
        [sum(&faces[0]), sum(&faces[1]), sum(&faces[2])]
    }

    #[cold]
    #[inline(never)]
    fn rare_section(&self, i: usize, shadow: &Shadow) -> [f64; 3] {
        let (whole, parts) = self.rare_parts(i, 0.0);
        let x = shadow.face(i);
        let mut sums = [0.0; 3];
        let mut add = |weights: Weights, x: [[f64; 4]; 2]| {
            let integrals = [weights.area(), weights.integrate(x[0]), weights.integrate(x[1])];
            sums.iter_mut().zip(integrals).for_each(|(sum, integral)| *sum += integral);
        };
        if whole {
            add(self.whole_weights(i), x);
        }
        for RarePart { cut, part, argument } in parts.into_iter().flatten() {
            add(part.weights(argument), x.map(|x| cut.turned(x)));
        }
        sums
    }

    #[inline(always)]
    fn whole_weights(&self, i: usize) -> Weights {
        Weights::of_whole_face([self.density[0][i], self.density[1][i], self.density[3][i]])
    }

    #[inline(always)]
    fn heights(&self, i: usize, depth: f64) -> [f64; 4] {
        [0, 1, 2, 3].map(|corner| self.heights[corner][i] - depth)
    }

    /// The part of a face that is below, or is not.
    #[inline(always)]
    fn part(&self, i: usize, heights: [f64; 4], cut: &Cut) -> Part {
        let turned = |lanes: &[Lanes; 4]| cut.turned([lanes[0][i], lanes[1][i], lanes[2][i], lanes[3][i]]);
        let [s1, s2, ..] = cut.turned(heights);
        let [g1, g2, _, g4] = turned(&self.density);
        let [to_next, across, _, to_last] = turned(&self.rises);
        let corner = Corner {
            heights: [s1, s2],
            density: [g1, g2, g4],
            rises: [to_next, across, to_last],
            twist: either(cut.turn[1], -self.twist[i], self.twist[i]),
        };
        Part::new(corner, cut.strip, cut.sign())
    }

    #[inline(always)]
    fn whole(&self, i: usize, depth: f64) -> Value {
        let [value, middle] = [self.whole[0][i], self.whole[1][i]];
        Value { value: value + depth * middle, derivative: middle, second: 0.0 }
    }

    /// What is below of a face with a far argument, or with opposite corners below.
    #[cold]
    #[inline(never)]
    fn rare_face(&self, i: usize, depth: f64) -> Value {
        let (whole, parts) = self.rare_parts(i, depth);
        let mut sum = if whole { self.whole(i, depth) } else { Value::default() };
        for RarePart { part, argument, .. } in parts.into_iter().flatten() {
            sum += part.integrate(argument);
        }
        sum
    }

    /// Whether the whole of such a face counts, and its parts.
    fn rare_parts(&self, i: usize, depth: f64) -> (bool, [Option<RarePart>; 2]) {
        let heights = self.heights(i, depth);
        let below = heights.map(|s| s <= 0.0);
        let mut cut = Cut::new(below);
        let mut turns = [Some(cut.turn), None];
        if cut.saddle {
            // The corners below meet across the saddle, and the other two are missing, or they do not.
            let first = usize::from(!below[0]);
            let joined = heights[first] * heights[first + 2] > heights[first + 1] * heights[(first + 3) & 3];
            let counted_from = first ^ usize::from(joined);
            turns = [false, true].map(|half| Some([half, counted_from == 1]));
            (cut.whole, cut.rest) = (joined, joined);
        }
        let part = |turn| {
            let cut = Cut { turn, ..cut };
            let part = self.part(i, heights, &cut);
            let z = part.z();
            let far = Argument::is_far(z);
            let argument =
                if far { Argument::far(z, self.quotient(i, heights, &cut)) } else { Argument::near(z) };
            RarePart { cut, part, argument }
        };
        (cut.whole, turns.map(|turn| turn.map(part)))
    }

    /// `c'` and `c` of a part, or numbers in the same ratio, where their difference does not tell the smaller one.
    fn quotient(&self, i: usize, heights: [f64; 4], cut: &Cut) -> [f64; 2] {
        if cut.strip {
            let [_, across, _, to_last] = cut.turned([0, 1, 2, 3].map(|corner| self.rises[corner][i]));
            return [across, to_last];
        }
        let [s1, s2, s3, s4] = cut.turned(heights);
        // The product underflows only where the face lies in the plane to beyond rounding, and adds nothing.
        [(s2 * s4 - s1 * s3).max(0.0), ((s2 - s1) * (s4 - s1)).max(f64::MIN_POSITIVE)]
    }
}

/// Numbers of the nodes by corner and face, and what stands where there is no face.
#[inline(always)]
fn corners(nodes: &[f64; 8], none: f64) -> [Lanes; 4] {
    from_fn(|corner| {
        from_fn(|face| if face < 6 { nodes[Hexahedron::FACE_NODES[face][corner]] } else { none })
    })
}

/// The sum over all faces.
#[inline(always)]
pub(super) fn sum(lanes: &Lanes) -> f64 {
    let [a, b, c, d, e, f, g, h] = *lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
