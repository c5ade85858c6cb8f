//! The volume of a brick inside a region, or its moments: exact along lines, adaptive across them.
//!
//! A line along the local coordinate `w` crosses each surface at closed-form places, and the Jacobian determinant on it is a
//! quadratic in `w`; the part inside is a closed form ([`measure`](super::measure)). Its integral over `v` is a sum over pieces between events
//! ([`form`](super::form)) that are roots of polynomials; in 3D the integral over `u` is split at the events on the four faces
//! that contain the direction `u`, where the section's boundary meets something new.

use vofkit_geometry::Vector;

use super::brick::{Brick, CORNERS, coefficients, patch};
use super::form::{Form, events};
use super::measure::Measure;
use super::quadrature::{Breaks, fixed, integrate};
use super::region::Region;

/// A surface that crosses a brick, by its frame at the corners.
pub(super) struct Crossing<const D: usize> {
    /// Index among the surfaces of the region.
    pub(super) surface: usize,
    pub(super) curved: bool,
    /// The surface's own coordinates of the corners.
    pub(super) frame: [Vector<D>; CORNERS],
    /// Along which axes a line crosses the surface at most once.
    pub(super) once: [bool; D],
}

/// What to integrate and how well.
pub(super) struct Problem<'a, const D: usize> {
    pub(super) region: &'a Region<D>,
    /// The sides of the surfaces that do not cross the brick.
    pub(super) sides: &'a [Option<bool>],
    pub(super) crossings: &'a [Crossing<D>],
    /// The axes that become `w`, `v` and, in 3D, `u`.
    pub(super) order: [usize; 3],
    /// Errors allowed in the integral and in one of its sections.
    pub(super) tolerances: [f64; 2],
}

impl<const D: usize> Problem<'_, D> {
    /// The sign of the order of the axes, and the coefficients of brick and surfaces in it.
    fn ordered(&self, brick: &Brick<D>) -> (f64, [Vector<D>; CORNERS], Vec<[Vector<D>; CORNERS]>) {
        let [_, v, u] = self.order;
        let sign = if v == (u + 1) % 3 { 1.0 } else { -1.0 };
        let surfaces = self.crossings.iter().map(|c| coefficients(&c.frame, self.order)).collect();
        (sign, coefficients(&brick.corners, self.order), surfaces)
    }

    /// The measure of the part of the brick inside the region.
    pub(super) fn integral<M: Measure<D>>(&self, brick: &Brick<D>) -> M {
        let (sign, x, surfaces) = self.ordered(brick);
        let length = brick.corners().iter().map(|x| x.amax()).fold(0.0, f64::max);
        let mut section = Section::new(self, length);
        let mut breaks = Breaks::default();
        if D == 2 {
            return section.integral::<M>(&x, &surfaces, 0.0, &mut breaks).of_length(length) * sign;
        }
        let mut outer = Breaks::default();
        for side in [0.0, 1.0] {
            // On the face of constant v: p = u, q = w. On the face of constant w: p = u, q = v.
            for [q, fixed] in [[1, 2], [2, 1]] {
                section.forms.clear();
                for (k, crossing) in surfaces.iter().zip(self.crossings) {
                    let at = |i: usize| k[i] + k[i | fixed] * side;
                    section.forms.push(Form {
                        curved: crossing.curved,
                        once: crossing.once[self.order[q - 1]],
                        k: [at(0), at(q), at(4), at(4 | q)],
                    });
                }
                events(&section.forms, &mut outer);
            }
        }
        let integrand = |u: f64| section.integral::<M>(&x, &surfaces, u, &mut breaks);
        integrate(&mut outer, self.tolerances[0], integrand).of_length(length) * sign
    }

    /// The same by lines at fixed places.
    pub(super) fn sampled<M: Measure<D>>(&self, brick: &Brick<D>) -> M {
        let (sign, x, surfaces) = self.ordered(brick);
        let mut section = Section::new(self, 1.0);
        let mut at = |u: f64| {
            let patch = section.at::<M>(&x, &surfaces, u);
            fixed().map(|(v, share)| section.line.amount::<M>(&section.forms, &patch, v) * share).sum::<M>()
        };
        let all = if D == 2 { at(0.0) } else { fixed().map(|(u, share)| at(u) * share).sum() };
        all * sign
    }
}

