//! The section of a plane with a cell: loops of points with straight chords along hyperbolic edges.
//!
//! The plane cuts each ruled face along pieces of a conic, *arcs*, that end on the face's edges. Every piece is
//! `u + v + w u v = 1` in the coordinates of [`crate::hyperbola`], and with `q = sqrt(1 + w)`
//!
//! ```text
//! u = t / (t + (1-t) q),   v = (1-t) / ((1-t) + t q),   0 <= t <= 1
//! ```
//!
//! makes the arc in space a rational quadratic curve with equal weights at its ends. So its largest distance from
//! the chord is the one at `t = 1/2`, and falls at least with the square of the number of chords.
//!
//! **Watertight.** The points of an arc are computed from its face and the plane alone, the face's nodes in an order
//! that both cells agree on, and the ends of an arc from the nodes of their edge alone. So two cells that share a
//! face find the same points on it to the last bit, in opposite directions.

use std::cmp::Ordering;

use crate::tolerance::{SECTION_CHORD, SECTION_CHORDS};
use crate::{Cell, HalfSpace, Hexahedron, Quad, Vector};

type Vector3 = Vector<3>;

/// The area vector of a closed loop of points, `1/2 sum (x_i - x_0) x (x_(i+1) - x_0)` (Newell): along the normal of
/// the half-space for a section of [`Cell::section`], with the section's area as length.
pub fn area_vector(points: &[Vector3]) -> Vector3 {
    let sides = points.windows(2).map(|side| (side[0] - points[0]).cross(&(side[1] - points[0])));
    0.5 * sides.sum::<Vector3>()
}

/// A piece of the section on one face, from one edge of the cell to another.
struct Arc {
    start: usize,
    end: usize,
    /// From start to end, both included.
    points: Vec<Vector3>,
}

pub(crate) fn of_hexahedron(nodes: &[Vector3; 8], half_space: &HalfSpace<3>) -> Vec<Vec<Vector3>> {
    let heights = nodes.map(|x| half_space.height(&x));
    let mut arcs: Vec<Arc> = Vec::new();
    for face in Hexahedron::FACE_NODES {
        arcs_of_face(nodes, &heights, face, &mut arcs);
    }
    let mut loops = Vec::new();
    while let Some(first) = arcs.pop() {
        let (start, mut end) = (first.start, first.end);
        let mut points = first.points;
        // An edge that the plane crosses starts one arc and ends one, so the chain always closes.
        while end != start
            && let Some(next) = arcs.iter().position(|arc| arc.start == end)
        {
            let next = arcs.swap_remove(next);
            points.extend(next.points);
            end = next.end;
        }
        points.dedup();
        while points.len() > 1 && points.first() == points.last() {
            points.pop();
        }
        if points.len() > 2 {
            loops.push(points);
        }
    }
    loops
}

/// The edge of the cell between two nodes.
fn edge_between(a: usize, b: usize) -> usize {
    let is_it = |edge: &[usize; 2]| *edge == [a, b] || *edge == [b, a];
    Hexahedron::EDGES.iter().position(is_it).expect("neighbours on a face share an edge")
}

/// Which piece of a face's section an arc is, by the corner it is counted from.
#[derive(Clone, Copy)]
pub(crate) enum Piece {
    /// Around corner `i`, from the edge to the next corner to the edge to the one before.
    Corner(usize),
    /// Between the corners `i`, `i + 1` and the other two, from the edge behind `i + 1` to that before `i`.
    Strip(usize),
}

