//! Polynomials of degree up to eight and their roots between 0 and 1: the places where sections of surfaces turn, meet or leave.

use super::tolerance::DOUBLE_ROOT;

/// Coefficients: discriminants of quadrics have degree 4, resultants of two quadrics 8.
const TERMS: usize = 9;

/// A polynomial, `sum c_i t^i`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polynomial {
    c: [f64; TERMS],
    degree: usize,
}

impl Polynomial {
    pub(super) fn new(coefficients: &[f64]) -> Self {
        let mut c = [0.0; TERMS];
        c[..coefficients.len()].copy_from_slice(coefficients);
        Self { c, degree: coefficients.len() - 1 }
    }

    /// `sum of a * b` over pairs of factors; the degrees must not add up to more than 8.
    pub(super) fn sum_of_products(pairs: &[(f64, &Self, &Self)]) -> Self {
        let mut c = [0.0; TERMS];
        let mut degree = 0;
        for (factor, a, b) in pairs {
            degree = degree.max(a.degree + b.degree);
            for i in 0..=a.degree {
                for j in 0..=b.degree {
                    c[i + j] += factor * a.c[i] * b.c[j];
                }
            }
        }
        Self { c, degree }
    }

    fn at(&self, t: f64) -> f64 {
        (0..=self.degree).rev().fold(0.0, |sum, i| sum * t + self.c[i])
    }

    fn derivative(&self) -> Self {
        let mut c = [0.0; TERMS];
        for i in 1..=self.degree {
            c[i - 1] = i as f64 * self.c[i];
        }
        Self { c, degree: self.degree.saturating_sub(1) }
    }

    /// Hands the roots between 0 and 1 to `found`, near misses of double roots among them; none for the zero polynomial.
    ///
    /// Between the roots of its derivative a polynomial is monotone, so that each root is bracketed; the derivatives
    /// are worked through from the linear one upwards.
    pub(super) fn roots(&self, mut found: impl FnMut(f64)) {
        let scale = self.c.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        if !(scale > 0.0 && scale.is_finite()) {
            return;
        }
        let mut chain = [*self; TERMS];
        for i in 1..=self.degree {
            chain[i] = chain[i - 1].derivative();
        }
        // Roots of the derivative, between the two ends.
        let mut turns = [0.0; TERMS + 1];
        let mut count = 0;
        for order in (0..self.degree).rev() {
            let p = &chain[order];
            let mut roots = [0.0; TERMS + 1];
            let mut n = 0;
            for k in 0..=count {
                let low = if k == 0 { 0.0 } else { turns[k - 1] };
                let high = if k == count { 1.0 } else { turns[k] };
                if let Some(root) = p.bracketed(&chain[order + 1], low, high) {
                    roots[n] = root;
                    n += 1;
                }
            }
            if order == 0 {
                let touching = |t: &&f64| self.at(**t).abs() <= DOUBLE_ROOT * scale;
                turns[..count].iter().filter(touching).for_each(|&t| found(t));
                roots[..n].iter().for_each(|&t| found(t));
            }
            (turns, count) = (roots, n);
        }
    }

    /// The root in an interval on which the polynomial is monotone: Newton's method kept inside the bracket.
    fn bracketed(&self, derivative: &Self, mut low: f64, mut high: f64) -> Option<f64> {
        let (at_low, at_high) = (self.at(low), self.at(high));
        if !(at_low * at_high < 0.0) {
            return (at_low == 0.0 && low < high).then_some(low);
        }
        let rising = at_low < 0.0;
        let mut t = 0.5 * (low + high);
        for _ in 0..80 {
            let value = self.at(t);
            if (value < 0.0) == rising {
                low = t;
            } else {
                high = t;
            }
            let newton = t - value / derivative.at(t);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let step = (next - t).abs();
            t = next;
            if step <= f64::EPSILON {
                break;
            }
        }
        Some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_roots(roots: &[f64]) -> Polynomial {
        roots.iter().fold(Polynomial::new(&[1.0]), |p, root| {
            Polynomial::sum_of_products(&[(1.0, &p, &Polynomial::new(&[-root, 1.0]))])
        })
    }

    fn found(p: &Polynomial) -> Vec<f64> {
        let mut all = Vec::new();
        p.roots(|t| all.push(t));
        all.sort_by(f64::total_cmp);
        all
    }

    #[test]
    fn simple_roots_inside_are_all_found() {
        let roots = found(&with_roots(&[-0.5, 0.1, 0.35, 0.36, 0.9, 2.0]));
        assert_eq!(roots.len(), 4);
        for (root, wanted) in roots.iter().zip([0.1, 0.35, 0.36, 0.9]) {
            assert!((root - wanted).abs() <= 1e-12, "{root} is not {wanted}");
        }
    }

    #[test]
    fn double_roots_are_found_and_vanishing_terms_do_no_harm() {
        let p = Polynomial::sum_of_products(&[(
            1.0,
            &with_roots(&[0.3, 0.3, 0.7]),
            &Polynomial::new(&[1.0, 0.0]),
        )]);
        let roots = found(&p);
        assert!(roots.iter().any(|t| (t - 0.3).abs() <= 1e-7), "{roots:?}");
        assert!(roots.iter().any(|t| (t - 0.7).abs() <= 1e-12), "{roots:?}");
        assert!(found(&Polynomial::new(&[0.0, 0.0, 0.0])).is_empty());
        assert!(found(&Polynomial::new(&[f64::NAN, 1.0])).is_empty());
    }
}
