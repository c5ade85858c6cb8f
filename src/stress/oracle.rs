//! Truncated volumes and section areas in double-double arithmetic, of some 31 digits, by other formulas than the kernel's.
//!
//! With a vector `t` across the normal, the field `(t.x) t / t.t` has the divergence 1, and nothing of it crosses the plane. So the
//! truncated volume is what of it leaves through the parts of the faces below the plane, and the section's area is what of the normal
//! enters through them. On a ruled face `x(a, b)` the height above the plane is linear in `b`: up to the plane, at `b*(a)`, the
//! integrals over `b` are those of polynomials. What remains is a rational function of `a` that has its only pole where the height
//! does not depend on `b`, and is smooth between the places where the plane meets an edge. There it is integrated by Gauss's rule, on
//! intervals that are halved towards the pole until none is longer than twice its distance from it.

use std::sync::LazyLock;

use twofloat::TwoFloat;
use vofkit_geometry::{Cell, Hexahedron, Vector};

/// Points of Gauss's rule. A pole one length away from an interval leaves an error of `(2 + sqrt 3)^(-2 POINTS) = 1e-23` of the largest
/// value.
const POINTS: usize = 20;

/// Halvings of an interval at most: what is left is shorter than the rounding of its ends.
const HALVINGS: usize = 108;

/// What a plane leaves of a hexahedron, rounded from some 31 digits. Volumes have the sign of the cell's orientation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exact {
    pub(super) cell_volume: f64,
    pub(super) truncated_volume: f64,
    /// Relative to the square of the normal's length: the derivative of the truncated volume by the plane constant.
    pub(super) section_area: f64,
    /// How much that changes when the plane moves to either side by the rounding of its distance from the cell's farthest node.
    pub(super) area_rounding: f64,
}

type Point = [TwoFloat; 3];

/// `c0 + c1 s`.
type Linear = [TwoFloat; 2];

const ZERO: TwoFloat = TwoFloat::from_f64(0.0);
const ONE: TwoFloat = TwoFloat::from_f64(1.0);

/// Places in `[-1, 1]` and weights.
static RULE: LazyLock<[(TwoFloat, TwoFloat); POINTS]> = LazyLock::new(|| std::array::from_fn(gauss));

/// The part of a hexahedron where `n.x <= d`.
pub(super) fn truncate(nodes: &[Vector<3>; 8], normal: &Vector<3>, constant: f64) -> Exact {
    let origin = nodes[0];
    let points = nodes.map(|x| [0, 1, 2].map(|axis| TwoFloat::new_sub(x[axis], origin[axis])));
    let n = [0, 1, 2].map(|axis| TwoFloat::from_f64(normal[axis]));
    let at_origin = [0, 1, 2].map(|axis| TwoFloat::new_mul(normal[axis], origin[axis]));
    let local = TwoFloat::from_f64(constant) - (at_origin[0] + at_origin[1] + at_origin[2]);
    // The normal turned by a right angle about the axis that it is farthest from: across it to the last bit.
    let least = (0..3).min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
    let [i, j] = [(least + 1) % 3, (least + 2) % 3];
    let mut t = [ZERO; 3];
    (t[i], t[j]) = (n[j], -n[i]);
    let faces = |local: TwoFloat| {
        let face = move |nodes: &&[usize]| Face::new([0, 1, 2, 3].map(|k| points[nodes[k]]), &t, &n, local);
        Hexahedron::FACE_NODES.iter().map(face)
    };
    let below = |local: TwoFloat| faces(local).fold([ZERO; 2], |sum, face| plus(&sum, &face.below()));
    let whole = faces(local).fold(ZERO, |sum, face| {
        let of_face = integral([ZERO, ONE], None, &|a| face.through(a, ONE));
        sum + of_face[0]
    });
    let [of_t, of_n] = below(local);
    let farthest = points.iter().map(|x| (dot(&n, x) - local).hi().abs()).fold(0.0, f64::max);
    let area = |of_n: TwoFloat| quotient(-of_n, dot(&n, &n));
    let moved = [-f64::EPSILON, f64::EPSILON].map(|share| {
        let [_, of_n_moved] = below(local + share * farthest);
        area(of_n_moved - of_n).hi().abs()
    });
    let square = dot(&t, &t);
    Exact {
        cell_volume: quotient(whole, square).hi(),
        truncated_volume: quotient(of_t, square).hi(),
        section_area: area(of_n).hi(),
        area_rounding: moved[0].max(moved[1]),
    }
}

