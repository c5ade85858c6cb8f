//! Roots of a function of one variable inside a bracket.

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

/// A function with its derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The value.
    pub value: f64,
    /// The derivative.
    pub derivative: f64,
}

/// Newton's method for an increasing function, kept inside the bracket `[low, high]` by bisection.
///
/// From the second step on it uses the evaluation before as well: the inverse function's cubic through both values
/// and derivatives, at zero (order 2.73, Traub 1964). Ends when the residual is at most `tolerance`, when a step no
/// longer moves the position by more than rounding relative to its distance from zero, or after `limit` evaluations.
pub fn newton(
    function: impl Fn(f64) -> Value,
    [mut low, mut high]: [f64; 2],
    start: f64,
    tolerance: f64,
    limit: usize,
) -> Root {
    let mut x = start.clamp(low, high);
    let mut best = Root { position: x, residual: f64::INFINITY, evaluations: 0 };
    let mut before: Option<(f64, Value)> = None;
    while best.evaluations < limit {
        let here = function(x);
        best.evaluations += 1;
        if here.value.abs() < best.residual.abs() {
            best.position = x;
            best.residual = here.value;
        }
        if here.value.abs() <= tolerance {
            break;
        }
        if here.value > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let step = -here.value / here.derivative;
        let curved = before.map_or(step, |(x0, there)| step + inverse_cubic(here, there, x0 - x));
        // A correction as large as the step means that the two points know nothing of each other.
        let step = if (curved - step).abs() < 0.5 * step.abs() { curved } else { step };
        let next = if x + step > low && x + step < high { x + step } else { 0.5 * (low + high) };
        if (next - x).abs() <= f64::EPSILON * x.abs() {
            break;
        }
        before = Some((x, here));
        x = next;
    }
    best
}

/// What the inverse function's cubic adds to Newton's step from `here`, for a second point at the distance `apart`:
/// with `h` the difference of the values, `t = -value / h` and `m` the inverse derivatives,
/// `t^2 (3 apart - 2 h m1 - h m0) + t^3 (h m1 + h m0 - 2 apart)`.
fn inverse_cubic(here: Value, there: Value, apart: f64) -> f64 {
    let h = there.value - here.value;
    let t = -here.value / h;
    let (m1, m0) = (h / here.derivative, h / there.derivative);
    t * t * ((3.0 * apart - 2.0 * m1 - m0) + t * (m1 + m0 - 2.0 * apart))
}

/// Brent's method (Brent 1973, chapter 4): inverse quadratic interpolation and secants, kept safe by bisection.
///
/// The values at the ends of the bracket are given, since the caller often knows them without an evaluation.
/// Ends when the residual is at most `tolerance`, when the bracket cannot shrink, or after `limit` evaluations.
pub fn brent(
    function: impl Fn(f64) -> f64,
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