/// The integral over one section, with the room it needs.
struct Section<'a, const D: usize> {
    problem: &'a Problem<'a, D>,
    /// The unit of coordinates: then no component of a measure is much larger than the volume.
    length: f64,
    forms: Vec<Form<D>>,
    line: Line<'a, D>,
}

impl<'a, const D: usize> Section<'a, D> {
    fn new(problem: &'a Problem<'a, D>, length: f64) -> Self {
        let mut line = Line {
            region: problem.region,
            crossings: problem.crossings,
            sides: problem.sides.to_vec(),
            cuts: Vec::with_capacity(2 * problem.crossings.len() + 1),
            spans: Vec::with_capacity(problem.crossings.len()),
            alone: None,
        };
        if let [crossing] = problem.crossings {
            let [inside, outside] = [true, false].map(|side| {
                line.sides[crossing.surface] = Some(side);
                line.region.decide(&|i| line.sides[i]).unwrap_or(false)
            });
            line.alone = Some([inside, outside]);
        }
        Self { problem, length, forms: Vec::with_capacity(problem.crossings.len()), line }
    }

    /// Goes to the patch of constant `u`.
    fn at<M: Measure<D>>(
        &mut self,
        x: &[Vector<D>; CORNERS],
        surfaces: &[[Vector<D>; CORNERS]],
        u: f64,
    ) -> M::Patch {
        self.forms.clear();
        for (k, crossing) in surfaces.iter().zip(self.problem.crossings) {
            let once = crossing.once[self.problem.order[0]];
            self.forms.push(Form { curved: crossing.curved, once, k: patch(k, u) });
        }
        M::patch(x, u, self.length)
    }

    /// The integral over the part of the patch of constant `u` inside the region.
    fn integral<M: Measure<D>>(
        &mut self,
        x: &[Vector<D>; CORNERS],
        surfaces: &[[Vector<D>; CORNERS]],
        u: f64,
        breaks: &mut Breaks,
    ) -> M {
        let patch = self.at::<M>(x, surfaces, u);
        breaks.clear();
        events(&self.forms, breaks);
        let Self { forms, line, problem, .. } = self;
        integrate(breaks, problem.tolerances[1], |v| line.amount::<M>(forms, &patch, v))
    }
}

/// One line through the brick.
struct Line<'a, const D: usize> {
    region: &'a Region<D>,
    crossings: &'a [Crossing<D>],
    /// Sides of all surfaces; those of the crossing ones change along the line.
    sides: Vec<Option<bool>>,
    cuts: Vec<f64>,
    spans: Vec<[f64; 2]>,
    /// With a single crossing surface: whether its inside and its outside belong to the region.
    alone: Option<[bool; 2]>,
}

impl<const D: usize> Line<'_, D> {
    /// The integral over the part of the line at `v` inside the region.
    fn amount<M: Measure<D>>(&mut self, forms: &[Form<D>], patch: &M::Patch, v: f64) -> M {
        let upto = M::along(patch, v);
        if let (Some(alone), [form]) = (self.alone, forms) {
            let [low, high] = form.inside(v);
            return match alone {
                [true, false] => upto(high) - upto(low),
                [false, true] => upto(low) + (upto(1.0) - upto(high)),
                [true, true] => upto(1.0),
                [false, false] => M::default(),
            };
        }
        self.spans.clear();
        self.cuts.clear();
        for form in forms {
            let span = form.inside(v);
            self.spans.push(span);
            self.cuts.extend(span.into_iter().filter(|w| *w < 1.0));
        }
        self.cuts.push(1.0);
        self.cuts.sort_unstable_by(f64::total_cmp);
        let mut sum = M::default();
        let mut low = 0.0;
        for &high in &self.cuts {
            if high <= low {
                continue;
            }
            let middle = 0.5 * (low + high);
            for ([start, end], crossing) in self.spans.iter().zip(self.crossings) {
                self.sides[crossing.surface] = Some(*start <= middle && middle < *end);
            }
            if self.region.decide(&|i| self.sides[i]) == Some(true) {
                sum = sum + (upto(high) - upto(low));
            }
            low = high;
        }
        sum
    }
}
