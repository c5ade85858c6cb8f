//! Runs a scene: everything between a [`Resolved`] scene and the files in the output folder.
//!
//! - this file: runs; [`still`]: the interface as it stands, of a scene of which nothing moves;
//! - [`prepare`]: mesh, fractions and transport, with the last errors of the scene; `velocity`: what moves it; `memory`: whether they fit;
//! - [`plan`]: the time steps; [`moment`]: the state at one time, with nothing written; [`results`]: read back from what was written;
//! - `folder`, `history`, `table`, `output`, `series`, `planes`: what is written; [`draw`]: pictures, of the meshes that have them;
//! - `checkpoint`: the state of a run, to go on from; `inputs`: whether its files are still the same;
//! - `fields`: the quantities that belong to the mesh; `quantities`: those that belong to the materials;
//! - `exact`: the exact final state, where it is known; `shape_errors`: how far planes are from shapes; `tally`: running totals; `notes`: what one might not expect;
//! - [`progress`]: who is told how far it is; [`threads`]: how many work.

mod checkpoint;
pub mod draw;
mod error;
mod exact;
mod fields;
mod folder;
mod history;
mod inputs;
mod memory;
pub mod moment;
mod notes;
pub mod output;
pub mod plan;
mod planes;
pub mod prepare;
pub mod progress;
mod quantities;
pub mod results;
#[cfg(feature = "vtk")]
mod series;
pub(crate) mod shape_errors;
pub mod still;
mod table;
mod tally;
pub mod threads;
mod velocity;

use std::borrow::Cow;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use checkpoint::State;
pub use checkpoint::{Checkpoint, Checkpoints};
pub use draw::Draw;
pub use error::RunError;
pub use output::Schedule;
pub use plan::Plan;
pub use prepare::Setup;
pub use progress::{Progress, Silent};

use fields::{FIELD_TABLE, FieldTable, Fields};
use folder::{Folder, SUMMARY};
use history::{HISTORY, History};
use inputs::inputs;
pub(crate) use memory::{forget_peak, megabytes, peak};
pub(crate) use notes::{notes, of_start};
use output::{Beside, Moved, Output};
use quantities::Quantities;
use table::Table;
use tally::Tally;
pub(crate) use tally::{mixed_cells, not_asked_for};

use crate::advection::Ledger;
use crate::export::{ExportError, write_file};
use crate::facet::Facet;
use crate::interface::reconstruct;
use crate::mesh::Mesh;
use crate::metrics::facet_gap_mean;
use crate::profile::Profile;
use crate::report::Summary;
use crate::scene::{Resolved, Substeps};
use crate::stopwatch::Stopwatch;
use crate::volume_associated::TransportError;

/// With [`Substeps::Auto`] a step is split further while a cell gives too much, but not into more parts than this.
const MOST_SUBSTEPS: usize = 1024;

/// What a scene does not say.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// The output folder.
    pub folder: PathBuf,
    /// Whether the folder may exist; the results in it are then replaced.
    pub force: bool,
    /// The number of threads, for the summary.
    pub threads: usize,
}

/// Runs a scene and writes what it asks for.
///
/// Scene and folder are checked before anything is written, and files are complete or absent. A run that fails before its first
/// step leaves nothing behind; one that fails later leaves the files that it finished.
///
/// # Errors
/// See [`RunError`].
pub fn run<C: Draw<D>, const D: usize>(
    scene: &Resolved<D>,
    options: &RunOptions,
    progress: &mut dyn Progress,
) -> Result<Summary, RunError> {
    run_with_checkpoints::<C, D>(scene, options, &Checkpoints::default(), None, progress)
}

/// The same with checkpoints, from the start or from one of them, whose folder `options` then names.
///
/// A run that goes on comes to the same bits as one that was not stopped. A complete run leaves no checkpoint.
///
/// # Errors
/// See [`RunError`].
pub fn run_with_checkpoints<C: Draw<D>, const D: usize>(
    scene: &Resolved<D>,
    options: &RunOptions,
    checkpoints: &Checkpoints,
    from: Option<Checkpoint>,
    progress: &mut dyn Progress,
) -> Result<Summary, RunError> {
    let done = prepared::<C, D>(scene, options, checkpoints, from, progress);
    progress.end();
    done
}

