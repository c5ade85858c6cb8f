//! Swartz' normals (Swartz 1989; in 3D Mosso, Swartz, Kothe & Clancy 1996): every plane is turned until it goes through the
//! middles of the sections of its neighbours.
//!
//! In every round each cell fits a plane to the middles `c` of its own section and its neighbours',
//!
//! ```text
//! sum of w (h - h_0 - s.t)^2 -> min,   w = q / |c - c_0|^3 (the own one: q),   q = sqrt(f (1 - f)) / sqrt(mean w h^2 of that cell),
//! m <- m - s
//! ```
//!
//! with the heights `h` over the present plane and the places `t` in it, in the cell's own frame, in which `c_0`, the middle of its own
//! section, is the origin; then all planes are placed anew. A plane that turns with its volume kept turns about the middle of its section to
//! first order. So these middles leave a common plane only by the square of the planes' errors, and a common plane is found in
//! about four rounds, on any mesh.
//!
//! The original has `h_0 = 0` and equal weights. There a small section that lies wrong keeps itself wrong, and a corner is felt two cells
//! away, since the plane next to it counts as much as one whose neighbours all agree with it. Circles come out better with these weights, too.
//!
//! Planes may not come to rest: at the rim of a sheet, next to a corner, or where a small section and a plane that leans on it keep each
//! other wrong. Where all planes around belong together and [LVIRA](super::lvira) then finds one that fits the patch to rounding, it is taken.
//!
//! **Neighbours** are the cells of the patch whose section belongs to the same piece of interface: their normals lie within 60
//! degrees, and the line between the middles within 45 degrees of the present plane. So the other side of a film or of a narrow
//! gap counts for nothing.

use nalgebra::SMatrix;
use vofkit_geometry::{Cell, HalfSpace, PositionMethod, Vector};

use super::descent::{least_curvature, solve_across};
use super::frame::Frame;
use super::patch::shift_beyond_ends;
use super::stencil::{stencil_cells, step_of};
use super::{Around, Direction, Found, Material, NormalMethod, Stencil, lvira};
use crate::parallel;
use crate::tolerance::{
    CONNECTED_NORMALS, CONNECTED_SLOPE, PLANE_DETERMINED, RELAXED_GAIN, RELAXED_ROUNDS, TURN_ROUNDING,
};

/// A plane on the way.
#[derive(Clone, Copy, Debug)]
struct Plane<const D: usize> {
    direction: Direction<D>,
    /// The cell's first node.
    anchor: Vector<D>,
    /// The middle of the section, relative to it.
    middle: Vector<D>,
    /// The square of the last turn.
    turn: f64,
    /// What its middle is worth to others.
    certainty: f64,
}

/// The mixed cells around one, by place among all.
#[derive(Clone, Copy, Debug)]
struct Links {
    places: [u32; 26],
    /// The steps that lead there, as places of a stencil.
    steps: [u8; 26],
    count: usize,
}

impl Links {
    /// Place and step of each.
    fn iter(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let all = self.places.iter().zip(&self.steps).take(self.count);
        all.map(|(&place, &step)| (place as usize, usize::from(step)))
    }
}

/// The normals in the mixed `cells` (ascending).
pub(super) fn relaxed<C: Cell<D>, const D: usize>(
    material: Material<'_, C, D>,
    cells: &[usize],
    position: PositionMethod,
) -> Vec<Found<D>> {
    let frames = parallel::map(cells.len(), |i| Frame::new(&material.mesh.local_cell(cells[i])));
    let problem = Problem { material, cells, frames, position };
    let starts: Vec<(Found<D>, Option<Plane<D>>)> = parallel::map(cells.len(), |i| problem.start(i));
    let (found, mut planes): (Vec<_>, Vec<_>) = starts.into_iter().unzip();
    let links = parallel::map(cells.len(), |i| problem.links(i));
    let mut next = planes.clone();
    for _ in 0..RELAXED_ROUNDS {
        // What stayed, among planes that stayed, stays.
        let moved = |i: usize| next[i].is_some() || links[i].iter().any(|(place, _)| next[place].is_some());
        let turned = |i: usize| moved(i).then(|| problem.turned(i, &links[i], &planes)).flatten();
        next = parallel::map(cells.len(), turned);
        if next.iter().all(Option::is_none) {
            break;
        }
        for (plane, next) in planes.iter_mut().zip(&next) {
            *plane = next.or(*plane);
        }
    }
    let settled = |i: usize| {
        let Some(plane) = planes[i] else { return found[i] };
        let restless = next[i].is_some() && plane.direction.determined;
        let fitted = if restless { problem.fitted(i, &plane, &links[i], &planes) } else { None };
        Ok(fitted.unwrap_or(plane.direction))
    };
    parallel::map(cells.len(), settled)
}

struct Problem<'a, C, const D: usize> {
    material: Material<'a, C, D>,
    cells: &'a [usize],
    frames: Vec<Frame<D>>,
    position: PositionMethod,
}

