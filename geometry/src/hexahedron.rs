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
//! positive. That part is a corner under a hyperbola, a strip under one, or the complement of corners.

use nalgebra::Matrix3;

use crate::cell::{Cell, Truncation};
use crate::face_part::face_part;
use crate::half_space::{compensated_dot, compensated_height, largest_and_direction};
use crate::parallelepiped::UnitCube;
use crate::plane_constant::{self, Monotone, PlaneConstant, PositionError, PositionMethod};
use crate::root::Value;
use crate::ruled_face::{SurfaceElement, area_vector};
use crate::tolerance::{TWIST_AFFINE, TWIST_NEGLIGIBLE};
use crate::{Defect, HalfSpace, Vector, defects, jacobian, section};

type Vector3 = Vector<3>;

/// A hexahedron whose six faces are ruled surfaces, prepared for truncation. Nodes in the order of `VTK_HEXAHEDRON`.
#[derive(Clone, Copy, Debug)]
pub struct Hexahedron {
    nodes: [Vector3; 8],
    /// The frame's origin, relative to the first node.
    origin: Vector3,
    jacobian: Matrix3<f64>,
    determinant: f64,
    /// The nodes in the affine frame.
    local: [Vector3; 8],
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
        let jacobian = Matrix3::from_columns(&edges);
        let determinant = edges[0].dot(&edges[1].cross(&edges[2]));
        // Rows of the inverse; not finite where the determinant vanishes.
        let inverse = Matrix3::from_rows(&[
            (edges[1].cross(&edges[2]) / determinant).transpose(),
            (edges[2].cross(&edges[0]) / determinant).transpose(),
            (edges[0].cross(&edges[1]) / determinant).transpose(),
        ]);
        let twist = raw.map(|a| inverse * a);
        let size = twist.iter().map(|b| b.amax()).fold(0.0, f64::max);
        let centre = 0.125 * nodes.iter().map(|x| x - nodes[0]).sum::<Vector3>();
        if size > TWIST_AFFINE || !twist.iter().all(|b| b.iter().all(|c| c.is_finite())) {
            return Self::scaled(nodes, centre);
        }
        let affine = size <= TWIST_NEGLIGIBLE;
        let local = std::array::from_fn(|i| {
            let y = Vector3::from_fn(|axis, _| Self::OFFSETS[i][axis] as f64);
            if affine {
                return y;
            }
            let c = y.add_scalar(-0.5);
            y + twist[0] * (c[0] * c[1])
                + twist[1] * (c[0] * c[2])
                + twist[2] * (c[1] * c[2])
                + twist[3] * (c[0] * c[1] * c[2])
        });
        let local_volume = if affine {
            1.0
        } else {
            1.0 + (cross_component(0, &twist[0], &twist[1])
                + cross_component(1, &twist[2], &twist[0])
                + cross_component(2, &twist[1], &twist[2]))
                / 12.0
        };
        let origin = centre - jacobian * Vector3::repeat(0.5);
        Self { nodes, origin, jacobian, determinant, local, local_volume, affine }
    }

    /// The frame for cells whose mean edges nearly vanish or fall together: a shift and a length scale.
    fn scaled(nodes: [Vector3; 8], centre: Vector3) -> Self {
        let relative = nodes.map(|x| (x - nodes[0]) - centre);
        let extent = relative.iter().map(|x| x.amax()).fold(0.0, f64::max);
        let scale = if extent > 0.0 { extent } else { 1.0 };
        let local = relative.map(|x| x / scale);
        let [j1, j2, j3] = mean_edges(&local);
        let [a12, a13, a23, _] = twists(&local);
        let local_volume = j1.dot(&j2.cross(&j3))
            + (j1.dot(&a12.cross(&a13)) + j2.dot(&a23.cross(&a12)) + j3.dot(&a13.cross(&a23))) / 12.0;
        Self {
            nodes,
            origin: centre,
            jacobian: Matrix3::identity() * scale,
            determinant: scale * scale * scale,
            local,
            local_volume,
            affine: false,
        }
    }

    /// The cell as its function volume(delta) along one normal, in the affine frame.
    fn along(&self, normal: &Vector3) -> Along<'_> {
        let (size, m) = largest_and_direction(&self.jacobian.tr_mul(normal));
        let mut heights = self.local.map(|y| m.dot(&y));
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        heights.iter_mut().for_each(|h| *h -= low);
        let base = compensated_dot(normal, &self.nodes[0]);
        let offset = normal.dot(&self.origin);
        Along { cell: self, size, m, cube: UnitCube::new(m.as_slice()), base, offset, low, heights }
    }
}

/// `e_axis . (a x b)`.
fn cross_component(axis: usize, a: &Vector3, b: &Vector3) -> f64 {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    a[i] * b[j] - a[j] * b[i]
}

