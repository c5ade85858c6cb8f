//! Whether the Jacobian determinant of a trilinear map is negative somewhere: Bernstein bounds with subdivision
//! (Johnen, Weill & Remacle 2017).
//!
//! The determinant is quadratic in each of the three coordinates. Its 27 coefficients in the Bernstein basis bound it
//! from both sides, the eight at the corners are values, and halving a box brings bounds and values together with the
//! square of its size. The signs of the corner values alone say nothing about the inside.

use std::collections::VecDeque;

use crate::tolerance::{JACOBIAN_BOXES, JACOBIAN_NEGATIVE};
use crate::{Cell, Hexahedron, Vector};

/// The smallest determinant that was found, and where.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Smallest {
    /// Relative to the largest Bernstein coefficient of the cell.
    pub(crate) determinant: f64,
    /// Local coordinates in `[0, 1]`.
    pub(crate) at: [f64; 3],
}

/// The determinant over a part of the cell: `coefficients[i + 3 j + 9 k]` belongs to `B_i(xi) B_j(eta) B_k(zeta)`.
#[derive(Clone, Copy)]
struct Part {
    coefficients: [f64; 27],
    low: [f64; 3],
    size: [f64; 3],
}

const STRIDES: [usize; 3] = [1, 3, 9];

/// The first coefficients of the nine lines of three along an axis.
fn lines(axis: usize) -> impl Iterator<Item = usize> {
    let stride = STRIDES[axis];
    (0..27).filter(move |i| (i / stride).is_multiple_of(3))
}

impl Part {
    /// The whole cell, from the values at `{0, 1/2, 1}^3`: `b0 = f0`, `b1 = 2 f(1/2) - (f0 + f1) / 2`, `b2 = f1`
    /// along each axis.
    fn whole(values: [f64; 27]) -> Self {
        let mut coefficients = values;
        for (axis, stride) in STRIDES.into_iter().enumerate() {
            for i in lines(axis) {
                let ends = coefficients[i] + coefficients[i + 2 * stride];
                coefficients[i + stride] = 2.0 * coefficients[i + stride] - 0.5 * ends;
            }
        }
        Self { coefficients, low: [0.0; 3], size: [1.0; 3] }
    }

    /// The smallest of the eight corner values, and where it is.
    fn smallest_corner(&self) -> (f64, [f64; 3]) {
        let corners = Hexahedron::OFFSETS.iter().map(|offset| {
            let value = self.coefficients[2 * (offset[0] + 3 * offset[1] + 9 * offset[2])];
            (value, std::array::from_fn(|axis| self.low[axis] + self.size[axis] * offset[axis] as f64))
        });
        corners.min_by(|a, b| a.0.total_cmp(&b.0)).expect("a box has corners")
    }

    /// The axis along which the coefficients are furthest from the function: the largest second difference.
    fn most_curved_axis(&self) -> usize {
        let curvature = |axis: usize| {
            let (b, stride) = (&self.coefficients, STRIDES[axis]);
            lines(axis).map(|i| (b[i] - 2.0 * b[i + stride] + b[i + 2 * stride]).abs()).fold(0.0, f64::max)
        };
        let [x, y, z] = [0, 1, 2].map(curvature);
        if x >= y && x >= z { 0 } else { if y >= z { 1 } else { 2 } }
    }

    /// The two halves along an axis, by de Casteljau's rule.
    fn halves(&self, axis: usize) -> [Self; 2] {
        let stride = STRIDES[axis];
        let [mut lower, mut upper] = [*self, *self];
        for half in [&mut lower, &mut upper] {
            half.size[axis] *= 0.5;
        }
        upper.low[axis] += upper.size[axis];
        for i in lines(axis) {
            let [b0, b1, b2] = [0, 1, 2].map(|step| self.coefficients[i + step * stride]);
            let (left, right) = (0.5 * (b0 + b1), 0.5 * (b1 + b2));
            let middle = 0.5 * (left + right);
            lower.coefficients[i + stride] = left;
            lower.coefficients[i + 2 * stride] = middle;
            upper.coefficients[i] = middle;
            upper.coefficients[i + stride] = right;
        }
        [lower, upper]
    }
}

/// Whether every edge is within 1 (sum of magnitudes) of the unit vector of its axis. The columns of the Jacobian
/// are means of such edges, so it is diagonally dominant everywhere and its determinant positive.
fn is_nearly_unit_cube(nodes: &[Vector<3>; 8]) -> bool {
    let near = |a: usize, b: usize, axis: usize| {
        let mut edge = nodes[b] - nodes[a];
        edge[axis] -= 1.0;
        edge.lp_norm(1) < 1.0
    };
    Hexahedron::EDGES.iter().enumerate().all(|(edge, [a, b])| near(*a, *b, edge / 4))
}

