//! The hexahedron as a polyhedron of planar triangles: what other codes make of ruled faces.
//!
//! Each face becomes two triangles, or four about the mean of its nodes. For planar triangles with area vectors `a`
//! and any point `p` on the plane the divergence theorem gives, with the part `phi` of each triangle below the
//! plane,
//!
//! ```text
//! 3 V = sum over triangles of phi (x1 - p).a,   A = - n . sum phi a
//! phi = s1^2 / ((s1 - s2)(s1 - s3))   for one corner below the plane; one minus that for two
//! ```
//!
//! **What to expect.** Four triangles a face enclose exactly the volume of the ruled cell, since all of them have
//! the middle `x0` of the face as a corner, and `sum phi x0.a` is the `x0.k / 2` of Eq. 22; truncated volumes are
//! wrong by 8e-4 cell volumes (rms; largest 5e-3) on unit cubes whose nodes are moved by up to 0.15. Two triangles
//! miss the ruled face by half the tetrahedron of its nodes, and the whole cell by 4e-2 (rms). Both are exact for
//! planar faces, and cells of a mesh fit together: the diagonal of a face runs from the corner with the lowest local
//! coordinates to that with the highest, the same one for both cells of a structured mesh.

use crate::cell::{Cell, Truncation};
use crate::parallelepiped::UnitCube;
use crate::plane_constant::{self, Monotone, PlaneConstant, PositionError, PositionMethod};
use crate::root::Value;
use crate::{HalfSpace, Hexahedron, Vector};

type Vector3 = Vector<3>;

/// What a ruled face is replaced by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Triangulation {
    /// Two triangles along a diagonal.
    TwoPerFace,
    /// Four triangles about the mean of the nodes.
    FourPerFace,
}

impl Triangulation {
    /// Corners of the triangles, outward: nodes 0 to 7, then the middle of each face.
    fn triangles(self) -> &'static [[usize; 3]] {
        match self {
            Self::TwoPerFace => &TWO_PER_FACE,
            Self::FourPerFace => &FOUR_PER_FACE,
        }
    }
}

const FACES: &[&[usize]] = <Hexahedron as Cell<3>>::FACE_NODES;

const TWO_PER_FACE: [[usize; 3]; 12] = {
    let offsets = <Hexahedron as Cell<3>>::OFFSETS;
    let mut triangles = [[0; 3]; 12];
    let mut face = 0;
    while face < 6 {
        // The corner of the face with the lowest coordinates.
        let (mut first, mut i) = (0, 1);
        while i < 4 {
            let (a, b) = (offsets[FACES[face][i]], offsets[FACES[face][first]]);
            if a[0] + a[1] + a[2] < b[0] + b[1] + b[2] {
                first = i;
            }
            i += 1;
        }
        let mut half = 0;
        while half < 2 {
            let (second, third) = ((first + 1 + half) % 4, (first + 2 + half) % 4);
            triangles[2 * face + half] = [FACES[face][first], FACES[face][second], FACES[face][third]];
            half += 1;
        }
        face += 1;
    }
    triangles
};

const FOUR_PER_FACE: [[usize; 3]; 24] = {
    let mut triangles = [[0; 3]; 24];
    let mut i = 0;
    while i < 24 {
        let (face, edge) = (i / 4, i % 4);
        triangles[i] = [8 + face, FACES[face][edge], FACES[face][(edge + 1) % 4]];
        i += 1;
    }
    triangles
};

/// Nodes, then middles of the faces.
const POINTS: usize = 14;

/// The corners of all triangles.
fn with_middles(nodes: &[Vector3; 8]) -> [Vector3; POINTS] {
    std::array::from_fn(|i| match i {
        0..8 => nodes[i],
        _ => 0.25 * FACES[i - 8].iter().map(|&node| nodes[node]).sum::<Vector3>(),
    })
}

/// The volume of the polyhedron.
pub fn volume(cell: &Hexahedron, triangulation: Triangulation) -> f64 {
    cell.frame_determinant() * Polyhedron::new(cell, triangulation).volume
}

/// What a plane leaves of the polyhedron.
pub fn truncate(cell: &Hexahedron, half_space: &HalfSpace<3>, triangulation: Triangulation) -> Truncation {
    let direction = cell.direction(&half_space.normal);
    let polyhedron = Polyhedron::new(cell, triangulation);
    let Value { value, derivative, .. } =
        polyhedron.along(&direction.m).below(direction.level(half_space.constant));
    Truncation {
        volume: cell.frame_determinant() * value,
        section_area: cell.frame_determinant() * (derivative * direction.per_size),
    }
}

