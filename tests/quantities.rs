//! Quantities that travel with their material: constants stay, sums are conserved, new values are between those they come from.

mod common;

use common::{Mesh2, Mesh3, fixed, random, steady, unit_mesh};
use proptest::prelude::*;
use vofkit::advection::{
    Ledger, Remesh, Scheme, Settings, StepError, SweepAxes, SweepOrder, Transport, remap,
};
use vofkit::ale::{self, AleError};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, Quad, Vector};
use vofkit::interface::Reconstruction;
use vofkit::mesh::{Distortion, Mesh, MeshError};
use vofkit::quantity::{Distribution, MaterialQuantity, QuantityError, State, effective, totals};
use vofkit::shape::Shape;
use vofkit::velocity::{Field, Velocity};
use vofkit::volume_associated::Weighting;

/// What the values of a test lie between.
const RANGE: [f64; 2] = [1.0, 3.0];

fn at_middles<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, value: impl Fn(Vector<D>) -> f64) -> Vec<f64> {
    (0..mesh.grid().len()).map(|cell| value(mesh.cell(cell).map(&Vector::repeat(0.5)))).collect()
}

/// Values between 1 and 3 that change fast.
fn varied<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>) -> Vec<f64> {
    at_middles(mesh, |x| 2.0 + (9.0 * x[0]).sin() * (7.0 * x[1]).cos())
}

/// Two materials; of the first a density, a vector carried by mass and a constant, of the second a first-order scalar.
fn state<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>) -> State {
    let shapes = [
        Shape::Sphere { centre: Vector::repeat(0.45), radius: 0.25 },
        Shape::Sphere { centre: Vector::repeat(0.6), radius: 0.3 },
    ];
    let vector = (0..D).map(|k| at_middles(mesh, |x| 2.0 + (5.0 * x[k]).sin())).collect();
    let mut scalar = MaterialQuantity::new(1, vec![varied(mesh)]);
    scalar.distribution = Distribution::Constant;
    let mut quantities = vec![
        MaterialQuantity::new(0, vector).by_mass(1),
        MaterialQuantity::new(0, vec![varied(mesh)]),
        MaterialQuantity::new(0, vec![vec![2.5; mesh.grid().len()]]).by_mass(1),
        scalar,
    ];
    for quantity in &mut quantities {
        quantity.inflow = Some(vec![2.5; quantity.values.len()]);
    }
    State { fractions: volume_fractions(mesh, &shapes), quantities }
}

/// Where there is material, constants are constant and values within their range.
fn assert_bounded(state: &State) {
    for (k, quantity) in state.quantities.iter().enumerate() {
        for values in &quantity.values {
            for (f, value) in state.fractions[quantity.material].iter().zip(values) {
                if *f == 0.0 {
                    assert_eq!(*value, 0.0);
                } else if k == 2 {
                    assert!((value - 2.5).abs() <= 1e-12 * 2.5, "{value}");
                } else {
                    assert!(
                        (RANGE[0]..=RANGE[1]).contains(value),
                        "quantity {k}: {value} where the fraction is {f:e}"
                    );
                }
            }
        }
    }
}

/// Sums change by what crossed the ends; `lost` is the share of the total that corrections may have moved.
fn assert_conserved<C: Cell<D>, const D: usize>(
    [from, to]: [&Mesh<C, D>; 2],
    before: &State,
    after: &State,
    ledger: &Ledger,
    lost: f64,
) {
    for k in 0..before.quantities.len() {
        let (start, magnitude) = totals(from, &before.fractions, &before.quantities, k);
        let (end, _) = totals(to, &after.fractions, &after.quantities, k);
        let account = ledger.quantities[k];
        let change = end.iter().sum::<f64>() - start.iter().sum::<f64>() + account.outflow;
        let allowed = 1e-13 * magnitude + if lost > 0.0 { account.limited } else { 0.0 };
        assert!(change.abs() <= allowed, "quantity {k}: {change:e} of {magnitude:e}, {account:?}");
        assert!(account.limited <= lost.max(1e-13) * magnitude, "quantity {k}: {account:?}");
    }
}

/// Steps of a Courant number; corrections may move `lost` of each total.
fn flows<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocity: Velocity,
    settings: Settings<D>,
    [courant, steps]: [f64; 2],
    lost: f64,
) {
    let before = state(mesh);
    let mut after = before.clone();
    let mut transport = Transport::new(mesh, velocity, settings).expect("no walls asked for");
    let mut ledger = Ledger::new(2);
    let dt = courant / transport.courant_rate();
    for step in 0..steps as usize {
        let State { fractions, quantities } = &mut after;
        let [start, end] = [step, step + 1].map(|step| step as f64 * dt);
        let of_step = transport.step_carrying(fractions, quantities, step, start, end);
        ledger.add(&of_step.expect("a step that can be done"));
        assert_bounded(&after);
    }
    assert_conserved([mesh, mesh], &before, &after, &ledger, lost);
}

