//! The polyhedron: edges between shared corners, each with the face on either side.

use super::{Full, Heights, Moments, Region, Side};
use crate::{Cell, HalfSpace, Hexahedron, Vector};

type Vector3 = Vector<3>;

/// Corners that a polyhedron has room for. A cell's pre-image has 14; what a cell of the mesh and a plane leave of it seldom
/// more than 30. Each is a bit of a `u64`.
const POINTS: usize = 64;

/// Edges. A pre-image has 36.
const EDGES: usize = 128;

/// Numbers of faces. A pre-image has 24, and each cut adds one.
const FACES: usize = 64;

/// A polyhedron with plane faces.
///
/// A face is known by its edges alone: those that have it on one of their sides, in any order, of which it may take several loops.
/// Each edge has two faces, which run along it in opposite directions, or enclosed volumes would depend on the origin. A corner
/// keeps its number through cuts, and new ones get the numbers of those that were cut off, so that edges that a plane
/// does not meet are copied as they are.
#[derive(Clone, Debug)]
pub struct Polyhedron {
    points: [Vector3; POINTS],
    /// Which of the points are corners, as bits.
    corners: u64,
    edges: [Edge; EDGES],
    edge_count: usize,
    /// Numbers that faces have had.
    face_count: usize,
}

/// An edge.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u8; 2],
    /// The face that runs along it from the first end to the second, counter-clockwise seen from outside, then the one that runs back.
    faces: [u8; 2],
}

impl Edge {
    fn reversed(self) -> Self {
        let ([a, b], [left, right]) = (self.ends, self.faces);
        Self { ends: [b, a], faces: [right, left] }
    }
}

const NO_EDGE: Edge = Edge { ends: [0; 2], faces: [0; 2] };

/// The corners of a tetrahedron's faces, outward where the last corner lies on the side of the normal of the first three.
const TETRAHEDRON: [Edge; 6] = edges_between(&[[1, 2, 3], [0, 2, 1], [0, 3, 2], [0, 1, 3]]);

/// The triangles of [`Region::fans`]: nodes 0 to 7, then the middles of the faces.
const FANS: [Edge; 36] = {
    let faces = <Hexahedron as Cell<3>>::FACE_NODES;
    let mut triangles = [[0; 3]; 24];
    let mut i = 0;
    while i < 24 {
        let (face, edge) = (i / 4, i % 4);
        triangles[i] = [8 + face as u8, faces[face][edge] as u8, faces[face][(edge + 1) % 4] as u8];
        i += 1;
    }
    edges_between(&triangles)
};

/// The edges of a closed surface of triangles.
const fn edges_between<const N: usize>(triangles: &[[u8; 3]]) -> [Edge; N] {
    let mut edges = [NO_EDGE; N];
    let (mut count, mut i) = (0, 0);
    while i < 9 * triangles.len() * triangles.len() {
        let [there, back] = [i / (3 * triangles.len()), i % (3 * triangles.len())];
        let ([left, from], [right, to]) = ([there / 3, there % 3], [back / 3, back % 3]);
        let ends = [triangles[left][from], triangles[left][(from + 1) % 3]];
        if ends[0] < ends[1] && triangles[right][to] == ends[1] && triangles[right][(to + 1) % 3] == ends[0] {
            edges[count] = Edge { ends, faces: [left as u8, right as u8] };
            count += 1;
        }
        i += 1;
    }
    assert!(count == N, "each edge has two triangles");
    edges
}

impl Polyhedron {
    /// The tetrahedron with these corners: positive where the last one lies on the side of the normal of the first three.
    pub fn tetrahedron(corners: [Vector3; 4]) -> Self {
        Self::with(&corners, &TETRAHEDRON, 4)
    }

    fn with(points: &[Vector3], edges: &[Edge], faces: usize) -> Self {
        let mut polyhedron = Self::empty();
        polyhedron.points[..points.len()].copy_from_slice(points);
        polyhedron.corners = (1 << points.len()) - 1;
        polyhedron.edges[..edges.len()].copy_from_slice(edges);
        (polyhedron.edge_count, polyhedron.face_count) = (edges.len(), faces);
        polyhedron
    }

    /// The points up to the last corner.
    fn numbered(&self) -> &[Vector3] {
        &self.points[..POINTS - self.corners.leading_zeros() as usize]
    }

    fn edges(&self) -> &[Edge] {
        &self.edges[..self.edge_count]
    }

    /// A corner of each face.
    #[inline(always)]
    fn apices(&self) -> [u8; FACES] {
        let mut apices = [0; FACES];
        for edge in self.edges() {
            for face in edge.faces {
                apices[usize::from(face) % FACES] = edge.ends[0];
            }
        }
        apices
    }

    /// Calls with the corners of the triangles that the faces are made of: a face's own corner and each of its edges.
    fn triangles(&self, mut visit: impl FnMut([u8; 3])) {
        let apices = self.apices();
        for &Edge { ends: [a, b], faces } in self.edges() {
            for (face, [a, b]) in faces.into_iter().zip([[a, b], [b, a]]) {
                let apex = apices[usize::from(face) % FACES];
                if a != apex && b != apex {
                    visit([apex, a, b]);
                }
            }
        }
    }

    /// A corner, as the origin of sums; any where there is none.
    fn origin(&self) -> Vector3 {
        self.points[self.corners.trailing_zeros() as usize % POINTS]
    }

    fn push(&mut self, edge: Edge) -> Result<(), Full> {
        *self.edges.get_mut(self.edge_count).ok_or(Full)? = edge;
        self.edge_count += 1;
        Ok(())
    }

    #[inline(always)]
    fn heights(&self, half_space: &HalfSpace<3>) -> Heights<POINTS> {
        Heights::new(self.numbered(), self.corners, half_space)
    }

