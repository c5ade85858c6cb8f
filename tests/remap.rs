//! Remapping between meshes: conservation and bounds without corrections however far the nodes move, planes exact.

mod common;

use common::{Mesh2, Mesh3, fixed, random, unit_mesh};
use proptest::prelude::*;
use vofkit::advection::{Ledger, RemapError, remap};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, HalfSpace, Vector};
use vofkit::interface::{Reconstruction, ReconstructionError};
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::metrics::{material_volume, shape_error};
use vofkit::normal::NormalMethod;
use vofkit::quantity::{QuantityError, State};
use vofkit::shape::Shape;

fn ball<const D: usize>(centre: [f64; D], radius: f64) -> Shape<D> {
    Shape::Sphere { centre: centre.into(), radius }
}

/// The fractions on another mesh.
fn remapped<C: Cell<D>, const D: usize>(
    from: &Mesh<C, D>,
    to: &Mesh<C, D>,
    fractions: Vec<Vec<f64>>,
    method: Reconstruction,
) -> Result<(Vec<Vec<f64>>, Ledger), RemapError> {
    let (state, ledger) = remap(from, to, &State::of_fractions(fractions), method)?;
    Ok((state.fractions, ledger))
}

fn conserves<C: Cell<D>, const D: usize>(from: &Mesh<C, D>, to: &Mesh<C, D>, shapes: &[Shape<D>]) {
    let start = volume_fractions(from, shapes);
    let (fractions, ledger) =
        remapped(from, to, start.clone(), Reconstruction::default()).expect("valid meshes");
    for (k, account) in ledger.materials.iter().enumerate() {
        let before = material_volume(from, &start[k]);
        let change = material_volume(to, &fractions[k]) - before;
        assert!(change.abs() <= 1e-13, "{change:e} of {before:e}");
        assert!(account.smallest >= -1e-12 && account.largest <= 1.0 + 1e-12, "{account:?}");
        assert!(account.clipped <= 1e-13 && account.rescaled == 0.0, "{account:?}");
    }
    for cell in 0..to.grid().len() {
        let sum: f64 = fractions.iter().map(|f| f[cell]).sum();
        assert!(sum <= 1.0 + 1e-12, "{sum}");
    }
}

proptest! {
    #![proptest_config(fixed(16, 20_261_125))]

    #[test]
    fn conserves_and_stays_bounded_2d(
        seed in 0_u64..1000,
        cells in 3_usize..24,
        centre in prop::array::uniform2(0.0_f64..1.0),
        radius in 0.05_f64..0.6,
    ) {
        let from: Mesh2 = unit_mesh(14, random(0.3, seed));
        let to: Mesh2 = unit_mesh(cells, random(0.3, seed + 1));
        conserves(&from, &to, &[ball(centre, radius), ball([0.5, 0.4], 0.3)]);
    }

    #[test]
    fn conserves_and_stays_bounded_3d(
        seed in 0_u64..1000,
        cells in 2_usize..9,
        centre in prop::array::uniform3(0.0_f64..1.0),
        radius in 0.1_f64..0.6,
    ) {
        let from: Mesh3 = unit_mesh(6, random(0.25, seed));
        let to: Mesh3 = unit_mesh(cells, random(0.25, seed + 1));
        conserves(&from, &to, &[ball(centre, radius), ball([0.5; 3], 0.4)]);
    }
}

#[test]
fn the_same_mesh_gives_the_same_fractions() {
    let mesh: Mesh3 = unit_mesh(8, random(0.2, 3));
    let start = volume_fractions(&mesh, &[ball([0.5; 3], 0.3)]);
    let (fractions, _) =
        remapped(&mesh, &mesh, start.clone(), Reconstruction::default()).expect("a valid mesh");
    let difference = start[0].iter().zip(&fractions[0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(difference <= 1e-12, "{difference:e}");
}

#[test]
fn planes_stay_planes_however_far_the_nodes_move() {
    let normal = Vector::<2>::new(0.6, 0.8);
    let shapes = [Shape::HalfSpace(HalfSpace { normal, constant: 0.7 })];
    let from: Mesh2 = unit_mesh(12, random(0.25, 1));
    let to: Mesh2 = unit_mesh(17, Distortion::Twist { angle: 0.8 });
    let method = Reconstruction { normal: NormalMethod::Lvira, ..Reconstruction::default() };
    let (fractions, _) =
        remapped(&from, &to, volume_fractions(&from, &shapes), method).expect("valid meshes");
    let error = shape_error(&to, &fractions[0], &volume_fractions(&to, &shapes)[0]);
    assert!(error <= 1e-8, "{error:e}");
}

#[test]
fn there_is_void_beyond_the_old_mesh() {
    let from: Mesh2 = unit_mesh(8, Distortion::None);
    let grid = Grid::new([9, 9], [false; 2]);
    let to = Mesh2::new(grid, Vector::repeat(-0.5), Vector::repeat(1.5), &random(0.2, 2)).expect("valid");
    let (fractions, _) =
        remapped(&from, &to, vec![vec![1.0; 64]], Reconstruction::default()).expect("valid meshes");
    assert!((material_volume(&to, &fractions[0]) - 1.0).abs() <= 1e-14);
    assert_eq!(fractions[0][0], 0.0);
}

#[test]
fn bad_fractions_are_refused() {
    let mesh: Mesh2 = unit_mesh(4, Distortion::None);
    let mut fractions = vec![vec![0.5; 16]];
    fractions[0][6] = f64::NAN;
    let error = remapped(&mesh, &mesh, fractions, Reconstruction::default()).expect_err("not a fraction");
    let RemapError::State(QuantityError::Fractions(of_cell)) = &error else { panic!("{error}") };
    assert!(matches!(of_cell, ReconstructionError::Cell { cell, .. } if cell == &[2, 1]), "{error}");
    let error = remapped(&mesh, &mesh, vec![vec![0.5; 15]], Reconstruction::default()).expect_err("too few");
    let length = ReconstructionError::Length { given: 15, cells: 16 };
    assert_eq!(error, RemapError::State(QuantityError::Fractions(length)));
    let (nothing, _) = remapped(&mesh, &mesh, Vec::new(), Reconstruction::default()).expect("nothing to do");
    assert!(nothing.is_empty());
}
