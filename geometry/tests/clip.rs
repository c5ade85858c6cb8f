//! Regions cut by planes: the parts add up in every moment, whatever the region and however degenerate the plane.

mod common;

use common::{KINDS, Random, at, config, corner, valid_cell};
use proptest::prelude::*;
use vofkit_geometry::clip::{Full, Polygon, Polyhedron, Region, Side, Tile, Workspace, bounds};
use vofkit_geometry::submesh::{self, Triangulation};
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, PositionMethod, Quad, Vector};

/// The middles of a cell's faces, each moved by up to `size`.
fn middles<const D: usize>(cell: &impl Cell<D>, random: &mut Random, size: f64) -> Vec<Vector<D>> {
    middles_of(cell).into_iter().map(|x| x + random.vector(size)).collect()
}

fn middles_of<C: Cell<D>, const D: usize>(cell: &C) -> Vec<Vector<D>> {
    let mean = |face: &&[usize]| face.iter().map(|&i| cell.nodes()[i]).sum::<Vector<D>>() / face.len() as f64;
    C::FACE_NODES.iter().map(mean).collect()
}

/// A region like a cell traced back: its nodes and the middles of its faces moved.
fn region<R: Region<D>, C: Cell<D>, const D: usize>(seed: u64, size: f64) -> R {
    let mut random = Random(seed);
    let cell: C = random.cell(size);
    R::fans(cell.nodes(), &middles(&cell, &mut random, size))
}

/// What the rounding of the coordinates is multiplied by: their size and the area of the region.
fn scale<const D: usize>(region: &impl Region<D>) -> f64 {
    let [low, high] = bounds(region.corners());
    size(region) * (high - low).amax().powi(D as i32 - 1)
}

/// The largest coordinate.
fn size<const D: usize>(region: &impl Region<D>) -> f64 {
    region.corners().map(|x| x.amax()).fold(0.0, f64::max)
}

fn parts_add_up<const D: usize, R: Region<D>>(whole: &R, half_space: &HalfSpace<D>, allowed: f64) {
    let (mut below, mut above, mut again) = (R::empty(), R::empty(), R::empty());
    let side = whole.split(half_space, &mut below, &mut above).expect("room");
    assert_eq!(side, whole.cut(half_space, &mut again).expect("room"));
    if side != Side::Across {
        return;
    }
    assert!(below.corners().eq(again.corners()));
    let [low, high, all] = [&below, &above, whole].map(Region::moments);
    let error = (low.volume + high.volume - all.volume).abs();
    assert!(error <= allowed * scale(whole), "{error:e} of {all:?}: {low:?} {high:?}");
    let size = size(whole);
    let error = (low.first + high.first - all.first).amax();
    assert!(error <= allowed * scale(whole) * size, "{error:e} of {all:?}: {low:?} {high:?}");
    for (part, sign) in [(&below, 1.0), (&above, -1.0)] {
        assert!(part.volume() == part.moments().volume);
        let extent = half_space.normal.norm() * (size + half_space.constant.abs());
        let height = |x: &Vector<D>| sign * half_space.height(x);
        assert!(part.corners().all(|x| height(x) <= 1e-14 * extent));
    }
}

/// Cuts a region again and again, each time going on with both parts.
fn cut_often<const D: usize, R: Region<D>>(whole: &R, random: &mut Random, depth: usize) {
    let [low, high] = bounds(whole.corners());
    let point = low + (high - low).component_mul(&(random.vector::<D>(0.5) + Vector::<D>::repeat(0.5)));
    let normal = random.unit::<D>();
    let half_space = HalfSpace { normal, constant: normal.dot(&point) };
    // The rounding of one cut: of the points, relative to the coordinates.
    parts_add_up(whole, &half_space, 1e-14);
    let (mut below, mut above) = (R::empty(), R::empty());
    if depth > 0 && whole.split(&half_space, &mut below, &mut above) == Ok(Side::Across) {
        cut_often(&below, random, depth - 1);
        cut_often(&above, random, depth - 1);
    }
}

