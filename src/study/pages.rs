//! The report of a study: `report.html`, `report.md`, `results.csv`, `results.json` and a drawing in each `.svg`.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::analysis::{Point, front, order, points, series, short_title, unranked};
use super::chart::{Bars, Chart, Curve, Mark, Style};
use super::file::{Study, Task};
use super::measure::{Measures, Outcome, Record, Spread, time_unit};
use crate::export::{ExportError, write_file};
use crate::report::document::{Block, Document, Figure};
use crate::report::machine::Machine;
use crate::run::megabytes;

/// What `results.json` holds.
#[derive(Serialize)]
struct Results<'a> {
    study: &'a str,
    lists: Vec<&'a str>,
    recommendation: &'a str,
    machine: &'a Machine,
    results: &'a [Record],
}

/// Writes all files of a report.
pub(super) fn write(
    study: &Study,
    records: &[Record],
    recommendation: &str,
    machine: &Machine,
    folder: &Path,
) -> Result<(), ExportError> {
    let document = document(study, records, recommendation, machine);
    let text =
        |name: &str, text: &str| write_file(folder.join(name), |writer| writer.write_all(text.as_bytes()));
    for figure in document.figures() {
        text(&format!("{}.svg", figure.name), &figure.svg)?;
    }
    let lists = study.axes.iter().map(|axis| axis.key.as_str()).collect();
    let results = Results { study: &study.name, lists, recommendation, machine, results: records };
    write_file(folder.join("results.json"), |writer| {
        serde_json::to_writer_pretty(&mut *writer, &results)?;
        writeln!(writer)
    })?;
    write_file(folder.join("results.csv"), |writer| {
        let mut table = csv::Writer::from_writer(writer);
        for row in csv_rows(study, records) {
            table.write_record(row)?;
        }
        table.flush()
    })?;
    text("report.md", &document.to_markdown())?;
    text("report.html", &document.to_html())
}

/// Numbers of a result by name, in the units of `results.jsonl`.
fn numbers(measures: &Measures) -> [(&'static str, Option<f64>); 16] {
    let Spread { median, lower, upper, count } = measures.seconds;
    [
        ("seconds_median", Some(median)),
        ("seconds_lower_quartile", Some(lower)),
        ("seconds_upper_quartile", Some(upper)),
        ("passes", Some(count as f64)),
        ("cells_along_axis", measures.cells_along_axis),
        ("steps", measures.steps.map(|count| count as f64)),
        ("mixed_cells", measures.mixed_cells),
        ("seconds_per_mixed_cell", measures.seconds_per_mixed_cell),
        ("evaluations_per_position", measures.evaluations_per_position),
        ("closed_form", measures.closed_form),
        ("memory_estimate", measures.memory_estimate.map(|bytes| bytes as f64)),
        ("memory_peak", measures.memory_peak.map(|bytes| bytes as f64)),
        ("drift", measures.drift),
        ("out_of_bounds", measures.out_of_bounds),
        ("corrected", measures.corrected),
        ("undetermined", measures.undetermined.map(|count| count as f64)),
    ]
}

fn csv_rows(study: &Study, records: &[Record]) -> Vec<Vec<String>> {
    let names = error_names(records);
    let empty = Measures::default();
    let mut header: Vec<String> = vec!["number".to_owned()];
    header.extend(study.axes.iter().map(|axis| axis.key.clone()));
    header.extend(["outcome".to_owned(), "reason".to_owned()]);
    header.extend(names.iter().map(|name| (*name).to_owned()));
    header.extend(numbers(&empty).map(|(name, _)| name.to_owned()));
    let row = |record: &Record| {
        let (outcome, reason) = match &record.outcome {
            Outcome::Done(_) => ("done", ""),
            Outcome::Skipped(reason) => ("skipped", reason.as_str()),
            Outcome::Failed(reason) => ("failed", reason.as_str()),
        };
        let mut row = vec![record.number.to_string()];
        row.extend(record.labels.iter().cloned());
        row.extend([outcome.to_owned(), reason.to_owned()]);
        let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:?}"));
        let measures = record.measures();
        row.extend(names.iter().map(|name| number(measures.and_then(|measures| measures.error(Some(name))))));
        row.extend(
            numbers(&empty)
                .iter()
                .enumerate()
                .map(|(k, _)| number(measures.and_then(|measures| numbers(measures)[k].1))),
        );
        row
    };
    std::iter::once(header).chain(records.iter().map(row)).collect()
}

