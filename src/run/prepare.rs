//! From a scene to everything that a run needs; the scene's last errors are found here, and nothing is written.

use vofkit_geometry::{Cell, Vector};

use super::memory;
use super::plan::Plan;
use super::velocity;
use crate::advection::{
    Boundary, End, Ledger, Remesh, Scheme, Settings, SetupError, StepError, SweepAxes, Transport,
};
use crate::fractions::{MaterialMoments, material_moments, volume_fractions};
use crate::interface::Parts;
use crate::mesh::{Grid, Mesh, MeshError, MeshMotion, MeshPath, MotionError, MotionRates, axis_name};
use crate::metrics::material_volume;
use crate::quantity::MaterialQuantity;
use crate::scene::{Part, Resolved, SceneError, Still};
use crate::stopwatch::Stopwatch;
use crate::velocity::{Flow, RigidMotion};

/// Unusable cells that an error names; the others are in its details.
const NAMED_CELLS: usize = 10;

/// What moves the materials, or the mesh under them.
#[derive(Debug)]
pub enum Mover<'a, C, const D: usize> {
    /// The mesh stands still.
    Flow(Box<Transport<'a, C, D>>),
    /// The materials rest.
    Remesh {
        /// Takes the fractions from one place of the mesh to the next.
        remesh: Box<Remesh<D>>,
        /// The way of the mesh.
        path: MeshPath<C, D>,
        /// Where it is.
        at: Mesh<C, D>,
    },
}

/// The moving part of a run.
#[derive(Debug)]
pub struct Setup<'a, C, const D: usize> {
    /// Moves the materials.
    pub mover: Mover<'a, C, D>,
    /// What happens at the ends of the axes.
    pub boundary: Boundary<D>,
    /// The largest sum of what leaves a cell in a step, relative to its volume; where the mesh moves, of that sum and the change
    /// of the cell's volume.
    pub divergence: f64,
    /// The time steps.
    pub plan: Plan,
    /// What one might not expect of the files of the velocity.
    pub notes: Vec<String>,
}

/// The mesh of a scene.
///
/// # Errors
/// More memory than there is, cells that cannot be used, all of them in [`SceneError::details`], and amplitudes out of range.
pub fn mesh<C: Cell<D>, const D: usize>(scene: &Resolved<D>) -> Result<Mesh<C, D>, SceneError> {
    memory::check(scene, memory(scene))?;
    made(scene)
}

/// The mesh of a scene of which nothing moves.
///
/// # Errors
/// As [`mesh`].
pub fn still_mesh<C: Cell<D>, const D: usize>(scene: &Still<D>) -> Result<Mesh<C, D>, SceneError> {
    memory::check(scene, still_memory(scene))?;
    made(scene)
}

fn made<C: Cell<D>, const D: usize>(scene: &Still<D>) -> Result<Mesh<C, D>, SceneError> {
    let setup = &scene.mesh;
    let grid = Grid::new(setup.cells, scene.boundary.periodic);
    let made = match &setup.file {
        Some(file) => Mesh::from_nodes(grid, file.nodes.clone()),
        None => Mesh::new(grid, setup.lower, setup.upper, &setup.distortion),
    };
    let (of, repair) = match &setup.file {
        Some(file) => (file.path.display().to_string(), "repair them in the file"),
        None => ("the mesh".to_owned(), "lower the amplitude or the angle of mesh.distortion"),
    };
    made.map_err(|error| match error {
        MeshError::Distortion(_) => {
            scene.error(Part::Distortion, error.to_string(), "choose a number in that range")
        }
        MeshError::BadCells { bad, total } => {
            let all: Vec<String> =
                bad.iter().map(|cell| format!("cell {:?}: {}", cell.cell, cell.defect)).collect();
            let mut cells: Vec<_> = bad.iter().map(|cell| &cell.cell).collect();
            cells.dedup();
            let mut message = format!("{} of {total} cells of {of} cannot be used:", cells.len());
            for line in all.iter().take(NAMED_CELLS) {
                message.push_str("\n  ");
                message.push_str(line);
            }
            if all.len() > NAMED_CELLS {
                message
                    .push_str(&format!("\n  and {} more; `vofkit check` lists all", all.len() - NAMED_CELLS));
            }
            scene.error(Part::Distortion, message, repair).with_details(all)
        }
        _ if setup.file.is_some() => {
            scene.error(Part::Mesh, format!("{of}: {error}"), "repair it in the file")
        }
        _ => scene.error(Part::Mesh, error.to_string(), "change mesh.cells, mesh.lower or mesh.upper"),
    })
}

