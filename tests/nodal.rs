//! Quantities at nodes and integration points, and moving meshes: conservation, constancy, bounds and what stays when nothing moves.

mod common;

use common::{Mesh2, Mesh3, random, unit_mesh};
use vofkit::geometry::{Cell, Vector};
use vofkit::mesh::{Distortion, Grid, Mesh, MeshMotion, MeshPath, SweptVolumes};
use vofkit::metrics::{absolute_integral, extremes, integral};
use vofkit::nodal::{NodalScheme, nodal_amounts, nodal_integral};
use vofkit::profile::Profile;
use vofkit::shape::Shape;
use vofkit::velocity::{FaceFluxes, Field};
use vofkit::volume_associated::points::{cell_means, count, local, redistribute};
use vofkit::volume_associated::{Limiter, Quantity, Scheme, Splitting, VolumeTransport, Weighting};

/// A profile with jumps and different values everywhere.
fn bumpy<const D: usize>() -> Profile<D> {
    let ball = |at: f64, radius: f64| Shape::Sphere { centre: Vector::repeat(at), radius };
    Profile::Inclusions { background: 0.3, shapes: vec![(ball(0.4, 0.2), 1.0), (ball(0.7, 0.25), -0.6)] }
}

/// The node values of a profile.
fn at_nodes<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, profile: &Profile<D>) -> Vec<f64> {
    mesh.nodes().iter().map(|x| profile.value(x)).collect()
}

fn schemes() -> [Scheme; 4] {
    [Scheme::Donor, Scheme::Muscl(Limiter::VanLeer), Scheme::Tvd(Limiter::CourantMinMod), Scheme::Fct]
}

fn keeps_constants_on_moving_meshes<C: Cell<D>, const D: usize>(
    start: Mesh<C, D>,
    motion: MeshMotion<D>,
    splitting: Splitting,
) {
    let steps = 12;
    let path = MeshPath::new(start, motion).expect("a motion");
    let quantities: Vec<Quantity> = schemes()
        .into_iter()
        .flat_map(|scheme| [Quantity { scheme, ..Quantity::default() }; 2])
        .chain([Quantity { weighting: Weighting::Mass(1), ..Quantity::default() }; 2])
        .collect();
    let mut from = path.start().clone();
    let varied = bumpy().cell_means(&from).iter().map(|v| v + 1.0).collect::<Vec<f64>>();
    let constant = vec![0.7; varied.len()];
    let mut values: Vec<Vec<f64>> =
        (0..quantities.len()).map(|k| if k % 2 == 0 { constant.clone() } else { varied.clone() }).collect();
    let [low, high] = extremes(&varied);
    let start = integral(&from, &varied);
    let mut transport = VolumeTransport::new(&from, splitting, false);
    for step in 0..steps {
        let to = path.mesh((step + 1) as f64 / steps as f64).expect("valid cells");
        let swept = SweptVolumes::new(&from, &to).expect("one grid");
        transport.set_mesh(&from);
        transport.remesh(&swept, step, &quantities, &mut values).expect("a valid step");
        from = to;
    }
    let scale = absolute_integral(&from, &varied);
    for (k, values) in values.iter().enumerate() {
        if k % 2 == 0 {
            let [a, b] = extremes(values);
            assert!(0.7 - a <= 1e-13 && b - 0.7 <= 1e-13, "{:?}: {a} {b}", quantities[k]);
        } else if quantities[k].weighting == Weighting::Volume {
            let drift = integral(&from, values) - start;
            assert!(drift.abs() <= 1e-13 * scale, "{:?}: {drift:e}", quantities[k]);
        }
        if splitting != Splitting::Isotropic
            && matches!(quantities[k].scheme, Scheme::Donor | Scheme::Muscl(_))
        {
            let [a, b] = extremes(values);
            assert!(a >= low.min(0.7) - 1e-12 && b <= high + 1e-12, "{:?}: {a} {b}", quantities[k]);
        }
    }
}

#[test]
fn a_constant_stays_on_any_moving_mesh() {
    let plane: Mesh2 = unit_mesh(10, random(0.15, 3));
    let space: Mesh3 = unit_mesh(6, random(0.1, 4));
    for splitting in [Splitting::Isotropic, Splitting::Alternating, Splitting::Symmetric] {
        let wave = || Distortion::Wave { amplitude: 0.3 };
        keeps_constants_on_moving_meshes(
            plane.clone(),
            MeshMotion::Distort { distortion: wave(), swings: 2 },
            splitting,
        );
        keeps_constants_on_moving_meshes(plane.clone(), MeshMotion::Smooth { swings: 1 }, splitting);
        keeps_constants_on_moving_meshes(
            space.clone(),
            MeshMotion::Distort { distortion: wave(), swings: 1 },
            splitting,
        );
    }
}

#[test]
fn integration_points_keep_the_mean() {
    let mesh: Mesh3 = unit_mesh(6, random(0.2, 9));
    let means = bumpy().cell_means(&mesh);
    let scale = absolute_integral(&mesh, &means);
    for limiter in [None, Some(Limiter::MinMod), Some(Limiter::Superbee), Some(Limiter::Off)] {
        let points = redistribute(&mesh, limiter, &means);
        assert_eq!(points.len(), 8);
        let back = cell_means(&mesh, &points);
        let error = back.iter().zip(&means).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error <= 1e-14, "{limiter:?}: {error:e}");
        assert!((integral(&mesh, &back) - integral(&mesh, &means)).abs() <= 1e-14 * scale);
        assert!(points.iter().any(|values| values != &means) == limiter.is_some());
    }
}

