//! Several materials in one cell: parts that tile it, in every order, on any mesh.

mod common;

use common::{Mesh2, Mesh3, drift, fixed, random, run, steady, transport, unit_mesh};
use proptest::prelude::*;
use vofkit::advection::{Settings, StepError, SweepAxes, Transport};
use vofkit::facet::Facet;
use vofkit::fractions::volume_fractions;
use vofkit::geometry::clip::{Region, Side, Tile};
use vofkit::geometry::{Cell, HalfSpace, Vector};
use vofkit::interface::{
    Counts, Dissector, Materials, Reconstruction, ReconstructionError, Shared, reconstruct,
};
use vofkit::mesh::{Distortion, Mesh};
use vofkit::metrics::{fragments, material_volume, shape_error};
use vofkit::normal::NormalMethod;
use vofkit::shape::Shape;
use vofkit::velocity::Field;

fn method(materials: Materials) -> Reconstruction {
    Reconstruction { materials, ..Reconstruction::default() }
}

/// The volumes of the parts of a cell, by material, relative to the cell.
fn volumes<C: Cell<D>, const D: usize>(
    dissector: &mut Dissector<C, D>,
    mesh: &Mesh<C, D>,
    fractions: &[Vec<f64>],
    index: usize,
    method: Reconstruction,
) -> Result<(Vec<f64>, Counts), ReconstructionError> {
    let cell = mesh.local_cell(index);
    let mut volumes = vec![0.0; fractions.len()];
    let shared = Shared { mesh, parts: fractions.into(), planes: &[], index, cell: &cell };
    let counts =
        dissector.dissect(shared, [cell], method, |_, material, volume| volumes[material] += volume)?;
    Ok((volumes, counts))
}

/// Cuts a cell again with the cuts of the dissector, as anybody can: each part from what the earlier ones left.
fn cut_again<C: Cell<D>, const D: usize>(cell: &C, cuts: &[vofkit::interface::Cut<D>]) -> Vec<f64> {
    let mut rest = C::Tile::region(cell);
    let mut parts = Vec::new();
    for cut in cuts {
        let (mut below, mut above) = (Region::empty(), Region::empty());
        parts.push(match rest.split(&cut.half_space, &mut below, &mut above).expect("there is room") {
            Side::Below => rest.volume(),
            Side::Above => 0.0,
            Side::Across => {
                rest = above;
                below.volume()
            }
        });
    }
    parts
}

fn check_tiling<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fractions: &[Vec<f64>],
    method: Reconstruction,
) {
    let mut dissector = Dissector::default();
    for index in 0..mesh.grid().len() {
        let (volumes, _) = volumes(&mut dissector, mesh, fractions, index, method).expect("a dissection");
        for (material, volume) in volumes.iter().enumerate() {
            let error = (volume - fractions[material][index]).abs();
            assert!(error <= 1e-13, "cell {index}, material {material}: {error:e}");
        }
        let cell = mesh.local_cell(index);
        for (cut, part) in dissector.cuts().iter().zip(cut_again(&cell, dissector.cuts())) {
            let void = 1.0 - fractions.iter().map(|f| f[index]).sum::<f64>();
            let fraction = cut.material.map_or(void, |material| fractions[material][index]);
            let error = (part / cell.volume() - fraction).abs();
            assert!(error <= 1e-12, "cell {index}, {:?}: {error:e} when cut again", cut.material);
        }
    }
}

/// Fractions by chance: `count` materials that fill all cells, or leave void in them.
fn by_chance(cells: usize, count: usize, full: bool, parts: &[f64]) -> Vec<Vec<f64>> {
    let mut fractions = vec![vec![0.0; cells]; count];
    for cell in 0..cells {
        let part = |k: usize| parts[(cell * 7 + k * 13) % parts.len()].max(0.0);
        let sum: f64 = (0..count).map(part).sum::<f64>() + if full { 0.0 } else { 0.3 };
        if sum > 0.0 {
            (0..count).for_each(|k| fractions[k][cell] = part(k) / sum);
        }
    }
    fractions
}

proptest! {
    #![proptest_config(fixed(6, 20_261_124))]

    #[test]
    fn parts_tile_the_cell_2d(
        seed in 0_u64..1000,
        count in 2_usize..=20,
        full in any::<bool>(),
        // A third of the materials are absent.
        parts in prop::collection::vec(-0.5_f64..1.0, 97),
        materials in prop::sample::select(vec![Materials::Nested, Materials::Listed]),
    ) {
        let mesh: Mesh2 = unit_mesh(4, random(0.3, seed));
        check_tiling(&mesh, &by_chance(16, count, full, &parts), method(materials));
    }

    #[test]
    fn parts_tile_the_cell_3d(
        seed in 0_u64..1000,
        count in 2_usize..=20,
        full in any::<bool>(),
        parts in prop::collection::vec(-0.5_f64..1.0, 97),
        materials in prop::sample::select(vec![Materials::Nested, Materials::Listed]),
    ) {
        let mesh: Mesh3 = unit_mesh(3, random(0.2, seed));
        check_tiling(&mesh, &by_chance(27, count, full, &parts), method(materials));
    }
}

