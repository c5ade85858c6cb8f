//! What fuzzing found, each under a name of its own.

mod common;

use common::{Random, corner};
use vofkit_geometry::clip::{Polyhedron, Region, Side};
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, PositionMethod, Quad, Vector};

fn length_of_the_normal_does_not_matter<const D: usize, C: Cell<D>>() {
    let mut random = Random(1);
    let skewed = |offset: [usize; D]| corner(offset) + Vector::<D>::repeat(0.2 * corner(offset)[0]);
    for cell in [random.cell(0.2), C::from_corners(corner), C::from_corners(skewed)] {
        let normal = random.unit::<D>();
        let exact = cell.truncate(&HalfSpace { normal, constant: 0.3 });
        for length in [1e-300, 1e-200, 1e-100, 1e100, 1e200, 1e300] {
            let half_space = HalfSpace { normal: normal * length, constant: 0.3 * length };
            let found = cell.truncate(&half_space);
            assert!((found.volume - exact.volume).abs() <= 4e-15, "{length:e}: {found:?} {exact:?}");
            let area = found.section_area * length;
            assert!((area - exact.section_area).abs() <= 1e-13, "{length:e}: {found:?} {exact:?}");
        }
        let subnormal = HalfSpace { normal: normal * 1e-319, constant: 0.0 };
        assert!(cell.truncate(&subnormal).volume.is_finite());
    }
}

/// The squares of the components of short normals underflowed, and the volume was NaN.
#[test]
fn short_and_long_normals_are_directions() {
    length_of_the_normal_does_not_matter::<3, Hexahedron>();
    length_of_the_normal_does_not_matter::<2, Quad>();
}

/// The heights of a face's corners were so small that their product underflowed, and the volume was NaN.
#[test]
fn face_that_is_in_the_plane_but_for_subnormal_heights() {
    let mut random = Random(2);
    for height in [1e-160, 1e-200, 1e-300, 5e-324] {
        for _ in 0..50 {
            let lift: [f64; 8] = std::array::from_fn(|_| height * random.within(-1.0, 1.0).round());
            let cell = Hexahedron::from_corners(|[i, j, k]| {
                let mut x = corner([i, j, k]);
                x[2] += if k == 0 { lift[i + 2 * j] } else { 0.05 * (i * j) as f64 };
                x
            });
            let half_space = HalfSpace { normal: Vector::<3>::new(height, 0.0, 1.0), constant: 0.0 };
            let below = cell.truncate(&half_space);
            let above = cell.truncate(&half_space.complement());
            assert!(below.volume.abs() <= 1e-15 && below.section_area.is_finite(), "{height:e}: {below:?}");
            assert!((above.volume - cell.volume()).abs() <= 2e-15, "{height:e}: {above:?}");
        }
    }
}

/// The heights of a strip's corners were subnormal, their inverse overflowed, and the volume was NaN.
#[test]
fn strip_of_subnormal_heights() {
    let cell = Hexahedron::from_corners(|[i, j, k]| {
        let stretch = if [i, j, k] == [1, 1, 0] { 0.225 } else { 0.0 };
        corner([i, j, k]) + Vector::<3>::new(0.0, stretch, 0.0)
    });
    let normal = Vector::<3>::new(5.432e-318, 5.5626846e-315, 1.0);
    let below = cell.truncate(&HalfSpace { normal, constant: 2.7814e-315 });
    assert!(below.volume.abs() <= 1e-15 && below.section_area.is_finite(), "{below:?}");
}

/// The inverse of a subnormal component of the normal overflowed in the closed form, and the volume was NaN.
#[test]
fn box_cut_by_a_plane_that_is_parallel_but_for_a_subnormal_component() {
    let cell = Hexahedron::from_corners(corner);
    let normal = Vector::<3>::new(5.43e-312, 6.0, 0.0);
    let below = cell.truncate(&HalfSpace { normal, constant: 2.05e-314 });
    assert!(below.volume.abs() <= 1e-15 && (below.section_area - 1.0 / 6.0).abs() <= 1e-15, "{below:?}");
}

