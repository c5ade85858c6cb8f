//! Shapes on meshes: totals against closed forms, identities of sets, invariance, agreement with the kernel.

mod bodies;
mod centroids;
#[path = "../common/mod.rs"]
mod common;
#[cfg(all(feature = "cli", feature = "surface", feature = "obj", feature = "vtk"))]
mod files;
mod overlaps;

use std::f64::consts::PI;
use std::time::Instant;

use common::fixed;
use proptest::prelude::*;
use vofkit::fractions::{cell_fraction, shape_volume, volume_fractions};
use vofkit::geometry::{Cell, HalfSpace, Hexahedron, Quad, Vector};
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::shape::{Rotation, Shape, ShapeError};

type V2 = Vector<2>;
type V3 = Vector<3>;

const TOTAL: f64 = 1e-9;

fn distortions() -> [Distortion; 4] {
    [
        Distortion::None,
        Distortion::Random { amplitude: 0.2, seed: 7 },
        Distortion::Wave { amplitude: 0.5 },
        Distortion::Twist { angle: 0.6 },
    ]
}

/// The unit square or cube.
fn unit_mesh<C: Cell<D>, const D: usize>(n: usize, distortion: &Distortion) -> Mesh<C, D> {
    let grid = Grid::new([n; D], [false; D]);
    Mesh::new(grid, Vector::zeros(), Vector::repeat(1.0), distortion).expect("the mesh is valid")
}

/// The relative error of the total volume on every kind of mesh.
fn assert_total<C: Cell<D>, const D: usize>(shape: &Shape<D>, exact: f64, resolutions: &[usize]) {
    shape.check().expect("the shape is valid");
    for distortion in distortions() {
        for &n in resolutions {
            let mesh = unit_mesh::<C, D>(n, &distortion);
            let error = (shape_volume(&mesh, shape) / exact - 1.0).abs();
            assert!(error <= TOTAL, "{shape:?} on {n} cells, {distortion:?}: {error:e}");
            let fractions = &volume_fractions(&mesh, std::slice::from_ref(shape))[0];
            assert!(
                fractions.iter().all(|f| (0.0..=1.0).contains(f)),
                "{shape:?} on {n} cells, {distortion:?}"
            );
            let total: f64 = fractions.iter().zip(mesh.volumes()).map(|(f, v)| f * v).sum();
            assert!(
                (total / exact - 1.0).abs() <= TOTAL,
                "fractions of {shape:?} on {n} cells, {distortion:?}"
            );
        }
    }
}

fn assert_closed_form<C: Cell<D>, const D: usize>(shape: &Shape<D>, resolutions: &[usize]) {
    assert_total::<C, D>(shape, shape.volume().expect("the volume is a closed form"), resolutions);
}

fn tilt() -> Rotation<3> {
    Rotation::from_axis_angle(V3::new(1.0, -2.0, 0.7), 0.8)
}

#[test]
fn discs_and_ellipses() {
    let resolutions = [1, 2, 3, 8, 33];
    for radius in [0.4, 0.15, 0.01, 1e-4] {
        let disc = Shape::Sphere { centre: V2::new(0.52, 0.47), radius };
        assert_closed_form::<Quad, 2>(&disc, &resolutions);
    }
    for (angle, semi_axes) in [(0.0, [0.4, 0.1]), (0.7, [0.4, 0.05]), (-1.0, [0.3, 1e-3])] {
        let rotation = Rotation::from_angle(angle);
        let ellipse = Shape::Ellipsoid { centre: V2::new(0.5, 0.5), semi_axes: semi_axes.into(), rotation };
        assert_closed_form::<Quad, 2>(&ellipse, &resolutions);
    }
}

