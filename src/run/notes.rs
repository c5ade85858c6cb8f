//! What a run tells besides its numbers.

use vofkit_geometry::Cell;

use super::output::Schedule;
use super::prepare::Setup;
use crate::mesh::Mesh;
use crate::scene::{Resolved, ReversalSetup, Still};
use crate::shape::{Body, Shape};

/// What is odd about cells, if anything is.
fn odd_cells<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>) -> Option<String> {
    let first = mesh.notices().first()?;
    let (count, cell) = (mesh.notices().len(), &first.cell);
    Some(format!("{count} odd but legal cells, such as {cell:?}: {}", first.defect))
}

/// What is odd about the mesh of a scene, the file that it comes from, and the surfaces of its bodies.
pub(crate) fn of_start<C: Cell<D>, const D: usize>(scene: &Still<D>, mesh: &Mesh<C, D>) -> Vec<String> {
    let of_file = scene.mesh.file.iter().flat_map(|file| file.notes.iter().cloned());
    let mut notes: Vec<String> = of_file.chain(odd_cells(mesh)).collect();
    for material in &scene.materials {
        let notices = material.shape.iter().flat_map(Shape::bodies).flat_map(Body::notices);
        notes.extend(notices.map(|notice| format!("\"{}\": {notice}", material.name)));
    }
    notes
}

/// What a run of the scene does not do although the scene says so, and what is odd about its mesh and its velocity.
pub(crate) fn notes<C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    setup: &Setup<'_, C, D>,
    schedule: &Schedule,
) -> Vec<String> {
    let plan = &setup.plan;
    let mut notes = of_start(scene, setup.mover.mesh());
    notes.extend(setup.notes.iter().cloned());
    for time in &schedule.after_end {
        notes.push(format!("the output time {time} is after the end and will not be reached"));
    }
    let late = match scene.reversal {
        ReversalSetup::FlipAtStep { step } => step >= plan.steps as u64,
        ReversalSetup::FlipAtTime { time } => time >= plan.end,
        _ => false,
    };
    if late {
        notes.push("the flip of the velocity is after the end and will not be reached".to_owned());
    }
    notes
}
