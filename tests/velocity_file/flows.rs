//! The same results as from the formulas.

use vofkit::advection::{Scheme, Settings, SweepAxes, SweepOrder, Transport};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, Hexahedron, Quad, Vector};
use vofkit::import::NodalVelocity;
use vofkit::mesh::{Distortion, Mesh};
use vofkit::shape::Shape;
use vofkit::velocity::{Divergence, Field, Flow, Reversal, Sampled};

use crate::common::{Mesh2, Mesh3, drift, random, run, steady, unit_mesh};
use crate::{sampled, write};

fn settings<const D: usize>(scheme: Scheme, axes: SweepAxes) -> Settings<D> {
    Settings { scheme, axes, order: SweepOrder::Symmetric, ..Settings::default() }
}

const SCHEMES: [(Scheme, SweepAxes); 4] = [
    (Scheme::Sweeps, SweepAxes::Logical),
    (Scheme::Sweeps, SweepAxes::Cartesian),
    (Scheme::Isotropic, SweepAxes::Logical),
    (Scheme::Unsplit, SweepAxes::Logical),
];

/// The largest difference of fractions after some steps by a field and by its samples, which must be free of divergence.
fn difference<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    field: Field,
    (scheme, axes): (Scheme, SweepAxes),
) -> f64 {
    let ball = Shape::Sphere { centre: Vector::repeat(0.45), radius: 0.25 };
    let start = volume_fractions(mesh, &[ball]);
    let samples = Sampled::new(mesh, vec![(0.0, sampled(mesh, &field))], Divergence::Error).expect("exact");
    let flow = Flow::sampled(samples, Reversal::None);
    let settings = settings(scheme, axes);
    let mut transports = [
        Transport::new(mesh, steady(field), settings).expect("no walls"),
        Transport::with_flow(mesh, flow, settings).expect("no walls"),
    ];
    let end = 6.0 * 0.4 / transports[0].courant_rate();
    let [a, b] = transports.each_mut().map(|transport| {
        let mut fractions = start.clone();
        let ledger = run(transport, &mut fractions, 6, end).expect("a short step");
        if axes == SweepAxes::Logical && scheme != Scheme::Isotropic {
            let drift = drift(mesh, &start[0], &fractions[0], ledger.materials[0].outflow);
            assert!(drift.abs() <= 1e-13, "{scheme}: drift {drift:e}");
        }
        assert_eq!(ledger.materials[0].dilated, 0.0);
        fractions
    });
    a[0].iter().zip(&b[0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn uniform_velocities_move_like_their_formula() {
    let plane = Field::Uniform { velocity: [0.7, -0.4, 0.0].into() };
    let space = Field::Uniform { velocity: [0.7, -0.4, 0.5].into() };
    for distortion in [Distortion::None, random(0.2, 3)] {
        let (flat, solid): (Mesh2, Mesh3) = (unit_mesh(16, distortion.clone()), unit_mesh(7, distortion));
        for scheme in SCHEMES {
            let difference = [difference(&flat, plane, scheme), difference(&solid, space, scheme)];
            assert!(difference.iter().all(|&d| d <= 1e-12), "{scheme:?}: {difference:?}");
        }
    }
}

/// The interpolation is exact for a rotation, so that the fluxes are those of the formula; nodes are traced back to second order.
#[test]
fn rotations_move_like_their_formula() {
    let about = |angular_velocity: [f64; 3]| Field::Rotation {
        centre: Vector::<3>::repeat(0.5),
        angular_velocity: angular_velocity.into(),
    };
    for distortion in [Distortion::None, random(0.2, 5)] {
        let (flat, solid): (Mesh2, Mesh3) = (unit_mesh(16, distortion.clone()), unit_mesh(7, distortion));
        for scheme in SCHEMES {
            // Alone the unsplit scheme traces the formula to higher order.
            let most = if scheme.0 == Scheme::Unsplit { 2e-3 } else { 1e-8 };
            let difference = [
                difference(&flat, about([0.0, 0.0, 1.0]), scheme),
                difference(&solid, about([0.4, -0.2, 1.0]), scheme),
            ];
            assert!(difference.iter().all(|&d| d <= most), "{scheme:?}: {difference:?}");
        }
    }
}

#[test]
fn a_series_is_linear_in_time_and_constant_beyond() {
    let mesh: Mesh2 = unit_mesh(4, random(0.2, 1));
    let along = |x: f64, y: f64| vec![Vector::<2>::new(x, y); mesh.nodes().len()];
    let series = vec![(1.0, along(1.0, 0.0)), (2.0, along(0.0, 2.0)), (4.0, along(-1.0, 0.0))];
    let samples = Sampled::new(&mesh, series, Divergence::Error).expect("uniform");
    let shift = |reversal: Reversal, start: f64, end: f64| {
        Flow::sampled(samples.clone(), reversal).step(start, end).straight(&mesh, 7)
    };
    let cases = [
        ([0.0, 0.5], [0.5, 0.0]),
        ([1.0, 2.0], [0.5, 1.0]),
        ([1.5, 1.75], [0.09375, 0.3125]),
        ([0.0, 5.0], [1.0 + 0.5 - 1.0 - 1.0, 1.0 + 2.0]),
        ([4.5, 5.0], [-0.5, 0.0]),
    ];
    for ([start, end], expected) in cases {
        let shift = shift(Reversal::None, start, end);
        assert!((shift - Vector::<2>::from(expected)).amax() <= 1e-15, "{start} to {end}: {shift}");
    }
    // A reversal acts on all of it; what flips in the middle of a step is split there.
    let there = shift(Reversal::Flip { time: 1.5 }, 1.25, 1.5);
    let all = shift(Reversal::Flip { time: 1.5 }, 1.25, 1.75);
    let back = shift(Reversal::None, 1.5, 1.75);
    assert!((all - there + back).amax() <= 1e-15);
    let by_midpoints: Vector<2> = (0..4000)
        .map(|i| {
            let t = 0.5 + (f64::from(i) + 0.5) / 1000.0;
            let period = 3.0;
            Flow::sampled(samples.clone(), Reversal::Cosine { period }).cell_velocities(&mesh, t)[3] / 1000.0
        })
        .sum();
    let parts: Vector<2> = (0..40)
        .map(|i| shift(Reversal::Cosine { period: 3.0 }, 0.5 + 0.1 * f64::from(i), 0.6 + 0.1 * f64::from(i)))
        .sum();
    assert!((parts - by_midpoints).amax() <= 1e-5, "{parts} {by_midpoints}");
}

#[test]
fn cell_data_go_to_the_nodes_by_volume() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cells.vts");
    let nodes = [[0.0, 0.0], [1.0, 0.0], [4.0, 0.0], [0.0, 1.0], [1.0, 1.0], [4.0, 1.0]];
    let grid = vofkit::mesh::Grid::new([2, 1], [false; 2]);
    let mesh = Mesh::<Quad, 2>::from_nodes(grid, nodes.map(Vector::<2>::from).to_vec()).unwrap();
    write(&path, &mesh, &[Vector::<2>::new(4.0, 1.0), Vector::<2>::new(8.0, -1.0)]);
    let found = NodalVelocity::read(&path).unwrap().on(&mesh).unwrap();
    assert_eq!(found[0], Vector::<2>::new(4.0, 1.0));
    assert_eq!(found[1], Vector::<2>::new(7.0, -0.5));
    assert_eq!(found[5], Vector::<2>::new(8.0, -1.0));
    // Uniform velocities are the same in cells and at nodes.
    let mesh: Mesh<Hexahedron, 3> = unit_mesh(3, random(0.2, 2));
    write(&path, &mesh, &vec![Vector::<3>::new(1.0, -2.0, 0.5); 27]);
    let found = NodalVelocity::read(&path).unwrap().on(&mesh).unwrap();
    assert!(found.iter().all(|u| (u - Vector::<3>::new(1.0, -2.0, 0.5)).amax() <= 1e-15));
}
