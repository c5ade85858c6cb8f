//! Moment of fluid: planes from centroids, to second order on curves, and several materials in one cell.

use proptest::prelude::*;
use vofkit::fractions::{MaterialMoments, material_moments};
use vofkit::geometry::{Cell, HalfSpace, Quad, Vector};
use vofkit::interface::{Counts, Materials, Parts, Placed, Reconstruction, ReconstructionError};
use vofkit::interface::{is_mixed, planes, reconstruct};
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::metrics::plane_errors;
use vofkit::normal::{Material, NoNormal, NormalMethod};
use vofkit::shape::Shape;

use super::common::{Mesh2, Mesh3, fixed, random, unit_mesh};
use super::planes::{through, unit};
use super::{WAVE, difference, distortions, near_middle, with};

/// The planes of a shape in all mixed cells.
fn placed<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, shape: &Shape<D>) -> Vec<(usize, Placed<D>)> {
    let MaterialMoments { fractions, centroids } = material_moments(mesh, std::slice::from_ref(shape));
    let mixed: Vec<usize> = (0..fractions[0].len()).filter(|&i| is_mixed(fractions[0][i])).collect();
    let material = Material { mesh, fractions: &fractions[0], centroids: Some(&centroids[0]) };
    let planes = planes(material, &mixed, with(NormalMethod::Mof)).expect("valid fractions");
    mixed.into_iter().zip(planes).collect()
}

/// The largest part of a cell in which a half-space and its reconstruction differ, and how many cells' planes are not determined.
fn plane_error<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, line: HalfSpace<D>) -> (f64, usize) {
    let shape = Shape::HalfSpace(line);
    let (mut largest, mut open) = (0.0_f64, 0);
    for (cell, placed) in placed(mesh, &shape) {
        let Placed::Plane { half_space, determined, .. } = placed else { panic!("{placed:?}") };
        largest = largest.max(difference(mesh, cell, &half_space, &shape));
        open += usize::from(!determined);
    }
    (largest, open)
}

proptest! {
    #![proptest_config(fixed(96, 20_261_124))]

    #[test]
    fn lines_are_reproduced(
        normal in [-1.0..1.0_f64, -1.0..1.0].prop_filter_map("no direction", unit),
        at in [0.0..1.0_f64, 0.0..1.0],
        mesh in 0..3_usize,
        seed in 0..1000_u64,
    ) {
        let mesh: Mesh2 = unit_mesh(12, distortions(seed)[mesh].clone());
        let (error, open) = plane_error(&mesh, through(normal, at));
        prop_assert!(error <= 1e-10, "{error:e}, {open} open");
    }

    #[test]
    fn planes_are_reproduced(
        normal in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0].prop_filter_map("no direction", unit),
        at in [0.1..0.9_f64, 0.1..0.9, 0.1..0.9],
        mesh in 0..3_usize,
        seed in 0..1000_u64,
    ) {
        let mesh: Mesh3 = unit_mesh(6, distortions(seed)[mesh].clone());
        let (error, open) = plane_error(&mesh, through(normal, at));
        prop_assert!(error <= 1e-10, "{error:e}, {open} open");
    }
}

#[test]
fn thin_cells_and_single_corners_are_exact_too() {
    let grid = Grid::new([10, 10], [false, false]);
    let thin: Mesh2 =
        Mesh::new(grid, Vector::zeros(), Vector::from([1.0, 1e-6]), &random(0.2, 9)).expect("valid");
    let (error, _) = plane_error(&thin, HalfSpace { normal: Vector::from([1e-6, 0.9]), constant: 7e-7 });
    assert!(error <= 1e-9, "{error:e}");
    // The corner of the domain alone is cut, and the corner of a cell alone is left.
    let mesh: Mesh2 = unit_mesh(5, Distortion::None);
    for line in [([0.6, 0.8], 0.08), ([0.6, 0.8], 0.2799), ([0.6, 0.8], 1e-4), ([0.28, 0.96], 1.24 - 1e-4)] {
        let (normal, constant) = (Vector::from(line.0), line.1);
        let (error, open) = plane_error(&mesh, HalfSpace { normal, constant });
        assert!(error <= 1e-10 && open == 0, "{line:?}: {error:e}, {open} open");
    }
}

