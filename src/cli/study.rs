//! Studies, on the terminal.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;

use super::terminal::{self, Failure};
use crate::study::{self, Outcome, Study, StudyOptions};

/// Which study, to where and how.
#[derive(Debug, Args)]
pub struct Work {
    /// The study file.
    pub study: PathBuf,
    /// The folder of the report; `out/study/NAME` with the name of the study unless it is given.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Take the short lists of the study file, and less patience.
    #[arg(long)]
    pub quick: bool,
    /// Keep the results in the folder and go on behind them.
    #[arg(long)]
    pub resume: bool,
    /// Recommend the cheapest combination whose error is at most E.
    #[arg(long, value_name = "E", value_parser = positive)]
    pub target: Option<f64>,
    /// Print nothing but errors.
    #[arg(long)]
    pub quiet: bool,
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.ok_or_else(|| "give a number above 0, such as 1e-3".to_owned())
}

/// Runs a study and prints what it ended with.
///
/// # Errors
/// See [`study::study`].
pub fn run(work: Work) -> Result<(), Failure> {
    let study = Study::load(&work.study, work.quick)?;
    let folder = work.out.unwrap_or_else(|| PathBuf::from("out").join("study").join(&study.name));
    let options = StudyOptions { folder, resume: work.resume, target: work.target };
    let mut told = |line: &str| {
        if !work.quiet {
            // Nobody may be reading.
            let _ = writeln!(io::stderr().lock(), "{line}");
        }
    };
    let finished = study::study(&study, &options, &mut told)?;
    if work.quiet {
        return Ok(());
    }
    let count =
        |is: fn(&Outcome) -> bool| finished.records.iter().filter(|record| is(&record.outcome)).count();
    let done = count(|outcome| matches!(outcome, Outcome::Done(_)));
    let skipped = count(|outcome| matches!(outcome, Outcome::Skipped(_)));
    let failed = count(|outcome| matches!(outcome, Outcome::Failed(_)));
    let overhead = finished
        .overhead
        .map_or(String::new(), |part| format!("; {:.2} % of the time outside the runs", 100.0 * part));
    terminal::print(&format!(
        "{}\n{done} combinations run, {skipped} skipped, {failed} failed{overhead}\nreport: {}\n",
        finished.recommendation,
        options.folder.join("report.html").display()
    ))
}