fn settings<const D: usize>(scheme: Scheme) -> Settings<D> {
    Settings { scheme, ..Settings::default() }
}

fn cartesian<const D: usize>() -> Settings<D> {
    Settings { axes: SweepAxes::Cartesian, ..Settings::default() }
}

fn symmetric<const D: usize>() -> Settings<D> {
    Settings { order: SweepOrder::Symmetric, ..Settings::default() }
}

#[test]
fn every_scheme_carries_quantities_through_a_vortex() {
    let distorted: Mesh2 = unit_mesh(20, random(0.25, 5));
    let even: Mesh2 = unit_mesh(20, Distortion::None);
    let vortex = steady(Field::ReversedVortex);
    for settings in [Settings::default(), symmetric(), settings(Scheme::Unsplit)] {
        flows(&distorted, vortex, settings, [0.45, 20.0], 0.0);
        flows(&even, vortex, settings, [0.5, 20.0], 0.0);
    }
    // Of several materials more may be found in a cell than it holds, or regions overlap: fractions are corrected, and quantities with them.
    flows(&even, vortex, settings(Scheme::WeymouthYue), [0.5, 20.0], 0.01);
    for settings in [cartesian(), settings(Scheme::Isotropic)] {
        flows(&distorted, vortex, settings, [0.4, 20.0], 0.1);
    }
}

#[test]
fn every_scheme_carries_quantities_in_3d() {
    let distorted: Mesh3 = unit_mesh(8, random(0.2, 5));
    let even: Mesh3 = unit_mesh(8, Distortion::None);
    let field = steady(Field::Deformation3d);
    for settings in [Settings::default(), symmetric(), settings(Scheme::Unsplit)] {
        flows(&distorted, field, settings, [0.3, 4.0], 0.0);
    }
    flows(&even, field, settings(Scheme::WeymouthYue), [0.25, 4.0], 0.01);
    for settings in [cartesian(), settings(Scheme::Isotropic)] {
        flows(&distorted, field, settings, [0.3, 4.0], 0.1);
    }
}

proptest! {
    #![proptest_config(fixed(12, 20_261_126))]

    #[test]
    fn quantities_are_carried_through_open_ends(
        seed in 0_u64..1000,
        amplitude in 0.0_f64..0.3,
        direction in 0.0_f64..std::f64::consts::TAU,
        inflow in prop::option::of(0_usize..2),
    ) {
        let mesh: Mesh2 = unit_mesh(12, random(amplitude, seed));
        let velocity = Vector::<3>::new(direction.cos(), direction.sin(), 0.0);
        for scheme in [Scheme::Sweeps, Scheme::Unsplit] {
            let settings = Settings { inflow, ..settings(scheme) };
            flows(&mesh, steady(Field::Uniform { velocity }), settings, [0.4, 12.0], 0.0);
        }
    }
}

#[test]
fn meshes_move_under_quantities_at_rest() {
    let from: Mesh2 = unit_mesh(16, random(0.2, 1));
    let moved = |amplitude: f64| -> Mesh2 {
        let nodes = from.nodes().iter().map(|x| {
            let bump = amplitude * (3.0 * x[0]).sin() * x[0] * (1.0 - x[0]) * x[1] * (1.0 - x[1]);
            x + Vector::<2>::new(bump, -bump)
        });
        Mesh::from_nodes(from.grid().clone(), nodes.collect()).expect("valid cells")
    };
    let cases = [
        (settings(Scheme::Sweeps), 0.2, 0.0),
        (settings(Scheme::Unsplit), 0.2, 0.0),
        (settings(Scheme::Remap), 2.0, 0.0),
        (cartesian(), 0.2, 0.01),
        (settings(Scheme::Isotropic), 0.2, 0.01),
    ];
    for (settings, amplitude, lost) in cases {
        let (to, before) = (moved(amplitude), state(&from));
        let mut after = before.clone();
        let State { fractions, quantities } = &mut after;
        let mut remesh = Remesh::new(settings).expect("a scheme for moving meshes");
        let ledger = remesh.step_carrying(&from, &to, fractions, quantities, 0).expect("a small move");
        assert_bounded(&after);
        assert_conserved([&from, &to], &before, &after, &ledger, lost);
        assert_ne!(before.quantities, after.quantities);
    }
}

