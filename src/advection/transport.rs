//! The transport of materials through a mesh that stands still: what stays the same over a run, and one step.

use vofkit_geometry::Cell;

use super::band::Band;
use super::boundary::{Boundary, WallCrossed};
use super::carry::{Cargo, carried};
use super::ledger::Ledger;
use super::preimage::displacement;
use super::schedule::{Share, Turn, turns};
use super::settings::{Scheme, Settings};
use super::stage::{NodalMotion, Outward, Regions, Stage, components, outward_volumes};
use super::sweeps::{Holding, Rules, Sweeps};
use super::unsplit::{Step, Unsplit, radius, reach};
use super::wisps;
use crate::interface::{ReconstructionError, check_fractions};
use crate::mesh::{Mesh, MotionError};
use crate::quantity::{self, MaterialQuantity, QuantityError};
use crate::space::{planar, spatial};
use crate::stopwatch::Stopwatch;
use crate::velocity::{FaceFluxes, FluxRange, Velocity};

/// A transport that cannot be set up.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// A wall that the velocity crosses.
    #[error(transparent)]
    Wall(#[from] WallCrossed),
    /// A velocity out of range.
    #[error(transparent)]
    Fluxes(#[from] FluxRange),
    /// A scheme for meshes that move.
    #[error("the scheme {scheme} is for meshes that move under materials at rest")]
    Still {
        /// The scheme.
        scheme: Scheme,
    },
    /// A scheme that needs boxes of one size.
    #[error("the scheme {} needs an undistorted mesh", scheme)]
    Distorted {
        /// The scheme.
        scheme: Scheme,
    },
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
    /// The pre-image of a cell reaches so far that its volume has lost its digits.
    #[error(
        "the time step is too large: the pre-image of cell {cell:?}, whose volume is {volume:.6e}, reaches so far that \
         {found:.6e} is found for it"
    )]
    Scattered {
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// The volume that the pre-image has by the fluxes: that of the cell.
        volume: f64,
        /// The volume by its corners.
        found: f64,
    },
    /// Open ends through which a material flows in that is not there.
    #[error("material {material} is to flow in through open ends, and there are {materials}")]
    Inflow {
        /// The material.
        material: usize,
        /// The number of materials.
        materials: usize,
    },
    /// A plane that was not found.
    #[error(transparent)]
    Reconstruction(#[from] ReconstructionError),
    /// An end of a moving mesh that was said to be a wall, but moves.
    #[error("an end of the mesh that is said to be a wall moves: {0}")]
    MovingWall(#[from] WallCrossed),
    /// A mesh that cannot be moved to.
    #[error(transparent)]
    Mesh(#[from] MotionError),
    /// A quantity that cannot be carried.
    #[error(transparent)]
    Quantity(#[from] QuantityError),
}

impl StepError {
    /// Whether shorter steps may go where this one could not.
    pub fn is_too_large(&self) -> bool {
        matches!(self, Self::Overdrawn { .. } | Self::Folded { .. } | Self::Scattered { .. })
    }
}

/// Moves the fractions of materials through a mesh that stands still.
#[derive(Debug)]
pub struct Transport<'a, C, const D: usize> {
    mesh: &'a Mesh<C, D>,
    velocity: Velocity,
    fluxes: FaceFluxes<D>,
    boundary: Boundary<D>,
    settings: Settings<D>,
    /// For regions that are traced back.
    nodes: Option<NodalMotion<D>>,
    band: Band<D>,
    sweeps: Sweeps<D>,
    /// For the unsplit scheme.
    unsplit: Option<Unsplit<D>>,
    /// Whether nothing crosses any face at any time.
    rests: bool,
    /// For the unsplit scheme: cells per time that the fastest node moves along an axis of a cell, at full amplitude.
    reach: f64,
}

impl<'a, C: Cell<D>, const D: usize> Transport<'a, C, D> {
    /// Prepares the transport through `mesh` by `velocity`.
    ///
    /// # Errors
    /// A velocity out of range, a wall that was asked for, but is crossed by the velocity, or a scheme that cannot deal with
    /// the mesh.
    pub fn new(mesh: &'a Mesh<C, D>, velocity: Velocity, settings: Settings<D>) -> Result<Self, SetupError> {
        Self::with_fluxes(mesh, velocity, FaceFluxes::new(mesh, &velocity.field)?, settings)
    }

    /// The same with the face fluxes of `velocity.field` at hand.
    ///
    /// # Errors
    /// A wall that was asked for, but is crossed by the velocity, or a scheme that cannot deal with the mesh.
    pub fn with_fluxes(
        mesh: &'a Mesh<C, D>,
        velocity: Velocity,
        fluxes: FaceFluxes<D>,
        settings: Settings<D>,
    ) -> Result<Self, SetupError> {
        if settings.scheme == Scheme::WeymouthYue && !mesh.is_undistorted() {
            return Err(SetupError::Distorted { scheme: settings.scheme });
        }
        if settings.scheme == Scheme::Remap {
            return Err(SetupError::Still { scheme: settings.scheme });
        }
        let boundary = Boundary::resolve(mesh, &fluxes, settings.ends, settings.inflow)?;
        let rests = fluxes.courant_rate(mesh) == 0.0;
        let traced = settings.scheme == Scheme::Isotropic || settings.splits_displacement(mesh);
        let is_unsplit = settings.scheme == Scheme::Unsplit;
        let at_node = |node: usize| planar(&velocity.field.velocity(&spatial(&mesh.nodes()[node])));
        Ok(Self {
            mesh,
            velocity,
            fluxes,
            boundary,
            settings,
            nodes: traced.then(|| NodalMotion::new(mesh, &velocity.field)),
            band: Band::new(),
            sweeps: Sweeps::default(),
            unsplit: is_unsplit.then(|| Unsplit::new(mesh)),
            reach: if is_unsplit { reach(mesh, at_node) } else { 0.0 },
            rests,
        })
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<C, D> {
        self.mesh
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
        self.step_carrying(fractions, &mut [], step, start, end)
    }

    /// The same with quantities of the materials.
    ///
    /// # Errors
    /// Those of [`Transport::step`], and quantities that cannot be carried; they are then as before, too.
    pub fn step_carrying(
        &mut self,
        fractions: &mut [Vec<f64>],
        quantities: &mut [MaterialQuantity],
        step: usize,
        start: f64,
        end: f64,
    ) -> Result<Ledger, StepError> {
        self.step_timed(fractions, quantities, step, [start, end], &mut Stopwatch::default())
    }

    /// The same with its phases timed.
    ///
    /// # Errors
    /// Those of [`Transport::step_carrying`].
    pub fn step_timed(
        &mut self,
        fractions: &mut [Vec<f64>],
        quantities: &mut [MaterialQuantity],
        step: usize,
        times: [f64; 2],
        stopwatch: &mut Stopwatch,
    ) -> Result<Ledger, StepError> {
        let mut cargo = Cargo { fractions, quantities };
        let mut ledger = self.go(&mut cargo, step, times, stopwatch)?;
        if let Some(below) = self.settings.wisps {
            wisps::remove(self.mesh, &mut cargo, below, &mut ledger);
        }
        stopwatch.lap(|seconds| &mut seconds.update);
        Ok(ledger)
    }

    fn go(
        &mut self,
        Cargo { fractions, quantities }: &mut Cargo<'_>,
        step: usize,
        [start, end]: [f64; 2],
        stopwatch: &mut Stopwatch,
    ) -> Result<Ledger, StepError> {
        self.boundary.check_inflow(fractions.len())?;
        let duration = self.velocity.duration(start, end);
        if duration == 0.0 || fractions.is_empty() {
            return Ok(Ledger::new(fractions.len()));
        }
        for fractions in fractions.iter() {
            check_fractions(self.mesh.grid(), fractions)?;
        }
        quantity::check(self.mesh.grid(), fractions, quantities, self.boundary.inflow)?;
        if self.rests {
            return Ok(Ledger::new(fractions.len()));
        }
        let carried = carried(quantities, fractions.len());
        let fluxes = self.fluxes.step(duration);
        if let Some(unsplit) = &mut self.unsplit {
            let mut ledger = Ledger::new(fractions.len());
            let around = [radius(self.reach * duration); D];
            self.band.collect(self.mesh.grid(), fractions, &carried, &self.boundary, around);
            let field = &self.velocity.field;
            let step = Step {
                mesh: self.mesh,
                volumes: self.mesh.volumes(),
                boundary: &self.boundary,
                displacement: &|node| displacement(field, &self.mesh.nodes()[node], duration),
                through: Some(&|offset, axis, side| fluxes.through(offset, axis, side)),
                band: &self.band,
                reconstruction: self.settings.reconstruction,
                overdraft: self.settings.overdraft,
            };
            unsplit.advance(&step, &mut Cargo { fractions, quantities }, &mut ledger, stopwatch)?;
            return Ok(ledger);
        }
        let turns = turns::<D>(self.settings.order, step);
        let stages = stages(self.mesh, self.nodes.as_ref(), self.settings.scheme, &turns, duration);
        let splits = self.settings.splits_displacement(self.mesh);
        let rules = Rules {
            grid: self.mesh.grid(),
            boundary: &self.boundary,
            volumes: self.mesh.volumes(),
            quanta: fluxes.quanta(),
            reconstruction: self.settings.reconstruction,
            overdraft: self.settings.overdraft,
            carried: &carried,
            holding: match self.settings.scheme {
                Scheme::Sweeps | Scheme::Unsplit | Scheme::Remap => Holding::Tracked,
                Scheme::Isotropic => Holding::AtOnce,
                Scheme::WeymouthYue => Holding::Fixed,
            },
            components: if splits { D } else { 1 },
        };
        let grid = self.mesh.grid();
        let outward = |offset: [usize; D], outward: &mut [Outward]| match &self.nodes {
            Some(nodes) if splits => {
                let axes = std::array::from_fn(|i| turns[i].axis);
                let parts: [[f64; D]; 6] = std::array::from_fn(|face| {
                    if face < C::FACES {
                        components(self.mesh, nodes, &fluxes, axes, offset, face)
                    } else {
                        [0.0; D]
                    }
                });
                for (k, outward) in outward.iter_mut().enumerate() {
                    *outward = outward_volumes::<C, D>(grid, &self.boundary, offset, |face| parts[face][k]);
                }
            }
            _ => {
                let through = fluxes.of_cell(offset);
                outward[0] = outward_volumes::<C, D>(grid, &self.boundary, offset, |face| through[face]);
            }
        };
        let cargo = &mut Cargo { fractions, quantities };
        self.sweeps.run(&rules, &stages, &mut self.band, cargo, stopwatch, outward)
    }
}

/// The sweeps of a step that lasts `duration`; `nodes` are there for regions that are traced back.
fn stages<'a, C: Cell<D>, const D: usize>(
    mesh: &'a Mesh<C, D>,
    nodes: Option<&'a NodalMotion<D>>,
    scheme: Scheme,
    turns: &[Turn],
    duration: f64,
) -> Vec<Stage<'a, C, D>> {
    let traced = |nodes, duration, axis| Regions::Traced { nodes, duration, axis };
    match nodes {
        None => turns.iter().map(|turn| Stage::along_mesh_lines(mesh, turn)).collect(),
        Some(nodes) if scheme == Scheme::Isotropic => {
            vec![Stage::over_all_faces(mesh, 0, Share::Whole, traced(nodes, duration, None))]
        }
        Some(nodes) => {
            let along = |&Turn { axis, share }: &Turn| {
                let duration = if share == Share::Whole { duration } else { 0.5 * duration };
                Stage::over_all_faces(mesh, axis, share, traced(nodes, duration, Some(axis)))
            };
            turns.iter().map(along).collect()
        }
    }
}
