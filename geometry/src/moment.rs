//! The first moment of the truncated part of a cell, the integral of position: its centroid is moment over volume.
//!
//! With any point `p` on the plane and `z = y - p`, `div(z_i z) = (D + 1) z_i`; the section contributes nothing,
//! since `z` lies in it:
//!
//! ```text
//! (D + 1) int z dV = sum over faces int z (z.dGamma)
//! ```
//!
//! On a ruled face `z = z1 + alpha e + beta g + alpha beta t`, and the terms of higher order of `z.dGamma` vanish:
//!
//! ```text
//! z.dGamma = (z1.q0 + alpha z1.q_alpha + beta z1.q_beta - alpha beta nu) dalpha dbeta
//! ```
//!
//! So the moments `K_nm`, `n, m <= 2`, of the part of the face below the plane are enough, and those are closed
//! forms in [`crate::hyperbola`] and [`crate::second_moments`]. Exact for ruled, folded and inverted cells
//! (algebraic).

use crate::Vector;
use crate::cell::Cell;
use crate::hexahedron::Hexahedron;
use crate::hyperbola::{Moments, moments};
use crate::quad::Quad;
use crate::ruled_face::SurfaceElement;
use crate::second_moments::{SecondMoments, second_moments};
use crate::section::{Piece, pieces};

type Vector2 = Vector<2>;
type Vector3 = Vector<3>;

/// Volume (2D: area) of a part of a cell, and its first moment about the origin of the frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PartMoment<const D: usize> {
    pub(crate) volume: f64,
    pub(crate) first: Vector<D>,
}

/// What of the sums over the faces goes into the moment: `sum int z.dGamma = D V` and `sum int z (z.dGamma)`, for `z`
/// relative to `origin`.
fn from_sums<const D: usize>(origin: &Vector<D>, sum: f64, sums: &Vector<D>) -> PartMoment<D> {
    let volume = sum / D as f64;
    PartMoment { volume, first: origin * volume + sums / (D + 1) as f64 }
}

/// The part where the heights `s` of the nodes `y` over a plane with normal `m` are not positive. `below` sums over
/// the faces, relative to a point of the plane; the whole cell has all heights negative, and any point will do.
fn smaller_part<const D: usize, const N: usize>(
    y: &[Vector<D>; N],
    m: &Vector<D>,
    s: &[f64; N],
    below: impl Fn(&[f64; N], &Vector<D>) -> PartMoment<D>,
) -> PartMoment<D> {
    let part = |s: &[f64; N], m: Vector<D>| {
        // A point of the plane next to the part that is wanted keeps small parts accurate.
        let lowest = (1..N).fold(0, |best, i| if s[i] < s[best] { i } else { best });
        below(s, &(y[lowest] - m * (s[lowest] / m.norm_squared())))
    };
    let whole = || below(&[-1.0; N], &(y.iter().sum::<Vector<D>>() / N as f64));
    match s.iter().filter(|&&s| s <= 0.0).count() {
        0 => PartMoment { volume: 0.0, first: Vector::<D>::zeros() },
        inside if inside == N => whole(),
        inside if 2 * inside <= N => part(s, *m),
        _ => {
            let (whole, above) = (whole(), part(&s.map(|s| -s), -m));
            PartMoment { volume: whole.volume - above.volume, first: whole.first - above.first }
        }
    }
}

/// The part of a hexahedron with nodes `y` below a plane with normal `m`, for the heights `s` of its nodes.
pub(crate) fn of_hexahedron(y: &[Vector3; 8], m: &Vector3, s: &[f64; 8]) -> PartMoment<3> {
    smaller_part(y, m, s, |s, p| {
        let (mut sum, mut sums) = (0.0, Vector3::zeros());
        for face in Hexahedron::FACE_NODES {
            face_part([0, 1, 2, 3].map(|i| s[face[i]]), |first, sign, k| {
                let z = [0, 1, 2, 3].map(|i| y[face[(first + i) & 3]] - p);
                let SurfaceElement { q0, q_alpha, q_beta, nu } = surface_element(&z);
                let density = [z[0].dot(&q0), z[0].dot(&q_alpha), z[0].dot(&q_beta), -nu];
                let (part, parts) = integrals(&z, density, k);
                sum += sign * part;
                sums += parts * sign;
            });
        }
        from_sums(p, sum, &sums)
    })
}

/// The part of a quadrilateral; see [`of_hexahedron`]. On an edge `z x e` is constant.
pub(crate) fn of_quad(y: &[Vector2; 4], m: &Vector2, s: &[f64; 4]) -> PartMoment<2> {
    smaller_part(y, m, s, |s, p| {
        let (mut sum, mut sums) = (0.0, Vector2::zeros());
        for face in Quad::FACE_NODES {
            let (a, b) = (face[0], face[1]);
            let Some((length, middle)) = edge_part([s[a], s[b]]) else { continue };
            let (z, edge) = (y[a] - p, y[b] - y[a]);
            let part = length * z.perp(&edge);
            sum += part;
            sums += (z + edge * middle) * part;
        }
        from_sums(p, sum, &sums)
    })
}

/// Length and middle of the part of an edge's parameter where the height is not positive.
pub(crate) fn edge_part([s_a, s_b]: [f64; 2]) -> Option<(f64, f64)> {
    match (s_a <= 0.0, s_b <= 0.0) {
        (false, false) => None,
        (true, true) => Some((1.0, 0.5)),
        (true, false) => Some((s_a / (s_a - s_b), 0.5 * s_a / (s_a - s_b))),
        (false, true) => Some((s_b / (s_b - s_a), 1.0 - 0.5 * s_b / (s_b - s_a))),
    }
}