#[test]
fn rectangles_and_strips() {
    for angle in [0.0, 0.25 * PI, 0.3] {
        let rotation = Rotation::from_angle(angle);
        let rectangle = Shape::Box { centre: V2::new(0.5, 0.5), lengths: V2::new(0.5, 0.31), rotation };
        assert_closed_form::<Quad, 2>(&rectangle, &[1, 2, 5, 16]);
        let axis = rotation.apply(&V2::new(3.0, 0.0));
        let strip = Shape::Cylinder { point: V2::new(0.5, 0.5), axis, radius: 0.1, length: Some(0.6) };
        assert_closed_form::<Quad, 2>(&strip, &[1, 2, 5, 16]);
    }
}

#[test]
fn spheres_and_ellipsoids() {
    let resolutions = [1, 2, 5, 16];
    for radius in [0.4, 0.15, 0.01, 1e-4] {
        let ball = Shape::Sphere { centre: V3::new(0.52, 0.47, 0.51), radius };
        assert_closed_form::<Hexahedron, 3>(&ball, &resolutions);
    }
    for semi_axes in [[0.4, 0.2, 0.1], [0.3, 0.3, 0.05]] {
        for rotation in [Rotation::identity(), tilt()] {
            let ellipsoid =
                Shape::Ellipsoid { centre: V3::repeat(0.5), semi_axes: semi_axes.into(), rotation };
            assert_closed_form::<Hexahedron, 3>(&ellipsoid, &resolutions);
        }
    }
}

#[test]
fn boxes_at_any_angle() {
    for rotation in [Rotation::identity(), Rotation::from_angle(0.25 * PI), tilt()] {
        let cuboid =
            Shape::Box { centre: V3::new(0.5, 0.48, 0.51), lengths: V3::new(0.5, 0.3, 0.41), rotation };
        assert_closed_form::<Hexahedron, 3>(&cuboid, &[1, 2, 5, 12]);
    }
}

#[test]
fn cylinders() {
    for axis in [V3::new(0.0, 0.0, 1.0), V3::new(1.0, 2.0, -0.5)] {
        let point = V3::new(0.5, 0.48, 0.51);
        let cylinder = Shape::Cylinder { point, axis, radius: 0.2, length: Some(0.4) };
        assert_closed_form::<Hexahedron, 3>(&cylinder, &[1, 2, 5, 12]);
    }
    let infinite =
        Shape::Cylinder { point: V3::repeat(0.5), axis: V3::new(0.0, 0.0, 1.0), radius: 0.2, length: None };
    assert_total::<Hexahedron, 3>(&infinite, 0.04 * PI, &[1, 2, 5, 12]);
}

#[test]
fn slotted_discs() {
    for angle in [0.0, 0.5, PI] {
        let rotation = Rotation::from_angle(angle);
        let disc = Shape::SlottedDisc {
            centre: V2::new(0.5, 0.5),
            radius: 0.5 * 0.8,
            slot_width: 0.12 * 0.8,
            bridge: 0.4 * 0.8,
            rotation,
        };
        assert_closed_form::<Quad, 2>(&disc, &[1, 2, 8, 40]);
    }
    // A slotted ball is the ball less a slice of it: what the lower part of a slab holds, by halves, if the slot
    // ends at the centre.
    let (radius, width) = (0.4, 0.1);
    let slice = PI * width * (radius * radius - width * width / 12.0);
    let ball = Shape::SlottedDisc {
        centre: V3::repeat(0.5),
        radius,
        slot_width: width,
        bridge: radius,
        rotation: tilt(),
    };
    assert_total::<Hexahedron, 3>(&ball, 4.0 / 3.0 * PI * radius.powi(3) - 0.5 * slice, &[1, 2, 8]);
}

