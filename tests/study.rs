//! Studies: what they run and skip, what they write, how they go on, and what is refused; and stress cases.
#![cfg(all(feature = "cli", feature = "plot"))]

mod cli_support;

use std::fs;
use std::path::Path;

use cli_support::{Place, number, scene};
use serde_json::Value;
use vofkit::study::plan;
use vofkit::study::{Outcome, Study};

/// A study of a disc that is carried along the diagonal of a tiny mesh.
fn small(more: &str) -> String {
    format!(
        "name = \"small\"\ntask = \"run\"\nscene = {:?}\ntarget = 1e3\n\n[set]\n\"advection.end_time\" = 0.2\n\"output.times\" = []\n{more}",
        scene("disc_diagonal")
    )
}

const CROSS: &str = "\n[cross]\n\"mesh.cells\" = [[8, 8], [16, 16]]\n\"advection.scheme\" = [\"sweeps\", \"weymouth_yue\"]\n\
    \n[variant.mesh]\nundistorted = {}\nrandom = { \"mesh.distortion.random.amplitude\" = 0.2 }\n\
    \n[[skip]]\nmesh = \"random\"\n\"mesh.cells\" = [8, 8]\nbecause = \"too coarse\"\n";

fn results(place: &Place, out: &str) -> Value {
    serde_json::from_slice(&fs::read(place.path(out).join("results.json")).unwrap()).unwrap()
}

/// Runs a study without a word.
fn run(place: &Place, arguments: &[&str]) {
    let done = place.vofkit(&[&["study"], arguments, &["--quiet"]].concat());
    assert_eq!((done.code, done.out.as_str(), done.err.as_str()), (Some(0), "", ""), "{arguments:?}");
}

#[test]
fn the_product_is_run_but_for_what_makes_no_sense() {
    let place = Place::new();
    place.file("s.toml", small(CROSS));
    let done = place.vofkit(&["study", "s.toml", "--quick", "--out", "o"]);
    assert_eq!(done.code, Some(0), "{}", done.err);
    assert!(done.out.contains("5 combinations run, 2 skipped, 1 failed"), "{}", done.out);
    assert!(done.out.contains("For E <= 1e3 take "), "{}", done.out);
    let results = results(&place, "o");
    let all = results["results"].as_array().unwrap();
    assert_eq!(all.len(), 8);
    // The same as by hand.
    let path = scene("disc_diagonal");
    let settings = [
        "mesh.cells=[16,16]",
        "advection.end_time=0.2",
        "output.times=[]",
        "mesh.distortion.random.amplitude=0.2",
    ];
    let mut arguments = vec!["run", path.to_str().unwrap(), "--out", "hand", "--quiet"];
    settings.iter().for_each(|setting| arguments.extend(["--set", setting]));
    assert_eq!(place.vofkit(&arguments).code, Some(0));
    let own =
        all.iter().find(|one| one["labels"] == serde_json::json!(["16 x 16", "sweeps", "random"])).unwrap();
    let error = number(&own["outcome"]["done"]["errors"][0]["value"]);
    assert_eq!(error, number(&place.summary("hand")["materials"][0]["shape_error"]));
    // Skipped and failed ones say why.
    let reason = |labels: Value, kind: &str| {
        let one = all.iter().find(|one| one["labels"] == labels).unwrap();
        one["outcome"][kind].as_str().unwrap().to_owned()
    };
    assert_eq!(reason(serde_json::json!(["8 x 8", "sweeps", "random"]), "skipped"), "too coarse");
    let failed = reason(serde_json::json!(["16 x 16", "weymouth_yue", "random"]), "failed");
    assert!(failed.contains("needs an undistorted mesh"), "{failed}");
}