#[test]
fn a_linear_field_is_right_at_the_integration_points() {
    let mesh: Mesh2 = Mesh::unit([5, 4], &Distortion::None).expect("a valid mesh");
    let linear = |x: &Vector<2>| 0.5 + 2.0 * x[0] - 3.0 * x[1];
    let means: Vec<f64> = (0..20).map(|i| linear(&mesh.cell(i).map(&Vector::repeat(0.5)))).collect();
    let points = redistribute(&mesh, Some(Limiter::MinMod), &means);
    // Cells at the ends have no slope.
    for index in [6, 7, 8, 11, 12, 13] {
        for (number, values) in points.iter().enumerate().take(count(2)) {
            let wanted = linear(&mesh.cell(index).map(&local(number)));
            assert!((values[index] - wanted).abs() <= 1e-14, "{index} {number}");
        }
    }
}

fn momentum_lasts<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, field: Field, by_mass: bool) {
    let grid = mesh.grid();
    let fluxes = FaceFluxes::new(mesh, &field).expect("in range");
    let duration = 0.4 / fluxes.courant_rate(mesh);
    for (scheme, nodal) in schemes()
        .into_iter()
        .flat_map(|scheme| [NodalScheme::HalfIndexShift, NodalScheme::Averaging].map(|n| (scheme, n)))
    {
        let mut density: Vec<f64> = bumpy().cell_means(mesh).iter().map(|v| 1.0 + v).collect();
        let amounts = |density: &[f64]| -> Vec<f64> {
            let of_cell = |(v, rho): (&f64, &f64)| if by_mass { v * rho } else { *v };
            mesh.volumes().iter().zip(density).map(of_cell).collect()
        };
        let mut nodes = at_nodes(mesh, &bumpy());
        // Images of a node have one value.
        nodes = nodes
            .iter()
            .enumerate()
            .map(|(node, _)| {
                let at = grid.node_offset(node);
                nodes[grid.node_index(std::array::from_fn(|k| {
                    if grid.periodic()[k] { at[k] % grid.cells()[k] } else { at[k] }
                }))]
            })
            .collect();
        let (start, [low, high]) = (nodes.clone(), extremes(&nodes));
        let magnitudes: Vec<f64> = start.iter().map(|v| v.abs()).collect();
        let before = nodal_integral(grid, &nodes, &amounts(&density));
        let scale = nodal_integral(grid, &magnitudes, &amounts(&density));
        let weighting = if by_mass { Weighting::Mass(0) } else { Weighting::Volume };
        let mut quantities = vec![Quantity { scheme, ..Quantity::default() }];
        quantities.extend(vec![Quantity { scheme, weighting, inflow: None }; nodal.quantities(D)]);
        let mut transport = VolumeTransport::new(mesh, Splitting::Alternating, false);
        for step in 0..4 {
            let mut values = vec![density.clone()];
            values.extend(nodal.to_cells(grid, &nodes));
            transport.flow(&fluxes, duration, step, &quantities, &mut values).expect("a valid step");
            density.clone_from(&values[0]);
            nodal.to_nodes(grid, &values[1..], &amounts(&density), &mut nodes);
        }
        let drift = nodal_integral(grid, &nodes, &amounts(&density)) - before;
        assert!(drift.abs() <= 1e-13 * scale, "{scheme:?} {nodal:?}: {drift:e} of {scale:e}");
        assert_ne!(nodes, start);
        if matches!(scheme, Scheme::Donor | Scheme::Muscl(_)) {
            let [a, b] = extremes(&nodes);
            assert!(low - a <= 1e-12 && b - high <= 1e-12, "{scheme:?} {nodal:?}: {a} {b}");
        }
    }
}

#[test]
fn the_momentum_of_the_nodes_lasts() {
    let plane: Mesh2 = unit_mesh(9, random(0.2, 2));
    let joined: Mesh2 =
        Mesh::new(Grid::new([8, 7], [true; 2]), Vector::zeros(), Vector::repeat(1.0), &random(0.2, 6))
            .expect("valid");
    let space: Mesh3 = unit_mesh(5, random(0.15, 7));
    for by_mass in [false, true] {
        momentum_lasts(&plane, Field::ReversedVortex, by_mass);
        momentum_lasts(&joined, Field::Uniform { velocity: [1.0, 0.4, 0.0].into() }, by_mass);
        momentum_lasts(&space, Field::Deformation3d, by_mass);
    }
}

#[test]
fn without_motion_the_shift_keeps_the_values_and_averaging_does_not() {
    let mesh: Mesh2 = unit_mesh(7, random(0.2, 5));
    let grid = mesh.grid();
    let start = at_nodes(&mesh, &bumpy());
    let there_and_back = |scheme: NodalScheme| {
        let mut nodes = start.clone();
        scheme.to_nodes(grid, &scheme.to_cells(grid, &start), mesh.volumes(), &mut nodes);
        start.iter().zip(&nodes).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(there_and_back(NodalScheme::HalfIndexShift) <= 1e-15);
    assert!(there_and_back(NodalScheme::Averaging) >= 0.1);
    let volumes = nodal_amounts(grid, mesh.volumes());
    assert!((volumes.iter().sum::<f64>() - 1.0).abs() <= 1e-14);
    // A node without mass around it keeps its value.
    let mut nodes = start.clone();
    let cells = NodalScheme::HalfIndexShift.to_cells(grid, &start);
    NodalScheme::HalfIndexShift.to_nodes(grid, &cells, &vec![0.0; grid.len()], &mut nodes);
    assert_eq!(nodes, start);
}
