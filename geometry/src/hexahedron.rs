//! The hexahedron with eight nodes and six ruled faces, and its exact truncation by a plane.
//!
//! Everything happens in the cell's own affine frame, in which it is a unit cube plus dimensionless twists, the plane
//! `n.x = d` becomes `m.y = level` with `m` along `J^T n`, and volumes scale with `det J`. Slivers, needles, rotated or
//! not, and tiny or huge cells are then as accurate as the unit cube.
//!
//! **Truncated volume.** The divergence theorem (Kothe et al. 1999; Eq. 91, 94 of the paper) makes it a sum over the parts of
//! the faces where the bilinear height over the plane is not positive. Such a part is a corner under a hyperbola, a strip under
//! one, or the complement of corners; the private `face_part` has the formulas, `profile` finds the parts and does the sum for one
//! normal, `along` turns it into that of the cell, and `batch` has many cells side by side.

mod along;
mod batch;
mod profile;

use std::ops::{Add, Mul, Sub};

use crate::cell::{Cell, Truncation, Wanted};
use crate::clip::HexahedronTile;
use crate::compensated::Pair;
use crate::frame::{Direction, Frame, is_ill_conditioned};
use crate::plane_constant::{self, PlaneConstant, PositionError, PositionMethod};
use crate::ruled_face::area_vector;
use crate::tolerance::{TWIST_AFFINE, TWIST_NEGLIGIBLE};
use crate::{Defect, HalfSpace, Vector, affine, defects, jacobian, section, simd};

use along::Along;

type Vector3 = Vector<3>;

/// A hexahedron whose six faces are ruled surfaces, prepared for truncation. Nodes in the order of `VTK_HEXAHEDRON`.
#[derive(Clone, Copy, Debug)]
pub struct Hexahedron {
    nodes: [Vector3; 8],
    frame: Frame<3>,
    /// The nodes in the frame.
    local: [Vector3; 8],
    local_volume: f64,
    affine: bool,
}

/// The mean edges of a trilinear map along xi, eta, zeta, and its twists (xi eta, xi zeta, eta zeta, xi eta zeta), the
/// second-order ones about the centre, from the edges between pairs of nodes.
#[inline(always)]
fn modes<T>(edge: impl Fn(usize, usize) -> T) -> ([T; 3], [T; 4])
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    let edge = |i: usize| edge(Hexahedron::EDGES[i][0], Hexahedron::EDGES[i][1]);
    let xi = [edge(0), edge(1), edge(2), edge(3)];
    let (xi_lower, xi_upper) = (xi[0] + xi[1], xi[2] + xi[3]);
    let (twist_lower, twist_upper) = (xi[1] - xi[0], xi[3] - xi[2]);
    let (eta_lower, eta_upper) = (edge(4) + edge(5), edge(6) + edge(7));
    let zeta = (edge(8) + edge(9)) + (edge(10) + edge(11));
    (
        [(xi_lower + xi_upper) * 0.25, (eta_lower + eta_upper) * 0.25, zeta * 0.25],
        [
            (twist_lower + twist_upper) * 0.5,
            (xi_upper - xi_lower) * 0.5,
            (eta_upper - eta_lower) * 0.5,
            twist_upper - twist_lower,
        ],
    )
}

/// The mean edges, the rows of `det J J^-1`, `det J`, and the twists in the frame: not finite where `det J` vanishes.
struct AffinePart<T> {
    edges: [T; 3],
    rows: [T; 3],
    determinant: f64,
    twists: [Vector3; 4],
}

impl<T> AffinePart<T> {
    #[inline(always)]
    fn new(
        (edges, [b12, b13, b23, b]): ([T; 3], [T; 4]),
        cross: impl Fn(&T, &T) -> T,
        dot: impl Fn(&T, &T) -> f64,
    ) -> Self {
        let [xi, eta, zeta] = &edges;
        let rows = [cross(eta, zeta), cross(zeta, xi), cross(xi, eta)];
        let determinant = dot(xi, &rows[0]);
        let scale = determinant.recip();
        let solve = |a: &T| Vector3::new(dot(&rows[0], a), dot(&rows[1], a), dot(&rows[2], a)) * scale;
        let twists = [solve(&b12), solve(&b13), solve(&b23), solve(&b)];
        Self { edges, rows, determinant, twists }
    }
}

