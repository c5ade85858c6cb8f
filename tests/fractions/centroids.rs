//! Centroids: sums over cells against closed forms, single cells against the kernel and against their own parts.

use vofkit::fractions::{MaterialMoments, material_moments};
use vofkit::geometry::{Cell, HalfSpace, Hexahedron, Quad, Vector};
use vofkit::interface::is_mixed;
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::shape::Shape;

use super::bodies::{body, box_surface, star};
use super::{V2, V3, distortions, tilt, unit_mesh};

/// The largest edge of a cell.
fn size<C: Cell<D>, const D: usize>(cell: &C) -> f64 {
    (0..D).map(|axis| cell.mean_edge(axis).norm()).fold(0.0, f64::max)
}

fn moments_of<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, shape: &Shape<D>) -> MaterialMoments<D> {
    material_moments(mesh, std::slice::from_ref(shape))
}

/// The middle of a whole shape as the sum over its cells says.
fn middle<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, shape: &Shape<D>) -> Vector<D> {
    let MaterialMoments { fractions, centroids } = moments_of(mesh, shape);
    let (mut volume, mut first) = (0.0, Vector::zeros());
    for (cell, &fraction) in fractions[0].iter().enumerate().filter(|(_, fraction)| **fraction > 0.0) {
        let part = fraction * mesh.volumes()[cell];
        volume += part;
        first += centroids[0][cell] * part;
    }
    first / volume
}

/// Whether the middle of a shape comes out, relative to its size.
fn assert_middle<C: Cell<D>, const D: usize>(shape: &Shape<D>, wanted: Vector<D>, size: f64) {
    for distortion in distortions() {
        for n in [1, 5, 16] {
            let error = (middle(&unit_mesh::<C, D>(n, &distortion), shape) - wanted).norm() / size;
            assert!(error <= 1e-10, "{shape:?} on {n} cells, {distortion:?}: {error:e}");
        }
    }
}

#[test]
fn moments_of_cells_add_up_to_that_of_the_body() {
    for radius in [0.4, 0.15, 0.01] {
        let centre = V2::new(0.52, 0.47);
        assert_middle::<Quad, 2>(&Shape::Sphere { centre, radius }, centre, radius);
        let centre = V3::new(0.52, 0.47, 0.51);
        assert_middle::<Hexahedron, 3>(&Shape::Sphere { centre, radius }, centre, radius);
    }
    let (centre, rotation) = (V3::new(0.5, 0.48, 0.51), tilt());
    let semi_axes = V3::new(0.4, 0.2, 0.1);
    assert_middle::<Hexahedron, 3>(&Shape::Ellipsoid { centre, semi_axes, rotation }, centre, 0.4);
    let lengths = V3::new(0.5, 0.3, 0.41);
    assert_middle::<Hexahedron, 3>(&Shape::Box { centre, lengths, rotation }, centre, 0.5);
    // Half a disc: 4 R / (3 pi) from the middle of its straight side.
    let centre = V2::new(0.5, 0.4);
    let disc = Shape::Sphere { centre, radius: 0.3 };
    let half = Shape::HalfSpace(HalfSpace { normal: V2::new(-0.6, -0.8), constant: -0.62 });
    let wanted = centre + V2::new(0.6, 0.8) * (0.4 / std::f64::consts::PI);
    assert_middle::<Quad, 2>(&Shape::Intersection(vec![disc, half]), wanted, 0.3);
}

/// The largest difference of a half-space's centroids from those of the kernel, in cells, and how many cells were compared.
fn half_space_error<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, line: HalfSpace<D>) -> (f64, usize) {
    let MaterialMoments { fractions, centroids } = moments_of(mesh, &Shape::HalfSpace(line));
    let (mut largest, mut compared) = (0.0_f64, 0);
    for cell in (0..mesh.grid().len()).filter(|&cell| fractions[0][cell] > 0.0) {
        let (anchor, local) = (mesh.anchor(cell), mesh.local_cell(cell));
        let below = line.translated(&-anchor);
        let exact = local.first_moment(&below) / local.truncate(&below).volume;
        largest = largest.max((centroids[0][cell] - anchor - exact).norm() / size(&local));
        compared += 1;
    }
    (largest, compared)
}

#[test]
fn half_spaces_have_the_centroids_of_the_kernel() {
    for distortion in distortions() {
        let mesh = unit_mesh::<Quad, 2>(12, &distortion);
        for (normal, constant) in [([0.6, 0.8], 0.71), ([1.0, 0.0], 0.5), ([-0.3, 0.954], 0.2)] {
            let (error, compared) = half_space_error(&mesh, HalfSpace { normal: normal.into(), constant });
            assert!(error <= 1e-12 && compared > 20, "{normal:?}, {distortion:?}: {error:e} in {compared}");
        }
        let mesh = unit_mesh::<Hexahedron, 3>(6, &distortion);
        for (normal, constant) in [([0.48, 0.6, 0.64], 0.86), ([0.0, 0.0, 1.0], 0.5), ([-0.3, 0.9, 0.3], 0.4)]
        {
            let (error, compared) = half_space_error(&mesh, HalfSpace { normal: normal.into(), constant });
            assert!(error <= 1e-12 && compared > 20, "{normal:?}, {distortion:?}: {error:e} in {compared}");
        }
    }
}

