//! Fractions that are none, and meshes that scenes cannot name.

use vofkit_geometry::{Cell, Hexahedron, PositionError, PositionMethod, Quad, Vector};

use super::Family;
use super::case::{Input, Verdict};
use super::cells::{common, filled};
use crate::advection::{Settings, Transport, remap};
use crate::interface::{Reconstruction, reconstruct};
use crate::mesh::{Distortion, Grid, Mesh};
use crate::metrics::material_volume;
use crate::quantity::State;
use crate::velocity::{Field, Reversal, Velocity};

/// Change of a volume that is rounding, relative to the mesh.
const VOLUME: f64 = 1e-12;

pub(super) const FAMILIES: &[Family] = &[
    Family {
        name: "fractions/odd",
        holds: "fractions below 0, above 1 and not a number are refused with a typed error; all others, denormal ones too, have a finite plane",
        weight: 1,
        draw: |random| {
            let (nodes, normal) = (common(random), random.unit());
            let odd = [
                -1e-300,
                -1.0,
                1.0 + f64::EPSILON,
                f64::NAN,
                f64::INFINITY,
                1e-310,
                5e-324,
                -0.0,
                1.0 - f64::EPSILON,
            ];
            filled(nodes, normal, random.one_of(&odd))
        },
        judge: odd,
    },
    Family {
        name: "fractions/field",
        holds: "one bad fraction in a field is refused by reconstruction and by a step, and the field stays as it was",
        weight: 50,
        draw: |random| {
            Input::Number(random.one_of(&[-1e-15, -1.0, 1.0 + 1e-15, 2.0, f64::NAN, f64::NEG_INFINITY]))
        },
        judge: |input| if let Input::Number(bad) = input { bad_field(*bad) } else { Verdict::good("") },
    },
    Family {
        name: "motion/graded",
        holds: "a mesh whose neighbours differ in volume by up to 1e6 conserves volume and stays within bounds",
        weight: 250,
        draw: |random| Input::Number(10.0_f64.powf(random.within(0.0, 6.0))),
        judge: |input| if let Input::Number(ratio) = input { graded(*ratio) } else { Verdict::good("") },
    },
    Family {
        name: "motion/spin",
        holds: "a remap to the mesh turned by 90 degrees gives the same volume and stays within bounds",
        weight: 250,
        draw: |random| Input::Number(random.within(0.05, 0.45)),
        judge: |input| if let Input::Number(radius) = input { spin(*radius) } else { Verdict::good("") },
    },
];

fn odd(input: &Input) -> Verdict {
    let Input::Cell(row) = input else { return Verdict::good("") };
    let (cell, fraction) = (Hexahedron::new(row.nodes), row.fraction());
    if cell.defects().iter().any(vofkit_geometry::Defect::is_error) {
        return Verdict::good("the check refuses the cell");
    }
    let methods = [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent];
    for found in methods.map(|method| cell.plane_constant(&row.normal, fraction, method)) {
        let fits = match &found {
            Ok(found) => (0.0..=1.0).contains(&fraction) && found.constant.is_finite(),
            Err(PositionError::Fraction(_)) => !(0.0..=1.0).contains(&fraction),
            Err(_) => false,
        };
        if !fits {
            return Verdict::broken(format!("{fraction:e}: {found:?}"));
        }
    }
    Verdict::good("as it should be")
}

fn vortex() -> Velocity {
    Velocity { field: Field::ReversedVortex, reversal: Reversal::None }
}

fn bad_field(bad: f64) -> Verdict {
    let distortion = Distortion::Random { amplitude: 0.2, seed: 3 };
    let Ok(mesh) = Mesh::<Quad, 2>::unit([6; 2], &distortion) else { return Verdict::broken("no mesh") };
    let mut fractions = vec![vec![0.5; mesh.grid().len()]];
    fractions[0][17] = bad;
    let before: Vec<u64> = fractions[0].iter().map(|f| f.to_bits()).collect();
    if let Ok(interface) = reconstruct(&mesh, &fractions, Reconstruction::default()) {
        return Verdict::broken(format!("{} facets of a field with {bad}", interface.facets.len()));
    }
    let Ok(mut transport) = Transport::new(&mesh, vortex(), Settings::default()) else {
        return Verdict::broken("no transport");
    };
    let stepped = transport.step(&mut fractions, 0, 0.0, 1e-3);
    let same = fractions[0].iter().map(|f| f.to_bits()).eq(before);
    if stepped.is_err() && same {
        Verdict::good("refused")
    } else {
        Verdict::broken(format!("a step with {bad}: {stepped:?}"))
    }
}

