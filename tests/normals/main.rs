//! What the normal methods promise: planes exactly (`planes`), circles and spheres to second order, the same after a turn of everything, a
//! status where there is no normal, and few plane constants.

#[path = "../common/mod.rs"]
mod common;
mod mof;
mod planes;

use std::collections::{BTreeMap, BTreeSet};

use common::{Mesh2, Mesh3, random, unit_mesh};
use vofkit::fractions::{symmetric_difference, volume_fractions};
use vofkit::geometry::{Cell, HalfSpace, Quad, Vector};
use vofkit::interface::{Counts, Placed, Reconstruction, is_mixed, planes, reconstruct};
use vofkit::mesh::{Distortion, Mesh};
use vofkit::metrics::{hausdorff_mean, plane_errors};
use vofkit::normal::{Material, NoNormal, NormalMethod};
use vofkit::shape::{Rotation, Shape};

/// The methods that reproduce planes on every mesh.
const PLANE_EXACT: [NormalMethod; 2] = [NormalMethod::Lvira, NormalMethod::Swartz];

/// All methods that need nothing but fractions.
const ALL: [NormalMethod; 8] = [
    NormalMethod::Youngs,
    NormalMethod::YoungsLogical,
    NormalMethod::LeastSquares,
    NormalMethod::Lvira,
    NormalMethod::Elvira,
    NormalMethod::Swartz,
    NormalMethod::Slic,
    NormalMethod::Myc,
];

const WAVE: Distortion = Distortion::Wave { amplitude: 0.5 };

fn with(normal: NormalMethod) -> Reconstruction {
    Reconstruction { normal, ..Reconstruction::default() }
}

/// The planes of a shape's fractions in all mixed cells.
fn placed<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fractions: &[f64],
    normal: NormalMethod,
) -> Vec<(usize, Placed<D>)> {
    let mixed: Vec<usize> = (0..fractions.len()).filter(|&i| is_mixed(fractions[i])).collect();
    let material = Material { mesh, fractions, centroids: None };
    let planes = planes(material, &mixed, with(normal)).expect("valid fractions");
    mixed.into_iter().zip(planes).collect()
}

/// The part of a cell in which a plane (in the cell's local coordinates) and a shape differ.
fn difference<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    cell: usize,
    plane: &HalfSpace<D>,
    shape: &Shape<D>,
) -> f64 {
    let plane = plane.translated(&mesh.anchor(cell));
    symmetric_difference(&mesh.cell(cell), &plane, shape) / mesh.volumes()[cell]
}

fn distortions(seed: u64) -> [Distortion; 3] {
    [Distortion::None, random(0.2, seed), WAVE]
}

/// A point near the middle of the unit box, the same for the same number.
fn near_middle<const D: usize>(number: usize) -> Vector<D> {
    // Multiples of irrational numbers fill the box evenly.
    Vector::from_fn(|k, _| 0.45 + 0.1 * (number as f64 * [0.754_877, 0.569_840, 0.324_717][k] + 0.1).fract())
}

/// Mean symmetric difference and mean Hausdorff distance over some spheres.
fn sphere_errors<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    radius: f64,
    centres: &[Vector<D>],
    method: NormalMethod,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for &centre in centres {
        let shape = Shape::Sphere { centre, radius };
        let fractions = volume_fractions(mesh, std::slice::from_ref(&shape));
        let facets = reconstruct(mesh, &fractions, with(method)).expect("valid fractions").facets;
        sums[0] += plane_errors(mesh, &facets, &shape).iter().sum::<f64>();
        sums[1] += hausdorff_mean(mesh, &facets, &centre, radius).expect("mixed cells");
    }
    sums.map(|sum| sum / centres.len() as f64)
}

