//! Kothe's closed form for truncated volumes as the paper has it (Eq. 96-98; Kothe et al. 1999), with its numerical
//! fall-back. Kept for comparison: [`crate::Cell::truncate`] has no failing case.
//!
//! For each face, with outward nodes `x_i`, predecessor `x_i'''`, successor `x_i'`, unit normal `n` and
//! `mu_i = n.x_i`,
//!
//! ```text
//! V^s = 1/6 sum eps_i Y_i (d-d_i)^2 / lambda_i + nu_tet/2 sum eps_i J(w_i) (d-d_i)^4 / lambda_i^2        (96)
//! d_i = min(d, mu_i),   eps = (+1, -1, +1, -1),   Y_i = (x_i''' - d n).((x_i - d n) x (x_i' - d n))      (97)
//! lambda_i = eps_i (mu_i - mu_i')(mu_i - mu_i'''),   w_i = n.B (d-d_i) / lambda_i,   B = x1 - x2 + x3 - x4
//! J(w) = 2 sum (-w)^n / ((n+2)(n+3)(n+4))                                                                 (98)
//! nu_tet = B.((x2-x1) x (x4-x1))                                                                          (95)
//! ```
//!
//! and `V_tr` is the sum of the `V^s`: the third of Eq. 91 is contained in Eq. 96. Each corner below the plane
//! stands for a region that goes on beyond the face, and the regions cancel there.
//!
//! **Limits.** With `lambda_i = 0` (an edge parallel to the plane) or `|w_i| >= 1` Eq. 96 is not defined, and the
//! face falls back to triangles and quadrilaterals between its corners and the points where the plane crosses its
//! edges. That is exact for planar faces and for faces wholly below the plane (Eq. 22), else an error of the order
//! of the twist. So `V(d)` jumps where a face changes from one to the other, and has no useful derivative. On unit
//! cubes whose nodes are moved by up to 0.15 it happens in more than half of the cells, which are then wrong by
//! 2e-3 of their volume (rms; largest 3e-2); the others are right to 1e-14 for `|w| <= 0.9`.
//!
//! Next to `lambda_i = 0` the regions grow like `1 / lambda_i` before they cancel, see [`KOTHE_PARALLEL`]; next to
//! `|w_i| = 1` the series needs very many terms, see [`KOTHE_TERMS`]. Small parts have no relative accuracy.

use crate::cell::Cell;
use crate::ruled_face::flux;
use crate::section::{Piece, pieces};
use crate::tolerance::{KOTHE_PARALLEL, KOTHE_TERMS};
use crate::{HalfSpace, Hexahedron, Vector};

type Vector3 = Vector<3>;

/// What Kothe's formula gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KotheTruncation {
    /// Volume of the part of the cell inside the half-space.
    pub volume: f64,
    /// Faces on which Eq. 96 failed and the fall-back was used.
    pub fallback_faces: usize,
    /// The largest `|w_i|` of the other faces.
    pub largest_w: f64,
}

/// The volume of the part of the cell inside the half-space by Eq. 96, with the fall-back where that fails.
pub fn truncate(cell: &Hexahedron, half_space: &HalfSpace<3>) -> KotheTruncation {
    let (local, direction) = (cell.local(), cell.direction(&half_space.normal));
    // A normal of zero leaves everything or nothing.
    let length = direction.m.norm().max(f64::MIN_POSITIVE);
    let (normal, d) = (direction.m / length, direction.level(half_space.constant) / length);
    let heights = local.map(|x| normal.dot(&x));
    let mut sum = KotheTruncation { volume: 0.0, fallback_faces: 0, largest_w: 0.0 };
    let above = heights.iter().filter(|&&mu| mu > d).count();
    if above == 8 {
        return sum;
    }
    let [low, high] = [f64::min, f64::max].map(|end| heights.iter().copied().fold(heights[0], end));
    // Relative to a point of the plane. One that misses the cell may be far away, and any point will do.
    let point = if above > 0 { normal * d } else { Vector3::zeros() };
    for nodes in Hexahedron::FACE_NODES {
        let x: [Vector3; 4] = std::array::from_fn(|i| local[nodes[i]] - point);
        if above == 0 {
            sum.volume += cone([0, 1, 2, 3].map(|i| &x[i]));
            continue;
        }
        let face = Face { x, mu: [0, 1, 2, 3].map(|i| heights[nodes[i]]), d, span: high - low };
        match face.closed_form() {
            Some((volume, w)) => {
                sum.volume += volume;
                sum.largest_w = sum.largest_w.max(w);
            }
            None => {
                sum.volume += face.fall_back();
                sum.fallback_faces += 1;
            }
        }
    }
    KotheTruncation { volume: cell.frame_determinant() * sum.volume, ..sum }
}