/// What crosses a ruled face `x(a, b)` of the field along `t` and of the normal.
struct Face {
    /// `t.x` at `b = 0`, and its derivative by `b`.
    along: [Linear; 2],
    /// `t.dx_a x dx_b` at `b = 0`, and its derivative by `b`.
    across: [Linear; 2],
    /// The same of the normal.
    normal: [Linear; 2],
    /// The height above the plane at `b = 0` and at `b = 1`.
    heights: [Linear; 2],
}

impl Face {
    /// From its corners (0, 0), (1, 0), (1, 1), (0, 1), in outward order.
    fn new([x1, x2, x3, x4]: [Point; 4], t: &Point, n: &Point, local: TwoFloat) -> Self {
        let (q, r) = (minus(&x2, &x1), minus(&x4, &x1));
        let w = minus(&minus(&x3, &x4), &q);
        // x_a x x_b = (q + b w) x (r + a w).
        let [k0, k1, k2] = [cross(&q, &r), cross(&q, &w), cross(&w, &r)];
        let area = |m: &Point| [[dot(m, &k0), dot(m, &k1)], [dot(m, &k2), ZERO]];
        let [s1, s2, s3, s4] = [x1, x2, x3, x4].map(|x| dot(n, &x) - local);
        Self {
            along: [[dot(t, &x1), dot(t, &q)], [dot(t, &r), dot(t, &w)]],
            across: area(t),
            normal: area(n),
            heights: [[s1, s2 - s1], [s4, s3 - s4]],
        }
    }

    /// What crosses the line `a`, from 0 to `b`.
    fn through(&self, a: TwoFloat, b: TwoFloat) -> [TwoFloat; 2] {
        let [x0, x1] = self.along.map(|line| at(&line, a));
        let [t0, t1] = self.across.map(|line| at(&line, a));
        let [n0, n1] = self.normal.map(|line| at(&line, a));
        let of_t = b * (x0 * t0 + b * ((x0 * t1 + x1 * t0) / 2.0 + b * (x1 * t1) / 3.0));
        [of_t, b * (n0 + b * n1 / 2.0)]
    }

    /// What crosses the part below the plane.
    fn below(&self) -> [TwoFloat; 2] {
        let [near, far] = &self.heights;
        let mut ends = vec![ZERO, ONE];
        ends.extend([near, far].into_iter().filter_map(root).filter(|end| *end > ZERO && *end < ONE));
        ends.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
        let pole = root(&[far[0] - near[0], far[1] - near[1]]);
        let mut sum = [ZERO; 2];
        for ends in ends.windows(2) {
            let middle = (ends[0] + ends[1]) / 2.0;
            let ends = [ends[0], ends[1]];
            let part = match [near, far].map(|height| at(height, middle) <= ZERO) {
                [true, true] => integral(ends, None, &|a| self.through(a, ONE)),
                [true, false] => integral(ends, pole, &|a| self.through(a, self.root(a))),
                [false, true] => integral(ends, pole, &|a| {
                    let [all, other] = [ONE, self.root(a)].map(|b| self.through(a, b));
                    [all[0] - other[0], all[1] - other[1]]
                }),
                [false, false] => continue,
            };
            sum = plus(&sum, &part);
        }
        sum
    }

    /// Where the line `a` meets the plane.
    fn root(&self, a: TwoFloat) -> TwoFloat {
        let [near, far] = self.heights.map(|height| at(&height, a));
        quotient(near, near - far)
    }
}

/// The integral of two functions that are smooth but for a pole.
fn integral(
    [mut low, mut high]: [TwoFloat; 2],
    pole: Option<TwoFloat>,
    f: &dyn Fn(TwoFloat) -> [TwoFloat; 2],
) -> [TwoFloat; 2] {
    let mut sum = [ZERO; 2];
    if let Some(pole) = pole {
        for _ in 0..HALVINGS {
            let [below, above] = [low - pole, pole - high];
            let half = (high - low) / 2.0;
            if below >= half || above >= half {
                break;
            }
            // The half that is farther from the pole is no longer than its distance.
            let middle = low + half;
            if below.hi().abs() < above.hi().abs() {
                sum = plus(&sum, &by_rule(middle, high, f));
                high = middle;
            } else {
                sum = plus(&sum, &by_rule(low, middle, f));
                low = middle;
            }
        }
    }
    plus(&sum, &by_rule(low, high, f))
}

