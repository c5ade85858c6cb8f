//! Meshes and transports that several tests use.
#![allow(dead_code, reason = "each test binary uses its own part")]

use proptest::test_runner::{Config, RngSeed};
use vofkit::advection::{Ledger, Settings, StepError, SweepAxes, Transport};
use vofkit::geometry::{Cell, Hexahedron, Quad};
use vofkit::mesh::{Distortion, Mesh};
use vofkit::metrics::material_volume;
use vofkit::velocity::{Field, Reversal, Velocity};

pub(crate) type Mesh2 = Mesh<Quad, 2>;
pub(crate) type Mesh3 = Mesh<Hexahedron, 3>;

/// The unit square or cube with `n` cells along each axis.
pub(crate) fn unit_mesh<C: Cell<D>, const D: usize>(n: usize, distortion: Distortion) -> Mesh<C, D> {
    Mesh::unit([n; D], &distortion).expect("a valid mesh")
}

/// What property tests run with: the same cases on every machine.
pub(crate) fn fixed(cases: u32, seed: u64) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..Config::default() }
}

pub(crate) fn random(amplitude: f64, seed: u64) -> Distortion {
    Distortion::Random { amplitude, seed }
}

/// A transport with the ends that the velocity asks for, and the default reconstruction.
pub(crate) fn transport<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocity: Velocity,
    axes: SweepAxes,
) -> Transport<'_, C, D> {
    Transport::new(mesh, velocity, Settings { axes, ..Settings::default() }).expect("no walls asked for")
}

pub(crate) fn steady(field: Field) -> Velocity {
    Velocity { field, reversal: Reversal::None }
}

/// Runs `steps` equal steps up to `end` and adds up what they did.
pub(crate) fn run<C: Cell<D>, const D: usize>(
    transport: &mut Transport<'_, C, D>,
    fractions: &mut [Vec<f64>],
    steps: usize,
    end: f64,
) -> Result<Ledger, StepError> {
    let mut ledger = Ledger::new(fractions.len());
    let time = |step: usize| end * step as f64 / steps as f64;
    for step in 0..steps {
        ledger.add(&transport.step(fractions, step, time(step), time(step + 1))?);
    }
    Ok(ledger)
}

/// Relative change of the volume, less what left through open ends.
pub(crate) fn drift<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    before: &[f64],
    after: &[f64],
    outflow: f64,
) -> f64 {
    let start = material_volume(mesh, before);
    (material_volume(mesh, after) - start + outflow) / start
}
