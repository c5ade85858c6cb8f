//! A multilinear piece of a cell: its corners, its halves, its volume and its Jacobian determinant.

use vofkit_geometry::{Cell, Vector};

/// Corners of a brick in three dimensions; in two, half of them are used.
pub(super) const CORNERS: usize = 8;

/// A cell or a part of one between surfaces of constant local coordinates, in coordinates relative to some anchor. Bit `k` of
/// a corner's index is its offset along axis `k`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brick<const D: usize> {
    pub(super) corners: [Vector<D>; CORNERS],
}

/// Coefficients `[i][j]` of `v^i w^j`.
pub(super) type Weight = [[f64; 3]; 3];

impl<const D: usize> Brick<D> {
    /// The cell relative to an anchor.
    pub(super) fn of_cell<C: Cell<D>>(cell: &C, anchor: &Vector<D>) -> Self {
        let mut corners = [Vector::zeros(); CORNERS];
        for (node, offset) in cell.nodes().iter().zip(C::OFFSETS) {
            corners[bits(offset)] = node - anchor;
        }
        Self { corners }
    }

    /// The corners that are in use.
    pub(super) fn corners(&self) -> &[Vector<D>] {
        &self.corners[..1 << D]
    }

    /// The mean of the corners and the largest distance of one from it.
    pub(super) fn ball(&self) -> (Vector<D>, f64) {
        ball(self.corners())
    }

    /// The half at the lower (0) or upper (1) end of an axis.
    pub(super) fn half(&self, axis: usize, side: usize) -> Self {
        let x = &self.corners;
        let bit = 1 << axis;
        let mut half = *self;
        for i in (0..1 << D).filter(|i| i >> axis & 1 != side) {
            half.corners[i] = (x[i] + x[i ^ bit]) * 0.5;
        }
        half
    }

    /// The product of the longest edges along each axis.
    pub(super) fn hull(&self) -> f64 {
        (0..D)
            .map(|axis| {
                edges::<D>(axis).map(|[a, b]| (self.corners[b] - self.corners[a]).norm()).fold(0.0, f64::max)
            })
            .product()
    }

    /// The algebraic volume.
    pub(super) fn volume(&self) -> f64 {
        let x = coefficients(&self.corners, [1, 0, 2]);
        let section = |u: f64| {
            let weight = weight(&x, u);
            (0..9).map(|n| weight[n / 3][n % 3] / ((n / 3 + 1) * (n % 3 + 1)) as f64).sum::<f64>()
        };
        // The determinant is quadratic in each coordinate: Simpson's rule is exact.
        if D == 2 { section(0.0) } else { (section(0.0) + 4.0 * section(0.5) + section(1.0)) / 6.0 }
    }
}

/// The mean of some points and the largest distance of one from it.
pub(super) fn ball<const D: usize>(points: &[Vector<D>]) -> (Vector<D>, f64) {
    let centre = points.iter().sum::<Vector<D>>() / points.len() as f64;
    let radius = points.iter().map(|x| (x - centre).norm_squared()).fold(0.0, f64::max).sqrt();
    (centre, radius)
}

/// The index of the corner at an offset.
pub(super) fn bits<const D: usize>(offset: &[usize; D]) -> usize {
    (0..D).map(|axis| offset[axis] << axis).sum()
}

/// The ends of the edges along an axis.
pub(super) fn edges<const D: usize>(axis: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..1 << D).filter(move |i| i >> axis & 1 == 0).map(move |i| [i, i | 1 << axis])
}

/// The coefficients of a multilinear function given at the corners. `order` names the axes that become `w`, `v` and (in 3D) `u`;
/// bits 0, 1 and 2 of a coefficient's index say whether it belongs to `w`, `v` and `u`.
pub(super) fn coefficients<const D: usize>(
    corners: &[Vector<D>; CORNERS],
    order: [usize; 3],
) -> [Vector<D>; CORNERS] {
    let mut k = [Vector::zeros(); CORNERS];
    for i in 0..1 << D {
        let natural: usize = (0..D).map(|bit| (i >> bit & 1) << order[bit]).sum();
        k[i] = corners[natural];
    }
    for bit in 0..D {
        for [a, b] in edges::<D>(bit) {
            let lower = k[a];
            k[b] -= lower;
        }
    }
    k
}

/// The coefficients on the patch of constant `u`: of `1`, `w`, `v` and `v w`.
pub(super) fn patch<const D: usize>(k: &[Vector<D>; CORNERS], u: f64) -> [Vector<D>; 4] {
    std::array::from_fn(|i| if D == 2 { k[i] } else { k[i] + k[i | 4] * u })
}

fn padded<const D: usize>(a: &Vector<D>) -> Vector<3> {
    Vector::<3>::from_fn(|i, _| if i < D { a[i] } else { 0.0 })
}

/// The Jacobian determinant on the patch of constant `u` of a brick with coefficients `x`,
///
/// ```text
/// x_u . (x_v x x_w),   x_v x x_w = x2 x x1 + (x2 x x3) v + (x3 x x1) w
/// ```
///
/// positive where `u, v, w` is an even permutation of the axes. In 2D `x_u` is the unit vector out of the plane.
pub(super) fn weight<const D: usize>(x: &[Vector<D>; CORNERS], u: f64) -> Weight {
    let [_, x1, x2, x3] = patch(x, u).map(|k| padded(&k));
    let normal = [((0, 0), x2.cross(&x1)), ((1, 0), x2.cross(&x3)), ((0, 1), x3.cross(&x1))];
    let along_u: [Vector<3>; 4] = match D {
        2 => [Vector::<3>::new(0.0, 0.0, 1.0), Vector::zeros(), Vector::zeros(), Vector::zeros()],
        _ => std::array::from_fn(|i| padded(&x[i | 4])),
    };
    let mut weight = Weight::default();
    for (i, x_u) in along_u.iter().enumerate() {
        for ((v, w), n) in &normal {
            weight[v + (i >> 1)][w + (i & 1)] += x_u.dot(n);
        }
    }
    weight
}
