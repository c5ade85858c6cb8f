//! Unsplit advection: conservation and bounds without corrections, constancy, and the overlap cases of the paper.

mod common;

use common::{Mesh2, Mesh3, fixed, random, unit_mesh};
use proptest::prelude::*;
use vofkit::advection::{End, Ledger, Scheme, Settings, StepError, SweepAxes, Transport};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, HalfSpace, Vector};
use vofkit::interface::Reconstruction;
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::metrics::{material_volume, shape_error};
use vofkit::normal::NormalMethod;
use vofkit::shape::Shape;
use vofkit::velocity::{Field, Reversal, Velocity};

fn steady(field: Field) -> Velocity {
    Velocity { field, reversal: Reversal::None }
}

fn uniform(velocity: [f64; 3]) -> Velocity {
    steady(Field::Uniform { velocity: Vector::<3>::from(velocity) })
}

fn ball<const D: usize>(centre: [f64; D], radius: f64) -> Shape<D> {
    Shape::Sphere { centre: centre.into(), radius }
}

fn unsplit<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, velocity: Velocity) -> Transport<'_, C, D> {
    let settings = Settings { scheme: Scheme::Unsplit, ..Settings::default() };
    Transport::new(mesh, velocity, settings).expect("no walls asked for")
}

/// Steps of a Courant number.
fn run<C: Cell<D>, const D: usize>(
    transport: &mut Transport<'_, C, D>,
    fractions: &mut [Vec<f64>],
    courant: f64,
    steps: usize,
) -> Result<Ledger, StepError> {
    let mut ledger = Ledger::new(fractions.len());
    let dt = courant / transport.courant_rate();
    for step in 0..steps {
        ledger.add(&transport.step(fractions, step, step as f64 * dt, (step + 1) as f64 * dt)?);
    }
    Ok(ledger)
}

fn conserves<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocity: Velocity,
    shapes: &[Shape<D>],
    courant: f64,
    steps: usize,
) {
    let start = volume_fractions(mesh, shapes);
    let mut fractions = start.clone();
    let mut transport = unsplit(mesh, velocity);
    let ledger = run(&mut transport, &mut fractions, courant, steps).expect("no fold");
    for (k, account) in ledger.materials.iter().enumerate() {
        let before = material_volume(mesh, &start[k]);
        let drift = (material_volume(mesh, &fractions[k]) - before + account.outflow) / before;
        assert!(drift.abs() <= 1e-12, "drift {drift:e}");
        assert!(account.smallest >= -1e-12 && account.largest <= 1.0 + 1e-12, "{account:?}");
        assert!(account.clipped <= 1e-12 * before && account.rescaled == 0.0, "{account:?}");
    }
}

proptest! {
    #![proptest_config(fixed(24, 20_261_124))]

    #[test]
    fn conserves_and_stays_bounded_without_correction_2d(
        seed in 0_u64..1000,
        amplitude in 0.0_f64..0.3,
        courant in 0.1_f64..1.0,
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
        conserves(&mesh, velocity, &[ball([x, y], radius)], courant, 12);
    }

    #[test]
    fn conserves_and_stays_bounded_without_correction_3d(
        seed in 0_u64..1000,
        amplitude in 0.0_f64..0.25,
        courant in 0.1_f64..1.0,
        centre in prop::array::uniform3(0.25_f64..0.75),
        radius in 0.1_f64..0.3,
        which in 0_usize..3,
    ) {
        let mesh: Mesh3 = unit_mesh(8, if amplitude < 0.05 { Distortion::None } else { random(amplitude, seed) });
        let axis = Vector::<3>::new(0.3, -0.5, 1.0);
        let velocity = [
            steady(Field::Deformation3d),
            uniform([0.7, -0.4, 0.5]),
            steady(Field::Rotation { centre: Vector::<3>::repeat(0.5), angular_velocity: axis }),
        ][which];
        conserves(&mesh, velocity, &[ball(centre, radius)], courant, 4);
    }
}

