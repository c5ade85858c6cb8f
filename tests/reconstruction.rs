//! Normals, planes and the numbers that judge them.

mod common;

use common::{Mesh2, Mesh3, random, unit_mesh};
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, HalfSpace, PositionError, Vector};
use vofkit::interface::{Reconstruction, ReconstructionError, is_mixed, reconstruct};
use vofkit::mesh::{Distortion, Mesh};
use vofkit::metrics::{facet_gap_mean, fragments};
use vofkit::normal::{NormalMethod, Stencil};
use vofkit::shape::Shape;

fn sphere<const D: usize>(centre: [f64; D], radius: f64) -> Shape<D> {
    Shape::Sphere { centre: centre.into(), radius }
}

/// Every plane leaves its cell the volume that the fraction says.
fn volumes_are_kept<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, shape: &Shape<D>) {
    let fractions = volume_fractions(mesh, std::slice::from_ref(shape));
    for normal in [NormalMethod::Youngs, NormalMethod::YoungsLogical] {
        let method = Reconstruction { normal, ..Reconstruction::default() };
        let interface = reconstruct(mesh, &fractions, method).expect("valid fractions");
        let mixed = fractions[0].iter().filter(|&&f| is_mixed(f)).count();
        assert_eq!(interface.counts.mixed, mixed);
        assert_eq!(interface.facets.len() + interface.counts.no_normal(), mixed);
        for facet in &interface.facets {
            let half_space = HalfSpace { normal: facet.normal, constant: facet.plane_constant };
            let truncation = mesh.cell(facet.cell).truncate(&half_space);
            let volume = mesh.volumes()[facet.cell];
            let error = (truncation.volume / volume - fractions[0][facet.cell]).abs();
            assert!(error <= 1e-12, "cell {}: {error:e}", facet.cell);
            assert!((facet.normal.norm() - 1.0).abs() <= 1e-14);
        }
    }
}

#[test]
fn planes_keep_the_volume_of_their_cells() {
    volumes_are_kept::<_, 2>(
        &unit_mesh::<vofkit::geometry::Quad, 2>(20, random(0.3, 1)),
        &sphere([0.5, 0.52], 0.31),
    );
    volumes_are_kept::<_, 3>(
        &unit_mesh::<vofkit::geometry::Hexahedron, 3>(10, random(0.2, 1)),
        &sphere([0.5, 0.52, 0.47], 0.31),
    );
}

#[test]
fn youngs_normals_of_a_sphere_point_outwards() {
    let centre = Vector::<3>::new(0.5, 0.52, 0.47);
    for (distortion, tolerance) in [(Distortion::None, 0.1), (Distortion::Wave { amplitude: 0.3 }, 0.35)] {
        let mesh: Mesh3 = unit_mesh(20, distortion);
        let fractions = volume_fractions(&mesh, &[sphere([0.5, 0.52, 0.47], 0.3)]);
        let interface = reconstruct(&mesh, &fractions, Reconstruction::default()).expect("valid fractions");
        assert_eq!(interface.counts.no_normal(), 0);
        for facet in &interface.facets {
            let radial = (mesh.cell(facet.cell).map(&Vector::<3>::repeat(0.5)) - centre).normalize();
            let off = (facet.normal - radial).norm();
            assert!(off <= tolerance, "{off} at {radial}");
        }
        let area: f64 = interface.facets.iter().map(|facet| facet.area).sum();
        assert!((area / (4.0 * std::f64::consts::PI * 0.09) - 1.0).abs() <= 0.05, "{area}");
    }
}

#[test]
fn youngs_normals_of_a_line_stand_up_to_random_meshes() {
    let rms = |amplitude: f64| {
        let mesh: Mesh2 = unit_mesh(64, random(amplitude, 5));
        let normal = Vector::<2>::new(0.8, 0.6);
        let line = Shape::HalfSpace(HalfSpace { normal, constant: 0.7 });
        let fractions = volume_fractions(&mesh, &[line]);
        let interface = reconstruct(&mesh, &fractions, Reconstruction::default()).expect("valid fractions");
        let sum: f64 = interface.facets.iter().map(|facet| (facet.normal - normal).norm_squared()).sum();
        (sum / interface.facets.len() as f64).sqrt()
    };
    // With the Jacobian of the cell in place of that of the stencil it would be 0.105 and 0.143.
    assert!(rms(0.2) <= 0.07, "{}", rms(0.2));
    assert!(rms(0.3) <= 0.08, "{}", rms(0.3));
}

