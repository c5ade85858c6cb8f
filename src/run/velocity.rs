//! What moves the materials of a scene: a field, or the velocity of files.

use vofkit_geometry::{Cell, Vector};

use crate::advection::SetupError;
use crate::import::{ImportError, NodalVelocity, TimedFile};
use crate::mesh::{Mesh, axis_name};
use crate::scene::{Part, Resolved, SceneError, VelocitySetup};
use crate::velocity::{Divergence, Flow, Reversal, Sampled, SampledError, Velocity};

/// Velocities at joined ends may differ by this much, relative to the largest: rounding of the fields.
const PERIODIC_DIFFERENCE: f64 = 1e-9;

/// The flow of a scene at full amplitude, and what one might not expect of the files that it comes from.
///
/// # Errors
/// Files that are no velocity on the mesh, a velocity that is not free of divergence or out of range, and joined ends at which it differs.
pub(super) fn flow<C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &Mesh<C, D>,
) -> Result<(Flow<D>, Vec<String>), SceneError> {
    let (flow, notes) = match &scene.field {
        VelocitySetup::Formula(field) => {
            let flow = Flow::new(mesh, Velocity { field: *field, reversal: Reversal::None })
                .map_err(|range| super::prepare::setup_error(scene, &SetupError::Fluxes(range)))?;
            (flow, Vec::new())
        }
        VelocitySetup::Files { files, divergence } => {
            let (samples, notes) = sampled(scene, mesh, files, *divergence)?;
            (Flow::sampled(samples, Reversal::None), notes)
        }
    };
    check_periodic(scene, mesh, &flow)?;
    Ok((flow, notes))
}

/// The velocity of files, and what one might not expect of them.
fn sampled<C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &Mesh<C, D>,
    files: &[TimedFile],
    divergence: Divergence,
) -> Result<(Sampled<D>, Vec<String>), SceneError> {
    let mut notes = Vec::new();
    let read = |file: &TimedFile| -> Result<(f64, Vec<Vector<D>>), ImportError> {
        let velocity = NodalVelocity::read(&file.path)?;
        notes.extend(velocity.notes());
        Ok((file.time, velocity.on(mesh)?))
    };
    let samples = files
        .iter()
        .map(read)
        .collect::<Result<_, _>>()
        .map_err(|error| scene.error(Part::Field, error.to_string(), error.help()))?;
    let samples = Sampled::new(mesh, samples, divergence).map_err(|error| {
        let file = error.frame().and_then(|frame| files.get(frame));
        let of_file = file.map_or_else(String::new, |file| format!("{}: ", file.path.display()));
        scene.error(Part::Field, format!("{of_file}{error}"), help(&error))
    })?;
    // A series is written by one program.
    let notes = match notes.as_slice() {
        [first, others @ ..] if !others.is_empty() => {
            vec![format!("{first}; so it is in {} more files", others.len())]
        }
        _ => notes,
    };
    Ok((samples, notes))
}

fn help(error: &SampledError) -> &'static str {
    match error {
        SampledError::Divergent { .. } => {
            "set divergence = \"project\" in velocity.field.file, which changes the fluxes as little as it takes to keep volumes, or \
             \"dilate\", which keeps the fluxes and lets volumes change"
        }
        SampledError::Range { .. } | SampledError::Speed { .. } | SampledError::TimeRange { .. } => {
            "choose other units of length or time"
        }
        SampledError::NoConvergence { .. } => {
            "set divergence = \"dilate\", or give a mesh without extremely flat cells"
        }
        SampledError::Empty | SampledError::Time { .. } | SampledError::Count { .. } => {
            "give velocities at increasing times, one for each node"
        }
    }
}

/// Ends can be joined only where the velocity is the same at both.
fn check_periodic<C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &Mesh<C, D>,
    flow: &Flow<D>,
) -> Result<(), SceneError> {
    let periodic = mesh.grid().periodic();
    for axis in (0..D).filter(|&axis| periodic[axis]) {
        let [difference, largest] = flow.mismatch(mesh, axis);
        if difference > PERIODIC_DIFFERENCE * largest.max(f64::MIN_POSITIVE) {
            return Err(scene.error(
                Part::Boundary(axis),
                format!(
                    "the velocity at the two ends of {} differs by {difference:.3e}, so they cannot be joined",
                    axis_name(axis)
                ),
                "use \"wall\" or \"outflow\" there, or a velocity and a box with matching ends",
            ));
        }
    }
    Ok(())
}
