//! The inverse of truncation: what it costs, and what it says when there is no answer.

mod common;

use common::{Random, corner};
use proptest::prelude::*;
use vofkit_geometry::parallelepiped::UnitCube;
use vofkit_geometry::{
    Cell, HalfSpace, Hexahedron, PlaneConstant, PositionError, PositionMethod, Quad, Vector, Wanted,
};

const SAMPLES: usize = 2000;

/// Mean and largest number of evaluations, on ruled hexahedra with fractions between 0.001 and 0.999.
fn evaluations(method: PositionMethod) -> (f64, usize) {
    let mut random = Random(7);
    let counts: Vec<usize> = (0..SAMPLES)
        .map(|_| {
            let cell: Hexahedron = random.cell(0.15);
            let normal = random.unit();
            let fraction = random.within(0.001, 0.999);
            cell.plane_constant(&normal, fraction, method).expect("a valid cell").evaluations
        })
        .collect();
    (counts.iter().sum::<usize>() as f64 / SAMPLES as f64, counts.into_iter().max().unwrap_or(0))
}

#[test]
fn evaluations_on_ruled_cells() {
    for (method, mean_allowed, most_allowed) in
        [(PositionMethod::Auto, 3.2, 8), (PositionMethod::Newton, 3.2, 8), (PositionMethod::Brent, 11.0, 20)]
    {
        let (mean, most) = evaluations(method);
        println!("{method:?}: mean {mean:.2}, most {most}");
        assert!(mean <= mean_allowed && most <= most_allowed, "{method:?}: mean {mean}, most {most}");
    }
}

/// Bits of what a plane constant is, or of why there is none: numbers compare as they are printed, NaN with NaN.
fn told(found: &Result<PlaneConstant, PositionError>) -> String {
    format!("{found:?}")
}

/// Ruled cells, boxes, folded and inverted cells, slivers far away, with fractions that are usual, extreme or none.
fn any_wanted() -> impl Strategy<Value = Wanted<Hexahedron, 3>> {
    let fraction = prop_oneof![
        4 => 0.0..1.0,
        1 => prop::sample::select(vec![0.0, 1.0, 0.5, -0.1, 1.5, f64::NAN, 5e-324, 1e-300, 1e-15, 1.0 - 1e-15]),
    ];
    let (amplitude, thickness) = (prop::sample::select(vec![0.0, 1e-9, 0.15, 0.3, 1.2]), 0..4_i32);
    (any::<u64>(), amplitude, thickness, fraction).prop_map(|(seed, amplitude, thickness, fraction)| {
        let mut random = Random(seed);
        let (cell, normal, turn) =
            (random.cell::<3, Hexahedron>(amplitude), random.unit(), random.unit::<3>());
        let scale = Vector::<3>::new(1.0, 1.0, 0.01_f64.powi(thickness));
        let rotation = nalgebra::Rotation3::new(turn);
        let place = |x: &Vector<3>| rotation * x.component_mul(&scale) + turn * 10.0_f64.powi(thickness);
        let cell = Hexahedron::new(std::array::from_fn(|i| place(&cell.nodes()[i])));
        Wanted { cell, normal, fraction }
    })
}

proptest! {
    #![proptest_config(common::config())]

    /// Each result of a batch is to the bit that of the cell alone, whatever the batch's size and the cell's place in it.
    #[test]
    fn a_batch_gives_what_its_cells_give_alone(
        wanted in prop::collection::vec(any_wanted(), 0..40),
        first in 0_usize..8,
        brent in prop::bool::weighted(0.1),
    ) {
        let method = if brent { PositionMethod::Brent } else { PositionMethod::Auto };
        let alone: Vec<String> = wanted
            .iter()
            .map(|Wanted { cell, normal, fraction }| told(&cell.plane_constant(normal, *fraction, method)))
            .collect();
        for skipped in [0, first.min(wanted.len())] {
            let mut batch = vec![None; wanted.len() - skipped];
            Hexahedron::plane_constants(&wanted[skipped..], method, |i, found| {
                assert!(batch[i].replace(told(&found)).is_none(), "told twice");
            });
            for (alone, batch) in alone[skipped..].iter().zip(batch) {
                prop_assert_eq!(Some(alone.clone()), batch);
            }
        }
    }
}

