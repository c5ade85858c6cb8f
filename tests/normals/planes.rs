//! Planes are reproduced on every mesh.

use std::collections::BTreeMap;

use proptest::prelude::*;
use vofkit::fractions::volume_fractions;
use vofkit::geometry::{Cell, HalfSpace, Vector};
use vofkit::interface::Placed;
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::normal::NormalMethod;
use vofkit::shape::Shape;

use super::common::{Mesh2, Mesh3, fixed, random, unit_mesh};
use super::{ALL, PLANE_EXACT, WAVE, difference, distortions, placed};

/// Reconstructs a half-space and returns the largest part of a cell in which the two differ, how many of the mixed cells the patch
/// does not determine, and how many there are.
fn plane_error<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    line: HalfSpace<D>,
    method: NormalMethod,
) -> (f64, usize, usize) {
    let fractions = volume_fractions(mesh, &[Shape::HalfSpace(line)]).remove(0);
    let (mut largest, mut open, mut all) = (0.0_f64, 0, 0);
    for (cell, placed) in placed(mesh, &fractions, method) {
        all += 1;
        match placed {
            Placed::Plane { half_space, determined: true, .. } => {
                largest = largest.max(difference(mesh, cell, &half_space, &Shape::HalfSpace(line)));
            }
            _ => open += 1,
        }
    }
    (largest, open, all)
}

/// The half-space with a plane through a point.
pub(super) fn through<const D: usize>(normal: Vector<D>, at: [f64; D]) -> HalfSpace<D> {
    HalfSpace { normal, constant: normal.dot(&Vector::from(at)) }
}

pub(super) fn unit<const D: usize>(parts: [f64; D]) -> Option<Vector<D>> {
    let direction = Vector::from(parts);
    (direction.norm() > 0.1).then(|| direction.normalize())
}

proptest! {
    #![proptest_config(fixed(48, 20_261_126))]

    #[test]
    fn lines_are_reproduced(
        normal in [-1.0..1.0_f64, -1.0..1.0].prop_filter_map("no direction", unit),
        at in [0.2..0.8_f64, 0.2..0.8],
        mesh in 0..3_usize,
        seed in 0..1000_u64,
    ) {
        let mesh: Mesh2 = unit_mesh(12, distortions(seed)[mesh].clone());
        let line = through(normal, at);
        for method in PLANE_EXACT {
            let (error, open, all) = plane_error(&mesh, line, method);
            prop_assert!(error <= 1e-10, "{method:?}: {error:e}");
            prop_assert!(open <= 2, "{method:?}: {open} of {all}");
        }
        if mesh.is_undistorted() {
            let inner = |cell: usize| mesh.grid().offset(cell).iter().all(|&at| at > 0 && at < 11);
            let fractions = volume_fractions(&mesh, &[Shape::HalfSpace(line)]).remove(0);
            for (cell, placed) in placed(&mesh, &fractions, NormalMethod::Elvira) {
                let Placed::Plane { half_space, .. } = placed else { panic!("{placed:?}") };
                let error = difference(&mesh, cell, &half_space, &Shape::HalfSpace(line));
                prop_assert!(!inner(cell) || error <= 1e-10, "{error:e} in {cell}");
            }
        }
    }

    #[test]
    fn planes_are_reproduced(
        normal in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0].prop_filter_map("no direction", unit),
        at in [0.3..0.7_f64, 0.3..0.7, 0.3..0.7],
        mesh in 0..3_usize,
        seed in 0..1000_u64,
    ) {
        let mesh: Mesh3 = unit_mesh(6, distortions(seed)[mesh].clone());
        let plane = through(normal, at);
        for method in PLANE_EXACT {
            let (error, open, all) = plane_error(&mesh, plane, method);
            prop_assert!(error <= 1e-10, "{method:?}: {error:e}");
            prop_assert!(open <= 4, "{method:?}: {open} of {all}");
        }
    }
}

#[test]
fn planes_that_only_just_leave_a_cell_are_reproduced() {
    // Cells that are all but full: near Youngs' normal the misfit has a minimum that is none of the plane's.
    let mesh: Mesh3 = unit_mesh(6, WAVE);
    let normal = Vector::<3>::new(0.36713386925576813, -0.13815825840270105, -0.9198505409469634).normalize();
    let plane = through(normal, [0.520283386193092, 0.4995829922544345, 0.6436300749759469]);
    for method in PLANE_EXACT {
        let (error, open, _) = plane_error(&mesh, plane, method);
        assert!(error <= 1e-10 && open == 0, "{method:?}: {error:e}, {open} open");
    }
}

#[test]
fn planes_that_keep_each_other_wrong_are_left_to_the_misfit() {
    // The plane of cell [0, 7] and a small section beside it hold each other off the line by 1.5e-2 of a cell.
    let mesh: Mesh2 = unit_mesh(12, random(0.2, 582));
    let normal = Vector::<2>::new(0.33895, -0.94080).normalize();
    let (error, open, _) = plane_error(&mesh, through(normal, [0.52373, 0.75469]), NormalMethod::Swartz);
    assert!(error <= 1e-10 && open <= 2, "{error:e}, {open} open");
}

#[test]
fn material_at_the_boundary_and_flat_cells_are_exact_too() {
    // One-sided patches at walls; cells of aspect 1e6; joined ends.
    let normal = Vector::<2>::new(0.6, 0.8);
    let line = HalfSpace { normal, constant: 0.31 };
    let mesh: Mesh2 = unit_mesh(10, random(0.2, 9));
    for method in PLANE_EXACT {
        let (error, _, mixed) = plane_error(&mesh, line, method);
        assert!(error <= 1e-10 && mixed > 5, "{method:?}: {error:e}");
    }
    let grid = Grid::new([10, 10], [false, false]);
    let thin: Mesh2 =
        Mesh::new(grid, Vector::zeros(), Vector::from([1.0, 1e-6]), &random(0.2, 9)).expect("valid");
    let steep = HalfSpace { normal: Vector::from([1e-6, 0.9]), constant: 7e-7 };
    for method in PLANE_EXACT {
        let (error, _, mixed) = plane_error(&thin, steep, method);
        assert!(error <= 1e-9 && mixed > 5, "{method:?}: {error:e}");
    }
    // A disc across the joined ends is the disc in the middle.
    let joined: Mesh2 = Mesh::new(
        Grid::new([20, 20], [true, false]),
        Vector::zeros(),
        Vector::repeat(1.0),
        &Distortion::None,
    )
    .expect("valid");
    let middle = Shape::Sphere { centre: [0.513, 0.477].into(), radius: 0.3 };
    let fractions = volume_fractions(&joined, &[middle]).remove(0);
    let shifted: Vec<f64> = (0..400).map(|cell| fractions[cell / 20 * 20 + (cell + 10) % 20]).collect();
    for method in ALL {
        let here = placed(&joined, &fractions, method);
        let there: BTreeMap<_, _> = placed(&joined, &shifted, method).into_iter().collect();
        for (cell, a) in here {
            let b = &there[&(cell / 20 * 20 + (cell + 10) % 20)];
            let (Placed::Plane { half_space: a, .. }, Placed::Plane { half_space: b, .. }) = (a, b) else {
                panic!("{method:?}: {a:?} {b:?}")
            };
            assert!((a.normal - b.normal).norm() <= 1e-9, "{method:?} in {cell}");
        }
    }
}
