//! The polyhedron: plane faces, each a set of directed edges between shared corners.

use super::{Full, Heights, Moments, Region, Side};
use crate::{Cell, HalfSpace, Hexahedron, Vector};

type Vector3 = Vector<3>;

/// Corners that a polyhedron has room for. A cell's pre-image has 14; what a cell of the mesh and a plane leave of it seldom
/// more than 30. Each is a bit of a `u64`.
const POINTS: usize = 64;

/// Directed edges: two for each edge. A pre-image has 72.
const EDGES: usize = 256;

/// Faces. A pre-image has 24, and each cut adds one.
const FACES: usize = 48;

/// Ways out of the half-space along one face, or ways in: one on a convex face.
const GAPS: usize = 16;

/// A polyhedron with plane faces.
///
/// Every directed edge of a face is met by one of another face that runs the other way, or enclosed volumes would
/// depend on the origin. The edges of a face are counter-clockwise seen from outside; they come in any order, and may make up
/// several loops. A corner keeps its number through cuts, and new ones get the numbers of those that were cut off, so that
/// faces that a plane does not meet are copied as they are.
#[derive(Clone, Debug)]
pub struct Polyhedron {
    points: [Vector3; POINTS],
    /// Which of the points are corners, as bits.
    corners: u64,
    edges: [[u8; 2]; EDGES],
    edge_count: usize,
    faces: [Face; FACES],
    face_count: usize,
}

/// A plane face.
#[derive(Clone, Copy, Debug)]
struct Face {
    /// Where its edges end; they start where those of the face before it end.
    end: u16,
    /// Its corners, as bits.
    corners: u64,
}

/// The corners of a tetrahedron's faces, outward where the last corner lies on the side of the normal of the first three.
const TETRAHEDRON: [[u8; 3]; 4] = [[1, 2, 3], [0, 2, 1], [0, 3, 2], [0, 1, 3]];

/// The triangles of [`Region::fans`]: nodes 0 to 7, then the middles of the faces.
const FANS: [[u8; 3]; 24] = {
    let faces = <Hexahedron as Cell<3>>::FACE_NODES;
    let mut triangles = [[0; 3]; 24];
    let mut i = 0;
    while i < 24 {
        let (face, edge) = (i / 4, i % 4);
        triangles[i] = [8 + face as u8, faces[face][edge] as u8, faces[face][(edge + 1) % 4] as u8];
        i += 1;
    }
    triangles
};

impl Polyhedron {
    /// The tetrahedron with these corners: positive where the last one lies on the side of the normal of the first three.
    pub fn tetrahedron(corners: [Vector3; 4]) -> Self {
        Self::triangulated(&corners, &TETRAHEDRON)
    }

    fn triangulated(points: &[Vector3], triangles: &[[u8; 3]]) -> Self {
        let mut polyhedron = Self::empty();
        polyhedron.points[..points.len()].copy_from_slice(points);
        polyhedron.corners = (1 << points.len()) - 1;
        for (i, &[a, b, c]) in triangles.iter().enumerate() {
            polyhedron.edges[3 * i..3 * i + 3].copy_from_slice(&[[a, b], [b, c], [c, a]]);
            polyhedron.faces[i] = Face { end: 3 * i as u16 + 3, corners: bit(a) | bit(b) | bit(c) };
        }
        polyhedron.edge_count = 3 * triangles.len();
        polyhedron.face_count = triangles.len();
        polyhedron
    }

    /// The points up to the last corner.
    fn numbered(&self) -> &[Vector3] {
        &self.points[..POINTS - self.corners.leading_zeros() as usize]
    }

