//! Surfaces that cross or overlap themselves are refused, those whose parts touch are not.

use vofkit::geometry::Vector;
use vofkit::shape::{Body, BodyDefect, BodyError, Rotation};

use super::bodies::{box_surface, loop_of, sphere_surface};
use super::{V3, tilt};

fn cube(centre: [f64; 3], length: f64) -> Vec<[V3; 3]> {
    box_surface(centre.into(), V3::repeat(length), &Rotation::identity())
}

/// A surface in every place: as it is, tilted, and with the rounding of single precision.
fn placed(surface: &[[V3; 3]]) -> [Vec<[V3; 3]>; 3] {
    let tilted = |x: V3| tilt().apply(&x) + V3::new(0.3, -0.2, 0.7);
    let single = |x: V3| tilted(x).map(|x| f64::from(x as f32));
    let all = |place: &dyn Fn(V3) -> V3| surface.iter().map(|piece| piece.map(place)).collect();
    [surface.to_vec(), all(&tilted), all(&single)]
}

fn defects<const D: usize>(surface: &[[Vector<D>; D]]) -> Vec<BodyDefect> {
    match Body::new(surface) {
        Err(BodyError::Defects(defects)) => defects.0,
        other => panic!("{:?}", other.map(|body| body.volume())),
    }
}

#[test]
fn overlapping_shells_are_refused_with_their_triangles() {
    let unit = cube([0.0; 3], 1.0);
    let turned = box_surface(V3::new(0.4, 0.3, 0.2), V3::repeat(1.0), &tilt());
    let doubled = [0.0, 1e-9, 1e-7].map(|shift| cube([shift, 0.0, -shift], 1.0));
    let others = [
        ("past a corner", cube([0.4, 0.3, 0.2], 1.0)),
        ("turned", turned),
        ("through", box_surface(V3::zeros(), V3::new(0.4, 0.5, 3.0), &Rotation::identity())),
        ("flush on four sides", cube([0.5, 0.0, 0.0], 1.0)),
        ("flush on four sides, longer", box_surface(V3::x(), V3::new(2.0, 1.0, 1.0), &Rotation::identity())),
        ("flush on two sides", cube([0.25, 0.25, 0.0], 1.0)),
    ];
    let others = others.into_iter().chain(doubled.map(|other| ("the same", other)));
    for (name, other) in others {
        for (i, surface) in placed(&[unit.clone(), other].concat()).iter().enumerate() {
            let found = defects(surface);
            let named = |defect: &BodyDefect| match *defect {
                BodyDefect::Crossing { triangles: [a, b] } => a <= 12 && b > 12 && b <= 24,
                BodyDefect::Overlapping { triangle, winding } => triangle <= 24 && [-1, 2].contains(&winding),
                _ => false,
            };
            assert!(found.iter().all(named), "{name}, place {i}: {found:?}");
        }
    }
    let boxes = [unit, cube([0.4, 0.3, 0.2], 1.0)].concat();
    let message = Body::new(&boxes).expect_err("they overlap").to_string();
    assert!(message.contains("run through each other"), "{message}");
}

#[test]
fn shells_that_cross_themselves_are_refused() {
    let own = sphere_surface(V3::zeros(), 1.0, 24, 16);
    for (depth, crosses) in [(-0.9, false), (-1.1, true)] {
        let pushed = |x: V3| if (x - V3::z()).norm() <= 1e-9 { V3::new(0.03, 0.02, depth) } else { x };
        let surface: Vec<_> = own.iter().map(|piece| piece.map(pushed)).collect();
        for surface in placed(&surface) {
            match crosses {
                true => {
                    let found = defects(&surface);
                    assert!(found.iter().all(|d| matches!(d, BodyDefect::Crossing { .. })), "{found:?}");
                }
                false => assert!(Body::new(&surface).is_ok()),
            }
        }
    }
}

