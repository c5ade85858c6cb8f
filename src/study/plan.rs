//! The product of a study's lists, and which of its combinations make no sense.

use super::file::{Axis, METHOD, Study, THREADS, Task};
use super::table;
use crate::kernel;
use crate::scene::{Draft, Scene, SceneError, StillScene};

/// More combinations than this are a slip in the study.
const MOST: usize = 10_000;

/// One of every list.
#[derive(Clone, Debug)]
pub struct Combination {
    /// Its place in the plan.
    pub number: usize,
    /// What was chosen of each list.
    pub labels: Vec<String>,
    /// What is set in the scene.
    pub settings: Vec<String>,
    /// What is set besides, for each of the samples that errors are averaged over.
    pub samples: Vec<Vec<String>>,
    /// Why it is not run.
    pub skipped: Option<String>,
    /// The place in every list.
    at: Vec<usize>,
}

/// All combinations, the first list changing slowest.
///
/// # Errors
/// Values that the scene refuses in every combination, with their place in the study file.
pub fn combinations(study: &Study) -> Result<Vec<Combination>, SceneError> {
    let lengths: Vec<usize> = study.axes.iter().map(|axis| axis.choices.len()).collect();
    let count = lengths.iter().try_fold(1_usize, |count, &length| count.checked_mul(length));
    let Some(count) = count.filter(|&count| count <= MOST) else {
        let message = format!("the lists make more than {MOST} combinations");
        return Err(study.source.error(0..0, message, "shorten them, or split the study"));
    };
    let mut combinations: Vec<Combination> =
        (0..count).map(|number| combination(study, &lengths, number)).collect();
    let mut refused: Vec<Option<SceneError>> = vec![None; count];
    let mut samples_are_good = false;
    for (combination, refused) in combinations.iter_mut().zip(&mut refused) {
        combination.skipped = skip(study, &combination.labels);
        if combination.skipped.is_none() {
            // One combination with all samples, and the others with the first, find what is wrong with either.
            let count = if samples_are_good { 1 } else { combination.samples.len() };
            *refused = check(study, combination, count).err();
            samples_are_good |= refused.is_none();
            combination.skipped =
                refused.as_ref().map(|error| format!("the scene refuses it: {}", error.message()));
        }
    }
    blame(study, &combinations, &refused)?;
    Ok(combinations)
}

fn combination(study: &Study, lengths: &[usize], number: usize) -> Combination {
    let mut at = vec![0; lengths.len()];
    let mut rest = number;
    for (at, &length) in at.iter_mut().zip(lengths).rev() {
        *at = rest % length;
        rest /= length;
    }
    let chosen = || study.axes.iter().zip(&at).map(|(axis, &place)| &axis.choices[place]);
    let settings = chosen().flat_map(|choice| choice.settings.iter().cloned());
    Combination {
        number,
        labels: chosen().map(|choice| choice.label.clone()).collect(),
        settings: quiet(study.task)
            .into_iter()
            .chain(study.settings.iter().cloned())
            .chain(settings)
            .collect(),
        samples: samples(&study.average),
        skipped: None,
        at,
    }
}

/// Nothing is written but the account of a run, unless the study asks for more.
fn quiet(task: Task) -> Vec<String> {
    if task != Task::Run {
        return Vec::new();
    }
    ["interface=[]", "fields=false", "picture=false", "history=false"]
        .map(|setting| format!("output.{setting}"))
        .to_vec()
}

/// The product of the lists that errors are averaged over.
fn samples(axes: &[Axis]) -> Vec<Vec<String>> {
    axes.iter().fold(vec![Vec::new()], |samples, axis| {
        let with = |sample: &Vec<String>| {
            let more =
                axis.choices.iter().map(|choice| [sample.as_slice(), choice.settings.as_slice()].concat());
            more.collect::<Vec<_>>()
        };
        samples.iter().flat_map(with).collect()
    })
}

