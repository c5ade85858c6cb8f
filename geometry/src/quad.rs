//! The quadrilateral with four nodes, and its exact truncation by a line.
//!
//! As the [hexahedron](crate::hexahedron), it works in its own affine frame. For any point `p` on the line the divergence
//! theorem gives, for any simple quadrilateral and with the winding number for any other (Eq. 87, 88),
//!
//! ```text
//! 2 A = sum over edges of (t1 - t0) (y_a - p) x (y_b - y_a)
//! ```
//!
//! where the edge from `a` to `b` is inside between its parameters `t0` and `t1`; the edge along the line gives nothing.
//! The area is a quadratic in the plane constant between the heights of two nodes, so the inverse is a closed form.

use std::ops::{Add, Mul, Sub};

use crate::cell::{Cell, Truncation};
use crate::clip::QuadTile;
use crate::compensated::Pair;
use crate::frame::{Direction, Frame, is_ill_conditioned};
use crate::parallelepiped::UnitCube;
use crate::plane_constant::{self, Monotone, PlaneConstant, PositionError, PositionMethod};
use crate::root::Value;
use crate::tolerance::{TWIST_AFFINE, TWIST_NEGLIGIBLE};
use crate::{Defect, HalfSpace, Vector, affine, centroid, defects, moment, section};

type Vector2 = Vector<2>;

/// A quadrilateral prepared for truncation. Nodes counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub struct Quad {
    nodes: [Vector2; 4],
    frame: Frame<2>,
    /// The nodes in the affine frame.
    local: [Vector2; 4],
    local_area: f64,
    affine: bool,
}

/// The mean edges and the twist of a bilinear map, from the edges between pairs of nodes.
fn modes<T>(edge: impl Fn(usize, usize) -> T) -> ([T; 2], T)
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    let (lower, upper, left, right) = (edge(0, 1), edge(3, 2), edge(0, 3), edge(1, 2));
    ([(lower + upper) * 0.5, (left + right) * 0.5], upper - lower)
}

/// The determinant of the mean edges, and the twist in their frame: not finite where the determinant vanishes.
fn affine_part<T>([j1, j2]: &[T; 2], twist: &T, cross: impl Fn(&T, &T) -> f64) -> (f64, Vector2) {
    let determinant = cross(j1, j2);
    (determinant, Vector2::new(cross(twist, j2), cross(j1, twist)) / determinant)
}

fn cross(a: &Vector2, b: &Vector2) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

impl Quad {
    /// The quadrilateral with these nodes, counter-clockwise.
    pub fn new(nodes: [Vector2; 4]) -> Self {
        let (edges, twist) = modes(|a, b| nodes[b] - nodes[a]);
        let (determinant, twist) = affine_part(&edges, &twist, cross);
        let [j1, j2] = &edges;
        if is_ill_conditioned(
            &edges,
            &[Vector2::new(j2[1], -j2[0]), Vector2::new(-j1[1], j1[0])],
            determinant,
        ) {
            return Self::compensated(nodes);
        }
        Self::in_frame(nodes, Frame::new(edges, None, determinant), &twist)
    }

    /// The quadrilateral in a frame that needs more digits than plain arithmetic has.
    #[cold]
    fn compensated(nodes: [Vector2; 4]) -> Self {
        let (edges, twist) = modes(|a, b| Pair::difference(&nodes[b], &nodes[a]));
        let (determinant, twist) = affine_part(&edges, &twist, Pair::perp);
        let rest = Some(edges.map(|edge| edge.rest));
        Self::in_frame(nodes, Frame::new(edges.map(|edge| edge.value), rest, determinant), &twist)
    }

    #[inline(always)]
    fn in_frame(nodes: [Vector2; 4], frame: Frame<2>, twist: &Vector2) -> Self {
        let size = twist.abs().sum();
        // What is not finite has no affine frame.
        if !(size <= TWIST_AFFINE) {
            return Self::scaled(nodes);
        }
        let affine = size <= TWIST_NEGLIGIBLE;
        let local = std::array::from_fn(|i| {
            let y = Vector2::from_fn(|axis, _| Self::OFFSETS[i][axis] as f64);
            if affine { y } else { y + twist * ((y[0] - 0.5) * (y[1] - 0.5)) }
        });
        Self { nodes, frame, local, local_area: 1.0, affine }
    }

    /// The frame for cells whose mean edges nearly vanish or fall together: a shift and a length scale.
    #[cold]
    fn scaled(nodes: [Vector2; 4]) -> Self {
        let centre = 0.25 * nodes.iter().map(|x| x - nodes[0]).sum::<Vector2>();
        let relative = nodes.map(|x| (x - nodes[0]) - centre);
        let extent = relative.iter().map(|x| x.amax()).fold(0.0, f64::max);
        let scale = if extent > 0.0 { extent } else { 1.0 };
        let local = relative.map(|x| x / scale);
        let local_area = 0.5 * cross(&(local[2] - local[0]), &(local[3] - local[1]));
        Self { nodes, frame: Frame::scaled(scale), local, local_area, affine: false }
    }

