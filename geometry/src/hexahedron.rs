//! The hexahedron with eight nodes and six ruled faces, and its exact truncation by a plane.
//!
//! Everything happens in the cell's own affine frame: with the mean edge vectors as columns of `J` and the
//! origin at the corner of their parallelepiped, `y = J^-1 (x - origin)` is a unit cube plus dimensionless twists. The plane
//! `n.x = d` becomes `m.y = d - n.origin` with `m = J^T n`, and volumes scale with `det J`. Slivers, needles
//! and tiny or huge cells are then as accurate as the unit cube.
//!
//! **Truncated volume.** For any point `p` on the plane the divergence theorem gives (Kothe et al. 1999;
//! Eq. 91, 94 of the paper)
//!
//! ```text
//! 3 V = sum over faces [ (y1 - p).k - nu K11 ],   k = q0 K00 + q_alpha K10 + q_beta K01,   A = - m . sum k / (m . m)
//! ```
//!
//! with the moments `K_nm` of `alpha^n beta^m` over the part of the face's unit square where the bilinear height is not
//! positive. That part is a corner under a hyperbola, a strip under one, or the complement of corners. The private
//! `along` does that for one normal.

mod along;

use nalgebra::Matrix3;

use crate::cell::{Cell, Truncation};
use crate::frame::Frame;
use crate::plane_constant::{self, PlaneConstant, PositionError, PositionMethod};
use crate::root::Value;
use crate::ruled_face::area_vector;
use crate::tolerance::{TWIST_AFFINE, TWIST_NEGLIGIBLE};
use crate::{Defect, HalfSpace, Vector, defects, jacobian, section};

use along::{Along, Profile};

type Vector3 = Vector<3>;

/// A hexahedron whose six faces are ruled surfaces, prepared for truncation. Nodes in the order of `VTK_HEXAHEDRON`.
#[derive(Clone, Copy, Debug)]
pub struct Hexahedron {
    nodes: [Vector3; 8],
    /// The frame's origin, relative to the first node.
    origin: Vector3,
    jacobian: Matrix3<f64>,
    determinant: f64,
    /// The nodes in the frame.
    local: [Vector3; 8],
    /// The twists in the frame.
    twists: [Vector3; 4],
    local_volume: f64,
    affine: bool,
}

/// The three second-order twists (xi eta, xi zeta, eta zeta) of a trilinear map.
fn twists(x: &[Vector3; 8]) -> [Vector3; 4] {
    let along_xi = [x[1] - x[0], x[2] - x[3], x[5] - x[4], x[6] - x[7]];
    let xi_eta = 0.5 * ((along_xi[1] - along_xi[0]) + (along_xi[3] - along_xi[2]));
    let xi_zeta = 0.5 * ((along_xi[2] - along_xi[0]) + (along_xi[3] - along_xi[1]));
    let eta_zeta = 0.5 * (((x[7] - x[4]) - (x[3] - x[0])) + ((x[6] - x[5]) - (x[2] - x[1])));
    let cubic = (along_xi[3] - along_xi[2]) - (along_xi[1] - along_xi[0]);
    [xi_eta, xi_zeta, eta_zeta, cubic]
}

fn mean_edges(x: &[Vector3; 8]) -> [Vector3; 3] {
    let edge = |i: usize| x[Hexahedron::EDGES[i][1]] - x[Hexahedron::EDGES[i][0]];
    [0, 4, 8].map(|i| 0.25 * (edge(i) + edge(i + 1) + edge(i + 2) + edge(i + 3)))
}

impl Hexahedron {
    /// The edges as pairs of nodes, four along each axis, in the direction of the axis; the lower one of the two other
    /// coordinates changes first.
    pub const EDGES: [[usize; 2]; 12] =
        [[0, 1], [3, 2], [4, 5], [7, 6], [0, 3], [1, 2], [4, 7], [5, 6], [0, 4], [1, 5], [3, 7], [2, 6]];

