//! Adaptive Gauss-Legendre quadrature between break points.

use std::num::NonZeroUsize;
use std::ops::{Add, Mul};
use std::sync::LazyLock;

use gauss_quad::GaussLegendre;

use super::tolerance::{BREAKS_APART, PIECES};

/// Nodes of a piece.
const NODES: usize = 10;

/// The rule on `[0, 1]`, with what takes values at its nodes to the Legendre coefficients of the integrand.
struct Rule {
    nodes: [f64; NODES],
    weights: [f64; NODES],
    /// `(2k + 1) w_i P_k(x_i)` for the last two coefficients and for the two in the middle.
    last: [[f64; NODES]; 2],
    middle: [[f64; NODES]; 2],
}

static RULE: LazyLock<Rule> = LazyLock::new(|| {
    let rule = GaussLegendre::new(NonZeroUsize::new(NODES).expect("there are nodes"));
    let pairs = rule.as_node_weight_pairs();
    let coefficient =
        |k: usize| std::array::from_fn(|i| (2 * k + 1) as f64 * 0.5 * pairs[i].1 * legendre(k, pairs[i].0));
    Rule {
        nodes: std::array::from_fn(|i| 0.5 + 0.5 * pairs[i].0),
        weights: std::array::from_fn(|i| 0.5 * pairs[i].1),
        last: [NODES - 1, NODES - 2].map(coefficient),
        middle: [NODES / 2 - 1, NODES / 2 - 2].map(coefficient),
    }
});

/// The Legendre polynomial `P_k(x)` by its recurrence.
fn legendre(k: usize, x: f64) -> f64 {
    let mut pair = [1.0, x];
    for i in 1..k {
        let i = i as f64;
        pair = [pair[1], ((2.0 * i + 1.0) * x * pair[1] - i * pair[0]) / (i + 1.0)];
    }
    pair[k.min(1)]
}

/// Points of `[0, 1]` between which an integrand is smooth.
#[derive(Clone, Debug, Default)]
pub(super) struct Breaks {
    /// Each with whether the integrand may behave like a power of the square root of the distance.
    points: Vec<(f64, bool)>,
}

impl Breaks {
    pub(super) fn clear(&mut self) {
        self.points.clear();
    }

    /// Adds a point; those outside are left out. `root` where the integrand may behave like a square root.
    pub(super) fn add(&mut self, t: f64, root: bool) {
        if t > 0.0 && t < 1.0 {
            self.points.push((t, root));
        }
    }

    #[cfg(test)]
    pub(super) fn settled(mut self) -> Vec<(f64, bool)> {
        self.settle();
        self.points
    }

    fn settle(&mut self) {
        self.points.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        self.points.dedup_by(|next, kept| {
            let one = next.0 - kept.0 <= BREAKS_APART;
            kept.1 |= one && next.1;
            one
        });
    }
}

/// Nodes and weights on `[0, 1]` for integrands of which nothing is known: the rule on each half.
pub(super) fn fixed() -> impl Iterator<Item = (f64, f64)> {
    [0.0, 0.5].into_iter().flat_map(|start| {
        RULE.nodes.iter().zip(&RULE.weights).map(move |(node, weight)| (start + 0.5 * node, 0.5 * weight))
    })
}

/// What can be integrated.
pub(super) trait Amount: Copy + Default + Add<Output = Self> + Mul<f64, Output = Self> {
    /// The size of the Legendre coefficients that a rule does not see, extrapolated as in [`adaptive`] from the `last` two that it does, by
    /// way of two in the `middle`: the largest among the components.
    fn tail(last: [Self; 2], middle: [Self; 2]) -> f64;
}

impl Amount for f64 {
    fn tail(last: [Self; 2], middle: [Self; 2]) -> f64 {
        tail(last, middle)
    }
}

/// [`Amount::tail`] of numbers.
pub(super) fn tail(last: [f64; 2], middle: [f64; 2]) -> f64 {
    let [last, middle] = [last, middle].map(|[a, b]| a.abs().max(b.abs()));
    last * if last < middle { last / middle } else { 1.0 }
}