#[test]
fn there_and_back() {
    let mesh: Mesh2 = unit_mesh(32, random(0.2, 3));
    let start = volume_fractions(&mesh, &[ball([0.5, 0.75], 0.15)]);
    let mut fractions = start.clone();
    let mut transport = unsplit(&mesh, steady(Field::ReversedVortex));
    let dt = 0.7 / transport.courant_rate();
    let time = |step: usize| if step <= 20 { step as f64 * dt } else { (40 - step) as f64 * dt };
    for step in 0..40 {
        transport.step(&mut fractions, step, time(step), time(step + 1)).expect("no fold");
    }
    let error = shape_error(&mesh, &fractions[0], &start[0]) / material_volume(&mesh, &start[0]);
    assert!(error <= 0.08, "{error}");
}

#[test]
fn a_full_domain_stays_full_to_the_bit() {
    let mesh: Mesh2 = unit_mesh(12, random(0.3, 2));
    let mut fractions = vec![vec![1.0; 144], vec![0.0; 144]];
    run(&mut unsplit(&mesh, steady(Field::ReversedVortex)), &mut fractions, 0.5, 5).expect("no interface");
    assert!(fractions[0].iter().all(|&f| f == 1.0) && fractions[1].iter().all(|&f| f == 0.0));
}

#[test]
fn materials_that_fill_the_domain_keep_it_full() {
    let side = Shape::HalfSpace(HalfSpace { normal: Vector::<2>::new(1.0, 0.0), constant: 0.5 });
    let all = Shape::HalfSpace(HalfSpace { normal: Vector::<2>::new(0.0, 1.0), constant: 2.0 });
    let disc = ball([0.5, 0.6], 0.25);
    let shapes = [Shape::Intersection(vec![disc.clone(), side]), disc, all];
    for distortion in [Distortion::None, random(0.25, 8)] {
        let mesh: Mesh2 = unit_mesh(24, distortion);
        conserves(&mesh, steady(Field::ReversedVortex), &shapes, 0.8, 30);
        let mut fractions = volume_fractions(&mesh, &shapes);
        run(&mut unsplit(&mesh, steady(Field::ReversedVortex)), &mut fractions, 0.8, 30).expect("no fold");
        for cell in 0..mesh.grid().len() {
            let sum: f64 = fractions.iter().map(|f| f[cell]).sum();
            assert!((sum - 1.0).abs() <= 1e-12, "{sum}");
        }
    }
}

#[test]
fn several_materials_in_3d_fill_a_cell_at_most() {
    let mesh: Mesh3 = unit_mesh(10, random(0.2, 5));
    let shapes = [ball([0.35; 3], 0.2), ball([0.6, 0.35, 0.35], 0.15), ball([0.45, 0.6, 0.4], 0.15)];
    conserves(&mesh, steady(Field::Deformation3d), &shapes, 0.7, 8);
    let mut fractions = volume_fractions(&mesh, &shapes);
    run(&mut unsplit(&mesh, steady(Field::Deformation3d)), &mut fractions, 0.7, 8).expect("no fold");
    for cell in 0..mesh.grid().len() {
        let sum: f64 = fractions.iter().map(|f| f[cell]).sum();
        assert!(sum <= 1.0 + 1e-12, "{sum}");
    }
}

/// A mesh of parallelograms in the unit square and beyond: neighbours in a row are shifted against each other from row to row.
fn sheared(cells: usize, shear: f64) -> Mesh2 {
    let grid = Grid::new([cells; 2], [false; 2]);
    let node = |node: usize| {
        let [i, j] = grid.node_offset(node).map(|i| i as f64 / cells as f64);
        Vector::<2>::new(i + shear * j, j)
    };
    let nodes = (0..grid.node_count()).map(node).collect();
    Mesh2::from_nodes(grid.clone(), nodes).expect("valid nodes")
}

