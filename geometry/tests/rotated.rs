//! Slivers and needles that are also rotated: exact cases of `rotated.csv` (see `python/rotated.py`), and quadrilaterals
//! against integers.

mod common;

use std::collections::BTreeMap;

use common::{Case, Errors, Random, rotated};
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, PositionMethod, Quad, Vector};

/// Prints errors per category and asserts a bound for all.
fn check(what: &str, bound: f64, error: impl Fn(&Case) -> f64) {
    let mut table: BTreeMap<&str, Errors> = BTreeMap::new();
    for case in &rotated() {
        table.entry(case.category).or_default().add(error(case));
    }
    for (category, errors) in &table {
        println!("{what}, {category}: {errors}");
    }
    for (category, errors) in &table {
        assert!(errors.largest <= bound, "{what}, {category}: {errors}");
    }
}

#[test]
fn cell_volume() {
    check("cell volume", 2e-15, |case| (case.cell().volume() - case.cell_volume).abs() / case.cell_volume);
}

#[test]
fn truncated_volume() {
    check("truncated volume", 2e-15, |case| {
        (case.cell().truncate(&case.half_space).volume - case.truncated_volume).abs() / case.cell_volume
    });
}

#[test]
fn section_area() {
    check("section area", 1e-14, |case| {
        let area = case.cell().truncate(&case.half_space).section_area;
        (area - case.section_area).abs() / case.section_area.max(case.cell_volume.powf(2.0 / 3.0))
    });
}

/// Plane constants are rounded numbers: the larger of rounding and of what that moves.
#[test]
fn position_returns_the_truncated_volume() {
    for method in [PositionMethod::Auto, PositionMethod::Brent] {
        check("round trip", 1e-14, |case| {
            let cell = case.cell();
            let fraction = case.truncated_volume / case.cell_volume;
            let position =
                cell.plane_constant(&case.half_space.normal, fraction, method).expect("a valid cell");
            let half_space = HalfSpace { constant: position.constant, ..case.half_space };
            let found = cell.truncate(&half_space);
            let error = (found.volume - case.truncated_volume).abs();
            let rounded = f64::EPSILON * position.constant.abs() * found.section_area;
            (error - rounded).max(0.0) / case.cell_volume
        });
    }
}

/// With the first node at the origin the plane constant is as small as the cell along the normal, and none of it is lost.
#[test]
fn position_with_a_local_constant() {
    let mut random = Random(41);
    for round in 0..2000 {
        let cell = turned(&mut random, 10.0_f64.powf(random_aspect(round)));
        let normal: Vector<3> = random.unit();
        for normal in [normal, cell.face_area(4).normalize(), cell.face_area(0).normalize()] {
            let fraction = random.within(0.0, 1.0);
            let position =
                cell.plane_constant(&normal, fraction, PositionMethod::Auto).expect("a valid cell");
            let found = cell.truncate(&HalfSpace { normal, constant: position.constant }).volume;
            let error = (found - fraction * cell.volume()).abs() / cell.volume();
            assert!(error <= 1e-14, "round {round}: {error:e}");
        }
    }
}

fn random_aspect(round: usize) -> f64 {
    -0.5 * (round % 17) as f64
}

/// A ruled cell with its first node at the origin, squeezed by `aspect` along one axis or two, in any direction.
fn turned(random: &mut Random, aspect: f64) -> Hexahedron {
    let cell: Hexahedron = random.cell(0.15);
    let middle = if random.within(0.0, 1.0) < 0.5 { aspect } else { 1.0 };
    let rotation = nalgebra::Rotation3::from_scaled_axis(random.unit::<3>() * random.within(0.0, 3.0));
    let squeezed = Vector::<3>::new(1.0, middle, aspect);
    let first = cell.nodes()[0];
    Hexahedron::new(std::array::from_fn(|i| rotation * (cell.nodes()[i] - first).component_mul(&squeezed)))
}