/// `|A| + |B| = |A u B| + |A n B|` and `|A \ B| = |A| - |A n B|`.
fn assert_set_identities<C: Cell<D>, const D: usize>(a: &Shape<D>, b: &Shape<D>, resolutions: &[usize]) {
    for distortion in distortions() {
        for &n in resolutions {
            let mesh = unit_mesh::<C, D>(n, &distortion);
            let volume = |shape: &Shape<D>| shape_volume(&mesh, shape);
            let pair = || vec![a.clone(), b.clone()];
            let (union, common) = (volume(&Shape::Union(pair())), volume(&Shape::Intersection(pair())));
            let rest = volume(&Shape::Difference(Box::new(a.clone()), vec![b.clone()]));
            let (va, vb) = (volume(a), volume(b));
            let errors = [va + vb - union - common, rest - (va - common)].map(|e| e.abs() / (va + vb));
            assert!(
                errors.iter().all(|e| *e <= TOTAL),
                "{a:?} and {b:?}, {n} cells, {distortion:?}: {errors:?}"
            );
        }
    }
}

#[test]
fn unions_and_intersections_add_up() {
    let discs = [0.45, 0.6].map(|x| Shape::Sphere { centre: V2::new(x, 0.5), radius: 0.3 });
    assert_set_identities::<Quad, 2>(&discs[0], &discs[1], &[1, 2, 9]);
    let balls = [0.45, 0.6].map(|x| Shape::Sphere { centre: V3::new(x, 0.5, 0.45), radius: 0.3 });
    assert_set_identities::<Hexahedron, 3>(&balls[0], &balls[1], &[1, 2, 7]);
    let cuboid = Shape::Box { centre: V3::repeat(0.6), lengths: V3::repeat(0.4), rotation: tilt() };
    assert_set_identities::<Hexahedron, 3>(&balls[0], &cuboid, &[1, 2, 7]);
}

/// Two balls that barely overlap: the lens `pi h^2 (3 r - h) / 3`, twice, for caps of height `h`.
#[test]
fn thin_lenses_are_not_overlooked() {
    let (radius, cap) = (0.2, 5e-4);
    let offset = radius - cap;
    let balls = [-1.0, 1.0].map(|s| Shape::Sphere {
        centre: V3::new(0.51, 0.52, 0.48) + tilt().apply(&V3::new(s * offset, 0.0, 0.0)),
        radius,
    });
    let lens = 2.0 * PI * cap * cap * (3.0 * radius - cap) / 3.0;
    for distortion in distortions() {
        for n in [1, 2, 6] {
            let mesh = unit_mesh::<Hexahedron, 3>(n, &distortion);
            let error = (shape_volume(&mesh, &Shape::Intersection(balls.to_vec())) - lens).abs();
            assert!(error <= 1e-6 * lens, "{n} cells, {distortion:?}: {error:e} of {lens:e}");
        }
    }
}

fn assert_agrees_with_truncation<C: Cell<D>, const D: usize>(normals: &[Vector<D>], tolerance: f64) {
    for distortion in distortions() {
        let mesh = unit_mesh::<C, D>(4, &distortion);
        for normal in normals {
            let half_space =
                HalfSpace { normal: *normal, constant: normal.dot(&Vector::repeat(0.5)) + 0.013 };
            let fractions = &volume_fractions(&mesh, &[Shape::HalfSpace(half_space)])[0];
            for (cell, fraction) in fractions.iter().enumerate() {
                let exact = mesh.cell(cell).truncate(&half_space).volume / mesh.cell(cell).volume();
                let error = (fraction - exact).abs();
                assert!(error <= tolerance, "cell {cell}, {distortion:?}, {normal}: {error:e}");
                let direct = cell_fraction(&mesh.cell(cell), &Shape::HalfSpace(half_space));
                assert!((direct - fraction).abs() <= tolerance, "cell {cell} alone: {direct} and {fraction}");
            }
        }
    }
}

#[test]
fn half_spaces_agree_with_the_kernel() {
    assert_agrees_with_truncation::<Quad, 2>(
        &[V2::new(1.0, 0.0), V2::new(0.6, -0.8), V2::new(2.0, 3.0)],
        1e-14,
    );
    let normals = [V3::new(0.0, 0.0, 1.0), V3::new(1.0, 1.0, 0.0), V3::new(1.0, -2.0, 0.4), V3::repeat(5.0)];
    assert_agrees_with_truncation::<Hexahedron, 3>(&normals, 1e-12);
}

