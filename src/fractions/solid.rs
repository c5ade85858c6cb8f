//! Cells that the surface of a body cuts: which of them to bisect first, and where they start to be taken apart.
//!
//! The faces of a brick are fans of triangles, as those of [tiles](vofkit_geometry::clip::tile): neighbours share them, so that totals
//! do not depend on them. Where a brick is far from a parallelepiped, or a curved surface crosses it too, it is bisected first.

use vofkit_geometry::clip::{Tile, Workspace, bounds};
use vofkit_geometry::{Cell, HalfSpace, Vector};

use super::apart::{Apart, PieceOf};
use super::brick::{Brick, ball, bits, edges};
use super::cut::Cut;
use super::facet::Facet;
use super::measure::Measure;
use super::region::Region;
use super::tolerance::{
    BODY_BISECTIONS, COPLANAR, CROWD_BISECTIONS, MEETING_BISECTIONS, MEETING_REACH, MOST_TRIANGLES,
    TRIANGLES, WARP,
};

/// A cell that a region with bodies cuts.
pub(super) struct Solid<'a, C: Cell<D>, const D: usize> {
    region: &'a Region<D>,
    /// The origin of all coordinates.
    anchor: Vector<D>,
    work: Workspace<PieceOf<C, D>>,
    apart: Apart<'a, C, D>,
}

impl<'a, C: Cell<D>, const D: usize> Solid<'a, C, D> {
    pub(super) fn new(region: &'a Region<D>, anchor: Vector<D>) -> Self {
        Self { region, anchor, work: Workspace::new(), apart: Apart::new(region, anchor) }
    }

    /// The measure of the part of a brick inside the region. `sides` are those of the surfaces that are known not to cross it, after `depth`
    /// bisections.
    pub(super) fn integral<M: Measure<D>>(
        &mut self,
        brick: &Brick<D>,
        sides: &[Option<bool>],
        depth: usize,
    ) -> M {
        let region = self.region;
        let mut sides = sides.to_vec();
        let reach = self.look(brick, &mut sides);
        if let Some(inside) = region.decide(&|i| sides[i]) {
            return if inside { M::of_brick(brick) } else { M::default() };
        }
        let (middle, _) = brick.ball();
        let triangles = self.apart.facets.len();
        let is_crowded = triangles > MOST_TRIANGLES || triangles > TRIANGLES && depth < CROWD_BISECTIONS;
        if is_crowded && depth >= BODY_BISECTIONS {
            for surface in region.open(&sides) {
                let body = region.surfaces[surface].body();
                sides[surface] = body.map(|body| body.contains(&(middle + self.anchor)));
            }
        }
        let open = region.open(&sides);
        if open.iter().all(|&surface| region.surfaces[surface].body().is_none()) {
            return Cut::new(region, self.anchor).integral(brick, &sides, 0);
        }
        let is_bent = (reach > MEETING_REACH || warp(brick) > WARP) && depth < MEETING_BISECTIONS;
        if is_crowded || is_bent {
            let axis = longest(brick);
            return [0, 1]
                .map(|side| self.integral::<M>(&brick.half(axis, side), &sides, depth + 1))
                .into_iter()
                .sum();
        }
        let planes = open.into_iter().filter(|&surface| region.surfaces[surface].body().is_none());
        let planes: Vec<(usize, HalfSpace<D>)> = planes
            .map(|surface| (surface, region.surfaces[surface].tangent(&self.anchor, &middle)))
            .collect();
        self.taken_apart(brick, sides, &planes)
    }

    /// Finds the sides of surfaces that do not cross a brick, and the triangles in it; returns the largest reach of a curved surface
    /// that may cross it.
    fn look(&mut self, brick: &Brick<D>, sides: &mut [Option<bool>]) -> f64 {
        let [lower, upper] = bounds(brick.corners());
        let (middle, radius) = brick.ball();
        let mut reach = 0.0_f64;
        self.apart.facets.clear();
        for surface in self.region.open(sides) {
            let own = &self.region.surfaces[surface];
            let Some(body) = own.body() else {
                sides[surface] = own.side(&self.anchor, &middle, radius);
                if own.curved && sides[surface].is_none() {
                    let mut frame = brick.corners;
                    frame.iter_mut().for_each(|x| *x = own.frame(&self.anchor, x));
                    reach = reach.max(ball(&frame[..1 << D]).1);
                }
                continue;
            };
            let before = self.apart.facets.len();
            for number in body.near([lower + self.anchor, upper + self.anchor]) {
                let corners = body.piece(number).map(|x| x - self.anchor);
                let facet = Facet::new(surface, &corners);
                self.apart.facets.extend(facet.and_then(|facet| facet.within(&lower, &upper)));
            }
            if self.apart.facets.len() == before {
                sides[surface] = Some(body.contains(&(middle + self.anchor)));
            }
        }
        reach
    }

    fn taken_apart<M: Measure<D>>(
        &mut self,
        brick: &Brick<D>,
        mut sides: Vec<Option<bool>>,
        planes: &[(usize, HalfSpace<D>)],
    ) -> M {
        let [lower, upper] = bounds(brick.corners());
        let size = upper - lower;
        // With a margin, so that the faces of the tile cut and not those of the box around it.
        let [low, high] = [lower - size, upper + size];
        let corner =
            |offset: [usize; D]| Vector::from_fn(|k, _| if offset[k] == 0 { low[k] } else { high[k] });
        let around = C::Tile::region(&C::from_corners(corner));
        let tile = C::Tile::new(&C::from_corners(|offset| brick.corners[bits(&offset)]));
        let Self { work, apart, .. } = self;
        apart.negligible = COPLANAR * size.amax();
        let facets = 0..apart.facets.len();
        let mut sum = M::default();
        let common = tile.common(&around, work, &mut |sign, piece| {
            sum = sum + apart.integral::<M>(piece, &mut sides, planes, facets.clone()) * sign;
        });
        // A box has room for the planes of a tile.
        debug_assert!(common.is_ok());
        sum
    }
}

/// How far a brick is from a parallelepiped, relative to its longest edge.
fn warp<const D: usize>(brick: &Brick<D>) -> f64 {
    let x = brick.corners();
    let (mut twist, mut longest) = (0.0_f64, 0.0_f64);
    for axis in 0..D {
        let [first, last] = [x[0], x[1 << axis]];
        for [a, b] in edges::<D>(axis) {
            longest = longest.max((x[b] - x[a]).norm());
            twist = twist.max((x[b] - x[a] - (last - first)).norm());
        }
    }
    // The faces of a quadrilateral are straight.
    if D == 2 { 0.0 } else { twist / longest }
}

/// The axis along which a brick is longest.
fn longest<const D: usize>(brick: &Brick<D>) -> usize {
    let length = |axis: usize| {
        edges::<D>(axis).map(|[a, b]| (brick.corners[b] - brick.corners[a]).norm()).sum::<f64>()
    };
    (1..D).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best })
}