#[test]
fn the_report_is_there_in_every_form_and_needs_nothing_else() {
    let place = Place::new();
    place.file("s.toml", small(CROSS));
    run(&place, &["s.toml", "--quick", "--out", "o"]);
    let listed = place.listed("o");
    let drawings = ["convergence_e.svg", "cost.svg", "stages.svg", "work_e.svg"];
    for file in ["report.html", "report.md", "results.csv", "results.json"].iter().chain(&drawings) {
        assert!(listed.iter().any(|name| name == file), "no {file} in {listed:?}");
    }
    let read = |name: &str| fs::read_to_string(place.path("o").join(name)).unwrap();
    let html = read("report.html");
    for word in [
        "<svg",
        "Pareto front",
        "Convergence: E",
        "Time by stage",
        "<th>normals</th><th>positions</th><th>fluxes</th><th>update</th>",
        "too coarse",
        "Conservation and bounds",
        "rustc",
    ] {
        assert!(html.contains(word), "no {word} in the page");
    }
    let fetched = ["src=", "href=", "@import", "url("].map(|word| html.contains(word));
    assert_eq!(fetched, [false; 4]);
    assert!(read("report.md").contains("![") && read("report.md").contains("| cells | scheme | mesh |"));
    let mut table = csv::Reader::from_path(place.path("o/results.csv")).unwrap();
    let column = table.headers().unwrap().iter().position(|name| name == "seconds_median").unwrap();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 8);
    let timed = rows.iter().filter(|row| row[column].parse::<f64>().is_ok_and(|time| time > 0.0)).count();
    assert_eq!(timed, 5);
}

#[test]
fn an_interrupted_study_goes_on_and_loses_nothing() {
    let place = Place::new();
    place.file("s.toml", small(CROSS));
    run(&place, &["s.toml", "--quick", "--out", "o"]);
    let whole = fs::read_to_string(place.path("o/results.jsonl")).unwrap();
    let lines: Vec<&str> = whole.lines().collect();
    let half = &lines[4][..lines[4].len() / 2];
    fs::write(place.path("o/results.jsonl"), format!("{}\n{half}", lines[..4].join("\n"))).unwrap();
    let refused = place.vofkit(&["study", "s.toml", "--quick", "--out", "o"]);
    assert_eq!(refused.code, Some(1));
    assert!(refused.err.contains("exists already") && refused.err.contains("--resume"), "{}", refused.err);
    run(&place, &["s.toml", "--quick", "--out", "o", "--resume"]);
    let again = fs::read_to_string(place.path("o/results.jsonl")).unwrap();
    let resumed: Vec<&str> = again.lines().collect();
    // Old results stay as they were, times and all.
    assert_eq!(resumed[..4], lines[..4]);
    assert_eq!(resumed.len(), lines.len());
    assert_eq!(results(&place, "o")["results"].as_array().unwrap().len(), 8);
}

#[test]
fn results_of_another_study_are_not_gone_on_with() {
    let place = Place::new();
    place.file("s.toml", small(CROSS));
    run(&place, &["s.toml", "--quick", "--out", "o"]);
    let before = fs::read(place.path("o/results.jsonl")).unwrap();
    let refused = |words: &str| {
        let done = place.vofkit(&["study", "s.toml", "--out", "o", "--resume"]);
        assert_eq!(done.code, Some(1));
        assert!(done.err.contains("results of another study") && done.err.contains(words), "{}", done.err);
    };
    refused("only one of them is quick");
    place.file("s.toml", small(&CROSS.replace("16, 16", "12, 12")));
    refused("the study file has changed");
    assert_eq!(fs::read(place.path("o/results.jsonl")).unwrap(), before);
}

#[test]
fn errors_are_means_over_samples_and_orders_are_fitted() {
    let place = Place::new();
    let text = format!(
        "task = \"reconstruct\"\nscene = {:?}\n[cross]\n\"mesh.cells\" = [[15, 15], [30, 30], [60, 60]]\n\
         \"reconstruction.normal\" = [\"youngs\", \"swartz\"]\n[average]\n\
         \"material.0.shape.disc.centre\" = [[5.0, 5.0], [5.13, 4.8], [4.71, 5.22]]\n",
        scene("static_disc")
    );
    place.file("discs.toml", text);
    run(&place, &["discs.toml", "--quick", "--out", "o", "--target", "0.1"]);
    let results = results(&place, "o");
    let error = |place: usize| number(&results["results"][place]["outcome"]["done"]["errors"][0]["value"]);
    // Swartz' planes converge faster than Youngs'.
    let [youngs, swartz] = [0, 1].map(|method| (error(method) / error(4 + method)).log2() / 2.0);
    assert!(swartz >= 1.7 && swartz > youngs, "{youngs} {swartz}");
    let recommendation = results["recommendation"].as_str().unwrap();
    assert!(recommendation.contains("symmetric difference <= 1e-1"), "{recommendation}");
    let report = fs::read_to_string(place.path("o/report.md")).unwrap();
    assert!(report.contains("Convergence: Hausdorff"), "{report}");
}