/// Mean symmetric difference of a sphere and its reconstruction over some centres.
fn sphere_error<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, radius: f64, centres: &[Vector<D>]) -> f64 {
    let of_sphere = |&centre: &Vector<D>| {
        let shape = Shape::Sphere { centre, radius };
        let moments = material_moments(mesh, std::slice::from_ref(&shape));
        let interface = reconstruct(mesh, &moments, with(NormalMethod::Mof)).expect("valid fractions");
        assert_eq!(interface.counts.no_normal(), 0);
        plane_errors(mesh, &interface.facets, &shape).iter().sum::<f64>()
    };
    centres.iter().map(of_sphere).sum::<f64>() / centres.len() as f64
}

#[test]
fn circles_and_spheres_converge_with_second_order() {
    let centres: Vec<Vector<2>> = (0..12).map(near_middle).collect();
    for distortion in distortions(3) {
        let [coarse, fine] =
            [40, 400].map(|n| sphere_error(&unit_mesh::<Quad, 2>(n, distortion.clone()), 0.25, &centres));
        let order = (coarse / fine).log10();
        assert!(order >= 1.9, "circle on {distortion:?}: {order}");
        let [coarse, fine] = [20, 40].map(|n| {
            let mesh: Mesh3 = unit_mesh(n, distortion.clone());
            sphere_error(&mesh, 0.32, &[near_middle(0)])
        });
        let order = (coarse / fine).log2();
        assert!(order >= 1.9, "sphere on {distortion:?}: {order}");
    }
}
/// The interface of some shapes.
fn interface_of<const D: usize, C: Cell<D>>(
    mesh: &Mesh<C, D>,
    shapes: &[Shape<D>],
    materials: Materials,
) -> Vec<(usize, HalfSpace<D>)> {
    let moments = material_moments(mesh, shapes);
    let method = Reconstruction { materials, ..with(NormalMethod::Mof) };
    let interface = reconstruct(mesh, &moments, method).expect("valid fractions");
    assert_eq!(interface.counts.no_normal(), 0);
    let plane =
        |facet: &vofkit::facet::Facet<D>| HalfSpace { normal: facet.normal, constant: facet.plane_constant };
    interface.facets.iter().map(|facet| (facet.cell, plane(facet))).collect()
}

/// Whether all planes are among some, whichever side is whose.
fn assert_among<const D: usize>(found: &[(usize, HalfSpace<D>)], wanted: &[HalfSpace<D>], what: &str) {
    let apart =
        |a: &HalfSpace<D>, b: &HalfSpace<D>| (a.normal - b.normal).norm() + (a.constant - b.constant).abs();
    for (cell, plane) in found {
        let sides = wanted.iter().flat_map(|wanted| [*wanted, wanted.complement()]);
        let least = sides.map(|wanted| apart(plane, &wanted)).fold(f64::INFINITY, f64::min);
        assert!(least <= 1e-8, "{what}, cell {cell}: {least:e}");
    }
}

#[test]
fn straight_interfaces_that_end_at_one_another_are_reproduced() {
    let below = HalfSpace { normal: Vector::from([0.28, 0.96]), constant: 0.6 };
    let left = HalfSpace { normal: Vector::from([0.8, 0.6]), constant: 0.75 };
    let [low, aside] = [below, left].map(Shape::HalfSpace);
    let rest = Shape::HalfSpace(HalfSpace { normal: Vector::from([-1.0, 0.0]), constant: 1.0 });
    for distortion in distortions(5) {
        let mesh: Mesh2 = unit_mesh(9, distortion.clone());
        for materials in [Materials::Nested, Materials::Listed] {
            let tell = format!("{materials:?} on {distortion:?}");
            // Two materials and void, then three that fill the mesh.
            for shapes in [&[low.clone(), aside.clone()][..], &[low.clone(), aside.clone(), rest.clone()]] {
                let planes = interface_of(&mesh, shapes, materials);
                assert!(planes.len() > 15);
                assert_among(&planes, &[below, left], &tell);
            }
        }
    }
}