/// What the materials have of the cells at the start.
#[derive(Clone, Debug)]
pub struct Start<const D: usize> {
    /// Fractions by material and cell.
    pub fractions: Vec<Vec<f64>>,
    /// Centroids by material and cell, where the normal method reads them.
    pub centroids: Option<Vec<Vec<Vector<D>>>>,
}

impl<const D: usize> Start<D> {
    /// As the reconstruction takes them.
    pub fn parts(&self) -> Parts<'_, D> {
        Parts { fractions: &self.fractions, centroids: self.centroids.as_deref() }
    }
}

/// The volume fractions at the start.
///
/// # Errors
/// As [`start`].
pub fn fractions<C: Cell<D>, const D: usize>(
    scene: &Still<D>,
    mesh: &Mesh<C, D>,
) -> Result<Vec<Vec<f64>>, SceneError> {
    start(scene, mesh).map(|start| start.fractions)
}

/// Fractions at the start and, where the normal method reads them, centroids.
///
/// # Errors
/// A material of which there is nothing in the domain, unless the scene allows it.
pub fn start<C: Cell<D>, const D: usize>(
    scene: &Still<D>,
    mesh: &Mesh<C, D>,
) -> Result<Start<D>, SceneError> {
    let shapes = || scene.shapes().unwrap_or_default();
    let start = match &scene.parts {
        Some(parts) => Start { fractions: parts.fractions.clone(), centroids: parts.centroids.clone() },
        None if scene.reconstruction.normal.reads_centroids() => {
            let MaterialMoments { fractions, centroids } = material_moments(mesh, &shapes());
            Start { fractions, centroids: Some(centroids) }
        }
        None => Start { fractions: volume_fractions(mesh, &shapes()), centroids: None },
    };
    for (k, (material, fractions)) in scene.materials.iter().zip(&start.fractions).enumerate() {
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
            if material.shape.is_some() {
                "move its shape into the domain, or what covers it away; or set allow_empty = true in this [[material]]"
            } else {
                "leave out this [[material]], or set allow_empty = true in it"
            },
        ));
    }
    Ok(start)
}

/// The transport and the time steps.
///
/// # Errors
/// A wall that the velocity crosses, joined ends at which it differs, no time step, or one that is too large.
pub fn setup<'a, C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &'a Mesh<C, D>,
) -> Result<Setup<'a, C, D>, SceneError> {
    if let Some(motion) = &scene.mesh.motion {
        return moving(scene, mesh, motion);
    }
    let (flow, notes) = velocity::flow(scene, mesh)?;
    let plan = Plan::new(scene, flow.courant_rate(mesh))?;
    let flow = flow.with_reversal(plan.reversal(scene.reversal));
    let divergence = flow.largest_divergence(mesh, plan.dt());
    let transport = Transport::with_flow(mesh, flow, settings(scene, &plan))
        .map_err(|error| setup_error(scene, &error))?;
    let boundary = *transport.boundary();
    Ok(Setup { mover: Mover::Flow(Box::new(transport)), boundary, divergence, plan, notes })
}

