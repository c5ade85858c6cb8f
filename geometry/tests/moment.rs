//! First moments of truncated cells: the exact cases, and invariants on random cells.

mod common;

use common::{Random, at, box_volume, config, corner, golden, is_valid, range, valid_cell};
use proptest::prelude::*;
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, Quad, Vector};

/// Largest distance of a node from the first.
fn extent<const D: usize>(nodes: &[Vector<D>]) -> f64 {
    nodes.iter().map(|x| (x - nodes[0]).norm()).fold(0.0, f64::max)
}

/// The part of the cell's own volume times extent that a moment may be wrong by, besides the rounding of the moment
/// itself, `V |x|`, where the cell is far from the origin.
fn check_golden(bound: f64, wanted: impl Fn(&str) -> bool, volume: impl Fn(&common::Case) -> f64) {
    let mut largest = std::collections::BTreeMap::<&str, f64>::new();
    for case in golden().iter().filter(|case| wanted(case.category)) {
        let far = case.nodes.iter().map(|x| x.norm()).fold(0.0, f64::max);
        let cell_volume = volume(case);
        let rounding = 2.0 * f64::EPSILON * far * cell_volume;
        let error = (case.cell().first_moment(&case.half_space) - case.moment).amax();
        let excess = (error - rounding).max(0.0) / (cell_volume * extent(&case.nodes));
        assert!(excess <= bound, "{}: {error:e} beyond {rounding:e}", case.category);
        let largest = largest.entry(case.category).or_default();
        *largest = largest.max(error / (cell_volume * extent(&case.nodes)));
    }
    for (category, error) in largest {
        println!("{category:<28} error / (volume * extent) {error:8.1e}");
    }
}

#[test]
fn golden_cases() {
    check_golden(1e-15, is_valid, |case| case.cell_volume);
}

/// The terms of inverted cells and thin swept regions cancel: relative to the bounding box.
#[test]
fn golden_swept_regions_and_bow_ties() {
    check_golden(1e-14, |category| !is_valid(category), common::Case::box_volume);
}

/// A small part's centroid lies in the part: the moment about a node next to it keeps its relative accuracy.
#[test]
fn small_parts_keep_their_centroid() {
    let mut random = Random(31);
    for _ in 0..2000 {
        let cell: Hexahedron = random.cell(0.2);
        let normal = random.unit();
        let (low, high) = range(cell.nodes(), &normal);
        let depth = 10.0_f64.powf(random.within(-9.0, -2.0)) * (high - low);
        let half_space = HalfSpace { normal, constant: low + depth };
        let volume = cell.truncate(&half_space).volume;
        let lowest = cell.nodes().iter().min_by(|a, b| normal.dot(a).total_cmp(&normal.dot(b)));
        let lowest = lowest.expect("eight nodes");
        let height = normal.dot(&cell.first_moment_about(&half_space, lowest)) / volume;
        // At a corner the centroid is three quarters of the depth away from the plane, on an edge less.
        assert!(height >= 0.5 * depth * (1.0 - 1e-3) - 1e-15 && height <= depth, "{height:e} of {depth:e}");
    }
}

/// The moment of the corner of the unit square or cube below the plane through the points at `a` on each axis.
#[test]
fn corners_in_closed_form() {
    let plane = |a: f64| HalfSpace { normal: Vector::<2>::new(1.0, 1.0), constant: a };
    let square = Quad::from_corners(corner);
    let moment = square.first_moment(&plane(0.3));
    assert!((moment - Vector::<2>::repeat(0.3_f64.powi(3) / 6.0)).amax() <= 1e-17, "{moment:?}");
    let plane = HalfSpace { normal: Vector::<3>::repeat(1.0), constant: 0.3 };
    let moment = Hexahedron::from_corners(corner).first_moment(&plane);
    assert!((moment - Vector::<3>::repeat(0.3_f64.powi(4) / 24.0)).amax() <= 1e-17, "{moment:?}");
}

/// Twice the area and six times the moment of a triangle.
fn triangle(x: [Vector<2>; 3]) -> (f64, Vector<2>) {
    let double = (x[1] - x[0]).perp(&(x[2] - x[0]));
    (double, (x[0] + x[1] + x[2]) * double)
}

