//! One step of every scheme on a small mesh of any nodes near a grid, with any fractions in any velocity: volume is conserved but for
//! what the ledger says, fractions stay within bounds, and a step that cannot be done leaves them as they were.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vofkit::advection::{Scheme, Settings, SweepAxes, SweepOrder, Transport};
use vofkit::geometry::{Cell, Hexahedron, Quad, Vector};
use vofkit::interface::Reconstruction;
use vofkit::mesh::{Grid, Mesh};
use vofkit::metrics::material_volume;
use vofkit::velocity::{Reversal, Velocity};
use vofkit_fuzz::StepInput;

fn check<C: Cell<D>, const D: usize>(input: &StepInput) {
    let cells: [usize; D] = std::array::from_fn(|axis| input.cells[axis]);
    let grid = Grid::new(cells, [false; D]);
    let nodes: Vec<Vector<D>> = (0..grid.node_count())
        .map(|node| {
            let at = grid.node_offset(node);
            Vector::from_fn(|axis, _| {
                let inside = at[axis] > 0 && at[axis] < cells[axis];
                let shift = if inside { input.shift(node * D + axis) } else { 0.0 };
                (at[axis] as f64 + shift) / cells[axis] as f64
            })
        })
        .collect();
    let Ok(mesh) = Mesh::<C, D>::from_nodes(grid, nodes) else { return };
    let count = mesh.grid().len();
    let fractions: Vec<Vec<f64>> =
        (0..input.materials).map(|k| (0..count).map(|cell| input.fraction(cell, k)).collect()).collect();
    let velocity = Velocity { field: input.field(D), reversal: Reversal::None };
    let exact = [(Scheme::Sweeps, SweepAxes::Logical), (Scheme::Unsplit, SweepAxes::Logical)];
    let corrected = [
        (Scheme::Sweeps, SweepAxes::Cartesian),
        (Scheme::Isotropic, SweepAxes::Logical),
        (Scheme::WeymouthYue, SweepAxes::Logical),
    ];
    for (scheme, axes) in exact.into_iter().chain(corrected) {
        for order in [SweepOrder::Alternating, SweepOrder::Symmetric] {
            let reconstruction = Reconstruction { normal: input.normal, ..Reconstruction::default() };
            let settings = Settings { scheme, axes, order, reconstruction, ..Settings::default() };
            let Ok(mut transport) = Transport::new(&mesh, velocity, settings) else { continue };
            let rate = transport.courant_rate();
            let dt = if rate > 0.0 { input.courant * scheme.courant_limit(D) / rate } else { 1.0 };
            let mut after = fractions.clone();
            match transport.step(&mut after, 0, 0.0, dt) {
                Err(_) => assert_eq!(after, fractions, "{scheme} changed what it could not move"),
                Ok(ledger) => {
                    for (k, (before, after)) in fractions.iter().zip(&after).enumerate() {
                        assert!(after.iter().all(|f| (0.0..=1.0).contains(f)), "{scheme}: {after:?}");
                        let account = &ledger.materials[k];
                        let [a, b] = [before, after].map(|f| material_volume(&mesh, f));
                        let drift = (b - a + account.outflow).abs();
                        let allowed = 1e-12 + account.clipped + account.rescaled;
                        assert!(drift <= allowed, "{scheme}: {drift:e} of {a:e}, {account:?}");
                    }
                }
            }
        }
    }
}

fuzz_target!(|input: StepInput| {
    if input.is_solid { check::<Hexahedron, 3>(&input) } else { check::<Quad, 2>(&input) }
});