/// The plane constant for which [`truncate`] gives `fraction` of the polyhedron's [`volume`]: its inverse.
///
/// By Newton's method inside a bracket, with the section as derivative, from the closed form of the cell without
/// its twists.
///
/// # Errors
/// Those of [`Cell::plane_constant`].
pub fn plane_constant(
    cell: &Hexahedron,
    normal: &Vector3,
    fraction: f64,
    triangulation: Triangulation,
) -> Result<PlaneConstant, PositionError> {
    let polyhedron = Polyhedron::new(cell, triangulation);
    plane_constant::check(normal.as_slice(), fraction, cell.frame_determinant() * polyhedron.volume)?;
    plane_constant::from_smaller_part(fraction, |sign, fraction| {
        let direction = cell.direction(&(normal * sign));
        let cube = UnitCube::new(direction.m.as_slice());
        let mut along = Positioned { along: polyhedron.along(&direction.m), cube };
        let found = plane_constant::find(&mut along, fraction, PositionMethod::Newton)?;
        Ok(found.plane(&direction, along.along.low, sign))
    })
}

/// The triangles of a cell.
struct Polyhedron {
    points: [Vector3; POINTS],
    triangles: &'static [[usize; 3]],
    volume: f64,
}

impl Polyhedron {
    fn new(cell: &Hexahedron, triangulation: Triangulation) -> Self {
        let points = with_middles(cell.local());
        let triangles = triangulation.triangles();
        let six_times = triangles.iter().map(|&[a, b, c]| points[a].dot(&points[b].cross(&points[c])));
        Self { points, triangles, volume: six_times.sum::<f64>() / 6.0 }
    }

    fn along(&self, m: &Vector3) -> Along<'_> {
        let heights = self.points.map(|x| m.dot(&x));
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        Along { polyhedron: self, m: *m, heights, low }
    }
}

/// A polyhedron along one normal.
struct Along<'a> {
    polyhedron: &'a Polyhedron,
    m: Vector3,
    heights: [f64; POINTS],
    low: f64,
}

impl Along<'_> {
    /// The volume where `m.y` is not above the level, and its derivative.
    fn below(&self, level: f64) -> Value {
        let s = self.heights.map(|h| h - level);
        let total = self.polyhedron.volume;
        match s[..8].iter().filter(|&&s| s <= 0.0).count() {
            0 => Value::default(),
            8 => Value { value: total, ..Value::default() },
            1..=4 => self.part(&s, 1.0),
            _ => {
                // The smaller part keeps its relative accuracy.
                let above = self.part(&s.map(|s| -s), -1.0);
                Value { value: total - above.value, ..above }
            }
        }
    }

    /// Volume and its derivative where the heights `s` over a plane with normal `sign m` are not positive.
    fn part(&self, s: &[f64; POINTS], sign: f64) -> Value {
        let x = &self.polyhedron.points;
        let lowest = (1..8).fold(0, |best, i| if s[i] < s[best] { i } else { best });
        let m2 = self.m.norm_squared();
        let p = x[lowest] - self.m * (sign * s[lowest] / m2);
        let (mut six_times, mut twice) = (0.0, Vector3::zeros());
        for &[a, b, c] in self.polyhedron.triangles {
            let below = part_below([s[a], s[b], s[c]]);
            if below > 0.0 {
                let area = (x[b] - x[a]).cross(&(x[c] - x[a])) * below;
                six_times += (x[a] - p).dot(&area);
                twice += area;
            }
        }
        Value { value: six_times / 6.0, derivative: -0.5 * sign * self.m.dot(&twice) / m2, second: 0.0 }
    }
}

/// The part of a triangle's area where the height is not positive.
fn part_below(s: [f64; 3]) -> f64 {
    let corner = |i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        (s[i] / (s[i] - s[j])) * (s[i] / (s[i] - s[k]))
    };
    match s.map(|s| s <= 0.0) {
        [false, false, false] => 0.0,
        [true, true, true] => 1.0,
        [true, false, false] => corner(0),
        [false, true, false] => corner(1),
        [false, false, true] => corner(2),
        [false, true, true] => 1.0 - corner(0),
        [true, false, true] => 1.0 - corner(1),
        [true, true, false] => 1.0 - corner(2),
    }
}

/// A polyhedron along one normal, with the cell without its twists as a first guess.
struct Positioned<'a> {
    along: Along<'a>,
    cube: UnitCube,
}

impl Monotone for Positioned<'_> {
    fn span(&self) -> f64 {
        self.along.heights.iter().copied().fold(f64::NEG_INFINITY, f64::max) - self.along.low
    }

    fn total(&self) -> f64 {
        self.along.polyhedron.volume
    }

    fn volume(&mut self, depth: f64) -> Value {
        self.along.below(self.along.low + depth)
    }

    fn start(&self, fraction: f64) -> f64 {
        self.cube.position(fraction) * (self.span() / self.cube.span())
    }

    fn closed_form(&mut self, _: f64) -> Option<(f64, usize)> {
        None
    }
}
