//! The kernel from the command line: exact cases, round trips, files that stay, and everything that can be wrong with a table.
#![cfg(feature = "cli")]

#[path = "../cli_support/mod.rs"]
mod cli_support;
mod profile;
mod table;
mod wrong;

use std::fs;

use cli_support::{Done, Place};
use table::Table;

const GOLDEN: &str = include_str!("../../geometry/tests/truncation.csv");
const COMPUTED: [&str; 6] =
    ["cell_volume", "truncated_volume", "section_area", "moment_x", "moment_y", "moment_z"];

/// Runs `vofkit kernel` and expects it to work.
fn kernel(place: &Place, arguments: &[&str]) -> Done {
    let done = place.vofkit(&[&["kernel"], arguments].concat());
    assert_eq!((done.code, done.err.as_str()), (Some(0), ""), "{arguments:?}");
    done
}

fn is_valid(category: &str) -> bool {
    !matches!(category, "swept" | "bow_tie")
}

#[test]
fn the_exact_cases_come_out_exact() {
    let place = Place::new();
    place.file("in.csv", GOLDEN);
    let done = kernel(&place, &["truncate", "in.csv", "--out", "out.csv"]);
    let (exact, found) = (Table::parse(GOLDEN), Table::read(&place, "out.csv"));
    assert_eq!(found.header, exact.header);
    let wanted = COMPUTED.map(|name| exact.numbers(name));
    let numbers = COMPUTED.map(|name| found.numbers(name));
    for (row, category) in exact.column("category").into_iter().enumerate() {
        let error = |quantity: usize| (numbers[quantity][row] - wanted[quantity][row]).abs();
        let (far, of_box) = exact.extent(row);
        let volume = if is_valid(category) { wanted[0][row] } else { of_box };
        let (of_volume, of_area) = match category {
            "swept" | "bow_tie" => (1e-14, 1e-14),
            "along_edge" | "near_saddle" => (2e-15, 1e-12),
            _ => (2e-15, 1e-14),
        };
        let tell = || format!("{category}, line {}", row + 2);
        assert!(error(0) <= of_volume * volume && error(1) <= of_volume * volume, "{}", tell());
        let area = wanted[2][row].max(volume.powf(2.0 / 3.0));
        let undefined = category == "axis_normal_cube_on_face";
        assert!(error(2) <= of_area * area || undefined, "{}", tell());
        assert!((3..6).all(|quantity| error(quantity) <= 1e-14 * volume * far), "{}", tell());
        assert!(done.out.lines().any(|line| line.starts_with(category)), "{category}\n{}", done.out);
    }
    for words in ["ns per cell", "2000", "medians", "written to out.csv"] {
        assert!(done.out.contains(words), "{}", done.out);
    }
    let on_face = done.out.lines().find(|line| line.starts_with("axis_normal_cube_on_face")).unwrap();
    assert!(on_face.split_whitespace().filter(|field| *field == "-").count() == 2, "{on_face}");
}

#[test]
fn other_columns_pass_through_in_any_order() {
    let place = Place::new();
    let mut table = Table::parse(GOLDEN).without(&COMPUTED);
    table.header.reverse();
    table.header.extend(["note".to_owned(), String::new(), "note".to_owned()]);
    let category = table.header.iter().position(|name| name == "category").unwrap();
    table.header[category] = " kind".to_owned();
    for row in &mut table.rows {
        row.reverse();
        row.extend(["\"α, \"\"β\"\"\"", " 007 ", ""].map(str::to_owned));
    }
    // With a mark of the byte order, and line ends of Windows.
    place.file("in.csv", format!("\u{feff}{}", table.text().replace('\n', "\r\n")));
    kernel(&place, &["truncate", "in.csv", "--out", "out.csv", "--quiet"]);
    let found = Table::read(&place, "out.csv");
    let expected: Vec<&str> = table.header.iter().map(String::as_str).chain(COMPUTED).collect();
    assert_eq!(found.header, expected);
    for (before, after) in table.rows.iter().zip(&found.rows) {
        let count = before.len() - 3;
        assert_eq!(before[..count], after[..count]);
        assert_eq!(after[count..count + 3], ["α, \"β\"", " 007 ", ""]);
    }
    place.file("plain.csv", GOLDEN);
    kernel(&place, &["truncate", "plain.csv", "--out", "plain_out.csv", "--quiet"]);
    let plain = Table::read(&place, "plain_out.csv");
    assert!(COMPUTED.iter().all(|name| plain.column(name) == found.column(name)));
}