#[test]
fn the_logical_form_differs_only_where_the_mesh_is_distorted() {
    let shape = sphere([0.5, 0.5], 0.3);
    let normals = |mesh: &Mesh2, normal| {
        let fractions = volume_fractions(mesh, std::slice::from_ref(&shape));
        let method = Reconstruction { normal, ..Reconstruction::default() };
        let interface = reconstruct(mesh, &fractions, method).expect("valid fractions");
        interface.facets.into_iter().map(|facet| facet.normal).collect::<Vec<_>>()
    };
    let largest = |mesh: &Mesh2| {
        let physical = normals(mesh, NormalMethod::Youngs);
        let logical = normals(mesh, NormalMethod::YoungsLogical);
        physical.iter().zip(&logical).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    };
    assert!(largest(&unit_mesh(16, Distortion::None)) <= 1e-13);
    assert!(largest(&unit_mesh(16, Distortion::Twist { angle: 0.6 })) >= 0.1);
}

#[test]
fn a_cell_without_a_direction_gets_none() {
    let mesh: Mesh2 = unit_mesh(5, Distortion::None);
    let mut alone = vec![0.0; 25];
    alone[12] = 0.4;
    let interface =
        reconstruct(&mesh, &[alone, vec![0.5; 25]], Reconstruction::default()).expect("valid fractions");
    assert_eq!(interface.counts.mixed, 26);
    assert_eq!(interface.counts.no_normal(), 26);
    assert!(interface.facets.is_empty());
}

#[test]
fn beyond_the_ends_stands_the_mirror_image() {
    let mesh: Mesh2 = unit_mesh(4, Distortion::None);
    let fractions: Vec<f64> = (0..16).map(f64::from).collect();
    let stencil = Stencil::new(mesh.grid(), &fractions, [0, 3]);
    let values: Vec<f64> = stencil.iter().map(|(_, f)| f).collect();
    assert_eq!(values, [8.0, 8.0, 9.0, 12.0, 12.0, 13.0, 12.0, 12.0, 13.0]);
}

#[test]
fn a_fraction_that_is_no_number_is_an_error_that_says_where() {
    let mesh: Mesh2 = unit_mesh(4, Distortion::None);
    let mut fractions = volume_fractions(&mesh, &[sphere([0.5, 0.5], 0.3)]);
    for bad in [f64::NAN, f64::INFINITY, -0.1, 1.1] {
        fractions[0][5] = bad;
        let error = reconstruct(&mesh, &fractions, Reconstruction::default()).expect_err("not a fraction");
        let ReconstructionError::Cell { cell, source: PositionError::Fraction(_), .. } = error else {
            panic!("{error}")
        };
        assert_eq!(cell, [1, 1]);
    }
    let short = reconstruct(&mesh, &[vec![0.5; 15]], Reconstruction::default()).map(|_| ());
    assert_eq!(short, Err(ReconstructionError::Length { given: 15, cells: 16 }));
}

#[test]
fn fragments_are_counted_with_what_is_stray() {
    let mesh: Mesh2 = unit_mesh(40, random(0.2, 3));
    let one = volume_fractions(&mesh, &[sphere([0.3, 0.3], 0.2)]);
    assert_eq!(fragments(&mesh, &one[0]).count, 1);
    assert!(fragments(&mesh, &one[0]).stray_volume <= 1e-15);
    let two =
        volume_fractions(&mesh, &[Shape::Union(vec![sphere([0.3, 0.3], 0.2), sphere([0.8, 0.8], 0.1)])]);
    let pieces = fragments(&mesh, &two[0]);
    assert_eq!(pieces.count, 2);
    assert!((pieces.stray_volume - 0.2).abs() <= 1e-9, "{pieces:?}");
    assert_eq!(fragments(&mesh, &vec![0.0; 1600]).count, 0);
}

#[test]
fn gaps_between_the_planes_of_a_circle_shrink_with_the_mesh() {
    let gap = |n: usize| {
        let mesh: Mesh2 = unit_mesh(n, random(0.2, 3));
        let fractions = volume_fractions(&mesh, &[sphere([0.5, 0.5], 0.3)]);
        let interface = reconstruct(&mesh, &fractions, Reconstruction::default()).expect("valid fractions");
        facet_gap_mean(&mesh, &interface.facets).expect("planes meet")
    };
    let (coarse, fine) = (gap(10), gap(40));
    assert!(coarse <= 0.1 && fine <= coarse, "{coarse} {fine}");
}