/// The parts add up, and the section is the same from both sides.
#[test]
fn parts_sum_to_the_whole() {
    let mut random = Random(42);
    for round in 0..2000 {
        let cell = turned(&mut random, 10.0_f64.powf(random_aspect(round)));
        let half_space = common::at(cell.nodes(), random.unit(), random.within(0.05, 0.95));
        let (below, above) = (cell.truncate(&half_space), cell.truncate(&half_space.complement()));
        let error = (below.volume + above.volume - cell.volume()).abs() / cell.volume();
        assert!(error <= 4e-15, "round {round}: {error:e}");
        let area = below.section_area;
        assert!((area - above.section_area).abs() <= 1e-12 * area.max(cell.volume().powf(2.0 / 3.0)));
    }
}

/// Twice the area of a quadrilateral with integer coordinates, and of its triangle `0 1 2`, exactly.
fn doubled_areas(x: &[[i64; 2]; 4]) -> [i128; 2] {
    let cross = |a: usize, b: usize| {
        let [u, v] = [a, b].map(|i| [0, 1].map(|axis| i128::from(x[i][axis] - x[0][axis])));
        u[0] * v[1] - u[1] * v[0]
    };
    [cross(1, 2) + cross(2, 3), cross(1, 2)]
}

/// Thin quadrilaterals along any direction. Nodes with integer coordinates have integer areas, and so has the part
/// beside a diagonal.
#[test]
fn rotated_quadrilaterals() {
    let mut random = Random(43);
    let mut errors = Errors::default();
    for round in 0..4000 {
        let size = 2.0_f64.powi(40);
        let (turn, aspect) = (random.within(0.0, 6.3), 10.0_f64.powf(-0.5 * (round % 17) as f64));
        let [along, across] =
            [Vector::<2>::new(turn.cos(), turn.sin()), Vector::<2>::new(-turn.sin(), turn.cos())];
        let shift: Vector<2> = random.vector(1.0);
        let cell: Quad = random.cell(0.15);
        let x: [[i64; 2]; 4] = std::array::from_fn(|i| {
            let y = cell.nodes()[i];
            let place = (along * y[0] + across * (y[1] * aspect) + shift) * size;
            [place[0].round() as i64, place[1].round() as i64]
        });
        let quad = Quad::new(x.map(|[a, b]| Vector::<2>::new(a as f64, b as f64)));
        let [whole, part] = doubled_areas(&x).map(|area| 0.5 * area as f64);
        if part <= 0.0 || part >= whole {
            continue;
        }
        errors.add((quad.volume() - whole).abs() / whole);
        // The outward normal of the diagonal as an edge of the triangle, and its plane constant: below 2^53 they are
        // integers too, or rounded at a place that moves the line by less than a digit of the area.
        let normal = Vector::<2>::new((x[0][1] - x[2][1]) as f64, (x[2][0] - x[0][0]) as f64);
        let constant = [0, 1].map(|axis| normal[axis] as i128 * i128::from(x[0][axis])).iter().sum::<i128>();
        let rounded = (constant - constant as f64 as i128).unsigned_abs() as f64;
        let found = quad.truncate(&HalfSpace { normal, constant: constant as f64 });
        // The diagonal splits off one triangle.
        let allowed = rounded * found.section_area * 1.01;
        errors.add(((found.volume - part).abs() - allowed).max(0.0) / whole);
        let position = quad.plane_constant(&normal, 0.3, PositionMethod::Auto).expect("a valid cell");
        let found = quad.truncate(&HalfSpace { normal, constant: position.constant });
        let allowed = f64::EPSILON * position.constant.abs() * found.section_area;
        errors.add(((found.volume - 0.3 * quad.volume()).abs() - allowed).max(0.0) / whole);
    }
    println!("quadrilaterals: {errors}");
    assert!(errors.largest <= 1e-14, "{errors}");
}