    /// A normal in the cell's frame.
    fn direction(&self, normal: &Vector2) -> Direction<2> {
        self.frame.along(normal, &self.nodes[0], &self.local[0])
    }

    /// The cell as its function area(depth) along one normal, in the affine frame.
    fn along(&self, normal: &Vector2) -> Along<'_> {
        let direction = self.direction(normal);
        let mut heights = self.local.map(|y| direction.m.dot(&y));
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        heights.iter_mut().for_each(|h| *h -= low);
        Along { cell: self, direction, low, heights }
    }
}

/// A quadrilateral along one normal, in its affine frame: heights of the nodes over the lowest of them.
struct Along<'a> {
    cell: &'a Quad,
    /// The normal in the frame; its size is the unit of all heights and depths here.
    direction: Direction<2>,
    /// `m.y` of the lowest node.
    low: f64,
    heights: [f64; 4],
}

impl Monotone for Along<'_> {
    fn span(&self) -> f64 {
        self.heights.iter().copied().fold(0.0, f64::max)
    }

    fn total(&self) -> f64 {
        self.cell.local_area
    }

    fn volume(&mut self, depth: f64) -> Value {
        let s = self.heights.map(|h| h - depth);
        let inside = s.iter().filter(|&&s| s <= 0.0).count();
        match inside {
            0 => Value::default(),
            4 => Value { value: self.cell.local_area, ..Value::default() },
            3 => {
                let above = self.lower_part(&s.map(|s| -s), -1.0);
                Value { value: self.cell.local_area - above.value, ..above }
            }
            _ => self.lower_part(&s, 1.0),
        }
    }

    fn start(&self, fraction: f64) -> f64 {
        let cube = UnitCube::new(self.direction.m.as_slice());
        cube.position(fraction) * (self.span() / cube.span())
    }

    fn closed_form(&mut self, fraction: f64) -> Option<(f64, usize)> {
        let target = fraction * self.cell.local_area;
        let mut levels = self.heights;
        levels.sort_unstable_by(f64::total_cmp);
        let (mut low, mut below) = (levels[0], 0.0);
        for (evaluations, high) in levels.into_iter().enumerate().skip(1) {
            let upto = self.volume(high).value;
            if upto >= target {
                let width = high - low;
                let middle = self.volume(low + 0.5 * width).value;
                // area(low + t width) = below + t (linear + t square)
                // A section is not shorter than none: at a corner rounding would have it.
                let linear = (4.0 * (middle - below) - (upto - below)).max(0.0);
                let square = 2.0 * ((upto - below) - 2.0 * (middle - below));
                let wanted = target - below;
                let root = (linear * linear + 4.0 * square * wanted).max(0.0).sqrt();
                // The root vanishes where its square is too small for a number, and so is `t`.
                let t = if linear + root > 0.0 { 2.0 * wanted / (linear + root) } else { 0.0 };
                return Some((low + t.min(1.0) * width, evaluations + 1));
            }
            (low, below) = (high, upto);
        }
        None
    }
}

impl Along<'_> {
    /// The depth of a plane over the lowest node.
    fn depth(&self, constant: f64) -> f64 {
        self.direction.level(constant) - self.low
    }

    /// Area and section where the heights `s` over a line with normal `sign m` are not positive.
    fn lower_part(&self, s: &[f64; 4], sign: f64) -> Value {
        let y = &self.cell.local;
        let m = &self.direction.m;
        let m2 = m.norm_squared();
        let lowest = (1..4).fold(0, |best, i| if s[i] < s[best] { i } else { best });
        let p = y[lowest] - m * (sign * s[lowest] / m2);
        let mut double = 0.0;
        let mut k = Vector2::zeros();
        for a in 0..4 {
            let b = (a + 1) & 3;
            let part = match (s[a] <= 0.0, s[b] <= 0.0) {
                (false, false) => continue,
                (true, true) => 1.0,
                (true, false) => -s[a] / (s[b] - s[a]),
                (false, true) => -s[b] / (s[a] - s[b]),
            };
            let edge = y[b] - y[a];
            double += part * cross(&(y[a] - p), &edge);
            k += Vector2::new(edge[1], -edge[0]) * part;
        }
        Value { value: 0.5 * double, derivative: -sign * m.dot(&k) / m2, second: 0.0 }
    }
}

impl Cell<2> for Quad {
    type Tile = QuadTile;

