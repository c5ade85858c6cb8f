//! What a region has in common with a cell, and the plane constant on the same cell: tiles fit together without gaps.
//!
//! A [`Tile`] is a cell whose faces are the fans about the means of their nodes, four triangles each (2D: a quadrilateral).
//! Neighbours share these triangles, so the tiles of a mesh fill it, and a fan encloses exactly what the ruled face
//! does. A tile need not be convex: it is cut out of a region piece by convex piece.
//!
//! - A parallelepiped, and a convex quadrilateral, is one piece.
//! - Of any other hexahedron, first what lies under roofs of two triangles over its faces; then what of that lies between the roofs
//!   and the fans is taken away, face by face. Few faces of a cell meet a region that does not hold all of it.
//! - Where the roofs are not convex, it is six pyramids from its centre: each the cone over the edges of a face, under the
//!   four triangles of the fan, and where a cone is not convex or a piece is turned inside out, signed simplices.

use super::faces::{Pyramid, Roof, area, corners};
use super::{Full, Polygon, Polyhedron, Region, Side};
use crate::submesh::{self, Triangulation};
use crate::tolerance::PIECE_NEGLIGIBLE;
use crate::{Cell, HalfSpace, Hexahedron, PlaneConstant, PositionError, PositionMethod, Quad, Vector};

/// Room for what a cell leaves of a region, step by step.
#[derive(Clone, Debug)]
pub struct Workspace<R> {
    whole: [R; 2],
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
        Self { whole: pair(), outer: pair(), inner: pair() }
    }
}

/// A cell prepared for being cut out of regions; see [`crate::clip::tile`].
pub trait Tile<const D: usize>: Clone + Send + Sync + std::fmt::Debug {
    /// What it is cut out of.
    type Region: Region<D>;
    /// The cell.
    type Cell: Cell<D>;

    /// The tile of a cell.
    fn new(cell: &Self::Cell) -> Self;

    /// The tile moved by `shift`.
    fn translated(&self, shift: &Vector<D>) -> Self;

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
pub(super) fn within<'a, R: Region<D>, const D: usize>(
    region: &'a R,
    half_spaces: &[HalfSpace<D>],
    work: &'a mut [R; 2],
) -> Result<Option<&'a R>, Full> {
    // What lies apart is not cut at all, and no plane is looked at twice that does not meet the region.
    let mut across = 0_u64;
    for (i, half_space) in half_spaces.iter().enumerate() {
        match region.side(half_space) {
            Side::Below => {}
            Side::Above => return Ok(None),
            Side::Across => across |= 1 << i,
        }
    }
    let [mut current, mut next] = work.each_mut();
    let mut is_cut = false;
    while across != 0 {
        let half_space = &half_spaces[across.trailing_zeros() as usize];
        across &= across - 1;
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
pub(super) fn turned_to<const D: usize>(half_space: HalfSpace<D>, inside: &Vector<D>) -> HalfSpace<D> {
    if half_space.height(inside) > 0.0 { half_space.complement() } else { half_space }
}

/// The half-space on the left of the line from `a` to `b`.
fn left_of(a: &Vector<2>, b: &Vector<2>) -> HalfSpace<2> {
    let normal = Vector::<2>::new(b[1] - a[1], a[0] - b[0]);
    HalfSpace { normal, constant: normal.dot(a) }
}

/// The half-space under three points: its normal is that of their triangle.
pub(super) fn under(a: &Vector<3>, b: &Vector<3>, c: &Vector<3>) -> HalfSpace<3> {
    let normal = (b - a).cross(&(c - a));
    HalfSpace { normal, constant: normal.dot(a) }
}

/// The mean of points.
pub(super) fn mean_of<'a, const D: usize>(points: impl ExactSizeIterator<Item = &'a Vector<D>>) -> Vector<D> {
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

    fn translated(&self, shift: &Vector<2>) -> Self {
        let mut moved = self.clone();
        for half_space in moved.pieces.iter_mut().flat_map(|(half_spaces, _)| half_spaces) {
            *half_space = half_space.translated(shift);
        }
        moved
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

/// A hexahedron, prepared as its shape allows.
#[derive(Clone, Debug)]
pub struct HexahedronTile {
    nodes: [Vector<3>; 8],
    /// Half-spaces that hold all of it, of which the first `count` are in use.
    hull: [HalfSpace<3>; 12],
    count: usize,
    shape: Shape,
}

/// How a hexahedron lies in its hull.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// It fills it.
    Parallelepiped,
    /// But for what lies between roofs and fans.
    Roofed,
    /// As pyramids from its centre.
    Pyramids,
}

impl HexahedronTile {
    fn add(&mut self, half_space: HalfSpace<3>) {
        self.hull[self.count] = half_space;
        self.count += 1;
    }
}

impl Tile<3> for HexahedronTile {
    type Region = Polyhedron;
    type Cell = Hexahedron;

    fn new(cell: &Hexahedron) -> Self {
        let nodes: [Vector<3>; 8] = std::array::from_fn(|i| cell.nodes()[i]);
        let nothing = HalfSpace { normal: Vector::zeros(), constant: 0.0 };
        let mut tile = Self { nodes, hull: [nothing; 12], count: 0, shape: Shape::Parallelepiped };
        let x = &nodes;
        if cell.is_affine() {
            let turn = cell.volume().signum();
            for face in 0..6 {
                let [a, b, c, _] = corners(x, face);
                let outward = under(a, b, c);
                tile.add(if turn < 0.0 { outward.complement() } else { outward });
            }
            return tile;
        }
        tile.shape = Shape::Roofed;
        for face in 0..6 {
            let roof = Roof::new(corners(x, face));
            if !roof.covers(x) {
                tile.shape = Shape::Pyramids;
                break;
            }
            let planes = if roof.is_plane { &roof.planes[..1] } else { &roof.planes };
            planes.iter().for_each(|plane| tile.add(*plane));
        }
        if let Shape::Pyramids = tile.shape {
            tile.count = 0;
            for face in 0..6 {
                let normal = area(corners(x, face));
                let constant = x.iter().map(|x| normal.dot(x)).fold(f64::NEG_INFINITY, f64::max);
                tile.add(HalfSpace { normal, constant });
            }
        }
        tile
    }

    fn translated(&self, shift: &Vector<3>) -> Self {
        let mut moved = self.clone();
        moved.nodes.iter_mut().for_each(|x| *x += shift);
        for half_space in &mut moved.hull[..self.count] {
            *half_space = half_space.translated(shift);
        }
        moved
    }

    fn common(
        &self,
        region: &Polyhedron,
        work: &mut Workspace<Polyhedron>,
        visit: &mut impl FnMut(f64, &Polyhedron),
    ) -> Result<(), Full> {
        let Some(near) = within(region, &self.hull[..self.count], &mut work.whole)? else { return Ok(()) };
        let rooms = &mut [&mut work.outer, &mut work.inner];
        let mut faces = (0..6).map(|face| corners(&self.nodes, face));
        match self.shape {
            Shape::Parallelepiped => {
                visit(1.0, near);
                Ok(())
            }
            Shape::Roofed => {
                visit(1.0, near);
                faces.try_for_each(|corners| Roof::new(corners).take(near, rooms, visit))
            }
            Shape::Pyramids => {
                let centre = mean_of(self.nodes.iter());
                let negligible = PIECE_NEGLIGIBLE * extent(&self.nodes).powi(3);
                faces.try_for_each(|corners| {
                    Pyramid::new(&centre, corners, negligible).common(near, rooms, visit)
                })
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