/// A place where the determinant of the map with these nodes, times `sign`, is below [`JACOBIAN_NEGATIVE`].
///
/// The nodes must be of order one. Where the search ends without an answer, after [`JACOBIAN_BOXES`] boxes, no
/// negative value was found at any of their corners, and the cell passes.
pub(crate) fn negative(nodes: &[Vector<3>; 8], sign: f64) -> Option<Smallest> {
    if sign > 0.0 && is_nearly_unit_cube(nodes) {
        return None;
    }
    let place = |i: usize| [i % 3, i / 3 % 3, i / 9].map(|step| 0.5 * step as f64);
    let values: [f64; 27] = std::array::from_fn(|i| sign * determinant(nodes, place(i)));
    let whole = Part::whole(values);
    let largest = whole.coefficients.iter().fold(0.0, |largest: f64, b| largest.max(b.abs()));
    let bound = JACOBIAN_NEGATIVE * largest;
    let found = |value: f64, at| (value < bound).then(|| Smallest { determinant: value / largest, at });
    let sampled = (0..27).min_by(|&a, &b| values[a].total_cmp(&values[b])).expect("there are 27");
    if let Some(found) = found(values[sampled], place(sampled)) {
        return Some(found);
    }
    let mut open = VecDeque::from([whole]);
    let mut boxes = 1;
    while let Some(part) = open.pop_front() {
        if part.coefficients.iter().all(|&b| b >= bound) {
            continue;
        }
        let (value, at) = part.smallest_corner();
        if let Some(found) = found(value, at) {
            return Some(found);
        }
        boxes += 2;
        if boxes > JACOBIAN_BOXES {
            return None;
        }
        open.extend(part.halves(part.most_curved_axis()));
    }
    None
}

/// The Jacobian determinant of the trilinear map with these nodes.
pub(crate) fn determinant(x: &[Vector<3>; 8], [u, v, w]: [f64; 3]) -> f64 {
    let mean = |axis: usize, s: f64, t: f64| {
        let edge = |i: usize| {
            let [a, b] = Hexahedron::EDGES[4 * axis + i];
            x[b] - x[a]
        };
        let mix = |a: Vector<3>, b: Vector<3>, t: f64| a + (b - a) * t;
        mix(mix(edge(0), edge(1), s), mix(edge(2), edge(3), s), t)
    };
    mean(0, v, w).dot(&mean(1, u, w).cross(&mean(2, u, v)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(nodes: &[Vector<3>; 8]) -> Vec<f64> {
        Hexahedron::OFFSETS.iter().map(|o| determinant(nodes, o.map(|c| c as f64))).collect()
    }

    #[test]
    fn coefficients_reproduce_the_determinant_in_every_part() {
        let nodes = std::array::from_fn(|i| {
            let x = Vector::<3>::from_fn(|axis, _| Hexahedron::OFFSETS[i][axis] as f64);
            x + 0.4 * Vector::<3>::from_fn(|axis, _| ((7 * i + 3 * axis + 1) as f64).sin())
        });
        let values =
            std::array::from_fn(|i| determinant(&nodes, [i % 3, i / 3 % 3, i / 9].map(|s| 0.5 * s as f64)));
        let mut parts = vec![Part::whole(values)];
        for axis in [0, 1, 2, 1] {
            parts = parts.iter().flat_map(|part| part.halves(axis)).collect();
        }
        for part in parts {
            for (i, offset) in Hexahedron::OFFSETS.iter().enumerate() {
                let at = std::array::from_fn(|axis| part.low[axis] + part.size[axis] * offset[axis] as f64);
                let value = part.coefficients[2 * (offset[0] + 3 * offset[1] + 9 * offset[2])];
                assert!((value - determinant(&nodes, at)).abs() <= 1e-14, "corner {i} of {:?}", part.low);
            }
        }
    }

    #[test]
    fn positive_corners_do_not_make_a_valid_cell() {
        let nodes = crate::defects::tests::positive_corners_negative_inside();
        assert!(corners(&nodes).iter().all(|&d| d > 0.1), "{:?}", corners(&nodes));
        let found = negative(&nodes, 1.0).expect("negative inside");
        assert!(determinant(&nodes, found.at) < -0.05);
    }
}
