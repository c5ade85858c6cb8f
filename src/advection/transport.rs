//! The transport of materials through a mesh that stands still: what stays the same over a run, and one step.

use vofkit_geometry::Cell;

use super::band::Band;
use super::boundary::Boundary;
use super::ledger::Ledger;
use super::motion::{Motion, NodalMotion};
use super::sweeps::{Sweep, Sweeps};
use crate::interface::{Reconstruction, ReconstructionError};
use crate::mesh::Mesh;
use crate::parallel;
use crate::velocity::{FaceFluxes, Velocity};

/// The directions of the sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SweepAxes {
    /// One Cartesian component of the displacement per sweep, over all faces: the paper's.
    #[default]
    Cartesian,
    /// Along mesh lines, over two opposite faces of every cell.
    Logical,
}

/// A step that cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// A cell gives away more than it holds.
    #[error(
        "the time step is too large: cell {cell:?} holds the volume {volume:.6e} and would lose {outflow:.6e} in one sweep"
    )]
    Overdrawn {
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// Its tracked volume.
        volume: f64,
        /// What leaves it in the sweep.
        outflow: f64,
    },
    /// A plane that was not found.
    #[error(transparent)]
    Reconstruction(#[from] ReconstructionError),
}

/// Moves the fractions of materials through a mesh that stands still.
#[derive(Debug)]
pub struct Transport<'a, C, const D: usize> {
    mesh: &'a Mesh<C, D>,
    velocity: Velocity,
    fluxes: FaceFluxes<D>,
    boundary: Boundary<D>,
    reconstruction: Reconstruction,
    /// For Cartesian sweeps on distorted meshes; on undistorted ones they are the same as those along mesh lines.
    nodes: Option<NodalMotion<D>>,
    overdraft: bool,
    band: Band,
    sweeps: Sweeps<D>,
}

impl<'a, C: Cell<D>, const D: usize> Transport<'a, C, D> {
    /// Prepares the transport through `mesh` by `velocity`, whose face fluxes are given.
    pub fn new(
        mesh: &'a Mesh<C, D>,
        velocity: Velocity,
        fluxes: FaceFluxes<D>,
        boundary: Boundary<D>,
        reconstruction: Reconstruction,
        axes: SweepAxes,
    ) -> Self {
        let cartesian = axes == SweepAxes::Cartesian && !mesh.is_undistorted();
        Self {
            mesh,
            velocity,
            fluxes,
            boundary,
            reconstruction,
            nodes: cartesian.then(|| NodalMotion::new(mesh, &velocity.field)),
            overdraft: false,
            band: Band::new(mesh.grid().len()),
            sweeps: Sweeps::default(),
        }
    }

    /// Goes on where a cell would give away more than it holds, instead of returning [`StepError::Overdrawn`]; what cannot be given
    /// shows up in the ledger.
    pub fn allow_overdraft(&mut self) {
        self.overdraft = true;
    }

    /// The Courant number of a step per unit of time: the largest face flux over the volume of its donor, at full amplitude.
    pub fn courant_rate(&self) -> f64 {
        let unit = self.fluxes.step(1.0);
        let rates = parallel::map(self.mesh.grid().len(), |index| {
            let offset = self.mesh.grid().offset(index);
            let outward = |face: usize| {
                let flux = unit.through(offset, face / 2, face % 2);
                if face % 2 == 1 { flux } else { -flux }
            };
            (0..C::FACES).map(outward).fold(0.0, f64::max) / self.mesh.volumes()[index]
        });
        rates.into_iter().fold(0.0, f64::max)
    }

    /// The largest sum of the fluxes out of a cell in a step of this duration, relative to its volume, without sign.
    pub fn largest_divergence(&self, duration: f64) -> f64 {
        let fluxes = self.fluxes.step(duration);
        let sums = parallel::map(self.mesh.grid().len(), |index| {
            let offset = self.mesh.grid().offset(index);
            let net: f64 =
                (0..D).map(|axis| fluxes.through(offset, axis, 1) - fluxes.through(offset, axis, 0)).sum();
            net.abs() / self.mesh.volumes()[index]
        });
        sums.into_iter().fold(0.0, f64::max)
    }

    /// What happens at the ends of the axes.
    pub fn boundary(&self) -> &Boundary<D> {
        &self.boundary
    }

    /// Advances `fractions[material][cell]` from `start` to `end`. The order of the sweeps alternates with `step`.
    ///
    /// # Errors
    /// A time step that is too large, or a plane that was not found; the fractions are then as before.
    pub fn step(
        &mut self,
        fractions: &mut [Vec<f64>],
        step: usize,
        start: f64,
        end: f64,
    ) -> Result<Ledger, StepError> {
        let mut ledger = Ledger::new(fractions.len());
        let duration = self.velocity.duration(start, end);
        if duration == 0.0 || fractions.is_empty() {
            return Ok(ledger);
        }
        // Along mesh lines a cell's content moves by one cell per axis; with Cartesian sweeps, each over all faces, by D.
        let radius = if self.nodes.is_some() { D } else { 1 };
        self.band.collect(self.mesh, fractions, &self.boundary, radius);
        let motion = Motion {
            mesh: self.mesh,
            boundary: &self.boundary,
            fluxes: self.fluxes.step(duration),
            order: sweep_order(step),
            nodes: self.nodes.as_ref(),
        };
        self.sweeps.begin(&motion, &self.band, fractions);
        for axis in motion.order {
            let sweep = Sweep {
                motion: &motion,
                axis,
                reconstruction: self.reconstruction,
                overdraft: self.overdraft,
            };
            if let Err(error) = self.sweeps.advance(&sweep, fractions, &mut ledger) {
                self.sweeps.restore(fractions);
                return Err(error);
            }
        }
        Ok(ledger)
    }
}

/// The axes in the order of a step's sweeps: all orders in turn, each followed by its reverse.
fn sweep_order<const D: usize>(step: usize) -> [usize; D] {
    let shift = step / 2 % D;
    std::array::from_fn(|i| {
        let i = if step.is_multiple_of(2) { i } else { D - 1 - i };
        if D == 2 { i } else { (i + shift) % D }
    })
}
