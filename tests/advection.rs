//! Transport by sweeps: conservation, bounds, constancy, and what is an error.

mod common;

use common::{Mesh2, Mesh3, drift, fixed, random, run, steady, transport, unit_mesh};
use proptest::prelude::*;
use vofkit::advection::{End, Settings, SetupError, StepError, SweepAxes, Transport};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, HalfSpace, Vector};
use vofkit::interface::ReconstructionError;
use vofkit::mesh::{Distortion, Grid, Mesh, MeshError};
use vofkit::metrics::{material_volume, shape_error};
use vofkit::shape::Shape;
use vofkit::velocity::{Field, Velocity};

fn uniform(velocity: [f64; 3]) -> Velocity {
    steady(Field::Uniform { velocity: Vector::<3>::from(velocity) })
}

fn disc(centre: [f64; 2], radius: f64) -> Shape<2> {
    Shape::Sphere { centre: centre.into(), radius }
}

fn conserves<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocity: Velocity,
    shapes: &[Shape<D>],
    courant: f64,
    steps: usize,
) {
    let mut transport = transport(mesh, velocity, SweepAxes::Logical);
    let start = volume_fractions(mesh, shapes);
    let mut fractions = start.clone();
    let end = steps as f64 * courant / transport.courant_rate();
    let ledger = run(&mut transport, &mut fractions, steps, end).expect("steps within the limit");
    for (material, account) in ledger.materials.iter().enumerate() {
        let drift = drift(mesh, &start[material], &fractions[material], account.outflow);
        assert!(drift.abs() <= 1e-12, "drift {drift:e}");
        assert!(account.smallest >= -1e-12 && account.largest <= 1.0 + 1e-12, "{account:?}");
    }
}

proptest! {
    #![proptest_config(fixed(24, 20_261_122))]

    #[test]
    fn sweeps_along_mesh_lines_conserve_and_stay_bounded_2d(
        seed in 0_u64..1000,
        amplitude in 0.0_f64..0.35,
        courant in 0.1_f64..0.6,
        x in 0.2_f64..0.8,
        y in 0.2_f64..0.8,
        radius in 0.05_f64..0.3,
        which in 0_usize..4,
    ) {
        let mesh: Mesh2 = unit_mesh(16, random(amplitude, seed));
        let centre = Vector::<3>::new(0.5, 0.5, 0.0);
        let velocity = [
            steady(Field::ReversedVortex),
            uniform([0.7, -0.4, 0.0]),
            steady(Field::Rotation { centre, angular_velocity: Vector::<3>::new(0.0, 0.0, 1.0) }),
            steady(Field::Eq101),
        ][which];
        conserves(&mesh, velocity, &[disc([x, y], radius)], courant, 12);
    }

    #[test]
    fn sweeps_along_mesh_lines_conserve_and_stay_bounded_3d(
        seed in 0_u64..1000,
        amplitude in 0.0_f64..0.25,
        courant in 0.1_f64..0.5,
        centre in prop::array::uniform3(0.25_f64..0.75),
        radius in 0.1_f64..0.3,
    ) {
        let mesh: Mesh3 = unit_mesh(8, random(amplitude, seed));
        let shape = Shape::Sphere { centre: centre.into(), radius };
        conserves(&mesh, steady(Field::Deformation3d), &[shape], courant, 6);
    }
}

#[test]
fn a_full_domain_stays_full_to_the_bit() {
    let mesh: Mesh2 = unit_mesh(12, random(0.3, 2));
    for axes in [SweepAxes::Logical, SweepAxes::Cartesian] {
        let mut transport = transport(&mesh, steady(Field::ReversedVortex), axes);
        let mut fractions = vec![vec![1.0; 144], vec![0.0; 144]];
        let end = 2.5 / transport.courant_rate();
        run(&mut transport, &mut fractions, 5, end).expect("no interface, no error");
        assert!(fractions[0].iter().all(|&f| f == 1.0) && fractions[1].iter().all(|&f| f == 0.0));
    }
}

#[test]
fn without_velocity_nothing_changes() {
    let mesh: Mesh2 = unit_mesh(12, random(0.3, 2));
    let start = volume_fractions(&mesh, &[disc([0.4, 0.5], 0.2)]);
    let mut fractions = start.clone();
    let mut transport = transport(&mesh, uniform([0.0; 3]), SweepAxes::Logical);
    run(&mut transport, &mut fractions, 10, 1.0).expect("nothing moves");
    assert_eq!(fractions, start);
}