#[test]
fn large_offsets_cost_no_digits() {
    // Corners and centre are exact in both places.
    let place = |offset: f64| {
        let (lower, upper) = (V3::repeat(offset), V3::repeat(offset + 1.0));
        let mesh: Mesh<Hexahedron, 3> =
            Mesh::new(Grid::new([8; 3], [false; 3]), lower, upper, &Distortion::None)
                .expect("the mesh is valid");
        volume_fractions(&mesh, &[Shape::Sphere { centre: V3::repeat(offset + 0.5), radius: 0.3 }])
    };
    assert_eq!(place(0.0), place(1048576.0));
}

#[test]
fn movement_takes_points_along() {
    let mesh = unit_mesh::<Hexahedron, 3>(6, &Distortion::Random { amplitude: 0.2, seed: 3 });
    let about = V3::new(0.4, 0.5, 0.6);
    let shift = V3::new(0.03, -0.02, 0.01);
    let ball = Shape::Sphere { centre: V3::repeat(0.5), radius: 0.2 };
    let cut = HalfSpace { normal: V3::new(1.0, 2.0, -2.0), constant: 0.6 };
    let shapes = [
        Shape::Difference(Box::new(ball.clone()), vec![Shape::HalfSpace(cut)]),
        Shape::Intersection(vec![
            ball,
            Shape::Cylinder {
                point: V3::repeat(0.5),
                axis: V3::new(1.0, 1.0, 0.0),
                radius: 0.1,
                length: Some(0.3),
            },
        ]),
        Shape::Box { centre: V3::repeat(0.5), lengths: V3::new(0.3, 0.2, 0.1), rotation: tilt() },
    ];
    for shape in shapes {
        let moved = shape.moved(&tilt(), &about, &shift);
        let [before, after] = [&shape, &moved].map(|shape| shape_volume(&mesh, shape));
        assert!((before - after).abs() <= TOTAL * before, "{shape:?}: {before} {after}");
        // There and back again.
        let home = moved.moved(&Rotation::identity(), &about, &-shift).moved(
            &tilt().inverse(),
            &about,
            &V3::zeros(),
        );
        let fractions = [shape, home].map(|shape| volume_fractions(&mesh, &[shape]).remove(0));
        let worst = fractions[0].iter().zip(&fractions[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst <= 1e-11, "{worst:e}");
    }
}

#[test]
fn earlier_materials_come_first() {
    let mesh = unit_mesh::<Hexahedron, 3>(6, &Distortion::Random { amplitude: 0.2, seed: 5 });
    let ball = Shape::Sphere { centre: V3::new(0.4, 0.5, 0.5), radius: 0.3 };
    let cuboid = Shape::Box { centre: V3::new(0.6, 0.5, 0.5), lengths: V3::repeat(0.5), rotation: tilt() };
    let everywhere = Shape::Sphere { centre: V3::zeros(), radius: 3.0 };
    let all = [ball.clone(), cuboid.clone(), everywhere];
    let fractions = volume_fractions(&mesh, &all);
    assert_eq!(fractions[0], volume_fractions(&mesh, std::slice::from_ref(&ball))[0]);
    let difference = Shape::Difference(Box::new(cuboid), vec![ball]);
    let direct = &volume_fractions(&mesh, &[difference])[0];
    let worst = fractions[1].iter().zip(direct).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst <= 1e-11, "{worst:e}");
    for cell in 0..mesh.grid().len() {
        let sum: f64 = fractions.iter().map(|f| f[cell]).sum();
        assert!((sum - 1.0).abs() <= 1e-10 && sum <= 1.0 + 1e-15, "cell {cell}: {sum}");
    }
}