/// `sum |f - f_exact| V` away from the ends after one step of a uniform velocity, by the paper's sweeps and unsplit.
fn errors_after_one_step(
    mesh: &Mesh2,
    velocity: [f64; 3],
    time: f64,
    shape: impl Fn([f64; 2]) -> Shape<2>,
) -> [f64; 2] {
    let exact = volume_fractions(mesh, &[shape([velocity[0] * time, velocity[1] * time])]);
    let grid = mesh.grid();
    let inner = |&cell: &usize| {
        let offset = grid.offset(cell);
        (0..2).all(|axis| offset[axis] >= 2 && offset[axis] + 2 < grid.cells()[axis])
    };
    [Scheme::Sweeps, Scheme::Unsplit].map(|scheme| {
        let reconstruction = Reconstruction { normal: NormalMethod::Lvira, ..Reconstruction::default() };
        let settings = Settings { scheme, axes: SweepAxes::Cartesian, reconstruction, ..Settings::default() };
        let mut transport = Transport::new(mesh, uniform(velocity), settings).expect("no walls asked for");
        let mut fractions = volume_fractions(mesh, &[shape([0.0; 2])]);
        transport.step(&mut fractions, 0, 0.0, time).expect("a step within the limit");
        let error = |cell: usize| (fractions[0][cell] - exact[0][cell]).abs() * mesh.volumes()[cell];
        (0..grid.len()).filter(inner).map(error).sum()
    })
}

/// Fig. 33, lower right: the flux polygon of an empty donor reaches over a cell that is full.
#[test]
fn overlap_with_a_full_cell_beside_an_empty_donor_is_accounted_for() {
    let mesh = sheared(7, 0.6);
    let (h, shear) = (1.0 / 7.0, 0.6);
    // Cell [3, 3] is full and all others are empty.
    let cell = |shift: [f64; 2]| {
        let corner = Vector::<2>::new(3.0 * h + shear * 3.0 * h + shift[0], 3.0 * h + shift[1]);
        let side = |x: f64, y: f64, width: f64| {
            let normal = Vector::<2>::new(x, y);
            HalfSpace { normal, constant: normal.dot(&corner) + width }
        };
        let sides = [side(0.0, -1.0, 0.0), side(0.0, 1.0, h), side(-1.0, shear, 0.0), side(1.0, -shear, h)];
        Shape::Intersection(sides.map(Shape::HalfSpace).to_vec())
    };
    let [sweeps, unsplit] = errors_after_one_step(&mesh, [0.7, -1.0, 0.0], 0.08, cell);
    assert!(unsplit <= 1e-9, "{unsplit:e}");
    assert!(sweeps >= 0.1 * h * h, "{sweeps:e}");
}

/// Fig. 33, lower centre: the flux polygon reaches over cells in which the same plane goes on.
#[test]
fn overlap_with_a_cell_that_continues_the_plane_is_accounted_for() {
    let mesh: Mesh2 = unit_mesh(12, random(0.3, 6));
    let half = |shift: [f64; 2]| {
        let normal = Vector::<2>::new(0.6, 0.8);
        let point = Vector::<2>::new(0.5 + shift[0], 0.5 + shift[1]);
        Shape::HalfSpace(HalfSpace { normal, constant: normal.dot(&point) })
    };
    let [sweeps, unsplit] = errors_after_one_step(&mesh, [0.7, -1.0, 0.0], 0.03, half);
    assert!(unsplit <= 1e-8, "{unsplit:e}");
    assert!(sweeps <= 1e-4, "{sweeps:e}");
}

