//! The centroid of a section: closed forms, finely sampled sections, the derivative of the first moment, symmetries.

mod common;

use common::{Random, at, config, corner, golden, is_valid, range, rotated, valid_cell};
use proptest::prelude::*;
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, Quad, Vector};

fn extent<const D: usize>(nodes: &[Vector<D>]) -> f64 {
    nodes.iter().map(|x| (x - nodes[0]).norm()).fold(0.0, f64::max)
}

#[test]
fn closed_forms() {
    let square: Quad = Quad::from_corners(corner);
    let line = |constant| HalfSpace { normal: Vector::<2>::new(0.6, 0.8), constant };
    let middle = square.section_centroid(&line(0.7)).expect("a section");
    // From (1, 0.125) to (0, 0.875).
    assert!((middle - Vector::<2>::new(0.5, 0.5)).amax() <= 1e-15, "{middle:?}");
    assert_eq!(square.section_centroid(&line(-0.1)), None);
    assert_eq!(square.section_centroid(&line(1.5)), None);
    let cube: Hexahedron = Hexahedron::from_corners(corner);
    for a in [1e-9, 0.3, 1.0] {
        // A triangle, seen from either side.
        let plane = HalfSpace { normal: Vector::<3>::repeat(1.0), constant: a };
        for plane in [plane, plane.complement()] {
            let middle = cube.section_centroid(&plane).expect("a section");
            assert!((middle - Vector::<3>::repeat(a / 3.0)).amax() <= 1e-15, "{middle:?}");
        }
    }
    let touching = HalfSpace { normal: Vector::<3>::repeat(1.0), constant: 0.0 };
    assert_eq!(cube.section_centroid(&touching), None);
}

/// Two corners of the top face lifted: two loops with the same area, and the centroid between them.
#[test]
fn several_loops_count_together() {
    let cell = Hexahedron::from_corners(|offset| {
        let lift = if matches!(offset, [0, 0, 1] | [1, 1, 1]) { 0.5 } else { 0.0 };
        corner(offset) + Vector::<3>::new(0.0, 0.0, lift)
    });
    let plane = HalfSpace { normal: Vector::<3>::new(0.0, 0.0, 1.0), constant: 1.4 };
    let middle = cell.section_centroid(&plane).expect("a section");
    assert!((middle - Vector::<3>::new(0.5, 0.5, 1.4)).amax() <= 1e-14, "{middle:?}");
}

/// Area and first moment of the section from the sampled loops of the cell's pieces: a piece of a ruled face is ruled
/// too, and has shorter chords.
fn sampled(cell: &Hexahedron, plane: &HalfSpace<3>, parts: usize) -> (f64, Vector<3>) {
    let (mut area, mut first) = (0.0, Vector::<3>::zeros());
    let place = |i: usize, offset: usize| (i + offset) as f64 / parts as f64;
    for (i, j, k) in (0..parts).flat_map(|i| (0..parts).flat_map(move |j| (0..parts).map(move |k| (i, j, k))))
    {
        let piece = Hexahedron::from_corners(|[a, b, c]| {
            cell.map(&Vector::<3>::new(place(i, a), place(j, b), place(k, c)))
        });
        for points in piece.section(plane) {
            for side in points[1..].windows(2) {
                let part = 0.5 * (side[0] - points[0]).cross(&(side[1] - points[0])).dot(&plane.normal);
                area += part;
                first += (points[0] + side[0] + side[1]) * (part / 3.0);
            }
        }
    }
    (area, first)
}

#[test]
fn finely_sampled_sections() {
    let mut random = Random(51);
    for _ in 0..40 {
        let cell: Hexahedron = random.cell(0.3);
        let plane = at(cell.nodes(), random.unit(), random.within(0.1, 0.9));
        let Some(found) = cell.section_centroid(&plane) else { continue };
        let (area, first) = sampled(&cell, &plane, 12);
        let error = (found * area - first).amax();
        assert!(error <= 1e-4, "{error:e}");
    }
}

