//! The transport of materials through a mesh that stands still: what stays the same over a run, and one step.

use std::borrow::Cow;

use vofkit_geometry::Cell;

use super::band::Band;
use super::boundary::{Boundary, WallCrossed};
use super::carry::{Cargo, carried};
use super::dilation;
use super::ledger::Ledger;
use super::schedule::{Share, Turn, turns};
use super::settings::{Scheme, Settings};
use super::stage::{Outward, Regions, Stage, components, outward_volumes};
use super::sweeps::{Holding, Rules, Sweeps};
use super::tracing::{Traced, Tracing};
use super::unsplit::{Step, Unsplit};
use super::wisps;
use crate::interface::{ReconstructionError, check_fractions};
use crate::mesh::{Mesh, MotionError};
use crate::quantity::{self, MaterialQuantity, QuantityError};
use crate::stopwatch::Stopwatch;
use crate::velocity::{Flow, FluxRange, Velocity};

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
    /// A scheme in which cells keep their volume within a step.
    #[error("the scheme {scheme} needs fluxes that cancel in every cell, and these dilate what is in it")]
    Dilating {
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
    flow: Flow<D>,
    boundary: Boundary<D>,
    settings: Settings<D>,
    tracing: Tracing<D>,
    band: Band<D>,
    sweeps: Sweeps<D>,
    /// For the unsplit scheme.
    unsplit: Option<Unsplit<D>>,
    /// Whether nothing crosses any face at any time.
    rests: bool,
}

impl<'a, C: Cell<D>, const D: usize> Transport<'a, C, D> {
    /// Prepares the transport through `mesh` by `velocity`.
    ///
    /// # Errors
    /// A velocity out of range, a wall that was asked for, but is crossed by the velocity, or a scheme that cannot deal with
    /// the mesh.
    pub fn new(mesh: &'a Mesh<C, D>, velocity: Velocity, settings: Settings<D>) -> Result<Self, SetupError> {
        Self::with_flow(mesh, Flow::new(mesh, velocity)?, settings)
    }

    /// The same by any flow on the mesh.
    ///
    /// # Errors
    /// A wall that was asked for, but is crossed by the velocity, or a scheme that cannot deal with the mesh or the flow.
    pub fn with_flow(mesh: &'a Mesh<C, D>, flow: Flow<D>, settings: Settings<D>) -> Result<Self, SetupError> {
        if settings.scheme == Scheme::WeymouthYue && !mesh.is_undistorted() {
            return Err(SetupError::Distorted { scheme: settings.scheme });
        }
        if settings.scheme == Scheme::Remap {
            return Err(SetupError::Still { scheme: settings.scheme });
        }
        if settings.scheme == Scheme::WeymouthYue && flow.dilates() {
            return Err(SetupError::Dilating { scheme: settings.scheme });
        }
        let boundary = Boundary::resolve(mesh, &flow, settings.ends, settings.inflow)?;
        let rests = flow.courant_rate(mesh) == 0.0;
        let is_unsplit = settings.scheme == Scheme::Unsplit;
        Ok(Self {
            mesh,
            boundary,
            settings,
            tracing: Tracing::new(mesh, &flow, &settings),
            flow,
            band: Band::new(),
            sweeps: Sweeps::default(),
            unsplit: is_unsplit.then(|| Unsplit::new(mesh)),
            rests,
        })
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a Mesh<C, D> {
        self.mesh
    }

    /// What moves the materials.
    pub fn flow(&self) -> &Flow<D> {
        &self.flow
    }

    /// The Courant number of a step per unit of time: see [`Flow::courant_rate`].
    pub fn courant_rate(&self) -> f64 {
        self.flow.courant_rate(self.mesh)
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
        if self.flow.dilates() {
            let [start, end] = times;
            dilation::enter(self.mesh, &self.flow.step(start, end).fluxes(), cargo.fractions, &mut ledger);
        }
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
        let flow = self.flow.step(start, end);
        if flow.is_nothing() || fractions.is_empty() {
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
        let fluxes = flow.fluxes();
        let traced = self.tracing.of_step(self.mesh, &flow);
        if let Some(unsplit) = &mut self.unsplit {
            let mut ledger = Ledger::new(fractions.len());
            let around = [self.tracing.radius(self.mesh, &flow, traced.as_ref()); D];
            self.band.collect(self.mesh.grid(), fractions, &carried, &self.boundary, around);
            let mesh = self.mesh;
            let displacement = |node: usize| match &traced {
                Some(traced) => traced.displacement(node),
                None => flow.displacement(&mesh.nodes()[node]),
            };
            let volumes = match self.flow.dilates() {
                true => Cow::Owned(dilation::volumes(mesh, &fluxes)?),
                false => Cow::Borrowed(mesh.volumes()),
            };
            let step = Step {
                mesh,
                volumes: &volumes,
                boundary: &self.boundary,
                displacement: &displacement,
                through: Some(&|offset, axis, side| fluxes.through(offset, axis, side)),
                band: &self.band,
                reconstruction: self.settings.reconstruction,
                overdraft: self.settings.overdraft,
            };
            unsplit.advance(&step, &mut Cargo { fractions, quantities }, &mut ledger, stopwatch)?;
            return Ok(ledger);
        }
        let turns = turns::<D>(self.settings.order, step);
        let stages = stages(self.mesh, traced.as_ref(), self.settings.scheme, &turns);
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
        let outward = |offset: [usize; D], outward: &mut [Outward]| match &traced {
            Some(traced) if splits => {
                let axes = std::array::from_fn(|i| turns[i].axis);
                let parts: [[f64; D]; 6] = std::array::from_fn(|face| {
                    if face < C::FACES {
                        components(self.mesh, traced, &fluxes, axes, offset, face)
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

/// The sweeps of a step; `traced` is there for regions that are traced back.
fn stages<'a, C: Cell<D>, const D: usize>(
    mesh: &'a Mesh<C, D>,
    traced: Option<&'a Traced<'_, D>>,
    scheme: Scheme,
    turns: &[Turn],
) -> Vec<Stage<'a, C, D>> {
    let regions = |traced: &'a Traced<'_, D>, part: f64, axis| Regions::Traced {
        nodes: &traced.nodes,
        duration: traced.duration * part,
        axis,
    };
    match traced {
        None => turns.iter().map(|turn| Stage::along_mesh_lines(mesh, turn)).collect(),
        Some(traced) if scheme == Scheme::Isotropic => {
            vec![Stage::over_all_faces(mesh, 0, Share::Whole, regions(traced, 1.0, None))]
        }
        Some(traced) => {
            let along = |&Turn { axis, share }: &Turn| {
                let part = if share == Share::Whole { 1.0 } else { 0.5 };
                Stage::over_all_faces(mesh, axis, share, regions(traced, part, Some(axis)))
            };
            turns.iter().map(along).collect()
        }
    }
}
