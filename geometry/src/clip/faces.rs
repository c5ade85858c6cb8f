//! The faces of a hexahedron, each the fan of four triangles about the mean of its nodes, and what lies on either side of them.
//!
//! The planes through the centre of the cell and the edges of its faces divide space into six cones, one for each face. A [`Saddle`] takes
//! what a region has in its cone beyond the face from what it has in all; a [`Pyramid`] is what lies in its cone before it.

use super::tile::{mean_of, turned_to, under, within};
use super::{Full, Polyhedron, Region};
use crate::{Cell, HalfSpace, Hexahedron, Vector};

/// Room for what is left of a region, three times.
pub(super) type Rooms<'a> = [&'a mut [Polyhedron; 2]; 3];

/// The corners of a face, in outward order.
pub(super) fn corners(nodes: &[Vector<3>], face: usize) -> [&Vector<3>; 4] {
    [0, 1, 2, 3].map(|i| &nodes[Hexahedron::FACE_NODES[face][i]])
}

/// Twice the area vector of a face.
pub(super) fn area([a, b, c, d]: [&Vector<3>; 4]) -> Vector<3> {
    (c - a).cross(&(d - b))
}

/// A face whose fan has two opposite edges that are ridges and two that are valleys, as of every ruled face not too far from a
/// parallelogram. It covers what lies under both triangles at the one ridge or under both at the other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Saddle {
    /// All that lies beyond the fan, and as little as possible before it; then the planes through the centre and each edge.
    beyond: [HalfSpace<3>; 5],
    /// The triangles at each ridge.
    ridges: [[HalfSpace<3>; 2]; 2],
}

/// The part of a hexahedron between its centre and one face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pyramid {
    /// The planes through the centre and each edge of the face.
    sides: [HalfSpace<3>; 4],
    sectors: [Sector; 4],
    /// Whether the sides bound a convex cone and no sector is turned inside out.
    is_convex: bool,
}

/// The tetrahedron between the centre of the cell, the middle of a face, and one of the face's edges.
#[derive(Clone, Copy, Debug)]
struct Sector {
    /// The planes through the line from the centre to the middle and each end of the edge, and that of the triangle.
    half_spaces: [HalfSpace<3>; 3],
    /// 0 for none.
    sign: f64,
}

/// The half-spaces under the planes through the centre and each edge of a face, and whether they bound a convex cone.
fn cone(centre: &Vector<3>, corners: [&Vector<3>; 4]) -> ([HalfSpace<3>; 4], bool) {
    let sides: [HalfSpace<3>; 4] = std::array::from_fn(|i| under(centre, corners[(i + 1) % 4], corners[i]));
    let is_convex = (0..4).all(|i| [2, 3].iter().all(|k| sides[i].height(corners[(i + k) % 4]) <= 0.0));
    (sides, is_convex)
}

impl Pyramid {
    pub(super) fn new(centre: &Vector<3>, corners: [&Vector<3>; 4], negligible: f64) -> Self {
        let middle = &mean_of(corners.into_iter());
        let (sides, is_convex) = cone(centre, corners);
        let sectors: [Sector; 4] = std::array::from_fn(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            let outer = under(middle, a, b);
            let six_times = outer.height(centre);
            let half_spaces = [
                turned_to(under(centre, middle, a), b),
                turned_to(under(centre, middle, b), a),
                turned_to(outer, centre),
            ];
            let sign = if six_times.abs() > negligible { -six_times.signum() } else { 0.0 };
            Sector { half_spaces, sign }
        });
        let is_convex = is_convex && sectors.iter().all(|sector| sector.sign == 1.0);
        Self { sides: sides.map(|side| turned_to(side, middle)), sectors, is_convex }
    }

    pub(super) fn common(
        &self,
        region: &Polyhedron,
        [outer, inner, _]: &mut Rooms<'_>,
        visit: &mut impl FnMut(f64, &Polyhedron),
    ) -> Result<(), Full> {
        if !self.is_convex {
            for (sector, side) in self.sectors.iter().zip(&self.sides) {
                let [first, second, triangle] = sector.half_spaces;
                if sector.sign != 0.0
                    && let Some(part) = within(region, &[*side, first, second, triangle], outer)?
                {
                    visit(sector.sign, part);
                }
            }
            return Ok(());
        }
        let Some(cone) = within(region, &self.sides, outer)? else { return Ok(()) };
        let is_under = |sector: &Sector, x: &Vector<3>| sector.half_spaces[2].height(x) <= 0.0;
        if self.sectors.iter().all(|sector| cone.corners().all(|x| is_under(sector, x))) {
            visit(1.0, cone);
            return Ok(());
        }
        if self.sectors.iter().all(|sector| !cone.corners().any(|x| is_under(sector, x))) {
            return Ok(());
        }
        for sector in &self.sectors {
            if let Some(part) = within(cone, &sector.half_spaces, inner)? {
                visit(1.0, part);
            }
        }
        Ok(())
    }
}

impl Saddle {
    /// The face, if it is one and the centre of the cell sees all of it.
    pub(super) fn new(centre: &Vector<3>, corners: [&Vector<3>; 4], negligible: f64) -> Option<Self> {
        let ([a, b, c, d], is_convex) = cone(centre, corners);
        let middle = mean_of(corners.into_iter());
        let triangles: [HalfSpace<3>; 4] =
            std::array::from_fn(|i| under(&middle, corners[i], corners[(i + 1) % 4]));
        let normal = area(corners);
        let lowest = corners.iter().map(|x| normal.dot(x)).fold(f64::INFINITY, f64::min);
        let beyond = HalfSpace { normal: -normal, constant: -lowest };
        let is_seen = |triangle: &HalfSpace<3>| triangle.height(centre) < -negligible;
        if !(is_convex && triangles.iter().all(is_seen) && beyond.height(centre) >= 0.0) {
            return None;
        }
        // How far the corner before an edge of the fan lies over the triangle after it.
        let bends: [f64; 4] = std::array::from_fn(|i| triangles[i].height(corners[(i + 3) % 4]));
        let is_ridge = |i: usize| bends[i] <= negligible && bends[i + 2] <= negligible;
        let is_valley = |i: usize| bends[i % 2] >= -negligible && bends[i % 2 + 2] >= -negligible;
        let first = (0..2).find(|&i| is_ridge(i) && is_valley(i + 1))?;
        let ridge = |i: usize| [triangles[(i + 3) % 4], triangles[i]];
        Some(Self { beyond: [beyond, a, b, c, d], ridges: [ridge(first), ridge(first + 2)] })
    }

    /// Visits pieces that add up, with their signs, to what a region has beyond the face, turned inside out.
    pub(super) fn take(
        &self,
        region: &Polyhedron,
        [outer, inner, both]: &mut Rooms<'_>,
        visit: &mut impl FnMut(f64, &Polyhedron),
    ) -> Result<(), Full> {
        let Some(slice) = within(region, &self.beyond, outer)? else { return Ok(()) };
        let [first, second] = &self.ridges;
        let covers = |ridge: &[HalfSpace<3>; 2]| {
            ridge.iter().all(|triangle| slice.corners().all(|x| triangle.height(x) <= 0.0))
        };
        if covers(first) || covers(second) {
            return Ok(());
        }
        visit(-1.0, slice);
        if let Some(part) = within(slice, first, inner)? {
            visit(1.0, part);
            if let Some(twice) = within(part, second, both)? {
                visit(-1.0, twice);
            }
        }
        if let Some(part) = within(slice, second, inner)? {
            visit(1.0, part);
        }
        Ok(())
    }
}
