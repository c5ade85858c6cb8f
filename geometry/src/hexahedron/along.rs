//! A hexahedron along one normal: its truncated volume as a function of the depth of the plane.
//!
//! [`Along`] does what one plane needs; [`Profile`] prepares for many planes with the same normal.

use crate::cell::Cell;
use crate::face_part::face_part;
use crate::half_space::{compensated_dot, compensated_height, largest_and_direction};
use crate::moment::{self, PartMoment};
use crate::parallelepiped::UnitCube;
use crate::plane_constant::Monotone;
use crate::root::Value;
use crate::ruled_face::SurfaceElement;

use super::{Hexahedron, Vector3};

/// A hexahedron along one normal, in its frame: heights of the nodes over the lowest of them, in units of `size`.
pub(super) struct Along<'a> {
    cell: &'a Hexahedron,
    /// Largest component of `J^T n`, the unit of all heights and depths here.
    pub(super) size: f64,
    /// `m = J^T n / size`.
    m: Vector3,
    /// `n.x` of the first node.
    base: [f64; 2],
    /// `n.x` of the frame's origin over the first node.
    offset: f64,
    lowest: usize,
    /// `m.y` of the lowest node.
    low: f64,
    heights: [f64; 8],
}

impl<'a> Along<'a> {
    #[inline]
    pub(super) fn new(cell: &'a Hexahedron, normal: &Vector3) -> Self {
        let (size, m) = largest_and_direction(&cell.jacobian.tr_mul(normal));
        let mut heights = cell.local.map(|y| m.dot(&y));
        let lowest = (1..8).fold(0, |best, i| if heights[i] < heights[best] { i } else { best });
        let low = heights[lowest];
        heights.iter_mut().for_each(|h| *h -= low);
        let base = compensated_dot(normal, &cell.nodes[0]);
        Self { cell, size, m, base, offset: normal.dot(&cell.origin), lowest, low, heights }
    }

    /// The depth of a plane over the lowest node.
    pub(super) fn depth(&self, constant: f64) -> f64 {
        -compensated_height(self.base, self.offset, constant) / self.size - self.low
    }

    /// The plane constant of a depth, for the normal along which this is times `sign`.
    pub(super) fn constant(&self, depth: f64, sign: f64) -> f64 {
        sign * (self.base[0] + (self.base[1] + (self.offset + (self.low + depth) * self.size)))
    }

    /// Volume and section below one depth.
    pub(super) fn volume(&self, depth: f64) -> Value {
        if self.cell.affine {
            return UnitCube::new(self.m.as_slice()).volume(depth);
        }
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
        moment::of_hexahedron(&self.cell.local, &self.m, &self.heights.map(|h| h - depth))
    }

    /// Volume and section where the heights `s` over a plane with normal `sign m` are not positive.
    fn lower_part(&self, s: &[f64; 8], sign: f64) -> Value {
        let y = &self.cell.local;
        let m2 = self.m.norm_squared();
        // A point of the plane next to the part that is wanted keeps small parts accurate.
        let lowest = (1..8).fold(0, |best, i| if s[i] < s[best] { i } else { best });
        let p = y[lowest] - self.m * (sign * s[lowest] / m2);
        let mut triple = 0.0;
        let mut k = Vector3::zeros();
        for face in Hexahedron::FACE_NODES {
            let heights = std::array::from_fn(|i| s[face[i]]);
            face_part(heights, |first, sign, moments| {
                let corner = |i: usize| &y[face[(first + i) & 3]];
                let SurfaceElement { q0, q_alpha, q_beta, nu } =
                    SurfaceElement::new([corner(0), corner(1), corner(2), corner(3)]);
                let part = q0 * moments.k00 + q_alpha * moments.k10 + q_beta * moments.k01;
                k += part * sign;
                triple += sign * ((corner(0) - p).dot(&part) - nu * moments.k11);
            });
        }
        Value { value: triple / 3.0, derivative: -sign * self.m.dot(&k) / m2 }
    }
}

