//! Materials that rest while the mesh moves: their fractions from one place of the mesh to the next.
//!
//! What crosses a face is minus the volume that it sweeps, exactly, so that the tracked volume of a cell ends as that of the new
//! cell. Along *logical* axes the sweeps are those of a flow through the old mesh: two opposite faces each, and slabs of
//! the old cell. Along *Cartesian* axes (the paper's) the nodes move by one component after the other; each sweep starts from the mesh
//! that the last one left, and its swept regions are exact. *Unsplit* and by *remapping*, new cells are cut by the old ones that
//! they meet and by the planes in them.

use vofkit_geometry::Cell;

use super::band::Band;
use super::boundary::Boundary;
use super::carry::{Cargo, carried};
use super::ledger::Ledger;
use super::schedule::{Share, Turn, turns};
use super::settings::{Scheme, Settings, SweepAxes};
use super::stage::{Regions, Stage, outward_volumes};
use super::sweeps::{Holding, Rules, Sweeps};
use super::transport::{SetupError, StepError};
use super::unsplit::{Step, Unsplit, radius, reach};
use super::wisps;
use crate::interface::check_fractions;
use crate::mesh::{Mesh, SweptVolumes};
use crate::quanta::Quanta;
use crate::quantity::{self, MaterialQuantity};
use crate::stopwatch::Stopwatch;
use crate::tolerance::END_SLIDING;

/// Moves the fractions of materials that rest from one place of a mesh to the next.
#[derive(Debug)]
pub struct Remesh<const D: usize> {
    settings: Settings<D>,
    band: Band<D>,
    sweeps: Sweeps<D>,
}

impl<const D: usize> Remesh<D> {
    /// Prepares the transport.
    ///
    /// # Errors
    /// A scheme that needs a mesh which stays undistorted.
    pub fn new(settings: Settings<D>) -> Result<Self, SetupError> {
        if settings.scheme == Scheme::WeymouthYue {
            return Err(SetupError::Distorted { scheme: settings.scheme });
        }
        Ok(Self { settings, band: Band::new(), sweeps: Sweeps::default() })
    }

    /// Takes `fractions[material][cell]` on the mesh `from` to the mesh `to`. The order of the sweeps alternates with `step`.
    ///
    /// # Errors
    /// Meshes of other cells, a move that is too large, an end that should be a wall but moves, a fraction that is not in
    /// `[0, 1]`, or a plane that was not found; the fractions are then as before.
    pub fn step<C: Cell<D>>(
        &mut self,
        from: &Mesh<C, D>,
        to: &Mesh<C, D>,
        fractions: &mut [Vec<f64>],
        step: usize,
    ) -> Result<Ledger, StepError> {
        self.step_carrying(from, to, fractions, &mut [], step)
    }

    /// The same with quantities of the materials.
    ///
    /// # Errors
    /// Those of [`Remesh::step`], and quantities that cannot be carried; they are then as before, too.
    pub fn step_carrying<C: Cell<D>>(
        &mut self,
        from: &Mesh<C, D>,
        to: &Mesh<C, D>,
        fractions: &mut [Vec<f64>],
        quantities: &mut [MaterialQuantity],
        step: usize,
    ) -> Result<Ledger, StepError> {
        self.step_timed([from, to], fractions, quantities, step, &mut Stopwatch::default())
    }

    /// The same with its phases timed.
    ///
    /// # Errors
    /// Those of [`Remesh::step_carrying`].
    pub fn step_timed<C: Cell<D>>(
        &mut self,
        [from, to]: [&Mesh<C, D>; 2],
        fractions: &mut [Vec<f64>],
        quantities: &mut [MaterialQuantity],
        step: usize,
        stopwatch: &mut Stopwatch,
    ) -> Result<Ledger, StepError> {
        for fractions in fractions.iter() {
            check_fractions(from.grid(), fractions)?;
        }
        quantity::check(from.grid(), fractions, quantities, self.settings.inflow)?;
        let mut cargo = Cargo { fractions, quantities };
        let mut ledger = match self.settings.scheme {
            Scheme::Unsplit | Scheme::Remap => self.at_once(from, to, &mut cargo, stopwatch),
            _ => self.in_sweeps([from, to], &mut cargo, step, stopwatch),
        }?;
        if let Some(below) = self.settings.wisps {
            wisps::remove(to, &mut cargo, below, &mut ledger);
        }
        stopwatch.lap(|seconds| &mut seconds.update);
        Ok(ledger)
    }