#[test]
fn outlines_that_cross_themselves_are_refused() {
    let eight = loop_of(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_eq!(defects(&eight), [BodyDefect::Crossing { triangles: [1, 3] }]);
    // The second half of an eight runs the other way round, also where both halves meet at a corner.
    let halves = loop_of(&[[0.0, 0.0], [-1.0, 1.0], [-1.0, -1.0], [0.0, 0.0], [1.0, 0.5], [1.0, -0.5]]);
    let turned = [4, 5, 6].map(|triangle| BodyDefect::Overlapping { triangle, winding: -1 });
    assert_eq!(defects(&halves), turned);
}

#[test]
fn touching_shells_are_no_overlap() {
    let unit = cube([0.0; 3], 1.0);
    let ball = sphere_surface(V3::new(0.1, 0.2, 1.0), 0.5, 8, 6);
    let both = 1.0 + Body::new(&ball).expect("closed").volume();
    let hollow = [unit.clone(), cube([0.0; 3], 0.6)].concat();
    let around = |distance: f64| {
        (0..6).flat_map(move |side| {
            let mut centre = [0.0; 3];
            centre[side % 3] = if side < 3 { distance } else { -distance };
            cube(centre, 1.0)
        })
    };
    let cases = [
        ("apart", [unit.clone(), cube([1.5, 0.2, 0.1], 1.0)].concat(), 2.0),
        ("a cavity", hollow.clone(), 1.0 - 0.216),
        ("an island in it", [hollow, cube([0.0; 3], 0.3)].concat(), 1.0 - 0.216 + 0.027),
        ("a cavity at the wall", [unit.clone(), cube([0.25, 0.1, 0.0], 0.5)].concat(), 0.875),
        ("stacked", [unit.clone(), cube([0.0, 0.0, 1.0], 1.0)].concat(), 2.0),
        ("stacked below", [unit.clone(), cube([0.0, 0.0, -1.0], 1.0)].concat(), 2.0),
        ("stacked with a step", [unit.clone(), cube([0.3, -0.2, 0.75], 0.5)].concat(), 1.125),
        ("touched on all sides", unit.iter().copied().chain(around(1.0)).collect(), 7.0),
        ("at an edge", [unit.clone(), cube([1.0, 1.0, 0.0], 1.0)].concat(), 2.0),
        ("along a part of an edge", [unit.clone(), cube([1.0, 1.0, 0.3], 1.0)].concat(), 2.0),
        ("at a corner", [unit.clone(), cube([1.0; 3], 1.0)].concat(), 2.0),
        ("a corner on a face", [unit, ball].concat(), both),
    ];
    for (name, surface, volume) in cases {
        for (i, surface) in placed(&surface).iter().enumerate() {
            let body = Body::new(surface).unwrap_or_else(|error| panic!("{name}, place {i}: {error}"));
            let error = (body.volume() - volume).abs();
            assert!(error <= 1e-6, "{name}, place {i}: {error:e}");
        }
    }
    // Two triangles that meet at a corner, and the same corner twice in one loop.
    let bow = loop_of(&[[0.0, 0.0], [0.5, 0.5], [1.0, 0.0], [1.0, 1.0], [0.5, 0.5], [0.0, 1.0]]);
    assert!((Body::new(&bow).expect("it only touches itself").volume() - 0.5).abs() <= 1e-15);
}

#[test]
fn heaps_of_cubes_are_no_overlap() {
    for turn in 0..60 {
        let axis = V3::new(1.0, 0.3 * f64::from(turn), -0.7);
        let rotation = Rotation::from_axis_angle(axis, 0.1 * f64::from(turn));
        let places = (0..27).filter(|i| (i * (turn + 3) + turn) % 5 < 3);
        let centres: Vec<V3> =
            places.map(|i| V3::new((i % 3).into(), (i / 3 % 3).into(), (i / 9).into())).collect();
        let own =
            centres.iter().flat_map(|centre| box_surface(*centre, V3::repeat(1.0), &Rotation::identity()));
        let at = |x: V3| (rotation.apply(&x) + V3::repeat(0.1)).map(|x| f64::from(x as f32));
        let turned = centres.iter().flat_map(|centre| box_surface(at(*centre), V3::repeat(1.0), &rotation));
        let turned = turned.map(|piece| piece.map(|x| x.map(|x| f64::from(x as f32))));
        for surface in [own.collect::<Vec<_>>(), turned.collect()] {
            let body = Body::new(&surface).unwrap_or_else(|error| panic!("turn {turn}: {error}"));
            let error = (body.volume() - centres.len() as f64).abs();
            assert!(error <= 1e-5, "turn {turn}: {error:e}");
        }
    }
}

/// Were each triangle checked against each other one, this would be billions of checks.
#[test]
fn a_large_surface_is_checked() {
    let surface = sphere_surface(V3::repeat(0.5), 0.4, 200, 201);
    assert_eq!(Body::new(&surface).expect("a sphere").piece_count(), 80_000);
}
