//! What moves materials through a mesh that stands still: a field with a formula, or velocities at the nodes.

use vofkit_geometry::{Cell, Vector};

use super::sampled::Acting;
use super::trace::{NodalMotion, displacement};
use super::{FaceFluxes, FluxRange, Reversal, RigidMotion, Sampled, StepFluxes, Velocity};
use crate::mesh::Mesh;
use crate::parallel;
use crate::space::{planar, spatial};
use crate::tolerance::REVERSAL_ROUNDING;

/// A velocity on a mesh: what crosses its faces, and where what is at its nodes comes from.
#[derive(Clone, Debug)]
pub struct Flow<const D: usize> {
    source: Source<D>,
    reversal: Reversal,
}

#[derive(Clone, Debug)]
enum Source<const D: usize> {
    Field { velocity: Velocity, fluxes: FaceFluxes<D> },
    Sampled(Sampled<D>),
}

/// A flow from one time to another.
#[derive(Clone, Debug)]
pub struct FlowStep<'a, const D: usize> {
    source: &'a Source<D>,
    /// The integral of the amplitude.
    duration: f64,
    /// For how long sets of velocities act; none of a field.
    acting: Vec<Acting>,
}

impl<const D: usize> Flow<D> {
    /// A velocity with a formula.
    ///
    /// # Errors
    /// Fluxes out of range.
    pub fn new<C: Cell<D>>(mesh: &Mesh<C, D>, velocity: Velocity) -> Result<Self, FluxRange> {
        let fluxes = FaceFluxes::new(mesh, &velocity.field)?;
        Ok(Self { source: Source::Field { velocity, fluxes }, reversal: velocity.reversal })
    }

    /// Velocities at the nodes of the mesh, times the amplitude of a reversal.
    pub fn sampled(samples: Sampled<D>, reversal: Reversal) -> Self {
        Self { source: Source::Sampled(samples), reversal }
    }

    /// The same with another change in time.
    #[must_use]
    pub fn with_reversal(mut self, reversal: Reversal) -> Self {
        if let Source::Field { velocity, .. } = &mut self.source {
            velocity.reversal = reversal;
        }
        self.reversal = reversal;
        self
    }

