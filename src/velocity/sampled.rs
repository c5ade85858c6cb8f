//! A velocity that is given at the nodes of a mesh, at one time or at several.
//!
//! Between the nodes it is linear along mesh lines, and the volume that crosses a face is the exact integral of that. Between two times it is
//! linear, before the first and after the last constant; so what crosses a face in a step is the exact integral over the step, too.
//!
//! The fluxes of a cell then do not cancel. [`Divergence`] says what becomes of that.

use vofkit_geometry::{Cell, Vector};

use super::faces::{Faces, area, flux};
use super::projection::project;
use super::{Reversal, StepFluxes};
use crate::mesh::{Grid, Mesh};
use crate::parallel;
use crate::quanta::Quanta;
use crate::tolerance::{DIVERGENCE_ROUNDING, RANGE, WALL_ROUNDING};

/// What becomes of the divergence of velocities that are given at nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Divergence {
    /// There must not be any but for rounding.
    #[default]
    Error,
    /// The face fluxes are made free of it by the smallest change.
    Project,
    /// What is in a cell is dilated or compressed: `f+ = (f V - sum G) / (V - sum F)`. Volume is then not conserved; the ledger has the change.
    Dilate,
}

/// Velocities at nodes that no material can be moved by. Velocities are counted by the times that they are given at.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SampledError {
    /// No velocities.
    #[error("there are no velocities at any time")]
    Empty,
    /// A time that does not follow the one before.
    #[error("the time {time} does not follow {before}")]
    Time {
        /// The time.
        time: f64,
        /// The one before.
        before: f64,
    },
    /// A time that is not finite, or whose distance to others is not.
    #[error("the time {time:e} is outside the range of double precision")]
    TimeRange {
        /// The time.
        time: f64,
    },
    /// Velocities that are not those of the nodes.
    #[error("there are {found} velocities, the mesh has {wanted} nodes")]
    Count {
        /// Which velocities.
        frame: usize,
        /// Their number.
        found: usize,
        /// The nodes.
        wanted: usize,
    },
    /// Velocities that are not finite, or whose fluxes cannot be counted in double precision.
    #[error("the velocities make fluxes of up to {largest:e}, outside the range of double precision")]
    Range {
        /// Which velocities.
        frame: usize,
        /// The largest flux through a face, without sign; NaN if any is.
        largest: f64,
    },
    /// Velocities whose squares cannot be counted in double precision.
    #[error("the velocities of up to {fastest:e} have squares outside the range of double precision")]
    Speed {
        /// Which velocities.
        frame: usize,
        /// The largest component of one, without sign.
        fastest: f64,
    },
    /// Fluxes that do not cancel.
    #[error(
        "the velocity is not free of divergence: at a Courant number of 1 the fluxes of cell {cell:?} would add {relative:.3e} of \
         its volume in a step"
    )]
    Divergent {
        /// Which velocities.
        frame: usize,
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// Its sum of fluxes over its volume and the Courant number per time of the whole mesh.
        relative: f64,
    },
    /// A projection that did not get to the end.
    #[error(
        "after {iterations} iterations the fluxes of a cell still add up to {residual:.3e} of the largest flux"
    )]
    NoConvergence {
        /// Which velocities.
        frame: usize,
        /// The iterations.
        iterations: usize,
        /// The largest sum of the fluxes of a cell, relative to the largest flux.
        residual: f64,
    },
}

impl SampledError {
    /// Which velocities it is about.
    pub fn frame(&self) -> Option<usize> {
        match self {
            Self::Count { frame, .. }
            | Self::Range { frame, .. }
            | Self::Speed { frame, .. }
            | Self::Divergent { frame, .. }
            | Self::NoConvergence { frame, .. } => Some(*frame),
            Self::Empty | Self::Time { .. } | Self::TimeRange { .. } => None,
        }
    }
}

/// Velocities at the nodes of a mesh, and the fluxes through its faces that follow from them.
#[derive(Clone, Debug)]
pub struct Sampled<const D: usize> {
    frames: Vec<Frame<D>>,
    divergence: Divergence,
}

/// The velocities at one time.
#[derive(Clone, Debug)]
struct Frame<const D: usize> {
    time: f64,
    velocities: Vec<Vector<D>>,
    fluxes: Faces<D>,
    /// The largest flux.
    largest: f64,
}