fn simplices_add_up<const D: usize>(region: &impl Region<D>) {
    let (mut volume, mut first) = (0.0, Vector::<D>::zeros());
    region.simplices(&mut |simplex| {
        let moments = simplex.moments();
        volume += moments.volume;
        first += moments.first;
    });
    let all = region.moments();
    assert!((volume - all.volume).abs() <= 4e-15 * scale(region).max(1.0), "{volume} {all:?}");
    assert!((first - all.first).amax() <= 4e-15 * scale(region).max(1.0), "{first:?} {all:?}");
}

/// What a region has in common with a cell.
fn common_volume<C: Cell<D>, const D: usize>(region: &<C::Tile as Tile<D>>::Region, cell: &C) -> f64 {
    let mut volume = 0.0;
    let mut add = |sign: f64, part: &<C::Tile as Tile<D>>::Region| volume += sign * part.volume();
    C::Tile::new(cell).common(region, &mut Workspace::new(), &mut add).expect("room");
    volume
}

/// A region in the middle of three cells along each axis, whose inner nodes are moved.
fn tiles_fill_space<C: Cell<D>, const D: usize>(seed: u64, size: f64, collapse: bool) {
    let mut random = Random(seed);
    let moves: Vec<Vector<D>> = (0..4_usize.pow(D as u32)).map(|_| random.vector(size)).collect();
    let node = |at: [usize; D]| {
        let inner = at.iter().all(|&i| i == 1 || i == 2);
        let index = at.iter().rev().fold(0, |index, i| 4 * index + i);
        let mut x = corner(at);
        if inner {
            x += moves[index];
            // Two nodes fall together, and edges and faces between them collapse.
            if collapse && at == [2; D] {
                let mut other = at;
                other[0] = 1;
                x = corner(other) + moves[index - 1];
            }
        }
        x
    };
    let shape: C = random.cell(0.45);
    let shift = Vector::<D>::repeat(1.0) + random.vector::<D>(0.4);
    let mut region = <C::Tile as Tile<D>>::Region::fans(shape.nodes(), &middles(&shape, &mut random, 0.1));
    region.translate(&shift);
    let mut sum = 0.0;
    for mut cell in 0..3_usize.pow(D as u32) {
        let at: [usize; D] = std::array::from_fn(|_| {
            let i = cell % 3;
            cell /= 3;
            i
        });
        let cell = C::from_corners(|offset| node(std::array::from_fn(|k| at[k] + offset[k])));
        let part = common_volume(&region, &cell);
        // Where a cell crosses itself, it counts twice with itself.
        if !cell.defects().iter().any(|defect| defect.is_error()) {
            assert!((common_volume(&C::Tile::region(&cell), &cell) - cell.volume()).abs() <= 1e-13);
        }
        sum += part;
    }
    assert!((sum - region.volume()).abs() <= 1e-13, "{sum} {}", region.volume());
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn hexahedra_of_a_mesh_fill_a_region(seed in any::<u64>(), size in 0.0_f64..0.4, collapse in any::<bool>()) {
        tiles_fill_space::<Hexahedron, 3>(seed, size, collapse);
    }

    #[test]
    fn quadrilaterals_of_a_mesh_fill_a_region(seed in any::<u64>(), size in 0.0_f64..0.6, collapse in any::<bool>()) {
        tiles_fill_space::<Quad, 2>(seed, size, collapse);
    }

    #[test]
    fn two_hexahedra_share_the_same_either_way(seed in any::<u64>(), size in 0.0_f64..0.45) {
        let mut random = Random(seed);
        let [a, b]: [Hexahedron; 2] = [random.cell(size), random.cell(size)];
        let shift = random.vector::<3>(0.7);
        let b = Hexahedron::from_corners(|offset| b.nodes()[Hexahedron::OFFSETS.iter().position(|o| *o == offset)
            .expect("a corner")] + shift);
        let [ab, ba] = [(&a, &b), (&b, &a)].map(|(of, other)| {
            common_volume(&<Hexahedron as Cell<3>>::Tile::region(of), other)
        });
        // Where a cell crosses itself, it counts with its winding number as a region and with its pieces as a tile.
        if [a, b].iter().all(|cell| !cell.defects().iter().any(|defect| defect.is_error())) {
            prop_assert!((ab - ba).abs() <= 1e-13, "{ab} {ba}");
        }
    }

    #[test]
    fn the_plane_constant_of_a_tile_leaves_its_part(seed in any::<u64>(), fraction in 0.0_f64..=1.0) {
        let cell: Hexahedron = valid_cell(seed / KINDS * KINDS);
        let normal = Random(seed).unit();
        let method = PositionMethod::default();
        let found = <Hexahedron as Cell<3>>::Tile::plane_constant(&cell, &normal, fraction, method);
        let half_space = HalfSpace { normal, constant: found.expect("a valid cell").constant };
        let whole = <Hexahedron as Cell<3>>::Tile::region(&cell);
        let mut below = Polyhedron::empty();
        let part = match whole.cut(&half_space, &mut below).expect("room") {
            Side::Below => whole.volume(),
            Side::Above => 0.0,
            Side::Across => below.volume(),
        };
        prop_assert!((part - fraction * cell.volume()).abs() <= 1e-14, "{part} {fraction}");
    }

    #[test]
    fn polyhedra_cut_again_and_again_add_up(seed in any::<u64>(), size in 0.0_f64..0.6) {
        let whole: Polyhedron = region::<_, Hexahedron, 3>(seed, size);
        simplices_add_up(&whole);
        cut_often(&whole, &mut Random(seed ^ 1), 4);
    }

    #[test]
    fn polygons_cut_again_and_again_add_up(seed in any::<u64>(), size in 0.0_f64..0.6) {
        let whole: Polygon = region::<_, Quad, 2>(seed, size);
        simplices_add_up(&whole);
        cut_often(&whole, &mut Random(seed ^ 1), 6);
    }

    #[test]
    fn fans_about_the_mean_of_the_nodes_are_the_sub_mesh(seed in any::<u64>(), part in -0.1_f64..1.1) {
        let cell: Hexahedron = valid_cell(seed / KINDS * KINDS);
        let whole = Polyhedron::fans(cell.nodes(), &middles_of(&cell));
        prop_assert!((whole.volume() - cell.volume()).abs() <= 4e-15 * scale(&whole));
        let half_space = at(cell.nodes(), Random(seed).unit(), part);
        let wanted = submesh::truncate(&cell, &half_space, Triangulation::FourPerFace).volume;
        let mut below = Polyhedron::empty();
        let found = match whole.cut(&half_space, &mut below).expect("room") {
            Side::Below => whole.volume(),
            Side::Above => 0.0,
            Side::Across => below.volume(),
        };
        prop_assert!((found - wanted).abs() <= 4e-15 * scale(&whole), "{found:e} {wanted:e}");
    }

    #[test]
    fn quadrilaterals_are_exact(seed in any::<u64>(), part in -0.1_f64..1.1) {
        let cell: Quad = valid_cell(seed / KINDS * KINDS);
        let whole = Polygon::fans(cell.nodes(), &middles_of(&cell));
        let half_space = at(cell.nodes(), Random(seed).unit(), part);
        let mut below = Polygon::empty();
        let found = match whole.cut(&half_space, &mut below).expect("room") {
            Side::Below => whole.moments(),
            Side::Above => return Ok(()),
            Side::Across => below.moments(),
        };
        let wanted = cell.truncate(&half_space).volume;
        prop_assert!((found.volume - wanted).abs() <= 4e-15 * scale(&whole));
        let first = cell.first_moment(&half_space);
        prop_assert!((found.first - first).amax() <= 8e-15 * scale(&whole), "{found:?} {first:?}");
    }

    #[test]
    fn planes_through_corners_edges_and_faces_add_up(seed in any::<u64>()) {
        let mut random = Random(seed);
        // Coordinates in eighths: planes through three of the corners meet others exactly, and edges collapse.
        let eighth = |x: f64| (8.0 * x).round() / 8.0;
        let cell: Hexahedron = random.cell(0.3);
        let nodes: Vec<_> = cell.nodes().iter().map(|x| x.map(eighth)).collect();
        let centres: Vec<_> = middles(&cell, &mut random, 0.2).iter().map(|x| x.map(eighth)).collect();
        let whole = Polyhedron::fans(&nodes, &centres);
        let mut pick = || *whole.corners().nth(random.within(0.0, 14.0) as usize).expect("14 corners");
        let [a, b, c] = [pick(), pick(), pick()];
        let normal = (b - a).cross(&(c - a));
        let half_space = HalfSpace { normal, constant: normal.dot(&a) };
        parts_add_up(&whole, &half_space, 1e-14);
        parts_add_up(&whole, &half_space.complement(), 1e-14);
        // The same plane, off by a few units in the last place.
        for nudge in [-4e-16, -1e-16, 1e-16, 4e-16] {
            let nudged = HalfSpace { constant: half_space.constant + nudge, ..half_space };
            parts_add_up(&whole, &nudged, 1e-14);
        }
    }
}

