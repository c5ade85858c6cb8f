//! Meshes and transports that several tests use.
#![allow(dead_code, reason = "each test binary uses its own part")]

use vofkit::advection::{Settings, SweepAxes, Transport};
use vofkit::geometry::{Cell, Hexahedron, Quad};
use vofkit::mesh::{Distortion, Mesh};
use vofkit::velocity::Velocity;

pub(crate) type Mesh2 = Mesh<Quad, 2>;
pub(crate) type Mesh3 = Mesh<Hexahedron, 3>;

/// The unit square or cube with `n` cells along each axis.
pub(crate) fn unit_mesh<C: Cell<D>, const D: usize>(n: usize, distortion: Distortion) -> Mesh<C, D> {
    Mesh::unit([n; D], &distortion).expect("a valid mesh")
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