#[test]
fn pure_cells_are_exact() {
    let mesh = unit_mesh::<Hexahedron, 3>(8, &Distortion::Random { amplitude: 0.2, seed: 11 });
    let everywhere = Shape::Sphere { centre: V3::repeat(0.5), radius: 0.9 };
    assert!(volume_fractions(&mesh, &[everywhere])[0].iter().all(|f| *f == 1.0));
    let nowhere = Shape::Sphere { centre: V3::repeat(3.0), radius: 1.0 };
    assert!(volume_fractions(&mesh, &[nowhere])[0].iter().all(|f| *f == 0.0));
    // A layer boundary on an undistorted mesh leaves no mixed cell.
    let mesh = unit_mesh::<Hexahedron, 3>(8, &Distortion::None);
    let layer = Shape::HalfSpace(HalfSpace { normal: V3::new(0.0, 0.0, 1.0), constant: 0.5 });
    assert!(volume_fractions(&mesh, &[layer])[0].iter().all(|f| *f == 0.0 || *f == 1.0));
}

#[test]
fn repeated_runs_agree_to_the_last_bit() {
    let mesh = unit_mesh::<Hexahedron, 3>(12, &Distortion::Wave { amplitude: 0.5 });
    let shapes = [0.3, 0.6].map(|x| Shape::Sphere { centre: V3::repeat(x), radius: 0.25 });
    assert_eq!(volume_fractions(&mesh, &shapes), volume_fractions(&mesh, &shapes));
}

#[test]
fn what_is_wrong_with_a_shape_is_said() {
    let flat = Shape::Sphere { centre: V2::zeros(), radius: -0.5 };
    assert_eq!(
        flat.check().unwrap_err().to_string(),
        "the radius of the sphere is -0.5, not a positive length"
    );
    let nested = Shape::Union(vec![Shape::Difference(Box::new(flat), Vec::new())]);
    assert!(matches!(nested.check(), Err(ShapeError::NotPositive { .. })));
    assert_eq!(Shape::<2>::Union(Vec::new()).check(), Err(ShapeError::Empty { shape: "union" }));
    let no_normal = Shape::HalfSpace(HalfSpace { normal: V3::zeros(), constant: 0.0 });
    assert!(matches!(no_normal.check(), Err(ShapeError::ZeroDirection { .. })));
    let no_axis = Rotation::from_axis_angle(V3::zeros(), 1.0);
    let lost = Shape::Box { centre: V3::zeros(), lengths: V3::repeat(1.0), rotation: no_axis };
    assert!(matches!(lost.check(), Err(ShapeError::NotFinite { what: "rotation", .. })));
}

#[test]
fn bounding_boxes_hold_and_touch() {
    let rotation = tilt();
    let lengths = V3::new(0.3, 0.2, 0.1);
    let cuboid = Shape::Box { centre: V3::repeat(0.5), lengths, rotation };
    let [lower, upper] = cuboid.bounding_box().expect("a box is bounded");
    let mesh: Mesh<Hexahedron, 3> =
        Mesh::new(Grid::new([3; 3], [false; 3]), lower, upper, &Distortion::None).expect("the mesh is valid");
    assert!((shape_volume(&mesh, &cuboid) / lengths.product() - 1.0).abs() <= TOTAL);
    let shrunk = (upper - lower) * 1e-3;
    let mesh: Mesh<Hexahedron, 3> =
        Mesh::new(Grid::new([3; 3], [false; 3]), lower + shrunk, upper - shrunk, &Distortion::None)
            .expect("the mesh is valid");
    assert!(shape_volume(&mesh, &cuboid) < lengths.product());
    assert_eq!(
        Shape::Union(vec![cuboid, Shape::HalfSpace(HalfSpace { normal: lengths, constant: 0.0 })])
            .bounding_box(),
        None
    );
}

/// Points on a grid that looks like none.
fn scattered(count: usize) -> impl Iterator<Item = V2> {
    (1..=count).map(|i| V2::new((0.618_034 * i as f64).fract(), (0.754_878 * i as f64).fract()))
}