/// A third of `int x.dGamma` over a ruled face, the volume between face and origin (Eq. 22).
fn cone(x: [&Vector3; 4]) -> f64 {
    flux(x, x) / 3.0
}

struct Face {
    /// The nodes relative to `d n`.
    x: [Vector3; 4],
    mu: [f64; 4],
    d: f64,
    /// Height of the highest node of the cell over the lowest.
    span: f64,
}

impl Face {
    /// The right side of Eq. 96 and the largest `|w_i|`, if it is defined.
    fn closed_form(&self) -> Option<(f64, f64)> {
        let Self { x, mu, d, span } = self;
        let nu = mu[0] - mu[1] + mu[2] - mu[3];
        let twist = (x[0] - x[1]) + (x[2] - x[3]);
        let nu_tet = twist.dot(&(x[1] - x[0]).cross(&(x[3] - x[0])));
        let (mut first, mut second, mut largest) = (0.0, 0.0, 0.0_f64);
        for i in 0..4 {
            let depth = d - mu[i].min(*d);
            if depth == 0.0 {
                continue;
            }
            let (next, last) = ((i + 1) & 3, (i + 3) & 3);
            let epsilon = if i % 2 == 0 { 1.0 } else { -1.0 };
            let (to_next, to_last) = (mu[i] - mu[next], mu[i] - mu[last]);
            let lambda = epsilon * to_next * to_last;
            let w = nu * depth / lambda;
            if lambda.abs() <= KOTHE_PARALLEL * span * span || w.abs() >= 1.0 {
                return None;
            }
            largest = largest.max(w.abs());
            let y = x[last].dot(&x[i].cross(&x[next]));
            let ratio = depth * depth / lambda;
            first += epsilon * y * ratio;
            second += epsilon * series(w) * ratio * ratio;
        }
        Some((first / 6.0 + 0.5 * nu_tet * second, largest))
    }

    /// The part below the plane as triangles and quadrilaterals between the corners and the points where the plane
    /// crosses the edges (Eq. 22, 27). With more than four points it is the whole face less the triangles above the
    /// plane.
    fn fall_back(&self) -> f64 {
        let s = self.mu.map(|mu| mu - self.d);
        let node = |i: usize| &self.x[i & 3];
        let crossing = |i: usize, j: usize| {
            let (i, j) = (i & 3, j & 3);
            self.x[i] + (self.x[j] - self.x[i]) * (s[i] / (s[i] - s[j]))
        };
        let whole = || cone([0, 1, 2, 3].map(node));
        let pieces = pieces(&s);
        if pieces[0].is_none() {
            return if s[0] <= 0.0 { whole() } else { 0.0 };
        }
        let part = |(piece, below)| match piece {
            Piece::Corner(i) => {
                let triangle = cone([node(i), &crossing(i, i + 1), &crossing(i, i + 3), node(i)]);
                if below { triangle } else { -triangle }
            }
            Piece::Strip(i) => cone([node(i), node(i + 1), &crossing(i + 1, i + 2), &crossing(i, i + 3)]),
        };
        let less = pieces.iter().flatten().any(|(_, below)| !below);
        pieces.into_iter().flatten().map(part).sum::<f64>() + if less { whole() } else { 0.0 }
    }
}

/// Eq. 98, until a term no longer changes the sum.
fn series(w: f64) -> f64 {
    let (mut sum, mut power) = (0.0, 2.0);
    for n in 0..KOTHE_TERMS {
        let n = n as f64;
        let term = power / ((n + 2.0) * (n + 3.0) * (n + 4.0));
        sum += term;
        if term.abs() <= 0.5 * f64::EPSILON * sum {
            break;
        }
        power *= -w;
    }
    sum
}
