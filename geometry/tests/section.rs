//! The section of a cell with a plane: area, orientation, closedness, and the same bits in both cells of a face.

mod common;

use std::collections::HashMap;

use common::{Random, corner, golden, is_valid};
use vofkit_geometry::section::area_vector;
use vofkit_geometry::tolerance::SECTION_CHORD;
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, Quad, Vector};

type Bits = [u64; 3];

fn diameter<const D: usize>(nodes: &[Vector<D>]) -> f64 {
    let distances = nodes.iter().flat_map(|a| nodes.iter().map(move |b| (a - b).norm()));
    distances.fold(0.0, f64::max)
}

fn perimeter(points: &[Vector<3>]) -> f64 {
    sides(points).map(|(a, b)| (b - a).norm()).sum()
}

fn sides<const D: usize>(points: &[Vector<D>]) -> impl Iterator<Item = (Vector<D>, Vector<D>)> + '_ {
    (0..points.len()).map(|i| (points[i], points[(i + 1) % points.len()]))
}

fn bits(x: Vector<3>) -> Bits {
    // Zero has two representations.
    std::array::from_fn(|i| (x[i] + 0.0).to_bits())
}

#[test]
fn area_and_orientation_of_golden_cases() {
    let mut loops_seen = 0;
    for case in golden().iter().filter(|case| is_valid(case.category)) {
        let sections = case.cell().section(&case.half_space);
        // A whole face in the plane has no section of its own.
        if case.category == "axis_normal_cube_on_face" {
            continue;
        }
        let normal = case.half_space.normal;
        let size = diameter(&case.nodes);
        let offset = case.nodes[0].norm() * f64::EPSILON * 8.0;
        let total: Vector<3> = sections.iter().map(|points| area_vector(points)).sum();
        let around: f64 = sections.iter().map(|points| perimeter(points)).sum();
        let allowed = (SECTION_CHORD * size + offset) * around + 1e-12 * size * size;
        let error = (total.dot(&normal) - case.section_area).abs();
        assert!(
            error <= allowed,
            "{}: {error:e} of {:e}, allowed {allowed:e}",
            case.category,
            case.section_area
        );
        for points in &sections {
            loops_seen += 1;
            let area = area_vector(points);
            let across = area - normal * area.dot(&normal);
            assert!(across.norm() <= 1e-12 * size * size + offset * perimeter(points), "{}", case.category);
            assert!(area.dot(&normal) >= -offset * size - 1e-12 * size * size, "{}", case.category);
            for x in points {
                let height = case.half_space.height(x).abs();
                assert!(height <= 1e-12 * size + offset, "{}: {height:e}", case.category);
            }
        }
    }
    assert!(loops_seen > 1000, "{loops_seen}");
}

#[test]
fn planar_faces_have_straight_edges() {
    let mut random = Random(1);
    for _ in 0..200 {
        let shape = nalgebra::Matrix3::from_fn(|_, _| random.within(-1.0, 1.0));
        let cell = Hexahedron::from_corners(|offset| shape * corner(offset));
        if cell.volume() <= 0.01 {
            continue;
        }
        let half_space = HalfSpace { normal: random.unit(), constant: random.within(0.0, 1.0) };
        for points in cell.section(&half_space) {
            assert!(points.len() <= 6, "{points:?}");
        }
    }
    // A frustum: planar faces that are no parallelograms.
    let frustum = Hexahedron::from_corners(|offset| {
        let x = corner(offset);
        let scale = 1.0 - 0.5 * x[2];
        Vector::<3>::new((x[0] - 0.5) * scale, (x[1] - 0.5) * scale, x[2])
    });
    let tilted = HalfSpace { normal: Vector::<3>::new(1.0, 2.0, 2.0) / 3.0, constant: 0.4 };
    let section = frustum.section(&tilted);
    assert!(section.len() == 1 && section[0].len() <= 6, "{section:?}");
}

#[test]
fn curved_edges_keep_the_chord_error() {
    let mut random = Random(2);
    for _ in 0..300 {
        let cell: Hexahedron = random.cell(0.3);
        let half_space = HalfSpace { normal: random.unit(), constant: random.within(-0.5, 1.0) };
        let total: Vector<3> = cell.section(&half_space).iter().map(|points| area_vector(points)).sum();
        let around: f64 = cell.section(&half_space).iter().map(|points| perimeter(points)).sum();
        let exact = cell.truncate(&half_space).section_area;
        let error = (total.dot(&half_space.normal) - exact).abs();
        let allowed = SECTION_CHORD * diameter(cell.nodes()) * around;
        assert!(error <= allowed, "{error:e} of {exact:e}, allowed {allowed:e}");
    }
}

