//! Invariants of truncation and its inverse on random cells: parts sum to the whole, derivatives, symmetries, slabs,
//! swept regions.

mod common;

use common::{Random, at, box_volume, config, corner, range, valid_cell};
use proptest::prelude::*;
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, PositionMethod, Quad, Vector};

/// A simple quadrilateral that is not convex.
fn arrowhead(seed: u64) -> Quad {
    let mut random = Random(seed);
    let cell: Quad = random.cell(0.2);
    let x = cell.nodes();
    Quad::new([x[0], x[1], x[0] + (x[2] - x[0]) * random.within(0.1, 0.45), x[3]])
}

/// The change of a volume when points or planes at the distance of the nodes are rounded, a few times.
fn rounding<const D: usize>(nodes: &[Vector<D>], area: f64) -> f64 {
    let far = nodes.iter().map(|x| x.norm()).fold(0.0, f64::max);
    4.0 * f64::EPSILON * far * area
}

/// The sum of the areas of all faces.
fn surface<const D: usize, C: Cell<D>>(cell: &C) -> f64 {
    (0..C::FACES).map(|face| cell.face_area(face).norm()).sum()
}

fn parts_sum_to_the_whole<const D: usize>(cell: &impl Cell<D>, normal: Vector<D>, part: f64) {
    let half_space = at(cell.nodes(), normal, part);
    let below = cell.truncate(&half_space);
    let above = cell.truncate(&half_space.complement());
    let error = (below.volume + above.volume - cell.volume()).abs();
    // Where the cell is not convex, the terms of the sum are larger than the cell.
    let allowed = 4e-15 * cell.volume() + 1e-15 * box_volume(cell.nodes());
    assert!(error <= allowed, "{error:e} of {:e}", cell.volume());
    let (low, high) = range(cell.nodes(), &normal);
    let scale = below.section_area.max(cell.volume() / (high - low));
    assert!((below.section_area - above.section_area).abs() <= 1e-11 * scale, "{below:?} {above:?}");
}

fn monotone_with_the_section_as_derivative<const D: usize>(cell: &impl Cell<D>, normal: Vector<D>) {
    let volume = cell.volume();
    let (low, high) = range(cell.nodes(), &normal);
    let mut previous = 0.0;
    let mut integral = 0.0;
    const STEPS: usize = 64;
    // Three-point Gauss rule between samples: the section is an analytic function between the nodes' heights.
    let gauss = [(0.5 - 0.15_f64.sqrt(), 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + 0.15_f64.sqrt(), 5.0 / 18.0)];
    for step in 0..=STEPS {
        let found = cell.truncate(&at(cell.nodes(), normal, step as f64 / STEPS as f64)).volume;
        assert!(found >= previous - 4e-15 * volume, "{found:e} after {previous:e}");
        previous = found;
        if step < STEPS {
            for (place, weight) in gauss {
                let half_space = at(cell.nodes(), normal, (step as f64 + place) / STEPS as f64);
                integral += weight * (high - low) / STEPS as f64 * cell.truncate(&half_space).section_area;
            }
        }
    }
    // The section may jump, where an edge is parallel to the plane, by no more than its mean in most cells.
    assert!((integral - volume).abs() <= 2.0 / STEPS as f64 * volume, "{integral:e} {volume:e}");
}

fn section_is_the_derivative<const D: usize>(cell: &impl Cell<D>, normal: Vector<D>, part: f64) {
    let (low, high) = range(cell.nodes(), &normal);
    let step = 1e-4 * (high - low);
    let near_node = |x: &Vector<D>| (normal.dot(x) - (low + part * (high - low))).abs() <= 30.0 * step;
    if cell.nodes().iter().any(near_node) {
        return;
    }
    let volume = |shift: f64| {
        let mut half_space = at(cell.nodes(), normal, part);
        half_space.constant += shift;
        cell.truncate(&half_space).volume
    };
    let difference =
        2.0 / 3.0 * (volume(step) - volume(-step)) - (volume(2.0 * step) - volume(-2.0 * step)) / 12.0;
    let area = cell.truncate(&at(cell.nodes(), normal, part)).section_area;
    let error = (difference - area * step).abs() / cell.volume();
    let rounding = rounding(cell.nodes(), area) / cell.volume();
    assert!(error <= 2e-8 * 1e-2 + rounding, "{error:e}, {area:e}");
}