#[test]
fn films_and_void_between_films_are_reproduced() {
    // A film half a cell thick between two materials, whichever is listed first, and the same without the film's material.
    let normal = Vector::from([0.28, 0.96]);
    let lower = HalfSpace { normal, constant: 0.6 };
    let upper = HalfSpace { normal: -normal, constant: -0.65 };
    let film = Shape::Intersection(
        vec![lower.complement(), upper.complement()].into_iter().map(Shape::HalfSpace).collect(),
    );
    let [low, high] = [lower, upper].map(Shape::HalfSpace);
    for distortion in distortions(6) {
        let mesh: Mesh2 = unit_mesh(10, distortion.clone());
        for shapes in [vec![film.clone(), low.clone(), high.clone()], vec![low.clone(), high.clone()]] {
            let planes = interface_of(&mesh, &shapes, Materials::Nested);
            assert_among(&planes, &[lower, upper], &format!("{} materials on {distortion:?}", shapes.len()));
        }
    }
}

#[test]
fn layers_in_space_are_reproduced_where_faces_are_plane() {
    let normal = Vector::from([0.48, 0.6, 0.64]);
    let planes = [0.8, 0.86].map(|constant| HalfSpace { normal, constant });
    let mesh: Mesh3 = unit_mesh(5, Distortion::None);
    let found = interface_of(&mesh, &planes.map(Shape::HalfSpace), Materials::Nested);
    assert_among(&found, &planes, "layers");
}

#[test]
fn centroids_that_are_none_are_told() {
    let mesh: Mesh2 = unit_mesh(6, WAVE);
    let disc = Shape::Sphere { centre: Vector::from([0.5, 0.5]), radius: 0.3 };
    let mut moments = material_moments(&mesh, std::slice::from_ref(&disc));
    let mof = with(NormalMethod::Mof);
    let mixed = (0..36).filter(|&cell| is_mixed(moments.fractions[0][cell])).count();
    let counts =
        |parts: Parts<'_, 2>| -> Counts { reconstruct(&mesh, parts, mof).expect("valid fractions").counts };
    let none = counts(Parts::from(&moments.fractions));
    assert_eq!([none.mixed, none.no_centroid], [mixed, mixed]);
    let odd = (0..36).find(|&cell| is_mixed(moments.fractions[0][cell])).expect("mixed cells");
    moments.centroids[0][odd][1] = f64::NAN;
    assert_eq!(counts(Parts::from(&moments)).no_centroid, 1);
    moments.centroids[0].pop();
    let short = reconstruct(&mesh, &moments, mof).map(|_| ()).unwrap_err();
    assert_eq!(short, ReconstructionError::Centroids { given: 35, wanted: 36, of: "cells" });
    let material = Material { mesh: &mesh, fractions: &moments.fractions[0], centroids: Some(&[]) };
    let placed = planes(material, &[odd], mof).expect("a valid fraction");
    assert_eq!(placed, [Placed::NoNormal(NoNormal::NoCentroid)]);
    moments.centroids.clear();
    let short = reconstruct(&mesh, &moments, mof).map(|_| ()).unwrap_err();
    assert_eq!(short.to_string(), "centroids are given for 0 materials, not for 1");
}

#[test]
fn few_plane_constants_are_found_on_the_way() {
    for distortion in distortions(3) {
        let mesh: Mesh3 = unit_mesh(16, distortion.clone());
        let mut counts = Counts::default();
        placed(&mesh, &Shape::Sphere { centre: near_middle(1), radius: 0.32 })
            .iter()
            .for_each(|(_, placed)| counts.count(placed));
        let mean = counts.trials as f64 / counts.mixed as f64;
        assert!(mean <= 20.0, "{distortion:?}: {mean}");
    }
}
