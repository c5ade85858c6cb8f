//! The centroid of the section of a plane with a cell, exactly.
//!
//! The section closes the part of the cell below the plane. So the divergence theorem turns integrals over it into ones
//! over the faces, which are closed forms: with any point `p` on the plane, `z = y - p` and a constant vector `m` along the
//! normal, `div m = 0` and `div (z_i m) = m_i` give
//!
//! ```text
//! |m| A          = - sum over faces int m.dGamma
//! |m| int z_i dA = - sum over faces int z_i (m.dGamma) + m_i V
//! ```
//!
//! The centroid lies in the plane, which the last term is for: leaving it out and taking the component along `m` away is
//! the same. `m.dGamma` is linear in the parameters of a ruled face, and the moments of [`crate::moment`] are enough.
//!
//! Several loops count together, and the section of an inverted cell counts algebraically.

use crate::Vector;
use crate::cell::Cell;
use crate::hexahedron::Hexahedron;
use crate::moment::edge_part;
use crate::quad::Quad;

type Vector2 = Vector<2>;
type Vector3 = Vector<3>;

/// The centroid of the section where the heights `s` of the nodes `y` over a plane with normal `m` are zero. `below` sums
/// `int m.dGamma` and `int z (m.dGamma)` over the parts of the faces below the plane.
fn of_plane<const D: usize, const N: usize>(
    y: &[Vector<D>; N],
    m: &Vector<D>,
    s: &[f64; N],
    below: impl Fn(&[f64; N], &Vector<D>) -> (f64, Vector<D>),
) -> Option<Vector<D>> {
    let inside = s.iter().filter(|&&s| s <= 0.0).count();
    if inside == 0 || inside == N {
        return None;
    }
    // The smaller part is less to sum up, and `p` next to it keeps the digits of small sections.
    let sign = if 2 * inside <= N { 1.0 } else { -1.0 };
    let s = s.map(|s| sign * s);
    let m2 = m.norm_squared();
    let lowest = (1..N).fold(0, |best, i| if s[i] < s[best] { i } else { best });
    let p = y[lowest] - m * (sign * s[lowest] / m2);
    let (area, first) = below(&s, &p);
    let centroid = p + (first - m * (m.dot(&first) / m2)) / area;
    // An area of zero where the plane touches a node or an edge.
    centroid.iter().all(|c| c.is_finite()).then_some(centroid)
}

/// The same of a parallelepiped, whose section is a polygon: in each face an edge of it, from where the outward order of the face's nodes
/// comes down through the plane to where it goes up. Areas are those of the polygon's shadow along the axis in which `m` is largest.
pub(crate) fn of_parallelepiped(y: &[Vector3; 8], m: &Vector3, s: &[f64; 8]) -> Option<Vector3> {
    let axis = m.iamax();
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut origin = None;
    let (mut area, mut first) = (0.0, Vector3::zeros());
    for face in Hexahedron::FACE_NODES {
        let mut ends = [None; 2];
        for i in 0..4 {
            let (from, to) = (face[i], face[(i + 1) & 3]);
            if (s[from] <= 0.0) != (s[to] <= 0.0) {
                let crossing = y[from] + (y[to] - y[from]) * (s[from] / (s[from] - s[to]));
                ends[usize::from(s[from] <= 0.0)] = Some(crossing);
            }
        }
        let [Some(down), Some(up)] = ends else { continue };
        let origin = *origin.get_or_insert(down);
        let (a, b) = (down - origin, up - origin);
        let twice = a[j] * b[k] - a[k] * b[j];
        area += twice;
        first += (a + b) * (twice / 3.0);
    }
    // An area of zero where the plane touches a node or an edge.
    let centroid = origin? + first / area;
    centroid.iter().all(|c| c.is_finite()).then_some(centroid)
}

/// The centroid of the section of a quadrilateral; see [`of_plane`].
pub(crate) fn of_quad(y: &[Vector2; 4], m: &Vector2, s: &[f64; 4]) -> Option<Vector2> {
    of_plane(y, m, s, |s, p| {
        let (mut length, mut first) = (0.0, Vector2::zeros());
        for face in Quad::FACE_NODES {
            let (a, b) = (face[0], face[1]);
            let Some((part, middle)) = edge_part([s[a], s[b]]) else { continue };
            let edge = y[b] - y[a];
            let density = part * edge.perp(m);
            length -= density;
            first -= ((y[a] - p) + edge * middle) * density;
        }
        (length, first)
    })
}
