//! Stiff and extreme cases, on the terminal.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;

use super::progress;
use super::terminal::{self, Failure};
use crate::report::machine::Machine;
use crate::report::table;
use crate::run::threads::Pool;
use crate::stress::pages::{self, badness, file_name};
use crate::stress::{self, Family, Tally};

/// Which cases, and how many.
#[derive(Debug, Args)]
pub struct Work {
    /// Only the families whose name holds this, such as `geometry` or `motion/whirl`.
    #[arg(long, value_name = "NAME")]
    pub filter: Option<String>,
    /// Where the cases come from.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Cases of a family, fewer of those that take longer.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub cases: u32,
    /// The folder of the report.
    #[arg(long, value_name = "DIR", default_value = "out/stress")]
    pub out: PathBuf,
    /// Share the work among N threads, one per processor unless it is given; the results do not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

/// Works through the families, writes the report and prints it.
///
/// # Errors
/// No such family, files that cannot be written, and anything that falls short.
pub fn run(work: Work) -> Result<(), Failure> {
    let Work { filter, seed, cases, out, threads } = work;
    let all = stress::families();
    let wanted = filter.as_deref().unwrap_or_default();
    let families: Vec<&Family> = all.iter().filter(|family| family.name.contains(wanted)).collect();
    if families.is_empty() {
        let names: Vec<&str> = all.iter().map(|family| family.name).collect();
        return Err(Failure::other(
            format!("no family is called \"{wanted}\""),
            format!("there are {}", names.join(", ")),
        ));
    }
    let pool = Pool::new(threads)?;
    // A panic is a finding, and told as one.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let mut progress = progress::chosen();
    let tally = |(number, family): (usize, &&Family)| {
        progress.stage(&format!("{} ({} of {})", family.name, number + 1, families.len()));
        pool.install(|| stress::run(family, seed, cases as usize))
    };
    let tallies: Vec<Tally> = families.iter().enumerate().map(tally).collect();
    progress.end();
    std::panic::set_hook(hook);
    fs::create_dir_all(&out).map_err(|error| {
        let message = format!("cannot make the folder {}: {error}", out.display());
        Failure::other(message, "choose another one with --out")
    })?;
    let machine = Machine::here(Path::new("."));
    pages::write(&tallies, seed, &machine, &out).map_err(|error| Failure::Run(error.into()))?;
    terminal::print(&text(&tallies))?;
    let short: Vec<&str> =
        tallies.iter().filter(|tally| tally.failures > 0).map(|tally| tally.name).collect();
    if short.is_empty() {
        return Ok(());
    }
    Err(Failure::other(
        format!("{} of {} families fall short: {}", short.len(), tallies.len(), short.join(", ")),
        format!("the worst case of each is above and in {}", out.join("stress.html").display()),
    ))
}

fn text(tallies: &[Tally]) -> String {
    let header = ["family", "cases", "short", "worst"].map(str::to_owned).to_vec();
    let row = |tally: &Tally| {
        let counts = [tally.cases, tally.failures].map(|count| count.to_string());
        [&[tally.name.to_owned()], &counts[..], &[badness(&tally.worst)]].concat()
    };
    let rows: Vec<Vec<String>> = std::iter::once(header).chain(tallies.iter().map(row)).collect();
    let mut text = table::columns(&rows);
    for Tally { name, holds, worst, .. } in tallies.iter().filter(|tally| tally.failures > 0) {
        text.push_str(&format!("\n{name} falls short: {holds}\nfound: {}\n", worst.found));
        for file in &worst.reproducer {
            text.push_str(&format!("{}:\n{}\n", file_name(name, file), file.text));
        }
    }
    text
}