    /// The flow from one time to a later one.
    pub fn step(&self, start: f64, end: f64) -> FlowStep<'_, D> {
        let acting = match &self.source {
            Source::Field { .. } => Vec::new(),
            Source::Sampled(samples) => samples.acting(&self.reversal, start, end),
        };
        FlowStep { source: &self.source, duration: self.reversal.duration(start, end), acting }
    }

    /// The flow while the velocities of each time act at full amplitude for `duration`: all that there is, between them.
    fn extremes(&self, duration: f64) -> impl Iterator<Item = FlowStep<'_, D>> {
        let frames = match &self.source {
            Source::Field { .. } => 1,
            Source::Sampled(samples) => samples.len(),
        };
        (0..frames).map(move |frame| {
            let is_field = matches!(self.source, Source::Field { .. });
            let acting = if is_field { Vec::new() } else { vec![Acting { frame, duration }] };
            FlowStep { source: &self.source, duration, acting }
        })
    }

    /// The Courant number of a step per unit of time: the largest face flux over the volume of its donor, at full amplitude and at any time.
    pub fn courant_rate<C: Cell<D>>(&self, mesh: &Mesh<C, D>) -> f64 {
        self.extremes(1.0).map(|step| step.fluxes().courant(mesh)).fold(0.0, f64::max)
    }

    /// The largest sum of the fluxes out of a cell in a step of this duration, at any time, relative to its volume, without sign.
    pub fn largest_divergence<C: Cell<D>>(&self, mesh: &Mesh<C, D>, duration: f64) -> f64 {
        self.extremes(duration).map(|step| step.fluxes().largest_divergence(mesh)).fold(0.0, f64::max)
    }

    /// The largest flux through face `2 axis + side` of the cell at `offset`, at full amplitude and at any time, without sign.
    pub fn largest_flux(&self, offset: [usize; D], axis: usize, side: usize) -> f64 {
        let through = |step: FlowStep<'_, D>| step.fluxes().through(offset, axis, side).abs();
        self.extremes(1.0).map(through).fold(0.0, f64::max)
    }

    /// By how much the velocity differs between the two ends of an axis at most, and its largest component there.
    pub fn mismatch<C: Cell<D>>(&self, mesh: &Mesh<C, D>, axis: usize) -> [f64; 2] {
        let grid = mesh.grid();
        let [lower, upper] = mesh.bounds();
        let shift = Vector::<D>::from_fn(|k, _| if k == axis { upper[k] - lower[k] } else { 0.0 });
        let last = grid.node_index(std::array::from_fn(|k| if k == axis { grid.cells()[k] } else { 0 }));
        let (mut difference, mut largest) = (0.0_f64, 0.0_f64);
        for node in (0..grid.node_count()).filter(|&node| grid.node_offset(node)[axis] == 0) {
            let mut compare = |here: Vector<3>, there: Vector<3>| {
                largest = largest.max(here.amax());
                difference = difference.max((there - here).amax());
            };
            match &self.source {
                Source::Field { velocity, .. } => {
                    let x = mesh.nodes()[node];
                    let [here, there] = [x, x + shift].map(|x| velocity.field.velocity(&spatial(&x)));
                    compare(here, there);
                }
                Source::Sampled(samples) => {
                    for frame in 0..samples.len() {
                        let at = |node: usize| spatial(&samples.velocity(frame, node));
                        compare(at(node), at(node + last));
                    }
                }
            }
        }
        [difference, largest]
    }

    /// The velocities in the middle of all cells at one time.
    pub fn cell_velocities<C: Cell<D>>(&self, mesh: &Mesh<C, D>, time: f64) -> Vec<Vector<D>> {
        let amplitude = self.reversal.amplitude(time);
        parallel::map(mesh.grid().len(), |cell| match &self.source {
            Source::Field { velocity, .. } => {
                let middle = mesh.cell(cell).map(&Vector::repeat(0.5));
                planar::<D>(&(velocity.field.velocity(&spatial(&middle)) * amplitude))
            }
            Source::Sampled(samples) => {
                let (grid, around) = (mesh.grid(), samples.around(time));
                let offset = grid.offset(cell);
                let of_corner = |corner: &[usize; D]| {
                    let node = grid.node_index(std::array::from_fn(|k| offset[k] + corner[k]));
                    around
                        .iter()
                        .map(|&(frame, part)| samples.velocity(frame, node) * part)
                        .sum::<Vector<D>>()
                };
                let sum = C::OFFSETS.iter().map(of_corner).sum::<Vector<D>>();
                sum * (amplitude / C::OFFSETS.len() as f64)
            }
        })
    }

    /// The rigid motion from `start` to `end`; none where shapes deform, or nothing is known of it.
    pub fn rigid_motion(&self, start: f64, end: f64) -> Option<RigidMotion> {
        match &self.source {
            Source::Field { velocity, .. } => velocity.rigid_motion(start, end),
            Source::Sampled(samples) => {
                let left = self.reversal.duration(start, end).abs();
                let is_back = samples.is_steady() && left <= REVERSAL_ROUNDING * (end - start).abs();
                is_back.then_some(RigidMotion::Identity)
            }
        }
    }

    /// Whether the fluxes of cells do not cancel, so that what is in them is dilated.
    pub fn dilates(&self) -> bool {
        matches!(&self.source, Source::Sampled(samples) if samples.dilates())
    }

    /// Velocities and accelerations at the nodes, where they are the same at all times but for the amplitude.
    pub(crate) fn steady_motion<C: Cell<D>>(&self, mesh: &Mesh<C, D>) -> Option<NodalMotion<D>> {
        match &self.source {
            Source::Field { velocity, .. } => Some(NodalMotion::of_field(mesh, &velocity.field)),
            Source::Sampled(samples) => samples.is_steady().then(|| {
                let velocities = (0..mesh.nodes().len()).map(|node| samples.velocity(0, node));
                NodalMotion::of_nodes(mesh, velocities.collect())
            }),
        }
    }

    /// The flow of a field while it acts at full amplitude for a unit of time.
    pub(crate) fn at_full_amplitude(&self) -> FlowStep<'_, D> {
        FlowStep { source: &self.source, duration: 1.0, acting: Vec::new() }
    }

    /// All numbers that were given for it at nodes; none of a field.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        let samples = match &self.source {
            Source::Field { .. } => None,
            Source::Sampled(samples) => Some(samples.numbers()),
        };
        samples.into_iter().flatten()
    }

    /// Whether it has a formula.
    pub(crate) fn is_field(&self) -> bool {
        matches!(self.source, Source::Field { .. })
    }
}

impl<const D: usize> FlowStep<'_, D> {
    /// The volumes that cross the faces.
    pub fn fluxes(&self) -> StepFluxes<'_, D> {
        match self.source {
            Source::Field { fluxes, .. } => fluxes.step(self.duration),
            Source::Sampled(samples) => samples.fluxes(&self.acting),
        }
    }

    /// For how long the velocity would have to act at full amplitude; negative backwards.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Whether nothing is moved.
    pub fn is_nothing(&self) -> bool {
        match self.source {
            Source::Field { .. } => self.duration == 0.0,
            Source::Sampled(_) => self.acting.iter().all(|acting| acting.duration == 0.0),
        }
    }

    /// How far a node would come at the velocities there: the integral of the velocity at its place.
    pub fn straight<C: Cell<D>>(&self, mesh: &Mesh<C, D>, node: usize) -> Vector<D> {
        match self.source {
            Source::Field { velocity, .. } => {
                planar(&(velocity.field.velocity(&spatial(&mesh.nodes()[node])) * self.duration))
            }
            Source::Sampled(samples) => {
                self.acting.iter().map(|a| samples.velocity(a.frame, node) * a.duration).sum()
            }
        }
    }

    /// How far what is at the nodes has come along its path, as the motion of one unit of time.
    pub(crate) fn motion<C: Cell<D>>(&self, mesh: &Mesh<C, D>) -> NodalMotion<D> {
        let straight = parallel::map(mesh.nodes().len(), |node| self.straight(mesh, node));
        NodalMotion::of_nodes(mesh, straight)
    }

    /// How far a point has come along the path that the formula gives; nowhere without a formula.
    pub(crate) fn displacement(&self, x: &Vector<D>) -> Vector<D> {
        match self.source {
            Source::Field { velocity, .. } => displacement(&velocity.field, x, self.duration),
            Source::Sampled(_) => Vector::zeros(),
        }
    }
}