#[test]
fn circles_come_out_as_in_the_literature() {
    // Mean Hausdorff distance per mixed cell for a radius of 10, by radius over cell: the published rows of Youngs and LVIRA.
    let rows = [
        (3.2, 0.1224, 0.1527),
        (5.0, 0.0504, 0.0563),
        (6.4, 0.0359, 0.0371),
        (10.0, 0.0197, 0.0137),
        (12.8, 0.0146, 0.0084),
        (15.0, 0.0119, 0.0058),
    ];
    let mut far = false;
    // 25 random circles for each row, as there; other sets of 25 differ by up to a tenth (Youngs at 5: 1.12 of the published
    // mean on one). LVIRA's weights are not published with its row: on these circles it comes out at up to 1.104 of it.
    let mut state = 12345_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        0.4 + 0.2 * ((state >> 11) as f64 / (1_u64 << 53) as f64)
    };
    for (cells, youngs, lvira) in rows {
        let centres: Vec<Vector<2>> = (0..25).map(|_| [random(), random()].into()).collect();
        let mesh: Mesh2 = unit_mesh((10.0 * cells) as usize, Distortion::None);
        let distance = |method| 100.0 * sphere_errors(&mesh, 0.1, &centres, method)[1];
        let [own, fitted, relaxed] =
            [NormalMethod::Youngs, NormalMethod::Lvira, NormalMethod::Swartz].map(distance);
        let ratios = [own / youngs, fitted / lvira, relaxed / lvira];
        println!("{cells}: Youngs {own:.4}, LVIRA {fitted:.4}, Swartz {relaxed:.4}, relative {ratios:.3?}");
        far |= !((ratios[0] - 1.0).abs() <= 0.1 && ratios[1] <= 1.12 && ratios[2] <= 1.05);
    }
    assert!(!far, "further from the published rows than allowed, as printed");
}

#[test]
fn circles_converge_with_second_order() {
    let centres: Vec<Vector<2>> = (0..12).map(near_middle).collect();
    for distortion in distortions(3) {
        let meshes = [40, 400].map(|n| unit_mesh::<Quad, 2>(n, distortion.clone()));
        let order = |method| {
            let [coarse, fine]: [f64; 2] =
                [0, 1].map(|i: usize| sphere_errors(&meshes[i], 0.25, &centres, method)[0]);
            (coarse / fine).log10()
        };
        for method in PLANE_EXACT {
            let order = order(method);
            assert!(order >= 1.9, "{method:?} on {distortion:?}: {order}");
        }
        let youngs = order(NormalMethod::Youngs);
        assert!((0.8..1.7).contains(&youngs), "Youngs on {distortion:?}: {youngs}");
    }
}

#[test]
fn spheres_converge_with_second_order() {
    for distortion in distortions(3) {
        let [coarse, fine]: [Mesh3; 2] = [20, 40].map(|n| unit_mesh(n, distortion.clone()));
        for method in PLANE_EXACT {
            let [coarse, fine] =
                [&coarse, &fine].map(|mesh| sphere_errors(mesh, 0.32, &[near_middle(0)], method)[0]);
            let order = (coarse / fine).log2();
            assert!(order >= 1.9, "{method:?} on {distortion:?}: {order}");
        }
    }
}

/// Errors of a box are confined to cells whose patch holds what is no plane: `bent` says whether a box of space does.
fn flat_sides_are_exact<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    shape: &Shape<D>,
    bent: impl Fn(&Vector<D>, &Vector<D>) -> bool,
) {
    let fractions = volume_fractions(mesh, std::slice::from_ref(shape)).remove(0);
    for method in PLANE_EXACT {
        let mut exact = 0;
        for (cell, placed) in placed(mesh, &fractions, method) {
            let around: Vec<Vector<D>> =
                mesh.grid().around(cell, 1).flat_map(|i| mesh.cell(i).nodes().to_vec()).collect();
            let lower = around.iter().fold(around[0], |a, b| a.inf(b));
            let upper = around.iter().fold(around[0], |a, b| a.sup(b));
            if bent(&lower, &upper) {
                continue;
            }
            let Placed::Plane { half_space, .. } = placed else { panic!("{method:?}: {placed:?}") };
            let error = difference(mesh, cell, &half_space, shape);
            assert!(error <= 1e-10, "{method:?}: {error:e} in {:?}", mesh.grid().offset(cell));
            exact += 1;
        }
        assert!(exact > 0);
    }
}

#[test]
fn sides_of_squares_and_cubes_are_exact_away_from_corners() {
    let (lower, upper) = (0.213, 0.791);
    let holds = |low: f64, high: f64, at: f64| low <= at && at <= high;
    for distortion in distortions(7) {
        for n in [15, 30] {
            let mesh: Mesh2 = unit_mesh(n, distortion.clone());
            let (centre, lengths) = (Vector::repeat(0.5 * (lower + upper)), Vector::repeat(upper - lower));
            let square = Shape::Box { centre, lengths, rotation: Rotation::identity() };
            let side = |a: f64, b: f64| holds(a, b, lower) || holds(a, b, upper);
            flat_sides_are_exact(&mesh, &square, |a, b| side(a[0], b[0]) && side(a[1], b[1]));
        }
        let mesh: Mesh3 = unit_mesh(15, distortion);
        let (centre, lengths) = (Vector::repeat(0.5 * (lower + upper)), Vector::repeat(upper - lower));
        let cube = Shape::Box { centre, lengths, rotation: Rotation::identity() };
        flat_sides_are_exact(&mesh, &cube, |a: &Vector<3>, b: &Vector<3>| {
            let side = |k: usize| holds(a[k], b[k], lower) || holds(a[k], b[k], upper);
            (0..3).filter(|&k| side(k)).count() >= 2
        });
    }
}