    /// The hexahedron with these nodes, in the order of `VTK_HEXAHEDRON`.
    pub fn new(nodes: [Vector3; 8]) -> Self {
        let edges = mean_edges(&nodes);
        let raw = twists(&nodes);
        let normals = [edges[1].cross(&edges[2]), edges[2].cross(&edges[0]), edges[0].cross(&edges[1])];
        let determinant = edges[0].dot(&normals[0]);
        let scale = determinant.recip();
        // J^-1 a; not finite where the determinant vanishes.
        let twists = raw.map(|a| Vector3::from_fn(|row, _| normals[row].dot(&a) * scale));
        // Comparisons with NaN are false: what is not finite has no affine frame.
        let within = |limit: f64| twists.iter().all(|b| b.iter().all(|c| c.abs() <= limit));
        let centre = 0.125 * nodes.iter().map(|x| x - nodes[0]).sum::<Vector3>();
        if !within(TWIST_AFFINE) {
            return Self::scaled(nodes, centre);
        }
        let affine = within(TWIST_NEGLIGIBLE);
        let mut local = CUBE;
        let mut local_volume = 1.0;
        if !affine {
            for y in &mut local {
                let c = y.add_scalar(-0.5);
                *y += twists[0] * (c[0] * c[1])
                    + twists[1] * (c[0] * c[2])
                    + (twists[2] + twists[3] * c[0]) * (c[1] * c[2]);
            }
            local_volume = volume(&AXES, &twists);
        }
        let jacobian = Matrix3::from_columns(&edges);
        let origin = centre - (edges[0] + edges[1] + edges[2]) * 0.5;
        Self { nodes, origin, jacobian, determinant, local, twists, local_volume, affine }
    }

    /// The cell in its own frame.
    pub(crate) fn frame(&self) -> Frame<'_> {
        let Self { nodes, origin, jacobian, determinant, local, .. } = self;
        Frame { first: &nodes[0], origin, jacobian, determinant: *determinant, nodes: local }
    }

    /// The frame for cells whose mean edges nearly vanish or fall together: a shift and a length scale.
    fn scaled(nodes: [Vector3; 8], centre: Vector3) -> Self {
        let relative = nodes.map(|x| (x - nodes[0]) - centre);
        let extent = relative.iter().map(|x| x.amax()).fold(0.0, f64::max);
        let scale = if extent > 0.0 { extent } else { 1.0 };
        let local = relative.map(|x| x / scale);
        let (edges, twists) = (mean_edges(&local), twists(&local));
        Self {
            nodes,
            origin: centre,
            jacobian: Matrix3::identity() * scale,
            determinant: scale * scale * scale,
            local,
            twists,
            local_volume: volume(&edges, &twists),
            affine: false,
        }
    }
}

/// The corners of the unit cube, in node order.
const CUBE: [Vector3; 8] = {
    let mut corners = [Vector3::new(0.0, 0.0, 0.0); 8];
    let mut i = 0;
    while i < 8 {
        let at = <Hexahedron as Cell<3>>::OFFSETS[i];
        corners[i] = Vector3::new(at[0] as f64, at[1] as f64, at[2] as f64);
        i += 1;
    }
    corners
};

/// The mean edges of the unit cube.
const AXES: [Vector3; 3] =
    [Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, 1.0, 0.0), Vector3::new(0.0, 0.0, 1.0)];

/// The volume of a trilinear cell with mean edges `j` and second-order twists `b` along (xi eta, xi zeta, eta zeta): the
/// Jacobian determinant about the centre, in which all odd powers integrate to zero,
/// `V = j1.(j2 x j3) + [ j1.(b12 x b13) + j2.(b23 x b12) + j3.(b13 x b23) ] / 12`.
fn volume([j1, j2, j3]: &[Vector3; 3], [b12, b13, b23, _]: &[Vector3; 4]) -> f64 {
    j1.dot(&j2.cross(j3))
        + (j1.dot(&b12.cross(b13)) + j2.dot(&b23.cross(b12)) + j3.dot(&b13.cross(b23))) / 12.0
}

impl Cell<3> for Hexahedron {
    const NODES: usize = 8;
    const FACES: usize = 6;
    const VTK_CELL_TYPE: u8 = 12;
    const OFFSETS: &'static [[usize; 3]] =
        &[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    const FACE_NODES: &'static [&'static [usize]] =
        &[&[0, 4, 7, 3], &[1, 2, 6, 5], &[0, 1, 5, 4], &[2, 3, 7, 6], &[0, 3, 2, 1], &[4, 5, 6, 7]];

    fn from_corners(node: impl Fn([usize; 3]) -> Vector3) -> Self {
        Self::new(std::array::from_fn(|i| node(Self::OFFSETS[i])))
    }

    fn swept(back: &[Vector3], face: &[Vector3]) -> Self {
        assert!(back.len() == 4 && face.len() == 4, "a face of a hexahedron has four nodes");
        Self::new(std::array::from_fn(|i| if i < 4 { back[i] } else { face[i - 4] }))
    }

    fn nodes(&self) -> &[Vector3] {
        &self.nodes
    }

    fn volume(&self) -> f64 {
        self.determinant * self.local_volume
    }

    fn is_affine(&self) -> bool {
        self.affine
    }

    fn map(&self, local: &Vector3) -> Vector3 {
        let x = &self.nodes;
        let mix = |a: &Vector3, b: &Vector3, t: f64| a + (b - a) * t;
        let bottom = mix(&mix(&x[0], &x[1], local[0]), &mix(&x[3], &x[2], local[0]), local[1]);
        let top = mix(&mix(&x[4], &x[5], local[0]), &mix(&x[7], &x[6], local[0]), local[1]);
        mix(&bottom, &top, local[2])
    }

