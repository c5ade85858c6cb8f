//! How materials are transported: the choices.

use std::fmt;

use vofkit_geometry::Cell;

use super::boundary::End;
use super::schedule::SweepOrder;
use crate::interface::Reconstruction;
use crate::mesh::Mesh;

/// How the volumes of a step are moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Scheme {
    /// One direction after the other (Algorithm 5.1 of the paper).
    #[default]
    Sweeps,
    /// All faces at once (Fig. 17), which is of first order: for comparison.
    Isotropic,
    /// Sweeps in which cells keep their volume (Weymouth & Yue 2010), on undistorted meshes.
    WeymouthYue,
    /// All directions at once: each cell gets what its pre-image holds, cut by every cell that it meets and by the planes in them.
    Unsplit,
    /// The content of the cells of another mesh, however far its nodes moved: for meshes that move. There `Unsplit` does the same, but
    /// for steps within a Courant number of 1.
    Remap,
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Scheme {
    /// The word of scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sweeps => "sweeps",
            Self::Isotropic => "isotropic",
            Self::WeymouthYue => "weymouth_yue",
            Self::Unsplit => "unsplit",
            Self::Remap => "remap",
        }
    }

    /// The largest Courant number, the part of a cell that may leave through one face in a step, in `dimension` dimensions.
    pub fn courant_limit(self, dimension: usize) -> f64 {
        match self {
            Self::Sweeps | Self::Isotropic | Self::Unsplit => 1.0,
            Self::Remap => f64::INFINITY,
            // Half of a cell may leave through all faces.
            Self::WeymouthYue => 0.5_f64.powi(dimension as i32 - 1),
        }
    }
}

/// The directions of the sweeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SweepAxes {
    /// Along mesh lines, over two opposite faces of every cell: conservative and bounded to rounding on any mesh.
    #[default]
    Logical,
    /// One Cartesian component of the displacement per sweep, over all faces: the paper's. On an undistorted mesh that stands
    /// still a component crosses the faces of one direction alone, and this is [`SweepAxes::Logical`].
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
    /// How the volumes are moved.
    pub scheme: Scheme,
    /// The directions of the sweeps.
    pub axes: SweepAxes,
    /// Their order.
    pub order: SweepOrder,
    /// Whether to go on where a cell would give away more than it holds, instead of returning
    /// [`StepError::Overdrawn`](super::StepError::Overdrawn); what cannot be given shows up in the ledger.
    pub overdraft: bool,
    /// After a step, cells are emptied that hold less than this fraction of a material among cells that all hold less: wisps. None
    /// keeps them.
    pub wisps: Option<f64>,
}

impl<const D: usize> Default for Settings<D> {
    fn default() -> Self {
        Self {
            ends: [[None; 2]; D],
            inflow: None,
            reconstruction: Reconstruction::default(),
            scheme: Scheme::default(),
            axes: SweepAxes::default(),
            order: SweepOrder::default(),
            overdraft: false,
            wisps: None,
        }
    }
}

impl<const D: usize> Settings<D> {
    /// Whether each face flux of a flow is split into the components of the displacement.
    pub(super) fn splits_displacement<C: Cell<D>>(&self, mesh: &Mesh<C, D>) -> bool {
        self.scheme == Scheme::Sweeps && self.axes == SweepAxes::Cartesian && !mesh.is_undistorted()
    }
}
