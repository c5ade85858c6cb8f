//! The variants of sweeps: symmetric, all faces at once, and with fixed cell volumes.

mod common;

use common::{Mesh2, Mesh3, drift, random, run, steady, unit_mesh};
use vofkit::advection::{
    Ledger, Scheme, Settings, SetupError, StepError, SweepAxes, SweepOrder, Transport, remap,
};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, Vector};
use vofkit::interface::Reconstruction;
use vofkit::mesh::{Distortion, Mesh};
use vofkit::metrics::shape_error;
use vofkit::normal::NormalMethod;
use vofkit::quantity::State;
use vofkit::shape::Shape;
use vofkit::velocity::{Field, Reversal, Velocity};

fn ball<const D: usize>(centre: [f64; D], radius: f64) -> Shape<D> {
    Shape::Sphere { centre: centre.into(), radius }
}

fn scheme<const D: usize>(scheme: Scheme) -> Settings<D> {
    Settings { scheme, ..Settings::default() }
}

fn symmetric<const D: usize>(axes: SweepAxes) -> Settings<D> {
    Settings { order: SweepOrder::Symmetric, axes, ..Settings::default() }
}

/// The fractions after some steps of this Courant number, with what was done.
fn advected<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocity: Velocity,
    settings: Settings<D>,
    shapes: &[Shape<D>],
    [courant, end]: [f64; 2],
) -> (Vec<Vec<f64>>, Vec<Vec<f64>>, Ledger) {
    let mut transport = Transport::new(mesh, velocity, settings).expect("a transport");
    let start = volume_fractions(mesh, shapes);
    let mut fractions = start.clone();
    let steps = (end * transport.courant_rate() / courant).ceil() as usize;
    let ledger = run(&mut transport, &mut fractions, steps, end).expect("steps within the limit");
    (start, fractions, ledger)
}

fn assert_exactly_conservative<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocity: Velocity,
    settings: Settings<D>,
    shapes: &[Shape<D>],
    courant: f64,
) {
    let (start, fractions, ledger) = advected(mesh, velocity, settings, shapes, [courant, 0.4]);
    for (k, account) in ledger.materials.iter().enumerate() {
        let drift = drift(mesh, &start[k], &fractions[k], account.outflow);
        assert!(drift.abs() <= 1e-12, "{settings:?}: drift {drift:e}");
        assert!(account.smallest >= -1e-12 && account.largest <= 1.0 + 1e-12, "{settings:?}: {account:?}");
    }
}

#[test]
fn symmetric_sweeps_conserve_and_stay_bounded_on_any_mesh() {
    let plane: Mesh2 = unit_mesh(20, random(0.25, 3));
    let discs = [ball([0.4, 0.6], 0.2), ball([0.6, 0.4], 0.15)];
    let settings = symmetric(SweepAxes::Logical);
    assert_exactly_conservative(&plane, steady(Field::ReversedVortex), settings, &discs, 0.5);
    let space: Mesh3 = unit_mesh(10, random(0.2, 3));
    let settings = symmetric(SweepAxes::Logical);
    assert_exactly_conservative(&space, steady(Field::Deformation3d), settings, &[ball([0.4; 3], 0.2)], 0.5);
}

#[test]
fn fixed_volumes_conserve_and_stay_bounded_within_their_limit() {
    let settings = scheme(Scheme::WeymouthYue);
    let plane: Mesh2 = unit_mesh(32, Distortion::None);
    let limit = settings.scheme.courant_limit(2);
    assert_eq!(limit, 0.5);
    let disc = [ball([0.5, 0.75], 0.15)];
    assert_exactly_conservative(&plane, steady(Field::ReversedVortex), settings, &disc, limit);
    let space: Mesh3 = unit_mesh(12, Distortion::None);
    let settings = scheme(Scheme::WeymouthYue);
    assert_eq!(settings.scheme.courant_limit(3), 0.25);
    assert_exactly_conservative(&space, steady(Field::Deformation3d), settings, &[ball([0.4; 3], 0.2)], 0.25);
}

#[test]
fn fixed_volumes_need_an_undistorted_mesh() {
    let mesh: Mesh2 = unit_mesh(8, random(0.1, 1));
    let error = Transport::new(&mesh, steady(Field::ReversedVortex), scheme(Scheme::WeymouthYue))
        .expect_err("the mesh is distorted");
    assert_eq!(error, SetupError::Distorted { scheme: Scheme::WeymouthYue });
    assert!(error.to_string().contains("weymouth_yue"), "{error}");
}