#[test]
fn sweep_axes_agree_on_undistorted_meshes() {
    let mesh: Mesh2 = unit_mesh(20, Distortion::None);
    let start = volume_fractions(&mesh, &[disc([0.5, 0.75], 0.15)]);
    let results = [SweepAxes::Logical, SweepAxes::Cartesian].map(|axes| {
        let mut fractions = start.clone();
        let mut transport = transport(&mesh, steady(Field::ReversedVortex), axes);
        let end = 10.0 / transport.courant_rate();
        run(&mut transport, &mut fractions, 20, end).expect("steps within the limit");
        fractions
    });
    assert_eq!(results[0], results[1]);
}

#[test]
fn cartesian_sweeps_on_a_distorted_mesh_enter_their_corrections() {
    let mesh: Mesh2 = unit_mesh(32, random(0.2, 1));
    let start = volume_fractions(&mesh, &[disc([0.3, 0.3], 0.15)]);
    let mut fractions = start.clone();
    let mut transport = transport(&mesh, uniform([1.0, 1.0, 0.0]), SweepAxes::Cartesian);
    let steps = (0.4 * transport.courant_rate() / 0.5).ceil() as usize;
    let ledger = run(&mut transport, &mut fractions, steps, 0.4).expect("steps within the limit");
    let account = ledger.materials[0];
    let change = drift(&mesh, &start[0], &fractions[0], account.outflow) * material_volume(&mesh, &start[0]);
    assert!(change.abs() <= account.clipped + 1e-14, "{change:e} is not in the ledger: {account:?}");
    let exact = volume_fractions(&mesh, &[disc([0.7, 0.7], 0.15)]);
    let error = shape_error(&mesh, &fractions[0], &exact[0]) / material_volume(&mesh, &start[0]);
    assert!(error <= 0.1, "{error}");
}

#[test]
fn what_leaves_is_counted() {
    let mesh: Mesh2 = unit_mesh(20, random(0.2, 7));
    let start = volume_fractions(&mesh, &[disc([0.8, 0.5], 0.15)]);
    let mut fractions = start.clone();
    let mut transport = transport(&mesh, uniform([1.0, 0.0, 0.0]), SweepAxes::Logical);
    assert_eq!(transport.boundary().ends, [[End::Outflow; 2], [End::Wall; 2]]);
    let steps = (0.5 * transport.courant_rate() / 0.5).ceil() as usize;
    let ledger = run(&mut transport, &mut fractions, steps, 0.5).expect("steps within the limit");
    let outflow = ledger.materials[0].outflow;
    let drift = drift(&mesh, &start[0], &fractions[0], outflow);
    assert!(drift.abs() <= 1e-12, "{drift:e}");
    assert!((outflow / material_volume(&mesh, &start[0]) - 1.0).abs() <= 1e-12);
}

#[test]
fn a_named_material_flows_in() {
    let mesh: Mesh2 = unit_mesh(10, Distortion::None);
    let velocity = uniform([1.0, 0.0, 0.0]);
    let settings = Settings { inflow: Some(0), ..Settings::default() };
    let mut transport = Transport::new(&mesh, velocity, settings).expect("no walls asked for");
    let mut fractions = vec![vec![0.0; 100]];
    let ledger = run(&mut transport, &mut fractions, 10, 0.45).expect("steps within the limit");
    assert!((material_volume(&mesh, &fractions[0]) - 0.45).abs() <= 1e-13);
    assert!((ledger.materials[0].outflow + 0.45).abs() <= 1e-13);
}

#[test]
fn one_period_around_a_periodic_box() {
    let grid = Grid::new([24, 24], [true, true]);
    for distortion in [Distortion::None, random(0.2, 4)] {
        let mesh: Mesh2 =
            Mesh::new(grid.clone(), Vector::zeros(), Vector::repeat(1.0), &distortion).expect("valid");
        let start = volume_fractions(&mesh, &[disc([0.5, 0.5], 0.25)]);
        let mut fractions = start.clone();
        let mut transport = transport(&mesh, uniform([1.0, 1.0, 0.0]), SweepAxes::Logical);
        let steps = (transport.courant_rate() / 0.5).ceil() as usize;
        let ledger = run(&mut transport, &mut fractions, steps, 1.0).expect("steps within the limit");
        let volume = material_volume(&mesh, &start[0]);
        assert!(drift(&mesh, &start[0], &fractions[0], 0.0).abs() <= 1e-12);
        assert!(ledger.materials[0].outflow == 0.0);
        assert!(shape_error(&mesh, &fractions[0], &start[0]) <= 0.05 * volume);
    }
}

