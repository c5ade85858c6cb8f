//! Which points a body holds: by the pieces of its surface above a point.

use vofkit_geometry::Vector;

use super::{Body, normal};

impl<const D: usize> Body<D> {
    /// Whether the body holds a point. On the surface itself either answer is given.
    pub fn contains(&self, x: &Vector<D>) -> bool {
        let mut winding = 0;
        self.above(x, D - 1, |_, side, _| winding += side);
        winding > 0
    }

    /// Visits the pieces that are crossed by the ray along the axis next to the normal of a piece, from `touch` before its middle on.
    /// Each comes with what it adds to the windings of the surface around two points, `touch` before the middle and behind it: 1
    /// where the ray leaves the body, -1 where it enters, 0 where the second point lies behind that place.
    pub(super) fn across(&self, number: usize, touch: f64, mut visit: impl FnMut(usize, [i32; 2])) {
        let piece = self.piece(number);
        let middle = piece.iter().sum::<Vector<D>>() / D as f64;
        let axis = normal(&piece).iamax();
        let mut before = middle;
        before[axis] -= touch;
        self.above(&before, axis, |other, side, height| {
            visit(other, [side, if height > middle[axis] + touch { side } else { 0 }]);
        });
    }

    /// Visits the pieces that the ray from a point along an axis crosses, with 1 where it leaves the body there and -1 where it
    /// enters, and with the coordinate of that place.
    ///
    /// Pieces that share an edge judge it by the same numbers, and an edge that the ray meets belongs to one of them, so that
    /// no ray slips through.
    fn above(&self, x: &Vector<D>, axis: usize, mut visit: impl FnMut(usize, i32, f64)) {
        let mut end = *x;
        // Beyond everything: only boxes are asked.
        end[axis] = f64::MAX;
        for number in self.near([*x, end]) {
            let piece = self.piece(number);
            let side = winding(&piece, x, axis);
            if side != 0 {
                let height = height(&piece, x, axis);
                if height > x[axis] {
                    visit(number, side, height);
                }
            }
        }
    }
}

/// How often the shadow of a piece along an axis winds around that of a point: 1 where the outward normal points along
/// the axis, -1 where it points against it, 0 beside the shadow.
fn winding<const D: usize>(piece: &[Vector<D>; D], x: &Vector<D>, axis: usize) -> i32 {
    let between = |a: f64, b: f64, x: f64| i32::from(a <= x && x < b) - i32::from(b <= x && x < a);
    let [first, second] = [(axis + 1) % D, (axis + 2) % D];
    if D == 2 {
        let along = between(piece[0][first], piece[1][first], x[first]);
        return if axis == 0 { along } else { -along };
    }
    let edge = |i: usize| {
        let [a, b, x] = [&piece[i], &piece[(i + 1) % D], x].map(|x| [x[first], x[second]]);
        let rises = between(a[1], b[1], x[1]);
        if rises != 0 && rises == left_of(a, b, x) { rises } else { 0 }
    };
    (0..D).map(edge).sum()
}

/// 1 where a point lies left of an edge, -1 right of it; the edge turned round gives the opposite.
fn left_of(a: [f64; 2], b: [f64; 2], x: [f64; 2]) -> i32 {
    let turned = b < a;
    let (low, high) = if turned { (b, a) } else { (a, b) };
    let area = (high[0] - low[0]) * (x[1] - low[1]) - (high[1] - low[1]) * (x[0] - low[0]);
    let side = i32::from(area > 0.0) - i32::from(area < 0.0);
    if turned { -side } else { side }
}

/// The coordinate along an axis of a piece where a point lies in its shadow.
fn height<const D: usize>(piece: &[Vector<D>; D], x: &Vector<D>, axis: usize) -> f64 {
    let n = normal(piece);
    let rise: f64 = (0..D).filter(|&k| k != axis).map(|k| n[k] * (x[k] - piece[0][k])).sum();
    let ends = piece.iter().map(|corner| corner[axis]);
    let (low, high) =
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
    // Of a piece that is almost upright, rounding leaves little of the quotient.
    (piece[0][axis] - rise / n[axis]).max(low).min(high)
}