#[test]
fn triangles_in_closed_form() {
    let mut random = Random(32);
    for _ in 0..1000 {
        let x: [Vector<2>; 3] = std::array::from_fn(|_| random.vector(1.0));
        let normal: Vector<2> = random.unit();
        // The part with the first node: the triangle to the crossings of its edges.
        let heights = x.map(|x| x.dot(&normal));
        let constant = heights[0] + random.within(0.0, 1.0) * (heights[1].min(heights[2]) - heights[0]);
        if heights[0] >= heights[1].min(heights[2]) {
            continue;
        }
        let cut = |i: usize| x[0] + (x[i] - x[0]) * ((constant - heights[0]) / (heights[i] - heights[0]));
        let exact = triangle([x[0], cut(1), cut(2)]).1 / 6.0;
        for collapsed in [[0, 1, 2, 2], [0, 0, 1, 2], [0, 1, 1, 2]] {
            let cell = Quad::new(collapsed.map(|i| x[i]));
            let error = (cell.first_moment(&HalfSpace { normal, constant }) - exact).amax();
            assert!(error <= 2e-15, "{error:e}");
        }
    }
}

fn agrees<const D: usize>(found: Vector<D>, wanted: Vector<D>, allowed: f64, what: &str) {
    let error = (found - wanted).amax();
    assert!(error <= allowed, "{what}: {error:e} beyond {allowed:e}");
}

fn parts_sum_to_the_whole<const D: usize, C: Cell<D>>(cell: &C, plane: &HalfSpace<D>) {
    let about = cell.nodes()[0];
    let moment = |plane: &HalfSpace<D>| cell.first_moment_about(plane, &about);
    let everything = HalfSpace { normal: plane.normal, constant: f64::MAX };
    let scale = box_volume(cell.nodes()) * extent(cell.nodes());
    agrees(moment(plane) + moment(&plane.complement()), moment(&everything), 4e-15 * scale, "parts");
    // Cut along a surface of constant local coordinate.
    for axis in 0..D {
        let [near, far] = [cell.slab(2 * axis, 0.4), cell.slab(2 * axis + 1, 0.6)]
            .map(|slab| slab.first_moment_about(plane, &about));
        let rounded = 8.0 * f64::EPSILON * (about.norm() + extent(cell.nodes())) * surface(cell);
        agrees(near + far, moment(plane), 1e-14 * scale + rounded * extent(cell.nodes()), "slabs");
    }
}

fn surface<const D: usize, C: Cell<D>>(cell: &C) -> f64 {
    (0..C::FACES).map(|face| cell.face_area(face).norm()).sum()
}

/// `dM/dd` is the section's area times its centroid: the part of it along the normal is known, `A d`.
fn derivative_along_the_normal<const D: usize>(cell: &impl Cell<D>, normal: Vector<D>, part: f64) {
    let plane = at(cell.nodes(), normal, part);
    let (low, high) = range(cell.nodes(), &normal);
    let step = 1e-4 * (high - low);
    if cell.nodes().iter().any(|x| plane.height(x).abs() <= 30.0 * step) {
        return;
    }
    let about = cell.nodes()[0];
    let moment = |shift: f64| {
        let plane = HalfSpace { constant: plane.constant + shift, ..plane };
        normal.dot(&cell.first_moment_about(&plane, &about))
    };
    let difference =
        2.0 / 3.0 * (moment(step) - moment(-step)) - (moment(2.0 * step) - moment(-2.0 * step)) / 12.0;
    let area = cell.truncate(&plane).section_area;
    let exact = -plane.height(&about) * area * step;
    let scale = cell.volume() * extent(cell.nodes());
    let rounding = 16.0 * f64::EPSILON * about.norm() * area * extent(cell.nodes());
    assert!((difference - exact).abs() <= 1e-9 * scale + rounding, "{difference:e} {exact:e}");
}