#[test]
fn another_mesh_gets_all_of_the_quantities() {
    let from: Mesh3 = unit_mesh(6, random(0.25, 2));
    let to: Mesh3 = unit_mesh(7, random(0.25, 3));
    let before = state(&from);
    let (after, ledger) = remap(&from, &to, &before, Reconstruction::default()).expect("valid meshes");
    assert_bounded(&after);
    assert_conserved([&from, &to], &before, &after, &ledger, 0.0);
}

#[test]
fn remapping_keeps_linear_values_where_nothing_limits_them() {
    let linear = |x: Vector<2>| 1.0 + 0.5 * x[0] - 0.25 * x[1];
    // Means over cells are values at centroids: those of parallelograms are in their middles.
    let from = Mesh2::unit([12; 2], &Distortion::None).expect("valid");
    let to = Mesh2::unit([17; 2], &Distortion::None).expect("valid");
    let whole = State {
        fractions: vec![vec![1.0; from.grid().len()]],
        quantities: vec![MaterialQuantity::new(0, vec![at_middles(&from, linear)])],
    };
    let (after, _) = remap(&from, &to, &whole, Reconstruction::default()).expect("valid meshes");
    let exact = at_middles(&to, linear);
    for (cell, value) in after.quantities[0].values[0].iter().enumerate() {
        let at = to.grid().offset(cell);
        // At corners and ends the limiter acts.
        if at.iter().all(|at| (2..15).contains(at)) {
            assert!((value - exact[cell]).abs() <= 1e-13, "{at:?}: {value}");
        }
    }
}

/// The error of a wave in a material that fills a periodic box, after once around along a diagonal.
fn wave_error(cells: usize, scheme: Scheme, distribution: Distribution) -> f64 {
    let grid = vofkit::mesh::Grid::new([cells; 2], [true; 2]);
    let mesh: Mesh2 =
        Mesh::new(grid, Vector::zeros(), Vector::repeat(1.0), &Distortion::None).expect("a valid mesh");
    let wave = |x: Vector<2>| 2.0 + (std::f64::consts::TAU * (x[0] + x[1])).sin();
    let start = at_middles(&mesh, wave);
    let mut quantities =
        vec![MaterialQuantity { distribution, ..MaterialQuantity::new(0, vec![start.clone()]) }];
    let mut fractions = vec![vec![1.0; mesh.grid().len()]];
    let field = Field::Uniform { velocity: Vector::<3>::new(1.0, 1.0, 0.0) };
    let mut transport = Transport::new(&mesh, steady(field), settings(scheme)).expect("a valid setup");
    let steps = 2 * cells;
    for step in 0..steps {
        let [from, to] = [step, step + 1].map(|step| step as f64 / steps as f64);
        transport.step_carrying(&mut fractions, &mut quantities, step, from, to).expect("half a cell");
    }
    let differences = quantities[0].values[0].iter().zip(&start).map(|(a, b)| (a - b).abs());
    differences.sum::<f64>() / mesh.grid().len() as f64
}

#[test]
fn limited_slopes_lose_far_less_of_a_wave_than_constants() {
    for scheme in [Scheme::Sweeps, Scheme::Unsplit] {
        let errors = |distribution: Distribution| [24, 48].map(|n| wave_error(n, scheme, distribution));
        let [constant, linear] = [Distribution::Constant, Distribution::Linear].map(errors);
        let order = |[coarse, fine]: [f64; 2]| (coarse / fine).log2();
        assert!((0.6..1.1).contains(&order(constant)), "{scheme}: {constant:?}");
        assert!(order(linear) >= order(constant) + 0.2, "{scheme}: {linear:?}");
        assert!(linear[1] <= 0.3 * constant[1], "{scheme}: {linear:?} against {constant:?}");
    }
}

#[test]
fn a_cell_that_empties_gives_all_and_keeps_nothing_odd() {
    // The strip leaves the cells behind it to a remainder of rounding.
    let mesh: Mesh2 = unit_mesh(10, Distortion::None);
    let strip = Shape::Box {
        centre: [0.3, 0.5].into(),
        lengths: [0.3, 2.0].into(),
        rotation: vofkit::shape::Rotation::identity(),
    };
    let before = State {
        fractions: volume_fractions(&mesh, &[strip]),
        quantities: vec![MaterialQuantity::new(0, vec![varied(&mesh)])],
    };
    for scheme in [Scheme::Sweeps, Scheme::Isotropic, Scheme::WeymouthYue, Scheme::Unsplit] {
        let mut after = before.clone();
        let field = Field::Uniform { velocity: Vector::<3>::new(1.0, 0.0, 0.0) };
        let mut transport = Transport::new(&mesh, steady(field), settings(scheme)).expect("open ends");
        let mut ledger = Ledger::new(1);
        for step in 0..15 {
            let State { fractions, quantities } = &mut after;
            let [start, end] = [step, step + 1].map(|step| step as f64 / 30.0);
            ledger.add(
                &transport.step_carrying(fractions, quantities, step, start, end).expect("a third of a cell"),
            );
            assert_bounded(&after);
        }
        assert_conserved([&mesh, &mesh], &before, &after, &ledger, 0.0);
    }
}

