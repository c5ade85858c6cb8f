//! Rotations, in two and in three dimensions.

use nalgebra::SMatrix;
use vofkit_geometry::Vector;

/// A rotation of the plane or of space, kept as its orthonormal matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<const D: usize> {
    matrix: SMatrix<f64, D, D>,
}

impl<const D: usize> Default for Rotation<D> {
    fn default() -> Self {
        Self::identity()
    }
}

impl<const D: usize> Rotation<D> {
    /// No rotation.
    pub fn identity() -> Self {
        Self { matrix: SMatrix::identity() }
    }

    /// The rotation by `angle`, in radians, counter-clockwise about the z axis (2D: of the plane).
    pub fn from_angle(angle: f64) -> Self {
        Self::from_axis_angle(Vector::<3>::new(0.0, 0.0, 1.0), angle)
    }

    /// The rotation by `angle`, in radians, counter-clockwise about `axis`, which need not have unit length:
    ///
    /// ```text
    /// R = cos(angle) I + sin(angle) [a]x + (1 - cos(angle)) a a^T,   a = axis / |axis|      (Rodrigues)
    /// ```
    ///
    /// In 2D only the z axis makes sense; there the axis stands for its z component. An axis of zero length
    /// gives a matrix that is not finite, which [`Shape::check`](super::Shape::check) reports.
    pub fn from_axis_angle(axis: Vector<3>, angle: f64) -> Self {
        let axis = if D == 2 { Vector::<3>::new(0.0, 0.0, axis[2]) } else { axis };
        let scaled = axis / axis.amax();
        let a = scaled / scaled.norm();
        let (sin, cos) = angle.sin_cos();
        let matrix = SMatrix::from_fn(|i, j| {
            let skew = match (j + 3 - i) % 3 {
                0 => cos,
                1 => -sin * a[3 - i - j],
                _ => sin * a[3 - i - j],
            };
            skew + (1.0 - cos) * a[i] * a[j]
        });
        Self { matrix }
    }

    /// The matrix `R`: its columns are the images of the axes.
    pub fn matrix(&self) -> &SMatrix<f64, D, D> {
        &self.matrix
    }

    /// The image of a direction.
    pub fn apply(&self, direction: &Vector<D>) -> Vector<D> {
        self.matrix * direction
    }

    /// This rotation followed by another.
    pub fn then(&self, next: &Self) -> Self {
        Self { matrix: next.matrix * self.matrix }
    }

    /// The rotation back.
    pub fn inverse(&self) -> Self {
        Self { matrix: self.matrix.transpose() }
    }

    pub(super) fn is_finite(&self) -> bool {
        self.matrix.iter().all(|c| c.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_turn_counter_clockwise() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let cases = [([0.0, 0.0, 2.0], 0, 1), ([3.0, 0.0, 0.0], 1, 2), ([0.0, 0.5, 0.0], 2, 0)];
        for (axis, from, to) in cases {
            let unit = |k: usize| Vector::<3>::from_fn(|i, _| f64::from(u8::from(i == k)));
            let turned = Rotation::<3>::from_axis_angle(axis.into(), quarter).apply(&unit(from));
            assert!((turned - unit(to)).amax() <= 1e-15, "{axis:?}: {turned}");
        }
        let turned = Rotation::<2>::from_angle(quarter).apply(&Vector::<2>::new(1.0, 0.0));
        assert!((turned - Vector::<2>::new(0.0, 1.0)).amax() <= 1e-15);
    }

    #[test]
    fn inverse_and_composition() {
        let [a, b] = [([1.0, -2.0, 0.5], 0.7), ([0.3, 0.1, 4.0], -2.0)]
            .map(|(axis, angle): ([f64; 3], f64)| Rotation::<3>::from_axis_angle(axis.into(), angle));
        let round = a.then(&b).then(&b.inverse()).then(&a.inverse());
        assert!((round.matrix() - Rotation::<3>::identity().matrix()).amax() <= 1e-15);
        assert!((a.matrix().determinant() - 1.0).abs() <= 1e-15);
    }
}