/// Adds the arcs of one face, with the material on their right seen from outside the cell: the section's boundary
/// runs against that of the material on the face.
fn arcs_of_face(nodes: &[Vector3; 8], heights: &[f64; 8], outward: &[usize], arcs: &mut Vec<Arc>) {
    let order = canonical_order(std::array::from_fn(|i| &nodes[outward[i]]));
    let face =
        Face { x: order.nodes.map(|i| nodes[outward[i]]), s: order.nodes.map(|i| heights[outward[i]]) };
    let edge = |i: usize| edge_between(outward[order.nodes[i & 3]], outward[order.nodes[(i + 1) & 3]]);
    for (piece, material_on_left) in pieces(&face.s).into_iter().flatten() {
        let (start, end) = match piece {
            Piece::Corner(i) => (edge(i), edge(i + 3)),
            Piece::Strip(i) => (edge(i + 1), edge(i + 3)),
        };
        let points = face.points(piece);
        let mut arc = Arc { start, end, points };
        if material_on_left != order.reversed {
            arc.points.reverse();
            std::mem::swap(&mut arc.start, &mut arc.end);
        }
        arcs.push(arc);
    }
}

/// The order of a face's corners that both cells agree on.
struct Order {
    nodes: [usize; 4],
    /// Whether it runs against the order given.
    reversed: bool,
}

/// The lexicographically smallest of the eight ways to walk around a face.
fn canonical_order(face: [&Vector3; 4]) -> Order {
    let walks = (0..8).map(|walk| {
        let (first, reversed) = (walk & 3, walk >= 4);
        Order {
            nodes: std::array::from_fn(|i| (if reversed { first + 4 - i } else { first + i }) & 3),
            reversed,
        }
    });
    let smaller = |a: Order, b: Order| {
        let compared = (0..4).map(|i| compare(face[a.nodes[i]], face[b.nodes[i]])).find(|o| o.is_ne());
        if compared == Some(Ordering::Greater) { b } else { a }
    };
    walks.reduce(smaller).expect("there are eight walks")
}

/// Lexicographic order of coordinates.
fn compare<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> Ordering {
    a.iter().partial_cmp(b.iter()).unwrap_or(Ordering::Equal)
}

/// Where the plane crosses an edge, from the edge's nodes and heights alone, whichever comes first.
fn crossing<const D: usize>(x: [&Vector<D>; 2], s: [f64; 2]) -> Vector<D> {
    let ([a, b], [s_a, s_b]) = match compare(x[0], x[1]) {
        Ordering::Greater => ([x[1], x[0]], [s[1], s[0]]),
        _ => (x, s),
    };
    if s_b == 0.0 {
        return *b;
    }
    a + (b - a) * (s_a / (s_a - s_b))
}

/// The pieces of the section of a face with these heights, each with whether the material (`s <= 0`) is on its left:
/// the cases of the truncated volume.
pub(crate) fn pieces(s: &[f64; 4]) -> [Option<(Piece, bool)>; 2] {
    let mask = s.iter().enumerate().fold(0_usize, |mask, (i, &s)| mask | (usize::from(s <= 0.0) << i));
    let inside = mask.trailing_zeros() as usize;
    match mask.count_ones() {
        1 => [Some((Piece::Corner(inside), true)), None],
        3 => [Some((Piece::Corner((!mask).trailing_zeros() as usize), false)), None],
        2 if mask == 0b1001 => [Some((Piece::Strip(3), true)), None],
        2 if mask != 0b0101 && mask != 0b1010 => [Some((Piece::Strip(inside), true)), None],
        2 => {
            let across = s[inside] * s[inside + 2] > s[inside + 1] * s[(inside + 3) & 3];
            let first = if across { inside + 1 } else { inside };
            [first, first + 2].map(|i| Some((Piece::Corner(i & 3), !across)))
        }
        _ => [None, None],
    }
}

/// A face in canonical order, with the heights of its corners over the plane.
struct Face {
    x: [Vector3; 4],
    s: [f64; 4],
}