#[test]
fn effective_values_are_those_of_the_materials_by_their_fractions() {
    let mesh: Mesh2 = unit_mesh(12, random(0.2, 4));
    let mut state = state(&mesh);
    state.quantities = [4.0, 1.0]
        .iter()
        .enumerate()
        .map(|(material, value)| MaterialQuantity::new(material, vec![vec![*value; 144]]))
        .collect();
    let mixture = effective(&state.fractions, &state.quantities, &[0, 1], 0);
    for (cell, value) in mixture.iter().enumerate() {
        let [a, b] = [0, 1].map(|k: usize| state.fractions[k][cell]);
        assert!((value - (4.0 * a + b)).abs() <= 1e-15 * 4.0);
    }
}

#[cfg(feature = "parallel")]
#[test]
fn the_same_bits_for_any_number_of_threads() {
    let mesh: Mesh2 = unit_mesh(24, random(0.2, 6));
    let carried = |threads: usize, scheme: Scheme| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let State { mut fractions, mut quantities } = state(&mesh);
            let mut transport =
                Transport::new(&mesh, steady(Field::ReversedVortex), settings(scheme)).expect("walls");
            let dt = 0.4 / transport.courant_rate();
            for step in 0..3 {
                let [start, end] = [step, step + 1].map(|step| step as f64 * dt);
                transport.step_carrying(&mut fractions, &mut quantities, step, start, end).expect("small");
            }
            quantities
        })
    };
    for scheme in [Scheme::Sweeps, Scheme::Unsplit] {
        assert_eq!(carried(1, scheme), carried(3, scheme));
    }
}

#[test]
fn a_step_that_fails_leaves_the_quantities_as_they_were() {
    let mesh: Mesh2 = unit_mesh(12, Distortion::None);
    let before = state(&mesh);
    for scheme in [Scheme::Sweeps, Scheme::Unsplit] {
        let State { mut fractions, mut quantities } = before.clone();
        let mut transport =
            Transport::new(&mesh, steady(Field::ReversedVortex), settings(scheme)).expect("walls");
        let end = 6.0 / transport.courant_rate();
        let error = transport.step_carrying(&mut fractions, &mut quantities, 0, 0.0, end);
        error.expect_err("six cells in a step");
        assert_eq!((fractions, quantities), (before.fractions.clone(), before.quantities.clone()));
    }
}

#[test]
fn quantities_that_are_none_are_errors_that_say_where() {
    let mesh: Mesh2 = unit_mesh(4, Distortion::None);
    let wrong = |change: &dyn Fn(&mut State)| {
        let mut state = State {
            fractions: vec![vec![0.5; 16]],
            quantities: vec![
                MaterialQuantity::new(0, vec![vec![1.0; 16]]),
                MaterialQuantity::new(0, vec![vec![1.0; 16]; 2]).by_mass(0),
            ],
        };
        change(&mut state);
        state.check(mesh.grid(), None).expect_err("a state that is none")
    };
    let error = wrong(&|state| state.quantities[1].values[1][6] = f64::NAN);
    let is_at = |cell: &[usize]| cell == [2, 1];
    assert!(
        matches!(&error, QuantityError::Value { quantity: 1, component: 1, cell, .. } if is_at(cell)),
        "{error}"
    );
    let error = wrong(&|state| state.quantities[0].values[0][6] = -1.0);
    assert!(matches!(&error, QuantityError::NotPositive { density: 0, cell, .. } if is_at(cell)), "{error}");
    let error = wrong(&|state| state.quantities[0].material = 3);
    assert_eq!(error, QuantityError::Material { quantity: 0, material: 3, materials: 1 });
    let error = wrong(&|state| state.quantities[1].values[0].truncate(3));
    assert_eq!(error, QuantityError::Length { quantity: 1, component: 0, given: 3, cells: 16 });
    let error = wrong(&|state| state.quantities[1].weighting = Weighting::Mass(1));
    assert_eq!(error, QuantityError::Density { quantity: 1, density: 1 });
    let error = wrong(&|state| state.quantities[1].inflow = Some(vec![1.0]));
    assert_eq!(error, QuantityError::Inflow { quantity: 1, material: 0, components: 2 });
    let error = wrong(&|state| state.fractions[0][0] = 2.0);
    assert!(matches!(error, QuantityError::Fractions(_)), "{error}");

    let State { mut fractions, mut quantities } = state(&mesh);
    quantities[3].inflow = None;
    let field = Field::Uniform { velocity: Vector::<3>::new(1.0, 0.0, 0.0) };
    let settings = Settings { inflow: Some(1), ..Settings::default() };
    let mut transport = Transport::new(&mesh, steady(field), settings).expect("open ends");
    let error = transport.step_carrying(&mut fractions, &mut quantities, 0, 0.0, 0.1).expect_err("no inflow");
    let missing = QuantityError::Inflow { quantity: 3, material: 1, components: 1 };
    assert_eq!(error, StepError::Quantity(missing));
}

