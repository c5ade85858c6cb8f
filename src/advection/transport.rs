//! The transport of materials through a mesh that stands still: what stays the same over a run, and one step.

use std::fmt;

use vofkit_geometry::Cell;

use super::band::Band;
use super::boundary::{Boundary, End, WallCrossed};
use super::ledger::Ledger;
use super::motion::{Motion, NodalMotion};
use super::sweeps::{Sweep, Sweeps};
use super::unsplit::{Step, Unsplit};
use crate::interface::{Reconstruction, ReconstructionError, check_fractions};
use crate::mesh::Mesh;
use crate::velocity::{FaceFluxes, FluxRange, Velocity};

/// How materials are advected.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// One direction after the other (Algorithm 5.1 of the paper).
    #[default]
    Sweeps,
    /// All directions at once: each cell gets what its pre-image holds, cut by every cell that it meets and by the planes in them.
    Unsplit,
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Sweeps => "sweeps",
            Self::Unsplit => "unsplit",
        })
    }
}

/// The directions of the sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SweepAxes {
    /// Along mesh lines, over two opposite faces of every cell: conservative and bounded to rounding on any mesh.
    #[default]
    Logical,
    /// One Cartesian component of the displacement per sweep, over all faces: the paper's. On an undistorted mesh a component
    /// crosses the faces of one direction alone, and this is [`SweepAxes::Logical`].
    Cartesian,
}

/// How materials are transported.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<const D: usize> {
    /// What the ends `[lower, upper]` of each axis are; where not given, a wall if nothing crosses it, else open.
    pub ends: [[Option<End>; 2]; D],
    /// The material that flows in through open ends; none for void.
    pub inflow: Option<usize>,
    /// How the interface is reconstructed.
    pub reconstruction: Reconstruction,
    /// How materials are advected.
    pub scheme: Scheme,
    /// The directions of the sweeps.
    pub axes: SweepAxes,
    /// Whether to go on where a cell would give away more than it holds, instead of returning
    /// [`StepError::Overdrawn`]; what cannot be given shows up in the ledger.
    pub overdraft: bool,
}

impl<const D: usize> Default for Settings<D> {
    fn default() -> Self {
        Self {
            ends: [[None; 2]; D],
            inflow: None,
            reconstruction: Reconstruction::default(),
            scheme: Scheme::default(),
            axes: SweepAxes::default(),
            overdraft: false,
        }
    }
}

/// A transport that cannot be set up.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// A wall that the velocity crosses.
    #[error(transparent)]
    Wall(#[from] WallCrossed),
    /// A velocity out of range.
    #[error(transparent)]
    Fluxes(#[from] FluxRange),
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
    /// The pre-image of a cell folds over.
    #[error(
        "the time step is too large: the pre-image of cell {cell:?} folds over, and would fill {fraction} of the cell"
    )]
    Folded {
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// The fraction of a material that would be in it; not a number where the pre-image folds too often to be cut.
        fraction: f64,
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
    /// For Cartesian sweeps on distorted meshes; on undistorted ones the sweeps run along mesh lines.
    nodes: Option<NodalMotion<D>>,
    overdraft: bool,
    band: Band,
    sweeps: Sweeps<D>,
    /// For the unsplit scheme.
    unsplit: Option<Unsplit<D>>,
}

impl<'a, C: Cell<D>, const D: usize> Transport<'a, C, D> {
    /// Prepares the transport through `mesh` by `velocity`.
    ///
    /// # Errors
    /// A velocity out of range, or a wall that was asked for, but is crossed by the velocity.
    pub fn new(mesh: &'a Mesh<C, D>, velocity: Velocity, settings: Settings<D>) -> Result<Self, SetupError> {
        Ok(Self::with_fluxes(mesh, velocity, FaceFluxes::new(mesh, &velocity.field)?, settings)?)
    }

    /// The same with the face fluxes of `velocity.field` at hand.
    ///
    /// # Errors
    /// A wall that was asked for, but is crossed by the velocity.
    pub fn with_fluxes(
        mesh: &'a Mesh<C, D>,
        velocity: Velocity,
        fluxes: FaceFluxes<D>,
        settings: Settings<D>,
    ) -> Result<Self, WallCrossed> {
        let boundary = Boundary::resolve(mesh, &fluxes, settings.ends, settings.inflow)?;
        let cartesian = settings.axes == SweepAxes::Cartesian && !mesh.is_undistorted();
        Ok(Self {
            mesh,
            velocity,
            fluxes,
            boundary,
            reconstruction: settings.reconstruction,
            nodes: cartesian.then(|| NodalMotion::new(mesh, &velocity.field)),
            overdraft: settings.overdraft,
            band: Band::new(mesh.grid().len()),
            sweeps: Sweeps::default(),
            unsplit: (settings.scheme == Scheme::Unsplit).then(|| Unsplit::new(mesh, &velocity.field)),
        })
    }

    /// The fluxes through the faces.
    pub fn fluxes(&self) -> &FaceFluxes<D> {
        &self.fluxes
    }

    /// The Courant number of a step per unit of time: see [`FaceFluxes::courant_rate`].
    pub fn courant_rate(&self) -> f64 {
        self.fluxes.courant_rate(self.mesh)
    }

    /// What happens at the ends of the axes.
    pub fn boundary(&self) -> &Boundary<D> {
        &self.boundary
    }

    /// Advances `fractions[material][cell]` from `start` to `end`. The order of the sweeps alternates with `step`.
    ///
    /// # Errors
    /// A time step that is too large, a fraction that is not in `[0, 1]`, or a plane that was not found; the fractions are then
    /// as before.
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
        for fractions in fractions.iter() {
            check_fractions(self.mesh.grid(), fractions)?;
        }
        if let Some(unsplit) = &mut self.unsplit {
            self.band.collect(self.mesh, fractions, &self.boundary, unsplit.radius(duration));
            let step = Step {
                mesh: self.mesh,
                boundary: &self.boundary,
                fluxes: self.fluxes.step(duration),
                field: &self.velocity.field,
                band: &self.band,
                reconstruction: self.reconstruction,
                overdraft: self.overdraft,
            };
            unsplit.advance(&step, fractions, &mut ledger)?;
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
pub(crate) fn sweep_order<const D: usize>(step: usize) -> [usize; D] {
    let shift = step / 2 % D;
    std::array::from_fn(|i| {
        let i = if step.is_multiple_of(2) { i } else { D - 1 - i };
        if D == 2 { i } else { (i + shift) % D }
    })
}