/// The names of the errors, in the order in which they turn up.
fn error_names(records: &[Record]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for error in records.iter().filter_map(Record::measures).flat_map(|measures| &measures.errors) {
        if !names.contains(&error.name.as_str()) {
            names.push(&error.name);
        }
    }
    names
}

fn document(study: &Study, records: &[Record], recommendation: &str, machine: &Machine) -> Document {
    let quick = if study.quick { " (quick)" } else { "" };
    let mut document = Document { title: format!("Study {}{quick}", study.name), blocks: Vec::new() };
    document.blocks.extend(study.about.clone().map(Block::Text));
    document.text(recommendation);
    for name in error_names(records) {
        work_precision(&mut document, study, records, name);
        convergence(&mut document, study, records, name);
    }
    by_cells(&mut document, study, records);
    stages(&mut document, study, records);
    categories(&mut document, study, records);
    bounds(&mut document, study, records);
    left_out(&mut document, study, records);
    document.heading("How this was made");
    document.table(&["", ""], machine.rows());
    document.text(format!("The study file, {}:", study.name));
    document.blocks.push(Block::Verbatim(study.text().to_owned()));
    if !study.subject_text.is_empty() {
        document.text("The scene:");
        document.blocks.push(Block::Verbatim(study.subject_text.clone()));
    }
    document
}

/// A name for files.
fn stem(what: &str, name: &str) -> String {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' }).collect();
    format!("{what}_{plain}")
}

fn figure(document: &mut Document, name: String, caption: String, svg: Option<String>) {
    document.blocks.extend(svg.map(|svg| Block::Figure(Figure { name, caption, svg })));
}

fn scientific(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.3e}"))
}

fn work_precision(document: &mut Document, study: &Study, records: &[Record], name: &str) {
    let (factor, unit) = time_unit(study.task);
    let all = points(records, Some(name));
    if all.is_empty() {
        return;
    }
    let best = front(&all);
    let on_front = |point: &Point<'_>| best.iter().any(|best| best.record.number == point.record.number);
    let mark = |record: &Record| {
        let point = all.iter().find(|point| point.record.number == record.number)?;
        let Spread { median, lower, upper, .. } = point.measures.seconds;
        Some(Mark {
            x: median * factor,
            y: point.error,
            range: Some([lower * factor, upper * factor]),
            label: on_front(point).then(|| short_title(study, point.record)),
        })
    };
    let mut curves: Vec<Curve> = series(study, records)
        .into_iter()
        .map(|series| Curve {
            name: series.name,
            marks: series.records.into_iter().filter_map(mark).collect(),
            style: Style::Points,
        })
        .collect();
    let line = best.iter().map(|point| Mark::at(point.measures.seconds.median * factor, point.error));
    curves.push(Curve { name: "Pareto front".to_owned(), marks: line.collect(), style: Style::Dashed });
    document.heading(format!("Error against time: {name}"));
    let x = format!("median time in {unit}");
    let svg = Chart { x: &x, y: name, y_is_log: true, ticks: Vec::new(), curves }.svg();
    let caption = format!(
        "{name} against {x}; whiskers from the lower to the upper quartile. Labelled: what nothing beats in both."
    );
    figure(document, stem("work", name), caption, svg);
    let mut header: Vec<&str> = study.axes.iter().map(|axis| axis.name()).collect();
    let unit_header = format!("time in {unit}");
    header.extend([name, unit_header.as_str(), "+- %", "passes", "on the front"]);
    let row = |point: &Point<'_>| {
        let Spread { median, count, .. } = point.measures.seconds;
        let mut row = point.record.labels.clone();
        row.extend([
            format!("{:.4e}", point.error),
            format!("{:.4}", median * factor),
            if count > 1 { format!("{:.1}", point.measures.seconds.percent()) } else { "-".to_owned() },
            count.to_string(),
            if on_front(point) { "yes" } else { "" }.to_owned(),
        ]);
        row
    };
    document.table(&header, all.iter().map(row).collect());
    if all.iter().any(|point| point.measures.seconds.count == 1) {
        document.text("Runs that take long are done once: their times have no spread, and small differences mean nothing.");
    }
    let notes = unranked(study, &all);
    if !notes.is_empty() {
        document.text("What could not be ranked:");
        document.blocks.push(Block::List(notes));
    }
}