    /// New cells cut by old ones.
    fn at_once<C: Cell<D>>(
        &mut self,
        from: &Mesh<C, D>,
        to: &Mesh<C, D>,
        cargo: &mut Cargo<'_>,
        stopwatch: &mut Stopwatch,
    ) -> Result<Ledger, StepError> {
        let boundary = self.boundary_of(from, &[SweptVolumes::new(from, to)?])?;
        boundary.check_inflow(cargo.fractions.len())?;
        let mut ledger = Ledger::new(cargo.fractions.len());
        if cargo.fractions.is_empty() {
            return Ok(ledger);
        }
        let displacement = |node: usize| from.nodes()[node] - to.nodes()[node];
        match self.settings.scheme {
            // However far the nodes moved.
            Scheme::Remap => self.band.collect_all(from.grid()),
            _ => {
                let around = [radius(reach(from, displacement)); D];
                let carried = carried(cargo.quantities, cargo.fractions.len());
                self.band.collect(from.grid(), cargo.fractions, &carried, &boundary, around);
            }
        }
        let step = Step {
            mesh: from,
            volumes: to.volumes(),
            boundary: &boundary,
            displacement: &displacement,
            through: None,
            band: &self.band,
            reconstruction: self.settings.reconstruction,
            overdraft: self.settings.overdraft,
        };
        Unsplit::new(from).advance(&step, cargo, &mut ledger, stopwatch)?;
        Ok(ledger)
    }

    fn in_sweeps<C: Cell<D>>(
        &mut self,
        [from, to]: [&Mesh<C, D>; 2],
        cargo: &mut Cargo<'_>,
        step: usize,
        stopwatch: &mut Stopwatch,
    ) -> Result<Ledger, StepError> {
        let turns = turns::<D>(self.settings.order, step);
        let at_once = self.settings.scheme == Scheme::Isotropic;
        let in_legs = !at_once && self.settings.axes == SweepAxes::Cartesian;
        let between = if in_legs { between(from, to, &turns) } else { Vec::new() };
        let places: Vec<&Mesh<C, D>> = [from].into_iter().chain(&between).chain([to]).collect();
        let legs = places
            .windows(2)
            .map(|ends| SweptVolumes::new(ends[0], ends[1]))
            .collect::<Result<Vec<_>, _>>()?;
        let boundary = self.boundary_of(from, &legs)?;
        boundary.check_inflow(cargo.fractions.len())?;
        // What is a multiple of a coarser power of two is one of all finer ones.
        let quanta = legs.iter().map(SweptVolumes::quanta).reduce(Quanta::coarser).expect("there is a leg");
        let rules = Rules {
            grid: from.grid(),
            boundary: &boundary,
            volumes: from.volumes(),
            quanta,
            reconstruction: self.settings.reconstruction,
            overdraft: self.settings.overdraft,
            carried: &carried(cargo.quantities, cargo.fractions.len()),
            holding: if at_once { Holding::AtOnce } else { Holding::Tracked },
            components: legs.len(),
        };
        let stages: Vec<Stage<'_, C, D>> = if at_once || in_legs {
            let mut stages = Vec::with_capacity(legs.len());
            for (component, ends) in places.windows(2).enumerate() {
                let regions = Regions::Swept { to: ends[1] };
                stages.push(Stage::over_all_faces(ends[0], component, Share::Whole, regions));
            }
            stages
        } else {
            turns.iter().map(|turn| Stage::along_mesh_lines(from, turn)).collect()
        };
        self.sweeps.run(&rules, &stages, &mut self.band, cargo, stopwatch, |offset, outward| {
            for (outward, leg) in outward.iter_mut().zip(&legs) {
                let through = |face: usize| quanta.round(leg.through(offset, face / 2, face % 2));
                *outward = outward_volumes::<C, D>(from.grid(), &boundary, offset, through);
            }
        })
    }

    /// What the ends of the axes are in a step from one place to the other.
    ///
    /// # Errors
    /// Meshes of other cells, or an end that should be a wall but moves.
    pub fn boundary<C: Cell<D>>(&self, from: &Mesh<C, D>, to: &Mesh<C, D>) -> Result<Boundary<D>, StepError> {
        self.boundary_of(from, &[SweptVolumes::new(from, to)?])
    }

    fn boundary_of<C: Cell<D>>(
        &self,
        from: &Mesh<C, D>,
        legs: &[SweptVolumes<D>],
    ) -> Result<Boundary<D>, StepError> {
        let crossing = |offset: [usize; D], axis: usize, side: usize| {
            let swept = legs.iter().map(|leg| leg.through(offset, axis, side).abs()).fold(0.0, f64::max);
            let volume = from.volumes()[from.grid().index(offset)];
            if swept > END_SLIDING * volume { swept } else { 0.0 }
        };
        Boundary::where_crossed(from, self.settings.ends, self.settings.inflow, crossing)
            .map_err(StepError::MovingWall)
    }
}

/// The meshes after all sweeps but the last, each of which moves the nodes by one Cartesian component of their way.
fn between<C: Cell<D>, const D: usize>(
    from: &Mesh<C, D>,
    to: &Mesh<C, D>,
    turns: &[Turn],
) -> Vec<Mesh<C, D>> {
    let mut nodes = from.nodes().to_vec();
    let after = |turn: &Turn| {
        for (x, (old, new)) in nodes.iter_mut().zip(from.nodes().iter().zip(to.nodes())) {
            let k = turn.axis;
            x[k] = if turn.share == Share::FirstHalf { 0.5 * (old[k] + new[k]) } else { new[k] };
        }
        from.on_the_way(nodes.clone())
    };
    turns[..turns.len() - 1].iter().map(after).collect()
}