#[test]
fn moments_of_a_box_and_of_its_halves() {
    let cell =
        Hexahedron::from_corners(|offset| corner(offset).component_mul(&Vector::<3>::new(2.0, 3.0, 4.0)));
    let mut whole = Polyhedron::fans(cell.nodes(), &middles_of(&cell));
    whole.translate(&Vector::<3>::new(1.0, 1.0, 1.0));
    let moments = whole.moments();
    assert!((moments.volume - 24.0).abs() <= 1e-14);
    assert!((moments.first - Vector::<3>::new(2.0, 2.5, 3.0) * 24.0).amax() <= 1e-13);
    let half_space = HalfSpace { normal: Vector::<3>::new(0.0, 0.0, 1.0), constant: 2.0 };
    let mut below = Polyhedron::empty();
    assert_eq!(whole.cut(&half_space, &mut below), Ok(Side::Across));
    assert!((below.moments().first - Vector::<3>::new(2.0, 2.5, 1.5) * 6.0).amax() <= 1e-13);
    for (constant, side) in [(1.0, Side::Across), (0.9, Side::Above), (5.0, Side::Below)] {
        let half_space = HalfSpace { constant, ..half_space };
        assert_eq!(whole.cut(&half_space, &mut below), Ok(side));
        if side == Side::Across {
            // Its lowest face lies in the plane, and counts as below it.
            assert!(below.volume().abs() <= 1e-15);
        }
    }
}

