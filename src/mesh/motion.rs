//! Meshes that move while the material rests: where the nodes are, as a function of the progress of a run from 0 to 1.

use std::f64::consts::PI;

use vofkit_geometry::{Cell, Vector};

use super::{Distortion, Grid, Mesh, MeshError, SweptVolumes, axis_name, box_nodes};
use crate::shape::Rotation;
use crate::tolerance::PERIODIC_MOTION;

/// How the nodes of a mesh move over a run.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshMotion<const D: usize> {
    /// From where they are to where a distortion puts them.
    Distort {
        /// The distortion; it adds to the one that the mesh may have.
        distortion: Distortion,
        /// How often: 1 is there, 2 there and back, and so on.
        swings: usize,
    },
    /// To their places in the mesh of equal boxes with the same bounds.
    Smooth {
        /// How often: 1 is there, 2 there and back, and so on.
        swings: usize,
    },
    /// The whole mesh about an axis.
    Rotate {
        /// A point of the axis.
        centre: Vector<D>,
        /// The direction of the axis, of any length but zero; in 2D z.
        axis: Vector<3>,
        /// The angle at the end, in radians.
        angle: f64,
    },
    /// Through given places of all nodes, one set after the other, on straight lines at equal intervals. The first set is
    /// where the mesh goes from its start.
    Through(Vec<Vec<Vector<D>>>),
}

/// A motion that cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// An amplitude or an angle out of range.
    #[error(transparent)]
    Distortion(MeshError),
    /// No swing at all.
    #[error("the motion of the mesh has 0 swings")]
    NoSwing,
    /// A rotation whose angle, centre or axis is not finite, or without an axis.
    #[error("the rotation of the mesh by {angle} about the axis {axis:?} through {centre:?} is none")]
    Rotation {
        /// The angle.
        angle: f64,
        /// The axis.
        axis: Vec<f64>,
        /// The centre.
        centre: Vec<f64>,
    },
    /// No node set.
    #[error("there are no places to move the nodes to")]
    NoNodes,
    /// A node set that is not one place for each node.
    #[error("node set {set} has {given} nodes, and the mesh has {wanted}")]
    NodeCount {
        /// The set, counted from 0.
        set: usize,
        /// Nodes of the mesh.
        wanted: usize,
        /// Nodes of the set.
        given: usize,
    },
    /// A place that is not finite.
    #[error("node {node:?} of node set {set} is at {place:?}, which is not finite")]
    NotFinite {
        /// The set, counted from 0.
        set: usize,
        /// The node's index along each axis.
        node: Vec<usize>,
        /// Where it should be.
        place: Vec<f64>,
    },
    /// Joined ends that would come apart.
    #[error("node {node:?} and its image at the joined end of {} move apart by {difference:e}", axis_name(*axis))]
    Periodic {
        /// The axis.
        axis: usize,
        /// The node's index along each axis.
        node: Vec<usize>,
        /// By how much the two moves differ.
        difference: f64,
    },
    /// Two meshes that are not places of one.
    #[error("a mesh of {from:?} cells cannot move to one of {to:?} cells")]
    OtherGrid {
        /// Cells along each axis before.
        from: Vec<usize>,
        /// Cells along each axis after.
        to: Vec<usize>,
    },
    /// Cells that cannot be used on the way.
    #[error("at {:.4} of its motion {source}", progress)]
    Cells {
        /// Where on the way, from 0 to 1.
        progress: f64,
        /// Which cells, and why.
        source: MeshError,
    },
}

/// Samples of each part of a motion, in its middle and around it, where swings are fastest; and the size of the steps there.
const RATE_SAMPLES: usize = 5;
const RATE_STEP: f64 = 1e-3;

/// How fast a mesh moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionRates {
    /// The Courant number per progress.
    pub courant: f64,
    /// The difference between cell volumes and what the faces sweep, relative: rounding.
    pub mismatch: f64,
}

/// The ways of the nodes of a mesh.
#[derive(Clone, Debug)]
pub struct MeshPath<C, const D: usize> {
    start: Mesh<C, D>,
    way: Way<D>,
}

#[derive(Clone, Debug)]
enum Way<const D: usize> {
    /// On straight lines to one place, there and back.
    Swing {
        end: Vec<Vector<D>>,
        swings: usize,
    },
    Rotation {
        centre: Vector<D>,
        axis: Vector<3>,
        angle: f64,
    },
    Through(Vec<Vec<Vector<D>>>),
}

impl<C: Cell<D>, const D: usize> MeshPath<C, D> {
    /// The ways from where the nodes of `start` are.
    ///
    /// # Errors
    /// Numbers out of range, nodes that are missing or not finite, and joined ends that would come apart. Whether the cells
    /// stay valid shows on the way.
    pub fn new(start: Mesh<C, D>, motion: MeshMotion<D>) -> Result<Self, MotionError> {
        let [lower, upper] = start.bounds();
        let way = match motion {
            MeshMotion::Distort { swings: 0, .. } | MeshMotion::Smooth { swings: 0 } => {
                return Err(MotionError::NoSwing);
            }
            MeshMotion::Distort { distortion, swings } => {
                let mut end = start.nodes().to_vec();
                distortion.apply(start.grid(), &lower, &upper, &mut end).map_err(MotionError::Distortion)?;
                Way::Swing { end, swings }
            }
            MeshMotion::Smooth { swings } => {
                Way::Swing { end: box_nodes(start.grid(), &lower, &upper), swings }
            }
            MeshMotion::Rotate { centre, axis, angle } => {
                let end = Rotation::<D>::from_axis_angle(axis, angle);
                if !end.matrix().iter().chain(centre.iter()).all(|c| c.is_finite()) {
                    return Err(MotionError::Rotation {
                        angle,
                        axis: axis.as_slice().to_vec(),
                        centre: centre.as_slice().to_vec(),
                    });
                }
                Way::Rotation { centre, axis, angle }
            }
            MeshMotion::Through(sets) => {
                check_sets(start.grid(), &sets)?;
                Way::Through(sets)
            }
        };
        let path = Self { start, way };
        path.check_periodic()?;
        Ok(path)
    }