fn prepared<C: Draw<D>, const D: usize>(
    scene: &Resolved<D>,
    options: &RunOptions,
    checkpoints: &Checkpoints,
    from: Option<Checkpoint>,
    progress: &mut dyn Progress,
) -> Result<Summary, RunError> {
    let (clock, stopwatch) = (Instant::now(), Stopwatch::started());
    if from.is_none() {
        Folder::check(&options.folder, options.force)?;
    }
    progress.stage("mesh");
    let mesh: Mesh<C, D> = prepare::mesh(scene)?;
    progress.stage("fractions");
    let fractions = match &from {
        None => prepare::fractions(scene, &mesh)?,
        Some(_) => Vec::new(),
    };
    progress.stage("fluxes");
    let setup = prepare::setup(scene, &mesh)?;
    let fields = Fields::new(scene, &mesh)?;
    let folder = match &from {
        None => Folder::open(&options.folder, options.force)?,
        Some(_) => Folder::of_run(&options.folder),
    };
    let quantities = match &from {
        None => Quantities::new(scene, &mesh, &fractions),
        Some(_) => Quantities::new(scene, &mesh, &vec![vec![0.0; mesh.grid().len()]; scene.materials.len()]),
    };
    let threads = options.threads;
    let run = Run {
        scene,
        setup,
        fields,
        quantities,
        folder: folder.path(),
        checkpoints,
        threads,
        clock,
        stopwatch,
    };
    let done = run.go(fractions, from, progress);
    if done.is_err() {
        folder.remove_if_empty();
    }
    done
}

/// A run whose folder is there.
struct Run<'a, C, const D: usize> {
    scene: &'a Resolved<D>,
    setup: Setup<'a, C, D>,
    fields: Fields<'a, D>,
    quantities: Quantities<'a, D>,
    folder: &'a Path,
    checkpoints: &'a Checkpoints,
    threads: usize,
    clock: Instant,
    stopwatch: Stopwatch,
}

/// What changes from step to step besides mesh and fields.
struct Stand<'a, const D: usize> {
    step: usize,
    substeps: usize,
    fractions: Vec<Vec<f64>>,
    tally: Tally,
    output: Output<'a, D>,
    history: Option<History>,
    field_table: Option<FieldTable>,
}

impl<'a, C: Draw<D>, const D: usize> Run<'a, C, D> {
    fn go(
        mut self,
        fractions: Vec<Vec<f64>>,
        from: Option<Checkpoint>,
        progress: &mut dyn Progress,
    ) -> Result<Summary, RunError> {
        let (scene, plan) = (self.scene, self.setup.plan);
        let schedule = Schedule::new(&scene.output, &plan);
        self.stopwatch.lap(|seconds| &mut seconds.initialise);
        progress.begin(plan.steps);
        let mut stand = match from {
            None => self.start(fractions, &schedule)?,
            Some(checkpoint) => self.go_on(checkpoint)?,
        };
        self.stopwatch.lap(|seconds| &mut seconds.output);
        while stand.step < plan.steps {
            let [start, end] = [stand.step, stand.step + 1].map(|step| plan.time(step));
            let ledger = match self.step(&mut stand.fractions, stand.step, [start, end], &mut stand.substeps)
            {
                Ok(ledger) => ledger,
                Err(error) => {
                    // The steps before this one may tell why.
                    stand.history.map(|history| history.0.finish()).transpose()?;
                    stand.field_table.map(|table| table.0.finish()).transpose()?;
                    return Err(error);
                }
            };
            stand.tally.add(&stand.fractions, &ledger, stand.substeps);
            self.quantities.note(&stand.fractions, &ledger.quantities);
            if let Some(history) = &mut stand.history {
                let courant = self.setup.courant([start, end]);
                let mesh = self.setup.mover.mesh();
                history.add(&stand.tally.line(mesh, &stand.fractions, &ledger, [start, end], courant))?;
            }
            stand.step += 1;
            self.measure(&mut stand.field_table, stand.step)?;
            progress.step(stand.step, end, stand.tally.mixed_cells());
            if stand.step < plan.steps {
                self.write(&mut stand.output, &schedule, stand.step, &stand.fractions)?;
                stand = self.checkpoint(stand)?;
            }
            self.stopwatch.lap(|seconds| &mut seconds.output);
        }
        progress.stage("summary");
        self.finish(stand, &schedule)
    }

