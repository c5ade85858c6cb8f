//! Bodies given by their surfaces: against shapes with the same surface, on every kind of mesh, and what is refused.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use vofkit::fractions::{cell_fraction, shape_volume, volume_fractions};
use vofkit::geometry::{Cell, Hexahedron, Quad, Vector};
use vofkit::mesh::Distortion;
use vofkit::shape::{Body, BodyDefect, BodyError, BodyNotice, Rotation, Shape};

use super::{V2, V3, distortions, tilt, unit_mesh};

type Triangles = Vec<[V3; 3]>;

pub(super) fn body<const D: usize>(surface: &[[Vector<D>; D]]) -> Shape<D> {
    Shape::Body(Arc::new(Body::new(surface).expect("the surface is closed")))
}

/// The twelve triangles of a box.
pub(super) fn box_surface(centre: V3, lengths: V3, rotation: &Rotation<3>) -> Triangles {
    let cell = Hexahedron::from_corners(|offset| {
        let half = V3::from_fn(|k, _| lengths[k] * (offset[k] as f64 - 0.5));
        centre + rotation.apply(&half)
    });
    let split = |face: &&[usize]| {
        let x: Vec<V3> = face.iter().map(|&i| cell.nodes()[i]).collect();
        [[x[0], x[1], x[2]], [x[0], x[2], x[3]]]
    };
    Hexahedron::FACE_NODES.iter().flat_map(split).collect()
}

/// A sphere of `2 n (m - 1)` triangles with `n` meridians.
pub(super) fn sphere_surface(centre: V3, radius: f64, n: usize, m: usize) -> Triangles {
    let at = |i: usize, j: usize| {
        let (phi, theta) = (TAU * (i % n) as f64 / n as f64, PI * j as f64 / m as f64);
        let ring = if j == 0 || j == m { 0.0 } else { theta.sin() };
        centre + V3::new(ring * phi.cos(), ring * phi.sin(), -theta.cos()) * radius
    };
    let mut triangles = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if j > 0 {
            triangles.push([a, b, c]);
        }
        if j + 1 < m {
            triangles.push([a, c, d]);
        }
    }
    triangles
}

pub(super) fn loop_of(points: &[[f64; 2]]) -> Vec<[V2; 2]> {
    (0..points.len()).map(|i| [points[i].into(), points[(i + 1) % points.len()].into()]).collect()
}

pub(super) fn star(centre: V2, points: usize, radii: [f64; 2]) -> Vec<[V2; 2]> {
    let corner = |i: usize| {
        let angle = PI * i as f64 / points as f64 + 0.1;
        (centre + V2::new(angle.cos(), angle.sin()) * radii[i % 2]).into()
    };
    loop_of(&(0..2 * points).map(corner).collect::<Vec<[f64; 2]>>())
}

