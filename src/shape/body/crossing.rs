//! Whether a surface crosses or overlaps itself.
//!
//! Two checks, since each finds what the other may not: edges that pierce other pieces, which include those of folds too narrow for the
//! middle of a piece to lie in, and windings on both sides of every piece, which include boxes that overlap with all faces flush.

use vofkit_geometry::Vector;
use vofkit_geometry::clip::bounds;

use super::check::{BodyDefect, BodyError, refused};
use super::{Body, normal};

/// Whether no edge of a piece (2D: no segment) runs through another one, with its ends and the point of crossing further than
/// `touch` from that one's plane and edges.
///
/// # Errors
/// The pieces that cross.
pub(super) fn apart<const D: usize>(body: &Body<D>, touch: f64) -> Result<(), BodyError> {
    let mut crossing = Vec::new();
    for number in 0..body.piece_count() {
        let piece = body.piece(number);
        let plane = normal(&piece).normalize();
        // Each edge runs forward in as many pieces as backward.
        let edges_of = |other: usize| {
            let corners = body.pieces[other];
            let edges = (0..D).map(move |i| [corners[i], corners[(i + 1) % D]]);
            edges.filter(|[a, b]| a < b).map(|edge| edge.map(|i| body.corners[i as usize]))
        };
        let pierces = |edge: [Vector<D>; 2]| pierces(&edge, &piece, &plane, touch);
        for other in body.near(bounds(&piece)) {
            if edges_of(other).any(pierces) {
                crossing.push([number.min(other) + 1, number.max(other) + 1]);
            }
        }
    }
    crossing.sort_unstable();
    crossing.dedup();
    refused(crossing.into_iter().map(|triangles| BodyDefect::Crossing { triangles }).collect())
}

/// Whether an edge runs through a piece with a unit normal. Of a piece that is none, which has no normal, nothing is true.
fn pierces<const D: usize>(
    edge: &[Vector<D>; 2],
    piece: &[Vector<D>; D],
    plane: &Vector<D>,
    touch: f64,
) -> bool {
    let [from, to] = edge.each_ref().map(|x| plane.dot(&(x - piece[0])));
    if !(from.min(to) < -touch && from.max(to) > touch) {
        return false;
    }
    let x = edge[0] + (edge[1] - edge[0]) * (from / (from - to));
    (0..D).all(|i| {
        let side = piece[(i + 1) % D] - piece[i];
        let inward =
            if D == 2 { side } else { normal(&std::array::from_fn(|k| [Vector::zeros(), *plane, side][k])) };
        inward.dot(&(x - piece[i])) > touch * inward.norm()
    })
}

/// Whether the surface winds once or not at all around the space on either side of each of its pieces, further than `touch` from it.
///
/// # Errors
/// The pieces beside which it does not.
pub(super) fn simple<const D: usize>(body: &Body<D>, touch: f64) -> Result<(), BodyError> {
    let odd = |number: usize| {
        let mut windings = [0; 2];
        body.across(number, touch, |_, sides| (0..2).for_each(|i| windings[i] += sides[i]));
        let winding = windings.into_iter().find(|winding| !(0..=1).contains(winding))?;
        Some(BodyDefect::Overlapping { triangle: number + 1, winding })
    };
    refused((0..body.piece_count()).filter_map(odd).collect())
}
