//! Quantities at nodes and integration points, schemes at these, and moving meshes: conservation, constancy, bounds and what stays when nothing moves.

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
use vofkit::volume_associated::{
    AlphaRange, Limiter, PointError, PointScheme, PointTransport, Quantity, Scheme, Smoothing, Splitting,
    VolumeMatrix, VolumeTransport, Weighting,
};

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
            transport.flow(&fluxes.step(duration), step, &quantities, &mut values).expect("a valid step");
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

const MATRICES: [VolumeMatrix; 2] = [VolumeMatrix::Lumped, VolumeMatrix::Consistent];

fn direct(local: bool, alpha: f64, matrix: VolumeMatrix) -> PointScheme {
    PointScheme::Direct { smoothing: Smoothing { local, alpha }, matrix }
}

/// Every scheme at points with either volume matrix.
fn point_schemes() -> Vec<PointScheme> {
    let smoothings = [(false, 0.0), (true, 0.0), (false, 1.0), (true, 1.0), (false, 0.6), (true, 1.4)];
    let of_matrix = |matrix: VolumeMatrix| {
        let galerkin = PointScheme::LaxWendroffGalerkin { matrix };
        smoothings.map(|(local, alpha)| direct(local, alpha, matrix)).into_iter().chain([galerkin])
    };
    MATRICES.into_iter().flat_map(of_matrix).collect()
}

fn bar(cells: usize) -> Mesh2 {
    let grid = Grid::new([cells, 1], [true, false]);
    Mesh::new(grid, Vector::zeros(), [1.0, 1.0 / cells as f64].into(), &Distortion::None).expect("valid")
}

fn constants_last_at_points<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>) {
    let displacement: Vec<Vector<D>> =
        mesh.nodes().iter().map(|x| Vector::from_fn(|axis, _| 0.03 * (3.0 * x[axis] + 1.0).sin())).collect();
    let mut transport = PointTransport::new(mesh).expect("no folded cell");
    for scheme in point_schemes() {
        for points in [1, count(D)] {
            let mut values = vec![vec![0.7; mesh.grid().len()]; points];
            (0..5).for_each(|_| transport.step(mesh, &displacement, scheme, &mut values).expect("finite"));
            let [low, high] = extremes(&values.concat());
            assert!(0.7 - low <= 1e-13 && high - 0.7 <= 1e-13, "{scheme:?}: {low} {high}");
        }
    }
}

#[test]
fn constants_last_at_points_on_any_mesh() {
    let plane: Mesh2 = unit_mesh(9, random(0.25, 12));
    let joined: Mesh2 =
        Mesh::new(Grid::new([7, 5], [true, false]), Vector::zeros(), Vector::repeat(1.0), &random(0.2, 6))
            .expect("valid");
    let space: Mesh3 = unit_mesh(4, random(0.2, 13));
    constants_last_at_points(&plane);
    constants_last_at_points(&joined);
    constants_last_at_points(&space);
}

fn a_linear_field_is_moved_exactly<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>) {
    let slope = Vector::<D>::from_fn(|axis, _| 1.0 - 1.7 * axis as f64);
    let linear = |x: Vector<D>| 0.4 + slope.dot(&x);
    let at_points = |shift: &Vector<D>| -> Vec<Vec<f64>> {
        let at_point = |number: usize| {
            (0..mesh.grid().len()).map(|cell| linear(mesh.cell(cell).map(&local(number)) - shift)).collect()
        };
        (0..count(D)).map(at_point).collect()
    };
    let shift = Vector::<D>::from_fn(|axis, _| 0.02 + 0.01 * axis as f64);
    let displacement = vec![shift; mesh.nodes().len()];
    let mut transport = PointTransport::new(mesh).expect("no folded cell");
    for alpha in [0.0, 0.6, 1.0] {
        let mut values = at_points(&Vector::zeros());
        let scheme = direct(false, alpha, VolumeMatrix::Consistent);
        transport.step(mesh, &displacement, scheme, &mut values).expect("finite");
        for (value, wanted) in values.concat().iter().zip(at_points(&shift).concat()) {
            assert!((value - wanted).abs() <= 1e-12, "{alpha}: {value} {wanted}");
        }
    }
}

/// The consistent matrix finds the nodal values of a linear field again, on any mesh.
#[test]
fn the_direct_scheme_moves_a_linear_field_exactly() {
    let plane: Mesh2 = unit_mesh(8, random(0.25, 3));
    let space: Mesh3 = unit_mesh(4, random(0.2, 5));
    a_linear_field_is_moved_exactly(&plane);
    a_linear_field_is_moved_exactly(&space);
}

/// On a bar of equal cells with one value each, lumped projections are centred differences: both schemes are that of Lax and Wendroff, the
/// direct one where `alpha = 2 Cr^2`.
#[test]
fn on_a_bar_both_schemes_are_that_of_lax_and_wendroff() {
    let mesh = bar(24);
    let start: Vec<f64> = (0..24).map(|i| f64::from(i * i % 7) / 7.0).collect();
    let fluxes = FaceFluxes::new(&mesh, &Field::Uniform { velocity: Vector::<3>::x() }).expect("in range");
    for courant in [0.2, 0.5, 0.9] {
        let shift = courant / 24.0;
        let mut by_faces = vec![start.clone()];
        let quantity = Quantity { scheme: Scheme::LaxWendroff, ..Quantity::default() };
        let mut volumes = VolumeTransport::new(&mesh, Splitting::Isotropic, false);
        let mut points = PointTransport::new(&mesh).expect("no folded cell");
        let lumped = VolumeMatrix::Lumped;
        let schemes = [
            direct(false, 2.0 * courant * courant, lumped),
            PointScheme::LaxWendroffGalerkin { matrix: lumped },
        ];
        let mut by_points = vec![vec![start.clone()]; schemes.len()];
        let displacement = vec![[shift, 0.0].into(); mesh.nodes().len()];
        for step in 0..20 {
            volumes.flow(&fluxes.step(shift), step, &[quantity], &mut by_faces).expect("a valid step");
            for (scheme, values) in schemes.iter().zip(&mut by_points) {
                points.step(&mesh, &displacement, *scheme, values).expect("finite");
            }
        }
        for (scheme, values) in schemes.iter().zip(&by_points) {
            for (value, wanted) in values[0].iter().zip(&by_faces[0]) {
                assert!((value - wanted).abs() <= 1e-12, "{scheme:?}: {value} {wanted}");
            }
        }
    }
}