#[test]
fn all_normals_tile() {
    let shapes = three_sectors::<3>(0.4);
    let mesh: Mesh3 = unit_mesh(5, random(0.2, 3));
    let fractions = volume_fractions(&mesh, &shapes);
    for normal in [NormalMethod::Lvira, NormalMethod::Swartz, NormalMethod::Mof, NormalMethod::Slic] {
        check_tiling(&mesh, &fractions, Reconstruction { normal, ..Reconstruction::default() });
    }
}

/// A half-space to the left of `x = at`, and the rest cut in two at `y = at`.
fn three_sectors<const D: usize>(at: f64) -> [Shape<D>; 3] {
    let half_space = |axis: usize, sign: f64| {
        let mut normal = Vector::<D>::zeros();
        normal[axis] = sign;
        Shape::HalfSpace(HalfSpace { normal, constant: sign * at })
    };
    [half_space(0, 1.0), half_space(1, 1.0), half_space(1, -1.0)]
}

#[test]
fn three_materials_that_meet_in_a_point_are_found_exactly() {
    for size in [5, 6] {
        let mesh: Mesh2 = unit_mesh(size, Distortion::None);
        let fractions = volume_fractions(&mesh, &three_sectors(0.5));
        let facets = reconstruct(&mesh, &fractions, Reconstruction::default()).expect("an interface").facets;
        // With six cells a side the interfaces lie between cells.
        assert_eq!(facets.is_empty(), size == 6);
        for facet in &facets {
            for point in facet.loops.iter().flatten() {
                let [x, y] = [point[0] - 0.5, point[1] - 0.5].map(f64::abs);
                let on = if facet.normal[0].abs() > 0.5 { x } else { y };
                assert!(on <= 1e-13, "{facet:?}");
                // Right of the first material only.
                assert!(facet.normal[0].abs() > 0.5 || point[0] >= 0.5 - 1e-13, "{facet:?}");
            }
        }
        let length: f64 = facets.iter().map(|facet| facet.area).sum();
        if size == 5 {
            // Both materials at an interface show it.
            let expected = 2.0 * (1.0 + 0.5);
            assert!((length - expected).abs() <= 1e-12, "{length} {expected}");
        }
    }
}

#[test]
fn a_film_between_two_materials_lies_between_them() {
    // Material 1 is a film through the middle of the cells between 0 on the left and void on the right; its own fractions
    // are the same on both sides.
    let mesh: Mesh2 = unit_mesh(5, Distortion::None);
    let left_of = |x: f64| Shape::HalfSpace(HalfSpace { normal: Vector::<2>::new(1.0, 0.0), constant: x });
    let fractions = volume_fractions(&mesh, &[left_of(0.47), left_of(0.52)]);
    let cell = 12;
    assert!((fractions[1][cell] - 0.25).abs() <= 1e-12);
    for materials in [Materials::Nested, Materials::Listed] {
        let mut dissector = Dissector::default();
        volumes(&mut dissector, &mesh, &fractions, cell, method(materials)).expect("a dissection");
        let cuts = dissector.cuts();
        assert_eq!(cuts.iter().map(|cut| cut.material).collect::<Vec<_>>(), [Some(0), Some(1)]);
        for (cut, place) in cuts.iter().zip([0.07, 0.12]) {
            let difference = cut.half_space.constant - place;
            assert!(cut.half_space.normal[0] > 1.0 - 1e-12 && difference.abs() <= 1e-12, "{cut:?}");
        }
    }
    // Listed first, the film has no direction of its own, and waits.
    let film_first: Vec<Vec<f64>> = fractions.iter().rev().cloned().collect();
    let mut dissector = Dissector::default();
    volumes(&mut dissector, &mesh, &film_first, cell, method(Materials::Listed)).expect("a dissection");
    assert_eq!(dissector.cuts().iter().map(|cut| cut.material).collect::<Vec<_>>(), [Some(1), Some(0)]);
}

#[test]
fn the_order_is_the_listed_one_or_that_of_the_steepest() {
    // The second material is a half-space, the first a quadrant.
    let mesh: Mesh2 = unit_mesh(5, Distortion::None);
    let [half, quadrant, _] = three_sectors::<2>(0.5);
    let mut fractions = volume_fractions(&mesh, &[half, quadrant]);
    fractions.swap(0, 1);
    for (materials, order) in [(Materials::Nested, [1, 0]), (Materials::Listed, [0, 1])] {
        let mut dissector = Dissector::default();
        let (_, counts) =
            volumes(&mut dissector, &mesh, &fractions, 12, method(materials)).expect("a dissection");
        assert_eq!(dissector.cuts().iter().map(|cut| cut.material).collect::<Vec<_>>(), order.map(Some));
        assert_eq!((counts.mixed, counts.iterative, counts.no_normal()), (2, 2, 0));
    }
}

