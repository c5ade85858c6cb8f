//! The volumes that one sweep moves through the faces, and the regions that they come from.
//!
//! Along *logical* axes a sweep uses the whole flux of two opposite faces, and the swept region is the slab of the donor cell
//! that holds the fraction `flux / V*` of its volume. Along *Cartesian* axes (the paper's) a sweep moves every face by one
//! component of the displacement: its flux volume is split into component fluxes
//!
//! ```text
//! phi_k = u_k S_k + (phi - sum_j u_j S_j) S_k^2 / |S|^2,   sum_k phi_k = phi
//! ```
//!
//! with the mean nodal displacement `u` and the area vector `S` of the face (Eq. 27), and the swept region lies between the face and the face
//! traced back by that component, its depth scaled until its volume is the wanted one.

use vofkit_geometry::{Cell, Vector};

use crate::mesh::Mesh;
use crate::parallel;
use crate::tolerance::SWEPT_VOLUME_RATIO;
use crate::velocity::{Field, StepFluxes};

/// Velocities and accelerations at the nodes, for tracing them back.
#[derive(Clone, Debug)]
pub(super) struct NodalMotion<const D: usize> {
    velocity: Vec<Vector<D>>,
    acceleration: Vec<Vector<D>>,
}

fn truncated<const D: usize>(v: &Vector<3>) -> Vector<D> {
    Vector::from_fn(|k, _| v[k])
}

impl<const D: usize> NodalMotion<D> {
    pub(super) fn new<C: Cell<D>>(mesh: &Mesh<C, D>, field: &Field) -> Self {
        let nodes = mesh.nodes();
        let at = |i: usize| Vector::<3>::from_fn(|k, _| if k < D { nodes[i][k] } else { 0.0 });
        Self {
            velocity: parallel::map(nodes.len(), |i| truncated(&field.velocity(&at(i)))),
            acceleration: parallel::map(nodes.len(), |i| truncated(&field.acceleration(&at(i)))),
        }
    }

    /// How far a node has come in the step: `T u - T^2/2 (u.grad) u`, second order in the duration `T`. The node came
    /// from its place minus this.
    fn displacement(&self, node: usize, duration: f64) -> Vector<D> {
        (self.velocity[node] - self.acceleration[node] * (0.5 * duration)) * duration
    }
}

/// One sweep over a mesh: which part of the step's fluxes it moves.
#[derive(Clone, Copy)]
pub(super) struct Sweep<'a, C, const D: usize> {
    pub(super) mesh: &'a Mesh<C, D>,
    pub(super) fluxes: StepFluxes<'a, D>,
    pub(super) axis: usize,
    /// For Cartesian sweeps; without it the sweep runs along mesh lines.
    pub(super) cartesian: Option<Cartesian<'a, D>>,
}

/// What a Cartesian sweep needs besides.
#[derive(Clone, Copy)]
pub(super) struct Cartesian<'a, const D: usize> {
    pub(super) nodes: &'a NodalMotion<D>,
    /// In the last sweep of a step the axes of those before it: it takes what they left of every flux.
    pub(super) taken: Option<&'a [usize]>,
}

impl<C: Cell<D>, const D: usize> Sweep<'_, C, D> {
    /// The faces that the sweep can move volume through.
    pub(super) fn faces(&self) -> std::ops::Range<usize> {
        if self.cartesian.is_some() { 0..C::FACES } else { 2 * self.axis..2 * self.axis + 2 }
    }

    /// The volume that leaves the cell at `offset` through `face`; negative where it enters.
    pub(super) fn outward(&self, offset: [usize; D], face: usize) -> f64 {
        let (axis, side) = (face / 2, face % 2);
        let whole = self.fluxes.through(offset, axis, side);
        let flux = match &self.cartesian {
            None => whole,
            Some(cartesian) => self.component(cartesian, offset, axis, side, whole),
        };
        if side == 1 { flux } else { -flux }
    }

    /// The part of the flux towards higher indices through a face that belongs to this sweep's component.
    fn component(
        &self,
        cartesian: &Cartesian<'_, D>,
        mut offset: [usize; D],
        axis: usize,
        side: usize,
        whole: f64,
    ) -> f64 {
        let grid = self.mesh.grid();
        // Both cells of a face must split it alike: periodic images count as the first layer.
        let mut side = side;
        if side == 0 && offset[axis] > 0 {
            offset[axis] -= 1;
            side = 1;
        } else if side == 1 && grid.periodic()[axis] && offset[axis] + 1 == grid.cells()[axis] {
            offset[axis] = 0;
            side = 0;
        }
        let face = 2 * axis + side;
        let cell = self.mesh.local_cell(grid.index(offset));
        let sign = if side == 1 { 1.0 } else { -1.0 };
        let area = cell.face_area(face) * sign;
        let nodes = C::FACE_NODES[face];
        let mean = nodes.iter().map(|&i| self.displacement(cartesian, offset, i)).sum::<Vector<D>>()
            / nodes.len() as f64;
        let rest = whole - mean.dot(&area);
        let part =
            |k: usize| self.fluxes.round(mean[k] * area[k] + rest * area[k] * area[k] / area.norm_squared());
        match cartesian.taken {
            None => part(self.axis),
            Some(axes) => axes.iter().fold(whole, |left, &k| left - part(k)),
        }
    }

    fn displacement(&self, cartesian: &Cartesian<'_, D>, offset: [usize; D], node: usize) -> Vector<D> {
        let corner = C::OFFSETS[node];
        let at = std::array::from_fn(|k| offset[k] + corner[k]);
        cartesian.nodes.displacement(self.mesh.grid().node_index(at), self.fluxes.duration())
    }

    /// The region behind `face` with the wanted volume, in the local coordinates of its donor `cell` at `offset`.
    pub(super) fn region(&self, cell: &C, offset: [usize; D], face: usize, wanted: f64) -> C {
        let Some(cartesian) = &self.cartesian else {
            return cell.slab(face, wanted / cell.volume());
        };
        let index = C::FACE_NODES[face];
        let count = index.len();
        let mut front = [Vector::<D>::zeros(); 4];
        let mut back = front;
        for (i, &node) in index.iter().enumerate() {
            front[i] = cell.nodes()[node];
        }
        let mut trace = |depth: &dyn Fn(usize) -> f64| {
            for i in 0..count {
                back[i] = front[i];
                back[i][self.axis] -= depth(i);
            }
            C::swept(&back[..count], &front[..count])
        };
        let moved = |i: usize| self.displacement(cartesian, offset, index[i])[self.axis];
        // Displacements along one direction: the volume is exactly linear in their scale.
        let ratio = wanted / trace(&moved).volume();
        if (SWEPT_VOLUME_RATIO.recip()..=SWEPT_VOLUME_RATIO).contains(&ratio) {
            trace(&|i| ratio * moved(i))
        } else {
            let uniform = wanted / cell.face_area(face)[self.axis];
            trace(&|_| uniform)
        }
    }
}