/// For how long the velocities of one time act in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Acting {
    pub(super) frame: usize,
    pub(super) duration: f64,
}

/// The volumes that cross the faces in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct SampledFluxes<'a, const D: usize> {
    frames: &'a [Frame<D>],
    acting: &'a [Acting],
    pub(super) quanta: Quanta,
}

impl<const D: usize> Sampled<D> {
    /// Velocities at the nodes of `mesh`, each set with its time; of one set the time is of no meaning. An end of the mesh
    /// that is crossed by rounding alone, of single precision at most, is taken to be crossed by nothing.
    ///
    /// # Errors
    /// See [`SampledError`].
    pub fn new<C: Cell<D>>(
        mesh: &Mesh<C, D>,
        samples: Vec<(f64, Vec<Vector<D>>)>,
        divergence: Divergence,
    ) -> Result<Self, SampledError> {
        let mut frames: Vec<Frame<D>> = Vec::with_capacity(samples.len());
        for (frame, (time, velocities)) in samples.into_iter().enumerate() {
            let before = frames.last().map_or(f64::NEG_INFINITY, |last| last.time);
            if !(time.abs() <= *RANGE.end()) {
                return Err(SampledError::TimeRange { time });
            }
            if !(time > before) {
                return Err(SampledError::Time { time, before });
            }
            let (found, wanted) = (velocities.len(), mesh.nodes().len());
            if found != wanted {
                return Err(SampledError::Count { frame, found, wanted });
            }
            let mut fluxes = Faces::new(mesh.grid(), |face| flux(mesh, &velocities, face));
            let largest = fluxes.largest();
            if largest != 0.0 && !RANGE.contains(&largest) {
                return Err(SampledError::Range { frame, largest });
            }
            let fastest = velocities.iter().map(|u| u.amax()).fold(0.0, f64::max);
            if fastest * fastest > *RANGE.end() {
                return Err(SampledError::Speed { frame, fastest });
            }
            close_walls(mesh, &velocities, &mut fluxes);
            match divergence {
                Divergence::Error => check_divergence(mesh, &fluxes, frame)?,
                Divergence::Project => {
                    project(mesh, &mut fluxes).map_err(|(iterations, residual)| {
                        SampledError::NoConvergence { frame, iterations, residual }
                    })?;
                }
                Divergence::Dilate => {}
            }
            frames.push(Frame { time, velocities, largest: fluxes.largest(), fluxes });
        }
        if frames.is_empty() {
            return Err(SampledError::Empty);
        }
        Ok(Self { frames, divergence })
    }

    /// Whether the fluxes of cells do not cancel.
    pub fn dilates(&self) -> bool {
        self.divergence == Divergence::Dilate
    }

    /// Whether the velocities do not change but for a reversal.
    pub fn is_steady(&self) -> bool {
        self.frames.len() == 1
    }