#[test]
fn several_materials_fill_a_cell_at_most() {
    let mesh: Mesh2 = unit_mesh(24, random(0.2, 9));
    let shapes = [disc([0.4, 0.5], 0.15), disc([0.65, 0.5], 0.15), disc([0.5, 0.7], 0.1)];
    conserves(&mesh, steady(Field::ReversedVortex), &shapes, 0.5, 30);
    let mut fractions = volume_fractions(&mesh, &shapes);
    let mut transport = transport(&mesh, steady(Field::ReversedVortex), SweepAxes::Logical);
    let end = 15.0 / transport.courant_rate();
    run(&mut transport, &mut fractions, 30, end).expect("steps within the limit");
    for cell in 0..mesh.grid().len() {
        let sum: f64 = fractions.iter().map(|f| f[cell]).sum();
        assert!(sum <= 1.0 + 1e-13, "{sum}");
    }
}

#[test]
fn materials_that_fill_the_domain_keep_it_full() {
    // Their planes are found one by one and do not match: what leaves is shared so that no void comes up between them.
    let ball = Shape::Sphere { centre: [0.5, 0.6].into(), radius: 0.25 };
    let left = Shape::HalfSpace(HalfSpace { normal: Vector::<2>::new(1.0, 0.0), constant: 0.5 });
    let all = Shape::HalfSpace(HalfSpace { normal: Vector::<2>::new(0.0, 1.0), constant: 2.0 });
    let shapes = [Shape::Intersection(vec![ball.clone(), left]), ball, all];
    for distortion in [Distortion::None, random(0.25, 8)] {
        let mesh: Mesh2 = unit_mesh(24, distortion);
        conserves(&mesh, steady(Field::ReversedVortex), &shapes, 0.5, 60);
        let mut fractions = volume_fractions(&mesh, &shapes);
        let mut transport = transport(&mesh, steady(Field::ReversedVortex), SweepAxes::Logical);
        let end = 30.0 / transport.courant_rate();
        let ledger = run(&mut transport, &mut fractions, 60, end).expect("steps within the limit");
        assert!(ledger.materials.iter().all(|account| account.rescaled <= 1e-13));
        for cell in 0..mesh.grid().len() {
            let sum: f64 = fractions.iter().map(|f| f[cell]).sum();
            assert!((sum - 1.0).abs() <= 1e-11, "{sum}");
        }
    }
}

#[test]
fn overdraft_goes_on_with_finite_fractions_between_the_bounds() {
    let mesh: Mesh2 = unit_mesh(32, random(0.2, 0));
    for axes in [SweepAxes::Logical, SweepAxes::Cartesian] {
        let settings = Settings { axes, overdraft: true, ..Settings::default() };
        let mut transport =
            Transport::new(&mesh, steady(Field::ReversedVortex), settings).expect("walls are closed");
        let mut fractions = volume_fractions(&mesh, &[disc([0.5, 0.75], 0.15), disc([0.3, 0.3], 0.1)]);
        let end = 160.0 / transport.courant_rate();
        run(&mut transport, &mut fractions, 40, end).expect("overdraft is allowed");
        let bad = fractions.iter().flatten().filter(|f| !(0.0..=1.0).contains(*f)).count();
        assert_eq!(bad, 0, "{axes:?}");
    }
}

#[test]
fn velocities_and_meshes_out_of_range_are_refused() {
    let mesh: Mesh2 = unit_mesh(4, Distortion::None);
    for speed in [1e300, 1e-300, f64::INFINITY, f64::NAN] {
        let error = Transport::new(&mesh, uniform([speed, 0.0, 0.0]), Settings::default()).map(|_| ());
        assert!(matches!(error, Err(SetupError::Fluxes(_))), "{speed}: {error:?}");
    }
    let grid = Grid::new([4, 4], [false; 2]);
    for size in [1e-150, 1e150] {
        let mesh = Mesh2::new(grid.clone(), Vector::zeros(), Vector::repeat(size), &Distortion::None);
        assert!(matches!(mesh, Err(MeshError::Range { .. })), "{size}");
    }
    let nodes = vec![Vector::zeros(); 24];
    assert!(matches!(
        Mesh2::from_nodes(grid, nodes),
        Err(MeshError::NodeCount { wanted: 25, given: 24, .. })
    ));
}