#[test]
fn printed_numbers_are_read_back_exactly() {
    let place = Place::new();
    place.file("in.csv", GOLDEN);
    kernel(&place, &["truncate", "in.csv", "--out", "a.csv", "--quiet"]);
    let found = Table::read(&place, "a.csv");
    for name in COMPUTED {
        for (number, text) in found.numbers(name).into_iter().zip(found.column(name)) {
            assert_eq!(format!("{number:?}"), text, "{name}");
        }
    }
    let again = kernel(&place, &["truncate", "a.csv", "--out", "b.csv"]);
    assert_eq!(fs::read(place.path("a.csv")).unwrap(), fs::read(place.path("b.csv")).unwrap());
    let all = again.out.lines().find(|line| line.starts_with("all")).unwrap();
    assert_eq!(all.split_whitespace().filter(|field| *field == "0.0e0").count(), 8, "{all}");
}

/// Every valid cell of the exact cases with every one of these fractions.
fn with_fractions() -> Table {
    let mut names = COMPUTED.to_vec();
    names.push("d");
    let mut table = Table::parse(GOLDEN).without(&names);
    table.header.push("f".to_owned());
    let fractions = [0.0, 1e-14, 1e-9, 1e-3, 0.31, 0.5, 0.77, 1.0 - 1e-6, 1.0 - 1e-12, 1.0 - 1e-14, 1.0];
    let valid = table.rows.iter().filter(|row| is_valid(&row[0]));
    let with = |row: &Vec<String>| fractions.map(|f| [row.clone(), vec![format!("{f:?}")]].concat());
    table.rows = valid.flat_map(with).collect();
    table
}

/// The constant of a plane whose normal is as short as can be is none of those in between.
#[test]
fn residuals_are_those_of_the_planes_that_are_printed() {
    let place = Place::new();
    let names = (0..8).map(|i| format!("x{i},y{i},z{i},")).collect::<String>();
    let cube = "0,0,0,1,0,0,1,1,0,0,1,0,0,0,1,1,0,1,1,1,1,0,1,1";
    place.file("in.csv", format!("{names}nx,ny,nz,f\n{cube},5e-324,0,0,0.25\n{cube},1,0,0,0.25\n"));
    kernel(&place, &["position", "in.csv", "--out", "out.csv", "--quiet"]);
    let planes = Table::read(&place, "out.csv");
    let wanted = [-0.25, 0.0];
    let errors =
        planes.numbers("residual").into_iter().zip(wanted).map(|(found, wanted)| (found - wanted).abs());
    assert!(errors.fold(0.0, f64::max) <= 1e-15, "{:?}", planes.column("residual"));
}

