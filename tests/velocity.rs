//! Velocity fields, their potentials, and the volumes that cross faces.

mod common;

use common::{Mesh2, Mesh3, random, unit_mesh};
use vofkit::geometry::{Cell, Vector};
use vofkit::mesh::{Distortion, Mesh};
use vofkit::velocity::{FaceFluxes, Field, Reversal, RigidMotion, Velocity};

type Vector3 = Vector<3>;

fn fields() -> Vec<Field> {
    vec![
        Field::Uniform { velocity: Vector3::new(0.3, -1.1, 0.7) },
        Field::Rotation {
            centre: Vector3::new(0.2, 0.4, 0.1),
            angular_velocity: Vector3::new(0.5, -0.8, 1.3),
        },
        Field::Eq101,
        Field::RudmanShear,
        Field::ReversedVortex,
        Field::Deformation3d,
        Field::Shear3d { speed: 1.0, radius: 0.5 },
    ]
}

fn points() -> impl Iterator<Item = Vector3> {
    // A low-discrepancy sequence is as good as random, and always the same.
    (1..60).map(|i| {
        Vector3::new(0.754_877, 0.569_840, 0.430_160).map(|step| (f64::from(i) * step).fract() * 1.4 - 0.2)
    })
}

#[test]
fn velocity_is_the_curl_of_the_potential() {
    let step = 1e-5;
    for field in fields() {
        for x in points() {
            let slope = |k: usize, by: usize| {
                let mut shift = Vector3::zeros();
                shift[by] = step;
                (field.potential(&(x + shift))[k] - field.potential(&(x - shift))[k]) / (2.0 * step)
            };
            let curl = Vector3::from_fn(|k, _| {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                slope(j, i) - slope(i, j)
            });
            let error = (curl - field.velocity(&x)).norm();
            assert!(error <= 1e-8, "{field:?} at {x}: {error:e}");
        }
    }
}

#[test]
fn acceleration_of_a_rotation_points_to_its_axis() {
    let rate = 1.7;
    let field = Field::Rotation { centre: Vector3::zeros(), angular_velocity: Vector3::new(0.0, 0.0, rate) };
    for x in points() {
        let expected = -rate * rate * Vector3::new(x[0], x[1], 0.0);
        assert!((field.acceleration(&x) - expected).norm() <= 1e-8);
    }
}

/// Flux through a face by Gauss quadrature of the velocity over its bilinear surface.
fn quadrature_flux<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    field: &Field,
    index: usize,
    face: usize,
) -> f64 {
    let cell = mesh.cell(index);
    let (axis, side) = (face / 2, face % 2);
    let rule = gauss_quad::legendre::GaussLegendre::new(12.try_into().expect("not zero"));
    let step = 1e-6;
    let mut sum = 0.0;
    let points: Vec<(f64, f64)> = rule.iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect();
    let pairs = points.iter().flat_map(|a| points.iter().map(move |b| (a, b)));
    for (&(u, weight_u), &(v, weight_v)) in pairs {
        let mut local = Vector::<D>::repeat(side as f64);
        local[(axis + 1) % D] = u;
        if D == 3 {
            local[(axis + 2) % D] = v;
        }
        let tangent = |k: usize| {
            let mut shift = Vector::<D>::zeros();
            shift[k] = step;
            let difference = (cell.map(&(local + shift)) - cell.map(&(local - shift))) / (2.0 * step);
            Vector3::from_fn(|i, _| if i < D { difference[i] } else { 0.0 })
        };
        let normal = if D == 3 {
            tangent((axis + 1) % D).cross(&tangent((axis + 2) % D))
        } else if axis == 0 {
            tangent(1).cross(&Vector3::z())
        } else {
            -tangent(0).cross(&Vector3::z())
        };
        let x = cell.map(&local);
        let x = Vector3::from_fn(|i, _| if i < D { x[i] } else { 0.0 });
        sum += weight_u * weight_v * field.velocity(&x).dot(&normal);
    }
    sum
}

fn fluxes_match<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, fields: &[Field]) {
    for field in fields {
        let fluxes = FaceFluxes::new(mesh, field).expect("fluxes in range");
        let step = fluxes.step(1.0);
        // The axial velocity of the shear has a kink on its axis, which no quadrature resolves.
        let tolerance = if matches!(field, Field::Shear3d { .. }) { 1e-4 } else { 1e-8 };
        for index in (0..mesh.grid().len()).step_by(7) {
            for face in 0..C::FACES {
                let flux = step.through(mesh.grid().offset(index), face / 2, face % 2);
                let expected = quadrature_flux(mesh, field, index, face);
                let area = mesh.cell(index).face_area(face).norm();
                assert!(
                    (flux - expected).abs() <= tolerance * area,
                    "{field:?} {index} {face}: {flux} {expected}"
                );
            }
        }
    }
}

#[test]
fn face_fluxes_are_integrals_of_the_velocity() {
    let planar: Vec<Field> = fields().into_iter().filter(Field::is_planar).collect();
    let mesh: Mesh2 = unit_mesh(8, random(0.3, 5));
    fluxes_match(&mesh, &planar);
    let mesh: Mesh3 = unit_mesh(5, random(0.25, 6));
    fluxes_match(&mesh, &fields());
}

fn closed<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>) {
    for field in fields() {
        let fluxes = FaceFluxes::new(mesh, &field).expect("fluxes in range");
        for duration in [1.0, 0.013, -0.37] {
            let step = fluxes.step(duration);
            for index in 0..mesh.grid().len() {
                let offset = mesh.grid().offset(index);
                let net: f64 =
                    (0..D).map(|axis| step.through(offset, axis, 1) - step.through(offset, axis, 0)).sum();
                assert!(net == 0.0, "{field:?}: {net:e}");
            }
        }
    }
}

#[test]
fn fluxes_of_a_cell_cancel_to_the_bit() {
    closed(&unit_mesh::<vofkit::geometry::Quad, 2>(13, random(0.2, 3)));
    closed(&unit_mesh::<vofkit::geometry::Hexahedron, 3>(7, Distortion::Wave { amplitude: 0.5 }));
}

#[test]
fn durations_add_up_and_return() {
    let field = Field::ReversedVortex;
    for reversal in [Reversal::None, Reversal::Cosine { period: 8.0 }, Reversal::Flip { time: 4.0 }] {
        let velocity = Velocity { field, reversal };
        let parts: f64 =
            (0..100).map(|i| velocity.duration(f64::from(i) * 0.08, f64::from(i + 1) * 0.08)).sum();
        assert!((parts - velocity.duration(0.0, 8.0)).abs() <= 1e-13);
        let by_midpoints: f64 =
            (0..8000).map(|i| 1e-3 * velocity.amplitude((f64::from(i) + 0.5) * 1e-3)).sum();
        assert!((by_midpoints - velocity.duration(0.0, 8.0)).abs() <= 1e-6);
        let returned = velocity.rigid_motion(0.0, 8.0) == Some(RigidMotion::Identity);
        assert_eq!(returned, reversal != Reversal::None);
    }
}