#[test]
fn kernels_are_compared_on_a_table() {
    let place = Place::new();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("geometry/tests/truncation.csv");
    let text = fs::read_to_string(golden).unwrap();
    let rows: Vec<&str> = text.lines().step_by(50).collect();
    place.file("cells.csv", rows.join("\n"));
    let study = "task = \"truncate\"\ntable = \"cells.csv\"\ntarget = 1e-12\n[cross]\nmethod = [\"exact\", \"submesh2\"]\n";
    place.file("k.toml", study);
    run(&place, &["k.toml", "--quick", "--out", "o"]);
    let results = results(&place, "o");
    let largest = |place: usize| number(&results["results"][place]["outcome"]["done"]["errors"][1]["value"]);
    assert!(largest(0) <= 1e-12 && largest(1) >= 1e-6, "{} {}", largest(0), largest(1));
    assert!(results["recommendation"].as_str().unwrap().contains("take exact"), "{results}");
    let report = fs::read_to_string(place.path("o/report.md")).unwrap();
    assert!(report.contains("Largest error by category of cells"), "{report}");
}

#[test]
fn wrong_study_files_are_refused_with_the_line() {
    let place = Place::new();
    let with = |more: &str| small(&format!("{CROSS}{more}"));
    let wrong: &[(String, &[&str])] = &[
        (
            "task = \"run\"\nscene = \"nowhere.toml\"\n".to_owned(),
            &["nowhere.toml", "No such file", "s.toml:2:"],
        ),
        ("task = \"fly\"\n".to_owned(), &["the task \"fly\" is not known", "reconstruct", "s.toml:1:"]),
        ("scene = \"a.toml\"\n".to_owned(), &["missing key `task`"]),
        (small("\n[cross]\n\"mesh.cells\" = []\n"), &["the list of `mesh.cells` is empty", "s.toml:11:"]),
        (small("\n[cross]\n\"mesh.cells\" = 5\n"), &["not a list of values", "s.toml:11:"]),
        (small(""), &["crosses nothing"]),
        (with("[colour]\n"), &["unknown key `colour`", "reference"]),
        (with("[quick]\nmash = [1]\n"), &["`mash` of [quick] is no list of the study"]),
        (with("[quick]\nmesh = [\"wave\"]\n"), &["no variant \"wave\""]),
        (with("[[skip]]\nbecause = \"so\"\n"), &["would skip everything"]),
        (with("[[reference]]\nlabel = \"a\"\nsource = \"b\"\ncells = 3\n"), &["missing key `error`"]),
        (
            with("[[reference]]\nlabel = \"a\"\nsource = \"b\"\ncells = -3\nerror = 1.0\n"),
            &["not a number above 0"],
        ),
        (with("").replace("sweeps", "sweep"), &["\"sweep\" is not known", "s.toml:12:"]),
        (
            with("").replace("random.amplitude", "random.amplitud"),
            &["`mesh` = random is refused", "amplitud", "s.toml:16:"],
        ),
        (with("").replace("end_time", "end_tim"), &["no combination can be run", "end_tim"]),
        (small("\n[cross]\nthreads = [0]\n"), &["a whole number from 1 to 1024", "s.toml:11:"]),
        ("a = [".to_owned(), &["s.toml:1:"]),
    ];
    for (text, answer) in wrong {
        place.file("s.toml", text);
        let done = place.vofkit(&["study", "s.toml", "--out", "o"]);
        assert_eq!(done.code, Some(1), "{text}: {}", done.out);
        for words in *answer {
            assert!(done.err.contains(words), "no {words:?} in {}", done.err);
        }
        assert_eq!(place.listed("."), ["s.toml"]);
    }
    let missing = place.vofkit(&["study", "none.toml"]);
    assert!(
        missing.code == Some(1) && missing.err.contains("cannot read the study file none.toml"),
        "{}",
        missing.err
    );
    let target = place.vofkit(&["study", "s.toml", "--target=-1"]);
    assert!(target.code == Some(2) && target.err.contains("above 0"), "{}", target.err);
}