#[test]
fn void_is_cut_first_where_it_fits_best() {
    // Two materials side by side under a free surface.
    let mesh: Mesh2 = unit_mesh(5, Distortion::None);
    let [left, low, _] = three_sectors::<2>(0.5);
    let on_the_left = Shape::Intersection(vec![low.clone(), left]);
    let fractions = volume_fractions(&mesh, &[on_the_left, low]);
    let mut dissector = Dissector::default();
    volumes(&mut dissector, &mesh, &fractions, 12, Reconstruction::default()).expect("a dissection");
    let [void, first] = dissector.cuts() else { panic!("{:?}", dissector.cuts()) };
    assert_eq!((void.material, first.material, dissector.last()), (None, Some(0), Some(1)));
    assert!(void.half_space.normal[1] <= -1.0 + 1e-12 && first.half_space.normal[0] >= 1.0 - 1e-12);
}

#[test]
fn materials_without_normals_stay_mixed() {
    let mesh: Mesh2 = unit_mesh(3, Distortion::None);
    let fractions = vec![vec![0.25; 9], vec![0.25; 9]];
    let mut dissector = Dissector::default();
    let (volumes, counts) = volumes(&mut dissector, &mesh, &fractions, 4, Reconstruction::default()).unwrap();
    assert_eq!(volumes, [0.25, 0.25]);
    assert_eq!((counts.mixed, counts.no_normal()), (2, 2));
    assert!(dissector.cuts().is_empty());
}

#[test]
fn two_materials_that_fill_a_cell_share_one_exact_plane() {
    let mesh: Mesh3 = unit_mesh(6, random(0.2, 5));
    let ball = Shape::Sphere { centre: [0.5; 3].into(), radius: 0.3 };
    let inside = volume_fractions(&mesh, &[ball]).remove(0);
    let outside: Vec<f64> = inside.iter().map(|f| 1.0 - f).collect();
    let both =
        reconstruct(&mesh, &[inside.clone(), outside], Reconstruction::default()).expect("an interface");
    let alone = reconstruct(&mesh, &[inside], Reconstruction::default()).expect("an interface");
    assert_eq!(both.counts, alone.counts);
    let (of_first, of_second) = both.facets.split_at(alone.facets.len());
    for (one, other) in of_first.iter().zip(of_second) {
        assert_eq!((one.normal, one.plane_constant), (-other.normal, -other.plane_constant));
        assert!((one.area - other.area).abs() <= 1e-12 * one.area.max(1e-3), "{one:?} {other:?}");
    }
}

#[test]
fn independent_planes_are_those_of_each_material_alone() {
    let mesh: Mesh2 = unit_mesh(12, random(0.2, 5));
    let fractions = volume_fractions(&mesh, &touching_discs());
    let together = reconstruct(&mesh, &fractions, method(Materials::Independent)).expect("an interface");
    let mut apart = Vec::new();
    for (material, f) in fractions.iter().enumerate() {
        let alone =
            reconstruct(&mesh, std::slice::from_ref(f), Reconstruction::default()).expect("an interface");
        apart.extend(alone.facets.into_iter().map(|facet| Facet { material, ..facet }));
    }
    assert_eq!(together.facets, apart);
}

fn touching_discs() -> [Shape<2>; 2] {
    [0.3, 0.7].map(|x| Shape::Sphere { centre: [x, 0.5].into(), radius: 0.2 })
}

#[test]
fn facets_of_a_shared_cell_do_not_cross() {
    let mesh: Mesh2 = unit_mesh(13, random(0.2, 5));
    let fractions = volume_fractions(&mesh, &touching_discs());
    let interface = reconstruct(&mesh, &fractions, Reconstruction::default()).expect("an interface");
    let shared: Vec<_> =
        interface.facets.iter().filter(|facet| fractions.iter().all(|f| f[facet.cell] > 0.0)).collect();
    for (i, one) in shared.iter().enumerate() {
        for other in shared[..i].iter().filter(|other| other.cell == one.cell) {
            let crosses = |a: &Facet<2>, b: &Facet<2>| {
                let heights = b.loops.iter().flatten().map(|point| a.normal.dot(point) - a.plane_constant);
                let [low, high] = heights.fold([0.0_f64; 2], |[low, high], h| [low.min(h), high.max(h)]);
                low < -1e-12 && high > 1e-12
            };
            assert!(!(crosses(one, other) && crosses(other, one)), "{one:?} {other:?}");
        }
    }
    assert!(shared.len() > 2);
}

