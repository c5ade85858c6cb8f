//! The report of stress cases: `stress.html`, `stress.md` and `stress.json`, and the worst case of each family in files of its own.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::case::CaseFile;
use super::{Tally, Worst};
use crate::export::{ExportError, write_file};
use crate::report::document::{Block, Document};
use crate::report::machine::Machine;

/// What `stress.json` holds.
#[derive(Serialize)]
struct Results<'a> {
    seed: u64,
    machine: &'a Machine,
    families: &'a [Tally],
}

/// Writes all files of a report into a folder that is there.
///
/// # Errors
/// Files that cannot be written.
pub fn write(tallies: &[Tally], seed: u64, machine: &Machine, folder: &Path) -> Result<(), ExportError> {
    let document = document(tallies, seed, machine);
    let text =
        |name: &str, text: &str| write_file(folder.join(name), |writer| writer.write_all(text.as_bytes()));
    write_file(folder.join("stress.json"), |writer| {
        serde_json::to_writer_pretty(&mut *writer, &Results { seed, machine, families: tallies })?;
        writeln!(writer)
    })?;
    for Tally { name, worst, .. } in tallies {
        for file in &worst.reproducer {
            text(&file_name(name, file), &file.text)?;
        }
    }
    text("stress.md", &document.to_markdown())?;
    text("stress.html", &document.to_html())
}

/// The name of a file of a family's worst case.
pub fn file_name(family: &str, file: &CaseFile) -> String {
    format!("{}.{}", family.replace('/', "_"), file.extension)
}

/// The badness in words.
pub fn badness(worst: &Worst) -> String {
    worst.badness.map_or_else(|| "broken".to_owned(), |badness| format!("{badness:.2e}"))
}

fn document(tallies: &[Tally], seed: u64, machine: &Machine) -> Document {
    let mut document = Document { title: "Stiff and extreme cases".to_owned(), blocks: Vec::new() };
    let failed = tallies.iter().filter(|tally| tally.failures > 0).count();
    document.text(match failed {
        0 => format!("Everything holds in all {} families, from the seed {seed}.", tallies.len()),
        _ => format!("{failed} of {} families fall short, from the seed {seed}.", tallies.len()),
    });
    document.text("Worst: what was found over what is allowed, at most 1 where it holds.");
    let row = |tally: &Tally| {
        let counts = [tally.cases, tally.failures].map(|count| count.to_string());
        [&[tally.name.to_owned()], &counts[..], &[badness(&tally.worst)]].concat()
    };
    document.table(&["family", "cases", "short", "worst"], tallies.iter().map(row).collect());
    document.heading("What must hold, and the worst cases");
    for Tally { name, holds, worst, .. } in tallies {
        document.text(format!("{name}: {holds}. Worst: {}.", worst.found));
        for file in &worst.reproducer {
            document.text(file_name(name, file));
            document.blocks.push(Block::Verbatim(file.text.clone()));
        }
    }
    document.heading("How this was made");
    document.table(&["", ""], machine.rows());
    document
}
