//! A scene at one time, with nothing written.

use std::path::Path;
use std::time::Instant;

use super::draw::Draw;
use super::fields::Fields;
use super::prepare::Start;
use super::quantities::Quantities;
use super::{Checkpoints, Run, RunError, prepare};
use crate::facet::Facet;
use crate::interface::reconstruct;
use crate::mesh::Mesh;
use crate::scene::{Part, Resolved, Still};
use crate::stopwatch::Stopwatch;

/// What there is at one time.
#[derive(Clone, Debug)]
pub struct Moment<C, const D: usize> {
    /// The time.
    pub time: f64,
    /// The mesh.
    pub mesh: Mesh<C, D>,
    /// The names of the materials.
    pub names: Vec<String>,
    /// Their fractions.
    pub fractions: Vec<Vec<f64>>,
    /// Their interfaces.
    pub facets: Vec<Facet<D>>,
}

/// A scene of which nothing moves.
///
/// # Errors
/// See [`RunError`].
pub fn of_still<C: Draw<D>, const D: usize>(scene: &Still<D>) -> Result<Moment<C, D>, RunError> {
    let mesh: Mesh<C, D> = prepare::still_mesh(scene)?;
    let start = prepare::start(scene, &mesh)?;
    of(scene, 0.0, mesh, start)
}

/// A scene at the end of the first step that reaches a time; the steps are those of a run to the end.
///
/// # Errors
/// See [`RunError`]; also a time that the run does not reach.
pub fn of_run<C: Draw<D>, const D: usize>(scene: &Resolved<D>, time: f64) -> Result<Moment<C, D>, RunError> {
    let mesh: Mesh<C, D> = prepare::mesh(scene)?;
    let mut fractions = prepare::fractions(scene, &mesh)?;
    let setup = prepare::setup(scene, &mesh)?;
    let plan = setup.plan;
    let Some(last) = plan.step_at(time).filter(|_| time >= 0.0) else {
        let message = format!("there is no time {time}: the run goes from 0 to {}", plan.end);
        return Err(scene.error(Part::Steps, message, "give a time in between").into());
    };
    let fields = Fields::new(scene, &mesh)?;
    let quantities = Quantities::new(scene, &mesh, &fractions);
    let checkpoints = &Checkpoints::default();
    let (folder, clock) = (Path::new(""), Instant::now());
    let stopwatch = Stopwatch::started();
    let mut run = Run { scene, setup, fields, quantities, folder, checkpoints, threads: 1, clock, stopwatch };
    let mut substeps = plan.substeps;
    for step in 0..last {
        run.step(&mut fractions, step, [step, step + 1].map(|step| plan.time(step)), &mut substeps)?;
    }
    let mesh = run.setup.mover.mesh().clone();
    of(scene, plan.time(last), mesh, Start { fractions, centroids: None })
}

fn of<C: Draw<D>, const D: usize>(
    scene: &Still<D>,
    time: f64,
    mesh: Mesh<C, D>,
    start: Start<D>,
) -> Result<Moment<C, D>, RunError> {
    let facets = reconstruct(&mesh, start.parts(), scene.reconstruction)?.facets;
    Ok(Moment { time, mesh, names: scene.material_names(), fractions: start.fractions, facets })
}
