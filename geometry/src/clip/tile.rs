//! What a region has in common with a cell, and the plane constant on the same cell: tiles fit together without gaps.
//!
//! A [`Tile`] is a cell whose faces are the fans about the means of their nodes, four triangles each (2D: a quadrilateral).
//! Neighbours share these triangles, so the tiles of a mesh fill it, and a fan encloses exactly what the ruled face
//! does. A tile need not be convex: it is cut out of a region piece by convex piece.
//!
//! - A parallelepiped, and a convex quadrilateral, is one piece.
//! - Any other hexahedron is six pyramids from its centre. Each is the cone over the edges of a face, under the four triangles
//!   of the fan. A part of the region that lies under all four needs no further cut; else each triangle gets its own sector of
//!   the cone.
//! - Where a cone is not convex or a piece is turned inside out, the pieces are signed simplices.

use super::{Full, Polygon, Polyhedron, Region, Side};
use crate::submesh::{self, Triangulation};
use crate::tolerance::PIECE_NEGLIGIBLE;
use crate::{Cell, HalfSpace, Hexahedron, PlaneConstant, PositionError, PositionMethod, Quad, Vector};

/// Room for what a cell leaves of a region, step by step.
#[derive(Clone, Debug)]
pub struct Workspace<R> {
    outer: [R; 2],
    inner: [R; 2],
}

impl<R> Workspace<R> {
    /// Empty room.
    pub fn new<const D: usize>() -> Self
    where
        R: Region<D>,
    {
        let pair = || [R::empty(), R::empty()];
        Self { outer: pair(), inner: pair() }
    }
}

/// A cell prepared for being cut out of regions; see [`crate::clip::tile`].
pub trait Tile<const D: usize>: Sized {
    /// What it is cut out of.
    type Region: Region<D>;
    /// The cell.
    type Cell: Cell<D>;

    /// The tile of a cell.
    fn new(cell: &Self::Cell) -> Self;

    /// The mean of the nodes of each face; `2 D` of them.
    fn middles(cell: &Self::Cell) -> [Vector<D>; 6] {
        let mut middles = [Vector::zeros(); 6];
        for (middle, face) in middles.iter_mut().zip(Self::Cell::FACE_NODES) {
            *middle = mean_of(face.iter().map(|&i| &cell.nodes()[i]));
        }
        middles
    }

    /// The whole tile as a region.
    fn region(cell: &Self::Cell) -> Self::Region {
        Self::Region::fans(cell.nodes(), &Self::middles(cell)[..Self::Cell::FACES])
    }

    /// Visits pieces that add up, with their signs, to what the region has in common with the tile.
    ///
    /// # Errors
    /// No room.
    fn common(
        &self,
        region: &Self::Region,
        work: &mut Workspace<Self::Region>,
        visit: &mut impl FnMut(f64, &Self::Region),
    ) -> Result<(), Full>;

    /// The plane constant for which the tile of a cell keeps `fraction` of its volume.
    ///
    /// # Errors
    /// Those of [`Cell::plane_constant`].
    fn plane_constant(
        cell: &Self::Cell,
        normal: &Vector<D>,
        fraction: f64,
        method: PositionMethod,
    ) -> Result<PlaneConstant, PositionError>;
}

/// What of a region lies in all of some half-spaces; none if nothing does.
fn within<'a, R: Region<D>, const D: usize>(
    region: &'a R,
    half_spaces: &[HalfSpace<D>],
    work: &'a mut [R; 2],
) -> Result<Option<&'a R>, Full> {
    let [mut current, mut next] = work.each_mut();
    let mut is_cut = false;
    for half_space in half_spaces {
        let whole = if is_cut { &*current } else { region };
        match whole.cut(half_space, next)? {
            Side::Below => {}
            Side::Above => return Ok(None),
            Side::Across => {
                std::mem::swap(&mut current, &mut next);
                is_cut = true;
            }
        }
    }
    Ok(Some(if is_cut { current } else { region }))
}

/// Turns a half-space so that a point lies inside.
fn turned_to<const D: usize>(half_space: HalfSpace<D>, inside: &Vector<D>) -> HalfSpace<D> {
    if half_space.height(inside) > 0.0 { half_space.complement() } else { half_space }
}

/// The half-space on the left of the line from `a` to `b`.
fn left_of(a: &Vector<2>, b: &Vector<2>) -> HalfSpace<2> {
    let normal = Vector::<2>::new(b[1] - a[1], a[0] - b[0]);
    HalfSpace { normal, constant: normal.dot(a) }
}

/// The half-space under three points: its normal is that of their triangle.
fn under(a: &Vector<3>, b: &Vector<3>, c: &Vector<3>) -> HalfSpace<3> {
    let normal = (b - a).cross(&(c - a));
    HalfSpace { normal, constant: normal.dot(a) }
}

/// The mean of points.
fn mean_of<'a, const D: usize>(points: impl ExactSizeIterator<Item = &'a Vector<D>>) -> Vector<D> {
    let count = points.len() as f64;
    points.sum::<Vector<D>>() / count
}

/// The largest extent along an axis.
fn extent<const D: usize>(points: &[Vector<D>]) -> f64 {
    points.iter().map(|x| (x - points[0]).amax()).fold(0.0, f64::max)
}