#[test]
fn fractions_that_add_up_to_more_than_one_are_an_error() {
    let mesh: Mesh2 = unit_mesh(3, Distortion::None);
    let mut fractions = vec![vec![0.0; 9], vec![0.0; 9]];
    fractions[0][5] = 0.6;
    fractions[1][5] = 0.7;
    let error = reconstruct(&mesh, &fractions, Reconstruction::default()).map(|_| ()).unwrap_err();
    let ReconstructionError::Overfull { cell, sum } = error else { panic!("{error:?}") };
    assert!(cell == [2, 1] && (sum - 1.3).abs() <= 1e-12);
    assert!(reconstruct(&mesh, &fractions, method(Materials::Independent)).is_ok());
    fractions[1][5] = f64::NAN;
    let error = reconstruct(&mesh, &fractions, Reconstruction::default()).map(|_| ()).unwrap_err();
    assert!(matches!(error, ReconstructionError::Cell { cell, .. } if cell == [2, 1]));
}

/// Seven discs that touch, as in Fig. 42.
fn seven_discs() -> Vec<Shape<2>> {
    let disc = |x: f64, y: f64| Shape::Sphere { centre: [x, y].into(), radius: 0.13 };
    let around = (0..6).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_3);
    let around = around.map(|angle| disc(0.5 + 0.26 * angle.cos(), 0.5 + 0.26 * angle.sin()));
    std::iter::once(disc(0.5, 0.5)).chain(around).collect()
}

#[test]
fn seven_touching_discs_keep_their_identity_over_a_revolution() {
    let centre = Vector::<3>::new(0.5, 0.5, 0.0);
    let rotation = Field::Rotation { centre, angular_velocity: Vector::<3>::new(0.0, 0.0, 1.0) };
    for distortion in [Distortion::None, random(0.2, 1)] {
        let mesh: Mesh2 = unit_mesh(30, distortion);
        let start = volume_fractions(&mesh, &seven_discs());
        let mut fractions = start.clone();
        let mut transport = transport(&mesh, steady(rotation), SweepAxes::Logical);
        let end = std::f64::consts::TAU;
        let steps = (end * transport.courant_rate() / 0.5).ceil() as usize;
        let ledger = run(&mut transport, &mut fractions, steps, end).expect("steps within the limit");
        for (k, account) in ledger.materials.iter().enumerate() {
            let drift = drift(&mesh, &start[k], &fractions[k], account.outflow);
            assert!(drift.abs() <= 1e-12, "disc {k} drifts by {drift:e}");
            assert!(account.smallest >= -1e-12 && account.largest <= 1.0 + 1e-12, "{account:?}");
            assert!(account.rescaled <= 1e-13, "{account:?}");
            let pieces = fragments(&mesh, &fractions[k]);
            assert_eq!(pieces.count, 1, "disc {k}: {pieces:?}");
            let error = shape_error(&mesh, &fractions[k], &start[k]) / material_volume(&mesh, &start[k]);
            assert!(error <= 0.06, "disc {k} is wrong by {error}");
        }
    }
}

#[test]
fn materials_that_fill_a_mesh_go_on_filling_it_3d() {
    let mesh: Mesh3 = unit_mesh(8, random(0.2, 4));
    let start = volume_fractions(&mesh, &three_sectors(0.45));
    for axes in [SweepAxes::Logical, SweepAxes::Cartesian] {
        let mut fractions = start.clone();
        let mut transport = transport(&mesh, steady(Field::Deformation3d), axes);
        let end = 2.0 / transport.courant_rate();
        let ledger = run(&mut transport, &mut fractions, 5, end).expect("steps within the limit");
        let gaps = (0..mesh.grid().len()).map(|i| fractions.iter().map(|f| f[i]).sum::<f64>() - 1.0);
        let gap = gaps.map(f64::abs).fold(0.0, f64::max);
        if axes == SweepAxes::Logical {
            assert!(gap <= 1e-12, "void of {gap:e}");
            for (k, account) in ledger.materials.iter().enumerate() {
                let drift = drift(&mesh, &start[k], &fractions[k], account.outflow);
                assert!(drift.abs() <= 1e-12, "material {k} drifts by {drift:e}");
            }
        }
    }
}

#[test]
fn an_inflow_of_a_material_that_is_not_there_is_an_error() {
    let mesh: Mesh2 = unit_mesh(4, Distortion::None);
    let settings = Settings { inflow: Some(1), ..Settings::default() };
    let mut transport = Transport::new(&mesh, steady(Field::Eq101), settings).expect("a transport");
    let mut fractions = vec![vec![0.0; 16]];
    let error = transport.step(&mut fractions, 0, 0.0, 1e-3).unwrap_err();
    assert_eq!(error, StepError::Inflow { material: 1, materials: 1 });
}