impl Hexahedron {
    /// The edges as pairs of nodes, four along each axis, in the direction of the axis; the lower one of the two other
    /// coordinates changes first.
    pub const EDGES: [[usize; 2]; 12] =
        [[0, 1], [3, 2], [4, 5], [7, 6], [0, 3], [1, 2], [4, 7], [5, 6], [0, 4], [1, 5], [3, 7], [2, 6]];

    /// The hexahedron with these nodes, in the order of `VTK_HEXAHEDRON`.
    pub fn new(nodes: [Vector3; 8]) -> Self {
        let AffinePart { edges, rows, determinant, twists } =
            AffinePart::new(modes(|a, b| nodes[b] - nodes[a]), Vector3::cross, Vector3::dot);
        if is_ill_conditioned(&edges, &rows, determinant) {
            return Self::compensated(nodes);
        }
        Self::in_frame(nodes, Frame::new(edges, None, determinant), twists)
    }

    /// The hexahedron in a frame that needs more digits than plain arithmetic has.
    #[cold]
    #[inline(never)]
    fn compensated(nodes: [Vector3; 8]) -> Self {
        let modes = modes(|a, b| Pair::difference(&nodes[b], &nodes[a]));
        let AffinePart { edges, determinant, twists, .. } = AffinePart::new(modes, Pair::cross, Pair::dot);
        let rest = Some(edges.map(|edge| edge.rest));
        Self::in_frame(nodes, Frame::new(edges.map(|edge| edge.value), rest, determinant), twists)
    }

    #[inline(always)]
    fn in_frame(nodes: [Vector3; 8], frame: Frame<3>, twists: [Vector3; 4]) -> Self {
        let [b12, b13, b23, b] = &twists;
        let size = (b12.abs() + b13.abs() + (b23.abs() + b.abs())).sum();
        // What is not finite has no affine frame.
        if !(size <= TWIST_AFFINE) {
            return Self::scaled(nodes);
        }
        let mut cell = Self { nodes, frame, local: CUBE, local_volume: 1.0, affine: true };
        if size > TWIST_NEGLIGIBLE {
            twist_cube(&mut cell.local, &twists);
            cell.local_volume += (b12.cross(b13)[0] + b23.cross(b12)[1] + b13.cross(b23)[2]) / 12.0;
            cell.affine = false;
        }
        cell
    }

    /// The cell moved so that its first node lies in the origin: plane constants are then relative to that node.
    ///
    /// What was prepared stays as it is, so that nothing is lost where differences of nodes are rounded.
    pub fn relative_to_first_node(&self) -> Self {
        Self { nodes: self.nodes.map(|x| x - self.nodes[0]), ..*self }
    }

    /// The frame for cells whose mean edges nearly vanish or fall together: a shift and a length scale.
    #[cold]
    #[inline(never)]
    fn scaled(nodes: [Vector3; 8]) -> Self {
        let centre = 0.125 * nodes.iter().map(|x| x - nodes[0]).sum::<Vector3>();
        let relative = nodes.map(|x| (x - nodes[0]) - centre);
        let extent = relative.iter().map(|x| x.amax()).fold(0.0, f64::max);
        let scale = if extent > 0.0 { extent } else { 1.0 };
        let local = relative.map(|x| x / scale);
        let (edges, twists) = modes(|a, b| local[b] - local[a]);
        let local_volume = volume(&edges, &twists);
        Self { nodes, frame: Frame::scaled(scale), local, local_volume, affine: false }
    }

    /// [`Cell::truncate`] where there is no closed form: apart from it, so that the closed form needs no room for this.
    #[inline(never)]
    fn truncate_ruled(&self, half_space: &HalfSpace<3>) -> Truncation {
        simd::widest(
            #[inline(always)]
            || {
                let along = Along::new(self, &half_space.normal);
                let part = along.volume(along.depth(half_space.constant));
                self.frame.truncation(part, &along.direction)
            },
        )
    }