fn skip(study: &Study, labels: &[String]) -> Option<String> {
    let of = |key: &str| study.axes.iter().position(|axis| axis.key == key).map(|place| &labels[place]);
    let fits = |(key, wanted): &(String, Vec<String>)| of(key).is_some_and(|label| wanted.contains(label));
    study.skips.iter().find(|skip| skip.labels.iter().all(fits)).map(|skip| skip.because.clone())
}

/// Whether the scene can be read with the first samples of a combination.
fn check(study: &Study, combination: &Combination, samples: usize) -> Result<(), SceneError> {
    for sample in &combination.samples[..samples] {
        match study.task {
            Task::Run => drop(scene(study, combination, sample)?),
            Task::Reconstruct => drop(still(study, combination, sample)?),
            Task::Truncate | Task::Position => {
                kernel_task(study, combination)?;
            }
        }
    }
    Ok(())
}

fn draft(study: &Study, combination: &Combination, sample: &[String]) -> Result<Draft, SceneError> {
    let settings = [combination.settings.as_slice(), sample].concat();
    let name = study.subject.display().to_string();
    Draft::parse(&name, &study.name, &study.subject_text, &settings)
}

/// The scene of a combination and a sample.
pub(super) fn scene(
    study: &Study,
    combination: &Combination,
    sample: &[String],
) -> Result<Scene, SceneError> {
    draft(study, combination, sample)?.scene()
}

/// The same for a scene of which nothing moves.
pub(super) fn still(
    study: &Study,
    combination: &Combination,
    sample: &[String],
) -> Result<StillScene, SceneError> {
    draft(study, combination, sample)?.still()
}

/// What the kernel is asked.
pub(super) fn kernel_task(study: &Study, combination: &Combination) -> Result<kernel::Task, SceneError> {
    let method = label(study, combination, METHOD).unwrap_or_default();
    table::task(study.task, method).map_err(|known| {
        let message = format!("the method \"{method}\" is not known; known: {}", known.join(", "));
        study.source.error(0..0, message, "")
    })
}

/// The number of threads of a combination.
pub(super) fn threads(study: &Study, combination: &Combination) -> u16 {
    label(study, combination, THREADS).and_then(|label| label.parse().ok()).unwrap_or(1)
}

fn label<'a>(study: &Study, combination: &'a Combination, key: &str) -> Option<&'a str> {
    let place = study.axes.iter().position(|axis| axis.key == key)?;
    Some(&combination.labels[place])
}

/// A value that the scene refuses together with every other one is wrong.
fn blame(
    study: &Study,
    combinations: &[Combination],
    refused: &[Option<SceneError>],
) -> Result<(), SceneError> {
    // What the study leaves out itself says nothing.
    let judged =
        || combinations.iter().zip(refused).filter(|(one, error)| one.skipped.is_none() || error.is_some());
    let common = |own: &mut dyn Iterator<Item = &Option<SceneError>>| -> Option<SceneError> {
        let errors: Option<Vec<&SceneError>> = own.map(Option::as_ref).collect();
        errors?.first().map(|&error| error.clone())
    };
    if let Some(error) = common(&mut judged().map(|(_, error)| error)) {
        let help = "correct what every combination has in common: the scene, [set] or [average]";
        return Err(study.source.error(
            0..0,
            format!("no combination can be run: {}", error.message()),
            help,
        ));
    }
    for (k, axis) in study.axes.iter().enumerate() {
        for (place, choice) in axis.choices.iter().enumerate() {
            let mut own = judged().filter(|(one, _)| one.at[k] == place).map(|(_, error)| error);
            if let Some(error) = common(&mut own) {
                let message = format!("`{}` = {} is refused: {}", axis.key, choice.label, error.message());
                let help = "correct it, or take it out of the list";
                return Err(study.source.error(choice.place.clone(), message, help));
            }
        }
    }
    Ok(())
}
