//! One combination of a study, run as often as it takes to know its time.

use std::path::Path;
use std::time::{Duration, Instant};

use vofkit_geometry::{Hexahedron, Quad};

use super::file::{Study, Task};
use super::measure::{Measures, Named, Outcome, Spread};
use super::plan::{self, Combination};
use super::{still, table};
use crate::report::{MaterialSummary, Summary};
use crate::run::threads::Pool;
use crate::run::{self, RunError, RunOptions, Silent, prepare};
use crate::scene::Scene;
use crate::stopwatch::PhaseSeconds;

/// Passes over what is short, at most, and how long they may take together: normally, and in quick studies.
const PASSES: usize = 7;
const PATIENCE: [Duration; 2] = [Duration::from_secs(3), Duration::from_millis(600)];

/// Runs a combination with its threads.
pub(super) fn outcome(study: &Study, combination: &Combination, folder: &Path) -> Outcome {
    let measured = || match study.task {
        Task::Run => moved(study, combination, &folder.join("runs")),
        Task::Reconstruct => still::measured(study, combination),
        Task::Truncate | Task::Position => table::measured(study, combination, folder),
    };
    let threads = plan::threads(study, combination);
    let measures = Pool::new(Some(threads)).map_err(|error| error.to_string()).and_then(|pool| {
        run::forget_peak();
        pool.install(measured)
    });
    match measures {
        Ok(measures) => Outcome::Done(Box::new(Measures { memory_peak: run::peak(), ..measures })),
        Err(reason) => Outcome::Failed(reason),
    }
}

/// Does something again while there is patience.
pub(super) fn repeated<T>(
    quick: bool,
    mut pass: impl FnMut() -> Result<T, String>,
) -> Result<Vec<T>, String> {
    let patience = PATIENCE[usize::from(quick)];
    let (start, mut passes) = (Instant::now(), Vec::new());
    loop {
        passes.push(pass()?);
        let next = start.elapsed().mul_f64(1.0 + 1.0 / passes.len() as f64);
        if passes.len() == PASSES || next > patience {
            return Ok(passes);
        }
    }
}

/// The mean of what there is; none if any is missing.
pub(super) fn mean(values: impl Iterator<Item = Option<f64>>) -> Option<f64> {
    let values: Vec<f64> = values.collect::<Option<_>>()?;
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Cells along an axis, the geometric mean over the axes that are more than one cell long.
pub(super) fn along_axis<const D: usize>(cells: &[usize; D]) -> f64 {
    let long: Vec<f64> = cells.iter().filter(|&&count| count > 1).map(|&count| (count as f64).ln()).collect();
    (long.iter().sum::<f64>() / long.len().max(1) as f64).exp()
}

/// One run of a sample.
struct Sample {
    summary: Summary,
    cells_along_axis: f64,
    memory: u64,
}

/// Measures the run of a combination, errors being means over its samples.
fn moved(study: &Study, combination: &Combination, folder: &Path) -> Result<Measures, String> {
    let options = RunOptions {
        folder: folder.join(format!("{:04}", combination.number)),
        force: true,
        threads: usize::from(plan::threads(study, combination)),
    };
    let one = |sample: &Vec<String>| -> Result<Sample, RunError> {
        let scene = plan::scene(study, combination, sample)?;
        let (summary, cells_along_axis, memory) = match &scene {
            Scene::Plane(scene) => {
                let summary = run::run::<Quad, 2>(scene, &options, &mut Silent)?;
                (summary, along_axis(&scene.mesh.cells), prepare::memory(scene))
            }
            Scene::Space(scene) => {
                let summary = run::run::<Hexahedron, 3>(scene, &options, &mut Silent)?;
                (summary, along_axis(&scene.mesh.cells), prepare::memory(scene))
            }
        };
        Ok(Sample { summary, cells_along_axis, memory })
    };
    let pass =
        || combination.samples.iter().map(one).collect::<Result<Vec<_>, _>>().map_err(|e| e.to_string());
    let passes = repeated(study.quick, pass)?;
    let Some(samples) = passes.first() else { return Err("nothing was run".to_owned()) };
    Ok(summed_up(&passes, samples))
}

fn summed_up(passes: &[Vec<Sample>], samples: &[Sample]) -> Measures {
    let over = |value: fn(&Summary) -> Option<f64>| mean(samples.iter().map(|sample| value(&sample.summary)));
    let errors = [
        ("E", over(|summary| total(&summary.materials, |material| material.shape_error))),
        ("L1", over(|summary| summary.fields.first().and_then(|field| field.l1_error))),
    ];
    let materials = || samples.iter().flat_map(|sample| &sample.summary.materials);
    let largest = |values: Vec<f64>| values.into_iter().reduce(f64::max);
    let drifts = materials().filter_map(|material| material.volume_drift).map(f64::abs);
    let conserved =
        samples.iter().flat_map(|sample| &sample.summary.fields).filter_map(|field| field.conserved);
    let bounds =
        materials().map(|material| (-material.fraction_min).max(material.fraction_max - 1.0).max(0.0));
    let corrected = materials().map(|material| material.corrections.clipped + material.corrections.rescaled);
    let steps = samples.first().map(|sample| sample.summary.steps);
    let mixed = over(|summary| Some(summary.mixed_cells_mean));
    let positions = |summary: &Summary| summary.positions_closed_form + summary.positions_iterative;
    let all: usize = samples.iter().map(|sample| positions(&sample.summary)).sum();
    let closed: usize = samples.iter().map(|sample| sample.summary.positions_closed_form).sum();
    let seconds = |value: &dyn Fn(&Sample) -> f64| {
        let pass = |samples: &Vec<Sample>| mean(samples.iter().map(|sample| Some(value(sample))));
        Spread::of(passes.iter().filter_map(pass).collect())
    };
    let work = mixed.zip(steps).map(|(mixed, steps)| mixed * steps as f64).filter(|&work| work > 0.0);
    let names = PhaseSeconds::default().named().map(|(name, _)| name);
    let stages = names.iter().enumerate().filter_map(|(phase, name)| {
        let median = seconds(&|sample| sample.summary.seconds.named()[phase].1).median;
        (median > 0.0).then(|| Named::new(*name, median))
    });
    Measures {
        errors: errors.into_iter().filter_map(|(name, value)| Some(Named::new(name, value?))).collect(),
        seconds: seconds(&|sample| sample.summary.wall_seconds),
        cells_along_axis: samples.first().map(|sample| sample.cells_along_axis),
        steps,
        mixed_cells: mixed,
        seconds_per_mixed_cell: work
            .map(|work| seconds(&|sample| sample.summary.seconds.steps()).median / work),
        evaluations_per_position: over(|summary| summary.evaluations_per_position),
        closed_form: (all > 0).then(|| closed as f64 / all as f64),
        stages: stages.collect(),
        memory_estimate: samples.iter().map(|sample| sample.memory).max(),
        drift: largest(drifts.chain(conserved.map(f64::abs)).collect()),
        out_of_bounds: largest(bounds.collect()),
        corrected: largest(corrected.collect()),
        ..Measures::default()
    }
}

/// The sum over the materials; none if any is missing or there are none.
fn total(materials: &[MaterialSummary], value: fn(&MaterialSummary) -> Option<f64>) -> Option<f64> {
    let values: Vec<f64> = materials.iter().map(value).collect::<Option<_>>()?;
    (!values.is_empty()).then(|| values.iter().sum())
}
