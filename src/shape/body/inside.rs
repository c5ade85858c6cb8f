//! Which points a body holds: by the pieces of its surface above a point.

use vofkit_geometry::Vector;

use super::{Body, normal};

impl<const D: usize> Body<D> {
    /// Whether the body holds a point. On the surface itself either answer is given.
    pub fn contains(&self, x: &Vector<D>) -> bool {
        let mut winding = 0;
        self.above(x, |_, side| winding += side);
        winding > 0
    }

    /// Visits the pieces that the ray from a point along the last axis crosses, with 1 where it leaves the body there and -1 where
    /// it enters.
    ///
    /// Pieces that share an edge judge it by the same numbers, and an edge that the ray meets belongs to one of them, so that
    /// no ray slips through.
    pub(super) fn above(&self, x: &Vector<D>, mut visit: impl FnMut(usize, i32)) {
        let last = D - 1;
        let mut end = *x;
        // Beyond everything: only boxes are asked.
        end[last] = f64::MAX;
        for number in self.near([*x, end]) {
            let piece = self.piece(number);
            let side = winding(&piece, x);
            if side != 0 && height(&piece, x) > x[last] {
                visit(number, side);
            }
        }
    }
}

/// How often the shadow of a piece along the last axis winds around that of a point: 1 where the outward normal points along
/// the axis, -1 where it points against it, 0 beside the shadow.
fn winding<const D: usize>(piece: &[Vector<D>; D], x: &Vector<D>) -> i32 {
    let between = |a: f64, b: f64, x: f64| i32::from(a <= x && x < b) - i32::from(b <= x && x < a);
    if D == 2 {
        return -between(piece[0][0], piece[1][0], x[0]);
    }
    let edge = |i: usize| {
        let (a, b) = (&piece[i], &piece[(i + 1) % D]);
        let rises = between(a[1], b[1], x[1]);
        if rises != 0 && rises == left_of(a, b, x) { rises } else { 0 }
    };
    (0..D).map(edge).sum()
}

/// 1 where a point lies left of an edge seen along the last axis, -1 right of it; the edge turned round gives the opposite.
fn left_of<const D: usize>(a: &Vector<D>, b: &Vector<D>, x: &Vector<D>) -> i32 {
    let turned = (b[0], b[1]) < (a[0], a[1]);
    let (low, high) = if turned { (b, a) } else { (a, b) };
    let area = (high[0] - low[0]) * (x[1] - low[1]) - (high[1] - low[1]) * (x[0] - low[0]);
    let side = i32::from(area > 0.0) - i32::from(area < 0.0);
    if turned { -side } else { side }
}

/// The last coordinate of a piece where a point lies in its shadow.
fn height<const D: usize>(piece: &[Vector<D>; D], x: &Vector<D>) -> f64 {
    let (n, last) = (normal(piece), D - 1);
    let rise: f64 = (0..last).map(|k| n[k] * (x[k] - piece[0][k])).sum();
    let ends = piece.iter().map(|corner| corner[last]);
    let (low, high) =
        ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
    // Of a piece that is almost upright, rounding leaves little of the quotient.
    (piece[0][last] - rise / n[last]).max(low).min(high)
}
