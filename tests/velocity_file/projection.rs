//! Fluxes made free of divergence.

use vofkit::advection::{Scheme, Settings, Transport};
use vofkit::export::vtk::Collection;
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, Vector};
use vofkit::import::{NodalVelocity, velocity_files};
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::metrics::shape_error;
use vofkit::shape::Shape;
use vofkit::velocity::{Divergence, Field, Flow, Reversal, Sampled, SampledError, Velocity};

use crate::common::{Mesh2, Mesh3, drift, random, run, unit_mesh};
use crate::{sampled, write};

/// The samples of a field without their divergence.
fn projected<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, field: &Field) -> Flow<D> {
    let samples = Sampled::new(mesh, vec![(0.0, sampled(mesh, field))], Divergence::Project);
    Flow::sampled(samples.expect("a projection"), Reversal::None)
}

#[test]
fn nothing_but_rounding_is_left_of_the_divergence() {
    let plane = [Field::ReversedVortex, Field::Eq101, Field::RudmanShear];
    for distortion in [Distortion::None, Distortion::Wave { amplitude: 0.5 }, random(0.2, 7)] {
        let (flat, solid): (Mesh2, Mesh3) = (unit_mesh(24, distortion.clone()), unit_mesh(10, distortion));
        for field in plane {
            let flow = projected(&flat, &field);
            let dt = 1.0 / flow.courant_rate(&flat);
            let left = flow.largest_divergence(&flat, dt);
            assert!(left <= 1e-13, "{field:?}: {left:e}");
        }
        let flow = projected(&solid, &Field::Deformation3d);
        let left = flow.largest_divergence(&solid, 1.0 / flow.courant_rate(&solid));
        assert!(left <= 1e-13, "{left:e}");
    }
}

/// Joined ends, open ends and walls in one mesh of flat cells.
#[test]
fn ends_of_all_kinds_are_kept() {
    let grid = Grid::new([20, 12], [true, false]);
    let mesh =
        Mesh2::new(grid, Vector::zeros(), Vector::<2>::new(1.0, 0.02), &Distortion::Wave { amplitude: 0.3 })
            .unwrap();
    let pi = std::f64::consts::PI;
    let speed = |x: &Vector<2>| {
        // In through the lower end, nothing through the upper one.
        Vector::<2>::new(1.0 + (2.0 * pi * x[0]).sin(), 0.1 * (1.0 - x[1] / 0.02))
    };
    let velocities: Vec<Vector<2>> = mesh.nodes().iter().map(speed).collect();
    let samples = Sampled::new(&mesh, vec![(0.0, velocities)], Divergence::Project).expect("a projection");
    let flow = Flow::sampled(samples, Reversal::None);
    let dt = 1.0 / flow.courant_rate(&mesh);
    assert!(flow.largest_divergence(&mesh, dt) <= 1e-12);
    for i in 0..20 {
        assert_eq!(flow.largest_flux([i, 11], 1, 1), 0.0);
    }
    // What comes in leaves through the same end, as there is no other.
    let step = flow.step(0.0, dt);
    let net: f64 = (0..20).map(|i| step.fluxes().through([i, 0], 1, 0)).sum();
    assert!(net.abs() <= 1e-13 * mesh.total_volume(), "{net:e}");
}

/// The walls beside an inlet stay closed although rounding crosses them.
#[test]
fn parts_of_open_ends_stay_closed() {
    let mesh: Mesh2 = unit_mesh(16, Distortion::None);
    let speed = |x: &Vector<2>| {
        let inlet = (x[1] - 0.25) * (0.75 - x[1]);
        Vector::<2>::new(if inlet > 0.0 { inlet } else { 1e-17 }, 0.0) * (1.0 - 0.5 * x[0])
    };
    let velocities: Vec<Vector<2>> = mesh.nodes().iter().map(speed).collect();
    let samples = Sampled::new(&mesh, vec![(0.0, velocities)], Divergence::Project).expect("a projection");
    let flow = Flow::sampled(samples, Reversal::None);
    assert!(flow.largest_divergence(&mesh, 1.0 / flow.courant_rate(&mesh)) <= 1e-13);
    let through = |j: usize| flow.largest_flux([0, j], 0, 0);
    assert!((0..16).all(|j| if (4..12).contains(&j) { through(j) > 1e-4 } else { through(j) <= 1e-16 }));
}

#[test]
fn a_divergence_is_an_error_unless_asked_for() {
    let mesh: Mesh2 = unit_mesh(8, random(0.2, 1));
    let velocities = sampled(&mesh, &Field::RudmanShear);
    let error = Sampled::new(&mesh, vec![(0.0, velocities)], Divergence::default()).err();
    let Some(SampledError::Divergent { frame: 0, cell, relative }) = error else { panic!("{error:?}") };
    assert_eq!(cell.len(), 2);
    assert!(relative > 1e-6 && relative < 0.1, "{relative}");
}