fn round_trip<const D: usize>(cell: &impl Cell<D>, normal: Vector<D>, fraction: f64) -> [usize; 2] {
    let volume = cell.volume();
    [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent]
        .map(|method| {
            let position = cell.plane_constant(&normal, fraction, method).expect("a valid cell");
            let truncation = cell.truncate(&HalfSpace { normal, constant: position.constant });
            let allowed = 1e-14 * volume + rounding(cell.nodes(), truncation.section_area);
            let error = (truncation.volume - fraction * volume).abs();
            assert!(error <= allowed, "{method:?}, fraction {fraction:e}: {error:e} of {volume:e}");
            assert!(position.residual.abs() <= 1e-14, "{position:?}");
            position.evaluations
        })
        .last_chunk::<2>()
        .copied()
        .expect("three methods")
}

fn agrees<const D: usize>(
    found: &impl Cell<D>,
    wanted: &impl Cell<D>,
    plane: [HalfSpace<D>; 2],
    factor: f64,
) {
    let (found, wanted) = (found.truncate(&plane[0]), wanted.truncate(&plane[1]));
    let error = (found.volume - factor * wanted.volume).abs();
    assert!(error <= 2e-14 * factor, "{error:e} {found:?} {wanted:?}");
}

fn slabs<const D: usize, C: Cell<D>>(cell: &C, normal: Vector<D>, part: f64, fraction: f64) {
    let volume = cell.volume();
    let half_space = at(cell.nodes(), normal, part);
    // The nodes of a slab are rounded.
    let rounded = rounding(cell.nodes(), surface(cell));
    for face in 0..C::FACES {
        let (slab, rest) = (cell.slab(face, fraction), cell.slab(face ^ 1, 1.0 - fraction));
        let error = (slab.volume() - fraction * volume).abs();
        assert!(error <= 4e-15 * volume + rounded, "face {face}: {error:e} of {volume:e}");
        let error = (slab.volume() + rest.volume() - volume).abs();
        assert!(error <= 4e-15 * volume + rounded, "face {face}: {error:e} of {volume:e}");
        // A slab of a slab is one of the cell.
        let halves = slab.slab(face, 0.5).volume() + slab.slab(face ^ 1, 0.5).volume();
        assert!((halves - slab.volume()).abs() <= 4e-15 * volume + rounded, "face {face}: {halves:e}");
        for &node in C::FACE_NODES[face] {
            assert_eq!(slab.nodes()[node], cell.nodes()[node], "face {face}");
        }
        let [whole, near, far] = [cell, &slab, &rest].map(|part| part.truncate(&half_space));
        let error = (near.volume + far.volume - whole.volume).abs();
        assert!(error <= 2e-14 * volume + rounded, "face {face}: {error:e} of {volume:e}");
    }
}

/// The swept volumes of all faces of a moved cell add up to the change of its volume.
fn swept<const D: usize, C: Cell<D>>(cell: &C, moved: &C) {
    let of = |cell: &C, face: usize| -> Vec<Vector<D>> {
        C::FACE_NODES[face].iter().map(|&i| cell.nodes()[i]).collect()
    };
    let total: f64 = (0..C::FACES).map(|face| C::swept(&of(cell, face), &of(moved, face)).volume()).sum();
    let change = moved.volume() - cell.volume();
    assert!((total - change).abs() <= 4e-15, "{total:e} {change:e}");
}