    /// [`Cell::plane_constant`] for `fraction <= 1/2` along `sign` times the normal, where there is no closed form.
    #[inline(never)]
    fn position_ruled(
        &self,
        normal: &Vector3,
        sign: f64,
        fraction: f64,
        method: PositionMethod,
    ) -> Result<PlaneConstant, PositionError> {
        simd::widest(
            #[inline(always)]
            || {
                let along = Along::new(self, normal);
                let found = plane_constant::find(&mut along.rising(), fraction, method)?;
                Ok(found.plane(&along.direction, along.low, sign))
            },
        )
    }

    /// The nodes in the cell's frame.
    pub(crate) fn local(&self) -> &[Vector3; 8] {
        &self.local
    }

    /// What volumes in the cell's frame are to be multiplied by.
    pub(crate) fn frame_determinant(&self) -> f64 {
        self.frame.determinant
    }

    /// A normal in the cell's frame.
    #[inline(always)]
    pub(crate) fn direction(&self, normal: &Vector3) -> Direction<3> {
        self.frame.along(normal, &self.nodes[0], &self.local[0])
    }
}

/// Makes the corners `y` of the unit cube `y + b12 c1 c2 + b13 c1 c3 + b23 c2 c3 + b c1 c2 c3` with `c = y - 1/2`.
#[inline(always)]
fn twist_cube(cube: &mut [Vector3; 8], [b12, b13, b23, b]: &[Vector3; 4]) {
    let (flat, cubic) = (b12 * 0.25, b * 0.125);
    let (lower, upper) = (flat - cubic, flat + cubic);
    let (even, odd) = ((b13 + b23) * 0.25, (b13 - b23) * 0.25);
    cube[0] += lower + even;
    cube[1] -= lower + odd;
    cube[2] += lower - even;
    cube[3] -= lower - odd;
    cube[4] += upper - even;
    cube[5] -= upper - odd;
    cube[6] += upper + even;
    cube[7] -= upper + odd;
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

/// The volume of a trilinear cell with mean edges `j` and second-order twists `b` along (xi eta, xi zeta, eta zeta): the
/// Jacobian determinant about the centre, in which all odd powers integrate to zero,
/// `V = j1.(j2 x j3) + [ j1.(b12 x b13) + j2.(b23 x b12) + j3.(b13 x b23) ] / 12`.
fn volume([j1, j2, j3]: &[Vector3; 3], [b12, b13, b23, _]: &[Vector3; 4]) -> f64 {
    j1.dot(&j2.cross(j3))
        + (j1.dot(&b12.cross(b13)) + j2.dot(&b23.cross(b12)) + j3.dot(&b13.cross(b23))) / 12.0
}

impl Cell<3> for Hexahedron {
    type Tile = HexahedronTile;

    const FACES: usize = 6;
    const VTK_CELL_TYPE: u8 = 12;
    const OFFSETS: &'static [[usize; 3]] =
        &[[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    const SWEPT_BACK: usize = 4;
    const FACE_NODES: &'static [&'static [usize]] =
        &[&[0, 4, 7, 3], &[1, 2, 6, 5], &[0, 1, 5, 4], &[2, 3, 7, 6], &[0, 3, 2, 1], &[4, 5, 6, 7]];

    fn from_corners(node: impl Fn([usize; 3]) -> Vector3) -> Self {
        Self::new(std::array::from_fn(|i| node(Self::OFFSETS[i])))
    }

    fn swept(back: &[Vector3], face: &[Vector3]) -> Self {
        assert!(back.len() == 4 && face.len() == 4, "a face of a hexahedron has four nodes");
        Self::new(std::array::from_fn(|i| if i < 4 { back[i] } else { face[i - 4] }))
    }

    fn swept_volume(back: &[Vector3], face: &[Vector3]) -> f64 {
        assert!(back.len() == 4 && face.len() == 4, "a face of a hexahedron has four nodes");
        let node = |i: usize| if i < 4 { &back[i] } else { &face[i - 4] };
        let (edges, twists) = modes(|a, b| node(b) - node(a));
        volume(&edges, &twists)
    }

    fn nodes(&self) -> &[Vector3] {
        &self.nodes
    }

    fn volume(&self) -> f64 {
        self.frame.determinant * self.local_volume
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
        modes(|a, b| self.nodes[b] - self.nodes[a]).0[axis]
    }

    fn physical_gradient(&self, logical: &Vector3) -> Vector3 {
        let ([j1, j2, j3], _) = modes(|a, b| self.nodes[b] - self.nodes[a]);
        let determinant = j1.dot(&j2.cross(&j3));
        (j2.cross(&j3) * logical[0] + j3.cross(&j1) * logical[1] + j1.cross(&j2) * logical[2]) / determinant
    }

    fn area_vector(nodes: &[Vector3]) -> Vector3 {
        let [a, b, c, d] = nodes else { panic!("a face of a hexahedron has four nodes") };
        area_vector([a, b, c, d])
    }

    fn truncate(&self, half_space: &HalfSpace<3>) -> Truncation {
        if self.affine {
            return affine::truncate(&self.frame, &self.nodes[0], half_space);
        }
        self.truncate_ruled(half_space)
    }

    fn first_moment_about(&self, half_space: &HalfSpace<3>, point: &Vector3) -> Vector3 {
        let along = Along::new(self, &half_space.normal);
        let part = along.moment(along.depth(half_space.constant));
        let about_first = self.frame.jacobian * (part.first - self.local[0] * part.volume);
        ((self.nodes[0] - point) * part.volume + about_first) * self.frame.determinant
    }

    fn section_centroid(&self, half_space: &HalfSpace<3>) -> Option<Vector3> {
        simd::widest(
            #[inline(always)]
            || {
                let along = Along::new(self, &half_space.normal);
                let centroid = along.section_centroid(along.depth(half_space.constant))?;
                Some(self.nodes[0] + self.frame.jacobian * (centroid - self.local[0]))
            },
        )
    }

    fn plane_constant(
        &self,
        normal: &Vector3,
        fraction: f64,
        method: PositionMethod,
    ) -> Result<PlaneConstant, PositionError> {
        plane_constant::check(normal.as_slice(), fraction, self.volume())?;
        plane_constant::from_smaller_part(fraction, |sign, fraction| {
            if self.affine {
                return affine::plane_constant(&self.frame, &self.nodes[0], normal, sign, fraction, method);
            }
            self.position_ruled(&(normal * sign), sign, fraction, method)
        })
    }

    fn plane_constants(
        wanted: &[Wanted<Self, 3>],
        method: PositionMethod,
        give: impl FnMut(usize, Result<PlaneConstant, PositionError>),
    ) {
        batch::plane_constants(wanted, method, give);
    }

    fn slab(&self, face: usize, fraction: f64) -> Self {
        let (axis, upper) = (face / 2, face % 2 == 1);
        let depth = if self.affine {
            fraction.clamp(0.0, 1.0)
        } else {
            let section = |t: f64| self.section_determinant(axis, if upper { 0.5 - t } else { t - 0.5 });
            plane_constant::slab_depth([section(0.0), section(0.5), section(1.0)], fraction)
        };
        let mut nodes = self.nodes;
        for &front in Self::FACE_NODES[face] {
            let far = ACROSS[axis][front];
            nodes[far] = self.nodes[front] + (self.nodes[far] - self.nodes[front]) * depth;
        }
        Self::new(nodes)
    }

    fn section(&self, half_space: &HalfSpace<3>) -> Vec<Vec<Vector3>> {
        section::of_hexahedron(&self.nodes, half_space)
    }

    fn defects(&self) -> Vec<Defect> {
        defects::of_hexahedron(&self.nodes, self.volume(), &self.local, self.frame.determinant.signum())
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
        let (edges, twists) = modes(|a, b| self.local[b] - self.local[a]);
        // The twists of two axes, by the third.
        let twist = |without: usize| &twists[[2, 1, 0][without]];
        let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
        let (b_ij, b_ik, b_jk) = (twist(k), twist(j), twist(axis));
        let p = edges[j] + b_ij * c;
        let q = edges[k] + b_ik * c;
        let r = b_jk + twists[3] * c;
        edges[axis].dot(&p.cross(&q)) + (b_ij.dot(&p.cross(&r)) + b_ik.dot(&r.cross(&q))) / 12.0
    }
}
