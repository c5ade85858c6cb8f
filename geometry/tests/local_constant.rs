//! Plane constants relative to the first node of a cell: the inverse of truncation to rounding, wherever the cell lies.

mod common;

use common::{Errors, Random, golden, is_valid};
use vofkit_geometry::{
    Cell, HalfSpace, Hexahedron, PlaneConstant, PositionError, PositionMethod, Quad, Vector,
};

const METHODS: [PositionMethod; 3] = [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent];

/// What the plane leaves of a cell, as part of its volume.
fn part(cell: &Hexahedron, normal: &Vector<3>, position: &PlaneConstant) -> f64 {
    let half_space = HalfSpace { normal: *normal, constant: position.local_constant };
    cell.relative_to_first_node().truncate(&half_space).volume / cell.volume()
}

/// Places planes in all valid cells of the exact cases, and hands on what comes of it.
fn each(fractions: &[f64], mut check: impl FnMut(&Hexahedron, &Vector<3>, f64, PlaneConstant)) {
    for case in golden().iter().filter(|case| is_valid(case.category)) {
        let (cell, normal) = (case.cell(), case.half_space.normal);
        for method in METHODS {
            for &fraction in fractions {
                let position = cell
                    .plane_constant(&normal, fraction, method)
                    .unwrap_or_else(|error| panic!("{}, {method:?}, {fraction:e}: {error}", case.category));
                check(&cell, &normal, fraction, position);
            }
        }
    }
}

#[test]
fn the_exact_cases_give_their_fractions_back() {
    let fractions = [1e-14, 1e-12, 1e-9, 1e-6, 1e-3, 0.31, 0.5, 0.77, 0.999, 1.0 - 1e-9, 1.0 - 1e-14];
    let mut errors = Errors::default();
    each(&fractions, |cell, normal, fraction, position| {
        errors.add((part(cell, normal, &position) - fraction).abs());
    });
    println!("{errors}");
    assert!(errors.count == 23 * 80 * METHODS.len() * fractions.len() && errors.largest <= 1e-14, "{errors}");
}

#[test]
fn empty_and_full_cells_have_the_tangent_planes() {
    each(&[0.0, -0.0, 1.0], |cell, normal, fraction, position| {
        let heights = cell.nodes().iter().map(|x| normal.dot(&(x - cell.nodes()[0])));
        let sign = if fraction == 1.0 { 1.0 } else { -1.0 };
        let farthest = heights.clone().fold(f64::NEG_INFINITY, |far, height| far.max(sign * height));
        let scale = heights.fold(0.0, |scale: f64, height| scale.max(height.abs()));
        let error = (sign * position.local_constant - farthest).abs() / scale;
        assert!(error <= 1e-14 && position.residual == 0.0, "{fraction}: {position:?} is off by {error:e}");
        assert!((part(cell, normal, &position) - fraction).abs() <= 1e-14);
    });
}

/// Down to the smallest number there is, and up to the last one below 1.
#[test]
fn the_last_digits_before_the_ends_have_a_plane() {
    let fractions =
        [0.0_f64.next_up(), f64::MIN_POSITIVE, 1e-100, 1e-16, 1e-15, 1.0 - 1e-15, 1.0_f64.next_down()];
    let mut errors = Errors::default();
    each(&fractions, |cell, normal, fraction, position| {
        assert!(
            position.constant.is_finite() && position.residual.abs() <= 1e-15,
            "{fraction:e}: {position:?}"
        );
        let found = part(cell, normal, &position);
        assert!((-1e-15..=1.0 + 1e-15).contains(&found), "{fraction:e}: {found:e}");
        errors.add((found - fraction).abs());
    });
    println!("{errors}");
    assert!(errors.largest <= 2e-15, "{errors}");
}

fn no_plane_beyond_the_ends<const D: usize, C: Cell<D>>() {
    let mut random = Random(51);
    for (cell, normal) in [(random.cell::<D, C>(0.0), random.unit()), (random.cell(0.2), random.unit())] {
        for fraction in [0.0_f64.next_down(), -1e-15, -1.0, 1.0_f64.next_up(), f64::NAN, f64::NEG_INFINITY] {
            for method in METHODS {
                let found = cell.plane_constant(&normal, fraction, method);
                let is_it = |named: f64| named.to_bits() == fraction.to_bits();
                assert!(matches!(found, Err(PositionError::Fraction(named)) if is_it(named)), "{found:?}");
            }
        }
    }
}

#[test]
fn no_plane_beyond_the_ends_of_both_cells() {
    no_plane_beyond_the_ends::<2, Quad>();
    no_plane_beyond_the_ends::<3, Hexahedron>();
}

/// Nodes with few digits are moved without rounding, and nothing of the local constant may change but rounding.
fn a_shift_does_not_matter<const D: usize, C: Cell<D>>() {
    let mut random = Random(52);
    let unit = 2.0_f64.powi(-20);
    for round in 0..500 {
        let cell: C = random.cell(if round % 4 == 0 { 0.0 } else { 0.2 });
        let shift = random.vector::<D>(1e9).map(f64::round);
        let [near, far] = [Vector::zeros(), shift].map(|shift| {
            C::from_corners(|offset| {
                let place = C::OFFSETS.iter().position(|known| *known == offset).expect("an offset");
                cell.nodes()[place].map(|x| (x / unit).round() * unit) + shift
            })
        });
        let (normal, fraction) = (random.unit(), random.within(0.0, 1.0));
        for method in METHODS {
            let [near, far] = [&near, &far].map(|cell| {
                cell.plane_constant(&normal, fraction, method).expect("a valid cell").local_constant
            });
            assert!((near - far).abs() <= 2e-15, "{near} {far}");
        }
    }
}

#[test]
fn a_shift_of_both_cells_does_not_matter() {
    a_shift_does_not_matter::<2, Quad>();
    a_shift_does_not_matter::<3, Hexahedron>();
}