#[test]
fn fixed_volumes_refuse_more_than_a_cell_holds() {
    let mesh: Mesh2 = unit_mesh(16, Distortion::None);
    let mut transport =
        Transport::new(&mesh, steady(Field::ReversedVortex), scheme(Scheme::WeymouthYue)).expect("boxes");
    let mut fractions = volume_fractions(&mesh, &[ball([0.5, 0.75], 0.15)]);
    let start = fractions.clone();
    let end = 2.5 / transport.courant_rate();
    let error = transport.step(&mut fractions, 0, 0.0, end).expect_err("far above the limit");
    assert!(matches!(error, StepError::Overdrawn { .. }), "{error}");
    assert_eq!(fractions, start);
}

/// The error of a disc after a diagonal translation, relative to its volume.
fn translated(mesh: &Mesh2, settings: Settings<2>, courant: f64) -> (f64, Ledger) {
    let field = Field::Uniform { velocity: Vector::<3>::new(1.0, 1.0, 0.0) };
    let disc = [ball([0.3, 0.3], 0.15)];
    let (start, fractions, ledger) = advected(mesh, steady(field), settings, &disc, [courant, 0.4]);
    let exact = volume_fractions(mesh, &[ball([0.7, 0.7], 0.15)]);
    let volume = start[0].iter().zip(mesh.volumes()).map(|(f, v)| f * v).sum::<f64>();
    (shape_error(mesh, &fractions[0], &exact[0]) / volume, ledger)
}

#[test]
fn all_faces_at_once_are_worse_than_sweeps_and_enter_their_corrections() {
    let mesh: Mesh2 = unit_mesh(32, Distortion::None);
    let (at_once, ledger) = translated(&mesh, scheme(Scheme::Isotropic), 0.5);
    let (sweeps, exact) = translated(&mesh, Settings::default(), 0.5);
    assert!(sweeps <= 0.05, "{sweeps}");
    assert!(at_once >= 2.0 * sweeps, "{at_once} {sweeps}");
    // Regions that overlap give more than there is; regions that leave a gap at the corner give less.
    assert!(ledger.materials[0].clipped >= 1e-4, "{:?}", ledger.materials[0]);
    assert!(exact.materials[0].clipped <= 1e-12);
    let distorted: Mesh2 = unit_mesh(32, random(0.2, 2));
    let (error, _) = translated(&distorted, scheme(Scheme::Isotropic), 0.3);
    assert!(error <= 1.0, "{error}");
}

#[test]
fn symmetric_sweeps_are_at_least_as_good_as_alternating_ones_under_youngs_normals() {
    let velocity = Velocity { field: Field::ReversedVortex, reversal: Reversal::Cosine { period: 2.0 } };
    for distortion in [Distortion::None, random(0.15, 2)] {
        let mesh: Mesh2 = unit_mesh(32, distortion);
        let disc = [ball([0.5, 0.75], 0.15)];
        let [alternating, symmetric] = [Settings::default(), symmetric(SweepAxes::Logical)].map(|settings| {
            // With better normals one more reconstruction a step costs more than splitting it.
            let reconstruction = Reconstruction { normal: NormalMethod::Youngs, ..Reconstruction::default() };
            let settings = Settings { reconstruction, ..settings };
            let (start, fractions, _) = advected(&mesh, velocity, settings, &disc, [0.5, 2.0]);
            shape_error(&mesh, &fractions[0], &start[0])
        });
        assert!(symmetric <= 1.1 * alternating, "{symmetric} {alternating}");
    }
}

#[test]
fn small_steps_of_all_schemes_agree() {
    let mesh: Mesh2 = unit_mesh(24, Distortion::None);
    let velocity = steady(Field::ReversedVortex);
    let all = [
        Settings::default(),
        symmetric(SweepAxes::Logical),
        scheme(Scheme::WeymouthYue),
        scheme(Scheme::Isotropic),
    ];
    let disc = [ball([0.5, 0.7], 0.2)];
    let results = all.map(|settings| advected(&mesh, velocity, settings, &disc, [0.02, 0.2]).1);
    for (result, settings) in results.iter().zip(&all) {
        let difference = shape_error(&mesh, &result[0], &results[0][0]);
        assert!(difference <= 2e-3, "{:?} {:?}: {difference:e}", settings.scheme, settings.order);
    }
}

#[test]
fn symmetric_cartesian_sweeps_are_the_logical_ones_on_boxes() {
    let mesh: Mesh2 = unit_mesh(16, Distortion::None);
    let disc = [ball([0.5, 0.7], 0.2)];
    let [logical, cartesian] = [SweepAxes::Logical, SweepAxes::Cartesian]
        .map(|axes| advected(&mesh, steady(Field::ReversedVortex), symmetric(axes), &disc, [0.5, 0.2]).1);
    assert_eq!(logical, cartesian);
    let distorted: Mesh2 = unit_mesh(24, random(0.15, 5));
    let (_, _, ledger) = advected(
        &distorted,
        steady(Field::ReversedVortex),
        symmetric(SweepAxes::Cartesian),
        &disc,
        [0.5, 0.2],
    );
    assert!(ledger.materials[0].clipped <= 1e-2, "{:?}", ledger.materials[0]);
}