#[test]
fn newton_and_brent_agree() {
    let mut random = Random(8);
    for _ in 0..SAMPLES {
        let cell: Hexahedron = random.cell(0.3);
        let normal = random.unit();
        let fraction = random.within(0.01, 0.99);
        let [newton, brent] = [PositionMethod::Newton, PositionMethod::Brent]
            .map(|method| cell.plane_constant(&normal, fraction, method).expect("a valid cell").constant);
        assert!((newton - brent).abs() <= 1e-13, "{newton} {brent}");
    }
}

#[test]
fn closed_forms_are_used_where_they_exist() {
    let mut random = Random(9);
    let quad: Quad = random.cell(0.2);
    let position = quad.plane_constant(&random.unit(), 0.3, PositionMethod::Auto);
    assert!(position.is_ok_and(|position| position.closed_form));
    let shape = nalgebra::Matrix3::new(1.0, 0.2, 0.1, 0.0, 0.9, 0.3, 0.2, 0.0, 1.1);
    let cell = Hexahedron::from_corners(|offset| shape * corner(offset));
    let position = cell.plane_constant(&random.unit(), 0.3, PositionMethod::Auto);
    assert!(cell.is_affine() && position.is_ok_and(|position| position.closed_form));
    // The one evaluation is that of the residual.
    assert_eq!(position.map(|position| position.evaluations), Ok(1));
}

/// Also where components of the direction are equal, nearly equal or negligible, or one is the sum of the others.
#[test]
fn cubes_are_cut_and_filled_in_closed_form() {
    let mut random = Random(11);
    let mut worst = 0.0_f64;
    for sample in 0..20 * SAMPLES {
        let mut magnitude = || 10.0_f64.powf(random.within(-18.0, 0.0));
        let near = 1.0 + if sample % 2 == 0 { 0.0 } else { 1e-3 * magnitude() };
        let [a, b] = [magnitude(), if sample % 3 == 0 { 1.0 } else { magnitude() }];
        let m = match sample % 7 {
            0 => [a, near * a, b],
            1 => [a, b, a + near * b],
            2 => [0.0, a, b],
            3 => [a, near, 1.0],
            _ => random.unit::<3>().into(),
        };
        let cube = UnitCube::new(&m);
        let fraction = random.within(0.0, 1.0);
        let depth = cube.position(fraction);
        let volume = cube.volume(depth);
        // The depth is rounded, and so is its distance from the nearer corner.
        let error = (volume.value - fraction).abs() / (1.0 + volume.derivative * cube.span());
        worst = if error <= worst { worst } else { error };
        assert!(error <= 1e-15, "{m:?}, {fraction}: {depth}, off by {error:e}");
    }
    println!("largest error {worst:.1e}");
}

fn errors_are_typed<const D: usize, C: Cell<D>>(inverted: &C) {
    let cell = C::from_corners(corner);
    let normal = Vector::<D>::repeat(1.0);
    let find = |cell: &C, normal: Vector<D>, fraction: f64| {
        [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent].map(|method| {
            let error = cell.plane_constant(&normal, fraction, method).expect_err("there is no answer");
            assert!(!error.to_string().is_empty());
            error
        })
    };
    for fraction in [f64::NAN, -0.1, 1.1, f64::INFINITY] {
        assert!(find(&cell, normal, fraction).iter().all(|e| matches!(e, PositionError::Fraction(_))));
    }
    for bad in [0.0, f64::NAN, f64::INFINITY] {
        assert_eq!(find(&cell, Vector::<D>::repeat(bad), 0.5), [PositionError::Normal; 3]);
    }
    let is_volume = |e: &PositionError| matches!(e, PositionError::Volume(volume) if *volume <= 0.0);
    assert!(find(inverted, normal, 0.5).iter().all(is_volume));
    assert!(find(&C::from_corners(|_| normal), normal, 0.5).iter().all(is_volume));
}