/// The heights of a region's corners were subnormal and had no digits left, and the two parts did not add up to the whole.
#[test]
fn region_cut_along_a_subnormal_normal() {
    let nodes = [
        [-0.0796875, -0.0796875, -0.0796875],
        [0.9203125, -0.0796875, -0.0796875],
        [0.9203125, 0.90625, -0.0796875],
        [-0.0796875, 0.9203125, 0.20859375],
        [0.20859375, 0.20859375, 1.20859375],
        [1.20859375, 0.20859375, 0.96953125],
        [1.20859375, 1.20859375, 1.20859375],
        [0.20859375, 1.20859375, 1.1875],
    ];
    let middles = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1]];
    let whole = Polyhedron::fans(&nodes.map(Vector::from), &middles.map(corner::<3>));
    for length in [-9.11795066e-316, 1e-300, 1e-200] {
        let half_space = HalfSpace { normal: Vector::<3>::new(length, 0.0, 0.0), constant: 0.0 };
        let (mut below, mut above) = (Polyhedron::empty(), Polyhedron::empty());
        let sum = match whole.split(&half_space, &mut below, &mut above).expect("there is room") {
            Side::Across => below.volume() + above.volume(),
            _ => whole.volume(),
        };
        assert!((sum - whole.volume()).abs() <= 1e-14, "{length:e}: {sum} {}", whole.volume());
    }
}

/// Rounding gave the section at a corner a length below zero, and the plane for a part far below rounding lay at the next corner.
#[test]
fn a_part_of_a_quadrilateral_far_below_rounding() {
    let cell = Quad::new(
        [[0.440234375, 0.440234375], [1.0, 0.440234375], [1.0, 1.0], [0.5609375, 1.0]].map(Vector::from),
    );
    let mut random = Random(3);
    let normals = std::iter::repeat_with(|| random.unit::<2>()).take(100);
    for normal in normals.chain([Vector::<2>::new(-0.33325700406252073, 0.9428360245786501)]) {
        for fraction in [1e-15, 1e-100, 1e-300, 5e-324] {
            let found = cell.plane_constant(&normal, fraction, PositionMethod::Auto).expect("a plane");
            let constant = found.constant;
            let volume = cell.truncate(&HalfSpace { normal, constant }).volume;
            assert!(
                volume <= 1e-14 * cell.volume(),
                "{fraction:e} along {normal}: {found:?} leaves {volume:e}"
            );
        }
    }
}

/// A normal below the normal numbers was counted as none, and the plane constant was NaN.
#[test]
fn planes_along_normals_of_subnormal_length() {
    let nodes = [
        [0.14531249999999998, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0046875],
        [1.11484375, 0.0, 1.0],
        [1.0, 1.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    let cells =
        [Hexahedron::new(nodes.map(Vector::from)), Hexahedron::from_corners(|at| 1e-100 * corner(at))];
    let short = [
        Vector::<3>::new(1.55e-321, 1.265e-320, 0.0),
        Vector::<3>::new(0.0, -5e-324, 0.0),
        Vector::<3>::new(0.0, 1e-310, 1e-200),
    ];
    let methods = [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent];
    for (cell, normal) in cells.iter().flat_map(|cell| short.map(|normal| (cell, normal))) {
        let length = normal.amax();
        let (unit, extent) = (normal / length, cell.nodes()[6].amax());
        for (fraction, method) in
            [5e-324, 2.66225591934503e-310, 0.3, 1.0].into_iter().flat_map(|f| methods.map(|m| (f, m)))
        {
            let found = cell.plane_constant(&normal, fraction, method).expect("a plane");
            let exact = cell.plane_constant(&unit, fraction, method).expect("a plane");
            let allowed = 1e-14 * extent * length + f64::from_bits(8);
            let error = (found.constant - exact.constant * length).abs();
            assert!(error <= allowed, "{normal:?}, {fraction:e}: {found:?}, {exact:?}");
            let below = cell.truncate(&HalfSpace { normal, constant: found.constant });
            assert!(below.volume.is_finite() && below.section_area.is_finite(), "{below:?}");
        }
    }
}
