//! Plane constants of many ruled hexahedra: eight cells side by side, each in a lane of the vector instructions.
//!
//! What happens in a lane is what happens for a cell alone, operation by operation: results are the same bits in any lane and
//! any company.

use crate::cell::{Cell, Wanted};
use crate::frame::Direction;
use crate::plane_constant::{self, Depth, Monotone, PlaneConstant, PositionError, PositionMethod};
use crate::root::{Root, Search, Value};
use crate::simd::{self, either};
use crate::tolerance::POSITION_EVALUATIONS;

use super::Hexahedron;
use super::along::{Along, Range};
use super::profile::{LANES, Lanes, Profile, axes, projected, sum};

/// See [`Cell::plane_constants`].
pub(super) fn plane_constants(
    wanted: &[Wanted<Hexahedron, 3>],
    method: PositionMethod,
    mut give: impl FnMut(usize, Result<PlaneConstant, PositionError>),
) {
    let alone = |number: usize| {
        let Wanted { cell, normal, fraction } = &wanted[number];
        cell.plane_constant(normal, *fraction, method)
    };
    let mut batch = Batch::EMPTY;
    let mut waiting = [0; LANES];
    let mut count = 0;
    for number in 0..wanted.len() {
        if !is_searched(&wanted[number], method) {
            give(number, alone(number));
            continue;
        }
        waiting[count] = number;
        count += 1;
        if count == LANES {
            count = 0;
            batch.search(waiting.map(|number| &wanted[number]));
            for (lane, number) in waiting.into_iter().enumerate() {
                give(number, batch.found(lane));
            }
        }
    }
    waiting[..count].iter().for_each(|&number| give(number, alone(number)));
}

/// Whether a plane constant is found by Newton's method.
fn is_searched(Wanted { cell, normal, fraction }: &Wanted<Hexahedron, 3>, method: PositionMethod) -> bool {
    let (_, smaller) = plane_constant::smaller_part(*fraction);
    method != PositionMethod::Brent
        && !cell.is_affine()
        && smaller * cell.local_volume > 0.0
        && plane_constant::check(normal.as_slice(), *fraction, cell.volume()).is_ok()
}

/// Eight cells, each along its normal. Aligned as [`Profile`].
#[repr(align(64))]
struct Batch {
    directions: [Direction<3>; LANES],
    /// `m.y` of the lowest node, the sign of the normal, and the whole volume.
    low: Lanes,
    sign: Lanes,
    total: Lanes,
    target: Lanes,
    /// Each with the same face of the other cells.
    faces: [Profile; 6],
    searches: Searches,
}

/// One [`Search`] in each lane. Aligned as [`Profile`].
#[repr(align(64))]
struct Searches {
    position: Lanes,
    best: Lanes,
    residual: Lanes,
    evaluations: Lanes,
    bracket: [Lanes; 2],
    before: [Lanes; 4],
    tolerance: Lanes,
    /// Not at their end.
    open: Lanes,
}

impl Batch {
    const EMPTY: Self = Self {
        directions: [Direction::NONE; LANES],
        low: [0.0; LANES],
        sign: [0.0; LANES],
        total: [0.0; LANES],
        target: [0.0; LANES],
        faces: [Profile::EMPTY; 6],
        searches: Searches {
            position: [0.0; LANES],
            best: [0.0; LANES],
            residual: [0.0; LANES],
            evaluations: [0.0; LANES],
            bracket: [[0.0; LANES]; 2],
            before: [[0.0; LANES]; 4],
            tolerance: [0.0; LANES],
            open: [0.0; LANES],
        },
    };

    /// Finds the plane constants of eight cells that are [searched](is_searched).
    #[inline(never)]
    fn search(&mut self, wanted: [&Wanted<Hexahedron, 3>; LANES]) {
        simd::widest(
            #[inline(always)]
            || {
                self.prepare(wanted);
                let volumes = below(&self.faces, &self.searches.position);
                self.searches.advance::<true>(&volumes, &self.target);
                // The last one of a batch is not worth the work for eight.
                while sum(&self.searches.open) > 1.0 {
                    let volumes = below(&self.faces, &self.searches.position);
                    self.searches.advance::<false>(&volumes, &self.target);
                }
                for i in 0..LANES {
                    if self.searches.open[i] > 0.0 {
                        self.finish(i, wanted[i]);
                    }
                }
            },
        );
    }

