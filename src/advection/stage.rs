//! One sweep of a step: the volumes that it moves through the faces, and the regions that they come from.
//!
//! A *slab* of the donor cell next to the face holds the wanted part of its volume: that is a sweep along mesh lines, over two
//! opposite faces. A *traced* region lies between the face and the face traced back by one component of the displacement, or by all
//! of it, its depth adjusted until its volume is the wanted one; the flux volume of a face is then split into component fluxes
//!
//! ```text
//! phi_k = u_k S_k + (phi - sum_j u_j S_j) S_k^2 / |S|^2,   sum_k phi_k = phi
//! ```
//!
//! with the mean nodal displacement `u` and the area vector `S` of the face (Eq. 27). A *swept* region lies between the face and the
//! same face of the mesh that the nodes move to; its volume is exact as it is.

use std::ops::Range;

use vofkit_geometry::parallelepiped::UnitCube;
use vofkit_geometry::{Cell, HalfSpace, Vector};

use super::boundary::Boundary;
use super::schedule::{Share, Turn};
use super::tracing::Traced;
use crate::mesh::{Grid, Mesh};
use crate::tolerance::{OUTFLOW_EXCESS, SWEPT_VOLUME_RATIO, TRACE_ITERATIONS};
use crate::velocity::{NodalMotion, StepFluxes};

/// The volumes that leave a cell through its faces; negative where they enter.
pub(super) type Outward = [f64; 6];

/// One sweep.
pub(super) struct Stage<'a, C, const D: usize> {
    /// The mesh whose cells give.
    pub(super) mesh: &'a Mesh<C, D>,
    /// The faces that volume is moved through.
    pub(super) faces: Range<usize>,
    /// Which of the volumes of a cell are moved.
    pub(super) component: usize,
    /// How much of them.
    pub(super) share: Share,
    /// Where they come from.
    pub(super) regions: Regions<'a, C, D>,
}

/// Where the volumes of a sweep come from.
pub(super) enum Regions<'a, C, const D: usize> {
    /// From the slab of the donor next to the face.
    Slabs,
    /// From between the face and the face traced back over a time, along one axis or, without one, all of them.
    Traced { nodes: &'a NodalMotion<D>, duration: f64, axis: Option<usize> },
    /// From between the face and the same face of another mesh.
    Swept { to: &'a Mesh<C, D> },
}

/// The flux towards higher indices through a face, split by the axes of the displacement of the nodes; the last of `axes` takes
/// what the others leave.
pub(super) fn components<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    traced: &Traced<'_, D>,
    fluxes: &StepFluxes<'_, D>,
    axes: [usize; D],
    mut offset: [usize; D],
    face: usize,
) -> [f64; D] {
    let (axis, side) = (face / 2, face % 2);
    let whole = fluxes.through(offset, axis, side);
    let grid = mesh.grid();
    // Both cells of a face must split it alike: count it as the lower face of the cell above it, the two ends of a periodic axis
    // as one.
    offset[axis] += side;
    if grid.periodic()[axis] {
        offset[axis] %= grid.cells()[axis];
    }
    let index = C::FACE_NODES[2 * axis];
    let mut corners = [Vector::<D>::zeros(); 4];
    let mut mean = Vector::<D>::zeros();
    for (corner, &i) in corners.iter_mut().zip(index) {
        let node = grid.node_index(std::array::from_fn(|k| offset[k] + C::OFFSETS[i][k]));
        *corner = mesh.nodes()[node];
        mean += traced.displacement(node);
    }
    mean /= index.len() as f64;
    let area = -C::area_vector(&corners[..index.len()]);
    let rest = (whole - mean.dot(&area)) / area.norm_squared();
    let mut parts = [0.0; D];
    let (last, others) = axes.split_last().expect("there is at least one axis");
    let mut left = whole;
    for &k in others {
        parts[k] = fluxes.round(mean[k] * area[k] + rest * area[k] * area[k]);
        left -= parts[k];
    }
    parts[*last] = left;
    parts
}

/// What leaves the cell at `offset`, from what crosses its faces towards higher indices; nothing crosses walls.
pub(super) fn outward_volumes<C: Cell<D>, const D: usize>(
    grid: &Grid<D>,
    boundary: &Boundary<D>,
    offset: [usize; D],
    through: impl Fn(usize) -> f64,
) -> Outward {
    let mut outward = [0.0; 6];
    for face in 0..C::FACES {
        if !boundary.is_wall(grid, offset, face / 2, face % 2) {
            outward[face] = if face % 2 == 1 { through(face) } else { -through(face) };
        }
    }
    outward
}

impl<'a, C: Cell<D>, const D: usize> Stage<'a, C, D> {
    /// A sweep over two opposite faces, from slabs of the donors.
    pub(super) fn along_mesh_lines(mesh: &'a Mesh<C, D>, turn: &Turn) -> Self {
        let faces = 2 * turn.axis..2 * turn.axis + 2;
        Self { mesh, faces, component: 0, share: turn.share, regions: Regions::Slabs }
    }

    /// A sweep over all faces.
    pub(super) fn over_all_faces(
        mesh: &'a Mesh<C, D>,
        component: usize,
        share: Share,
        regions: Regions<'a, C, D>,
    ) -> Self {
        Self { mesh, faces: 0..C::FACES, component, share, regions }
    }
}