/// A hexahedron along one normal, prepared for many depths.
pub(super) struct Profile<'a> {
    along: &'a Along<'a>,
    /// The cell without its twists, along the same normal.
    cube: UnitCube,
    inverse_m2: f64,
    /// For cells that are not affine.
    faces: [FaceProfile; 6],
}

/// A face along one normal: what does not depend on the depth of the plane.
///
/// With the cross vectors `X_i` (Eq. 24) and the lowest node `y0` of the cell, for a part of the face counted from corner `i`,
///
/// ```text
/// (y_i - y0).k = h_i K00 + (h_{i+2} + nu_i - h_{i+3}) K10 + (h_{i+2} + nu_i - h_{i+1}) K01,   h_i = (y_i - y0).X_i
///          m.k = g_i K00 + (g_{i+2} - g_{i+3}) K10 + (g_{i+2} - g_{i+1}) K01,                 g_i = m.X_i
/// ```
///
/// since `y_i` lies in the planes of `X_{i+1}` and `X_{i+3}`, and `nu` alternates in sign around the face.
#[derive(Clone, Copy, Default)]
struct FaceProfile {
    h: [f64; 4],
    g: [f64; 4],
    nu: f64,
}

impl FaceProfile {
    fn new(face: [&Vector3; 4], lowest: &Vector3, m: &Vector3) -> Self {
        let edge = [face[1] - face[0], face[2] - face[1], face[3] - face[2], face[0] - face[3]];
        let mut profile = Self::default();
        for i in 0..4 {
            let x = edge[(i + 3) & 3].cross(&edge[i]);
            profile.h[i] = (face[i] - lowest).dot(&x);
            profile.g[i] = m.dot(&x);
            if i == 0 {
                profile.nu = -(edge[0] + edge[2]).dot(&x);
            }
        }
        profile
    }
}

impl<'a> Profile<'a> {
    pub(super) fn new(along: &'a Along<'a>) -> Self {
        let y = &along.cell.local;
        let mut faces = [FaceProfile::default(); 6];
        if !along.cell.affine {
            for (profile, face) in faces.iter_mut().zip(Hexahedron::FACE_NODES) {
                *profile = FaceProfile::new(std::array::from_fn(|i| &y[face[i]]), &y[along.lowest], &along.m);
            }
        }
        let cube = UnitCube::new(along.m.as_slice());
        Self { cube, inverse_m2: along.m.norm_squared().recip(), faces, along }
    }
}

impl Monotone for Profile<'_> {
    fn span(&self) -> f64 {
        self.along.heights.iter().copied().fold(0.0, f64::max)
    }

    fn total(&self) -> f64 {
        self.along.cell.local_volume
    }

    fn volume(&self, depth: f64) -> Value {
        if self.along.cell.affine {
            return self.cube.volume(depth);
        }
        let s = self.along.heights.map(|h| h - depth);
        let (mut triple, mut section) = (0.0, 0.0);
        for (face, profile) in Hexahedron::FACE_NODES.iter().zip(&self.faces) {
            let heights = std::array::from_fn(|i| s[face[i]]);
            face_part(heights, |i, sign, moments| {
                let FaceProfile { h, g, nu } = profile;
                let (next, far, last) = ((i + 1) & 3, (i + 2) & 3, (i + 3) & 3);
                let nu = if i & 1 == 0 { *nu } else { -nu };
                let beyond = h[far] + nu;
                triple += sign
                    * (h[i] * moments.k00
                        + (beyond - h[last]) * moments.k10
                        + (beyond - h[next]) * moments.k01
                        - nu * moments.k11);
                section += sign
                    * (g[i] * moments.k00
                        + (g[far] - g[last]) * moments.k10
                        + (g[far] - g[next]) * moments.k01);
            });
        }
        let derivative = -section * self.inverse_m2;
        Value { value: (triple + depth * derivative) / 3.0, derivative }
    }

    fn start(&self, fraction: f64) -> f64 {
        self.cube.position(fraction).0 * (self.span() / self.cube.span())
    }

    fn closed_form(&self, fraction: f64) -> Option<(f64, usize)> {
        self.along.cell.affine.then(|| self.cube.position(fraction))
    }
}
