//! The kernel against `truncation.csv`: 2,000 cases in 25 categories, exact to the last bit.

mod common;

use std::collections::BTreeMap;

use common::{Case, Errors, golden, is_valid};
use vofkit_geometry::{Cell, PositionMethod};

/// Prints a table of errors per category and asserts the bound of each.
fn check(what: &str, bound: impl Fn(&str) -> f64, error: impl Fn(&Case) -> Option<f64>) {
    let cases = golden();
    let mut table: BTreeMap<&str, Errors> = BTreeMap::new();
    for case in &cases {
        if let Some(error) = error(case) {
            table.entry(case.category).or_default().add(error);
        }
    }
    println!("{what:<44} {:>10} {:>10} {:>10}", "largest", "rms", "bound");
    for (category, errors) in &table {
        let bound = bound(category);
        println!("  {category:<42} {:10.2e} {:10.2e} {bound:10.1e}", errors.largest, errors.rms());
    }
    for (category, errors) in &table {
        assert!(errors.largest <= bound(category), "{what}, {category}: {:e}", errors.largest);
    }
}

#[test]
fn there_are_all_cases() {
    let cases = golden();
    assert_eq!(cases.len(), 2000);
    assert_eq!(cases.iter().filter(|case| is_valid(case.category)).count(), 23 * 80);
}

#[test]
fn cell_volume() {
    check(
        "cell volume / itself",
        |_| 2e-15,
        |case| {
            is_valid(case.category)
                .then(|| (case.cell().volume() - case.cell_volume).abs() / case.cell_volume)
        },
    );
}

#[test]
fn truncated_volume() {
    check(
        "truncated volume / cell volume",
        |_| 2e-15,
        |case| {
            is_valid(case.category).then(|| {
                let volume = case.cell().truncate(&case.half_space).volume;
                (volume - case.truncated_volume).abs() / case.cell_volume
            })
        },
    );
}

/// Relative to `max(A, V^(2/3))`: the section of a sliver is much larger than that of a cube of the same volume.
#[test]
fn section_area() {
    let bound = |category: &str| match category {
        // The plane nearly touches an edge or a saddle: the area changes like a logarithm there.
        "along_edge" | "near_saddle" => 1e-12,
        _ => 1e-14,
    };
    check("section area / max(itself, V^(2/3))", bound, |case| {
        let defined = case.category != "axis_normal_cube_on_face";
        (is_valid(case.category) && defined).then(|| {
            let area = case.cell().truncate(&case.half_space).section_area;
            (area - case.section_area).abs() / case.section_area.max(case.cell_volume.powf(2.0 / 3.0))
        })
    });
}

#[test]
fn defects_of_valid_collapsed_and_bow_tie_cells() {
    let (mut bow_ties, mut refused) = (0, 0);
    for case in golden() {
        let defects = case.cell().defects();
        let error = defects.iter().find(|defect| defect.is_error());
        match case.category {
            "swept" => continue,
            "bow_tie" => {
                bow_ties += 1;
                refused += usize::from(error.is_some());
            }
            "collapsed" => {
                assert!(error.is_none() && !defects.is_empty(), "{}: {defects:?}", case.category);
            }
            _ => assert!(error.is_none(), "{}: {error:?}", case.category),
        }
    }
    println!("{refused} of {bow_ties} bow-ties refused");
    assert!(10 * refused >= 9 * bow_ties, "{refused} of {bow_ties}");
}

/// The terms of inverted cells and thin swept regions cancel. The volume of the nodes' bounding box stands for
/// the sum of the terms' magnitudes.
#[test]
fn algebraic_volume_of_swept_regions_and_bow_ties() {
    check(
        "truncated volume / bounding box",
        |_| 1e-14,
        |case| {
            (!is_valid(case.category)).then(|| {
                let cell = case.cell();
                let volume = cell.truncate(&case.half_space).volume;
                let error =
                    (volume - case.truncated_volume).abs().max((cell.volume() - case.cell_volume).abs());
                error / case.box_volume()
            })
        },
    );
}

/// A corner of volume `v` is `v^(1/3)` deep, and the plane's place is rounded relative to the cell's size. So the
/// error relative to the part itself is rounding times `(V / v)^(1/3)`, and no more.
#[test]
fn smaller_part_keeps_its_own_digits() {
    check(
        "almost empty / part, times (v/V)^(1/3)",
        |_| 1e-14,
        |case| {
            (case.category == "almost_empty").then(|| {
                let exact = case.truncated_volume;
                let error = (case.cell().truncate(&case.half_space).volume - exact).abs() / exact;
                error * (exact / case.cell_volume).cbrt()
            })
        },
    );
}

/// The position for the exact part of the volume gives that part back.
#[test]
fn position_returns_the_truncated_volume() {
    for method in [PositionMethod::Auto, PositionMethod::Newton, PositionMethod::Brent] {
        let name = format!("round trip / cell volume, {method:?}");
        // A plane constant is a rounded number, 1e-10 of a cell that lies 1e6 sizes from the origin. These exact
        // constants are rounded numbers themselves and mostly found again.
        let bound = |category: &str| if category == "offset_1e6" { 3e-10 } else { 1e-14 };
        check(&name, bound, |case| {
            is_valid(case.category).then(|| {
                let cell = case.cell();
                let fraction = (case.truncated_volume / case.cell_volume).clamp(0.0, 1.0);
                let position = cell
                    .plane_constant(&case.half_space.normal, fraction, method)
                    .unwrap_or_else(|error| panic!("{}: {error}", case.category));
                let mut half_space = case.half_space;
                half_space.constant = position.constant;
                (cell.truncate(&half_space).volume - fraction * cell.volume()).abs() / case.cell_volume
            })
        });
    }
}
