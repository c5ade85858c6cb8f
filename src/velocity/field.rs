//! The steady fields, each with its vector potential.

use std::f64::consts::PI;

type Vector3 = vofkit_geometry::Vector<3>;

/// A steady, divergence-free velocity field. Two-dimensional meshes lie in the plane z = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Field {
    /// The same velocity everywhere.
    Uniform {
        /// The velocity.
        velocity: Vector3,
    },
    /// Rigid rotation `omega x (x - centre)`.
    Rotation {
        /// A point of the axis.
        centre: Vector3,
        /// The angular velocity `omega`: its direction is the axis, its length the rate in radians per time.
        angular_velocity: Vector3,
    },
    /// `(cos x sin y, -sin x cos y)` (Eq. 101 of the paper).
    Eq101,
    /// `(sin x cos y, -cos x sin y)` (Rudman 1997).
    RudmanShear,
    /// `(-sin^2(pi x) sin(2 pi y), sin^2(pi y) sin(2 pi x))` (Rider & Kothe 1998).
    ReversedVortex,
    /// `(2 sin^2(pi x) sin(2 pi y) sin(2 pi z), -sin(2 pi x) sin^2(pi y) sin(2 pi z), -sin(2 pi x) sin(2 pi y) sin^2(pi z))`
    /// (LeVeque 1996).
    Deformation3d,
    /// `(sin^2(pi x) sin(2 pi y), -sin(2 pi x) sin^2(pi y), U (1 - r/R)^2)` with `r` the distance from
    /// `x = y = 1/2` (Liovic et al. 2006).
    Shear3d {
        /// The axial velocity `U`.
        speed: f64,
        /// The radius `R`.
        radius: f64,
    },
}

/// `sin^2(pi x)` and `sin(2 pi x)`, the latter as its derivative over `pi`.
fn wave(x: f64) -> (f64, f64) {
    let (sin, cos) = (PI * x).sin_cos();
    (sin * sin, 2.0 * sin * cos)
}

impl Field {
    /// Whether the field stays in planes of constant z, so that it can be used in two dimensions.
    pub fn is_planar(&self) -> bool {
        match self {
            Self::Uniform { velocity } => velocity[2] == 0.0,
            Self::Rotation { angular_velocity, .. } => {
                angular_velocity[0] == 0.0 && angular_velocity[1] == 0.0
            }
            Self::Eq101 | Self::RudmanShear | Self::ReversedVortex => true,
            Self::Deformation3d | Self::Shear3d { .. } => false,
        }
    }

    /// The velocity at a point.
    pub fn velocity(&self, x: &Vector3) -> Vector3 {
        match *self {
            Self::Uniform { velocity } => velocity,
            Self::Rotation { centre, angular_velocity } => angular_velocity.cross(&(x - centre)),
            Self::Eq101 => Vector3::new(x[0].cos() * x[1].sin(), -x[0].sin() * x[1].cos(), 0.0),
            Self::RudmanShear => Vector3::new(x[0].sin() * x[1].cos(), -x[0].cos() * x[1].sin(), 0.0),
            Self::ReversedVortex => {
                let ((a, da), (b, db)) = (wave(x[0]), wave(x[1]));
                Vector3::new(-a * db, b * da, 0.0)
            }
            Self::Deformation3d => {
                let ((a, da), (b, db), (c, dc)) = (wave(x[0]), wave(x[1]), wave(x[2]));
                Vector3::new(2.0 * a * db * dc, -da * b * dc, -da * db * c)
            }
            Self::Shear3d { speed, radius } => {
                let ((a, da), (b, db)) = (wave(x[0]), wave(x[1]));
                let r = (x[0] - 0.5).hypot(x[1] - 0.5);
                Vector3::new(a * db, -da * b, speed * (1.0 - r / radius).powi(2))
            }
        }
    }

    /// A vector potential: the velocity is its curl. For planar fields its z component is the stream function
    /// `psi` with `u = d psi / dy`, `v = - d psi / dx`, and does not depend on z.
    pub fn potential(&self, x: &Vector3) -> Vector3 {
        let along_z = |psi: f64| Vector3::new(0.0, 0.0, psi);
        match *self {
            Self::Uniform { velocity: u } => Vector3::new(0.0, u[2] * x[0], u[0] * x[1] - u[1] * x[0]),
            Self::Rotation { centre, angular_velocity } => {
                // -1/2 (distance from the axis)^2 omega, with an axis whose square neither over- nor underflows
                let rate = angular_velocity.amax();
                if rate == 0.0 {
                    return Vector3::zeros();
                }
                let axis = angular_velocity / rate;
                let swept = axis.cross(&(x - centre));
                angular_velocity * (-0.5 * swept.norm_squared() / axis.norm_squared())
            }
            Self::Eq101 => along_z(-x[0].cos() * x[1].cos()),
            Self::RudmanShear => along_z(x[0].sin() * x[1].sin()),
            Self::ReversedVortex => along_z(-wave(x[0]).0 * wave(x[1]).0 / PI),
            Self::Deformation3d => {
                let ((a, _), (b, db), (c, dc)) = (wave(x[0]), wave(x[1]), wave(x[2]));
                Vector3::new(0.0, -a * db * c, a * b * dc) / PI
            }
            Self::Shear3d { speed, radius } => {
                // Around the axis A_theta = (1/r) int w r dr = U (r/2 - 2 r^2 / (3 R) + r^3 / (4 R^2)).
                let (dx, dy) = (x[0] - 0.5, x[1] - 0.5);
                let q = dx.hypot(dy) / radius;
                let around = speed * (0.5 - 2.0 / 3.0 * q + 0.25 * q * q);
                Vector3::new(-dy * around, dx * around, wave(x[0]).0 * wave(x[1]).0 / PI)
            }
        }
    }

    /// The material acceleration of the steady field, `(u . grad) u`, by a central difference along the path.
    pub fn acceleration(&self, x: &Vector3) -> Vector3 {
        let u = self.velocity(x);
        let speed = u.norm();
        if speed == 0.0 {
            return Vector3::zeros();
        }
        // The cube root of the rounding unit balances truncation and rounding.
        let step = f64::EPSILON.cbrt() * (1.0 + x.amax()) / speed;
        (self.velocity(&(x + u * step)) - self.velocity(&(x - u * step))) / (2.0 * step)
    }
}