#[test]
fn one_plane_through_a_distorted_mesh_is_watertight() {
    const N: usize = 3;
    let mut random = Random(3);
    for round in 0..60 {
        let mut shift = HashMap::new();
        for k in 0..=N {
            for j in 0..=N {
                for i in 0..=N {
                    // Some rounds leave nodes of the regular mesh exactly in the plane.
                    let size = if round % 3 == 0 { 0.0 } else { 0.3 };
                    shift.insert([i, j, k], random.vector::<3>(size));
                }
            }
        }
        let half_space = match round % 6 {
            0 => HalfSpace { normal: Vector::<3>::new(0.0, 0.0, 1.0), constant: 1.0 },
            3 => HalfSpace { normal: Vector::<3>::new(1.0, 1.0, 1.0), constant: 4.0 },
            _ => HalfSpace { normal: random.unit(), constant: random.within(0.0, 1.5) },
        };
        let mut open: HashMap<(Bits, Bits), i32> = HashMap::new();
        for k in 0..N {
            for j in 0..N {
                for i in 0..N {
                    let cell = Hexahedron::from_corners(|[a, b, c]| {
                        let place = [i + a, j + b, k + c];
                        corner(place) + shift[&place]
                    });
                    for points in cell.section(&half_space) {
                        for (a, b) in sides(&points) {
                            *open.entry((bits(a), bits(b))).or_default() += 1;
                            *open.entry((bits(b), bits(a))).or_default() -= 1;
                        }
                    }
                }
            }
        }
        // What is left open lies on the boundary of the mesh: with the shifts that means within 0.3 of it.
        for ((a, _), _) in open.iter().filter(|(_, count)| **count != 0) {
            let x = Vector::<3>::from(a.map(f64::from_bits));
            let inside = x.iter().all(|&c| c > 0.3 && c < N as f64 - 0.3);
            assert!(!inside, "round {round}: open at {x:?}");
        }
    }
}

#[test]
fn saddles_and_separate_parts_give_several_loops() {
    // The plane cuts off two opposite corners of the top face, which are lifted.
    let cell = Hexahedron::from_corners(|offset| {
        let lift = if matches!(offset, [0, 0, 1] | [1, 1, 1]) { 0.5 } else { 0.0 };
        corner(offset) + Vector::<3>::new(0.0, 0.0, lift)
    });
    let up = |constant| HalfSpace { normal: Vector::<3>::new(0.0, 0.0, 1.0), constant };
    assert_eq!(cell.section(&up(1.4)).len(), 2);
    assert_eq!(cell.section(&up(0.9)).len(), 1);
    assert_eq!(cell.section(&up(-0.1)).len(), 0);
    let exact = cell.truncate(&up(1.4)).section_area;
    let sampled: f64 = cell.section(&up(1.4)).iter().map(|points| area_vector(points)[2]).sum();
    assert!((sampled - exact).abs() <= SECTION_CHORD && sampled > 0.0, "{sampled} {exact}");
}

#[test]
fn sections_of_quads_have_the_material_on_their_left() {
    let mut random = Random(4);
    for round in 0..500 {
        let mut cell: Quad = random.cell(0.3);
        if round % 2 == 0 {
            // Simple, but not convex.
            let mut nodes = [0, 1, 2, 3].map(|i| cell.nodes()[i]);
            nodes[2] = nodes[0] + (nodes[2] - nodes[0]) * 0.25;
            cell = Quad::new(nodes);
        }
        let half_space = HalfSpace { normal: random.unit(), constant: random.within(-0.5, 1.0) };
        let segments = cell.section(&half_space);
        let length: f64 = segments.iter().map(|ends| (ends[1] - ends[0]).norm()).sum();
        let exact = cell.truncate(&half_space).section_area;
        assert!((length - exact).abs() <= 1e-13, "{length} {exact}");
        for ends in segments {
            let direction = (ends[1] - ends[0]).normalize();
            let outward = Vector::<2>::new(direction[1], -direction[0]);
            assert!((outward - half_space.normal).norm() <= 1e-9, "{outward:?}");
        }
    }
}