impl<C: Cell<D>, const D: usize> Problem<'_, C, D> {
    /// Youngs' normal, and its plane.
    fn start(&self, i: usize) -> (Found<D>, Option<Plane<D>>) {
        let index = self.cells[i];
        let cell = self.material.mesh.local_cell(index);
        let found = NormalMethod::Youngs.normal(self.material, index, &cell, self.position);
        let plane = found.ok().and_then(|direction| {
            let middle = self.middle(i, &cell, &direction.normal)?;
            let anchor = self.material.mesh.anchor(index);
            let direction = Direction { trials: 1, ..direction };
            Some(Plane { direction, anchor, middle, turn: f64::INFINITY, certainty: self.certainty(i, 1.0) })
        });
        (found, plane)
    }

    /// LVIRA's normal, where all planes around belong together and its plane fits the patch to rounding: near the normal of the most
    /// certain of them, since a plane that is common to all is known best there.
    fn fitted(
        &self,
        i: usize,
        own: &Plane<D>,
        links: &Links,
        planes: &[Option<Plane<D>>],
    ) -> Option<Direction<D>> {
        let mut best = own;
        for other in links.iter().filter_map(|(place, _)| planes[place].as_ref()) {
            if own.direction.normal.dot(&other.direction.normal) < CONNECTED_NORMALS {
                return None;
            }
            if other.certainty > best.certainty {
                best = other;
            }
        }
        let index = self.cells[i];
        let cell = self.material.mesh.local_cell(index);
        let grid = self.material.mesh.grid();
        let offset = grid.offset(index);
        let stencil = Stencil::new(grid, self.material.fractions, offset);
        let around = Around { material: self.material, index, offset, cell: &cell, stencil };
        lvira::exact(&around, self.position, &best.direction.normal)
    }

    /// The middle of the section with this normal that leaves the cell its volume.
    fn middle(&self, i: usize, cell: &C, normal: &Vector<D>) -> Option<Vector<D>> {
        let fraction = self.material.fractions[self.cells[i]];
        let constant = cell.plane_constant(normal, fraction, self.position).ok()?.constant;
        cell.section_centroid(&HalfSpace { normal: *normal, constant })
    }

    /// What the middle of a section is worth: small sections turn about places of their own, and a plane that its own neighbours
    /// contradict says little about others. `spread` is the weighted mean square of the heights of their middles over it, in squared cells.
    fn certainty(&self, i: usize, spread: f64) -> f64 {
        let f = self.material.fractions[self.cells[i]];
        (f * (1.0 - f) / (spread + TURN_ROUNDING)).sqrt()
    }

    fn links(&self, i: usize) -> Links {
        let grid = self.material.mesh.grid();
        let offset = grid.offset(self.cells[i]);
        let mut links = Links { places: [0; 26], steps: [0; 26], count: 0 };
        for place in (0..stencil_cells(D)).filter(|&place| place != stencil_cells(D) / 2) {
            let step = step_of::<D>(place);
            let beyond = |k: usize| !(0..grid.cells()[k] as isize).contains(&(offset[k] as isize + step[k]));
            if (0..D).any(|k| beyond(k) && !grid.periodic()[k]) {
                continue;
            }
            if let Ok(other) = self.cells.binary_search(&grid.index(grid.stepped(offset, step))) {
                links.places[links.count] = other as u32;
                links.steps[links.count] = place as u8;
                links.count += 1;
            }
        }
        links
    }

    /// The plane of one cell after another round; none if it stays.
    fn turned(&self, i: usize, links: &Links, planes: &[Option<Plane<D>>]) -> Option<Plane<D>> {
        let own = planes[i]?;
        let (mesh, index) = (self.material.mesh, self.cells[i]);
        let frame = &self.frames[i];
        let normal = frame.normal(&own.direction.normal);
        let (mut matrix, mut right) = (SMatrix::<f64, D, D>::zeros(), Vector::<D>::zeros());
        let (mut places, mut heights, mut squares) = (Vector::<D>::zeros(), 0.0, 0.0);
        // The cell's own middle is one of the points, at the origin.
        let (mut turn, mut weights) = (own.turn, own.certainty);
        for (place, step) in links.iter() {
            let Some(other) = planes[place] else { continue };
            if own.direction.normal.dot(&other.direction.normal) < CONNECTED_NORMALS {
                continue;
            }
            let beyond = shift_beyond_ends(mesh, index, &step_of::<D>(step));
            let arm = frame.point(&((other.middle - own.middle) + (other.anchor - own.anchor) + beyond));
            let h = normal.dot(&arm);
            let t = arm - normal * h;
            if h * h > CONNECTED_SLOPE * CONNECTED_SLOPE * t.norm_squared() {
                continue;
            }
            let square = arm.norm_squared();
            let weight = other.certainty / (square * square.sqrt());
            matrix += t * t.transpose() * weight;
            right += t * (weight * h);
            squares += weight * h * h;
            weights += weight;
            places += t * weight;
            heights += h * weight;
            turn = turn.max(other.turn);
        }
        // Nothing has moved by more than a small part of what the planes miss each other by.
        let spread = squares / weights;
        if turn <= (RELAXED_GAIN * spread).max(TURN_ROUNDING) {
            return None;
        }
        matrix -= places * places.transpose() / weights;
        right -= places * (heights / weights);
        if !(least_curvature(&matrix) > PLANE_DETERMINED * weights) {
            let direction = Direction { determined: false, ..own.direction };
            let open = Plane { direction, turn: f64::INFINITY, certainty: 0.0, ..own };
            return own.direction.determined.then_some(open);
        }
        let step = solve_across(&matrix, &right, &normal);
        let turned = frame.in_space(&(normal - step));
        let middle = self.middle(i, &mesh.local_cell(index), &turned)?;
        let direction = Direction { normal: turned, determined: true, trials: own.direction.trials + 1 };
        let certainty = self.certainty(i, spread);
        Some(Plane { direction, middle, turn: step.norm_squared(), certainty, ..own })
    }
}
