//! A kernel method over a table of cells: errors against the references in it, and nanoseconds per cell.

use std::path::Path;

use vofkit_geometry::{PositionMethod, TruncationMethod};

use super::file::{Study, Task};
use super::measure::{Measures, Named, Spread};
use super::plan::{Combination, kernel_task};
use super::subject::repeated;
use crate::kernel::account::{Account, Category, Errors};
use crate::kernel::{self, Job};

const TRUNCATIONS: [(&str, TruncationMethod); 4] = [
    ("exact", TruncationMethod::Exact),
    ("kothe", TruncationMethod::Kothe),
    ("submesh2", TruncationMethod::Submesh2),
    ("submesh4", TruncationMethod::Submesh4),
];
const POSITIONS: [(&str, PositionMethod); 3] =
    [("auto", PositionMethod::Auto), ("newton", PositionMethod::Newton), ("brent", PositionMethod::Brent)];

/// What the kernel is asked; the words that are known if the method is not.
pub(super) fn task(task: Task, method: &str) -> Result<kernel::Task, Vec<&'static str>> {
    let found = match task {
        Task::Truncate => find(&TRUNCATIONS, method).map(kernel::Task::Truncate),
        _ => find(&POSITIONS, method).map(kernel::Task::Position),
    };
    found.ok_or_else(|| match task {
        Task::Truncate => TRUNCATIONS.iter().map(|(word, _)| *word).collect(),
        _ => POSITIONS.iter().map(|(word, _)| *word).collect(),
    })
}

fn find<T: Copy>(known: &[(&str, T)], word: &str) -> Option<T> {
    known.iter().find(|(name, _)| *name == word).map(|(_, meaning)| *meaning)
}

/// Measures a method. The computed table is left in `folder`.
pub(super) fn measured(study: &Study, combination: &Combination, folder: &Path) -> Result<Measures, String> {
    let task = kernel_task(study, combination).map_err(|error| error.to_string())?;
    let job = Job {
        input: study.subject.clone(),
        output: folder.join(format!("{:04}.csv", combination.number)),
        force: true,
        task,
        timed: true,
    };
    let passes = repeated(study.quick, || kernel::run(&job).map_err(|error| error.to_string()))?;
    let Some(account) = passes.first() else { return Err("the table was not computed".to_owned()) };
    let nanoseconds = |account: &Account| account.timing.map(|timing| timing.evaluate);
    let Category { cells, closed_form, evaluations, .. } = account.total;
    let errors = errors(task, &account.total);
    let categories = account.categories.iter().filter_map(|(name, category)| {
        let error = main_error(task, category);
        (error.count > 0).then(|| Named::new(name.clone(), error.largest))
    });
    let is_position = study.task == Task::Position;
    Ok(Measures {
        errors,
        seconds: Spread::of(passes.iter().filter_map(nanoseconds).map(|time| time * 1e-9).collect()),
        evaluations_per_position: (is_position && cells > 0).then(|| evaluations / cells as f64),
        closed_form: (is_position && cells > 0).then(|| closed_form as f64 / cells as f64),
        categories: categories.collect(),
        ..Measures::default()
    })
}

fn main_error(task: kernel::Task, category: &Category) -> Errors {
    match task {
        kernel::Task::Truncate(_) => category.errors[1],
        kernel::Task::Position(_) => category.residual,
    }
}

fn errors(task: kernel::Task, total: &Category) -> Vec<Named> {
    let of = |name: &str, errors: Errors| {
        let pair = [
            Named::new(format!("{name} rms"), errors.rms()),
            Named::new(format!("{name} largest"), errors.largest),
        ];
        if errors.count > 0 { pair.to_vec() } else { Vec::new() }
    };
    match task {
        kernel::Task::Truncate(_) => [of("volume", total.errors[1]), of("area", total.errors[2])].concat(),
        kernel::Task::Position(_) => of("residual", total.residual),
    }
}