#[test]
fn agrees_with_sweeps_for_small_steps() {
    let mesh: Mesh2 = unit_mesh(24, random(0.15, 4));
    let start = volume_fractions(&mesh, &[ball([0.5, 0.7], 0.2)]);
    let difference = |courant: f64| {
        let [sweeps, unsplit] = [Scheme::Sweeps, Scheme::Unsplit].map(|scheme| {
            let settings = Settings { scheme, ..Settings::default() };
            let mut transport =
                Transport::new(&mesh, steady(Field::ReversedVortex), settings).expect("no walls asked for");
            let mut fractions = start.clone();
            run(&mut transport, &mut fractions, courant, 1).expect("within the limit");
            fractions
        });
        shape_error(&mesh, &sweeps[0], &unsplit[0]) / shape_error(&mesh, &unsplit[0], &start[0])
    };
    // The slab of a donor and the region traced back have the same volume but not the same shape: a small part of what moves.
    for courant in [0.1, 0.01, 0.001] {
        let difference = difference(courant);
        assert!(difference <= 0.08, "{difference} at {courant}");
    }
}

#[test]
fn one_period_around_a_periodic_box() {
    let grid = Grid::new([16, 16], [true, true]);
    for distortion in [Distortion::None, random(0.2, 4)] {
        let mesh: Mesh2 =
            Mesh::new(grid.clone(), Vector::zeros(), Vector::repeat(1.0), &distortion).expect("valid");
        let start = volume_fractions(&mesh, &[ball([0.5, 0.5], 0.25)]);
        let mut fractions = start.clone();
        let mut transport = unsplit(&mesh, uniform([1.0, 1.0, 0.0]));
        let steps = (transport.courant_rate() / 0.9).ceil() as usize;
        let courant = transport.courant_rate() / steps as f64;
        let ledger = run(&mut transport, &mut fractions, courant, steps).expect("no fold");
        let volume = material_volume(&mesh, &start[0]);
        assert!((material_volume(&mesh, &fractions[0]) / volume - 1.0).abs() <= 1e-12);
        assert!(ledger.materials[0].outflow == 0.0);
        let error = shape_error(&mesh, &fractions[0], &start[0]);
        assert!(error <= 0.06 * volume, "{}", error / volume);
    }
}

#[test]
fn a_named_material_flows_in_on_a_distorted_mesh() {
    for distortion in [Distortion::None, random(0.2, 11)] {
        let mesh: Mesh2 = unit_mesh(10, distortion);
        let settings = Settings { inflow: Some(0), scheme: Scheme::Unsplit, ..Settings::default() };
        let mut transport =
            Transport::new(&mesh, uniform([1.0, 0.3, 0.0]), settings).expect("no walls asked for");
        let mut fractions = vec![vec![0.0; 100]];
        let ledger = run(&mut transport, &mut fractions, 0.8, 6).expect("no fold");
        let entered = material_volume(&mesh, &fractions[0]);
        let account = ledger.materials[0];
        assert!((entered + account.outflow).abs() <= 1e-13, "{entered} {account:?}");
        assert!(account.smallest >= -1e-12 && account.largest <= 1.0 + 1e-12, "{account:?}");
        // The corner (t, 0.3 t) of what was in the box at the start bounds what came in.
        let [x, y] = [1.0, 0.3].map(|u| u * 6.0 * 0.8 / transport.courant_rate());
        let wanted = 1.0 - (1.0 - x) * (1.0 - y);
        assert!((entered - wanted).abs() <= 1e-2 * wanted, "{entered} {wanted}");
    }
}