/// Which waves the direct scheme lets grow on equal cells with one value: none for `2 Cr^2 <= alpha <= 2`.
#[test]
fn smoothing_keeps_waves_from_growing() {
    let cells = 16;
    let mesh = bar(cells);
    let mut transport = PointTransport::new(&mesh).expect("no folded cell");
    let mut growth = |courant: f64, alpha: f64| {
        let displacement = vec![[courant / cells as f64, 0.0].into(); mesh.nodes().len()];
        let largest = |waves: usize| {
            let wave = |i: usize| (std::f64::consts::TAU * (waves * i) as f64 / cells as f64).cos();
            let mut values = vec![(0..cells).map(wave).collect::<Vec<f64>>()];
            let norm = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>().sqrt();
            let before = norm(&values[0]);
            transport
                .step(&mesh, &displacement, direct(false, alpha, VolumeMatrix::Lumped), &mut values)
                .expect("finite");
            norm(&values[0]) / before
        };
        (0..=cells / 2).map(largest).fold(0.0, f64::max)
    };
    for courant in [0.1, 0.25, 0.5] {
        assert!(growth(courant, 0.0) > 1.0 + 1e-3, "{courant}");
        // Eq. 43.
        for alpha in [courant, 1.5 * courant, 2.0 * courant] {
            assert!(growth(courant, alpha) <= 1.0 + 1e-12, "{courant} {alpha}");
        }
    }
    for courant in [0.7, 0.9] {
        assert!(growth(courant, courant) > 1.0 + 1e-3, "{courant}");
        assert!(growth(courant, 2.0 * courant * courant) <= 1.0 + 1e-12, "{courant}");
    }
}

#[test]
fn without_motion_and_smoothing_points_keep_their_bits() {
    let mesh: Mesh3 = unit_mesh(4, random(0.2, 8));
    let still = vec![Vector::zeros(); mesh.nodes().len()];
    let start: Vec<Vec<f64>> =
        (0..8).map(|k| bumpy().cell_means(&mesh).iter().map(|v| v * f64::from(k)).collect()).collect();
    let mut transport = PointTransport::new(&mesh).expect("no folded cell");
    for matrix in MATRICES {
        for scheme in [
            direct(false, 0.0, matrix),
            direct(true, 0.0, matrix),
            PointScheme::LaxWendroffGalerkin { matrix },
        ] {
            let mut values = start.clone();
            transport.step(&mesh, &still, scheme, &mut values).expect("finite");
            assert_eq!(values, start, "{scheme:?}");
        }
    }
}

#[test]
fn wrong_values_at_points_are_refused() {
    let mesh: Mesh2 = unit_mesh(4, Distortion::None);
    let mut transport = PointTransport::new(&mesh).expect("no folded cell");
    let still = vec![Vector::zeros(); 25];
    let scheme = direct(true, 1.0, VolumeMatrix::Lumped);
    let mut refused = |displacement: &[Vector<2>], scheme: PointScheme, values: &[Vec<f64>]| {
        let mut values = values.to_vec();
        transport.step(&mesh, displacement, scheme, &mut values).expect_err("wrong values")
    };
    let fine = vec![1.0; 16];
    assert_eq!(refused(&still, scheme, &[]), PointError::Points { found: 0, wanted: 4 });
    let three = vec![fine.clone(); 3];
    assert_eq!(refused(&still, scheme, &three), PointError::Points { found: 3, wanted: 4 });
    assert_eq!(refused(&still, scheme, &[vec![1.0; 15]]), PointError::Length { found: 15, wanted: 16 });
    assert_eq!(
        refused(&still[..24], scheme, std::slice::from_ref(&fine)),
        PointError::Length { found: 24, wanted: 25 }
    );
    let mut with_nan = vec![fine.clone(); 4];
    with_nan[2][7] = f64::NAN;
    assert_eq!(refused(&still, scheme, &with_nan).to_string(), "the value at point 2 of cell [3, 1] is NaN");
    for alpha in [-0.1, 2.1, f64::NAN] {
        let error = refused(&still, direct(true, alpha, VolumeMatrix::Lumped), std::slice::from_ref(&fine));
        assert!(matches!(error, PointError::Alpha(AlphaRange { .. })), "{error}");
    }
    // A cell that is not convex, and folded at the integration point next to its third node.
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.25, 0.25]].map(Vector::<2>::from);
    let dart: Mesh2 =
        Mesh::from_nodes(Grid::new([1, 1], [false; 2]), corners.to_vec()).expect("a simple cell");
    let error = PointTransport::new(&dart).expect_err("a folded cell");
    assert!(matches!(error, PointError::Folded { determinant, .. } if determinant <= 0.0), "{error}");
}