#[test]
fn errors_of_both_cells_are_typed() {
    let mirrored = |x: Vector<3>| Vector::<3>::new(-x[0], x[1], x[2]);
    errors_are_typed(&Hexahedron::from_corners(|offset| mirrored(corner(offset))));
    errors_are_typed(&Quad::from_corners(|[i, j]| corner([j, i])));
}

/// A cell whose volume is positive but not monotone along the normal has no position for some fractions; what
/// is returned for the others gives the volume asked for.
#[test]
fn folded_cells_fail_with_numbers_or_succeed() {
    let mut random = Random(10);
    let mut failed = 0;
    for _ in 0..SAMPLES {
        let cell: Hexahedron = random.cell(1.2);
        let normal = random.unit();
        match cell.plane_constant(&normal, random.within(0.0, 1.0), PositionMethod::Auto) {
            Ok(position) => assert!(position.constant.is_finite() && position.residual.abs() <= 1e-12),
            Err(PositionError::Volume(volume)) => assert!(volume <= 0.0),
            Err(PositionError::NoConvergence { residual, evaluations }) => {
                failed += 1;
                assert!(!residual.is_nan() && evaluations > 0);
            }
            Err(error) => panic!("{error}"),
        }
    }
    println!("{failed} of {SAMPLES} folded cells without a position");
}

/// Cells on a warped surface, far thinner than it is warped, have a length scale alone as frame: what is above and below the plane
/// is known to the rounding of the extent, about 1 here, and not of the cell's own volume.
#[test]
fn thin_warped_cells_have_a_position() {
    let mut random = Random(12);
    let mut worst = 0.0_f64;
    for thickness in (1..=12).map(|exponent| 10.0_f64.powi(-exponent)) {
        let mut cells = 0;
        while cells < 200 {
            let base: [Vector<3>; 4] = std::array::from_fn(|_| random.vector(0.4));
            let up: [Vector<3>; 4] =
                std::array::from_fn(|_| Vector::<3>::new(0.0, 0.0, 1.0) + random.vector::<3>(0.3));
            let cell = Hexahedron::from_corners(|[i, j, k]| {
                corner([i, j, 0]) + base[i + 2 * j] + up[i + 2 * j] * (thickness * k as f64)
            });
            if cell.defects().iter().any(|defect| defect.is_error()) {
                continue;
            }
            cells += 1;
            let normal = if cells % 2 == 0 { random.unit() } else { cell.face_area(5).normalize() };
            let fraction = random.within(0.0, 1.0);
            for method in [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent] {
                let position = cell
                    .plane_constant(&normal, fraction, method)
                    .unwrap_or_else(|error| panic!("{method:?}, {thickness:e} thick: {error}"));
                let found = cell.truncate(&HalfSpace { normal, constant: position.constant }).volume;
                let error = (found - fraction * cell.volume()).abs();
                worst = if error <= worst { worst } else { error };
                assert!(error <= 2e-15, "{method:?}, {thickness:e} thick: {error:e}, {position:?}");
            }
        }
    }
    println!("largest error {worst:.1e}");
}

/// Parts below the least normal number have few digits or none, and their planes are found as fast as others.
#[test]
fn denormal_fractions_take_no_more_evaluations_than_others() {
    let mut random = Random(21);
    for k in 0..SAMPLES {
        let cell: Hexahedron = random.cell(if k % 2 == 0 { 0.2 } else { 0.0 });
        let normal = random.unit();
        for fraction in [1e-300, f64::MIN_POSITIVE, 1e-310, 1e-318, 1e-319, 1e-320, 5e-323, 5e-324] {
            for method in [PositionMethod::Auto, PositionMethod::Newton] {
                let position = cell.plane_constant(&normal, fraction, method).expect("a valid cell");
                let enough = position.evaluations <= 16 && position.residual.abs() <= 1e-300;
                assert!(enough, "{fraction:e}, {method:?}: {position:?}");
            }
        }
    }
}
