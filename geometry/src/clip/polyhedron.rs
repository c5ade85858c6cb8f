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
/// several loops.
#[derive(Clone, Debug)]
pub struct Polyhedron {
    points: [Vector3; POINTS],
    point_count: usize,
    edges: [[u8; 2]; EDGES],
    edge_count: usize,
    /// Where the edges of each face end.
    ends: [u16; FACES],
    face_count: usize,
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
        polyhedron.point_count = points.len();
        for (face, &[a, b, c]) in triangles.iter().enumerate() {
            polyhedron.edges[3 * face..3 * face + 3].copy_from_slice(&[[a, b], [b, c], [c, a]]);
            polyhedron.ends[face] = 3 * face as u16 + 3;
        }
        polyhedron.edge_count = 3 * triangles.len();
        polyhedron.face_count = triangles.len();
        polyhedron
    }

    /// The edges of each face.
    fn faces(&self) -> impl Iterator<Item = &[[u8; 2]]> {
        let mut start = 0;
        self.ends[..self.face_count].iter().map(move |&end| {
            let face = &self.edges[start..end as usize];
            start = end as usize;
            face
        })
    }

    /// The triangles that each face is made of: its own first corner and each of its edges.
    fn triangles(&self) -> impl Iterator<Item = [u8; 3]> {
        self.faces().flat_map(|face| {
            let apex = face[0][0];
            face.iter().filter(move |edge| !edge.contains(&apex)).map(move |&[a, b]| [apex, a, b])
        })
    }

    /// The corners of these triangles relative to the first corner of all, with six times the volume between.
    fn tetrahedra(&self) -> impl Iterator<Item = (f64, [Vector3; 3])> {
        let first = self.points[0];
        self.triangles().map(move |triangle| {
            let [a, b, c] = triangle.map(|i| self.points[usize::from(i)] - first);
            (a.dot(&b.cross(&c)), [a, b, c])
        })
    }

    fn push(&mut self, edge: [u8; 2]) -> Result<(), Full> {
        *self.edges.get_mut(self.edge_count).ok_or(Full)? = edge;
        self.edge_count += 1;
        Ok(())
    }

    fn close_face(&mut self) -> Result<(), Full> {
        let start = self.face_count.checked_sub(1).map_or(0, |last| usize::from(self.ends[last]));
        if self.edge_count > start {
            *self.ends.get_mut(self.face_count).ok_or(Full)? = self.edge_count as u16;
            self.face_count += 1;
        }
        Ok(())
    }

    fn part(&self, heights: &Heights<POINTS>, below: bool, part: &mut Self) -> Result<(), Full> {
        (part.point_count, part.edge_count, part.face_count) = (0, 0, 0);
        let kept = |i: u8| heights.is_below(usize::from(i)) == below;
        let mut renumbered = [0_u8; POINTS];
        for (i, x) in self.points().iter().enumerate() {
            if kept(i as u8) {
                renumbered[i] = part.point_count as u8;
                part.points[part.point_count] = *x;
                part.point_count += 1;
            }
        }
        let renumbered = |i: u8| renumbered[usize::from(i)];
        let mut crossings = Crossings { edges: [[0; 2]; POINTS], first: part.point_count };
        let mut cap = List::<EDGES>::default();
        for face in self.faces() {
            let (mut out, mut back) = (List::<GAPS>::default(), List::<GAPS>::default());
            for &[a, b] in face {
                match (kept(a), kept(b)) {
                    (true, true) => part.push([renumbered(a), renumbered(b)])?,
                    (true, false) => {
                        let gap = crossings.find(self, heights, [a, b], part)?;
                        part.push([renumbered(a), gap])?;
                        out.push(gap)?;
                    }
                    (false, true) => {
                        let gap = crossings.find(self, heights, [b, a], part)?;
                        part.push([gap, renumbered(b)])?;
                        back.push(gap)?;
                    }
                    (false, false) => {}
                }
            }
            for (&out, &back) in out.iter().zip(back.iter()) {
                if out != back {
                    part.push([out, back])?;
                    cap.push(back)?;
                    cap.push(out)?;
                }
            }
            part.close_face()?;
        }
        cap.iter().as_slice().chunks_exact(2).try_for_each(|edge| part.push([edge[0], edge[1]]))?;
        part.close_face()
    }
}

