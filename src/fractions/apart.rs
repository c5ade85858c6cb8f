//! Convex pieces taken apart, plane by plane, until no surface crosses them.
//!
//! A piece that the planes of all triangles in it have cut lies on one side of the body: its middle tells on which. So rounding can
//! misplace slivers and nothing else, and it does not matter in which order the planes come; the largest triangles come first, since
//! that makes the fewest pieces.

use std::ops::Range;

use vofkit_geometry::clip::{Region as Piece, Side, Tile};
use vofkit_geometry::{Cell, HalfSpace, Vector};

use super::facet::Facet;
use super::measure::Measure;
use super::region::Region;

pub(super) type PieceOf<C, const D: usize> = <<C as Cell<D>>::Tile as Tile<D>>::Region;

/// What it takes to take pieces apart.
pub(super) struct Apart<'a, C: Cell<D>, const D: usize> {
    region: &'a Region<D>,
    /// The origin of all coordinates.
    anchor: Vector<D>,
    /// The parts of triangles, those in the piece at hand last.
    pub(super) facets: Vec<Facet<D>>,
    /// A height that counts as none.
    pub(super) negligible: f64,
    /// Room for pieces.
    room: Vec<Box<PieceOf<C, D>>>,
}

impl<'a, C: Cell<D>, const D: usize> Apart<'a, C, D> {
    pub(super) fn new(region: &'a Region<D>, anchor: Vector<D>) -> Self {
        Self { region, anchor, facets: Vec::new(), negligible: 0.0, room: Vec::new() }
    }

    /// The measure of the part of a piece inside the region, with the facets of a range in it. `sides` are those of the surfaces that do not
    /// cross it, and are the same afterwards; `planes` stand for all other surfaces that are not bodies.
    pub(super) fn integral<M: Measure<D>>(
        &mut self,
        piece: &PieceOf<C, D>,
        sides: &mut [Option<bool>],
        planes: &[(usize, HalfSpace<D>)],
        facets: Range<usize>,
    ) -> M {
        if let Some(inside) = self.region.decide(&|i| sides[i]) {
            return if inside { M::of_piece(piece) } else { M::default() };
        }
        if let [(surface, half_space), planes @ ..] = planes {
            let mut on_side = |apart: &mut Self, piece: &PieceOf<C, D>, facets, is_below| {
                sides[*surface] = Some(is_below);
                let amount = apart.integral::<M>(piece, sides, planes, facets);
                sides[*surface] = None;
                amount
            };
            return self.split(piece, half_space, facets, &mut on_side);
        }
        let of_open = facets.clone().filter(|&i| sides[self.facets[i].surface].is_none());
        let Some(largest) = of_open.max_by(|&a, &b| self.facets[a].size().total_cmp(&self.facets[b].size()))
        else {
            return self.by_middle(piece, sides);
        };
        self.facets.swap(facets.start, largest);
        let half_space = self.facets[facets.start].half_space;
        let rest = facets.start + 1..facets.end;
        self.split(piece, &half_space, rest, &mut |apart, piece, facets, _| {
            apart.integral::<M>(piece, sides, planes, facets)
        })
    }

    /// Adds what `part` says of the two parts of a piece, with the facets in them.
    fn split<M: Measure<D>>(
        &mut self,
        piece: &PieceOf<C, D>,
        half_space: &HalfSpace<D>,
        facets: Range<usize>,
        part: &mut impl FnMut(&mut Self, &PieceOf<C, D>, Range<usize>, bool) -> M,
    ) -> M {
        let mut parts =
            [(); 2].map(|()| self.room.pop().unwrap_or_else(|| Box::new(PieceOf::<C, D>::empty())));
        let [below, above] = &mut parts;
        let amount = match piece.split(half_space, below, above) {
            Ok(Side::Below) => part(self, piece, facets, true),
            Ok(Side::Above) => part(self, piece, facets, false),
            Ok(Side::Across) => {
                let sides = [(below, 1.0), (above, -1.0)].map(|(piece, sign)| {
                    let start = self.facets.len();
                    for i in facets.clone() {
                        let height = |x: &Vector<D>| sign * half_space.height(x);
                        let facet = self.facets[i].part(height, self.negligible);
                        self.facets.extend(facet);
                    }
                    let amount = part(self, piece, start..self.facets.len(), sign > 0.0);
                    self.facets.truncate(start);
                    amount
                });
                sides.into_iter().sum()
            }
            Err(_) => {
                let mut sum = M::default();
                piece.simplices(&mut |simplex| {
                    sum = sum + self.split(simplex, half_space, facets.clone(), part)
                });
                sum
            }
        };
        self.room.extend(parts);
        amount
    }

    /// The measure of a piece that no body crosses any more.
    fn by_middle<M: Measure<D>>(&self, piece: &PieceOf<C, D>, sides: &[Option<bool>]) -> M {
        let moments = piece.moments();
        let x = moments.first / moments.volume + self.anchor;
        let by_middle = |surface: usize| self.region.surfaces[surface].body().map(|body| body.contains(&x));
        let inside = self.region.decide(&|surface| sides[surface].or_else(|| by_middle(surface)));
        if inside == Some(true) { M::of_moments(&moments) } else { M::default() }
    }
}