/// The integral over `[0, 1]` of a function that is smooth between the breaks, each smooth piece to an error below
/// `tolerance`.
pub(super) fn integrate<A: Amount>(
    breaks: &mut Breaks,
    tolerance: f64,
    mut integrand: impl FnMut(f64) -> A,
) -> A {
    breaks.settle();
    let ends = breaks.points.iter().copied().chain([(1.0, false)]);
    let mut budget = PIECES;
    let mut low = (0.0, false);
    let mut sum = A::default();
    for high in ends {
        let segment = Segment { low: low.0, width: high.0 - low.0, roots: [low.1, high.1] };
        let mut substituted = |t: f64| {
            let (x, derivative) = segment.place(t);
            integrand(x) * derivative
        };
        sum = sum + adaptive(&mut substituted, 0.0, 1.0, tolerance, &mut budget);
        low = high;
    }
    sum
}

/// The part between two breaks.
struct Segment {
    low: f64,
    width: f64,
    roots: [bool; 2],
}

impl Segment {
    /// The point at parameter `t` and its derivative: `t^2`, `t (2 - t)` or `t^2 (3 - 2 t)` of the way takes square
    /// roots of the distance to the lower, the upper or both ends to polynomials.
    fn place(&self, t: f64) -> (f64, f64) {
        let (way, derivative) = match self.roots {
            [false, false] => (t, 1.0),
            [true, false] => (t * t, 2.0 * t),
            [false, true] => (t * (2.0 - t), 2.0 * (1.0 - t)),
            [true, true] => (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t)),
        };
        (self.low + self.width * way, self.width * derivative)
    }
}

/// The integral over `[low, low + width]`, bisected until the error is below `tolerance`.
///
/// The rule with `n` nodes is wrong by the Legendre coefficients from `2 n` on. They are extrapolated from the decay between the
/// middle and the last of the `n` that the nodes determine: `|c_last| |c_last / c_middle|`, which a smooth integrand meets with the
/// square of the ratio. The spare power catches features that the nodes barely see.
fn adaptive<A: Amount>(
    f: &mut impl FnMut(f64) -> A,
    low: f64,
    width: f64,
    tolerance: f64,
    budget: &mut usize,
) -> A {
    let rule = &*RULE;
    let values: [A; NODES] = std::array::from_fn(|i| f(low + width * rule.nodes[i]));
    let dot =
        |weights: &[f64; NODES]| weights.iter().zip(&values).fold(A::default(), |sum, (w, v)| sum + *v * *w);
    let unseen = A::tail(rule.last.each_ref().map(dot), rule.middle.each_ref().map(dot));
    if width * unseen <= tolerance || *budget == 0 {
        return dot(&rule.weights) * width;
    }
    *budget -= 1;
    let half = 0.5 * width;
    adaptive(f, low, half, tolerance, budget) + adaptive(f, low + half, half, tolerance, budget)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error(points: &[(f64, bool)], f: impl Fn(f64) -> f64, exact: f64) -> (f64, usize) {
        let mut breaks = Breaks::default();
        points.iter().for_each(|&(t, root)| breaks.add(t, root));
        let mut calls = 0;
        let integral = integrate(&mut breaks, 1e-12, |t| {
            calls += 1;
            f(t)
        });
        ((integral - exact).abs(), calls)
    }

    #[test]
    fn smooth_pieces_take_one_rule_each() {
        assert!(error(&[], |t| t.powi(9), 0.1).0 <= 1e-16);
        let (kink, calls) = error(&[(0.3, false)], |t| (t - 0.3).abs(), 0.29);
        assert!(kink <= 1e-15 && calls == 2 * NODES, "{kink} in {calls}");
        let (root, calls) = error(&[(0.3, true)], |t| (t - 0.3).max(0.0).sqrt(), 0.7_f64.powf(1.5) / 1.5);
        assert!(root <= 1e-15 && calls == 2 * NODES, "{root} in {calls}");
    }

    #[test]
    fn unannounced_features_are_bisected() {
        let (kink, calls) = error(&[], |t| (t - 0.3).abs(), 0.29);
        assert!(kink <= 1e-10 && calls <= 50 * NODES, "{kink} in {calls}");
        let (root, calls) = error(&[], |t| (t - 0.3).max(0.0).sqrt(), 0.7_f64.powf(1.5) / 1.5);
        assert!(root <= 1e-10 && calls <= 80 * NODES, "{root} in {calls}");
        let (noise, calls) = error(&[], |t| (t * 1e9).sin().signum(), 0.0);
        assert!(noise.is_finite() && calls <= (2 * PIECES + 1) * NODES, "{calls} calls");
    }
}