    /// The mesh at the start.
    pub fn start(&self) -> &Mesh<C, D> {
        &self.start
    }

    /// The nodes at a progress from 0 to 1.
    pub fn nodes(&self, progress: f64) -> Vec<Vector<D>> {
        let start = self.start.nodes();
        match &self.way {
            Way::Swing { end, swings } => {
                let amount = 0.5 * (1.0 - (PI * *swings as f64 * progress).cos());
                between(start, end, amount)
            }
            Way::Rotation { centre, axis, angle } => {
                let rotation = Rotation::from_axis_angle(*axis, angle * progress);
                start.iter().map(|x| centre + rotation.apply(&(x - centre))).collect()
            }
            Way::Through(sets) => {
                let place = progress.clamp(0.0, 1.0) * sets.len() as f64;
                let set = (place.ceil() as usize).clamp(1, sets.len()) - 1;
                let from = if set == 0 { start } else { &sets[set - 1] };
                between(from, &sets[set], place - set as f64)
            }
        }
    }

    /// The mesh at a progress from 0 to 1.
    ///
    /// # Errors
    /// Cells that are not valid there, all of them.
    pub fn mesh(&self, progress: f64) -> Result<Mesh<C, D>, MotionError> {
        self.start.moved(self.nodes(progress)).map_err(|source| MotionError::Cells { progress, source })
    }

    /// The largest Courant number of small steps, per progress, and the largest [mismatch](SweptVolumes::mismatch) in them, from
    /// samples of the motion.
    ///
    /// # Errors
    /// Cells that are not valid at a sample.
    pub fn rates(&self) -> Result<MotionRates, MotionError> {
        let (parts, length) = match &self.way {
            // All swings are alike.
            Way::Swing { swings, .. } => (1, 1.0 / *swings as f64),
            Way::Rotation { .. } => (1, 1.0),
            Way::Through(sets) => (sets.len(), 1.0 / sets.len() as f64),
        };
        let mut rates = MotionRates::default();
        for sample in 0..parts * RATE_SAMPLES {
            let step = RATE_STEP * length;
            let middle = (sample as f64 + 0.5) / RATE_SAMPLES as f64 * length;
            let [from, to] = [middle - 0.5 * step, middle + 0.5 * step].map(|progress| self.mesh(progress));
            let (from, to) = (from?, to?);
            let swept = SweptVolumes::new(&from, &to)?;
            rates.courant = rates.courant.max(swept.courant(&from) / step);
            rates.mismatch = rates.mismatch.max(swept.mismatch(&from, &to));
        }
        Ok(rates)
    }

    /// Joined ends have to move alike.
    fn check_periodic(&self) -> Result<(), MotionError> {
        let grid = self.start.grid();
        let [lower, upper] = self.start.bounds();
        let limit = PERIODIC_MOTION * (upper - lower).amax();
        let intervals = if let Way::Through(sets) = &self.way { sets.len() } else { 2 };
        for interval in 1..=intervals {
            let nodes = self.nodes(interval as f64 / intervals as f64);
            for (node, x) in nodes.iter().enumerate() {
                let at = grid.node_offset(node);
                for axis in (0..D).filter(|&axis| grid.periodic()[axis] && at[axis] == 0) {
                    let mut other = at;
                    other[axis] = grid.cells()[axis];
                    let image = grid.node_index(other);
                    let apart = (nodes[image] - self.start.nodes()[image]) - (x - self.start.nodes()[node]);
                    let difference = apart.amax();
                    if !(difference <= limit) {
                        return Err(MotionError::Periodic { axis, node: at.to_vec(), difference });
                    }
                }
            }
        }
        Ok(())
    }
}

/// The points between two sets; exactly the sets at 0 and 1.
fn between<const D: usize>(from: &[Vector<D>], to: &[Vector<D>], amount: f64) -> Vec<Vector<D>> {
    from.iter().zip(to).map(|(a, b)| a * (1.0 - amount) + b * amount).collect()
}

fn check_sets<const D: usize>(grid: &Grid<D>, sets: &[Vec<Vector<D>>]) -> Result<(), MotionError> {
    if sets.is_empty() {
        return Err(MotionError::NoNodes);
    }
    for (set, nodes) in sets.iter().enumerate() {
        if nodes.len() != grid.node_count() {
            return Err(MotionError::NodeCount { set, wanted: grid.node_count(), given: nodes.len() });
        }
        if let Some(node) = nodes.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
            return Err(MotionError::NotFinite {
                set,
                node: grid.node_offset(node).to_vec(),
                place: nodes[node].as_slice().to_vec(),
            });
        }
    }
    Ok(())
}