#[test]
fn earlier_shapes_take_away_what_they_cover() {
    let disc = |(i, centre): (usize, V2)| Shape::Sphere { centre, radius: 0.02 + 0.1 * (i % 7) as f64 / 7.0 };
    let shapes: Vec<Shape<2>> = scattered(60).enumerate().map(disc).collect();
    let mesh = unit_mesh::<Quad, 2>(17, &Distortion::Wave { amplitude: 0.3 });
    for (own, found) in volume_fractions(&mesh, &shapes).iter().enumerate().skip(1) {
        let alone = Shape::Difference(Box::new(shapes[own].clone()), shapes[..own].to_vec());
        let alone = volume_fractions(&mesh, &[alone]).remove(0);
        let error = found.iter().zip(&alone).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error <= 1e-9, "{own}: {error:e}");
    }
}

/// Without the boxes around them, this takes minutes.
#[test]
fn thousands_of_materials() {
    let disc = |centre: V2| Shape::Sphere { centre, radius: 0.005 };
    let shapes: Vec<Shape<2>> = scattered(6000).map(disc).collect();
    let mesh = unit_mesh::<Quad, 2>(16, &Distortion::None);
    assert_eq!(volume_fractions(&mesh, &shapes).len(), 6000);
}

#[test]
fn time_of_a_sphere() {
    for distortion in [Distortion::None, Distortion::Random { amplitude: 0.2, seed: 1 }] {
        let mesh = unit_mesh::<Hexahedron, 3>(64, &distortion);
        for radius in [0.15, 0.4] {
            let shape = Shape::Sphere { centre: V3::repeat(0.5), radius };
            let exact = shape.volume().expect("a ball has a volume");
            let start = Instant::now();
            let fractions = volume_fractions(&mesh, &[shape]).remove(0);
            let elapsed = start.elapsed();
            let mixed = fractions.iter().filter(|f| **f > 0.0 && **f < 1.0).count();
            let total: f64 = fractions.iter().zip(mesh.volumes()).map(|(f, v)| f * v).sum();
            let error = total / exact - 1.0;
            println!("64^3, {distortion:?}, radius {radius}: {elapsed:?}, {mixed} mixed cells, {error:e}");
            assert!(error.abs() <= TOTAL, "{error:e}");
        }
    }
}

proptest! {
    #![proptest_config(fixed(40, 20_261_127))]

    #[test]
    fn any_ball_on_any_mesh(
        centre in [0.3..0.7, 0.3..0.7, 0.3..0.7], radius in 0.001..0.3, seed in 0_u64..1000, n in 1_usize..6,
    ) {
        let mesh = unit_mesh::<Hexahedron, 3>(n, &Distortion::Random { amplitude: 0.2, seed });
        let ball = Shape::Sphere { centre: centre.into(), radius };
        let exact = ball.volume().expect("a ball has a volume");
        let error = (shape_volume(&mesh, &ball) / exact - 1.0).abs();
        prop_assert!(error <= TOTAL, "{error:e}");
    }

    #[test]
    fn any_ellipse_on_any_mesh(
        centre in [0.4..0.6, 0.4..0.6], axes in [0.01..0.4, 0.01..0.4], angle in 0.0..6.3, seed in 0_u64..1000, n in 1_usize..9,
    ) {
        let mesh = unit_mesh::<Quad, 2>(n, &Distortion::Random { amplitude: 0.2, seed });
        let ellipse =
            Shape::Ellipsoid { centre: centre.into(), semi_axes: axes.into(), rotation: Rotation::from_angle(angle) };
        let exact = ellipse.volume().expect("an ellipse has an area");
        let error = (shape_volume(&mesh, &ellipse) / exact - 1.0).abs();
        prop_assert!(error <= TOTAL, "{error:e}");
    }
}