impl Face {
    /// The points of a piece, from start to end.
    fn points(&self, piece: Piece) -> Vec<Vector3> {
        let curve = Curve::new(self, piece);
        let diagonal = (self.x[2] - self.x[0]).norm().max((self.x[3] - self.x[1]).norm());
        let chord = curve.end - curve.start;
        let middle = curve.point(0.5) - curve.start;
        let along = if chord.norm() > 0.0 { chord.normalize() } else { chord };
        let distance = (middle - along * along.dot(&middle)).norm();
        let chords = (distance / (SECTION_CHORD * diagonal)).sqrt().ceil();
        // Not a number only where coordinates overflow; one chord then.
        let chords = if chords >= 1.0 { chords.min(SECTION_CHORDS as f64) } else { 1.0 } as usize;
        let mut points = vec![curve.start];
        points.extend((1..chords).rev().map(|i| curve.point(i as f64 / chords as f64)));
        points.push(curve.end);
        points
    }

    fn crossing(&self, i: usize, j: usize) -> Vector3 {
        crossing([&self.x[i], &self.x[j]], [self.s[i], self.s[j]])
    }
}

/// A piece as a curve in space.
struct Curve {
    /// The face's corners, counted from the piece's own.
    x: [Vector3; 4],
    start: Vector3,
    end: Vector3,
    /// `alpha = a u`.
    a: f64,
    /// `beta = b0 + b1 v`.
    b: [f64; 2],
    /// `sqrt(1 + w)`.
    q: f64,
}

impl Curve {
    fn new(face: &Face, piece: Piece) -> Self {
        let (Piece::Corner(first) | Piece::Strip(first)) = piece;
        let corner: [usize; 4] = std::array::from_fn(|i| (first + i) & 3);
        let x = corner.map(|i| face.x[i]);
        let [s1, s2, s3, s4] = corner.map(|i| face.s[i]);
        let end = face.crossing(corner[0], corner[3]);
        // Quotients first: products of small heights would underflow.
        match piece {
            Piece::Corner(_) => {
                let (to2, to4) = (s2 - s1, s4 - s1);
                let ratio = (s2 / to2) * (s4 / to4) - (s1 / to2) * (s3 / to4);
                let start = face.crossing(corner[0], corner[1]);
                Self { x, start, end, a: -s1 / to2, b: [0.0, -s1 / to4], q: ratio.max(0.0).sqrt() }
            }
            Piece::Strip(_) => {
                let (to3, to4) = (s3 - s2, s4 - s1);
                let (left, right) = (-s1 / to4, -s2 / to3);
                let start = face.crossing(corner[1], corner[2]);
                Self { x, start, end, a: 1.0, b: [right, left - right], q: (to3 / to4).sqrt() }
            }
        }
    }

    /// The point at `0 < t < 1`: the end, where `u = 0`, is at `t = 0`, and the start at `t = 1`.
    fn point(&self, t: f64) -> Vector3 {
        let alpha = self.a * (t / (t + (1.0 - t) * self.q));
        let beta = self.b[0] + self.b[1] * ((1.0 - t) / ((1.0 - t) + t * self.q));
        let [x1, x2, x3, x4] = &self.x;
        let (near, far) = (x1 + (x2 - x1) * alpha, x4 + (x3 - x4) * alpha);
        near + (far - near) * beta
    }
}

/// Each segment has the material on its left: turned by -90 degrees its direction is the outward normal, as on the
/// counter-clockwise boundary of the material. A quadrilateral that is not convex may have two.
pub(crate) fn of_quad(nodes: &[Vector<2>; 4], half_space: &HalfSpace<2>) -> Vec<Vec<Vector<2>>> {
    let heights = nodes.map(|x| half_space.height(&x));
    let along = Vector::<2>::new(-half_space.normal[1], half_space.normal[0]);
    let mut points = Vec::with_capacity(Quad::FACES);
    for face in Quad::FACE_NODES {
        let (a, b) = (face[0], face[1]);
        if (heights[a] <= 0.0) != (heights[b] <= 0.0) {
            points.push(crossing([&nodes[a], &nodes[b]], [heights[a], heights[b]]));
        }
    }
    points.sort_by(|a, b| along.dot(&(a - nodes[0])).total_cmp(&along.dot(&(b - nodes[0]))));
    points.chunks_exact(2).filter(|ends| ends[0] != ends[1]).map(<[_]>::to_vec).collect()
}
