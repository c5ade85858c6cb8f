//! L1 errors of the schemes for quantities of the mesh after one period of a sine, and their orders.

use std::f64::consts::TAU;

use vofkit::geometry::{Quad, Vector};
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::metrics::shape_error;
use vofkit::profile::Profile;
use vofkit::velocity::{FaceFluxes, Field};
use vofkit::volume_associated::{
    Limiter, PointScheme, PointTransport, Quantity, Scheme, Splitting, VolumeMatrix, VolumeTransport,
};

/// Steps of the schemes at points for each one of the others: along a diagonal they are stable up to a Courant number of about a third.
const POINT_STEPS: usize = 4;

/// A scheme on face fluxes or at points.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Method {
    Faces(Scheme),
    Points(PointScheme),
}

/// The schemes that are measured, each with the least order that it has to have.
pub(crate) fn methods() -> Vec<(&'static str, Method, Option<f64>)> {
    let galerkin = PointScheme::LaxWendroffGalerkin { matrix: VolumeMatrix::Lumped };
    let muscl = |limiter: Limiter| Method::Faces(Scheme::Muscl(limiter));
    let tvd = |limiter: Limiter| Method::Faces(Scheme::Tvd(limiter));
    vec![
        ("muscl van_leer", muscl(Limiter::VanLeer), Some(1.9)),
        ("muscl woodward", muscl(Limiter::Woodward), Some(1.9)),
        ("muscl min_mod", muscl(Limiter::MinMod), Some(1.7)),
        ("muscl superbee", muscl(Limiter::Superbee), Some(1.7)),
        ("muscl off", muscl(Limiter::Off), Some(1.9)),
        ("fct", Method::Faces(Scheme::Fct), Some(1.7)),
        ("lax_wendroff", Method::Faces(Scheme::LaxWendroff), Some(1.9)),
        ("donor", Method::Faces(Scheme::Donor), Some(0.9)),
        ("tvd superbee", tvd(Limiter::Superbee), None),
        ("tvd min_mod", tvd(Limiter::MinMod), None),
        ("tvd woodward", tvd(Limiter::Woodward), None),
        ("tvd van_leer", tvd(Limiter::VanLeer), None),
        ("tvd courant_min_mod", tvd(Limiter::CourantMinMod), None),
        ("lax_wendroff_galerkin", Method::Points(galerkin), None),
    ]
}

/// A mesh, and the numbers of cells along its axes by one of them.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) sizes: Vec<usize>,
    distortion: Distortion,
    is_bar: bool,
}

/// A bar, the square, and the square under a wave.
pub(crate) fn cases() -> [Case; 3] {
    let case = |name: &'static str, sizes: &[usize], distortion: Distortion, is_bar: bool| Case {
        name,
        sizes: sizes.to_vec(),
        distortion,
        is_bar,
    };
    [
        case("bar", &[60, 120, 240, 480], Distortion::None, true),
        case("undistorted", &[60, 120, 240], Distortion::None, false),
        case("wave 0.3", &[60, 120, 240], Distortion::Wave { amplitude: 0.3 }, false),
    ]
}

/// What can go wrong.
pub(crate) type Failure = Box<dyn std::error::Error>;

impl Case {
    /// The errors of each scheme after one period of a sine along x, moved along x (bar) or the diagonal in symmetric sweeps at a Courant number
    /// of at most `courant`.
    pub(crate) fn errors(&self, n: usize, courant: f64, methods: &[Method]) -> Result<Vec<f64>, Failure> {
        let (cells, upper) = if self.is_bar { ([n, 1], [1.0, 1.0 / n as f64]) } else { ([n, n], [1.0, 1.0]) };
        let mesh = Mesh::<Quad, 2>::new(
            Grid::new(cells, [true; 2]),
            Vector::zeros(),
            upper.into(),
            &self.distortion,
        )?;
        let profile = Profile::Sine { mean: 0.0, amplitude: 1.0, wave: [TAU, 0.0].into(), phase: 0.3 };
        let start = profile.cell_means(&mesh);
        let velocity = Vector::<3>::new(1.0, if self.is_bar { 0.0 } else { 1.0 }, 0.0);
        let fluxes = FaceFluxes::new(&mesh, &Field::Uniform { velocity })?;
        let steps = (fluxes.courant_rate(&mesh) / courant).ceil() as usize;
        let duration = 1.0 / steps as f64;
        let displacement = vec![
            Vector::<2>::new(velocity[0], velocity[1]) * (duration / POINT_STEPS as f64);
            mesh.nodes().len()
        ];
        let mut volumes = VolumeTransport::new(&mesh, Splitting::Symmetric, false);
        let mut points = PointTransport::new(&mesh)?;
        let (mut quantities, mut by_faces, mut by_points) = (Vec::new(), Vec::new(), Vec::new());
        for method in methods {
            match *method {
                Method::Faces(scheme) => {
                    quantities.push(Quantity { scheme, ..Quantity::default() });
                    by_faces.push(start.clone());
                }
                Method::Points(scheme) => by_points.push((scheme, vec![start.clone()])),
            }
        }
        for step in 0..steps {
            volumes.flow(&fluxes.step(duration), step, &quantities, &mut by_faces)?;
            for (scheme, values) in &mut by_points {
                for _ in 0..POINT_STEPS {
                    points.step(&mesh, &displacement, *scheme, values)?;
                }
            }
        }
        let (mut by_faces, mut by_points) = (by_faces.into_iter(), by_points.into_iter());
        let result = |method: &Method| match method {
            Method::Faces(_) => by_faces.next().unwrap_or_default(),
            Method::Points(_) => by_points.next().map(|(_, values)| values.concat()).unwrap_or_default(),
        };
        let results = methods.iter().map(result);
        Ok(results.map(|values| shape_error(&mesh, &values, &start) / mesh.total_volume()).collect())
    }
}

/// The slope of the least-squares line through `ln error` against `ln n`, downwards.
pub(crate) fn fitted(sizes: &[usize], errors: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> = sizes.iter().zip(errors).map(|(&n, e)| ((n as f64).ln(), e.ln())).collect();
    let mean = |pick: fn(&(f64, f64)) -> f64| points.iter().map(pick).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    -covariance / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}