fn convergence(document: &mut Document, study: &Study, records: &[Record], name: &str) {
    let pairs = |records: &[&Record]| -> Vec<(f64, f64)> {
        let pair = |measures: &Measures| Some((measures.cells_along_axis?, measures.error(Some(name))?));
        records.iter().filter_map(|record| pair(record.measures()?)).collect()
    };
    let series = series(study, records);
    let has_several = |cells: &[(f64, f64)]| cells.iter().any(|(count, _)| *count != cells[0].0);
    if !series.iter().any(|series| has_several(&pairs(&series.records))) {
        return;
    }
    let mut curves: Vec<Curve> = Vec::new();
    let mut rows = Vec::new();
    for series in &series {
        let pairs = pairs(&series.records);
        let order = order(&pairs).map_or_else(|| "-".to_owned(), |order| format!("{order:.2}"));
        let label = if series.name.is_empty() { study.name.as_str() } else { &series.name };
        let marks = pairs.iter().map(|&(x, y)| Mark::at(x, y)).collect();
        curves.push(Curve { name: format!("{label} ({order})"), marks, style: Style::Joined });
        let errors: Vec<String> =
            pairs.iter().map(|(cells, error)| format!("{cells:.0}: {error:.3e}")).collect();
        rows.push(vec![label.to_owned(), order, errors.join(", ")]);
    }
    let is_first = error_names(records).first() == Some(&name);
    let own = |measure: &Option<String>| measure.as_deref().map_or(is_first, |measure| measure == name);
    for reference in study.references.iter().filter(|reference| own(&reference.measure)) {
        let title = format!("{} ({})", reference.label, reference.source);
        let mark = Mark::at(reference.cells, reference.error);
        match curves.iter_mut().find(|curve| curve.style == Style::Marks && curve.name == title) {
            Some(curve) => curve.marks.push(mark),
            None => curves.push(Curve { name: title, marks: vec![mark], style: Style::Marks }),
        }
    }
    let published = curves.iter().filter(|curve| curve.style == Style::Marks);
    rows.extend(published.map(|curve| {
        let errors: Vec<String> =
            curve.marks.iter().map(|mark| format!("{:.0}: {:.3e}", mark.x, mark.y)).collect();
        vec![curve.name.clone(), "published".to_owned(), errors.join(", ")]
    }));
    document.heading(format!("Convergence: {name}"));
    let svg =
        Chart { x: "cells along an axis", y: name, y_is_log: true, ticks: ticks(&curves), curves }.svg();
    let caption =
        format!("{name} against cells along an axis, with fitted orders; diamonds are published values.");
    figure(document, stem("convergence", name), caption, svg);
    document.table(&["", "order", "error by cells along an axis"], rows);
}

