//! The faces of a hexahedron, each the fan of four triangles about the mean of its nodes, and what lies on either side of them.
//!
//! A [`Roof`] bounds a cell from outside and takes off what it has over the fan; a [`Pyramid`] is what lies between the fan and the
//! centre of the cell.

use super::tile::{mean_of, turned_to, under, within};
use super::{Full, Polyhedron, Region};
use crate::tolerance::FACE_PLANE;
use crate::{Cell, HalfSpace, Hexahedron, Vector};

/// Room for what is left of a region, twice.
pub(super) type Rooms<'a> = [&'a mut [Polyhedron; 2]; 2];

/// The corners of a face, in outward order.
pub(super) fn corners(nodes: &[Vector<3>], face: usize) -> [&Vector<3>; 4] {
    [0, 1, 2, 3].map(|i| &nodes[Hexahedron::FACE_NODES[face][i]])
}

/// Twice the area vector of a face.
pub(super) fn area([a, b, c, d]: [&Vector<3>; 4]) -> Vector<3> {
    (c - a).cross(&(d - b))
}

/// Two triangles over the fan of a face, on either side of the diagonal that lies further out: `a c` of the corners `a, b, c, d`.
///
/// The corners are `m - u - v + w`, `m + u - v - w`, `m + u + v + w` and `m - u + v - w`, where `m` is the middle and the volume
/// `u x v . w` is not negative. Of each triangle of the fan, one of the other corners lies `4 u x v . w` over its plane, measured
/// along its normal, `2 (u - w) x v` for `a b m`, and the other as far under it. So the fan falls from `a` and `c` to either side and
/// rises again to `b` and `d`, and what lies between it and the roof are two tetrahedra, `a b c m` and `c d a m`. What lies under
/// the roof and beyond the two triangles at `b` holds all of the first and nothing but what is in one of them; so
/// do those at `d` for the second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roof<'a> {
    corners: [&'a Vector<3>; 4],
    /// The half-spaces under the two triangles; one and the same where the face is plane.
    pub(super) planes: [HalfSpace<3>; 2],
    /// Whether there is nothing between roof and fan.
    pub(super) is_plane: bool,
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
        [outer, inner]: &mut Rooms<'_>,
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

impl<'a> Roof<'a> {
    /// The roof of a face with these corners, in outward order.
    pub(super) fn new(corners: [&'a Vector<3>; 4]) -> Self {
        let [a, b, c, d] = corners;
        let normal = area(corners);
        let twist = (a - b) + (c - d);
        let height = normal.dot(&twist);
        let size = normal.amax() * (c - a).amax().max((d - b).amax());
        let is_plane = height.abs() <= FACE_PLANE * size;
        let corners = if height < 0.0 { [b, c, d, a] } else { corners };
        let [a, b, c, d] = corners;
        let planes = match is_plane {
            // Two of its corners may be one.
            true => [HalfSpace { normal, constant: normal.dot(&mean_of(corners.into_iter())) }; 2],
            false => [under(a, b, c), under(a, c, d)],
        };
        Self { corners, planes, is_plane }
    }

    /// Whether the cell with these nodes lies under it.
    pub(super) fn covers(&self, nodes: &[Vector<3>; 8]) -> bool {
        let is_own = |x: &Vector<3>| self.corners.contains(&x);
        self.planes.iter().all(|plane| nodes.iter().all(|x| plane.height(x) <= 0.0 || is_own(x)))
    }

    /// Visits pieces that add up, with their signs, to what a region under it has beyond the fan, turned inside out.
    pub(super) fn take(
        &self,
        region: &Polyhedron,
        [outer, inner]: &mut Rooms<'_>,
        visit: &mut impl FnMut(f64, &Polyhedron),
    ) -> Result<(), Full> {
        if self.is_plane {
            return Ok(());
        }
        let [a, b, c, d] = self.corners;
        let middle = mean_of(self.corners.into_iter());
        let beyond = |a, b| under(&middle, b, a);
        let (first, second) = ([beyond(a, b), beyond(b, c)], [beyond(c, d), beyond(d, a)]);
        if let Some(part) = within(region, &first, outer)? {
            visit(-1.0, part);
            if let Some(twice) = within(part, &second, inner)? {
                visit(1.0, twice);
            }
        }
        if let Some(part) = within(region, &second, outer)? {
            visit(-1.0, part);
        }
        Ok(())
    }
}