/// The same for a mesh that moves.
fn moving<'a, C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &Mesh<C, D>,
    motion: &MeshMotion<D>,
) -> Result<Setup<'a, C, D>, SceneError> {
    let wrong = |error: MotionError| {
        let help = "change mesh.motion, or lower its amplitude or angle";
        scene.error(Part::Motion, error.to_string(), help)
    };
    let path = MeshPath::new(mesh.clone(), motion.clone()).map_err(wrong)?;
    let MotionRates { courant, mismatch } = path.rates().map_err(wrong)?;
    let plan = Plan::new(scene, courant / scene.advection.stepping.end_time().unwrap_or(1.0))?;
    let remesh = Remesh::new(settings(scene, &plan)).map_err(|error| setup_error(scene, &error))?;
    let first = path.mesh(plan.dt() / plan.end).map_err(wrong)?;
    let boundary = remesh.boundary(mesh, &first).map_err(|error| {
        scene.error(
            Part::Motion,
            error.to_string(),
            "leave out that end in [boundary], or make it \"outflow\"",
        )
    })?;
    let mover = Mover::Remesh { remesh: Box::new(remesh), at: mesh.clone(), path };
    Ok(Setup { mover, boundary, divergence: mismatch, plan, notes: Vec::new() })
}

impl<C: Cell<D>, const D: usize> Setup<'_, C, D> {
    /// Whether nothing can leave the mesh.
    pub fn is_closed(&self) -> bool {
        let periodic = self.mover.mesh().grid().periodic();
        (0..D).all(|axis| periodic[axis] || !self.boundary.ends[axis].contains(&End::Outflow))
    }

    /// The Courant number of a step, by what moves in it.
    pub(crate) fn courant(&self, [start, end]: [f64; 2]) -> f64 {
        let rate = self.plan.courant / self.plan.dt();
        let duration = self.mover.flow().map_or(end - start, |flow| flow.step(start, end).duration());
        rate * duration.abs()
    }
}

impl<C: Cell<D>, const D: usize> Mover<'_, C, D> {
    /// The mesh as it is now.
    pub fn mesh(&self) -> &Mesh<C, D> {
        match self {
            Self::Flow(transport) => transport.mesh(),
            Self::Remesh { at, .. } => at,
        }
    }

    /// What moves the materials; none where they rest.
    pub fn flow(&self) -> Option<&Flow<D>> {
        match self {
            Self::Flow(transport) => Some(transport.flow()),
            Self::Remesh { .. } => None,
        }
    }

    /// The rigid motion of the materials from the start to `time`; none where it is not known.
    pub(crate) fn rigid_motion(&self, time: f64) -> Option<RigidMotion> {
        let rest = Some(RigidMotion::Translation { shift: Vector::zeros() });
        self.flow().map_or(rest, |flow| flow.rigid_motion(0.0, time))
    }

    /// Takes the mesh to where it is after a part of its way.
    ///
    /// # Errors
    /// Cells that cannot be used.
    pub(crate) fn go_on(&mut self, part: f64) -> Result<(), StepError> {
        if let Self::Remesh { path, at, .. } = self {
            *at = path.mesh(part)?;
        }
        Ok(())
    }

    /// Advances fractions and quantities from `start` to `end`, in a run that ends at `run_end`. `step` counts the steps and their parts.
    ///
    /// # Errors
    /// A step that cannot be done; all of them, and the mesh, are then as before.
    pub fn step(
        &mut self,
        fractions: &mut [Vec<f64>],
        quantities: &mut [MaterialQuantity],
        step: usize,
        [start, end, run_end]: [f64; 3],
        stopwatch: &mut Stopwatch,
    ) -> Result<Ledger, StepError> {
        // Without materials there is nothing to cut.
        let is_needed = !fractions.is_empty();
        match self {
            Self::Flow(transport) if is_needed => {
                transport.step_timed(fractions, quantities, step, [start, end], stopwatch)
            }
            Self::Flow(_) => Ok(Ledger::new(0)),
            Self::Remesh { remesh, path, at } => {
                let to = path.mesh(end / run_end)?;
                let ledger = match is_needed {
                    true => remesh.step_timed([at, &to], fractions, quantities, step, stopwatch)?,
                    false => Ledger::new(0),
                };
                *at = to;
                Ok(ledger)
            }
        }
    }
}

fn settings<const D: usize>(scene: &Resolved<D>, plan: &Plan) -> Settings<D> {
    Settings {
        ends: scene.boundary.ends,
        inflow: scene.boundary.inflow,
        reconstruction: scene.reconstruction,
        scheme: scene.advection.scheme,
        axes: scene.advection.sweep_axes,
        order: scene.advection.sweep_order,
        overdraft: plan.overdraft,
        wisps: scene.advection.wisps,
    }
}