#[test]
fn every_shipped_study_makes_sense() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    let files = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let studies: Vec<_> = files.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    assert!(studies.len() >= 8, "{studies:?}");
    for path in studies {
        for quick in [false, true] {
            let study = Study::load(&path, quick).unwrap();
            let all = plan::combinations(&study).unwrap();
            let run = all.iter().filter(|one| one.skipped.is_none()).count();
            assert!(2 * run >= all.len() && run >= 2, "{}: {run} of {}", path.display(), all.len());
        }
    }
}

#[test]
fn an_outcome_is_told_in_a_line() {
    let text = Outcome::Failed("so".to_owned()).text(vofkit::study::file::Task::Run);
    assert_eq!(text, "failed: so");
}

#[test]
fn stress_cases_hold_and_are_the_same_for_any_number_of_threads() {
    let place = Place::new();
    for filter in ["geometry", "exact", "fractions", "motion/s", "motion/graded", "materials"] {
        let run = |threads: &str| {
            let arguments =
                ["stress", "--filter", filter, "--cases", "200", "--threads", threads, "--out", threads];
            let done = place.vofkit(&arguments);
            assert_eq!((done.code, done.err.as_str()), (Some(0), ""), "{}", done.out);
            done.out
        };
        assert_eq!(run("1"), run("2"));
    }
    for file in ["stress.html", "stress.json", "stress.md", "geometry_parts.csv", "motion_graded.vts"] {
        assert!(place.path("1").join(file).is_file(), "no {file}");
    }
    let report: Value = serde_json::from_slice(&fs::read(place.path("1/stress.json")).unwrap()).unwrap();
    let families = report["families"].as_array().unwrap();
    assert!(
        families
            .iter()
            .all(|family| family["failures"] == 0 && !family["holds"].as_str().unwrap().is_empty())
    );
}

#[test]
fn the_worst_case_of_every_family_can_be_run_again() {
    let place = Place::new();
    let done = place.vofkit(&["stress", "--cases", "1", "--out", "o"]);
    assert_eq!(done.code, Some(0), "{}", done.err);
    let report: Value = serde_json::from_slice(&fs::read(place.path("o/stress.json")).unwrap()).unwrap();
    let families = report["families"].as_array().unwrap();
    assert!(families.len() >= 40, "{}", families.len());
    for family in families {
        let stem = family["name"].as_str().unwrap().replace('/', "_");
        let files = family["worst"]["reproducer"].as_array().unwrap();
        assert!(!files.is_empty(), "{stem}");
        for file in files {
            let name = format!("o/{stem}.{}", file["extension"].as_str().unwrap());
            let text = fs::read_to_string(place.path(&name)).unwrap();
            assert_eq!(text, file["text"].as_str().unwrap());
            let done = if name.ends_with(".toml") {
                place.vofkit(&["check", &name])
            } else if name.ends_with(".csv") {
                let is_position = text.lines().next().unwrap().ends_with(",f");
                let task = if is_position { "position" } else { "truncate" };
                place.vofkit(&["kernel", task, &name, "--out", "out.csv", "--force"])
            } else {
                continue;
            };
            // What has to be refused is.
            let may_fail = ["geometry_range", "geometry_inverted", "geometry_collapsed", "fractions_odd"];
            let fails = stem == "fractions_field" || may_fail.contains(&&*stem) && done.code == Some(1);
            assert_eq!(done.code, Some(i32::from(fails)), "{name}: {}", done.err);
        }
    }
    for name in ["motion_whirl", "motion_graded", "motion_spin"] {
        let done = place.vofkit(&["run", &format!("o/{name}.toml"), "--out", name]);
        assert_eq!(done.code, Some(0), "{name}: {}", done.err);
    }
}

#[test]
fn an_unknown_family_is_refused_with_those_that_there_are() {
    let done = Place::new().vofkit(&["stress", "--filter", "geometri"]);
    assert_eq!(done.code, Some(1));
    assert!(
        done.err.contains("no family is called \"geometri\"") && done.err.contains("geometry/parts"),
        "{}",
        done.err
    );
    assert_eq!(Place::new().vofkit(&["stress", "--cases", "0"]).code, Some(2));
}