    /// All times and velocities, one number after the other.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.frames.iter().flat_map(|frame| {
            std::iter::once(frame.time).chain(frame.velocities.iter().flat_map(|u| u.iter().copied()))
        })
    }

    /// The number of times.
    pub(super) fn len(&self) -> usize {
        self.frames.len()
    }

    /// For how long each set of velocities acts from `start` to `end`: the integrals of `a(t) h(t)` with the amplitude `a` and the hat
    /// functions `h` of the times.
    pub(super) fn acting(&self, reversal: &Reversal, start: f64, end: f64) -> Vec<Acting> {
        let inside = |time: &f64| *time > start && *time < end;
        let mut cuts = vec![start, end];
        cuts.extend(self.frames.iter().map(|frame| frame.time).filter(inside));
        if let Reversal::Flip { time } = reversal {
            cuts.extend(Some(*time).filter(inside));
        }
        cuts.sort_by(f64::total_cmp);
        let mut acting: Vec<Acting> = Vec::new();
        let mut add = |frame: usize, duration: f64| match acting.last_mut() {
            Some(last) if last.frame == frame => last.duration += duration,
            _ => acting.push(Acting { frame, duration }),
        };
        for cut in cuts.windows(2) {
            let (from, to) = (cut[0], cut[1]);
            let whole = reversal.duration(from, to);
            let [(before, _), (after, _)] = self.around(0.5 * (from + to));
            // The part of the second of two times, from 0 to 1 between them; Gauss' rule is exact for a steady amplitude.
            let later = if before == after {
                0.0
            } else {
                let at = |t: f64| reversal.amplitude(t) * self.around(t)[1].1;
                gauss(from, to, at)
            };
            add(before, whole - later);
            if after != before {
                add(after, later);
            }
        }
        acting
    }

    /// The velocities that there are at a time: two sets and their parts.
    pub(super) fn around(&self, time: f64) -> [(usize, f64); 2] {
        let after = self.frames.partition_point(|frame| frame.time <= time);
        match after {
            0 => [(0, 1.0), (0, 0.0)],
            after if after == self.frames.len() => [(after - 1, 1.0), (after - 1, 0.0)],
            after => {
                let [a, b] = [after - 1, after].map(|k| self.frames[k].time);
                let part = (time - a) / (b - a);
                [(after - 1, 1.0 - part), (after, part)]
            }
        }
    }

    /// The velocity at a node at the time of a set.
    pub(super) fn velocity(&self, frame: usize, node: usize) -> Vector<D> {
        self.frames[frame].velocities[node]
    }

    /// What crosses the faces while sets of velocities act.
    pub(super) fn fluxes<'a>(&'a self, acting: &'a [Acting]) -> StepFluxes<'a, D> {
        let largest = acting.iter().map(|a| self.frames[a.frame].largest * a.duration.abs()).sum();
        StepFluxes::sampled(SampledFluxes { frames: &self.frames, acting, quanta: Quanta::new(largest) })
    }
}

impl<const D: usize> SampledFluxes<'_, D> {
    /// The volume that crosses face `2 axis + side` of the cell at `offset` towards higher indices.
    pub(super) fn through(&self, offset: [usize; D], axis: usize, side: usize) -> f64 {
        let part = |a: &Acting| self.frames[a.frame].fluxes.of_cell(offset, axis, side) * a.duration;
        self.quanta.round(self.acting.iter().map(part).sum())
    }
}

/// Gauss' rule with three points.
fn gauss(from: f64, to: f64, value: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let away = half * 0.6_f64.sqrt();
    half * (8.0 * value(middle) + 5.0 * (value(middle - away) + value(middle + away))) / 9.0
}

/// Lets nothing cross the ends of the mesh that are crossed by rounding alone: by less than [`WALL_ROUNDING`] times the largest
/// velocity everywhere.
fn close_walls<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocities: &[Vector<D>],
    fluxes: &mut Faces<D>,
) {
    let grid = mesh.grid();
    let fastest = velocities.iter().map(|u| u.norm()).fold(0.0, f64::max);
    let end = |axis: usize, at: usize| match at {
        0 => Some(0),
        at if at == grid.cells()[axis] => Some(1),
        _ => None,
    };
    let mut is_open = [[false; 2]; D];
    fluxes.change(|(axis, offset), flux| {
        if let Some(side) = end(axis, offset[axis]) {
            let most = WALL_ROUNDING * fastest * area(mesh, (axis, offset)).norm();
            is_open[axis][side] |= !(flux.abs() <= most);
        }
    });
    fluxes.change(|(axis, offset), flux| {
        if let Some(side) = end(axis, offset[axis])
            && !is_open[axis][side]
            && !grid.periodic()[axis]
        {
            *flux = 0.0;
        }
    });
}

/// # Errors
/// Fluxes that do not cancel.
fn check_divergence<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fluxes: &Faces<D>,
    frame: usize,
) -> Result<(), SampledError> {
    let grid: &Grid<D> = mesh.grid();
    let balances = parallel::map(grid.len(), |cell| {
        fluxes.balance(grid.offset(cell)).map(|volume| volume / mesh.volumes()[cell])
    });
    let courant = balances.iter().map(|[_, through]| *through).fold(0.0, f64::max);
    let mut worst = (0, 0.0);
    for (cell, [net, _]) in balances.iter().enumerate() {
        if net.abs() > worst.1 {
            worst = (cell, net.abs());
        }
    }
    let (cell, net) = worst;
    if net <= DIVERGENCE_ROUNDING * courant {
        return Ok(());
    }
    Err(SampledError::Divergent { frame, cell: grid.offset(cell).to_vec(), relative: net / courant })
}