    fn jacobian_determinant(&self, local: &Vector3) -> f64 {
        jacobian::determinant(&self.nodes, (*local).into())
    }

    fn mean_edge(&self, axis: usize) -> Vector3 {
        mean_edges(&self.nodes)[axis]
    }

    fn physical_gradient(&self, logical: &Vector3) -> Vector3 {
        let [j1, j2, j3] = mean_edges(&self.nodes);
        let determinant = j1.dot(&j2.cross(&j3));
        (j2.cross(&j3) * logical[0] + j3.cross(&j1) * logical[1] + j1.cross(&j2) * logical[2]) / determinant
    }

    fn area_vector(nodes: &[Vector3]) -> Vector3 {
        let [a, b, c, d] = nodes else { panic!("a face of a hexahedron has four nodes") };
        area_vector([a, b, c, d])
    }

    fn truncate(&self, half_space: &HalfSpace<3>) -> Truncation {
        let along = Along::new(self, &half_space.normal);
        let Value { value, derivative } = along.volume(along.depth(half_space.constant));
        Truncation {
            volume: self.determinant * value,
            section_area: self.determinant * (derivative / along.size),
        }
    }

    fn first_moment_about(&self, half_space: &HalfSpace<3>, point: &Vector3) -> Vector3 {
        let along = Along::new(self, &half_space.normal);
        let part = along.moment(along.depth(half_space.constant));
        let origin = (self.nodes[0] - point) + self.origin;
        (origin * part.volume + self.jacobian * part.first) * self.determinant
    }

    fn plane_constant(
        &self,
        normal: &Vector3,
        fraction: f64,
        method: PositionMethod,
    ) -> Result<PlaneConstant, PositionError> {
        plane_constant::check(normal.as_slice(), fraction, self.volume())?;
        plane_constant::from_smaller_part(fraction, |sign, fraction| {
            let along = Along::new(self, &(normal * sign));
            let found = plane_constant::find(&Profile::new(&along), fraction, method)?;
            Ok(found.with(along.constant(found.constant, sign), sign))
        })
    }

    fn slab(&self, face: usize, fraction: f64) -> Self {
        let (axis, upper) = (face / 2, face % 2 == 1);
        let depth = if self.affine {
            fraction.clamp(0.0, 1.0)
        } else {
            let section = |t: f64| self.section_determinant(axis, if upper { 0.5 - t } else { t - 0.5 });
            plane_constant::slab_depth([section(0.0), section(0.5), section(1.0)], fraction)
        };
        let front: [Vector3; 4] = std::array::from_fn(|i| self.nodes[Self::FACE_NODES[face][i]]);
        let back = std::array::from_fn::<_, 4, _>(|i| {
            let far = self.nodes[ACROSS[axis][Self::FACE_NODES[face][i]]];
            front[i] + (far - front[i]) * depth
        });
        Self::swept(&back, &front)
    }

    fn section(&self, half_space: &HalfSpace<3>) -> Vec<Vec<Vector3>> {
        section::of_hexahedron(&self.nodes, half_space)
    }

    fn defects(&self) -> Vec<Defect> {
        defects::of_hexahedron(&self.nodes, self.volume(), &self.local, self.determinant.signum())
    }
}

/// The node at the other end of the edge along an axis.
const ACROSS: [[usize; 8]; 3] =
    [[1, 0, 3, 2, 5, 4, 7, 6], [3, 2, 1, 0, 7, 6, 5, 4], [4, 5, 6, 7, 0, 1, 2, 3]];

impl Hexahedron {
    /// The Jacobian determinant, in the frame, integrated over the section at distance `c` from the centre along one axis:
    /// with the axes `i, j, k` in cyclic order, `P = e_j + c b_ij`, `Q = e_k + c b_ik`, `R = b_jk + c b`,
    /// it is `e_i.(P x Q) + [ b_ij.(P x R) + b_ik.(R x Q) ] / 12`.
    fn section_determinant(&self, axis: usize, c: f64) -> f64 {
        // The twists of two axes, by the third.
        let twist = |without: usize| &self.twists[[2, 1, 0][without]];
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        let (b_ij, b_ik, b_jk) = (twist(k), twist(j), twist(axis));
        let edges = mean_edges(&self.local);
        let p = edges[j] + b_ij * c;
        let q = edges[k] + b_ik * c;
        let r = b_jk + self.twists[3] * c;
        edges[axis].dot(&p.cross(&q)) + (b_ij.dot(&p.cross(&r)) + b_ik.dot(&r.cross(&q))) / 12.0
    }
}