/// A hexahedron along one normal, in its affine frame: heights of the nodes over the lowest of them, in
/// units of `size`.
struct Along<'a> {
    cell: &'a Hexahedron,
    /// Largest component of `J^T n`, the unit of all heights and depths here.
    size: f64,
    /// `m = J^T n / size`.
    m: Vector3,
    /// The cell without its twists, along the same normal.
    cube: UnitCube,
    /// `n.x` of the first node.
    base: [f64; 2],
    /// `n.x` of the frame's origin over the first node.
    offset: f64,
    /// `m.y` of the lowest node.
    low: f64,
    heights: [f64; 8],
}

impl Monotone for Along<'_> {
    fn span(&self) -> f64 {
        self.heights.iter().copied().fold(0.0, f64::max)
    }

    fn total(&self) -> f64 {
        self.cell.local_volume
    }

    fn volume(&self, depth: f64) -> Value {
        if self.cell.affine {
            return self.cube.volume(depth);
        }
        let s = self.heights.map(|h| h - depth);
        let inside = s.iter().filter(|&&s| s <= 0.0).count();
        if inside == 0 {
            return Value { value: 0.0, derivative: 0.0 };
        }
        if inside == 8 {
            return Value { value: self.cell.local_volume, derivative: 0.0 };
        }
        if inside <= 4 {
            self.lower_part(&s, 1.0)
        } else {
            // The smaller part is the one to compute: less to do, and it keeps its relative accuracy.
            let Value { value, derivative } = self.lower_part(&s.map(|s| -s), -1.0);
            Value { value: self.cell.local_volume - value, derivative }
        }
    }

    fn start(&self, fraction: f64) -> f64 {
        self.cube.position(fraction).0 * (self.span() / self.cube.span())
    }

    fn closed_form(&self, fraction: f64) -> Option<(f64, usize)> {
        self.cell.affine.then(|| self.cube.position(fraction))
    }
}

impl Along<'_> {
    /// The depth of a plane over the lowest node.
    fn depth(&self, constant: f64) -> f64 {
        -compensated_height(self.base, self.offset, constant) / self.size - self.low
    }

    /// The plane constant of a depth, for the normal along which this is times `sign`.
    fn constant(&self, depth: f64, sign: f64) -> f64 {
        sign * (self.base[0] + (self.base[1] + (self.offset + (self.low + depth) * self.size)))
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
        let along = self.along(&half_space.normal);
        let Value { value, derivative } = along.volume(along.depth(half_space.constant));
        Truncation {
            volume: self.determinant * value,
            section_area: self.determinant * (derivative / along.size),
        }
    }

    fn plane_constant(
        &self,
        normal: &Vector3,
        fraction: f64,
        method: PositionMethod,
    ) -> Result<PlaneConstant, PositionError> {
        plane_constant::check(normal.as_slice(), fraction, self.volume())?;
        plane_constant::from_smaller_part(fraction, |sign, fraction| {
            let along = self.along(&(normal * sign));
            let found = plane_constant::find(&along, fraction, method)?;
            Ok(found.with(along.constant(found.constant, sign), sign))
        })
    }

    fn slab(&self, face: usize, fraction: f64) -> Self {
        let (axis, upper) = (face / 2, face % 2 == 1);
        let x = &self.nodes;
        // Partial volumes are a cubic in the depth, fixed by the Bernstein coefficients of the sections.
        let depth = if self.affine {
            fraction.clamp(0.0, 1.0)
        } else {
            let section = |t: f64| self.integrated_determinant(axis, if upper { 1.0 - t } else { t });
            plane_constant::slab_depth([section(0.0), section(0.5), section(1.0)], fraction)
        };
        Self::from_corners(|offset| {
            let node = |side: usize| {
                let mut at = offset;
                at[axis] = side;
                x[Self::OFFSETS.iter().position(|o| *o == at).expect("every offset has a node")]
            };
            let (near, far) = (node(usize::from(upper)), node(usize::from(!upper)));
            if (offset[axis] == 1) == upper { near } else { near + (far - near) * depth }
        })
    }

    fn section(&self, half_space: &HalfSpace<3>) -> Vec<Vec<Vector3>> {
        section::of_hexahedron(&self.nodes, half_space)
    }

    fn defects(&self) -> Vec<Defect> {
        defects::of_hexahedron(&self.nodes, self.volume(), &self.local, self.determinant.signum())
    }
}

impl Hexahedron {
    /// The Jacobian determinant integrated over the section at coordinate `t` of one axis: a quadratic in `t`.
    fn integrated_determinant(&self, axis: usize, t: f64) -> f64 {
        // The determinant is quadratic in each coordinate: Simpson's rule is exact.
        const SIMPSON: [(f64, f64); 3] = [(0.0, 1.0 / 6.0), (0.5, 4.0 / 6.0), (1.0, 1.0 / 6.0)];
        let mut sum = 0.0;
        for (u, weight_u) in SIMPSON {
            for (v, weight_v) in SIMPSON {
                let mut local = Vector3::repeat(t);
                local[(axis + 1) % 3] = u;
                local[(axis + 2) % 3] = v;
                sum += weight_u * weight_v * self.jacobian_determinant(&local);
            }
        }
        sum
    }
}