#[test]
fn arrays_that_make_up_no_step_are_errors_that_say_where() {
    let nodes: Vec<[f64; 2]> = (0..25).map(|k| [f64::from(k % 5), f64::from(k / 5)]).collect();
    let state = State::of_fractions(vec![vec![0.5; 16]]);
    let method = Reconstruction::default();
    let remapped =
        |new: &[[f64; 2]]| ale::remap::<Quad, 2>([4, 4], &nodes, new, &state, method).expect_err("no mesh");
    let short = AleError::Length { what: "new nodes", given: 24, wanted: 25 };
    assert_eq!(remapped(&nodes[..24]), short);
    let mut odd = nodes.clone();
    odd[7][1] = f64::NAN;
    assert!(matches!(remapped(&odd), AleError::NotFinite { what: "new nodes", index: 7, .. }));
    odd[7] = [2.0, -9.0];
    assert!(matches!(remapped(&odd), AleError::Mesh(MeshError::BadCells { .. })));

    let mesh: Mesh2 = unit_mesh(4, Distortion::None);
    let (fluxes, still) = (vec![0.0; 20], vec![[0.0; 2]; 25]);
    let advanced = |x: &[f64], moves: &[[f64; 2]]| {
        ale::advance(&mesh, &[x, &fluxes], moves, &state, method).expect_err("no step")
    };
    let short = AleError::Length { what: "face fluxes", given: 19, wanted: 20 };
    assert_eq!(advanced(&fluxes[..19], &still), short);
    let short = AleError::Length { what: "displacements", given: 3, wanted: 25 };
    assert_eq!(advanced(&fluxes, &still[..3]), short);
    let mut one = fluxes.clone();
    one[6] = 0.01;
    // Face 6 across x is between the cells (0, 1) and (1, 1).
    assert!(matches!(advanced(&one, &still), AleError::Unbalanced { cell, .. } if cell == [0, 1]));
    one[6] = f64::INFINITY;
    assert!(matches!(advanced(&one, &still), AleError::NotFinite { what: "face fluxes", index: 6, .. }));
    let bad = State::of_fractions(vec![vec![2.0; 16]]);
    ale::advance(&mesh, &[&fluxes, &fluxes], &still, &bad, method).expect_err("no fractions");
}

#[test]
fn given_fluxes_and_displacements_do_what_a_uniform_flow_does() {
    let mesh: Mesh3 = unit_mesh(6, Distortion::None);
    let before = state(&mesh);
    let velocity = Vector::<3>::new(0.5, -0.25, 0.75);
    let dt = 0.1;
    let face = 1.0 / 36.0;
    let fluxes: Vec<Vec<f64>> = velocity.iter().map(|u| vec![u * dt * face; 7 * 36]).collect();
    let displacements = vec![[0.05, -0.025, 0.075]; 343];
    let arrays = [&fluxes[0][..], &fluxes[1], &fluxes[2]];
    let given = ale::advance(&mesh, &arrays, &displacements, &before, Reconstruction::default());
    let (given, ledger) = given.expect("a small step");
    let mut after = before.clone();
    let mut transport =
        Transport::new(&mesh, steady(Field::Uniform { velocity }), settings(Scheme::Unsplit)).expect("open");
    let State { fractions, quantities } = &mut after;
    let of_flow = transport.step_carrying(fractions, quantities, 0, 0.0, dt).expect("a small step");
    for (a, b) in given.fractions.iter().flatten().zip(after.fractions.iter().flatten()) {
        assert!((a - b).abs() <= 1e-13, "{a} and {b}");
    }
    for (a, b) in ledger.quantities.iter().zip(&of_flow.quantities) {
        assert!((a.outflow - b.outflow).abs() <= 1e-13, "{a:?} and {b:?}");
    }
    assert_bounded(&given);
}