#[test]
fn a_mesh_far_from_the_origin_gives_the_same() {
    let velocity = uniform([0.6, -0.8, 0.3]);
    let results = [0.0, 1024.0].map(|far| {
        let lower = Vector::<3>::repeat(far);
        let grid = Grid::new([8; 3], [false; 3]);
        let mesh: Mesh3 = Mesh::new(grid, lower, lower.add_scalar(1.0), &random(0.2, 7)).expect("valid");
        let mut fractions = volume_fractions(&mesh, &[ball([far + 0.5; 3], 0.3)]);
        run(&mut unsplit(&mesh, velocity), &mut fractions, 0.7, 3).expect("no fold");
        fractions.remove(0)
    });
    let difference = results[0].iter().zip(&results[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // The nodes themselves are rounded.
    assert!(difference <= 1e-9, "{difference:e}");
}

#[test]
fn a_fold_is_an_error_that_changes_nothing() {
    let mesh: Mesh2 = unit_mesh(16, Distortion::None);
    let start = volume_fractions(&mesh, &[ball([0.5, 0.75], 0.15)]);
    let mut fractions = start.clone();
    let mut transport = unsplit(&mesh, steady(Field::ReversedVortex));
    let error = run(&mut transport, &mut fractions, 12.0, 1).expect_err("twelve times the limit");
    let StepError::Folded { cell, fraction } = error else { panic!("{error}") };
    assert!(cell.len() == 2 && !(0.0..=1.0).contains(&fraction), "{cell:?} {fraction}");
    assert_eq!(fractions, start);
}

/// One step of this Courant number from fractions without a pattern: it keeps the account, or is an error that changes nothing.
fn keeps_its_account(mesh: &Mesh2, field: Field, courant: f64) -> Result<Ledger, StepError> {
    let start: Vec<Vec<f64>> = (0..2)
        .map(|k| (0..mesh.grid().len()).map(|cell| ((cell * 5 + k * 3 + 2) % 7) as f64 / 12.0).collect())
        .collect();
    let mut fractions = start.clone();
    let result = run(&mut unsplit(mesh, steady(field)), &mut fractions, courant, 1);
    let Ok(ledger) = &result else {
        assert_eq!(fractions, start);
        return result;
    };
    for (k, account) in ledger.materials.iter().enumerate() {
        let [before, after] = [&start[k], &fractions[k]].map(|f| material_volume(mesh, f));
        let drift = after - before + account.outflow;
        assert!(drift.abs() <= 1e-12, "{drift:e} of {before}: {account:?}");
    }
    result
}

#[test]
fn pre_images_of_which_no_digits_are_left_are_an_error() {
    // The stream function is nothing but the rounding of pi at all nodes: it takes a step of 1e32 to make anything of it, in which
    // a node comes from 1e16 cells away.
    let mesh = Mesh2::unit([1, 2], &Distortion::None).expect("a valid mesh");
    let error = keeps_its_account(&mesh, Field::ReversedVortex, 0.56).expect_err("no digits");
    let StepError::Scattered { volume, found, .. } = error else { panic!("{error}") };
    assert!(volume == 0.5 && (found - volume).abs() >= 1e-3, "{error}");
    assert!(error.is_too_large());
}

#[test]
fn what_crosses_walls_that_nodes_leave_is_accounted_for() {
    // As much goes out through one half of a wall at the lower and upper end of x as comes in through the other.
    let grid = Grid::new([2, 1], [false; 2]);
    let [lower, upper] = [0.25, 0.75].map(Vector::repeat);
    let mesh = Mesh2::new(grid, lower, upper, &Distortion::None).expect("a valid mesh");
    let transport = unsplit(&mesh, steady(Field::ReversedVortex));
    assert_eq!(transport.boundary().ends[0], [End::Wall; 2]);
    let ledger = keeps_its_account(&mesh, Field::ReversedVortex, 0.3).expect("no fold");
    assert!(ledger.materials.iter().all(|account| account.outflow.abs() >= 1e-3), "{ledger:?}");
}

#[cfg(feature = "parallel")]
#[test]
fn the_same_bits_for_any_number_of_threads() {
    let mesh: Mesh3 = unit_mesh(10, random(0.2, 1));
    let results = [1, 2, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let mut fractions = volume_fractions(&mesh, &[ball([0.35; 3], 0.2), ball([0.6, 0.5, 0.5], 0.2)]);
            run(&mut unsplit(&mesh, steady(Field::Deformation3d)), &mut fractions, 0.8, 4).expect("no fold");
            fractions
        })
    });
    assert_eq!(results[0], results[1]);
    assert_eq!(results[0], results[2]);
}
