//! Meshes that move: where their nodes are, and what their faces sweep.

mod common;

use common::{Mesh2, Mesh3, random, unit_mesh};
use vofkit::geometry::{Cell, Vector};
use vofkit::mesh::{Distortion, Grid, Mesh, MeshError, MeshMotion, MeshPath, MotionError, SweptVolumes};

/// The largest difference between a cell's new volume and its old one less what crossed outward, relative to the new volume
/// or, where more than the old one crosses a face, to what crosses.
fn gap<C: Cell<D>, const D: usize>(from: &Mesh<C, D>, to: &Mesh<C, D>) -> f64 {
    let swept = SweptVolumes::new(from, to).expect("two places of one mesh");
    swept.mismatch(from, to) / swept.courant(from).max(1.0)
}

fn rotation<const D: usize>(angle: f64) -> MeshMotion<D> {
    MeshMotion::Rotate { centre: Vector::repeat(0.4), axis: Vector::<3>::new(1.0, -2.0, 0.7), angle }
}

fn distort<const D: usize>(distortion: Distortion, swings: usize) -> MeshMotion<D> {
    MeshMotion::Distort { distortion, swings }
}

fn path<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, motion: MeshMotion<D>) -> MeshPath<C, D> {
    MeshPath::new(mesh.clone(), motion).expect("a motion")
}

/// Motions that keep random meshes of amplitude 0.15 valid.
fn motions<const D: usize>() -> [MeshMotion<D>; 5] {
    [
        distort(random(0.15, 5), 1),
        distort(Distortion::Wave { amplitude: 0.3 }, 1),
        distort(Distortion::Twist { angle: 0.3 }, 1),
        MeshMotion::Smooth { swings: 1 },
        rotation(0.8),
    ]
}

#[test]
fn swept_volumes_change_cell_volumes_to_rounding() {
    let plane: Mesh2 = unit_mesh(12, random(0.15, 3));
    for motion in motions() {
        let path = path(&plane, motion.clone());
        let gap = gap(&plane, &path.mesh(0.9).expect("valid cells"));
        assert!(gap <= 1e-14, "{motion:?}: {gap:e}");
    }
    let space: Mesh3 = unit_mesh(6, random(0.15, 3));
    for motion in motions() {
        let path = path(&space, motion.clone());
        let gap = gap(&space, &path.mesh(0.9).expect("valid cells"));
        assert!(gap <= 1e-14, "{motion:?}: {gap:e}");
    }
}

#[test]
fn small_moves_of_a_mesh_far_away_keep_their_digits() {
    let grid = Grid::new([5, 5, 5], [false; 3]);
    let lower = Vector::<3>::repeat(1e4);
    let far = Mesh3::new(grid, lower, lower + Vector::<3>::repeat(1.0), &random(0.2, 4)).expect("valid");
    let path = path(&far, distort(random(0.1, 8), 1));
    // The nodes themselves have rounding 1e4 eps, against a spacing of 0.2.
    let gap = gap(&far, &path.mesh(0.02).expect("valid cells"));
    assert!(gap <= 1e-14, "{gap:e}");
}

#[test]
fn sums_of_swept_volumes_are_exact_in_any_order() {
    let mesh: Mesh3 = unit_mesh(5, random(0.2, 3));
    let moved = path(&mesh, distort(random(0.2, 6), 1)).mesh(0.5).expect("valid cells");
    let swept = SweptVolumes::new(&mesh, &moved).expect("two places of one mesh");
    for cell in 0..mesh.grid().len() {
        let offset = mesh.grid().offset(cell);
        let faces: Vec<f64> = (0..6).map(|face| swept.through(offset, face / 2, face % 2)).collect();
        let half = swept.round(0.5 * faces[0]);
        let forward: f64 = faces.iter().sum();
        let backward: f64 = faces.iter().rev().sum();
        assert_eq!(forward, backward);
        assert_eq!(half + (faces[0] - half) + faces[1], faces[1] + faces[0]);
    }
}

#[test]
fn neighbours_share_their_face_and_joined_ends_too() {
    let grid = Grid::new([6, 4], [true, false]);
    let mesh = Mesh2::new(grid, Vector::zeros(), Vector::repeat(1.0), &random(0.2, 1)).expect("valid");
    let moved = path(&mesh, distort(random(0.15, 2), 1)).mesh(1.0).expect("valid cells");
    assert!(gap(&mesh, &moved) <= 4e-15);
    let swept = SweptVolumes::new(&mesh, &moved).expect("two places of one mesh");
    for j in 0..4 {
        assert_eq!(swept.through([5, j], 0, 1), swept.through([0, j], 0, 0));
        assert_eq!(swept.through([2, j], 0, 1), swept.through([3, j], 0, 0));
    }
}

#[test]
fn nodes_are_where_the_motion_says() {
    let mesh: Mesh2 = unit_mesh(8, random(0.2, 1));
    let smooth = path(&mesh, MeshMotion::Smooth { swings: 1 });
    let boxes: Mesh2 = unit_mesh(8, Distortion::None);
    assert_eq!(smooth.nodes(0.0), mesh.nodes());
    assert_eq!(smooth.nodes(1.0), boxes.nodes());
    let back = path(&mesh, distort(Distortion::Wave { amplitude: 0.3 }, 2)).nodes(1.0);
    assert_eq!(back, mesh.nodes());
    let quarter = MeshMotion::Rotate {
        centre: Vector::repeat(0.5),
        axis: Vector::<3>::z() * 1e-200,
        angle: std::f64::consts::FRAC_PI_2,
    };
    let turned = path(&boxes, quarter).nodes(1.0);
    assert!((turned[8] - Vector::<2>::new(1.0, 1.0)).amax() <= 1e-15, "{:?}", turned[8]);
    let sets = vec![boxes.nodes().to_vec(), mesh.nodes().to_vec()];
    let through = path(&mesh, MeshMotion::Through(sets));
    assert_eq!(through.nodes(0.5), boxes.nodes());
    assert_eq!(through.nodes(1.0), mesh.nodes());
    let middle = (mesh.nodes()[40] + boxes.nodes()[40]) * 0.5;
    assert!((through.nodes(0.25)[40] - middle).amax() <= 1e-15);
}