/// The whole derivative, against the sampled section of one long polygon.
fn derivative_is_the_section(cell: &Hexahedron, normal: Vector<3>, part: f64) {
    let plane = at(cell.nodes(), normal, part);
    let step = 1e-3;
    if cell.nodes().iter().any(|x| plane.height(x).abs() <= 30.0 * step) {
        return;
    }
    let moment = |shift: f64| cell.first_moment(&HalfSpace { constant: plane.constant + shift, ..plane });
    let derivative = (moment(step) - moment(-step)) / (2.0 * step);
    let mut section = Vector::<3>::zeros();
    for points in cell.section(&plane) {
        for side in points[1..].windows(2) {
            let area = 0.5 * (side[0] - points[0]).cross(&(side[1] - points[0])).dot(&normal);
            section += (points[0] + side[0] + side[1]) * (area / 3.0);
        }
    }
    // Chords stay within 2e-3 of the diagonals.
    agrees(derivative, section, 1e-2, "section");
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn parts_and_derivatives(seed in any::<u64>(), part in 0.0..1.0_f64) {
        let cell: Hexahedron = valid_cell(seed);
        let normal = Random(!seed).unit();
        parts_sum_to_the_whole(&cell, &at(cell.nodes(), normal, part));
        derivative_along_the_normal(&cell, normal, part);
        derivative_is_the_section(&Random(seed).cell(0.2), normal, part);
        let cell: Quad = valid_cell(seed);
        let normal = Random(!seed).unit();
        parts_sum_to_the_whole(&cell, &at(cell.nodes(), normal, part));
        derivative_along_the_normal(&cell, normal, part);
    }

    #[test]
    fn moved_turned_scaled_and_relabelled(seed in any::<u64>(), part in 0.0..1.0_f64) {
        let mut random = Random(seed);
        let cell: Hexahedron = random.cell(0.2);
        let plane = at(cell.nodes(), random.unit(), part);
        let (moment, volume) = (cell.first_moment(&plane), cell.truncate(&plane).volume);
        let (shift, scale) = (random.vector::<3>(1.0), random.within(0.1, 10.0));
        let rotation = nalgebra::Rotation3::from_scaled_axis(random.unit::<3>() * random.within(0.0, 3.0));
        let image = |x: &Vector<3>| rotation * x * scale + shift;
        let moved = Hexahedron::new(std::array::from_fn(|i| image(&cell.nodes()[i])));
        let normal = rotation * plane.normal;
        let image_plane = HalfSpace { normal, constant: plane.constant * scale + normal.dot(&shift) };
        let exact = (rotation * moment * scale + shift * volume) * scale.powi(3);
        agrees(moved.first_moment(&image_plane), exact, 3e-14 * scale.powi(3) * (1.0 + scale), "image");
        // A third of a turn about the diagonal, and half a turn about an axis.
        for from in [|[i, j, k]: [usize; 3]| [j, k, i], |[i, j, k]: [usize; 3]| [1 - i, 1 - j, k]] {
            let turned = Hexahedron::from_corners(|offset| {
                let place = Hexahedron::OFFSETS.iter().position(|o| *o == from(offset));
                cell.nodes()[place.expect("an offset")]
            });
            agrees(turned.first_moment(&plane), moment, 1e-14, "relabelled");
        }

        let cell: Quad = random.cell(0.2);
        let plane = at(cell.nodes(), random.unit(), part);
        let (moment, volume) = (cell.first_moment(&plane), cell.truncate(&plane).volume);
        let (shift, turn) = (random.vector::<2>(1.0), nalgebra::Rotation2::new(random.within(0.0, 3.0)));
        let moved = Quad::new(std::array::from_fn(|i| turn * cell.nodes()[i] * scale + shift));
        let normal = turn * plane.normal;
        let image_plane = HalfSpace { normal, constant: plane.constant * scale + normal.dot(&shift) };
        let exact = (turn * moment * scale + shift * volume) * scale.powi(2);
        agrees(moved.first_moment(&image_plane), exact, 1e-14 * scale.powi(2) * (1.0 + scale), "image");
        let turned = Quad::new(std::array::from_fn(|i| cell.nodes()[(i + 1) % 4]));
        agrees(turned.first_moment(&plane), moment, 1e-14, "relabelled");
    }

    /// Whatever the nodes are: nothing is NaN, and the parts sum to the whole.
    #[test]
    fn any_finite_nodes(seed in any::<u64>(), grid in 1..4_i32) {
        let mut random = Random(seed);
        let size = f64::from(grid) + 0.5;
        let cell = Hexahedron::new(std::array::from_fn(|_| random.vector::<3>(size).map(f64::round)));
        let normal = corner([1, 0, 0]) + random.vector::<3>(1.5).map(f64::round) * 2.0;
        let plane = HalfSpace { normal, constant: random.within(-3.0, 3.0).round() };
        let parts = [plane, plane.complement()].map(|plane| cell.first_moment(&plane));
        let whole = cell.first_moment(&HalfSpace { normal, constant: f64::MAX });
        let scale = box_volume(cell.nodes()).max(1.0) * extent(cell.nodes()).max(1.0);
        agrees(parts[0] + parts[1], whole, 1e-13 * scale, "parts");
    }
}