#[test]
fn a_region_turned_inside_out_counts_negative() {
    let triangle = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]].map(Vector::<2>::from);
    let polygon = Polygon::new(&triangle).expect("room");
    assert!((polygon.volume() + 0.5).abs() <= 1e-16);
    let half_space = HalfSpace { normal: Vector::<2>::new(1.0, 0.0), constant: 0.5 };
    let mut below = Polygon::empty();
    assert_eq!(polygon.cut(&half_space, &mut below), Ok(Side::Across));
    assert!((below.volume() + 0.375).abs() <= 1e-16);
}

#[test]
fn a_zigzag_that_a_line_cuts_too_often_is_refused() {
    let zigzag: Vec<_> = (0..32).map(|i| Vector::<2>::new(f64::from(i), f64::from(i % 2))).collect();
    let polygon = Polygon::new(&zigzag).expect("room for 32 corners");
    let half_space = HalfSpace { normal: Vector::<2>::new(0.0, 1.0), constant: 0.5 };
    assert_eq!(polygon.cut(&half_space, &mut Polygon::empty()), Err(Full));
    assert_eq!(Polygon::new(&[zigzag[0]; 33]).map(|_| ()), Err(Full));
    // Its triangles have room.
    let mut sum = 0.0;
    polygon.simplices(&mut |triangle| {
        let mut below = Polygon::empty();
        sum += match triangle.cut(&half_space, &mut below).expect("room") {
            Side::Below => triangle.volume(),
            Side::Above => 0.0,
            Side::Across => below.volume(),
        };
    });
    assert!(sum.is_finite());
}

#[test]
fn what_is_not_a_number_stays_one_and_does_not_panic() {
    let mut cell: Polyhedron = region::<_, Hexahedron, 3>(1, 0.1);
    let half_space = HalfSpace { normal: Vector::<3>::new(f64::NAN, 0.0, 1.0), constant: 0.5 };
    assert_eq!(cell.cut(&half_space, &mut Polyhedron::empty()), Ok(Side::Above));
    cell.translate(&Vector::<3>::new(0.0, f64::NAN, 0.0));
    assert!(cell.volume().is_nan());
}