/// The largest difference of the fractions of two shapes.
fn difference<C: Cell<D>, const D: usize>(n: usize, distortion: &Distortion, shapes: [&Shape<D>; 2]) -> f64 {
    let mesh = unit_mesh::<C, D>(n, distortion);
    let [a, b] = shapes.map(|shape| volume_fractions(&mesh, std::slice::from_ref(shape)).remove(0));
    a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn assert_volume<C: Cell<D>, const D: usize>(
    n: usize,
    distortion: &Distortion,
    shape: &Shape<D>,
    tolerance: f64,
) {
    let exact = shape.volume().expect("a body has a volume");
    let error = (shape_volume(&unit_mesh::<C, D>(n, distortion), shape) / exact - 1.0).abs();
    assert!(error <= tolerance, "{n} cells, {distortion:?}: {error:e}");
}

#[test]
fn a_box_of_triangles_is_a_box() {
    let (centre, lengths) = (V3::new(0.47, 0.52, 0.5), V3::new(0.5, 0.3, 0.6));
    for rotation in [Rotation::identity(), tilt()] {
        let shape = Shape::Box { centre, lengths, rotation };
        let surface = box_surface(centre, lengths, &rotation);
        let triangles = body(&surface);
        assert!((triangles.volume().expect("a body has one") - lengths.product()).abs() <= 1e-15);
        for n in [1, 2, 5, 8] {
            let error = difference::<Hexahedron, 3>(n, &Distortion::None, [&triangles, &shape]);
            assert!(error <= 1e-12, "{n} cells: {error:e}");
        }
        for distortion in distortions() {
            let error = difference::<Hexahedron, 3>(8, &distortion, [&triangles, &shape]);
            assert!(error <= 2e-3, "{distortion:?}: {error:e}");
            assert_volume::<Hexahedron, 3>(8, &distortion, &triangles, 1e-4);
        }
    }
}

#[test]
fn a_sphere_of_triangles_has_its_volume_on_any_mesh() {
    let sphere = body(&sphere_surface(V3::new(0.51, 0.48, 0.5), 0.31, 40, 25));
    for n in [1, 3, 8, 20] {
        assert_volume::<Hexahedron, 3>(n, &Distortion::None, &sphere, 1e-12);
    }
    for distortion in distortions() {
        assert_volume::<Hexahedron, 3>(12, &distortion, &sphere, 1e-5);
    }
}

#[test]
fn polygons_are_exact_on_any_mesh() {
    let square = [[0.2, 0.3], [0.8, 0.3], [0.8, 0.7], [0.2, 0.7]];
    let shape =
        Shape::Box { centre: V2::new(0.5, 0.5), lengths: V2::new(0.6, 0.4), rotation: Rotation::identity() };
    let spiky = body(&star(V2::new(0.52, 0.49), 7, [0.45, 0.12]));
    for distortion in distortions() {
        for n in [1, 4, 13] {
            let error = difference::<Quad, 2>(n, &distortion, [&body(&loop_of(&square)), &shape]);
            assert!(error <= 1e-12, "{distortion:?}: {error:e}");
            assert_volume::<Quad, 2>(n, &distortion, &spiky, 1e-12);
        }
    }
}

#[test]
fn a_loop_in_a_loop_is_a_hole() {
    let outer = loop_of(&[[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]]);
    for inner in [[[0.3, 0.3], [0.6, 0.3], [0.6, 0.5]], [[0.6, 0.5], [0.6, 0.3], [0.3, 0.3]]] {
        let both: Vec<_> = outer.iter().copied().chain(loop_of(&inner)).collect();
        let holed = Body::new(&both).expect("closed loops");
        assert!((holed.volume() - (0.64 - 0.03)).abs() <= 1e-15);
        assert!(!holed.contains(&[0.5, 0.35].into()) && holed.contains(&[0.5, 0.6].into()));
        assert_volume::<Quad, 2>(9, &Distortion::None, &Shape::Body(Arc::new(holed)), 1e-12);
    }
}

#[test]
fn shells_are_turned_by_what_is_around_them() {
    let (centre, rotation) = (V3::repeat(0.5), tilt());
    let outer = box_surface(centre, V3::repeat(0.6), &rotation);
    let inner = box_surface(centre, V3::repeat(0.2), &Rotation::identity());
    let turned = |surface: &Triangles| surface.iter().map(|[a, b, c]| [*a, *c, *b]).collect::<Triangles>();
    let hollow = 0.216 - 0.008;
    for (outside, inside, notices) in [
        (outer.clone(), turned(&inner), vec![]),
        (outer.clone(), inner.clone(), vec![BodyNotice::Cavity { triangle: 13, triangles: 12 }]),
        (turned(&outer), turned(&inner), vec![BodyNotice::Turned { triangle: 1, triangles: 12 }]),
    ] {
        let body = Body::new(&[outside, inside].concat()).expect("closed shells");
        assert!((body.volume() - hollow).abs() <= 1e-15, "{}", body.volume());
        assert_eq!(body.notices(), notices);
        assert!(!body.contains(&centre) && body.contains(&V3::new(0.5, 0.5, 0.65)));
        assert_volume::<Hexahedron, 3>(5, &Distortion::None, &Shape::Body(Arc::new(body)), 1e-12);
    }
}

#[test]
fn bodies_join_with_other_shapes() {
    let (centre, lengths, rotation) = (V3::new(0.5, 0.45, 0.5), V3::new(0.4, 0.5, 0.3), tilt());
    let triangles = body(&box_surface(centre, lengths, &rotation));
    let shape = Shape::Box { centre, lengths, rotation };
    let ball = Shape::Sphere { centre: V3::new(0.6, 0.6, 0.55), radius: 0.2 };
    let slab =
        Shape::Box { centre: V3::repeat(0.3), lengths: V3::repeat(0.5), rotation: Rotation::identity() };
    let joined = |own: &Shape<3>| {
        [
            Shape::Union(vec![own.clone(), slab.clone()]),
            Shape::Difference(Box::new(own.clone()), vec![ball.clone()]),
            Shape::Intersection(vec![own.clone(), ball.clone(), slab.clone()]),
        ]
    };
    for (i, (a, b)) in joined(&triangles).iter().zip(&joined(&shape)).enumerate() {
        let error = difference::<Hexahedron, 3>(6, &Distortion::None, [a, b]);
        let tolerance = if i == 0 { 1e-12 } else { 1e-3 };
        assert!(error <= tolerance, "{i}: {error:e}");
    }
    // What an earlier material takes away, in the plane: a disc out of a square.
    let square = body(&loop_of(&[[0.1, 0.1], [0.7, 0.1], [0.7, 0.7], [0.1, 0.7]]));
    let disc = Shape::Sphere { centre: V2::new(0.4, 0.4), radius: 0.2 };
    let mesh = unit_mesh::<Quad, 2>(7, &Distortion::None);
    let fractions = &volume_fractions(&mesh, &[disc, square])[1];
    let area: f64 = fractions.iter().zip(mesh.volumes()).map(|(f, v)| f * v).sum();
    assert!((area - (0.36 - PI * 0.04)).abs() <= 1e-9, "{area}");
}

#[test]
fn bodies_move_with_their_places() {
    let surface = sphere_surface(V3::new(0.1, 0.0, -0.1), 0.2, 12, 7);
    let own = Body::new(&surface).expect("closed");
    let (rotation, shift) = (tilt(), V3::new(1e3, -2e3, 5e2));
    let placed = own.placed(0.5, &rotation, &shift);
    assert!((placed.volume() / own.volume() - 0.125).abs() <= 1e-9);
    let at = |x: V3| rotation.apply(&(x * 0.5)) + shift;
    let cell = |x: V3| Hexahedron::from_corners(|o| x + V3::from_fn(|k, _| 0.1 * o[k] as f64));
    let turned = |x: V3| Hexahedron::from_corners(|o| at(x + V3::from_fn(|k, _| 0.1 * o[k] as f64)));
    for x in [V3::new(0.2, 0.1, -0.15), V3::new(-0.15, -0.1, -0.1), V3::new(0.05, -0.02, -0.12)] {
        let [here, there] = [
            cell_fraction(&cell(x), &Shape::Body(Arc::new(own.clone()))),
            cell_fraction(&turned(x), &Shape::Body(Arc::new(placed.clone()))),
        ];
        assert!((here - there).abs() <= 1e-9, "{here} {there}");
    }
    let shape = Shape::Body(Arc::new(own));
    let moved = shape.moved(&rotation, &V3::new(0.3, 0.2, 0.1), &V3::repeat(0.01));
    assert!((moved.volume().expect("a body") / shape.volume().expect("a body") - 1.0).abs() <= 1e-12);
}

#[test]
fn defects_are_named_with_their_triangles() {
    let surface = box_surface(V3::repeat(0.5), V3::repeat(1.0), &Rotation::identity());
    let defects = |surface: &[[V3; 3]]| match Body::new(surface) {
        Err(BodyError::Defects(defects)) => defects.0,
        other => panic!("{other:?}"),
    };
    assert_eq!(Body::<3>::new(&[]), Err(BodyError::Empty));
    let open = defects(&surface[1..]);
    assert!(open.len() == 3 && open.iter().all(|d| matches!(d, BodyDefect::Open { .. })), "{open:?}");
    let mut turned = surface.clone();
    turned[4].swap(0, 1);
    let found = defects(&turned);
    let names_it =
        |d: &BodyDefect| matches!(d, BodyDefect::TurnedOver { triangles } if triangles.contains(&5));
    assert!(found.len() == 3 && found.iter().all(names_it), "{found:?}");
    let mut odd = surface.clone();
    odd[2][1][0] = f64::NAN;
    odd[7][0][2] = f64::INFINITY;
    let not_finite = [3, 8].map(|triangle| BodyDefect::NotFinite { triangle });
    assert_eq!(defects(&odd), not_finite);
    let branching = [surface.clone(), vec![[surface[0][0], surface[0][1], V3::new(0.5, 0.5, 9.0)]]].concat();
    let message = Body::new(&branching).expect_err("three triangles at an edge").to_string();
    assert!(message.contains("meet at one edge") && message.contains("13"), "{message}");
    let flat = [[V3::zeros(), V3::x(), V3::y()], [V3::zeros(), V3::y(), V3::x()]];
    assert_eq!(Body::new(&flat), Err(BodyError::Flat { triangles: 2, extent: 1.0 }));
    let large = surface.iter().map(|piece| piece.map(|x| x * 1e100)).collect::<Triangles>();
    assert_eq!(Body::new(&large), Err(BodyError::Range { extent: 1e100 }));
    // One corner far away: what the rest encloses is nothing beside that.
    let far = |x: V3| if x.min() >= 1.0 { V3::repeat(3e38) } else { x };
    let stretched = surface.iter().map(|piece| piece.map(far)).collect::<Triangles>();
    assert_eq!(Body::new(&stretched), Err(BodyError::Flat { triangles: 12, extent: 3e38 }));
}