/// The places of the points, for numbers under them.
fn ticks(curves: &[Curve]) -> Vec<f64> {
    let mut places: Vec<f64> = curves.iter().flat_map(|curve| &curve.marks).map(|mark| mark.x).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

/// Cost, evaluations and memory over the number of cells.
fn by_cells(document: &mut Document, study: &Study, records: &[Record]) {
    type Value = fn(&Measures) -> Option<f64>;
    let drawings: [(&str, &str, bool, Value); 3] = [
        ("cost", "us per mixed cell and step", true, |measures| Some(measures.seconds_per_mixed_cell? * 1e6)),
        ("evaluations", "evaluations per position", false, |measures| measures.evaluations_per_position),
        ("memory", "MB, the peak of the process", true, |measures| Some(measures.memory_peak? as f64 * 1e-6)),
    ];
    let header: Vec<&str> = study.axes.iter().map(|axis| axis.name()).collect();
    for (name, what, y_is_log, value) in drawings {
        let mark = |measures: &Measures| Some(Mark::at(measures.cells_along_axis?, value(measures)?));
        let curves = series(study, records).into_iter().map(|series| Curve {
            name: series.name,
            marks: series.records.iter().filter_map(|record| mark(record.measures()?)).collect(),
            style: Style::Joined,
        });
        let row = |record: &Record| {
            let measures = record.measures()?;
            let number = format!("{:.4}", value(measures)?);
            let beside = match name {
                "memory" => measures.memory_estimate.map(megabytes),
                "evaluations" => measures.closed_form.map(|share| format!("{:.1} %", 100.0 * share)),
                _ => measures.mixed_cells.map(|count| format!("{count:.1}")),
            };
            Some([record.labels.clone(), vec![number, beside.unwrap_or_else(|| "-".to_owned())]].concat())
        };
        let rows: Vec<Vec<String>> = records.iter().filter_map(row).collect();
        if rows.is_empty() {
            continue;
        }
        let beside = match name {
            "memory" => "estimate",
            "evaluations" => "in closed form",
            _ => "mixed cells",
        };
        document.heading(match name {
            "cost" => "Cost",
            "memory" => "Memory",
            _ => "Evaluations",
        });
        let curves: Vec<Curve> = curves.collect();
        let chart = Chart { x: "cells along an axis", y: what, y_is_log, ticks: ticks(&curves), curves };
        figure(document, name.to_owned(), format!("{what}, against cells along an axis."), chart.svg());
        document.table(&[header.as_slice(), &[what, beside]].concat(), rows);
    }
}

fn stages(document: &mut Document, study: &Study, records: &[Record]) {
    let mut parts: Vec<String> = Vec::new();
    for stage in records.iter().filter_map(Record::measures).flat_map(|measures| &measures.stages) {
        if !parts.contains(&stage.name) {
            parts.push(stage.name.clone());
        }
    }
    let seconds = |record: &Record| -> Option<Vec<f64>> {
        let stages = &record.measures()?.stages;
        let of =
            |part: &String| stages.iter().find(|stage| stage.name == *part).map_or(0.0, |stage| stage.value);
        Some(parts.iter().map(of).collect())
    };
    let bars: Vec<(&Record, Vec<f64>)> =
        records.iter().filter_map(|record| Some((record, seconds(record)?))).collect();
    let drawn = bars.iter().map(|(record, parts)| (short_title(study, record), parts.clone()));
    let Some(svg) = (Bars { parts: &parts, bars: drawn.collect() }).svg() else { return };
    document.heading("Time by stage");
    figure(document, "stages".to_owned(), "Shares of the time of a run by stage.".to_owned(), Some(svg));
    let mut header: Vec<&str> = study.axes.iter().map(|axis| axis.name()).collect();
    header.extend(parts.iter().map(String::as_str));
    let row = |(record, parts): &(&Record, Vec<f64>)| {
        let seconds = parts.iter().map(|seconds| format!("{seconds:.4} s"));
        record.labels.iter().cloned().chain(seconds).collect()
    };
    document.table(&header, bars.iter().map(row).collect());
}

fn categories(document: &mut Document, study: &Study, records: &[Record]) {
    let measured: Vec<(&Record, &Measures)> =
        records.iter().filter_map(|record| Some((record, record.measures()?))).collect();
    let Some((_, first)) = measured.first().filter(|(_, measures)| !measures.categories.is_empty()) else {
        return;
    };
    document.heading("Largest error by category of cells");
    let titles: Vec<String> = measured.iter().map(|(record, _)| short_title(study, record)).collect();
    let header: Vec<&str> = std::iter::once("category").chain(titles.iter().map(String::as_str)).collect();
    let row = |category: &str| {
        let of = |measures: &Measures| {
            measures.categories.iter().find(|named| named.name == category).map(|named| named.value)
        };
        let errors = measured.iter().map(|(_, measures)| scientific(of(measures)));
        std::iter::once(category.to_owned()).chain(errors).collect()
    };
    document.table(&header, first.categories.iter().map(|named| row(&named.name)).collect());
}

fn bounds(document: &mut Document, study: &Study, records: &[Record]) {
    let mut header: Vec<&str> = study.axes.iter().map(|axis| axis.name()).collect();
    let row = |record: &Record| {
        let measures = record.measures()?;
        let counts = measures.undetermined.map_or_else(|| "-".to_owned(), |count| count.to_string());
        let numbers = [measures.drift, measures.out_of_bounds, measures.corrected].map(scientific);
        Some([record.labels.as_slice(), &numbers, &[counts]].concat())
    };
    let rows = records.iter().filter_map(row).collect();
    header.extend(["volume drift", "out of bounds", "corrected volume", "without a plane of their own"]);
    if !matches!(study.task, Task::Truncate | Task::Position) {
        document.heading("Conservation and bounds");
        document.table(&header, rows);
    }
}

fn left_out(document: &mut Document, study: &Study, records: &[Record]) {
    let mut header: Vec<&str> = study.axes.iter().map(|axis| axis.name()).collect();
    let row = |record: &Record| {
        let (what, reason) = match &record.outcome {
            Outcome::Done(_) => return None,
            Outcome::Skipped(reason) => ("skipped", reason),
            Outcome::Failed(reason) => ("failed", reason),
        };
        Some([record.labels.as_slice(), &[what.to_owned(), reason.clone()]].concat())
    };
    let rows: Vec<Vec<String>> = records.iter().filter_map(row).collect();
    if !rows.is_empty() {
        document.heading("Not run, or failed");
        header.extend(["", "reason"]);
        document.table(&header, rows);
    }
}