#[test]
fn velocities_and_times_out_of_range_are_refused() {
    let mesh: Mesh2 = unit_mesh(4, random(0.2, 1));
    let uniform = |speed: f64| sampled(&mesh, &Field::Uniform { velocity: [speed, 0.0, 0.0].into() });
    let error = |samples| Sampled::new(&mesh, samples, Divergence::default()).err();
    assert_eq!(error(vec![(0.0, uniform(1e120))]), None);
    assert_eq!(error(vec![(0.0, uniform(1e200))]), Some(SampledError::Speed { frame: 0, fastest: 1e200 }));
    for time in [-1e308, f64::NAN, f64::INFINITY] {
        let found = error(vec![(time, uniform(1.0)), (1e308, uniform(1.0))]);
        assert!(matches!(found, Some(SampledError::TimeRange { .. })), "{found:?}");
    }
}

/// The vortex, turned back by a cosine: its error as a formula and from a series of files.
fn errors<C: Cell<2>>(mesh: &Mesh<C, 2>, scheme: Scheme, period: f64) -> [f64; 2] {
    let folder = tempfile::tempdir().unwrap();
    let mut series = Collection::new(folder.path().join("vortex.pvd"));
    for k in 0..=32 {
        let time = period * f64::from(k) / 32.0;
        let amplitude = (std::f64::consts::PI * time / period).cos();
        let velocities: Vec<Vector<2>> =
            sampled(mesh, &Field::ReversedVortex).iter().map(|u| u * amplitude).collect();
        let path = folder.path().join(format!("vortex_{k}.vts"));
        write(&path, mesh, &velocities);
        series.add(time, &[("flow", &path)]).unwrap();
    }
    let read = velocity_files(series.path()).unwrap().into_iter().map(|file| {
        let velocities = NodalVelocity::read(&file.path).unwrap().on(mesh).unwrap();
        (file.time, velocities)
    });
    let samples = Sampled::new(mesh, read.collect(), Divergence::Project).expect("a projection");
    let velocity = Velocity { field: Field::ReversedVortex, reversal: Reversal::Cosine { period } };
    let settings = Settings { scheme, ..Settings::default() };
    let formula = Transport::new(mesh, velocity, settings).expect("walls");
    let flow = Flow::sampled(samples, Reversal::None);
    let files = Transport::with_flow(mesh, flow, settings).expect("walls");
    let disc = Shape::Sphere { centre: [0.5, 0.75].into(), radius: 0.15 };
    let start = volume_fractions(mesh, &[disc]);
    let steps = (formula.courant_rate() * period / 0.5).ceil() as usize;
    [formula, files].map(|mut transport| {
        let mut fractions = start.clone();
        let ledger = run(&mut transport, &mut fractions, steps, period).expect("short steps");
        let drift = drift(mesh, &start[0], &fractions[0], ledger.materials[0].outflow);
        assert!(drift.abs() <= 1e-12, "{scheme}: drift {drift:e}");
        let account = &ledger.materials[0];
        assert!(account.smallest >= -1e-12 && account.largest <= 1.0 + 1e-12, "{account:?}");
        shape_error(mesh, &fractions[0], &start[0])
    })
}

/// How many times the error of the formula. Pre-images see fluxes whose error is not that of the paths of the nodes; sweeps see fluxes
/// alone, and planes at the rims of films that do not come to rest, which chance moves the errors of both by a fifth.
const SCHEMES: [(Scheme, f64); 2] = [(Scheme::Sweeps, 1.3), (Scheme::Unsplit, 1.5)];

#[test]
fn a_series_comes_as_near_as_the_formula() {
    let mesh: Mesh2 = unit_mesh(64, Distortion::None);
    for (scheme, most) in SCHEMES {
        let [formula, files] = errors(&mesh, scheme, 2.0);
        assert!(files <= most * formula, "{scheme}: {files:e} and {formula:e}");
    }
}

#[test]
fn so_it_does_on_a_distorted_mesh() {
    let mesh: Mesh2 = unit_mesh(48, random(0.2, 1));
    for (scheme, most) in SCHEMES {
        let [formula, files] = errors(&mesh, scheme, 2.0);
        assert!(files <= most * formula, "{scheme}: {files:e} and {formula:e}");
    }
}

#[test]
fn hexahedra_keep_their_volume() {
    let mesh: Mesh3 = unit_mesh(12, random(0.2, 4));
    let ball = Shape::Sphere { centre: Vector::repeat(0.4), radius: 0.2 };
    let start = volume_fractions(&mesh, &[ball]);
    for scheme in [Scheme::Sweeps, Scheme::Unsplit] {
        let flow = projected(&mesh, &Field::Deformation3d);
        let settings = Settings { scheme, ..Settings::default() };
        let mut transport = Transport::with_flow(&mesh, flow, settings).expect("walls");
        let mut fractions = start.clone();
        let end = 10.0 * 0.5 / transport.courant_rate();
        run(&mut transport, &mut fractions, 10, end).expect("short steps");
        let drift = drift(&mesh, &start[0], &fractions[0], 0.0);
        assert!(drift.abs() <= 1e-13, "{scheme}: {drift:e}");
    }
}
