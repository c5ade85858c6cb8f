//! From a cell to bricks in which the quadrature converges fast: which bricks are pure, which direction to integrate along,
//! and where to bisect instead.
//!
//! In 3D the integrand over sections of constant `u` is smooth, apart from events on the faces, if no surface is tangent to
//! a section inside the brick, and no intersection of two surfaces either. A surface is not if its height changes
//! monotonically along `v` or along `w`; bounds on the slopes come from the convex hull of their values at the
//! corners, which holds because the frame of a surface is multilinear.

use vofkit_geometry::Vector;

use super::brick::{Brick, CORNERS, ball, edges};
use super::integral::{Crossing, Problem};
use super::measure::Measure;
use super::region::Region;
use super::tolerance::{
    BISECTIONS, BRICKS, FLAT, LEVEL, PAIR_BISECTIONS, QUADRATURE, REACH, ROUNDING, SECTION,
};

/// A cell that a region cuts.
pub(super) struct Cut<'a, const D: usize> {
    region: &'a Region<D>,
    /// The origin of the bricks' coordinates.
    anchor: Vector<D>,
    /// Whether to integrate along lines at fixed places, and never to bisect.
    sampled: bool,
    bricks: usize,
}

impl<'a, const D: usize> Cut<'a, D> {
    pub(super) fn new(region: &'a Region<D>, anchor: Vector<D>) -> Self {
        Self { region, anchor, sampled: false, bricks: 0 }
    }

    /// The same by lines at fixed places: to a thousandth, however the surfaces lie.
    pub(super) fn sampled(region: &'a Region<D>, anchor: Vector<D>) -> Self {
        Self { sampled: true, ..Self::new(region, anchor) }
    }

    /// The measure of the part of a brick inside the region. `sides` are those of the surfaces that are known not to cross it, after
    /// `depth` bisections.
    pub(super) fn integral<M: Measure<D>>(
        &mut self,
        brick: &Brick<D>,
        sides: &[Option<bool>],
        depth: usize,
    ) -> M {
        self.bricks += 1;
        let mut sides = sides.to_vec();
        let mut looks: Vec<Look<D>> = Vec::new();
        for surface in self.region.open(&sides) {
            match self.look(brick, surface) {
                Ok(side) => sides[surface] = Some(side),
                Err(look) => looks.push(look),
            }
        }
        if let Some(inside) = self.region.decide(&|i| sides[i]) {
            return if inside { M::of_brick(brick) } else { M::default() };
        }
        let open = self.region.open(&sides);
        looks.retain(|look| open.contains(&look.crossing.surface));
        let plan = Plan::new(&looks);
        let may_bisect = !self.sampled && self.bricks < BRICKS && depth < BISECTIONS;
        if may_bisect && (plan.hard || (plan.tangled && depth < PAIR_BISECTIONS)) {
            let axis = longest(&looks);
            return [0, 1]
                .map(|side| self.integral::<M>(&brick.half(axis, side), &sides, depth + 1))
                .into_iter()
                .sum();
        }
        let scale = brick.volume().abs() + FLAT * brick.hull();
        let rounding = looks.iter().map(Look::rounding).fold(0.0, f64::max);
        let crossings: Vec<_> = looks.into_iter().map(|look| look.crossing).collect();
        let tolerances = [QUADRATURE, SECTION].map(|error| error.max(rounding) * scale);
        let problem = Problem {
            region: self.region,
            sides: &sides,
            crossings: &crossings,
            order: plan.order,
            tolerances,
        };
        if self.sampled { problem.sampled(brick) } else { problem.integral(brick) }
    }

    /// The side of a surface on which the brick lies, or how the surface may cross it.
    fn look(&self, brick: &Brick<D>, surface: usize) -> Result<bool, Look<D>> {
        let own = &self.region.surfaces[surface];
        let mut frame = [Vector::zeros(); CORNERS];
        for (y, x) in frame.iter_mut().zip(brick.corners()) {
            *y = own.frame(&self.anchor, x);
        }
        let mut look = Look {
            crossing: Crossing { surface, curved: own.curved, frame, once: [false; D] },
            heights: [0.0; CORNERS],
            slopes: [[0.0; 2]; D],
            reach: 0.0,
        };
        for i in 0..1 << D {
            look.heights[i] = if own.curved { frame[i].norm_squared() - 1.0 } else { frame[i][0] };
        }
        let heights = &look.heights[..1 << D];
        // The brick lies in the convex hull of its corners.
        if heights.iter().all(|&h| h <= 0.0) {
            return Ok(true);
        }
        if own.curved {
            let (centre, radius) = ball(&frame[..1 << D]);
            if centre.norm() - radius > 1.0 {
                return Ok(false);
            }
            look.reach = radius;
        } else if heights.iter().all(|&h| h >= 0.0) {
            return Ok(false);
        }
        look.bound_slopes();
        Err(look)
    }
}

/// A surface that may cross a brick, with bounds.
struct Look<const D: usize> {
    crossing: Crossing<D>,
    /// `y_0` or `|y|^2 - 1` at the corners.
    heights: [f64; CORNERS],
    /// Bounds of the derivative of the height (half of it where curved) along each axis.
    slopes: [[f64; 2]; D],
    /// The distance from the middle to the corners in the frame of a curved surface.
    reach: f64,
}

impl<const D: usize> Look<D> {
    fn bound_slopes(&mut self) {
        let y = &self.crossing.frame;
        for axis in 0..D {
            let mut bounds = [f64::INFINITY, f64::NEG_INFINITY];
            let mut include = |slope: f64| bounds = [bounds[0].min(slope), bounds[1].max(slope)];
            for [a, b] in edges::<D>(axis) {
                let edge = y[b] - y[a];
                if self.crossing.curved {
                    y[..1 << D].iter().for_each(|y| include(y.dot(&edge)));
                } else {
                    include(edge[0]);
                }
            }
            self.slopes[axis] = bounds;
            self.crossing.once[axis] = bounds[0] > 0.0 || bounds[1] < 0.0;
        }
    }