/// The unit square with columns whose widths alternate by a ratio.
fn graded(ratio: f64) -> Verdict {
    let grid = Grid::new([8, 8], [false; 2]);
    let width = |column: usize| if column.is_multiple_of(2) { ratio } else { 1.0 };
    let total: f64 = (0..8).map(width).sum();
    let place = |count: usize| (0..count).map(width).sum::<f64>() / total;
    let nodes = (0..grid.node_count()).map(|node| {
        let [i, j] = grid.node_offset(node);
        Vector::<2>::new(place(i), j as f64 / 8.0)
    });
    let nodes: Vec<Vector<2>> = nodes.collect();
    let mesh = match Mesh::<Quad, 2>::from_nodes(grid, nodes) {
        Ok(mesh) => mesh,
        Err(error) => return Verdict::broken(error.to_string()),
    };
    let mut fractions = crate::fractions::volume_fractions(&mesh, &[disc(0.3)]);
    let before = material_volume(&mesh, &fractions[0]);
    let mut transport = match Transport::new(&mesh, vortex(), Settings::default()) {
        Ok(transport) => transport,
        Err(error) => return Verdict::broken(error.to_string()),
    };
    let dt = 0.5 / transport.courant_rate();
    let mut outside: f64 = 0.0;
    for step in 0..20 {
        match transport.step(&mut fractions, step, step as f64 * dt, (step + 1) as f64 * dt) {
            Ok(ledger) => {
                let account = ledger.materials[0];
                outside = outside.max(-account.smallest).max(account.largest - 1.0);
            }
            Err(error) => return Verdict::broken(error.to_string()),
        }
    }
    let drift = (material_volume(&mesh, &fractions[0]) - before).abs();
    Verdict::of(drift, VOLUME, format!("drift {drift:e}")).or(Verdict::of(
        outside,
        VOLUME,
        format!("{outside:e} out of bounds"),
    ))
}

fn disc(radius: f64) -> crate::shape::Shape<2> {
    crate::shape::Shape::Sphere { centre: Vector::<2>::new(0.5, 0.52), radius }
}

fn spin(radius: f64) -> Verdict {
    let cells = 9;
    let distortion = Distortion::Random { amplitude: 0.2, seed: 5 };
    let Ok(from) = Mesh::<Quad, 2>::unit([cells; 2], &distortion) else { return Verdict::broken("no mesh") };
    // The same boxes, numbered as if the mesh had been turned about its middle.
    let turned = from.nodes().iter().map(|x| Vector::<2>::new(1.0 - x[1], x[0]));
    let to = match Mesh::<Quad, 2>::from_nodes(Grid::new([cells; 2], [false; 2]), turned.collect()) {
        Ok(mesh) => mesh,
        Err(error) => return Verdict::broken(error.to_string()),
    };
    let fractions = crate::fractions::volume_fractions(&from, &[disc(radius)]);
    let state = State { fractions, quantities: Vec::new() };
    let there = match remap(&from, &to, &state, Reconstruction::default()) {
        Ok((there, _)) => there.fractions,
        Err(error) => return Verdict::broken(error.to_string()),
    };
    let [before, after] = [material_volume(&from, &state.fractions[0]), material_volume(&to, &there[0])];
    let outside = there[0].iter().fold(0.0_f64, |worst, &f| worst.max(-f).max(f - 1.0));
    let drift = Verdict::of((after - before).abs(), VOLUME, format!("volume {before:e} became {after:e}"));
    drift.or(Verdict::of(outside, VOLUME, format!("{outside:e} out of bounds")))
}