    /// Starts the tables and writes the first state.
    fn start(&self, fractions: Vec<Vec<f64>>, schedule: &Schedule) -> Result<Stand<'a, D>, RunError> {
        let scene = self.scene;
        let tally = Tally::new(self.setup.mover.mesh(), &fractions);
        let history = match scene.output.history {
            true => Some(History::create(self.folder, &scene.material_names(), &tally.first_line())?),
            false => None,
        };
        let mut field_table = match scene.output.history && !self.fields.is_empty() {
            true => Some(FieldTable::create(self.folder, scene.fields.iter().map(|field| &*field.name))?),
            false => None,
        };
        self.measure(&mut field_table, 0)?;
        let mut output = self.output();
        if let Err(error) = self.write(&mut output, schedule, 0, &fractions) {
            output.discard();
            return Err(error);
        }
        let substeps = self.setup.plan.substeps;
        Ok(Stand { step: 0, substeps, fractions, tally, output, history, field_table })
    }

    fn output(&self) -> Output<'a, D> {
        Output::new(self.scene, Beside::Velocity, self.folder.to_owned())
    }

    /// Takes everything to where it was at a checkpoint.
    fn go_on(&mut self, checkpoint: Checkpoint) -> Result<Stand<'a, D>, RunError> {
        let plan = self.setup.plan;
        let (cells, materials) = (self.setup.mover.mesh().grid().len(), self.scene.materials.len());
        checkpoint.check(cells, materials, plan.steps, inputs(self.scene, self.setup.mover.flow()))?;
        let refusal = checkpoint.refusal();
        let State {
            inputs: _,
            step,
            substeps,
            fractions,
            fields,
            quantities,
            tally,
            written,
            history,
            field_table,
        } = checkpoint.state;
        if !(self.fields.go_on(fields) && self.quantities.go_on(quantities)) {
            return Err(refusal);
        }
        self.setup.mover.go_on(plan.time(step) / plan.end).map_err(|error| RunError::Step {
            step,
            steps: plan.steps,
            time: plan.time(step),
            courant: plan.courant,
            error,
        })?;
        let mut output = self.output();
        output.go_on(written);
        let reopened = |name: &str, length: Option<u64>| {
            length.map(|length| Table::reopen(self.folder, name, length)).transpose()
        };
        Ok(Stand {
            step,
            substeps,
            fractions: fractions.into_owned(),
            tally: tally.into_owned(),
            output,
            history: reopened(HISTORY, history)?.map(History),
            field_table: reopened(FIELD_TABLE, field_table)?.map(FieldTable),
        })
    }

    /// Writes a checkpoint where one is due, and ends a run that is to stop.
    fn checkpoint(&self, stand: Stand<'a, D>) -> Result<Stand<'a, D>, RunError> {
        let is_stopped = self.checkpoints.is_stopped();
        if !is_stopped && !self.checkpoints.includes(stand.step) {
            return Ok(stand);
        }
        let length = |table: Option<&Table>| table.map(Table::length).transpose();
        let state = State {
            inputs: inputs(self.scene, self.setup.mover.flow()),
            step: stand.step,
            substeps: stand.substeps,
            fractions: Cow::Borrowed(&stand.fractions),
            fields: self.fields.state(),
            quantities: self.quantities.state(),
            tally: Cow::Borrowed(&stand.tally),
            written: stand.output.written(),
            history: length(stand.history.as_ref().map(|history| &history.0))?,
            field_table: length(stand.field_table.as_ref().map(|table| &table.0))?,
        };
        checkpoint::write(self.folder, self.scene, &state)?;
        if !is_stopped {
            return Ok(stand);
        }
        let (step, steps, folder) = (stand.step, self.setup.plan.steps, self.folder.to_owned());
        let tables = stand.history.map(|history| history.0).into_iter();
        tables.chain(stand.field_table.map(|table| table.0)).for_each(Table::leave);
        Err(RunError::Stopped { step, steps, folder })
    }

    /// Writes the last state and the account of the run.
    fn finish(mut self, stand: Stand<'a, D>, schedule: &Schedule) -> Result<Summary, RunError> {
        let (scene, plan) = (self.scene, self.setup.plan);
        let Stand { fractions, tally, mut output, history, field_table, .. } = stand;
        let facets = self.write(&mut output, schedule, plan.steps, &fractions)?;
        if let Some(history) = history {
            history.0.finish()?;
            output.files.push(HISTORY.to_owned());
        }
        if let Some(table) = field_table {
            table.0.finish()?;
            output.files.push(FIELD_TABLE.to_owned());
        }
        output.files.push(SUMMARY.to_owned());
        let mesh = self.setup.mover.mesh();
        let exact = exact::fractions(scene, mesh, &self.setup, tally.crossed());
        let mut summary = tally.summary(scene, &self.setup, mesh, &fractions, exact.as_deref());
        summary.quantities = self.quantities.summaries(mesh, &fractions);
        summary.fields = self.fields.summaries(mesh, &self.exact_fields(plan.steps), self.setup.is_closed());
        summary.facet_gap_mean = facet_gap_mean(mesh, &facets);
        summary.notes = notes(scene, &self.setup, schedule);
        summary.skipped.times_after_end.clone_from(&schedule.after_end);
        summary.obj_scale = output.obj_scale;
        summary.threads = self.threads;
        summary.files = output.files;
        self.stopwatch.lap(|seconds| &mut seconds.output);
        summary.seconds = self.stopwatch.seconds();
        summary.wall_seconds = self.clock.elapsed().as_secs_f64();
        write_file(self.folder.join(SUMMARY), |writer| {
            serde_json::to_writer_pretty(&mut *writer, &summary)?;
            writeln!(writer)
        })?;
        checkpoint::remove(self.folder)?;
        Ok(summary)
    }

    /// One step, in as many parts as it takes: with [`Substeps::Auto`] the rest of it is split again where a cell would give
    /// more than it holds. A part that fails leaves the fractions as they were.
    fn step(
        &mut self,
        fractions: &mut [Vec<f64>],
        step: usize,
        [start, end]: [f64; 2],
        substeps: &mut usize,
    ) -> Result<Ledger, RunError> {
        let splits = self.scene.advection.substeps == Substeps::Auto;
        let mut ledger = Ledger::new(fractions.len());
        let mut part = 0;
        while part < *substeps {
            let count = *substeps;
            let time = |part: usize| {
                if part == count { end } else { start + (end - start) * (part as f64 / count as f64) }
            };
            match self.part(fractions, step * count + part, [time(part), time(part + 1)]) {
                Ok(of_part) => {
                    ledger.add(&of_part);
                    part += 1;
                }
                Err(TransportError::Step(error))
                    if splits && count < MOST_SUBSTEPS && error.is_too_large() =>
                {
                    *substeps *= 2;
                    part *= 2;
                }
                Err(error) => {
                    let Plan { steps, courant, .. } = self.setup.plan;
                    let (step, time) = (step + 1, start);
                    return Err(match error {
                        TransportError::Step(error) => RunError::Step { step, steps, time, courant, error },
                        error => RunError::Field { step, steps, time, error },
                    });
                }
            }
        }
        Ok(ledger)
    }

    /// A part of a step: fields and materials, or neither.
    fn part(
        &mut self,
        fractions: &mut [Vec<f64>],
        number: usize,
        times: [f64; 2],
    ) -> Result<Ledger, TransportError> {
        let Self { fields, quantities, setup, stopwatch, .. } = self;
        let run_end = setup.plan.end;
        if !fields.is_empty() {
            fields.step(&setup.mover, times, run_end, number)?;
            stopwatch.lap(|seconds| &mut seconds.fields);
        }
        let [start, end] = times;
        let done =
            setup.mover.step(fractions, &mut quantities.values, number, [start, end, run_end], stopwatch);
        stopwatch.lap(|seconds| &mut seconds.update);
        done.map_err(|error| {
            fields.restore();
            error.into()
        })
    }

    /// Where the fields should be after a number of steps.
    fn exact_fields(&self, step: usize) -> Vec<Option<Vec<Profile<D>>>> {
        let time = self.setup.plan.time(step);
        fields::exact(self.scene, self.setup.mover.mesh(), self.setup.mover.rigid_motion(time))
    }

    /// Adds the state after a number of steps to the table of the fields.
    fn measure(&self, table: &mut Option<FieldTable>, step: usize) -> Result<(), ExportError> {
        let Some(table) = table else { return Ok(()) };
        let measures = self.fields.measures(self.setup.mover.mesh(), Some(&self.exact_fields(step)));
        table.add(step, self.setup.plan.time(step), &measures)
    }

    /// Writes what is asked for after a number of steps; returns the facets, which are always there at the end.
    fn write(
        &self,
        output: &mut Output<'_, D>,
        schedule: &Schedule,
        step: usize,
        fractions: &[Vec<f64>],
    ) -> Result<Vec<Facet<D>>, RunError> {
        let mesh = self.setup.mover.mesh();
        let last = step == self.setup.plan.steps;
        let time = self.setup.plan.time(step);
        let state = schedule.includes(step);
        let picture = self.scene.output.picture && (step == 0 || last);
        let facets = if last || picture || state && output.needs_facets() {
            reconstruct(mesh, fractions, self.scene.reconstruction)?.facets
        } else {
            Vec::new()
        };
        if state {
            let flow = self.setup.mover.flow();
            let moved = Moved { fields: &self.fields, quantities: &self.quantities, flow };
            output.state(mesh, time, fractions, &facets, Some(moved))?;
        }
        if picture {
            let when = if last { output::LAST } else { output::FIRST };
            if !fractions.is_empty() {
                output.picture(when, mesh, time, fractions, &facets)?;
            }
            output.field_pictures(when, mesh, time, &self.fields, &self.exact_fields(step))?;
        }
        Ok(facets)
    }
}
