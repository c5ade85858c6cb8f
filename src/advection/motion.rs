//! The volumes that the sweeps of a step move through the faces, and the regions that they come from.
//!
//! Along *logical* axes a sweep uses the whole flux of two opposite faces, and the swept region is the slab of the donor cell
//! that holds the fraction `phi / V*` of its volume. Along *Cartesian* axes (the paper's) a sweep moves every face by one
//! component of the displacement: its flux volume is split into component fluxes
//!
//! ```text
//! phi_k = u_k S_k + (phi - sum_j u_j S_j) S_k^2 / |S|^2,   sum_k phi_k = phi
//! ```
//!
//! with the mean nodal displacement `u` and the area vector `S` of the face (Eq. 27), and the swept region lies between the face and the face
//! traced back by that component, its depth scaled until its volume is the wanted one.

use vofkit_geometry::{Cell, Vector};

use super::boundary::{Boundary, End};
use crate::mesh::Mesh;
use crate::parallel;
use crate::space::{planar, spatial};
use crate::tolerance::SWEPT_VOLUME_RATIO;
use crate::velocity::{Field, StepFluxes};

/// Velocities and accelerations at the nodes, for tracing them back.
#[derive(Clone, Debug)]
pub(super) struct NodalMotion<const D: usize> {
    velocity: Vec<Vector<D>>,
    acceleration: Vec<Vector<D>>,
}

impl<const D: usize> NodalMotion<D> {
    pub(super) fn new<C: Cell<D>>(mesh: &Mesh<C, D>, field: &Field) -> Self {
        let nodes = mesh.nodes();
        let at_node = |value: &(dyn Fn(&Vector<3>) -> Vector<3> + Sync)| {
            parallel::map(nodes.len(), |i| planar(&value(&spatial(&nodes[i]))))
        };
        Self { velocity: at_node(&|x| field.velocity(x)), acceleration: at_node(&|x| field.acceleration(x)) }
    }

    /// How far a node has come in the step: `T u - T^2/2 (u.grad) u`, second order in the duration `T`. The node came
    /// from its place minus this.
    fn displacement(&self, node: usize, duration: f64) -> Vector<D> {
        (self.velocity[node] - self.acceleration[node] * (0.5 * duration)) * duration
    }
}

/// The volumes that leave a cell, by the axis of the sweep and by face; negative where they enter.
pub(super) type Outward<const D: usize> = [[f64; 6]; D];

/// The motion of one step.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a, C, const D: usize> {
    pub(super) mesh: &'a Mesh<C, D>,
    pub(super) boundary: &'a Boundary<D>,
    pub(super) fluxes: StepFluxes<'a, D>,
    /// The axes of the sweeps, in order.
    pub(super) order: [usize; D],
    /// For Cartesian sweeps; without it the sweeps run along mesh lines.
    pub(super) nodes: Option<&'a NodalMotion<D>>,
}

impl<C: Cell<D>, const D: usize> Motion<'_, C, D> {
    /// The faces that a sweep along an axis can move volume through.
    pub(super) fn faces(&self, axis: usize) -> std::ops::Range<usize> {
        if self.nodes.is_some() { 0..C::FACES } else { 2 * axis..2 * axis + 2 }
    }

    /// What leaves the cell at `offset` in each of the sweeps.
    pub(super) fn outward(&self, offset: [usize; D]) -> Outward<D> {
        let grid = self.mesh.grid();
        let mut outward = [[0.0; 6]; D];
        for face in 0..C::FACES {
            let (axis, side) = (face / 2, face % 2);
            let last = if side == 1 { grid.cells()[axis] - 1 } else { 0 };
            let at_end = offset[axis] == last && !grid.periodic()[axis];
            if at_end && self.boundary.ends[axis][side] == End::Wall {
                continue;
            }
            let sign = if side == 1 { 1.0 } else { -1.0 };
            let whole = self.fluxes.through(offset, axis, side);
            match self.nodes {
                None => outward[axis][face] = sign * whole,
                Some(nodes) => {
                    let parts = self.components(nodes, offset, axis, side, whole);
                    for (sweep, part) in outward.iter_mut().zip(parts) {
                        sweep[face] = sign * part;
                    }
                }
            }
        }
        outward
    }

    /// The flux towards higher indices through a face, split by the axes of the displacement; the last sweep takes
    /// what the others leave.
    fn components(
        &self,
        nodes: &NodalMotion<D>,
        mut offset: [usize; D],
        axis: usize,
        side: usize,
        whole: f64,
    ) -> [f64; D] {
        let grid = self.mesh.grid();
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
            *corner = self.mesh.nodes()[node];
            mean += nodes.displacement(node, self.fluxes.duration());
        }
        mean /= index.len() as f64;
        let area = -C::area_vector(&corners[..index.len()]);
        let rest = (whole - mean.dot(&area)) / area.norm_squared();
        let mut parts = [0.0; D];
        let (last, others) = self.order.split_last().expect("there is at least one axis");
        let mut left = whole;
        for &k in others {
            parts[k] = self.fluxes.round(mean[k] * area[k] + rest * area[k] * area[k]);
            left -= parts[k];
        }
        parts[*last] = left;
        parts
    }

    /// The region behind `face` with the wanted volume, in the local coordinates of its donor `cell` at `offset`.
    pub(super) fn region(&self, axis: usize, cell: &C, offset: [usize; D], face: usize, wanted: f64) -> C {
        let Some(nodes) = self.nodes else {
            return cell.slab(face, wanted / cell.volume());
        };
        let index = C::FACE_NODES[face];
        let mut front = [Vector::<D>::zeros(); 4];
        let mut depth = [0.0; 4];
        for (i, &corner) in index.iter().enumerate() {
            let node =
                self.mesh.grid().node_index(std::array::from_fn(|k| offset[k] + C::OFFSETS[corner][k]));
            front[i] = cell.nodes()[corner];
            depth[i] = nodes.displacement(node, self.fluxes.duration())[axis];
        }
        let front = &front[..index.len()];
        let traced = |depth: [f64; 4]| {
            let mut back = [Vector::<D>::zeros(); 4];
            for (i, back) in back[..front.len()].iter_mut().enumerate() {
                *back = front[i];
                back[axis] -= depth[i];
            }
            C::swept(&back[..front.len()], front)
        };
        // Displacements along one direction: the volume is exactly linear in their scale.
        let ratio = wanted / traced(depth).volume();
        if (SWEPT_VOLUME_RATIO.recip()..=SWEPT_VOLUME_RATIO).contains(&ratio) {
            traced(depth.map(|depth| ratio * depth))
        } else {
            traced([wanted / C::area_vector(front)[axis]; 4])
        }
    }
}
