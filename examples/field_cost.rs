//! What the transport of volume-associated quantities costs: nanoseconds per face for the swept volumes, and per cell, quantity and sweep beyond
//! them. `cargo run --release --example field_cost`, with `RAYON_NUM_THREADS=1` for one thread.

use std::time::Instant;

use vofkit::geometry::{Cell, Hexahedron, Quad, Vector};
use vofkit::mesh::{Distortion, Grid, Mesh, SweptVolumes};
use vofkit::velocity::{FaceFluxes, Field};
use vofkit::volume_associated::{FaceVolumes, Limiter, Quantity, Scheme, Splitting, VolumeTransport};

/// Repetitions, of which the fastest counts.
const ROUNDS: usize = 9;

fn fastest(mut work: impl FnMut()) -> f64 {
    let time = |work: &mut dyn FnMut()| {
        let clock = Instant::now();
        work();
        clock.elapsed().as_secs_f64()
    };
    (0..ROUNDS).map(|_| time(&mut work)).fold(f64::INFINITY, f64::min)
}

fn cost<C: Cell<D>, const D: usize>(
    cells: [usize; D],
    field: Field,
) -> Result<(), Box<dyn std::error::Error>> {
    let grid = Grid::new(cells, [false; D]);
    let mesh: Mesh<C, D> = Mesh::new(
        grid,
        Vector::zeros(),
        Vector::repeat(1.0),
        &Distortion::Random { amplitude: 0.2, seed: 1 },
    )?;
    let count = mesh.grid().len() as f64;
    let faces: usize = (0..D).map(|axis| mesh.grid().len() / cells[axis] * (cells[axis] + 1)).sum();
    let fluxes = FaceFluxes::new(&mesh, &field)?;
    let duration = 0.3 / fluxes.courant_rate(&mesh);
    println!("{cells:?} cells, {faces} faces");
    let mut crossing = FaceVolumes::zero(mesh.grid());
    let flow = fastest(|| crossing.set_flow(mesh.grid(), &fluxes.step(duration)));
    let moved = Mesh::from_nodes(mesh.grid().clone(), mesh.nodes().iter().map(|x| x * 1.001).collect())?;
    let mut wrong = None;
    let swept = fastest(|| match SweptVolumes::new(&mesh, &moved) {
        Ok(swept) => crossing.set_swept(mesh.grid(), &swept),
        Err(error) => wrong = Some(error),
    });
    if let Some(error) = wrong {
        return Err(error.into());
    }
    println!(
        "  swept volumes       flow mode {:6.2} ns a face, remesh mode {:6.2}",
        flow * 1e9 / faces as f64,
        swept * 1e9 / faces as f64
    );
    let mut transport = VolumeTransport::new(&mesh, Splitting::Alternating, false);
    let schemes = [
        ("donor", Scheme::Donor),
        ("lax_wendroff", Scheme::LaxWendroff),
        ("fct", Scheme::Fct),
        ("tvd superbee", Scheme::Tvd(Limiter::Superbee)),
        ("tvd courant min_mod", Scheme::Tvd(Limiter::CourantMinMod)),
        ("muscl van_leer", Scheme::Muscl(Limiter::VanLeer)),
        ("muscl woodward", Scheme::Muscl(Limiter::Woodward)),
    ];
    for (name, scheme) in schemes {
        let quantity = Quantity { scheme, ..Quantity::default() };
        // The step with nine quantities less that with one is the cost of eight.
        let mut times = [0.0; 2];
        for (time, quantities) in times.iter_mut().zip([1, 9]) {
            let mut values = vec![vec![1.0; mesh.grid().len()]; quantities];
            for (i, value) in values.iter_mut().flatten().enumerate() {
                *value = (i % 97) as f64;
            }
            let mut step = 0;
            let mut failed = None;
            *time = fastest(|| {
                step += 1;
                failed = transport
                    .flow(&fluxes.step(duration), step, &vec![quantity; quantities], &mut values)
                    .err();
            });
            if let Some(error) = failed {
                return Err(error.into());
            }
        }
        let each = (times[1] - times[0]) / 8.0 / (count * D as f64) * 1e9;
        println!("  {name:<20} {each:6.2} ns a cell, quantity and sweep");
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    cost::<Quad, 2>([512, 512], Field::ReversedVortex)?;
    cost::<Hexahedron, 3>([48, 48, 48], Field::Deformation3d)
}
