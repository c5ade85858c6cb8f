//! From a scene to everything that a run needs; the scene's last errors are found here, and nothing is written.

use vofkit_geometry::{Cell, Vector};

use super::memory;
use super::plan::Plan;
use crate::advection::{Scheme, Settings, SweepAxes, Transport};
use crate::fractions::volume_fractions;
use crate::mesh::{Grid, Mesh, MeshError, axis_name};
use crate::metrics::material_volume;
use crate::scene::{Part, Resolved, SceneError};
use crate::shape::Shape;
use crate::space::spatial;
use crate::velocity::{FaceFluxes, Velocity};

/// Unusable cells that an error names; the others are in its details.
const NAMED_CELLS: usize = 10;

/// Velocities at joined ends may differ by this much, relative to the largest: rounding of the fields.
const PERIODIC_DIFFERENCE: f64 = 1e-9;

/// The moving part of a run.
#[derive(Debug)]
pub struct Setup<'a, C, const D: usize> {
    /// Moves the materials.
    pub transport: Transport<'a, C, D>,
    /// The velocity with its change in time.
    pub velocity: Velocity,
    /// The time steps.
    pub plan: Plan,
}

/// The mesh of a scene.
///
/// # Errors
/// More memory than there is, cells that cannot be used, all of them in [`SceneError::details`], and amplitudes out of range.
pub fn mesh<C: Cell<D>, const D: usize>(scene: &Resolved<D>) -> Result<Mesh<C, D>, SceneError> {
    memory::check(scene, memory(scene))?;
    let setup = &scene.mesh;
    let grid = Grid::new(setup.cells, scene.boundary.periodic);
    Mesh::new(grid, setup.lower, setup.upper, &setup.distortion).map_err(|error| match error {
        MeshError::Distortion(_) => {
            scene.error(Part::Distortion, error.to_string(), "choose a number in that range")
        }
        MeshError::BadCells { bad, total } => {
            let all: Vec<String> =
                bad.iter().map(|cell| format!("cell {:?}: {}", cell.cell, cell.defect)).collect();
            let mut cells: Vec<_> = bad.iter().map(|cell| &cell.cell).collect();
            cells.dedup();
            let mut message = format!("{} of {total} cells of the mesh cannot be used:", cells.len());
            for line in all.iter().take(NAMED_CELLS) {
                message.push_str("\n  ");
                message.push_str(line);
            }
            if all.len() > NAMED_CELLS {
                message
                    .push_str(&format!("\n  and {} more; `vofkit check` lists all", all.len() - NAMED_CELLS));
            }
            scene
                .error(Part::Distortion, message, "lower the amplitude or the angle of mesh.distortion")
                .with_details(all)
        }
        _ => scene.error(Part::Mesh, error.to_string(), "change mesh.cells, mesh.lower or mesh.upper"),
    })
}

/// The volume fractions at the start.
///
/// # Errors
/// A material of which there is nothing in the domain, unless the scene allows it.
pub fn fractions<C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &Mesh<C, D>,
) -> Result<Vec<Vec<f64>>, SceneError> {
    let shapes: Vec<Shape<D>> = scene.materials.iter().map(|material| material.shape.clone()).collect();
    let fractions = volume_fractions(mesh, &shapes);
    for (k, (material, fractions)) in scene.materials.iter().zip(&fractions).enumerate() {
        if material_volume(mesh, fractions) > 0.0 || material.allow_empty {
            continue;
        }
        let [lower, upper] = mesh.bounds().map(|corner| format!("{:?}", corner.as_slice()));
        return Err(scene.error(
            Part::Shape(k),
            format!(
                "there is nothing of the material \"{}\" in the domain from {lower} to {upper}",
                material.name
            ),
            "move its shape into the domain, or what covers it away; or set allow_empty = true in this [[material]]",
        ));
    }
    Ok(fractions)
}

/// The transport and the time steps.
///
/// # Errors
/// A wall that the velocity crosses, joined ends at which it differs, no time step, or one that is too large.
pub fn setup<'a, C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &'a Mesh<C, D>,
) -> Result<Setup<'a, C, D>, SceneError> {
    check_periodic(scene, mesh)?;
    let fluxes = FaceFluxes::new(mesh, &scene.field).map_err(|range| {
        scene.error(Part::Field, range.to_string(), "choose other units of length or time")
    })?;
    let plan = Plan::new(scene, fluxes.courant_rate(mesh))?;
    let velocity = Velocity { field: scene.field, reversal: plan.reversal(scene.reversal) };
    let settings = Settings {
        ends: scene.boundary.ends,
        inflow: scene.boundary.inflow,
        reconstruction: scene.reconstruction,
        scheme: scene.advection.scheme,
        axes: scene.advection.sweep_axes,
        overdraft: plan.overdraft,
    };
    let transport = Transport::with_fluxes(mesh, velocity, fluxes, settings).map_err(|crossed| {
        scene.error(
            Part::Boundary(crossed.axis),
            crossed.to_string(),
            format!(
                "make that end of boundary.{} \"outflow\", or change the velocity",
                axis_name(crossed.axis)
            ),
        )
    })?;
    Ok(Setup { transport, velocity, plan })
}

/// Ends can be joined only where the velocity is the same at both.
fn check_periodic<C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &Mesh<C, D>,
) -> Result<(), SceneError> {
    let grid = mesh.grid();
    let [lower, upper] = mesh.bounds();
    for axis in (0..D).filter(|&axis| grid.periodic()[axis]) {
        let mut shift = Vector::<3>::zeros();
        shift[axis] = upper[axis] - lower[axis];
        let (mut largest, mut difference) = (0.0_f64, 0.0_f64);
        for (node, x) in mesh.nodes().iter().enumerate() {
            if grid.node_offset(node)[axis] == 0 {
                let x = spatial(x);
                let [here, there] = [x, x + shift].map(|x| scene.field.velocity(&x));
                largest = largest.max(here.amax());
                difference = difference.max((there - here).amax());
            }
        }
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

/// About how many bytes of memory a run of the scene takes.
pub fn memory<const D: usize>(scene: &Resolved<D>) -> u64 {
    let distorted = !scene.mesh.distortion.is_none();
    let number = size_of::<f64>() as u64;
    let [dimension, materials] = [D, scene.materials.len()].map(|count| count as u64);
    // Nodes, volumes, potentials on edges, fractions, which are there twice at times, and passing values.
    let mut values = dimension + 1 + (2 * dimension - 3) + 2 * materials + 2;
    if distorted {
        // Lists of defects.
        values += 3;
        if scene.advection.sweep_axes == SweepAxes::Cartesian {
            values += 2 * dimension;
        }
    }
    let mut band = size_of::<u32>() as u64;
    if scene.advection.scheme == Scheme::Unsplit {
        // Places of mixed cells and of traced nodes; on distorted meshes boxes around blocks of cells.
        band *= 3;
        values += if distorted { 2 } else { 0 };
    }
    let cells = scene.mesh.cells.iter().fold(1_u64, |cells, &count| cells.saturating_mul(count as u64));
    cells.saturating_mul(values * number + band)
}