fn by_rule(low: TwoFloat, high: TwoFloat, f: &dyn Fn(TwoFloat) -> [TwoFloat; 2]) -> [TwoFloat; 2] {
    let [middle, half] = [(low + high) / 2.0, (high - low) / 2.0];
    let mut sum = [ZERO; 2];
    for &(place, weight) in RULE.iter() {
        sum = plus(&sum, &f(middle + half * place).map(|value| weight * value));
    }
    sum.map(|sum| half * sum)
}

fn plus(a: &[TwoFloat; 2], b: &[TwoFloat; 2]) -> [TwoFloat; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// Place and weight of a point of Gauss's rule, by Newton's method on the Legendre polynomial.
fn gauss(point: usize) -> (TwoFloat, TwoFloat) {
    let count = POINTS as f64;
    let mut x = TwoFloat::from_f64((std::f64::consts::PI * (point as f64 + 0.75) / (count + 0.5)).cos());
    let mut slope = ONE;
    // Each doubles the digits, from three.
    for _ in 0..6 {
        let [mut before, mut value] = [ONE, x];
        for k in 1..POINTS {
            let k = k as f64;
            (before, value) = (value, (x * value * (2.0 * k + 1.0) - before * k) / (k + 1.0));
        }
        slope = quotient((x * value - before) * count, x * x - 1.0);
        x -= quotient(value, slope);
    }
    (x, quotient(TwoFloat::from_f64(2.0), (ONE - x * x) * slope * slope))
}

fn at(line: &Linear, place: TwoFloat) -> TwoFloat {
    line[0] + line[1] * place
}

/// Where a linear function is zero; none where it does not change.
fn root(line: &Linear) -> Option<TwoFloat> {
    (line[1] != ZERO).then(|| quotient(-line[0], line[1]))
}

/// A quotient with all digits: that of `twofloat` 0.8 has those of a double alone.
fn quotient(a: TwoFloat, b: TwoFloat) -> TwoFloat {
    let rough = a / b;
    rough + (a - rough * b) / b.hi()
}

fn dot(a: &Point, b: &Point) -> TwoFloat {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: &Point, b: &Point) -> Point {
    [0, 1, 2].map(|axis| a[axis] - b[axis])
}

fn cross(a: &Point, b: &Point) -> Point {
    [[1, 2], [2, 0], [0, 1]].map(|[i, j]| a[i] * b[j] - a[j] * b[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All cases of both tables of exact results, which other programs made with 60 digits.
    #[test]
    fn exact_tables_are_met_to_rounding() {
        let tables = [
            include_str!("../../geometry/tests/truncation.csv"),
            include_str!("../../geometry/tests/rotated.csv"),
        ];
        let mut cases = 0;
        for line in tables.iter().flat_map(|table| table.lines().skip(1)) {
            let (category, numbers) = line.split_once(',').unwrap();
            let v: Vec<f64> = numbers.split(',').map(|number| number.parse().unwrap()).collect();
            let vector = |i: usize| Vector::<3>::new(v[i], v[i + 1], v[i + 2]);
            let nodes = std::array::from_fn(|node| vector(3 * node));
            let found = truncate(&nodes, &vector(24), v[27]);
            let wanted = [v[28], v[29], v[30]];
            let found = [found.cell_volume, found.truncated_volume, found.section_area];
            let size = wanted[0].abs().max(wanted[1].abs());
            let sizes = [wanted[0].abs(), size, wanted[2].max(size.powf(2.0 / 3.0))];
            let compared = if category == "axis_normal_cube_on_face" { 2 } else { 3 };
            for i in 0..compared {
                let error = (found[i] - wanted[i]).abs();
                assert!(error <= 3e-16 * sizes[i], "{category}: {found:?} for {wanted:?}");
            }
            cases += 1;
        }
        assert_eq!(cases, 2240);
    }

    #[test]
    fn the_rule_integrates_polynomials_and_poles() {
        let [cubed, two] = integral([ZERO, TwoFloat::from_f64(2.0)], None, &|x| [x * x * x, ONE]);
        assert!((cubed - 4.0).hi().abs() <= 1e-29 && (two - 2.0).hi().abs() <= 1e-29);
        // int_0^1 da / (a + e) = ln((1 + e) / e).
        let pole = TwoFloat::from_f64(-1e-9);
        let [log, _] = integral([ZERO, ONE], Some(pole), &|x| [quotient(ONE, x - pole), ZERO]);
        assert!((log.hi() - (1.000_000_001_f64 / 1e-9).ln()).abs() <= 1e-14, "{log:?}");
    }
}
