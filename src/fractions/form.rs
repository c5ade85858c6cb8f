//! Surfaces on a bilinear patch: where lines cross them, and where those crossings come, go or change places.
//!
//! On a patch with coordinates `p, q` a surface's frame is bilinear, `y = k0 + k1 q + (k2 + k3 q) p`. A line of constant
//! `p` is straight, so that it crosses a plane once and a curved surface at the roots of
//!
//! ```text
//! A q^2 + 2 B q + C = 0,   A = y1.y1,  B = y0.y1,  C = y0.y0 - 1,   y0 = k0 + k2 p,  y1 = k1 + k3 p
//! ```
//!
//! and `A, B, C` are quadratics in `p`. Everything that happens to the crossings as `p` runs is a root of a polynomial in `p`.

use vofkit_geometry::Vector;

use super::polynomial::Polynomial;
use super::quadrature::Breaks;

/// A surface on a patch: the coefficients of `1`, `q`, `p` and `p q` of its frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Form<const D: usize> {
    pub(super) curved: bool,
    /// Every line of constant `p` crosses the surface at most once.
    pub(super) once: bool,
    pub(super) k: [Vector<D>; 4],
}

/// The empty span.
const NOWHERE: [f64; 2] = [f64::INFINITY; 2];
const EVERYWHERE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// The parameters between which the line `y0 + t y1` is inside a surface.
pub(super) fn span<const D: usize>(curved: bool, y0: &Vector<D>, y1: &Vector<D>) -> [f64; 2] {
    if !curved {
        let (height, slope) = (y0[0], y1[0]);
        let crossing = -height / slope;
        return match slope {
            _ if slope > 0.0 => [f64::NEG_INFINITY, crossing],
            _ if slope < 0.0 => [crossing, f64::INFINITY],
            _ if height <= 0.0 => EVERYWHERE,
            _ => NOWHERE,
        };
    }
    let (a, b, c) = (y1.norm_squared(), y0.dot(y1), y0.norm_squared() - 1.0);
    if a <= f64::MIN_POSITIVE {
        return if c <= 0.0 { EVERYWHERE } else { NOWHERE };
    }
    // The point of the line next to the centre gives the discriminant without cancellation.
    let within = 1.0 - (y0 - y1 * (b / a)).norm_squared();
    if within <= 0.0 {
        return NOWHERE;
    }
    let far = -(b + (a * within).sqrt().copysign(b));
    let [s, t] = [far / a, c / far];
    if s < t { [s, t] } else { [t, s] }
}

impl<const D: usize> Form<D> {
    /// The part of the line at `p` inside the surface, within `[0, 1]`.
    pub(super) fn inside(&self, p: f64) -> [f64; 2] {
        let k = &self.k;
        span(self.curved, &(k[0] + k[2] * p), &(k[1] + k[3] * p)).map(|t| t.clamp(0.0, 1.0))
    }

    /// The coefficients, as polynomials in `p`, of the equation in `q`: of `q^2`, of `q` (halved where curved), of 1.
    fn equation(&self) -> [Polynomial; 3] {
        let k = &self.k;
        if !self.curved {
            return [
                Polynomial::new(&[0.0]),
                Polynomial::new(&[k[1][0], k[3][0]]),
                Polynomial::new(&[k[0][0], k[2][0]]),
            ];
        }
        let product = |a: usize, b: usize, minus: f64| {
            Polynomial::new(&[
                k[a].dot(&k[b]) - minus,
                k[a].dot(&k[b + 2]) + k[a + 2].dot(&k[b]),
                k[a + 2].dot(&k[b + 2]),
            ])
        };
        [product(1, 1, 0.0), product(0, 1, 0.0), product(0, 0, 1.0)]
    }