pub(super) fn setup_error<const D: usize>(scene: &Resolved<D>, error: &SetupError) -> SceneError {
    let (part, help) = match error {
        SetupError::Wall(crossed) => (
            Part::Boundary(crossed.axis),
            format!(
                "make that end of boundary.{} \"outflow\", or change the velocity",
                axis_name(crossed.axis)
            ),
        ),
        SetupError::Fluxes(_) => (Part::Field, "choose other units of length or time".to_owned()),
        SetupError::Dilating { .. } => (
            Part::Scheme,
            "use the scheme sweeps, unsplit or isotropic, or divergence = \"project\" in velocity.field.file"
                .to_owned(),
        ),
        SetupError::Still { .. } => (Part::Scheme, "use the scheme unsplit in the mode flow".to_owned()),
        SetupError::Distorted { .. } => {
            (Part::Scheme, "use the scheme sweeps, or leave out mesh.distortion".to_owned())
        }
    };
    scene.error(part, error.to_string(), help)
}

/// About how many bytes of memory a run of the scene takes.
pub fn memory<const D: usize>(scene: &Resolved<D>) -> u64 {
    let moves = scene.mesh.motion.is_some();
    let distorted = moves || !scene.mesh.distortion.is_none();
    let number = size_of::<f64>() as u64;
    let [dimension, materials] = [D, scene.materials.len()].map(|count| count as u64);
    // Nodes, volumes, potentials on edges, fractions, which are there twice at times, and passing values.
    let mut values = dimension + 1 + (2 * dimension - 3) + 2 * materials + 2;
    if moves {
        // The mesh at the start, now, next and after all sweeps but the last, and what faces sweep.
        values += (3 + dimension) * (dimension + 1) + dimension * dimension;
    }
    if distorted {
        // Lists of defects.
        values += 3;
        let advection = &scene.advection;
        if advection.sweep_axes == SweepAxes::Cartesian || advection.scheme == Scheme::Isotropic {
            values += 2 * dimension;
        }
    }
    values += super::fields::values_per_cell(scene);
    let components = scene.materials.iter().flat_map(|material| &material.quantities);
    let components: u64 = components.map(|quantity| quantity.initial.len() as u64).sum();
    if components > 0 {
        // Values now and before the step, their slopes and middles, what a pass found, and what cells hold of the materials.
        values += components * (3 + dimension + 1) + dimension + 2 * materials;
    }
    // Velocities and fluxes of each file, and what is traced of them.
    values += (2 * scene.field.files() as u64 + 4) * dimension * u64::from(scene.field.files() > 0);
    let mut band = size_of::<u32>() as u64;
    if let Scheme::Unsplit | Scheme::Remap = scene.advection.scheme {
        // Places of mixed cells and of traced nodes; on distorted meshes boxes around blocks of cells.
        band *= 3;
        values += if distorted { 2 } else { 0 };
    }
    cells(scene).saturating_mul(values * number + band)
}

/// About how many bytes of memory the reconstruction of a scene takes.
pub fn still_memory<const D: usize>(scene: &Still<D>) -> u64 {
    let [dimension, materials] = [D, scene.materials.len()].map(|count| count as u64);
    // Nodes, volumes, fractions, which are there twice at times, and lists of defects; then normals, plane constants, areas, status.
    let mut values = dimension + 1 + 2 * materials + if scene.mesh.distortion.is_none() { 0 } else { 3 };
    if scene.output.fields {
        values += (dimension + 3) * materials;
    }
    if scene.reconstruction.normal.reads_centroids() {
        values += dimension * materials;
    }
    cells(scene).saturating_mul(values * size_of::<f64>() as u64)
}

fn cells<const D: usize>(scene: &Still<D>) -> u64 {
    scene.mesh.cells.iter().fold(1_u64, |cells, &count| cells.saturating_mul(count as u64))
}