/// Three steps of a uniform flow that start with number `first`.
fn pushed<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocity: Vector<3>,
    settings: Settings<D>,
    fractions: &[f64],
    first: usize,
) -> Vec<f64> {
    let field = Field::Uniform { velocity };
    let mut transport = Transport::new(mesh, steady(field), settings).expect("open ends");
    let mut fractions = vec![fractions.to_vec()];
    for step in first..first + 3 {
        let [start, end] = [0.0, 1.0].map(|part| 0.02 * (step as f64 + part));
        transport.step(&mut fractions, step, start, end).expect("a small step");
    }
    fractions.remove(0)
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn turned_twins_turn_together() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.8, 1.1);
    let mesh: Mesh3 = unit_mesh(8, random(0.2, 5));
    let nodes = mesh.nodes().iter().map(|x| turn * x).collect();
    let turned: Mesh3 = Mesh::from_nodes(mesh.grid().clone(), nodes).expect("valid cells");
    let start = volume_fractions(&mesh, &[ball([0.45; 3], 0.25)]).remove(0);
    let velocity = Vector::<3>::new(0.8, 0.5, -0.6);
    // Cartesian sweeps follow the axes of space, and fixed volumes need boxes: these have no turned twins.
    let all = [
        Settings::default(),
        symmetric(SweepAxes::Logical),
        scheme(Scheme::Isotropic),
        scheme(Scheme::Unsplit),
    ];
    for settings in all {
        let here = pushed(&mesh, velocity, settings, &start, 0);
        let there = pushed(&turned, turn * velocity, settings, &start, 0);
        let difference = largest_difference(&here, &there);
        assert!(difference <= 1e-9, "{settings:?}: {difference:e}");
        assert!(largest_difference(&here, &start) >= 0.1);
    }
    // The mesh moves under the material at rest.
    let moved = |mesh: &Mesh3| {
        let nodes = mesh.nodes().iter().map(|x| x + (mesh.nodes()[0] - x) * 0.1).collect();
        let to = Mesh3::from_nodes(mesh.grid().clone(), nodes).expect("valid cells");
        let state = State { fractions: vec![start.clone()], quantities: Vec::new() };
        remap(mesh, &to, &state, Reconstruction::default()).expect("valid").0.fractions.remove(0)
    };
    let [here, there] = [&mesh, &turned].map(moved);
    let difference = largest_difference(&here, &there);
    assert!(difference <= 1e-9, "{difference:e}");
    assert!(largest_difference(&here, &start) >= 0.1);
}

#[test]
fn relabelled_twins_move_alike() {
    // Counted along the old y, and backwards along the old x.
    let old = |place: usize, count: usize| {
        let [i, j] = [place % count, place / count];
        (count - 1 - j) + i * count
    };
    let velocity = Vector::<3>::new(0.8, 0.5, 0.0);
    let mesh: Mesh2 = unit_mesh(16, random(0.25, 5));
    let nodes = (0..17 * 17).map(|node| mesh.nodes()[old(node, 17)]).collect();
    let relabelled: Mesh2 = Mesh::from_nodes(mesh.grid().clone(), nodes).expect("valid cells");
    let start = volume_fractions(&mesh, &[ball([0.45; 2], 0.25)]).remove(0);
    let start_there: Vec<f64> = (0..256).map(|cell| start[old(cell, 16)]).collect();
    let all = [
        Settings::default(),
        Settings { axes: SweepAxes::Cartesian, ..Settings::default() },
        symmetric(SweepAxes::Logical),
        symmetric(SweepAxes::Cartesian),
        scheme(Scheme::Isotropic),
        scheme(Scheme::Unsplit),
    ];
    for settings in all {
        let here = pushed(&mesh, velocity, settings, &start, 0);
        // The order of the axes is the other one in odd steps; Cartesian axes stay as they are.
        let first = usize::from(settings.axes == SweepAxes::Logical);
        let there = pushed(&relabelled, velocity, settings, &start_there, first);
        let here: Vec<f64> = (0..256).map(|cell| here[old(cell, 16)]).collect();
        let difference = largest_difference(&here, &there);
        assert!(difference <= 1e-10, "{settings:?}: {difference:e}");
    }
}