    fn part(&self, heights: &Heights<POINTS>, below: bool, part: &mut Self) -> Result<(), Full> {
        let kept = if below { heights.below } else { !heights.below } & self.corners;
        let is_kept = |i: u8| kept >> (i & 63) & 1 == 1;
        let numbered = self.numbered();
        part.points[..numbered.len()].copy_from_slice(numbered);
        // Without branches: which edges are kept cannot be foretold.
        let mut crossing = [NO_EDGE; POINTS];
        let (mut inner, mut across) = (0, 0);
        for &edge in self.edges() {
            let [a, b] = edge.ends.map(is_kept);
            part.edges[inner % EDGES] = edge;
            crossing[across % POINTS] = edge;
            inner += usize::from(a & b);
            across += usize::from(a ^ b);
        }
        let cap = self.face_count;
        if across >= POINTS || cap >= FACES {
            return Err(Full);
        }
        (part.corners, part.edge_count, part.face_count) = (kept, inner, cap + 1);
        // By face: the last corner at which it comes back; by corner: the one before that.
        let (mut last, mut before) = ([0_u8; FACES], [0_u8; POINTS]);
        let mut out = [(0_u8, 0_u8); POINTS];
        for (&edge, out) in crossing[..across].iter().zip(&mut out) {
            let Edge { ends: [end, other], faces: [leaving, returning] } =
                if is_kept(edge.ends[0]) { edge } else { edge.reversed() };
            let number = (!part.corners).trailing_zeros() as u8;
            if usize::from(number) >= POINTS {
                return Err(Full);
            }
            let (lower, upper) = if below { (end, other) } else { (other, end) };
            part.points[usize::from(number)] =
                heights.crossing(&self.points, usize::from(lower) % POINTS, usize::from(upper) % POINTS);
            part.corners |= 1 << number;
            part.push(Edge { ends: [end, number], faces: [leaving, returning] })?;
            let last = &mut last[usize::from(returning) % FACES];
            before[usize::from(number)] = *last;
            (*last, *out) = (number, (number, leaving));
        }
        for &(number, face) in &out[..across] {
            let last = &mut last[usize::from(face) % FACES];
            let back = *last;
            *last = before[usize::from(back) % POINTS];
            if back != number {
                part.push(Edge { ends: [number, back], faces: [face, cap as u8] })?;
            }
        }
        Ok(())
    }
}

impl Region<3> for Polyhedron {
    fn empty() -> Self {
        Self {
            points: [Vector3::new(0.0, 0.0, 0.0); POINTS],
            corners: 0,
            edges: [NO_EDGE; EDGES],
            edge_count: 0,
            face_count: 0,
        }
    }

    fn fans(nodes: &[Vector3], middles: &[Vector3]) -> Self {
        assert!(nodes.len() == 8 && middles.len() == 6, "a hexahedron has eight nodes and six faces");
        let points: [Vector3; 14] = std::array::from_fn(|i| if i < 8 { nodes[i] } else { middles[i - 8] });
        Self::with(&points, &FANS, 24)
    }

    fn corners(&self) -> impl Iterator<Item = &Vector3> {
        let is_corner = |(i, _): &(usize, &Vector3)| self.corners >> *i & 1 == 1;
        self.numbered().iter().enumerate().filter(is_corner).map(|(_, x)| x)
    }

    fn translate(&mut self, shift: &Vector3) {
        self.points.iter_mut().for_each(|x| *x += shift);
    }

    fn volume(&self) -> f64 {
        let (origin, apices) = (self.origin(), self.apices());
        let at = |i: u8| &self.points[usize::from(i) % POINTS];
        let mut sum = 0.0;
        // The tetrahedra from the origin to the triangles that the faces are made of, on either side of each edge.
        for &Edge { ends: [a, b], faces } in self.edges() {
            let [left, right] = faces.map(|face| at(apices[usize::from(face) % FACES]));
            sum += (left - right).dot(&(at(a) - origin).cross(&(at(b) - origin)));
        }
        sum / 6.0
    }

    fn moments(&self) -> Moments<3> {
        let origin = self.origin();
        let mut first = Vector3::zeros();
        self.triangles(|triangle| {
            let [a, b, c] = triangle.map(|i| self.points[usize::from(i) % POINTS] - origin);
            first += (a + b + c) * a.dot(&b.cross(&c));
        });
        let volume = self.volume();
        Moments { volume, first: first / 24.0 + origin * volume }
    }

    fn side(&self, half_space: &HalfSpace<3>) -> Side {
        self.heights(half_space).side
    }

    fn cut(&self, half_space: &HalfSpace<3>, below: &mut Self) -> Result<Side, Full> {
        let heights = self.heights(half_space);
        if heights.side == Side::Across {
            self.part(&heights, true, below)?;
        }
        Ok(heights.side)
    }

    fn split(&self, half_space: &HalfSpace<3>, below: &mut Self, above: &mut Self) -> Result<Side, Full> {
        let heights = self.heights(half_space);
        if heights.side == Side::Across {
            self.part(&heights, true, below)?;
            self.part(&heights, false, above)?;
        }
        Ok(heights.side)
    }

    fn is_seen_from(&self, point: &Vector3) -> bool {
        let mut is_seen = true;
        self.triangles(|triangle| {
            let [a, b, c] = triangle.map(|i| self.points[usize::from(i)] - point);
            is_seen &= a.dot(&b.cross(&c)) >= 0.0;
        });
        is_seen
    }

    fn simplices(&self, visit: &mut dyn FnMut(&Self)) {
        let first = self.origin();
        self.triangles(|triangle| {
            let [a, b, c] = triangle.map(|i| self.points[usize::from(i)]);
            visit(&Self::tetrahedron([first, a, b, c]));
        });
    }
}