#[test]
fn normals_turn_with_mesh_and_field() {
    let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.8, 1.1);
    let mesh: Mesh3 = unit_mesh(10, random(0.2, 5));
    let turned_nodes = mesh.nodes().iter().map(|x| turn * x).collect();
    let turned: Mesh3 = Mesh::from_nodes(mesh.grid().clone(), turned_nodes).expect("valid");
    // Mirrored at x = 0, with the nodes along x in the opposite order.
    let flip = |i: usize, n: usize, row: usize| row * n + (n - 1 - i);
    let mirrored_nodes = (0..mesh.nodes().len())
        .map(|node| {
            let x = mesh.nodes()[flip(node % 11, 11, node / 11)];
            Vector::<3>::new(-x[0], x[1], x[2])
        })
        .collect();
    let mirrored: Mesh3 = Mesh::from_nodes(mesh.grid().clone(), mirrored_nodes).expect("valid");
    let fractions =
        volume_fractions(&mesh, &[Shape::Sphere { centre: near_middle(3), radius: 0.31 }]).remove(0);
    let mirrored_fractions: Vec<f64> =
        (0..fractions.len()).map(|cell| fractions[flip(cell % 10, 10, cell / 10)]).collect();
    for method in ALL {
        let here = placed(&mesh, &fractions, method);
        let normal = |placed: &Placed<3>| match placed {
            Placed::Plane { half_space, .. } => half_space.normal,
            other => panic!("{other:?}"),
        };
        // The logical form takes logical axes for Cartesian ones.
        if method != NormalMethod::YoungsLogical {
            for ((_, a), (_, b)) in here.iter().zip(placed(&turned, &fractions, method)) {
                let off = (turn * normal(a) - normal(&b)).norm();
                assert!(off <= 1e-9, "{method:?} turned: {off:e}");
            }
        }
        let there: BTreeMap<_, _> = placed(&mirrored, &mirrored_fractions, method).into_iter().collect();
        for (cell, a) in here {
            let a = normal(&a);
            let b = normal(&there[&flip(cell % 10, 10, cell / 10)]);
            let off = (Vector::<3>::new(-a[0], a[1], a[2]) - b).norm();
            assert!(off <= 1e-9, "{method:?} mirrored: {off:e}");
        }
    }
}

#[test]
fn cells_without_a_normal_say_why() {
    let mesh: Mesh2 = unit_mesh(5, random(0.2, 1));
    let only = |values: &[(usize, f64)], rest: f64| {
        let mut fractions = vec![rest; 25];
        values.iter().for_each(|&(cell, f)| fractions[cell] = f);
        fractions
    };
    // Two pure neighbours of a film one third of a cell thick pull alike.
    let film: Vec<f64> = (0..25).map(|cell| if cell / 5 == 2 { 1.0 / 3.0 } else { 0.0 }).collect();
    for method in ALL {
        let reason = |fractions: &[f64], cell: usize| {
            let all = placed(&mesh, fractions, method);
            let found = all.iter().find(|(index, _)| *index == cell).map(|(_, placed)| *placed);
            match found {
                Some(Placed::NoNormal(reason)) => reason,
                other => panic!("{method:?}: {other:?}"),
            }
        };
        assert_eq!(reason(&[0.5; 25], 12), NoNormal::Flat);
        assert_eq!(reason(&only(&[(12, 0.4)], 0.0), 12), NoNormal::Isolated);
        assert_eq!(reason(&only(&[(12, 0.4)], 1.0), 12), NoNormal::Isolated);
        assert_eq!(reason(&film, 12), NoNormal::Balanced);
        let mut counts = Counts::default();
        placed(&mesh, &film, method).iter().for_each(|(_, placed)| counts.count(placed));
        assert_eq!([counts.mixed, counts.balanced, counts.no_normal()], [5, 5, 5]);
    }
    assert_eq!(
        placed(&mesh, &only(&[(12, 0.4)], 0.0), NormalMethod::Mof)[0].1,
        Placed::NoNormal(NoNormal::NoCentroid)
    );
}

