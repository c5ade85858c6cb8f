//! Velocities whose divergence lets materials grow.

use vofkit::advection::{Scheme, Settings, SetupError, SweepAxes, Transport};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, Vector};
use vofkit::mesh::{Distortion, Mesh};
use vofkit::metrics::material_volume;
use vofkit::shape::Shape;
use vofkit::velocity::{Divergence, Flow, Reversal, Sampled};

use crate::common::{Mesh2, Mesh3, random, run, unit_mesh};

/// Everything moves away from the middle: `u = x - centre`.
fn spreading<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>) -> Flow<D> {
    let velocities = mesh.nodes().iter().map(|x| x - Vector::repeat(0.5)).collect();
    let samples = Sampled::new(mesh, vec![(0.0, velocities)], Divergence::Dilate).expect("in range");
    Flow::sampled(samples, Reversal::None)
}

/// The growth of a ball, and what it should be.
fn grows<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, scheme: Scheme, axes: SweepAxes) -> [f64; 2] {
    let ball = Shape::Sphere { centre: Vector::repeat(0.5), radius: 0.2 };
    let start = volume_fractions(mesh, &[ball]);
    let settings = Settings { scheme, axes, ..Settings::default() };
    let mut transport = Transport::with_flow(mesh, spreading(mesh), settings).expect("open ends");
    let (mut fractions, end) = (start.clone(), 0.3);
    let steps = (transport.courant_rate() * end / 0.3).ceil() as usize;
    let ledger = run(&mut transport, &mut fractions, steps, end).expect("short steps");
    assert!(fractions[0].iter().all(|f| (0.0..=1.0).contains(f)));
    let [before, after] = [&start, &fractions].map(|f| material_volume(mesh, &f[0]));
    let account = ledger.materials[0];
    if axes == SweepAxes::Logical && scheme != Scheme::Isotropic {
        assert!(account.smallest >= -1e-12 && account.largest <= 1.0 + 1e-12, "{scheme}: {account:?}");
        assert!(account.clipped <= 1e-12 * before, "{scheme}: {account:?}");
    }
    // What the divergence made is in the ledger.
    let left = after - before + account.outflow - account.dilated;
    assert!(left.abs() <= account.clipped + 1e-12 * before, "{scheme}: {left:e} of {account:?}");
    // Of `exp(D t)` what the scheme makes of each step.
    [after / before, (1.0 - D as f64 * end / steps as f64).powi(-(steps as i32))]
}

#[test]
fn bodies_grow_by_the_divergence_within_bounds() {
    let schemes = [
        (Scheme::Sweeps, SweepAxes::Logical),
        (Scheme::Sweeps, SweepAxes::Cartesian),
        (Scheme::Isotropic, SweepAxes::Logical),
        (Scheme::Unsplit, SweepAxes::Logical),
    ];
    for distortion in [Distortion::None, random(0.2, 9)] {
        let (flat, solid): (Mesh2, Mesh3) = (unit_mesh(32, distortion.clone()), unit_mesh(10, distortion));
        for (scheme, axes) in schemes {
            for ([found, exact], most) in
                [(grows(&flat, scheme, axes), 0.005), (grows(&solid, scheme, axes), 0.02)]
            {
                assert!((found / exact - 1.0).abs() <= most, "{scheme} {axes:?}: {found} for {exact}");
            }
        }
    }
}

#[test]
fn cells_that_keep_their_volume_cannot_dilate() {
    let mesh: Mesh2 = unit_mesh(8, Distortion::None);
    let settings = Settings { scheme: Scheme::WeymouthYue, ..Settings::default() };
    let error = Transport::with_flow(&mesh, spreading(&mesh), settings).expect_err("no error");
    assert_eq!(error, SetupError::Dilating { scheme: Scheme::WeymouthYue });
}

#[test]
fn more_than_a_cell_holds_is_an_error() {
    let mesh: Mesh2 = unit_mesh(8, Distortion::None);
    let disc = Shape::Sphere { centre: Vector::repeat(0.5), radius: 0.2 };
    for scheme in [Scheme::Sweeps, Scheme::Unsplit] {
        let settings = Settings { scheme, ..Settings::default() };
        let mut transport = Transport::with_flow(&mesh, spreading(&mesh), settings).expect("open ends");
        let mut fractions = volume_fractions(&mesh, std::slice::from_ref(&disc));
        let before = fractions.clone();
        let error = transport.step(&mut fractions, 0, 0.0, 1.5).expect_err("no error");
        assert!(error.is_too_large(), "{error}");
        assert_eq!(fractions, before);
    }
}
