//! Roots of a function of one variable inside a bracket.

use std::ops::AddAssign;

use crate::simd::either;

/// What a search for a root ended with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Root {
    /// Where the smallest residual was found.
    pub position: f64,
    /// The value of the function there.
    pub residual: f64,
    /// Evaluations of the function.
    pub evaluations: usize,
}

/// A function with its derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Value {
    /// The value.
    pub value: f64,
    /// The derivative.
    pub derivative: f64,
    /// The second derivative, or zero where the function does not give it, which costs a search an evaluation.
    pub second: f64,
}

impl Value {
    /// The function less a constant.
    #[inline(always)]
    pub(crate) fn less(self, constant: f64) -> Self {
        Self { value: self.value - constant, ..self }
    }
}

impl AddAssign for Value {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.value += other.value;
        self.derivative += other.derivative;
        self.second += other.second;
    }
}

/// Newton's method with the second derivative (Halley's), for an increasing function, kept inside the bracket `[low, high]`
/// by bisection.
///
/// From the second step on it uses the evaluation before as well: the inverse function's polynomial of fifth degree through both
/// values and their derivatives, at zero (Traub 1964). Ends when the residual is at most `tolerance`, when a step no longer
/// moves the position by more than rounding relative to its distance from zero, or after `limit` evaluations.
pub fn newton(
    mut function: impl FnMut(f64) -> Value,
    bracket: [f64; 2],
    start: f64,
    tolerance: f64,
    limit: usize,
) -> Root {
    let mut search = Search::new(bracket, start, tolerance);
    while !search.advance(function(search.position), limit) {}
    search.best
}

/// The state of [`newton`] between two evaluations: plain numbers, so that searches may stand side by side in lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Search {
    /// Where the function is wanted next.
    pub(crate) position: f64,
    /// The best that was found.
    pub(crate) best: Root,
    pub(crate) bracket: [f64; 2],
    /// The evaluation before.
    pub(crate) before: (f64, Value),
    pub(crate) tolerance: f64,
}

impl Search {
    #[inline(always)]
    pub(crate) fn new(bracket: [f64; 2], start: f64, tolerance: f64) -> Self {
        let position = start.clamp(bracket[0], bracket[1]);
        let best = Root { position, residual: f64::INFINITY, evaluations: 0 };
        Self { position, best, bracket, before: (position, Value::default()), tolerance }
    }

    /// Takes the function at the position, and says whether the search is at its end, at the latest after `limit` evaluations.
    #[inline(always)]
    pub(crate) fn advance(&mut self, here: Value, limit: usize) -> bool {
        let is_first = self.best.evaluations == 0;
        self.keep(here.value) || !self.step(here, is_first) || self.best.evaluations >= limit
    }

    /// Keeps a value at the position if it is the best, and says whether it is small enough.
    #[inline(always)]
    pub(crate) fn keep(&mut self, value: f64) -> bool {
        let is_better = value.abs() < self.best.residual.abs();
        self.best.position = either(is_better, self.position, self.best.position);
        self.best.residual = either(is_better, value, self.best.residual);
        self.best.evaluations += 1;
        value.abs() <= self.tolerance
    }

    /// Goes on from the function at the position, and says whether that moved it.
    #[inline(always)]
    pub(crate) fn step(&mut self, here: Value, is_first: bool) -> bool {
        let x = self.position;
        let is_past = here.value > 0.0;
        let [low, high] = [either(is_past, self.bracket[0], x), either(is_past, x, self.bracket[1])];
        let (x0, there) = self.before;
        let next = x + step(here, (!is_first).then_some((there, x0 - x)));
        let middle = 0.5 * (low + high);
        self.position = either(next > low, either(next < high, next, middle), middle);
        self.bracket = [low, high];
        self.before = (x, here);
        (self.position - x).abs() > f64::EPSILON * x.abs()
    }
}