/// The largest difference between the centroid in a cell and that of its parts together, in cells.
fn parts_error<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, shape: &Shape<D>) -> f64 {
    const PARTS: usize = 3;
    let MaterialMoments { fractions, centroids } = moments_of(mesh, shape);
    let mut largest = 0.0_f64;
    for cell in (0..mesh.grid().len()).filter(|&cell| is_mixed(fractions[0][cell])) {
        let whole = mesh.cell(cell);
        let grid = Grid::new([PARTS; D], [false; D]);
        let nodes = (0..grid.node_count()).map(|node| {
            let at = grid.node_offset(node);
            whole.map(&Vector::from_fn(|k, _| at[k] as f64 / PARTS as f64))
        });
        let parts: Mesh<C, D> =
            Mesh::from_nodes(grid.clone(), nodes.collect()).expect("parts of a valid cell");
        let error = (middle(&parts, shape) - centroids[0][cell]).norm() / size(&whole);
        largest = largest.max(error);
    }
    largest
}

#[test]
fn centroids_are_those_of_the_parts_of_a_cell() {
    for distortion in distortions() {
        let meshes = (unit_mesh::<Quad, 2>(20, &distortion), unit_mesh::<Hexahedron, 3>(8, &distortion));
        for number in 0..12 {
            let near = |factor: f64| 0.45 + 0.1 * (number as f64 * factor).fract();
            let centre = V3::new(near(0.754_877), near(0.569_840), near(0.324_717));
            let disc = Shape::Sphere { centre: centre.xy(), radius: 0.33 };
            let error = parts_error(&meshes.0, &disc);
            assert!(error <= 1e-10, "{disc:?}, {distortion:?}: {error:e}");
            if number % 3 == 0 {
                let ball = Shape::Sphere { centre, radius: 0.33 };
                let error = parts_error(&meshes.1, &ball);
                assert!(error <= 1e-10, "{ball:?}, {distortion:?}: {error:e}");
            }
        }
    }
}

#[test]
fn bodies_have_the_centroids_of_what_they_enclose() {
    for distortion in distortions() {
        // The sides of polygons are straight, and so are those of quadrilaterals.
        let mesh = unit_mesh::<Quad, 2>(15, &distortion);
        let error = parts_error(&mesh, &body(&star(V2::new(0.52, 0.47), 5, [0.4, 0.2])));
        assert!(error <= 1e-12, "{distortion:?}: {error:e}");
    }
    let (centre, lengths, rotation) = (V3::new(0.5, 0.48, 0.51), V3::new(0.5, 0.3, 0.41), tilt());
    let mesh = unit_mesh::<Hexahedron, 3>(8, &Distortion::None);
    let triangles = moments_of(&mesh, &body(&box_surface(centre, lengths, &rotation)));
    let shape = moments_of(&mesh, &Shape::Box { centre, lengths, rotation });
    for cell in (0..mesh.grid().len()).filter(|&cell| is_mixed(shape.fractions[0][cell])) {
        let error = (triangles.centroids[0][cell] - shape.centroids[0][cell]).norm() * 8.0;
        // Rounding of the volume, where there is next to nothing.
        let most = 1e-12 + 1e-16 / shape.fractions[0][cell];
        assert!(error <= most, "{:?}: {error:e}", mesh.grid().offset(cell));
    }
}

#[test]
fn pure_and_empty_cells_have_the_centroids_that_they_should() {
    for distortion in distortions() {
        let mesh = unit_mesh::<Hexahedron, 3>(6, &distortion);
        let ball = Shape::Sphere { centre: V3::repeat(0.5), radius: 0.4 };
        let everything = HalfSpace { normal: V3::zeros(), constant: 1.0 };
        let around = Shape::HalfSpace(HalfSpace { normal: V3::x(), constant: 2.0 });
        let MaterialMoments { fractions, centroids } = material_moments(&mesh, &[ball, around]);
        for (cell, middle) in (0..mesh.grid().len()).map(|cell| {
            let local = mesh.local_cell(cell);
            (cell, mesh.anchor(cell) + local.first_moment(&everything) / local.volume())
        }) {
            let [inner, outer] = [0, 1].map(|k: usize| (fractions[k][cell], centroids[k][cell]));
            let mut sum = V3::zeros();
            for (fraction, centroid) in [inner, outer] {
                assert_eq!(fraction > 0.0, centroid.iter().all(|c| c.is_finite()));
                if fraction > 0.0 {
                    sum += centroid * fraction;
                }
            }
            // What one has of the cell is what the other leaves.
            assert!((sum - middle).norm() <= 1e-12, "{:?} of {distortion:?}", mesh.grid().offset(cell));
        }
    }
}