/// `dM/dd = A c` for the first moment about any point.
fn derivative_of_the_moment<const D: usize>(cell: &impl Cell<D>, normal: Vector<D>, part: f64) {
    let plane = at(cell.nodes(), normal, part);
    let (low, high) = range(cell.nodes(), &normal);
    let step = 1e-3 * (high - low);
    let Some(centroid) = cell.section_centroid(&plane) else { return };
    if cell.nodes().iter().any(|x| plane.height(x).abs() <= 100.0 * step) {
        return;
    }
    let about = cell.nodes()[0];
    let moment = |shift: f64| {
        cell.first_moment_about(&HalfSpace { constant: plane.constant + shift, ..plane }, &about)
    };
    let difference =
        (moment(step) - moment(-step)) * (2.0 / 3.0) - (moment(2.0 * step) - moment(-2.0 * step)) / 12.0;
    let exact = (centroid - about) * (cell.truncate(&plane).section_area * step);
    let scale = cell.volume() * extent(cell.nodes());
    let rounding =
        16.0 * f64::EPSILON * about.norm() * cell.truncate(&plane).section_area * extent(cell.nodes());
    let error = (difference - exact).amax();
    assert!(error <= 1e-9 * scale + rounding, "{error:e} of {scale:e}");
}

fn lies_in_the_plane_and_is_seen_from_both_sides<const D: usize>(cell: &impl Cell<D>, plane: &HalfSpace<D>) {
    let both = [*plane, plane.complement()].map(|plane| cell.section_centroid(&plane));
    let [Some(from_below), Some(from_above)] = both else { return };
    let size = extent(cell.nodes());
    let far = 8.0 * f64::EPSILON * (cell.nodes()[0].norm() + size) * plane.normal.norm();
    assert!(plane.height(&from_below).abs() <= far, "{:e}", plane.height(&from_below));
    // What rounding of the plane does to a section that is a short piece of a long edge.
    let area = cell.truncate(plane).section_area;
    let relative = area / (cell.volume() / size);
    let error = (from_below - from_above).amax() * relative.min(1.0);
    assert!(error <= 1e-11 * size + far, "{error:e} of {size:e}");
}

#[test]
fn exact_cases() {
    for case in golden().iter().filter(|case| is_valid(case.category)).chain(&rotated()) {
        lies_in_the_plane_and_is_seen_from_both_sides(&case.cell(), &case.half_space);
    }
}

/// One cell cut into two by a surface of constant local coordinate: areas times centroids add up.
fn parts_add_up<const D: usize, C: Cell<D>>(cell: &C, plane: &HalfSpace<D>) {
    let moment = |cell: &C| {
        let area = cell.truncate(plane).section_area;
        cell.section_centroid(plane).map_or(Vector::<D>::zeros(), |c| (c - cell.nodes()[0]) * area)
            + cell.nodes()[0] * area
    };
    for axis in 0..D {
        let [near, far] = [cell.slab(2 * axis, 0.4), cell.slab(2 * axis + 1, 0.6)].map(|slab| moment(&slab));
        let error = (near + far - moment(cell)).amax();
        assert!(error <= 1e-12, "{error:e}");
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn invariants(seed in any::<u64>(), part in 0.0..1.0_f64) {
        let normal = Random(!seed).unit();
        let cell: Hexahedron = valid_cell(seed);
        derivative_of_the_moment(&cell, normal, part);
        lies_in_the_plane_and_is_seen_from_both_sides(&cell, &at(cell.nodes(), normal, part));
        let cell: Hexahedron = Random(seed).cell(0.2);
        parts_add_up(&cell, &at(cell.nodes(), normal, part));
        let normal = Random(!seed).unit();
        let cell: Quad = valid_cell(seed);
        derivative_of_the_moment(&cell, normal, part);
        lies_in_the_plane_and_is_seen_from_both_sides(&cell, &at(cell.nodes(), normal, part));
        let cell: Quad = Random(seed).cell(0.2);
        parts_add_up(&cell, &at(cell.nodes(), normal, part));
    }

    /// In the plane the centroid is the middle of the segment that is drawn.
    #[test]
    fn middles_of_segments(seed in any::<u64>(), part in 0.05..0.95_f64) {
        let cell: Quad = Random(seed).cell(0.2);
        let plane = at(cell.nodes(), Random(!seed).unit(), part);
        let segments = cell.section(&plane);
        let length: f64 = segments.iter().map(|ends| (ends[1] - ends[0]).norm()).sum();
        let sum: Vector<2> =
            segments.iter().map(|ends| (ends[0] + ends[1]) * (0.5 * (ends[1] - ends[0]).norm())).sum();
        let found = cell.section_centroid(&plane).expect("a section");
        prop_assert!((found * length - sum).amax() <= 1e-14);
    }
}