    /// Calls with the corners of the triangles that the faces are made of: a face's own first corner and each of its edges.
    #[inline(always)]
    fn triangles(&self, mut visit: impl FnMut([u8; 3])) {
        let mut start = 0;
        for face in &self.faces[..self.face_count] {
            let end = usize::from(face.end);
            let edges = &self.edges[start..end];
            start = end;
            let Some(&[apex, _]) = edges.first() else { continue };
            for &[a, b] in &edges[1..] {
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

    /// The corners of these triangles relative to the origin, with six times the volume between.
    #[inline(always)]
    fn tetrahedra(&self, mut visit: impl FnMut(f64, [Vector3; 3])) {
        let origin = self.origin();
        let at = |i: u8| self.points[usize::from(i) % POINTS] - origin;
        self.triangles(|[a, b, c]| {
            let corners = [at(a), at(b), at(c)];
            visit(corners[0].dot(&corners[1].cross(&corners[2])), corners);
        });
    }

    fn push(&mut self, edge: [u8; 2]) -> Result<(), Full> {
        *self.edges.get_mut(self.edge_count).ok_or(Full)? = edge;
        self.edge_count += 1;
        Ok(())
    }

    /// Ends a face that began with an edge.
    fn close_face(&mut self, first_edge: usize) -> Result<(), Full> {
        let edges = &self.edges[first_edge..self.edge_count];
        if edges.is_empty() {
            return Ok(());
        }
        // Each corner begins an edge.
        let corners = edges.iter().fold(0, |corners, &[a, _]| corners | bit(a));
        *self.faces.get_mut(self.face_count).ok_or(Full)? = Face { end: self.edge_count as u16, corners };
        self.face_count += 1;
        Ok(())
    }

    fn part(&self, heights: &Heights<POINTS>, below: bool, part: &mut Self) -> Result<(), Full> {
        let kept = if below { heights.below } else { !heights.below } & self.corners;
        let numbered = self.numbered();
        part.points[..numbered.len()].copy_from_slice(numbered);
        (part.corners, part.edge_count, part.face_count) = (kept, 0, 0);
        let is_kept = |i: u8| kept & bit(i) != 0;
        let mut crossings = Crossings { made: [0; POINTS], other: [0; POINTS] };
        let mut cap = List::<[u8; 2], POINTS>::new([0; 2]);
        let mut start = 0;
        for face in &self.faces[..self.face_count] {
            let edges = &self.edges[start..usize::from(face.end)];
            start = usize::from(face.end);
            let kept_here = face.corners & kept;
            if kept_here == 0 {
                continue;
            }
            let first_edge = part.edge_count;
            if kept_here == face.corners {
                let end = first_edge + edges.len();
                part.edges.get_mut(first_edge..end).ok_or(Full)?.copy_from_slice(edges);
                part.edge_count = end;
                *part.faces.get_mut(part.face_count).ok_or(Full)? = Face { end: end as u16, ..*face };
                part.face_count += 1;
                continue;
            }
            let (mut out, mut back) = (List::<u8, GAPS>::new(0), List::<u8, GAPS>::new(0));
            for &[a, b] in edges {
                match (is_kept(a), is_kept(b)) {
                    (true, true) => part.push([a, b])?,
                    (true, false) => {
                        let gap = crossings.find(self, heights, [a, b], part)?;
                        part.push([a, gap])?;
                        out.push(gap)?;
                    }
                    (false, true) => {
                        let gap = crossings.find(self, heights, [b, a], part)?;
                        part.push([gap, b])?;
                        back.push(gap)?;
                    }
                    (false, false) => {}
                }
            }
            for (&out, &back) in out.items().iter().zip(back.items()) {
                if out != back {
                    part.push([out, back])?;
                    cap.push([back, out])?;
                }
            }
            part.close_face(first_edge)?;
        }
        let first_edge = part.edge_count;
        cap.items().iter().try_for_each(|edge| part.push(*edge))?;
        part.close_face(first_edge)
    }
}

fn bit(i: u8) -> u64 {
    1_u64 << (i & 63)
}

/// The corners that a cut makes, each on the edge that it lies on: from the corner that is kept to the other.
struct Crossings {
    /// By corner that is kept: those made on its edges, as bits.
    made: [u64; POINTS],
    /// By corner made: the other end of its edge.
    other: [u8; POINTS],
}

impl Crossings {
    /// The number of the corner on an edge; makes it the first time.
    fn find(
        &mut self,
        whole: &Polyhedron,
        heights: &Heights<POINTS>,
        edge: [u8; 2],
        part: &mut Polyhedron,
    ) -> Result<u8, Full> {
        let [kept, other] = edge.map(|i| usize::from(i) % POINTS);
        let mut candidates = self.made[kept];
        while candidates != 0 {
            let number = candidates.trailing_zeros() as u8;
            if usize::from(self.other[usize::from(number) % POINTS]) == other {
                return Ok(number);
            }
            candidates &= candidates - 1;
        }
        let number = (!part.corners).trailing_zeros() as u8;
        if usize::from(number) >= POINTS {
            return Err(Full);
        }
        let (lower, upper) = if heights.is_below(kept) { (kept, other) } else { (other, kept) };
        part.points[usize::from(number)] = heights.crossing(&whole.points, lower, upper);
        part.corners |= bit(number);
        self.made[kept] |= bit(number);
        self.other[usize::from(number)] = other as u8;
        Ok(number)
    }
}

/// A short list.
struct List<T, const N: usize> {
    items: [T; N],
    count: usize,
}

impl<T: Copy, const N: usize> List<T, N> {
    fn new(nothing: T) -> Self {
        Self { items: [nothing; N], count: 0 }
    }

    fn push(&mut self, item: T) -> Result<(), Full> {
        *self.items.get_mut(self.count).ok_or(Full)? = item;
        self.count += 1;
        Ok(())
    }

    fn items(&self) -> &[T] {
        &self.items[..self.count]
    }
}

impl Region<3> for Polyhedron {
    fn empty() -> Self {
        Self {
            points: [Vector3::new(0.0, 0.0, 0.0); POINTS],
            corners: 0,
            edges: [[0; 2]; EDGES],
            edge_count: 0,
            faces: [Face { end: 0, corners: 0 }; FACES],
            face_count: 0,
        }
    }

    fn fans(nodes: &[Vector3], middles: &[Vector3]) -> Self {
        assert!(nodes.len() == 8 && middles.len() == 6, "a hexahedron has eight nodes and six faces");
        let points: [Vector3; 14] = std::array::from_fn(|i| if i < 8 { nodes[i] } else { middles[i - 8] });
        Self::triangulated(&points, &FANS)
    }

    fn corners(&self) -> impl Iterator<Item = &Vector3> {
        let is_corner = |(i, _): &(usize, &Vector3)| self.corners & bit(*i as u8) != 0;
        self.numbered().iter().enumerate().filter(is_corner).map(|(_, x)| x)
    }

    fn translate(&mut self, shift: &Vector3) {
        self.points.iter_mut().for_each(|x| *x += shift);
    }

    fn volume(&self) -> f64 {
        let mut sum = 0.0;
        self.tetrahedra(|six_times, _| sum += six_times);
        sum / 6.0
    }

    fn moments(&self) -> Moments<3> {
        let (mut sum, mut first) = (0.0, Vector3::zeros());
        self.tetrahedra(|six_times, [a, b, c]| {
            sum += six_times;
            first += (a + b + c) * (six_times / 24.0);
        });
        let volume = sum / 6.0;
        Moments { volume, first: first + self.origin() * volume }
    }

    fn cut(&self, half_space: &HalfSpace<3>, below: &mut Self) -> Result<Side, Full> {
        let heights = Heights::new(self.numbered(), self.corners, half_space);
        if heights.side == Side::Across {
            self.part(&heights, true, below)?;
        }
        Ok(heights.side)
    }

    fn split(&self, half_space: &HalfSpace<3>, below: &mut Self, above: &mut Self) -> Result<Side, Full> {
        let heights = Heights::new(self.numbered(), self.corners, half_space);
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