/// Moments `K[n][m]` of `alpha^n beta^m` over a part of a face.
pub(crate) type FaceMoments = [[f64; 3]; 3];

const WHOLE_FACE: FaceMoments =
    [[1.0, 0.5, 1.0 / 3.0], [0.5, 0.25, 1.0 / 6.0], [1.0 / 3.0, 1.0 / 6.0, 1.0 / 9.0]];

/// Hands the part of a face with `s <= 0` to `add` as signed pieces: the corner to count the face from, the sign,
/// and the moments in the parametrisation that starts there.
pub(crate) fn face_part(s: [f64; 4], mut add: impl FnMut(usize, f64, &FaceMoments)) {
    let pieces = pieces(&s);
    let complement = pieces.iter().flatten().any(|(_, inside)| !inside);
    if complement || s.iter().all(|&s| s <= 0.0) {
        add(0, 1.0, &WHOLE_FACE);
    }
    for (piece, inside) in pieces.into_iter().flatten() {
        let (Piece::Corner(first) | Piece::Strip(first)) = piece;
        let s = [0, 1, 2, 3].map(|i| s[(first + i) & 3]);
        let k = match piece {
            Piece::Corner(_) => corner_moments(s),
            Piece::Strip(_) => strip_moments(s),
        };
        add(first, if inside { 1.0 } else { -1.0 }, &k);
    }
}

/// All moments of the region under a hyperbola, symmetric in `n` and `m`.
fn hyperbola_moments(numerator: f64, denominator: f64, difference: f64) -> FaceMoments {
    let Moments { m00, m10, m11, .. } = moments(numerator, denominator, difference);
    let SecondMoments { m20, m21, m22 } = second_moments(numerator, denominator, difference);
    [[m00, m10, m20], [m10, m11, m21], [m20, m21, m22]]
}

/// The region at the first corner, `u + v + w u v <= 1` in `u = alpha / a`, `v = beta / b` with `a = s1/(s1-s2)`,
/// `b = s1/(s1-s4)`, `1 + w = (s2 s4 - s1 s3) / ((s2-s1)(s4-s1))`: `K_nm = a^(n+1) b^(m+1) M_nm`.
fn corner_moments([s1, s2, s3, s4]: [f64; 4]) -> FaceMoments {
    let (to2, to4) = (s2 - s1, s4 - s1);
    let (a, b) = (-s1 / to2, -s1 / to4);
    // The products underflow only where the face lies in the plane to beyond rounding, and adds nothing.
    let denominator = (to2 * to4).max(f64::MIN_POSITIVE);
    let m = hyperbola_moments((s2 * s4 - s1 * s3).max(0.0), denominator, -s1 * ((s3 - s4) - to2));
    let (powers_a, powers_b) = ([a, a * a, a * a * a], [b, b * b, b * b * b]);
    std::array::from_fn(|i| std::array::from_fn(|j| powers_a[i] * powers_b[j] * m[i][j]))
}

/// The strip at the edge from the first corner to the next, under `beta = R + S g(alpha)` with
/// `g = (1-alpha)/(1 + w alpha)`, `1 + w = (s3-s2)/(s4-s1)`, `R = s2/(s2-s3)`, `R + S = s1/(s1-s4)`. Since
/// `int alpha^n g^k = k M_n(k-1)`,
///
/// ```text
/// K_nm = R^(m+1) / ((n+1)(m+1)) + sum over j <= m of binomial(m, j) R^(m-j) S^(j+1) M_nj
/// ```
fn strip_moments([s1, s2, s3, s4]: [f64; 4]) -> FaceMoments {
    let (to3, to4) = (s3 - s2, s4 - s1);
    let right = -s2 / to3;
    let step = -s1 / to4 - right;
    let m = hyperbola_moments(to3, to4, (s3 - s4) - (s2 - s1));
    std::array::from_fn(|n| {
        let length = 1.0 / (n + 1) as f64;
        let [m0, m1, m2] = m[n];
        [
            length * right + step * m0,
            0.5 * length * right * right + step * (right * m0 + step * m1),
            length / 3.0 * right * right * right
                + step * (right * right * m0 + step * (2.0 * right * m1 + step * m2)),
        ]
    })
}

/// The surface element of the face through four points.
pub(crate) fn surface_element(z: &[Vector3; 4]) -> SurfaceElement {
    SurfaceElement::new([&z[0], &z[1], &z[2], &z[3]])
}

/// The integrals of a density `c0 + c_alpha alpha + c_beta beta + c_both alpha beta`, and of `z` times it, over the part
/// of the parameters of the face through four points that has these moments.
pub(crate) fn integrals(z: &[Vector3; 4], density: [f64; 4], k: &FaceMoments) -> (f64, Vector3) {
    let [c0, c_alpha, c_beta, c_both] = density;
    let weighted = |n: usize, m: usize| {
        c0 * k[n][m] + c_alpha * k[n + 1][m] + c_beta * k[n][m + 1] + c_both * k[n + 1][m + 1]
    };
    let (e, g) = (z[1] - z[0], z[3] - z[0]);
    let t = (z[2] - z[3]) - e;
    let whole = weighted(0, 0);
    (whole, z[0] * whole + e * weighted(1, 0) + g * weighted(0, 1) + t * weighted(1, 1))
}