/// The step from `here` to where the function is zero, for another point at the distance `apart`, if there is one.
#[inline(always)]
fn step(here: Value, before: Option<(Value, f64)>) -> f64 {
    let inverse = 1.0 / here.derivative;
    let newton = -here.value * inverse;
    let bend = 0.5 * newton * (here.second * inverse);
    let halley = newton / (1.0 + bend);
    let curved = match before {
        None => halley,
        Some((there, apart)) => newton * (1.0 - bend) + inverse_quintic(here, there, apart, inverse),
    };
    // A correction of the size of the step means that there is no such function near here.
    let is_small = |step: f64| (step - newton).abs() < 0.5 * newton.abs();
    either(is_small(curved), curved, either(is_small(halley), halley, newton))
}

/// What the inverse function's polynomial of fifth degree adds to its terms up to the second power, for a second point at the
/// distance `apart`: in `t`, which is 0 here and 1 there, with derivatives of the inverse function by it.
#[inline(always)]
fn inverse_quintic(here: Value, there: Value, apart: f64, inverse: f64) -> f64 {
    let h = there.value - here.value;
    let t = -here.value / h;
    let (first, there_first) = (h * inverse, h / there.derivative);
    let second = -(first * first) * (here.second * inverse);
    let there_second = -(there_first * there_first) * (there.second / there.derivative);
    let value = apart - first - 0.5 * second;
    let slope = there_first - first - second;
    let curvature = there_second - second;
    let cubic = 10.0 * value - 4.0 * slope + 0.5 * curvature;
    let fourth = 7.0 * slope - 15.0 * value - curvature;
    let fifth = 6.0 * value - 3.0 * slope + 0.5 * curvature;
    t * t * t * (cubic + t * (fourth + t * fifth))
}

/// Brent's method (Brent 1973, chapter 4): inverse quadratic interpolation and secants, kept safe by bisection.
///
/// The values at the ends of the bracket are given, since the caller often knows them without an evaluation.
/// Ends when the residual is at most `tolerance`, when the bracket cannot shrink, or after `limit` evaluations.
pub fn brent(
    mut function: impl FnMut(f64) -> f64,
    bracket: [f64; 2],
    values: [f64; 2],
    tolerance: f64,
    limit: usize,
) -> Root {
    let resolution = f64::EPSILON * (bracket[1] - bracket[0]).abs();
    // b is the best point, a the one before, c the other end of the bracket.
    let [mut a, mut b] = bracket;
    let [mut fa, mut fb] = values;
    let (mut c, mut fc) = (a, fa);
    let mut previous_step = b - a;
    let mut step = previous_step;
    let mut evaluations = 0;
    loop {
        if fc.abs() < fb.abs() {
            (a, fa) = (b, fb);
            (b, fb) = (c, fc);
            (c, fc) = (a, fa);
        }
        let half_width = 0.5 * (c - b);
        if fb.abs() <= tolerance || half_width.abs() <= resolution || evaluations >= limit {
            return Root { position: b, residual: fb, evaluations };
        }
        let mut bisect = previous_step.abs() < resolution || fa.abs() <= fb.abs();
        if !bisect {
            let s = fb / fa;
            let (mut p, mut q) = if a == c {
                (2.0 * half_width * s, 1.0 - s)
            } else {
                let (u, r) = (fa / fc, fb / fc);
                (
                    s * (2.0 * half_width * u * (u - r) - (b - a) * (r - 1.0)),
                    (u - 1.0) * (r - 1.0) * (s - 1.0),
                )
            };
            if p > 0.0 {
                q = -q;
            }
            p = p.abs();
            let inside = 2.0 * p < (3.0 * half_width * q - (resolution * q).abs());
            if inside && 2.0 * p < (previous_step * q).abs() {
                previous_step = step;
                step = p / q;
            } else {
                bisect = true;
            }
        }
        if bisect {
            step = half_width;
            previous_step = step;
        }
        (a, fa) = (b, fb);
        b += if step.abs() > resolution { step } else { resolution.copysign(half_width) };
        fb = function(b);
        evaluations += 1;
        if (fb > 0.0) == (fc > 0.0) {
            (c, fc) = (a, fa);
            previous_step = b - a;
            step = previous_step;
        }
    }
}