#[test]
fn a_mesh_on_given_nodes_moves_materials_like_any_other() {
    let made: Mesh2 = unit_mesh(16, random(0.2, 3));
    let given = Mesh2::from_nodes(made.grid().clone(), made.nodes().to_vec()).expect("valid nodes");
    let results = [&made, &given].map(|mesh| {
        let mut fractions = volume_fractions(mesh, &[disc([0.5, 0.7], 0.2)]);
        let mut transport = transport(mesh, steady(Field::ReversedVortex), SweepAxes::Logical);
        let end = 4.0 / transport.courant_rate();
        run(&mut transport, &mut fractions, 8, end).expect("steps within the limit");
        fractions
    });
    assert_eq!(results[0], results[1]);
}

#[test]
fn a_step_that_is_too_large_names_the_cell_and_changes_nothing() {
    let mesh: Mesh2 = unit_mesh(16, Distortion::None);
    let start = volume_fractions(&mesh, &[disc([0.5, 0.75], 0.15)]);
    let mut fractions = start.clone();
    let mut transport = transport(&mesh, steady(Field::ReversedVortex), SweepAxes::Logical);
    let end = 3.0 / transport.courant_rate();
    let error = transport.step(&mut fractions, 0, 0.0, end).expect_err("three times the limit");
    let StepError::Overdrawn { cell, volume, outflow } = error else { panic!("{error}") };
    assert!(cell.len() == 2 && outflow > volume);
    assert_eq!(fractions, start);
}

#[test]
fn a_fraction_that_is_none_names_the_cell_and_changes_nothing() {
    let mesh: Mesh2 = unit_mesh(8, Distortion::None);
    let mut transport = transport(&mesh, steady(Field::ReversedVortex), SweepAxes::Logical);
    let end = 0.5 / transport.courant_rate();
    for bad in [f64::NAN, f64::NEG_INFINITY, -1e-3, 2.0] {
        let mut fractions = volume_fractions(&mesh, &[disc([0.5, 0.6], 0.2)]);
        fractions[0][19] = bad;
        let start = fractions.clone();
        let error = transport.step(&mut fractions, 0, 0.0, end).expect_err("not a fraction");
        assert!(
            matches!(&error, StepError::Reconstruction(ReconstructionError::Cell { cell, .. }) if cell == &[3, 2]),
            "{error}"
        );
        assert!(fractions[0].iter().zip(&start[0]).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
    let short = transport.step(&mut [vec![0.5; 63]], 0, 0.0, end).expect_err("too few fractions");
    assert_eq!(short, StepError::Reconstruction(ReconstructionError::Length { given: 63, cells: 64 }));
}

#[test]
fn a_wall_that_is_crossed_is_refused() {
    let mesh: Mesh2 = unit_mesh(8, Distortion::None);
    let mut settings = Settings::default();
    settings.ends[0][1] = Some(End::Wall);
    let error = Transport::new(&mesh, uniform([1.0, 0.0, 0.0]), settings).expect_err("the flow crosses it");
    let SetupError::Wall(crossed) = error else { panic!("{error}") };
    assert_eq!((crossed.axis, crossed.side), (0, 1));
    assert!((crossed.rate - 0.125).abs() <= 1e-12);
}

#[test]
fn work_follows_the_interface() {
    // Twice the cells along each axis: twice the cells of the band in 2D, four times the cells of the mesh.
    let visited = [64, 128].map(|n| {
        let mesh: Mesh2 = unit_mesh(n, Distortion::None);
        let mut fractions = volume_fractions(&mesh, &[disc([0.5, 0.75], 0.15)]);
        let mut transport = transport(&mesh, steady(Field::ReversedVortex), SweepAxes::Logical);
        let end = 1.0 / transport.courant_rate();
        let ledger = run(&mut transport, &mut fractions, 2, end).expect("steps within the limit");
        ledger.cells_visited as f64 / ledger.sweeps as f64
    });
    assert!(visited[1] / visited[0] <= 2.2, "{visited:?}");
}