    const FACES: usize = 4;
    const VTK_CELL_TYPE: u8 = 9;
    const OFFSETS: &'static [[usize; 2]] = &[[0, 0], [1, 0], [1, 1], [0, 1]];
    const SWEPT_BACK: usize = 3;
    const FACE_NODES: &'static [&'static [usize]] = &[&[3, 0], &[1, 2], &[0, 1], &[2, 3]];

    fn from_corners(node: impl Fn([usize; 2]) -> Vector2) -> Self {
        Self::new(std::array::from_fn(|i| node(Self::OFFSETS[i])))
    }

    fn swept(back: &[Vector2], face: &[Vector2]) -> Self {
        assert!(back.len() == 2 && face.len() == 2, "a face of a quadrilateral has two nodes");
        Self::new([face[0], face[1], back[1], back[0]])
    }

    fn nodes(&self) -> &[Vector2] {
        &self.nodes
    }

    fn volume(&self) -> f64 {
        self.frame.determinant * self.local_area
    }

    fn is_affine(&self) -> bool {
        self.affine
    }

    fn map(&self, local: &Vector2) -> Vector2 {
        let x = &self.nodes;
        let bottom = x[0] + (x[1] - x[0]) * local[0];
        let top = x[3] + (x[2] - x[3]) * local[0];
        bottom + (top - bottom) * local[1]
    }

    fn jacobian_determinant(&self, local: &Vector2) -> f64 {
        let x = &self.nodes;
        let mix = |a: Vector2, b: Vector2, t: f64| a + (b - a) * t;
        cross(&mix(x[1] - x[0], x[2] - x[3], local[1]), &mix(x[3] - x[0], x[2] - x[1], local[0]))
    }

    fn mean_edge(&self, axis: usize) -> Vector2 {
        modes(|a, b| self.nodes[b] - self.nodes[a]).0[axis]
    }

    fn physical_gradient(&self, logical: &Vector2) -> Vector2 {
        let ([j1, j2], _) = modes(|a, b| self.nodes[b] - self.nodes[a]);
        (Vector2::new(j2[1], -j2[0]) * logical[0] + Vector2::new(-j1[1], j1[0]) * logical[1])
            / cross(&j1, &j2)
    }

    fn area_vector(nodes: &[Vector2]) -> Vector2 {
        let [a, b] = nodes else { panic!("a face of a quadrilateral has two nodes") };
        Vector2::new(b[1] - a[1], a[0] - b[0])
    }

    fn truncate(&self, half_space: &HalfSpace<2>) -> Truncation {
        if self.affine {
            return affine::truncate(&self.frame, &self.nodes[0], half_space);
        }
        let mut along = self.along(&half_space.normal);
        let part = along.volume(along.depth(half_space.constant));
        self.frame.truncation(part, &along.direction)
    }

    fn first_moment_about(&self, half_space: &HalfSpace<2>, point: &Vector2) -> Vector2 {
        let along = self.along(&half_space.normal);
        let depth = along.depth(half_space.constant);
        let part = moment::of_quad(&self.local, &along.direction.m, &along.heights.map(|h| h - depth));
        let about_first = self.frame.jacobian * (part.first - self.local[0] * part.volume);
        ((self.nodes[0] - point) * part.volume + about_first) * self.frame.determinant
    }

    fn section_centroid(&self, half_space: &HalfSpace<2>) -> Option<Vector2> {
        let along = self.along(&half_space.normal);
        let depth = along.depth(half_space.constant);
        let centroid = centroid::of_quad(&self.local, &along.direction.m, &along.heights.map(|h| h - depth))?;
        Some(self.nodes[0] + self.frame.jacobian * (centroid - self.local[0]))
    }

    fn plane_constant(
        &self,
        normal: &Vector2,
        fraction: f64,
        method: PositionMethod,
    ) -> Result<PlaneConstant, PositionError> {
        plane_constant::check(normal.as_slice(), fraction, self.volume())?;
        plane_constant::from_smaller_part(fraction, |sign, fraction| {
            if self.affine {
                return affine::plane_constant(&self.frame, &self.nodes[0], normal, sign, fraction, method);
            }
            let mut along = self.along(&(normal * sign));
            let found = plane_constant::find(&mut along, fraction, method)?;
            Ok(found.plane(&along.direction, along.low, sign))
        })
    }

    fn slab(&self, face: usize, fraction: f64) -> Self {
        let (axis, upper) = (face / 2, face % 2 == 1);
        let depth = if self.affine {
            fraction.clamp(0.0, 1.0)
        } else {
            let section = |t: f64| {
                let mut local = Vector2::repeat(0.5);
                local[axis] = if upper { 1.0 - t } else { t };
                self.jacobian_determinant(&local)
            };
            plane_constant::slab_depth([0.0, 0.5, 1.0].map(section), fraction)
        };
        let mut nodes = self.nodes;
        for &front in Self::FACE_NODES[face] {
            let far = ACROSS[axis][front];
            nodes[far] = self.nodes[front] + (self.nodes[far] - self.nodes[front]) * depth;
        }
        Self::new(nodes)
    }

    fn section(&self, half_space: &HalfSpace<2>) -> Vec<Vec<Vector2>> {
        section::of_quad(&self.nodes, half_space)
    }

    fn defects(&self) -> Vec<Defect> {
        defects::of_quad(&self.nodes, self.volume())
    }
}

/// The node at the other end of the edge along an axis.
const ACROSS: [[usize; 4]; 2] = [[1, 0, 3, 2], [3, 2, 1, 0]];
