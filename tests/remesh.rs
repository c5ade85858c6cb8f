//! Meshes that move under materials that rest: conservation, constancy, accuracy, and what is an error.

mod common;

use common::{Mesh2, random, unit_mesh};
use vofkit::advection::{
    End, Ledger, Remesh, Scheme, Settings, SetupError, StepError, SweepAxes, SweepOrder,
};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, Hexahedron, Quad, Vector};
use vofkit::mesh::{Distortion, Mesh, MeshMotion, MeshPath, MotionError};
use vofkit::metrics::{material_volume, shape_error};
use vofkit::shape::Shape;

fn ball<const D: usize>(centre: [f64; D], radius: f64) -> Shape<D> {
    Shape::Sphere { centre: centre.into(), radius }
}

fn settings<const D: usize>(axes: SweepAxes) -> Settings<D> {
    Settings { axes, ..Settings::default() }
}

/// Takes fractions along a path in equal steps; the mesh at the end, and what was done.
fn moved<C: Cell<D>, const D: usize>(
    path: &MeshPath<C, D>,
    settings: Settings<D>,
    fractions: &mut [Vec<f64>],
    steps: usize,
) -> Result<(Mesh<C, D>, Ledger), StepError> {
    let mut remesh = Remesh::new(settings).expect("a scheme for moving meshes");
    let mut at = path.start().clone();
    let mut ledger = Ledger::new(fractions.len());
    for step in 0..steps {
        let to = path.mesh((step + 1) as f64 / steps as f64)?;
        ledger.add(&remesh.step(&at, &to, fractions, step)?);
        at = to;
    }
    Ok((at, ledger))
}

fn wave<C: Cell<D>, const D: usize>(mesh: Mesh<C, D>, amplitude: f64, swings: usize) -> MeshPath<C, D> {
    let distortion = Distortion::Wave { amplitude };
    MeshPath::new(mesh, MeshMotion::Distort { distortion, swings }).expect("a motion")
}

fn shaken<C: Cell<D>, const D: usize>(mesh: Mesh<C, D>, amplitude: f64) -> MeshPath<C, D> {
    let distortion = random(amplitude, 11);
    MeshPath::new(mesh, MeshMotion::Distort { distortion, swings: 2 }).expect("a motion")
}

/// Relative errors of volume and of shape after the motion.
fn errors<C: Cell<D>, const D: usize>(
    path: &MeshPath<C, D>,
    settings: Settings<D>,
    shapes: &[Shape<D>],
    steps: usize,
) -> ([f64; 2], Ledger) {
    let mut fractions = volume_fractions(path.start(), shapes);
    let start = material_volume(path.start(), &fractions[0]);
    let (mesh, ledger) = moved(path, settings, &mut fractions, steps).expect("small moves");
    let exact = volume_fractions(&mesh, shapes);
    let drift = (material_volume(&mesh, &fractions[0]) - start + ledger.materials[0].outflow) / start;
    ([drift, shape_error(&mesh, &fractions[0], &exact[0]) / start], ledger)
}

#[test]
fn sweeps_along_mesh_lines_conserve_and_stay_bounded() {
    for order in [SweepOrder::Alternating, SweepOrder::Symmetric] {
        let plane = settings(SweepAxes::Logical);
        let path = shaken(unit_mesh::<Quad, 2>(20, random(0.1, 1)), 0.15);
        let shapes = [ball([0.4, 0.5], 0.2), ball([0.6, 0.4], 0.15)];
        let ([drift, error], ledger) = errors(&path, Settings { order, ..plane }, &shapes, 10);
        assert!(drift.abs() <= 1e-12 && error <= 0.05, "{drift:e} {error}");
        for account in &ledger.materials {
            assert!(account.smallest >= -1e-12 && account.largest <= 1.0 + 1e-12, "{account:?}");
        }
        let space = settings(SweepAxes::Logical);
        let path = shaken(unit_mesh::<Hexahedron, 3>(8, random(0.1, 1)), 0.1);
        let shapes = [ball([0.4, 0.5, 0.6], 0.25)];
        let ([drift, error], ledger) = errors(&path, Settings { order, ..space }, &shapes, 8);
        assert!(drift.abs() <= 1e-12 && error <= 0.1, "{drift:e} {error}");
        assert!(ledger.materials[0].smallest >= -1e-12 && ledger.materials[0].largest <= 1.0 + 1e-12);
    }
}

#[test]
fn cartesian_sweeps_lose_no_more_than_their_ledger_says() {
    let path = wave(unit_mesh::<Quad, 2>(24, Distortion::None), 0.4, 1);
    let disc = [ball([0.4, 0.55], 0.2)];
    let ([drift, error], ledger) = errors(&path, settings(SweepAxes::Cartesian), &disc, 40);
    let volume = std::f64::consts::PI * 0.04;
    assert!(drift.abs() * volume <= ledger.materials[0].clipped + 1e-9, "{drift:e} {ledger:?}");
    assert!(error <= 0.03, "{error}");
    let path = wave(unit_mesh::<Hexahedron, 3>(10, Distortion::None), 0.3, 1);
    let sphere = [ball([0.4, 0.55, 0.5], 0.25)];
    let ([drift, error], ledger) = errors(&path, settings(SweepAxes::Cartesian), &sphere, 16);
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 0.25_f64.powi(3);
    assert!(drift.abs() * volume <= ledger.materials[0].clipped + 1e-9, "{drift:e} {ledger:?}");
    assert!(error <= 0.06, "{error}");
}

