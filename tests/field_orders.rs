//! Orders of convergence of the schemes on face fluxes, and the largest factor on MinMod that lets the total variation not grow.

mod common;

use std::f64::consts::TAU;

use common::Mesh2;
use vofkit::geometry::Vector;
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::metrics::{shape_error, total_variation};
use vofkit::profile::Profile;
use vofkit::velocity::{FaceFluxes, Field};
use vofkit::volume_associated::{Limiter, Quantity, Scheme, Splitting, VolumeTransport};

/// L1 errors after one period of the sine `wave . x`, moved by `velocity` at a Courant number of at most 0.8.
fn errors(
    cells: [usize; 2],
    upper: [f64; 2],
    distortion: &Distortion,
    wave: [f64; 2],
    velocity: [f64; 2],
    schemes: &[Scheme],
) -> Vec<f64> {
    let mesh: Mesh2 =
        Mesh::new(Grid::new(cells, [true; 2]), Vector::zeros(), upper.into(), distortion).expect("valid");
    let profile = Profile::Sine { mean: 0.0, amplitude: 1.0, wave: wave.into(), phase: 0.3 };
    let start = profile.cell_means(&mesh);
    let quantities: Vec<Quantity> =
        schemes.iter().map(|&scheme| Quantity { scheme, ..Quantity::default() }).collect();
    let field = Field::Uniform { velocity: [velocity[0], velocity[1], 0.0].into() };
    let fluxes = FaceFluxes::new(&mesh, &field).expect("in range");
    let steps = (fluxes.courant_rate(&mesh) / 0.8).ceil() as usize;
    let mut transport = VolumeTransport::new(&mesh, Splitting::Symmetric, false);
    let mut values = vec![start.clone(); schemes.len()];
    for step in 0..steps {
        transport.flow(&fluxes, 1.0 / steps as f64, step, &quantities, &mut values).expect("a valid step");
    }
    values.iter().map(|values| shape_error(&mesh, values, &start) / mesh.total_volume()).collect()
}

/// The slope of the least-squares line through `ln error` against `ln n`, downwards.
fn fitted(sizes: &[usize], errors: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> = sizes.iter().zip(errors).map(|(&n, e)| ((n as f64).ln(), e.ln())).collect();
    let mean = |pick: fn(&(f64, f64)) -> f64| points.iter().map(pick).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    -covariance / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

fn expected() -> Vec<(Scheme, f64)> {
    vec![
        (Scheme::Muscl(Limiter::VanLeer), 1.9),
        (Scheme::Muscl(Limiter::Woodward), 1.9),
        (Scheme::Muscl(Limiter::MinMod), 1.7),
        (Scheme::Muscl(Limiter::Superbee), 1.7),
        (Scheme::Fct, 1.7),
        (Scheme::Muscl(Limiter::Off), 1.9),
        (Scheme::LaxWendroff, 1.9),
        (Scheme::Donor, 0.9),
    ]
}

fn check(what: &str, sizes: &[usize], errors: impl Fn(usize, &[Scheme]) -> Vec<f64>) {
    let expected = expected();
    let schemes: Vec<Scheme> = expected.iter().map(|(scheme, _)| *scheme).collect();
    let by_size: Vec<Vec<f64>> = sizes.iter().map(|&n| errors(n, &schemes)).collect();
    for (k, (scheme, least)) in expected.iter().enumerate() {
        let errors: Vec<f64> = by_size.iter().map(|errors| errors[k]).collect();
        let order = fitted(sizes, &errors);
        assert!(order >= *least, "{what} {scheme:?}: order {order}, errors {errors:?}");
    }
}

#[test]
fn orders_on_a_bar() {
    check("bar", &[60, 120, 240, 480], |n, schemes| {
        errors([n, 1], [1.0, 1.0 / n as f64], &Distortion::None, [TAU, 0.0], [1.0, 0.0], schemes)
    });
}

#[test]
fn orders_in_two_dimensions() {
    for distortion in [Distortion::None, Distortion::Wave { amplitude: 0.3 }] {
        let on_squares = |n: usize, schemes: &[Scheme]| {
            errors([n, n], [1.0, 1.0], &distortion, [TAU, 0.0], [1.0, 1.0], schemes)
        };
        check(&format!("{distortion:?}"), &[60, 120, 240], on_squares);
    }
}

/// The total variation of noise never grows under `tvd` with `alpha` MinMod just where `alpha <= 2 (1/Cr - 1)`.
#[test]
fn the_largest_factor_on_min_mod() {
    let n = 24;
    let grid = Grid::new([n, 1], [true, false]);
    let mesh: Mesh2 =
        Mesh::new(grid, Vector::zeros(), [1.0, 1.0 / n as f64].into(), &Distortion::None).expect("valid");
    let fluxes = FaceFluxes::new(&mesh, &Field::Uniform { velocity: Vector::<3>::x() }).expect("in range");
    let start: Vec<f64> = (0..n).map(|i| ((i * i + 3 * i) % 11) as f64 / 11.0).collect();
    let grows = |courant: f64, alpha: f64| {
        let mut transport = VolumeTransport::new(&mesh, Splitting::Alternating, false);
        let quantity =
            Quantity { scheme: Scheme::Tvd(Limiter::ScaledMinMod { alpha }), ..Quantity::default() };
        let mut values = vec![start.clone()];
        (0..200).any(|step| {
            let before = total_variation(mesh.grid(), &values[0]);
            transport
                .flow(&fluxes, courant / n as f64, step, &[quantity], &mut values)
                .expect("a valid step");
            total_variation(mesh.grid(), &values[0]) > before * (1.0 + 1e-12)
        })
    };
    for courant in [0.5_f64, 0.55, 0.6, 0.7, 0.8, 0.9, 0.95] {
        let bound = (2.0 * (1.0 / courant - 1.0)).min(2.0);
        let (mut fine, mut grown) = (0.0, 2.0_f64);
        for _ in 0..12 {
            let alpha = 0.5 * (fine + grown);
            if grows(courant, alpha) { grown = alpha } else { fine = alpha }
        }
        assert!((fine - bound).abs() <= 1e-3, "Cr {courant}: {fine}, not {bound}");
        assert!(!grows(courant, bound * (1.0 - 1e-12)), "Cr {courant}");
    }
}
