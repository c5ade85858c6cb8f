//! A hexahedron along one normal, prepared for many depths: an evaluation is then a sum of scalars.

use crate::cell::Cell;
use crate::face_part::{FaceMoments, FaceSum, face_part};
use crate::parallelepiped::UnitCube;
use crate::plane_constant::Monotone;
use crate::root::Value;

use super::along::{Along, FACE_MASKS, inside_mask};
use super::{Hexahedron, Vector3};

/// What does not depend on the depth of the plane.
pub(super) struct Profile<'a> {
    along: &'a Along<'a>,
    /// The cell without its twists, along the same normal.
    cube: UnitCube,
    inverse_m2: f64,
    faces: [FaceProfile; 6],
}

/// A face along one normal.
///
/// With the cross vectors `X_i` (Eq. 24) and the lowest node `y0` of the cell, for a part of the face counted from corner `i`,
///
/// ```text
/// (y_i - y0).k = h_i K00 + (h_{i+2} + nu_i - h_{i+3}) K10 + (h_{i+2} + nu_i - h_{i+1}) K01,   h_i = (y_i - y0).X_i
///          m.k = g_i K00 + (g_{i+2} - g_{i+3}) K10 + (g_{i+2} - g_{i+1}) K01,                 g_i = m.X_i
/// ```
///
/// since `y_i` lies in the planes of `X_{i+1}` and `X_{i+3}`, and `nu` alternates in sign around the face. The fourth of each
/// follows from the others: `X_4 = X_1 - X_2 + X_3`, `h_4 = h_1 - h_2 + h_3 + nu_1`.
#[derive(Clone, Copy, Default)]
struct FaceProfile {
    /// `h_i` and `g_i`.
    corners: [[f64; 2]; 4],
    nu: f64,
    /// The sums for the whole face.
    whole: [f64; 2],
}

impl FaceProfile {
    /// For the corners of a face relative to the lowest node of the cell.
    fn new(corner: [&Vector3; 4], m: &Vector3) -> Self {
        let edges = [corner[1] - corner[0], corner[2] - corner[1], corner[3] - corner[2]];
        let cross =
            [edges[0].cross(&(corner[3] - corner[0])), edges[0].cross(&edges[1]), edges[1].cross(&edges[2])];
        let nu = -(edges[0] + edges[2]).dot(&cross[0]);
        let [one, two, three] = std::array::from_fn(|i| [corner[i].dot(&cross[i]), m.dot(&cross[i])]);
        let four = [one[0] - two[0] + three[0] + nu, one[1] - two[1] + three[1]];
        // K00 = 1, K10 = K01 = 1/2, K11 = 1/4.
        let whole = [
            one[0] + three[0] + nu - 0.5 * (two[0] + four[0]) - 0.25 * nu,
            one[1] + three[1] - 0.5 * (two[1] + four[1]),
        ];
        Self { corners: [one, two, three, four], nu, whole }
    }
}

impl<'a> Profile<'a> {
    pub(super) fn new(along: &'a Along<'a>) -> Self {
        let cell = along.cell;
        let nodes = cell.local.map(|y| y - cell.local[along.lowest]);
        let mut faces = [FaceProfile::default(); 6];
        for (profile, face) in faces.iter_mut().zip(Hexahedron::FACE_NODES) {
            *profile = FaceProfile::new(std::array::from_fn(|i| &nodes[face[i]]), &along.direction.m);
        }
        let cube = UnitCube::new(along.direction.m.as_slice());
        Self { cube, inverse_m2: along.direction.m.norm_squared().recip(), faces, along }
    }
}

/// The sums over faces for one depth.
struct Sum<'a> {
    face: &'a FaceProfile,
    /// Of `(y - y0).k - nu K11` and of `m.k`.
    total: [f64; 2],
}

impl FaceSum for Sum<'_> {
    #[inline]
    fn whole(&mut self) {
        self.total[0] += self.face.whole[0];
        self.total[1] += self.face.whole[1];
    }

    #[inline]
    fn part(&mut self, i: usize, sign: f64, moments: &FaceMoments) {
        let FaceProfile { corners, nu, .. } = self.face;
        let nu = if i & 1 == 0 { *nu } else { -nu };
        let [near, next, far, last] = [0, 1, 2, 3].map(|step| corners[(i + step) & 3]);
        let far = [far[0] + nu, far[1]];
        let sum: [f64; 2] = std::array::from_fn(|k| {
            near[k] * moments.k00 + (far[k] - last[k]) * moments.k10 + (far[k] - next[k]) * moments.k01
        });
        self.total[0] += sign * (sum[0] - nu * moments.k11);
        self.total[1] += sign * sum[1];
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
        let s = self.along.heights.map(|h| h - depth);
        let mask = inside_mask(&s);
        let mut sum = Sum { face: &self.faces[0], total: [0.0; 2] };
        for (i, face) in self.faces.iter().enumerate() {
            sum.face = face;
            let nodes = Hexahedron::FACE_NODES[i];
            face_part(FACE_MASKS[i][mask], std::array::from_fn(|i| s[nodes[i]]), &mut sum);
        }
        let [triple, section] = sum.total;
        let derivative = -section * self.inverse_m2;
        Value { value: (triple + depth * derivative) / 3.0, derivative }
    }

    /// From the affine part: for small parts with the lowest corners in one place and the heights stretched, for others with the
    /// middles in one place; over the first sixteenth of the cell the one gives way to the other.
    fn start(&self, fraction: f64) -> f64 {
        let depth = self.cube.position(fraction).0;
        let stretched = depth * (self.span() / self.cube.span());
        let middle = self.along.heights.iter().sum::<f64>() / 8.0;
        let centred = depth + (middle - 0.5 * self.cube.span());
        let weight = (16.0 * fraction).min(1.0);
        (stretched + weight * (centred - stretched)).clamp(0.0, self.span())
    }

    fn closed_form(&self, _fraction: f64) -> Option<(f64, usize)> {
        None
    }
}