#[test]
fn a_motion_that_spoils_cells_says_which_and_when() {
    let mesh: Mesh2 = unit_mesh(8, Distortion::None);
    let mut nodes = mesh.nodes().to_vec();
    nodes[mesh.grid().node_index([3, 3])] = Vector::<2>::new(0.9, 0.9);
    let path = path(&mesh, MeshMotion::Through(vec![nodes]));
    assert!(path.mesh(0.05).is_ok());
    let error = path.mesh(0.75).expect_err("one node is far from its cells");
    let MotionError::Cells { progress, source: MeshError::BadCells { bad, .. } } = &error else {
        panic!("{error}")
    };
    assert_eq!(*progress, 0.75);
    assert!(bad.iter().all(|bad| bad.cell.iter().all(|&at| at == 2 || at == 3)), "{bad:?}");
}

#[test]
fn motions_out_of_range_are_refused() {
    let mesh: Mesh2 = unit_mesh(4, Distortion::None);
    let refused = |motion| MeshPath::new(mesh.clone(), motion).expect_err("out of range");
    for amplitude in [f64::NAN, -0.1, 1.0] {
        assert!(matches!(refused(distort(random(amplitude, 1), 1)), MotionError::Distortion(_)));
    }
    assert_eq!(refused(distort(random(0.1, 1), 0)), MotionError::NoSwing);
    assert_eq!(refused(MeshMotion::Smooth { swings: 0 }), MotionError::NoSwing);
    for angle in [f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(rotation(angle)), MotionError::Rotation { .. }));
    }
    let none = MeshMotion::Rotate { centre: Vector::zeros(), axis: Vector::<3>::zeros(), angle: 1.0 };
    assert!(matches!(refused(none), MotionError::Rotation { .. }));
    assert_eq!(refused(MeshMotion::Through(Vec::new())), MotionError::NoNodes);
    let short = vec![mesh.nodes().to_vec(), vec![Vector::zeros(); 24]];
    assert_eq!(refused(MeshMotion::Through(short)), MotionError::NodeCount { set: 1, wanted: 25, given: 24 });
    let mut nodes = mesh.nodes().to_vec();
    nodes[7][1] = f64::NAN;
    let error = refused(MeshMotion::Through(vec![nodes]));
    assert!(matches!(&error, MotionError::NotFinite { set: 0, node, .. } if node == &[2, 1]), "{error}");
}

#[test]
fn joined_ends_cannot_come_apart() {
    let grid = Grid::new([4, 4], [false, true]);
    let mesh = Mesh2::new(grid, Vector::zeros(), Vector::repeat(1.0), &Distortion::None).expect("valid");
    let error = MeshPath::new(mesh, rotation(0.3)).expect_err("the ends turn differently");
    assert!(matches!(error, MotionError::Periodic { axis: 1, .. }), "{error}");
}

#[test]
fn meshes_of_other_cells_are_refused() {
    let [a, b]: [Mesh2; 2] = [4, 5].map(|n| unit_mesh(n, Distortion::None));
    let error = SweptVolumes::new(&a, &b).expect_err("other cells");
    assert_eq!(error, MotionError::OtherGrid { from: vec![4, 4], to: vec![5, 5] });
}

#[test]
fn the_courant_number_is_what_leaves_a_cell_of_what_it_holds() {
    let mesh: Mesh2 = unit_mesh(10, Distortion::None);
    let shifted = mesh.nodes().iter().map(|x| x + Vector::<2>::new(0.03, -0.02)).collect();
    let moved = mesh.moved(shifted).expect("valid");
    let swept = SweptVolumes::new(&mesh, &moved).expect("two places of one mesh");
    assert!((swept.courant(&mesh) - 0.3).abs() <= 1e-12);
    // Towards lower indices, for the mesh moves to higher ones.
    assert!((swept.through([3, 3], 0, 1) + 0.003).abs() <= 1e-15);
}

#[test]
fn rates_hold_over_the_whole_motion() {
    let mesh: Mesh2 = unit_mesh(10, random(0.1, 2));
    let quarter: MeshMotion<2> =
        MeshMotion::Rotate { centre: Vector::repeat(0.5), axis: Vector::<3>::z(), angle: 1.5 };
    for (motion, fastest) in [(distort(random(0.15, 7), 3), 1.0 / 6.0), (quarter, 0.3)] {
        let path = path(&mesh, motion);
        let rates = path.rates().expect("valid cells");
        let [from, to] = [fastest - 1e-4, fastest + 1e-4].map(|at| path.mesh(at).expect("valid cells"));
        let there = SweptVolumes::new(&from, &to).expect("places of one mesh").courant(&from) / 2e-4;
        assert!((rates.courant / there - 1.0).abs() <= 0.05, "{} {there}", rates.courant);
        assert!(rates.mismatch <= 1e-14);
    }
}