/// A quadrilateral as convex pieces: itself, or two triangles.
#[derive(Clone, Debug)]
pub struct QuadTile {
    /// The half-spaces of each piece, of which the first `sides` count, and its sign: 0 for none.
    pieces: [([HalfSpace<2>; 4], f64); 2],
    sides: usize,
}

impl Tile<2> for QuadTile {
    type Region = Polygon;
    type Cell = Quad;

    fn new(cell: &Quad) -> Self {
        let x = cell.nodes();
        let side = |i: usize, j: usize| left_of(&x[i], &x[j]);
        let around = [side(0, 1), side(1, 2), side(2, 3), side(3, 0)];
        let is_convex = (0..4)
            .all(|i| around[i].height(&x[(i + 2) % 4]) <= 0.0 && around[i].height(&x[(i + 3) % 4]) <= 0.0);
        if is_convex {
            return Self { pieces: [(around, 1.0), (around, 0.0)], sides: 4 };
        }
        let negligible = PIECE_NEGLIGIBLE * extent(x).powi(2);
        let triangle = |[a, b, c]: [usize; 3]| {
            let turn = side(a, b).height(&x[c]);
            let sign = if turn.abs() > negligible { -turn.signum() } else { 0.0 };
            let sides = [(a, b, c), (b, c, a), (c, a, b), (a, b, c)];
            (sides.map(|(a, b, c)| turned_to(side(a, b), &x[c])), sign)
        };
        Self { pieces: [triangle([0, 1, 2]), triangle([0, 2, 3])], sides: 3 }
    }

    fn common(
        &self,
        region: &Polygon,
        work: &mut Workspace<Polygon>,
        visit: &mut impl FnMut(f64, &Polygon),
    ) -> Result<(), Full> {
        for (half_spaces, sign) in self.pieces.iter().filter(|(_, sign)| *sign != 0.0) {
            if let Some(part) = within(region, &half_spaces[..self.sides], &mut work.outer)? {
                visit(*sign, part);
            }
        }
        Ok(())
    }

    fn plane_constant(
        cell: &Quad,
        normal: &Vector<2>,
        fraction: f64,
        method: PositionMethod,
    ) -> Result<PlaneConstant, PositionError> {
        cell.plane_constant(normal, fraction, method)
    }
}

/// A hexahedron as convex pieces.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "lives on the stack while one cell is cut out")]
pub enum HexahedronTile {
    /// A parallelepiped.
    Convex([HalfSpace<3>; 6]),
    /// Any other.
    Pyramids([Pyramid; 6]),
}

/// The part of a hexahedron between its centre and one face.
#[derive(Clone, Copy, Debug)]
pub struct Pyramid {
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

impl Pyramid {
    fn new(centre: &Vector<3>, middle: &Vector<3>, corners: [&Vector<3>; 4], negligible: f64) -> Self {
        let side = |i: usize| under(centre, corners[(i + 1) % 4], corners[i]);
        let sides = [side(0), side(1), side(2), side(3)];
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
        let is_convex = sectors.iter().all(|sector| sector.sign == 1.0)
            && (0..4).all(|i| [2, 3].iter().all(|k| sides[i].height(corners[(i + k) % 4]) <= 0.0));
        let sides = std::array::from_fn(|i| turned_to(sides[i], middle));
        Self { sides, sectors, is_convex }
    }

    fn common(
        &self,
        region: &Polyhedron,
        work: &mut Workspace<Polyhedron>,
        visit: &mut impl FnMut(f64, &Polyhedron),
    ) -> Result<(), Full> {
        let Workspace { outer, inner } = work;
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

impl Tile<3> for HexahedronTile {
    type Region = Polyhedron;
    type Cell = Hexahedron;

    fn new(cell: &Hexahedron) -> Self {
        let x = cell.nodes();
        let faces = Hexahedron::FACE_NODES;
        if cell.is_affine() {
            let turn = cell.volume().signum();
            return Self::Convex(std::array::from_fn(|face| {
                let [a, b, c] = [0, 1, 2].map(|i| &x[faces[face][i]]);
                let outward = under(a, b, c);
                if turn < 0.0 { outward.complement() } else { outward }
            }));
        }
        let centre = mean_of(x.iter());
        let negligible = PIECE_NEGLIGIBLE * extent(x).powi(3);
        Self::Pyramids(std::array::from_fn(|face| {
            let corners = [0, 1, 2, 3].map(|i| &x[faces[face][i]]);
            let middle = mean_of(corners.into_iter());
            Pyramid::new(&centre, &middle, corners, negligible)
        }))
    }

    fn common(
        &self,
        region: &Polyhedron,
        work: &mut Workspace<Polyhedron>,
        visit: &mut impl FnMut(f64, &Polyhedron),
    ) -> Result<(), Full> {
        match self {
            Self::Convex(half_spaces) => {
                if let Some(part) = within(region, half_spaces, &mut work.outer)? {
                    visit(1.0, part);
                }
                Ok(())
            }
            Self::Pyramids(pyramids) => {
                pyramids.iter().try_for_each(|pyramid| pyramid.common(region, work, visit))
            }
        }
    }

    fn plane_constant(
        cell: &Hexahedron,
        normal: &Vector<3>,
        fraction: f64,
        method: PositionMethod,
    ) -> Result<PlaneConstant, PositionError> {
        if cell.is_affine() {
            return cell.plane_constant(normal, fraction, method);
        }
        submesh::plane_constant(cell, normal, fraction, Triangulation::FourPerFace)
    }
}