/// Fractions of all magnitudes, from both ends.
fn any_fraction() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => 0.0..=1.0_f64,
        2 => (-14.0..0.0_f64).prop_map(|e| 10.0_f64.powf(e)),
        2 => (-14.0..0.0_f64).prop_map(|e| 1.0 - 10.0_f64.powf(e)),
        1 => Just(0.0),
        1 => Just(1.0),
    ]
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn hexahedra(seed in any::<u64>(), part in -0.1..1.1_f64, fraction in any_fraction()) {
        let cell: Hexahedron = valid_cell(seed);
        let normal = Random(!seed).unit();
        parts_sum_to_the_whole(&cell, normal, part);
        monotone_with_the_section_as_derivative(&cell, normal);
        section_is_the_derivative(&cell, normal, part);
        round_trip(&cell, normal, fraction);
        slabs(&cell, normal, part, fraction);
    }

    #[test]
    fn quads(seed in any::<u64>(), part in -0.1..1.1_f64, fraction in any_fraction()) {
        let normal = Random(!seed).unit();
        let cell: Quad = valid_cell(seed);
        slabs(&cell, normal, part, fraction);
        for cell in [cell, arrowhead(seed)] {
            parts_sum_to_the_whole(&cell, normal, part);
            monotone_with_the_section_as_derivative(&cell, normal);
            section_is_the_derivative(&cell, normal, part);
            round_trip(&cell, normal, fraction);
        }
    }

    #[test]
    fn moved_rotated_and_scaled(seed in any::<u64>(), part in 0.0..1.0_f64) {
        let mut random = Random(seed);
        let (axis, angle, shift) = (random.unit::<3>(), random.within(0.0, 3.0), random.vector(1.0));
        let rotation = nalgebra::Rotation3::from_scaled_axis(axis * angle);
        let scale = random.within(0.1, 10.0);
        let cell: Hexahedron = random.cell(0.2);
        let half_space = at(cell.nodes(), random.unit(), part);
        let image = |x: &Vector<3>| rotation * x * scale + shift;
        let moved = Hexahedron::new(std::array::from_fn(|i| image(&cell.nodes()[i])));
        let normal = rotation * half_space.normal;
        let plane = HalfSpace { normal, constant: half_space.constant * scale + normal.dot(&shift) };
        agrees(&moved, &cell, [plane, half_space], scale.powi(3));

        let turn = nalgebra::Rotation2::new(angle);
        let cell: Quad = random.cell(0.2);
        let half_space = at(cell.nodes(), random.unit(), part);
        let shift = random.vector(1.0);
        let moved = Quad::new(std::array::from_fn(|i| turn * cell.nodes()[i] * scale + shift));
        let normal = turn * half_space.normal;
        let plane = HalfSpace { normal, constant: half_space.constant * scale + normal.dot(&shift) };
        agrees(&moved, &cell, [plane, half_space], scale.powi(2));
    }

    #[test]
    fn relabelled(seed in any::<u64>(), part in 0.0..1.0_f64) {
        let mut random = Random(seed);
        let cell: Hexahedron = random.cell(0.3);
        let half_space = at(cell.nodes(), random.unit(), part);
        let mut rotations = 0;
        for axes in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
            let odd = axes[(axes.iter().position(|&a| a == 0).unwrap_or(0) + 1) % 3] != 1;
            for flips in 0..8_usize {
                // Proper rotations only: an odd permutation needs an odd number of flips.
                if (flips.count_ones() % 2 == 1) != odd {
                    continue;
                }
                rotations += 1;
                let turned = Hexahedron::from_corners(|offset| {
                    let from: [usize; 3] = std::array::from_fn(|a| offset[axes[a]] ^ (flips >> a & 1));
                    let place = Hexahedron::OFFSETS.iter().position(|o| *o == from);
                    cell.nodes()[place.expect("an offset")]
                });
                agrees(&turned, &cell, [half_space; 2], 1.0);
            }
        }
        prop_assert_eq!(rotations, 24);
        let cell: Quad = random.cell(0.3);
        let half_space = at(cell.nodes(), random.unit(), part);
        for first in 0..4 {
            let turned = Quad::new(std::array::from_fn(|i| cell.nodes()[(first + i) % 4]));
            agrees(&turned, &cell, [half_space; 2], 1.0);
        }
    }

    #[test]
    fn swept_volumes_add_up(seed in any::<u64>()) {
        let mut random = Random(seed);
        swept::<3, Hexahedron>(&random.cell(0.3), &random.cell(0.3));
        swept::<2, Quad>(&random.cell(0.3), &random.cell(0.3));
    }

    /// Whatever the nodes are: nothing is NaN, and the parts sum to the whole.
    #[test]
    fn any_finite_nodes(seed in any::<u64>(), grid in 1..4_i32, fraction in 0.0..=1.0_f64) {
        let mut random = Random(seed);
        // Coordinates on a coarse grid: nodes, edges and faces fall together, heights are exactly zero.
        let nodes: [Vector<3>; 8] = std::array::from_fn(|_| {
            random.vector::<3>(f64::from(grid) + 0.5).map(f64::round)
        });
        let cell = Hexahedron::new(nodes);
        let half_space = HalfSpace {
            normal: corner([1, 0, 0]) + random.vector::<3>(1.5).map(f64::round) * 2.0,
            constant: random.within(-3.0, 3.0).round(),
        };
        let below = cell.truncate(&half_space);
        let above = cell.truncate(&half_space.complement());
        prop_assert!(below.section_area.is_finite() && above.section_area.is_finite());
        let error = (below.volume + above.volume - cell.volume()).abs();
        prop_assert!(error <= 1e-14 * box_volume(&nodes).max(1.0), "{:e}", error);
        for points in cell.section(&half_space) {
            prop_assert!(points.iter().all(|x| x.iter().all(|c| c.is_finite())));
        }
        let _ = cell.defects();
        if let Ok(position) = cell.plane_constant(&half_space.normal, fraction, PositionMethod::Auto) {
            prop_assert!(position.constant.is_finite());
        }
    }
}