    fn steepest(&self) -> f64 {
        self.slopes.iter().flatten().fold(0.0, |m: f64, s| m.max(s.abs()))
    }

    /// Whether the height is constant along an axis, up to rounding.
    fn level(&self, axis: usize) -> bool {
        let [low, high] = self.slopes[axis];
        low.abs().max(high.abs()) <= LEVEL * self.steepest()
    }

    fn mean_slope(&self, axis: usize) -> f64 {
        0.5 * (self.slopes[axis][0] + self.slopes[axis][1])
    }

    /// Share of an axis in the slopes.
    fn share(&self, axis: usize) -> f64 {
        let total: f64 = (0..D).map(|k| self.mean_slope(k).abs()).sum();
        if total > 0.0 { self.mean_slope(axis).abs() / total } else { 0.0 }
    }

    /// Rounding of the place of a crossing, relative to the brick.
    fn rounding(&self) -> f64 {
        if !self.crossing.curved {
            return 0.0;
        }
        let highest = self.heights[..1 << D].iter().fold(0.0, |m: f64, h| m.max(h.abs()));
        ROUNDING * (2.0 + highest) / self.steepest()
    }

    /// Whether a linear combination of the heights proves that two surfaces do not meet in the brick.
    fn apart(&self, other: &Self) -> bool {
        let product = |a: &Self, b: &Self| (0..D).map(|k| a.mean_slope(k) * b.mean_slope(k)).sum::<f64>();
        let factor = product(self, other) / product(other, other);
        let bounds = (0..1 << D)
            .map(|i| self.heights[i] - factor * other.heights[i])
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], d| [low.min(d), high.max(d)]);
        // |y|^2 falls below the interpolant of its values at the corners by at most the square of the reach.
        let (sag, other_sag) = (self.reach.powi(2), factor.abs() * other.reach.powi(2));
        let below = sag + if factor < 0.0 { other_sag } else { 0.0 };
        let above = if factor > 0.0 { other_sag } else { 0.0 };
        bounds[0] - below > 0.0 || bounds[1] + above < 0.0
    }

    /// Whether the intersection with another surface may be tangent to sections across axes `v` and `w`: whether
    /// `f_v g_w - f_w g_v` may vanish.
    fn tangled(&self, other: &Self, v: usize, w: usize) -> bool {
        let range = |a: [f64; 2], b: [f64; 2]| {
            let all = [a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]];
            (all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max))
        };
        let (first, second) =
            (range(self.slopes[v], other.slopes[w]), range(self.slopes[w], other.slopes[v]));
        first.0 <= second.1 && second.0 <= first.1
    }
}

/// How to integrate over a brick.
struct Plan {
    /// The axes that become `w`, `v` and, in 3D, `u`.
    order: [usize; 3],
    /// A surface may be tangent to a section, or is much smaller than the brick.
    hard: bool,
    /// The intersection of two surfaces may be tangent to a section, or three may meet.
    tangled: bool,
}

impl Plan {
    /// The best choice of directions: few tangencies, then lines that cross each surface once, then steep crossings.
    fn new<const D: usize>(looks: &[Look<D>]) -> Self {
        let mut best = Self { order: [1, 0, 2], hard: false, tangled: false };
        let mut least = f64::INFINITY;
        let large = looks.iter().any(|look| look.reach > REACH);
        let corner = D == 3 && may_have_corner(looks);
        for order in [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 0, 1], [1, 2, 0], [2, 1, 0]] {
            let [w, v, u] = order;
            if D == 2 && u != 2 {
                continue;
            }
            let (mut hard, mut tangled, mut cost) = (large, corner, 0.0);
            for (i, look) in looks.iter().enumerate() {
                let crossing = &look.crossing;
                let along_u = !crossing.curved && look.level(v) && look.level(w);
                hard |= D == 3 && !(crossing.once[w] || crossing.once[v] || along_u);
                tangled |=
                    D == 3 && looks[..i].iter().any(|other| look.tangled(other, v, w) && !look.apart(other));
                cost += f64::from(u8::from(!crossing.once[w])) - 0.5 * look.share(w) - 0.2 * look.share(v);
            }
            cost += 1e6 * f64::from(u8::from(hard)) + 1e3 * f64::from(u8::from(tangled));
            if cost < least {
                least = cost;
                best = Self { order, hard, tangled };
            }
        }
        best
    }
}

/// Whether three surfaces may meet in the brick: whether no pair of some three is apart.
fn may_have_corner<const D: usize>(looks: &[Look<D>]) -> bool {
    let near = |a: usize, b: usize| !looks[a].apart(&looks[b]);
    let mut pairs = (0..looks.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    looks.len() > 2 && pairs.any(|(a, b)| near(a, b) && (0..b).any(|c| near(a, c) && near(b, c)))
}

/// The axis along which the surfaces change most.
fn longest<const D: usize>(looks: &[Look<D>]) -> usize {
    let length = |axis: usize| -> f64 {
        let of = |look: &Look<D>, axis: usize| {
            let y = &look.crossing.frame;
            let sum: Vector<D> = edges::<D>(axis).map(|[a, b]| y[b] - y[a]).sum();
            sum.norm()
        };
        let share = |look| of(look, axis) / (0..D).map(|k| of(look, k)).sum::<f64>().max(f64::MIN_POSITIVE);
        looks.iter().map(share).sum()
    };
    (1..D).fold(0, |best, axis| if length(axis) > length(best) { axis } else { best })
}