#[test]
fn positions_give_their_fractions_back() {
    let place = Place::new();
    place.file("in.csv", with_fractions().text());
    for method in ["auto", "newton", "brent"] {
        let method = ["position", "in.csv", "--out", "planes.csv", "--force", "--method", method];
        let done = kernel(&place, &method);
        assert!(done.out.contains("evaluations") && done.out.contains("residual"), "{}", done.out);
        let planes = Table::read(&place, "planes.csv");
        assert!(planes.numbers("residual").iter().all(|residual| residual.abs() <= 1e-14));
        assert!(planes.column("evaluations").iter().all(|text| text.parse::<u32>().is_ok()));
        let (volume, fraction) = (planes.numbers("cell_volume"), planes.numbers("f"));
        let (residual, truncated) = (planes.numbers("residual"), planes.numbers("truncated_volume"));
        for row in 0..volume.len() {
            let of_plane = truncated[row] / volume[row] - fraction[row];
            assert!((residual[row] - of_plane).abs() <= 1e-16, "{method:?}, line {}", row + 2);
        }
        let (area, constant) = (planes.numbers("section_area"), planes.numbers("d"));
        let round_trip = |unused: &[&str], rounded: bool| {
            place.file("again.csv", Table::read(&place, "planes.csv").without(unused).text());
            kernel(&place, &["truncate", "again.csv", "--out", "out.csv", "--force", "--quiet"]);
            let back = Table::read(&place, "out.csv").numbers("truncated_volume");
            for row in 0..volume.len() {
                let d = constant[row].abs();
                let step = if rounded { area[row] * (d.next_up() - d) } else { 0.0 };
                let error = (back[row] - fraction[row] * volume[row]).abs();
                assert!(error <= (1e-14 * volume[row]).max(step), "{method:?}, line {}: {error:e}", row + 2);
            }
        };
        // The output as it is, and with each of the two plane constants alone.
        round_trip(&[], false);
        round_trip(&["d"], false);
        round_trip(&["local_constant"], true);
    }
}

#[test]
fn the_inexact_methods_leave_empty_what_they_do_not_give() {
    let place = Place::new();
    let boxes: Vec<&str> =
        GOLDEN.lines().filter(|line| line.starts_with("category") || line.starts_with("box")).collect();
    place.file("in.csv", boxes.join("\n"));
    for (method, given) in [("exact", 6), ("kothe", 2), ("submesh2", 3), ("submesh4", 3)] {
        let arguments = ["truncate", "in.csv", "--out", "out.csv", "--force", "--method", method];
        let done = kernel(&place, &arguments);
        assert_eq!(done.out.contains("left empty"), given < 6, "{}", done.out);
        let (found, exact) = (Table::read(&place, "out.csv"), Table::read(&place, "in.csv"));
        for (quantity, name) in COMPUTED.into_iter().enumerate() {
            if quantity >= given {
                assert!(found.column(name).iter().all(|field| field.is_empty()), "{method} {name}");
                continue;
            }
            // All of them are right for boxes, Kothe's formula where no edge is nearly parallel to the plane.
            for (found, exact) in found.numbers(name).into_iter().zip(exact.numbers(name)) {
                assert!(
                    (found - exact).abs() <= 1e-9 * exact.abs().max(1.0),
                    "{method} {name}: {found} {exact}"
                );
            }
        }
        // Empty fields are no references.
        kernel(&place, &["truncate", "out.csv", "--out", "again.csv", "--force", "--method", method]);
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let place = Place::new();
    place.file("in.csv", with_fractions().text());
    for (threads, out) in [("1", "1.csv"), ("3", "3.csv")] {
        let arguments = ["position", "in.csv", "--out", out, "--quiet", "--threads", threads];
        if cfg!(feature = "parallel") || threads == "1" {
            assert_eq!(kernel(&place, &arguments).out, "");
        }
    }
    if cfg!(feature = "parallel") {
        assert_eq!(fs::read(place.path("1.csv")).unwrap(), fs::read(place.path("3.csv")).unwrap());
    }
}

#[test]
fn normals_have_any_length() {
    let place = Place::new();
    let mut table = Table::parse(GOLDEN);
    let scaled = ["nx", "ny", "nz", "d"].map(|name| table.at(name));
    for row in &mut table.rows {
        for at in scaled {
            row[at] = format!("{:?}", 8.0 * row[at].parse::<f64>().unwrap());
        }
    }
    place.file("unit.csv", GOLDEN);
    place.file("long.csv", table.text());
    for name in ["unit", "long"] {
        kernel(&place, &["truncate", &format!("{name}.csv"), "--out", &format!("{name}_out.csv"), "--quiet"]);
    }
    let [unit, long] = ["unit_out.csv", "long_out.csv"].map(|name| Table::read(&place, name));
    assert!(COMPUTED.iter().all(|name| unit.column(name) == long.column(name)));
}