impl<C: Cell<D>, const D: usize> Stage<'_, C, D> {
    /// What the half-space leaves of the region behind `face` that has the wanted volume. `cell` is the donor, at
    /// `offset`, in its local coordinates, and so is the half-space.
    pub(super) fn part(
        &self,
        cell: &C,
        offset: [usize; D],
        face: usize,
        wanted: f64,
        half_space: &HalfSpace<D>,
    ) -> f64 {
        if let (Regions::Slabs, Some(lengths)) = (&self.regions, self.mesh.spacing()) {
            let volume = cell.volume();
            return volume * part_of_slab(&lengths, half_space, face, wanted / volume);
        }
        self.region(cell, offset, face, wanted).truncate(half_space).volume
    }

    /// The region behind `face` that has the wanted volume.
    pub(super) fn region(&self, cell: &C, offset: [usize; D], face: usize, wanted: f64) -> C {
        match &self.regions {
            Regions::Slabs => cell.slab(face, wanted / cell.volume()),
            Regions::Traced { nodes, duration, axis } => {
                let displacement = |node: usize| {
                    let whole = nodes.displacement(node, *duration);
                    axis.map_or(whole, |axis| Vector::from_fn(|k, _| if k == axis { whole[k] } else { 0.0 }))
                };
                let (front, moves) = self.face(cell, offset, face, displacement);
                traced(&front[..C::FACE_NODES[face].len()], &moves, *axis, wanted)
            }
            Regions::Swept { to } => {
                let moves = |node: usize| self.mesh.nodes()[node] - to.nodes()[node];
                let (front, moves) = self.face(cell, offset, face, moves);
                moved_back(&front[..C::FACE_NODES[face].len()], &moves, 1.0)
            }
        }
    }

    /// The slabs behind the two faces of a sweep along mesh lines with the wanted volumes, and what they leave of the cell: together
    /// they are the cell. None in other sweeps, and where a cell gives more than it holds.
    pub(super) fn slabs(&self, cell: &C, wanted: impl Fn(usize) -> f64) -> Option<[C; 3]> {
        let Regions::Slabs = self.regions else { return None };
        let [low, high] = [self.faces.start, self.faces.start + 1];
        let [of_low, of_high] = [low, high].map(|face| wanted(face) / cell.volume());
        if of_low + of_high > 1.0 + OUTFLOW_EXCESS {
            return None;
        }
        let above_low = cell.slab(high, 1.0 - of_low);
        let left = if of_low < 1.0 { 1.0 - of_high / (1.0 - of_low) } else { 0.0 };
        let middle = above_low.slab(low, left);
        Some([cell.slab(low, of_low), cell.slab(high, of_high), middle])
    }

    /// The nodes of a face of a cell in its local coordinates, and what `of_node` says about each.
    fn face(
        &self,
        cell: &C,
        offset: [usize; D],
        face: usize,
        of_node: impl Fn(usize) -> Vector<D>,
    ) -> ([Vector<D>; 4], [Vector<D>; 4]) {
        let (mut front, mut moves) = ([Vector::zeros(); 4], [Vector::zeros(); 4]);
        for (i, &corner) in C::FACE_NODES[face].iter().enumerate() {
            front[i] = cell.nodes()[corner];
            let at = std::array::from_fn(|k| offset[k] + C::OFFSETS[corner][k]);
            moves[i] = of_node(self.mesh.grid().node_index(at));
        }
        (front, moves)
    }
}

/// The region between a face and the face moved back by `scale` times its moves.
fn moved_back<C: Cell<D>, const D: usize>(front: &[Vector<D>], moves: &[Vector<D>; 4], scale: f64) -> C {
    let mut back = [Vector::zeros(); 4];
    for (i, back) in back[..front.len()].iter_mut().enumerate() {
        *back = front[i] - moves[i] * scale;
    }
    C::swept(&back[..front.len()], front)
}

/// The region of the wanted volume behind a face whose nodes came from their places minus `moves`. Where these do not
/// resemble the flux (its velocity changes sign over the face), the face is moved as a whole.
fn traced<C: Cell<D>, const D: usize>(
    front: &[Vector<D>],
    moves: &[Vector<D>; 4],
    axis: Option<usize>,
    wanted: f64,
) -> C {
    // Along one axis the volume is exactly linear in the scale of the moves; else it has terms of second order, and a few
    // rounds settle it.
    let mut scale = 1.0;
    for _ in 0..TRACE_ITERATIONS {
        let region: C = moved_back(front, moves, scale);
        let ratio = wanted / region.volume();
        if !(SWEPT_VOLUME_RATIO.recip()..=SWEPT_VOLUME_RATIO).contains(&ratio) {
            break;
        }
        scale *= ratio;
        if axis.is_some() || (ratio - 1.0).abs() <= f64::EPSILON.sqrt() {
            return moved_back(front, moves, scale);
        }
    }
    let area = C::area_vector(front);
    let along = match axis {
        Some(axis) => Vector::from_fn(|k, _| if k == axis { wanted / area[k] } else { 0.0 }),
        None => area * (wanted / area.norm_squared()),
    };
    moved_back(front, &[along; 4], 1.0)
}

/// What the half-space leaves of the slab that takes up `fraction` of a box with these edges, next to `face`; relative to the
/// box, whose lowest corner is the origin.
///
/// The slab is a box itself: a unit cube whose normal is shortened along the axis of the face.
fn part_of_slab<const D: usize>(
    lengths: &Vector<D>,
    half_space: &HalfSpace<D>,
    face: usize,
    fraction: f64,
) -> f64 {
    let (axis, upper) = (face / 2, face % 2 == 1);
    let thickness = fraction.clamp(0.0, 1.0);
    let mut m = half_space.normal.component_mul(lengths);
    let lowest: f64 = m.iter().map(|m| m.min(0.0)).sum();
    let mut depth = half_space.constant - lowest;
    if upper == (m[axis] > 0.0) {
        depth -= m[axis].abs() * (1.0 - thickness);
    }
    m[axis] *= thickness;
    thickness * UnitCube::new(m.as_slice()).volume(depth).value
}