#[test]
fn a_patch_that_does_not_determine_the_plane_is_said_so() {
    // The corner of the domain alone is cut: nothing of the line is in any other cell.
    let mesh: Mesh2 = unit_mesh(5, Distortion::None);
    let normal = Vector::<2>::new(0.6, 0.8);
    let fractions =
        volume_fractions(&mesh, &[Shape::HalfSpace(HalfSpace { normal, constant: 0.08 })]).remove(0);
    for method in PLANE_EXACT {
        let all = placed(&mesh, &fractions, method);
        assert_eq!(all.len(), 1);
        assert!(matches!(all[0].1, Placed::Plane { determined: false, .. }), "{method:?}: {:?}", all[0].1);
    }
}

#[test]
fn two_interfaces_in_one_patch_keep_apart() {
    // Two bodies with a gap of a cell between their flat sides: each side is a line of its own.
    for distortion in [Distortion::None, random(0.1, 4)] {
        let mesh: Mesh2 = unit_mesh(20, distortion);
        let normal = Vector::<2>::new(0.28, 0.96);
        let below = HalfSpace { normal, constant: 0.5 };
        let above = HalfSpace { normal: -normal, constant: -0.57 };
        let gap = Shape::Union(vec![Shape::HalfSpace(below), Shape::HalfSpace(above)]);
        let fractions = volume_fractions(&mesh, &[gap]).remove(0);
        let mut largest = 0.0_f64;
        for (cell, placed) in placed(&mesh, &fractions, NormalMethod::Swartz) {
            let Placed::Plane { half_space, .. } = placed else { continue };
            let plane = half_space.translated(&mesh.anchor(cell));
            let off = [below, above].map(|line| (line.normal - plane.normal).norm());
            largest = largest.max(off[0].min(off[1]));
        }
        assert!(largest <= 0.35, "{largest}");
    }
}

#[test]
fn three_materials_in_a_patch_each_have_their_own_planes() {
    let mesh: Mesh2 = unit_mesh(12, random(0.2, 2));
    let below = Shape::HalfSpace(HalfSpace { normal: [0.0, 1.0].into(), constant: 0.53 });
    let left = Shape::HalfSpace(HalfSpace { normal: [1.0, 0.0].into(), constant: 0.47 });
    let rest = Shape::HalfSpace(HalfSpace { normal: [-1.0, 0.0].into(), constant: 1.0 });
    let fractions = volume_fractions(&mesh, &[below, left, rest]);
    for method in ALL {
        let interface = reconstruct(&mesh, &fractions, with(method)).expect("valid fractions");
        let triple =
            (0..144).find(|&cell| fractions.iter().all(|f| is_mixed(f[cell]))).expect("one meets all");
        // Materials that share a cell have one facet for each plane that bounds their part.
        let there = interface.facets.iter().filter(|facet| facet.cell == triple);
        let materials: BTreeSet<_> = there.map(|facet| facet.material).collect();
        assert_eq!(materials.len(), 3, "{method:?}");
        assert!(interface.facets.iter().all(|facet| (facet.normal.norm() - 1.0).abs() <= 1e-12));
    }
}

#[test]
fn few_plane_constants_are_found_on_the_way() {
    for distortion in distortions(3) {
        let mesh: Mesh3 = unit_mesh(16, distortion);
        let ball = Shape::Sphere { centre: near_middle(1), radius: 0.32 };
        let fractions = volume_fractions(&mesh, &[ball]).remove(0);
        for (method, most) in [
            (NormalMethod::Youngs, 0.0),
            (NormalMethod::Lvira, 5.0),
            (NormalMethod::Swartz, 5.0),
            (NormalMethod::Elvira, 27.0),
        ] {
            let all = placed(&mesh, &fractions, method);
            let mut counts = Counts::default();
            all.iter().for_each(|(_, placed)| counts.count(placed));
            let mean = counts.trials as f64 / counts.mixed as f64;
            assert!(mean <= most, "{method:?}: {mean}");
        }
    }
}

#[cfg(feature = "parallel")]
#[test]
fn the_number_of_threads_changes_nothing() {
    let mesh: Mesh3 = unit_mesh(16, random(0.2, 8));
    let ball = Shape::Sphere { centre: near_middle(2), radius: 0.33 };
    let fractions = volume_fractions(&mesh, &[ball]).remove(0);
    for method in ALL {
        let with_threads = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| placed(&mesh, &fractions, method))
        };
        assert_eq!(with_threads(1), with_threads(2), "{method:?}");
    }
}
