//! Roots of a function of one variable inside a bracket.

use std::ops::AddAssign;

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
    let mut search = Search::new(bracket, start, tolerance, limit);
    while !search.advance(function(search.position)) {}
    search.best
}

/// The state of [`newton`] between two evaluations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Search {
    /// Where the function is wanted next.
    pub(crate) position: f64,
    /// The best that was found.
    pub(crate) best: Root,
    bracket: [f64; 2],
    before: Option<(f64, Value)>,
    tolerance: f64,
    limit: usize,
}

impl Search {
    #[inline(always)]
    pub(crate) fn new(bracket: [f64; 2], start: f64, tolerance: f64, limit: usize) -> Self {
        let position = start.clamp(bracket[0], bracket[1]);
        let best = Root { position, residual: f64::INFINITY, evaluations: 0 };
        Self { position, best, bracket, before: None, tolerance, limit }
    }

    /// Takes the function at the position, and says whether the search is at its end.
    #[inline(always)]
    pub(crate) fn advance(&mut self, here: Value) -> bool {
        let x = self.position;
        self.best.evaluations += 1;
        if here.value.abs() < self.best.residual.abs() {
            self.best.position = x;
            self.best.residual = here.value;
        }
        if here.value.abs() <= self.tolerance {
            return true;
        }
        self.bracket[usize::from(here.value > 0.0)] = x;
        let [low, high] = self.bracket;
        let step = step(here, self.before.map(|(x0, there)| (there, x0 - x)));
        let next = if x + step > low && x + step < high { x + step } else { 0.5 * (low + high) };
        self.before = Some((x, here));
        self.position = next;
        (next - x).abs() <= f64::EPSILON * x.abs() || self.best.evaluations >= self.limit
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
    [curved, halley].into_iter().find(|step| (step - newton).abs() < 0.5 * newton.abs()).unwrap_or(newton)
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
