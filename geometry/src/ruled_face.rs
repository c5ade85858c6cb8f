//! The ruled face: the bilinear surface through four points in outward order,
//! `x(alpha, beta) = x1 + alpha e + beta g + alpha beta t` with `e = x2 - x1`, `g = x4 - x1` and the twist
//! `t = x1 - x2 + x3 - x4` (Eq. 23).

use crate::Vector;

/// The area vector of a ruled face, the integral of its unit normal: `k / 2` with
/// `k = (x3 - x1) x (x4 - x2)` (Eq. 21). Exact for any four points.
pub fn area_vector(face: [&Vector<3>; 4]) -> Vector<3> {
    let [x1, x2, x3, x4] = face;
    0.5 * (x3 - x1).cross(&(x4 - x2))
}

/// The rate of volume through a ruled face for velocities given at its nodes: `F = c0 . k / 2` with the mean
/// velocity `c0` (Eq. 27), in cubic length per time.
///
/// It is the exact integral for a uniform velocity; with nodal velocities it is the paper's one-point rule.
pub fn flux(face: [&Vector<3>; 4], velocity: [&Vector<3>; 4]) -> f64 {
    let mean = (velocity[0] + velocity[1] + velocity[2] + velocity[3]) * 0.25;
    mean.dot(&area_vector(face))
}

/// The surface element of a ruled face, `dGamma = (q0 + alpha q_alpha + beta q_beta) dalpha dbeta` (Eq. 25),
/// and the volume `nu = t . (e x g)` of its twist (Eq. 95).
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceElement {
    pub(crate) q0: Vector<3>,
    pub(crate) q_alpha: Vector<3>,
    pub(crate) q_beta: Vector<3>,
    pub(crate) nu: f64,
}

impl SurfaceElement {
    pub(crate) fn new(face: [&Vector<3>; 4]) -> Self {
        let [x1, x2, x3, x4] = face;
        let e = x2 - x1;
        let g = x4 - x1;
        let t = (x3 - x4) - e;
        let q0 = e.cross(&g);
        Self { q0, q_alpha: e.cross(&t), q_beta: t.cross(&g), nu: t.dot(&q0) }
    }
}
