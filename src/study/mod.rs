//! Studies: a scene, or a table of cells, run for every combination of lists of settings, and a report of error against time.
//!
//! - [`mod@file`]: the study file; `words`: its parts, read with their places; [`plan`]: the product of its lists, and what of it makes no sense;
//! - [`measure`]: what is known of a combination when it has run; `subject`, `still`, `table`: runs it;
//! - `store`: every result on disk as soon as it is there, and read back to go on;
//! - [`analysis`]: fronts, orders, what noise hides; [`chart`]: drawings; `labels`: what stands beside their points; `pages`: the report.

pub mod analysis;
pub mod chart;
pub mod file;
mod labels;
pub mod measure;
mod pages;
pub mod plan;
mod still;
mod store;
mod subject;
mod table;
mod words;

use std::path::PathBuf;
use std::time::Instant;

pub use file::Study;
pub use measure::{Measures, Outcome, Record};

use crate::report::machine::Machine;
use crate::run::RunError;
use store::Store;

/// What a study file does not say.
#[derive(Clone, Debug)]
pub struct StudyOptions {
    /// The folder of the report.
    pub folder: PathBuf,
    /// Whether the results in it are kept, and the study goes on behind them.
    pub resume: bool,
    /// The error that a recommendation has to stay below, in place of that of the file.
    pub target: Option<f64>,
}

/// What a study ended with.
#[derive(Clone, Debug)]
pub struct Finished {
    /// The results in the order of the plan.
    pub records: Vec<Record>,
    /// The recommendation, in words.
    pub recommendation: String,
    /// The time that went by outside the runs of this call, over all of its time; none where nothing was run.
    pub overhead: Option<f64>,
}

/// Runs a study and writes its report; `told` hears of every combination before it is run and after.
///
/// # Errors
/// A study file that makes no sense, a folder that cannot be used, files that cannot be written. A combination that fails is part of
/// the results.
pub fn study(
    study: &Study,
    options: &StudyOptions,
    told: &mut dyn FnMut(&str),
) -> Result<Finished, RunError> {
    let clock = Instant::now();
    let combinations = plan::combinations(study)?;
    let mut store = Store::open(study, options, combinations.len())?;
    let mut running = 0.0;
    for combination in &combinations {
        if store.has(combination.number) {
            continue;
        }
        let outcome = match &combination.skipped {
            Some(reason) => Outcome::Skipped(reason.clone()),
            None => {
                told(&format!(
                    "{} of {}: {}",
                    combination.number + 1,
                    combinations.len(),
                    study.title(combination)
                ));
                let clock = Instant::now();
                let outcome = subject::outcome(study, combination, &options.folder);
                running += clock.elapsed().as_secs_f64();
                told(&format!("  {}", outcome.text(study.task)));
                outcome
            }
        };
        store.add(Record { number: combination.number, labels: combination.labels.clone(), outcome })?;
    }
    let records = store.records();
    let target = options.target.or(study.target);
    let recommendation = analysis::recommendation(study, &records, target);
    let machine = Machine::here(&study.folder());
    pages::write(study, &records, &recommendation, &machine, &options.folder)?;
    let all = clock.elapsed().as_secs_f64();
    let overhead = (running > 0.0).then(|| (all - running) / all);
    Ok(Finished { records, recommendation, overhead })
}
