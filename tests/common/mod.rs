//! Meshes and transports that several tests use.
#![allow(dead_code, reason = "each test binary uses its own part")]

use vofkit::advection::{Boundary, SweepAxes, Transport};
use vofkit::geometry::{Cell, Hexahedron, Quad, Vector};
use vofkit::interface::Reconstruction;
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::velocity::{FaceFluxes, Velocity};

pub(crate) type Mesh2 = Mesh<Quad, 2>;
pub(crate) type Mesh3 = Mesh<Hexahedron, 3>;

/// The unit square or cube with `n` cells along each axis.
pub(crate) fn unit_mesh<C: Cell<D>, const D: usize>(n: usize, distortion: Distortion) -> Mesh<C, D> {
    Mesh::new(Grid::new([n; D], [false; D]), Vector::zeros(), Vector::repeat(1.0), &distortion)
        .expect("a valid mesh")
}

pub(crate) fn random(amplitude: f64, seed: u64) -> Distortion {
    Distortion::Random { amplitude, seed }
}

/// A transport with open or walled ends as the velocity has it, void flowing in, and default reconstruction.
pub(crate) fn transport<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocity: Velocity,
    axes: SweepAxes,
) -> Transport<'_, C, D> {
    let fluxes = FaceFluxes::new(mesh, &velocity.field);
    let boundary = Boundary::resolve(mesh, &fluxes, [[None; 2]; D], None).expect("no walls asked for");
    Transport::new(mesh, velocity, fluxes, boundary, Reconstruction::default(), axes)
}