    /// Adds the `p` at which the surface crosses the sides `q = 0` and `q = 1`, and at which it turns back in `q`.
    fn turns(&self, breaks: &mut Breaks) {
        let k = &self.k;
        for [y0, y1] in [[k[0], k[2]], [k[0] + k[1], k[2] + k[3]]] {
            span(self.curved, &y0, &y1).into_iter().for_each(|p| breaks.add(p, false));
        }
        if self.curved && !self.once {
            let [a, b, c] = &self.equation();
            Polynomial::sum_of_products(&[(1.0, b, b), (-1.0, a, c)]).roots(|p| breaks.add(p, true));
        }
    }

    /// Adds the `p` at which two surfaces cross: the roots of the resultant of their equations.
    fn meetings(&self, other: &Self, breaks: &mut Breaks) {
        let sum = Polynomial::sum_of_products;
        let resultant = match (self.curved, other.curved) {
            (true, false) => return other.meetings(self, breaks),
            (false, false) => {
                let ([_, s1, s0], [_, t1, t0]) = (&self.equation(), &other.equation());
                sum(&[(1.0, s0, t1), (-1.0, s1, t0)])
            }
            (false, true) => {
                let ([_, s1, s0], [a, b, c]) = (&self.equation(), &other.equation());
                let [s00, s01, s11] = &[sum(&[(1.0, s0, s0)]), sum(&[(1.0, s0, s1)]), sum(&[(1.0, s1, s1)])];
                sum(&[(1.0, a, s00), (-2.0, b, s01), (1.0, c, s11)])
            }
            (true, true) => {
                let ([a, b, c], [d, e, f]) = (&self.equation(), &other.equation());
                let minor = |a, b, c, d| sum(&[(1.0, a, d), (-1.0, b, c)]);
                let [ac, ab, bc] = &[minor(a, c, d, f), minor(a, b, d, e), minor(b, c, e, f)];
                sum(&[(1.0, ac, ac), (-4.0, ab, bc)])
            }
        };
        resultant.roots(|p| breaks.add(p, false));
    }
}

/// Adds every `p` at which the part of the line inside a combination of the surfaces fails to be a smooth function of `p`.
pub(super) fn events<const D: usize>(forms: &[Form<D>], breaks: &mut Breaks) {
    for (i, form) in forms.iter().enumerate() {
        form.turns(breaks);
        forms[..i].iter().for_each(|other| form.meetings(other, breaks));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Vector2 = Vector<2>;

    #[test]
    fn spans_of_a_circle_and_a_line() {
        let [s, t] = span(true, &Vector2::new(-2.0, 0.6), &Vector2::new(4.0, 0.0));
        assert!((s - 0.3).abs() <= 1e-15 && (t - 0.7).abs() <= 1e-15, "{s} {t}");
        assert_eq!(span(true, &Vector2::new(-2.0, 1.0), &Vector2::new(4.0, 0.0)), NOWHERE);
        assert_eq!(span(true, &Vector2::new(0.5, 0.0), &Vector2::zeros()), EVERYWHERE);
        let span = span(false, &Vector2::new(-1.0, 7.0), &Vector2::new(2.0, 5.0));
        assert_eq!(span, [f64::NEG_INFINITY, 0.5]);
    }

    #[test]
    fn two_circles_meet_where_they_meet() {
        // Unit circles about the origin and (1, 0) on the square [-2, 2]^2 cross at x = 1/2: p = 5/8.
        let circle = |centre: f64| Form {
            curved: true,
            once: false,
            k: [
                Vector2::new(-2.0 - centre, -2.0),
                Vector2::new(0.0, 4.0),
                Vector2::new(4.0, 0.0),
                Vector2::zeros(),
            ],
        };
        let mut breaks = Breaks::default();
        events(&[circle(0.0), circle(1.0)], &mut breaks);
        let found = breaks.settled();
        for wanted in [0.25, 0.5, 0.625, 0.75, 1.0] {
            let near = |(p, _): &(f64, bool)| (p - wanted).abs() <= 1e-6;
            assert!(wanted == 1.0 || found.iter().any(near), "{wanted} is not in {found:?}");
        }
    }
}