    /// Puts each cell with its normal and its first guess in a lane.
    #[inline(always)]
    fn prepare(&mut self, wanted: [&Wanted<Hexahedron, 3>; LANES]) {
        let mut heights = [[0.0; LANES]; 8];
        let mut shadows = [[[0.0; LANES]; 8]; 2];
        for i in 0..LANES {
            let Wanted { cell, normal, fraction } = wanted[i];
            let (sign, fraction) = plane_constant::smaller_part(*fraction);
            let along = Along::new(cell, &(normal * sign));
            let m = &along.direction.m;
            let shadow = projected(&cell.local, m, axes(m));
            for node in 0..8 {
                heights[node][i] = along.heights[node];
                shadows[0][node][i] = shadow[0][node];
                shadows[1][node][i] = shadow[1][node];
            }
            (self.directions[i], self.low[i], self.sign[i]) = (along.direction, along.low, sign);
            let (range, target) = (Range::new(m, &along.heights), fraction * cell.local_volume);
            (self.total[i], self.target[i]) = (cell.local_volume, target);
            let tolerance = plane_constant::residual_allowed(target);
            self.searches.set(i, &Search::new([0.0, range.span], range.start(fraction), tolerance));
            self.searches.open[i] = 1.0;
        }
        for (face, nodes) in self.faces.iter_mut().zip(Hexahedron::FACE_NODES) {
            let [a, b, c, d] = [nodes[0], nodes[1], nodes[2], nodes[3]];
            face.heights = [heights[a], heights[b], heights[c], heights[d]];
            face.prepare(|i| [0, 1].map(|axis| [a, b, c, d].map(|node| shadows[axis][node][i])));
        }
    }

    /// Goes on with one of the searches to its end.
    #[inline(always)]
    fn finish(&mut self, i: usize, Wanted { cell, normal, .. }: &Wanted<Hexahedron, 3>) {
        let mut rising = Along::new(cell, &(normal * self.sign[i])).rising();
        let mut search = self.searches.get(i);
        while !search.advance(rising.volume(search.position).less(self.target[i]), POSITION_EVALUATIONS) {}
        self.searches.set(i, &search);
    }

    /// What the search in one lane found.
    fn found(&self, i: usize) -> Result<PlaneConstant, PositionError> {
        let depth = Depth::of_root(self.searches.get(i).best, self.total[i])?;
        Ok(depth.plane(&self.directions[i], self.low[i], self.sign[i]))
    }
}

/// The volumes below a depth for each of eight cells, with their derivatives.
#[inline(always)]
fn below(faces: &[Profile; 6], depths: &Lanes) -> [Lanes; 3] {
    let mut below = [[[0.0; LANES]; 3]; 6];
    for (below, face) in below.iter_mut().zip(faces) {
        *below = face.below(depths);
    }
    let mut sums = [[0.0; LANES]; 3];
    for i in 0..LANES {
        for of in 0..3 {
            let [a, b, c, d, e, f] = [0, 1, 2, 3, 4, 5].map(|face: usize| below[face][of][i]);
            sums[of][i] = sum(&[a, b, c, d, e, f, 0.0, 0.0]);
        }
    }
    sums
}

impl Searches {
    #[inline(always)]
    fn get(&self, i: usize) -> Search {
        let [x, value, derivative, second] = [0, 1, 2, 3].map(|of: usize| self.before[of][i]);
        Search {
            position: self.position[i],
            best: Root {
                position: self.best[i],
                residual: self.residual[i],
                evaluations: self.evaluations[i] as usize,
            },
            bracket: [self.bracket[0][i], self.bracket[1][i]],
            before: (x, Value { value, derivative, second }),
            tolerance: self.tolerance[i],
        }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, search: &Search) {
        let Search { position, best, bracket, before: (x, before), tolerance } = *search;
        self.position[i] = position;
        (self.best[i], self.residual[i]) = (best.position, best.residual);
        self.evaluations[i] = best.evaluations as f64;
        (self.bracket[0][i], self.bracket[1][i]) = (bracket[0], bracket[1]);
        for (lanes, number) in self.before.iter_mut().zip([x, before.value, before.derivative, before.second])
        {
            lanes[i] = number;
        }
        self.tolerance[i] = tolerance;
    }

    /// [`Search::advance`] of those that are open.
    #[inline(always)]
    fn advance<const FIRST: bool>(&mut self, volumes: &[Lanes; 3], targets: &Lanes) {
        for i in 0..LANES {
            let here = Value { value: volumes[0][i], derivative: volumes[1][i], second: volumes[2][i] };
            let here = here.less(targets[i]);
            let mut search = self.get(i);
            let is_open = self.open[i] > 0.0;
            let is_found = search.keep(here.value);
            let is_moved = search.step(here, FIRST);
            search.best.position = either(is_open, search.best.position, self.best[i]);
            search.best.residual = either(is_open, search.best.residual, self.residual[i]);
            let evaluations = self.evaluations[i] + self.open[i];
            self.set(i, &search);
            self.evaluations[i] = evaluations;
            self.open[i] = either(
                is_open & !is_found & is_moved & (evaluations < POSITION_EVALUATIONS as f64),
                1.0,
                0.0,
            );
        }
    }
}