#[test]
fn materials_that_fill_the_mesh_fill_it_to_the_bit() {
    for axes in [SweepAxes::Logical, SweepAxes::Cartesian] {
        let path = shaken(unit_mesh::<Quad, 2>(10, random(0.1, 3)), 0.2);
        let mut fractions = vec![vec![1.0; 100], vec![0.0; 100]];
        moved(&path, settings(axes), &mut fractions, 8).expect("no interface, no error");
        assert!(fractions[0].iter().all(|&f| f == 1.0) && fractions[1].iter().all(|&f| f == 0.0));
    }
}

#[test]
fn small_moves_of_all_variants_agree() {
    let path = wave(unit_mesh::<Quad, 2>(24, Distortion::None), 0.4, 1);
    let disc = [ball([0.4, 0.55], 0.2)];
    let variants = [
        settings(SweepAxes::Logical),
        settings(SweepAxes::Cartesian),
        Settings { order: SweepOrder::Symmetric, ..settings(SweepAxes::Cartesian) },
        Settings { scheme: Scheme::Isotropic, ..Settings::default() },
    ];
    for variant in variants {
        let ([_, error], _) = errors(&path, variant, &disc, 100);
        assert!(error <= 0.03, "{variant:?}: {error}");
    }
}

#[test]
fn a_mesh_that_turns_is_a_flow_that_turns_back() {
    // Relative to the mesh the material turns, so that both have the same errors.
    let angle = 1.2;
    let motion = MeshMotion::Rotate { centre: Vector::repeat(0.5), axis: Vector::<3>::z(), angle };
    let path = MeshPath::new(unit_mesh::<Quad, 2>(24, Distortion::None), motion).expect("a motion");
    let disc = [ball([0.5, 0.7], 0.15)];
    let ([drift, error], ledger) = errors(&path, settings(SweepAxes::Logical), &disc, 60);
    assert!(drift.abs() <= 1e-12 && error <= 0.06, "{drift:e} {error}");
    assert_eq!(ledger.materials[0].outflow, 0.0);
}

#[test]
fn ends_that_move_are_open_unless_they_must_not() {
    let mesh: Mesh2 = unit_mesh(10, Distortion::None);
    let shifted = mesh.nodes().iter().map(|x| x + Vector::<2>::new(0.04, 0.0)).collect();
    let to = mesh.moved(shifted).expect("valid");
    let start = volume_fractions(&mesh, &[ball([0.1, 0.5], 0.2)]);
    let mut fractions = start.clone();
    let mut remesh = Remesh::new(Settings::default()).expect("sweeps");
    assert_eq!(remesh.boundary(&mesh, &to).expect("no walls").ends, [[End::Outflow; 2], [End::Wall; 2]]);
    let ledger = remesh.step(&mesh, &to, &mut fractions, 0).expect("a small move");
    let lost = material_volume(&mesh, &start[0]) - material_volume(&to, &fractions[0]);
    assert!(lost > 0.01 && (lost - ledger.materials[0].outflow).abs() <= 1e-15, "{lost}");
    let mut walls = Settings::default();
    walls.ends[0][0] = Some(End::Wall);
    let before = fractions.clone();
    let error =
        Remesh::new(walls).expect("sweeps").step(&mesh, &to, &mut fractions, 0).expect_err("the wall moves");
    assert!(matches!(&error, StepError::MovingWall(wall) if wall.axis == 0 && wall.side == 0), "{error}");
    assert_eq!(fractions, before);
}

#[test]
fn moves_that_cannot_be_done_change_nothing() {
    let mesh: Mesh2 = unit_mesh(10, Distortion::None);
    let start = volume_fractions(&mesh, &[ball([0.5, 0.5], 0.2)]);
    let mut fractions = start.clone();
    let far = mesh.nodes().iter().map(|x| x + Vector::<2>::new(0.15, 0.0)).collect();
    let to = mesh.moved(far).expect("valid");
    for axes in [SweepAxes::Logical, SweepAxes::Cartesian] {
        let mut remesh = Remesh::new(settings(axes)).expect("sweeps");
        let error = remesh.step(&mesh, &to, &mut fractions, 0).expect_err("more than a cell");
        assert!(matches!(error, StepError::Overdrawn { .. }), "{error}");
        let other: Mesh2 = unit_mesh(9, Distortion::None);
        let error = remesh.step(&mesh, &other, &mut fractions, 0).expect_err("other cells");
        assert!(matches!(error, StepError::Mesh(MotionError::OtherGrid { .. })), "{error}");
        let error = remesh.step(&mesh, &mesh, &mut [vec![f64::NAN; 100]], 0).expect_err("not a number");
        assert!(matches!(error, StepError::Reconstruction(_)), "{error}");
    }
    assert_eq!(fractions, start);
    let error = Remesh::<3>::new(Settings { scheme: Scheme::WeymouthYue, ..Settings::default() });
    assert_eq!(error.err(), Some(SetupError::Distorted { scheme: Scheme::WeymouthYue }));
}