/// The corners that a cut makes, each on the edge that it lies on: from the corner that is kept to the other.
struct Crossings {
    edges: [[u8; 2]; POINTS],
    /// Their first number in the part.
    first: usize,
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
        let known = part.point_count - self.first;
        if let Some(place) = self.edges[..known].iter().position(|other| *other == edge) {
            return Ok((self.first + place) as u8);
        }
        let [kept, other] = edge.map(usize::from);
        let (lower, upper) = if heights.is_below(kept) { (kept, other) } else { (other, kept) };
        *part.points.get_mut(part.point_count).ok_or(Full)? = heights.crossing(&whole.points, lower, upper);
        self.edges[known] = edge;
        part.point_count += 1;
        Ok(part.point_count as u8 - 1)
    }
}

/// A short list of corners.
struct List<const N: usize> {
    items: [u8; N],
    count: usize,
}

impl<const N: usize> Default for List<N> {
    fn default() -> Self {
        Self { items: [0; N], count: 0 }
    }
}

impl<const N: usize> List<N> {
    fn push(&mut self, item: u8) -> Result<(), Full> {
        *self.items.get_mut(self.count).ok_or(Full)? = item;
        self.count += 1;
        Ok(())
    }

    fn iter(&self) -> std::slice::Iter<'_, u8> {
        self.items[..self.count].iter()
    }
}

impl Region<3> for Polyhedron {
    fn empty() -> Self {
        Self {
            points: [Vector3::new(0.0, 0.0, 0.0); POINTS],
            point_count: 0,
            edges: [[0; 2]; EDGES],
            edge_count: 0,
            ends: [0; FACES],
            face_count: 0,
        }
    }

    fn fans(nodes: &[Vector3], middles: &[Vector3]) -> Self {
        assert!(nodes.len() == 8 && middles.len() == 6, "a hexahedron has eight nodes and six faces");
        let points: [Vector3; 14] = std::array::from_fn(|i| if i < 8 { nodes[i] } else { middles[i - 8] });
        Self::triangulated(&points, &FANS)
    }

    fn points(&self) -> &[Vector3] {
        &self.points[..self.point_count]
    }

    fn translate(&mut self, shift: &Vector3) {
        self.points[..self.point_count].iter_mut().for_each(|x| *x += shift);
    }

    fn volume(&self) -> f64 {
        self.tetrahedra().map(|(six_times, _)| six_times).sum::<f64>() / 6.0
    }

    fn moments(&self) -> Moments<3> {
        let (mut sum, mut first) = (0.0, Vector3::zeros());
        for (six_times, [a, b, c]) in self.tetrahedra() {
            sum += six_times;
            first += (a + b + c) * (six_times / 24.0);
        }
        let volume = sum / 6.0;
        Moments { volume, first: first + self.points[0] * volume }
    }

    fn cut(&self, half_space: &HalfSpace<3>, below: &mut Self) -> Result<Side, Full> {
        let heights = Heights::new(self.points(), half_space);
        if heights.side == Side::Across {
            self.part(&heights, true, below)?;
        }
        Ok(heights.side)
    }

    fn split(&self, half_space: &HalfSpace<3>, below: &mut Self, above: &mut Self) -> Result<Side, Full> {
        let heights = Heights::new(self.points(), half_space);
        if heights.side == Side::Across {
            self.part(&heights, true, below)?;
            self.part(&heights, false, above)?;
        }
        Ok(heights.side)
    }

    fn is_seen_from(&self, point: &Vector3) -> bool {
        self.triangles().all(|triangle| {
            let [a, b, c] = triangle.map(|i| self.points[usize::from(i)] - point);
            a.dot(&b.cross(&c)) >= 0.0
        })
    }

    fn simplices(&self, visit: &mut dyn FnMut(&Self)) {
        let first = self.points[0];
        for triangle in self.triangles() {
            let [a, b, c] = triangle.map(|i| self.points[usize::from(i)]);
            visit(&Self::tetrahedron([first, a, b, c]));
        }
    }
}
