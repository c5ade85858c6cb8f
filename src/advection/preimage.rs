//! Where the content of a cell comes from: its pre-image, the cell traced back over the step.
//!
//! The nodes are traced by the classical Runge-Kutta method through the steady field, whose duration is the integral of its
//! amplitude, or, where the velocity is given at the nodes, to second order in time. Each face then is a fan from one added point to the traced edges (2D: two segments). The added point starts in
//! the mean of the traced nodes, where the fan encloses what the ruled face does, and moves along the area vector `A` of
//! the traced face until the region between the face and its fan has the flux volume `phi`: moving it by `s A` changes that by
//! `-s |A|^2 / D`, so
//!
//! ```text
//! s = D (V - phi) / |A|^2
//! ```
//!
//! with the volume `V` between the face and its ruled pre-image. Both cells of a face find the same point. So the pre-images fill
//! the mesh, and each has the volume of its cell less the sum of its fluxes: its own volume again.

use vofkit_geometry::clip::{Region, Tile};
use vofkit_geometry::{Cell, Vector};

use super::places::Places;
use crate::interface::RegionOf;
use crate::mesh::{Grid, Mesh};
use crate::parallel;
use crate::tolerance::FACE_COLLAPSED;

/// How far the nodes of some cells have come in a step.
#[derive(Clone, Debug)]
pub(super) struct Traces<const D: usize> {
    nodes: Places,
    /// By place in `nodes`.
    displacements: Vec<Vector<D>>,
}

impl<const D: usize> Traces<D> {
    pub(super) fn new(nodes: usize) -> Self {
        Self { nodes: Places::new(nodes), displacements: Vec::new() }
    }

    /// Traces the nodes of some cells back.
    pub(super) fn trace<C: Cell<D>>(
        &mut self,
        mesh: &Mesh<C, D>,
        displacement: &(dyn Fn(usize) -> Vector<D> + Sync),
        cells: &[u32],
    ) {
        self.nodes.clear();
        let grid = mesh.grid();
        for &cell in cells {
            let offset = grid.offset(cell as usize);
            for corner in C::OFFSETS {
                self.nodes.insert(corner_node(grid, offset, corner));
            }
        }
        let nodes = self.nodes.items();
        self.displacements = parallel::map(nodes.len(), |i| displacement(nodes[i] as usize));
    }

    /// The nodes of a traced cell relative to its first one, in node order: where they are, and where they come from.
    pub(super) fn nodes<C: Cell<D>>(&self, mesh: &Mesh<C, D>, offset: [usize; D]) -> [[Vector<D>; 8]; 2] {
        let grid = mesh.grid();
        let origin = mesh.nodes()[grid.node_index(offset)];
        let [mut now, mut before] = [[Vector::zeros(); 8]; 2];
        for (i, corner) in C::OFFSETS.iter().enumerate() {
            let node = corner_node(grid, offset, corner);
            now[i] = mesh.nodes()[node] - origin;
            let place = self.nodes.of(node).expect("the nodes of the band were traced");
            before[i] = now[i] - self.displacements[place];
        }
        [now, before]
    }
}

/// The node at a corner of the cell at an offset.
pub(super) fn corner_node<const D: usize>(grid: &Grid<D>, offset: [usize; D], corner: &[usize; D]) -> usize {
    grid.node_index(std::array::from_fn(|k| offset[k] + corner[k]))
}

/// A traced face, its nodes in outward order: where they are, and where they come from, with the added point.
#[derive(Clone, Copy, Debug)]
pub(super) struct TracedFace<const D: usize> {
    pub(super) now: [Vector<D>; 4],
    pub(super) before: [Vector<D>; 4],
    pub(super) middle: Vector<D>,
}

impl<const D: usize> Default for TracedFace<D> {
    fn default() -> Self {
        Self { now: [Vector::zeros(); 4], before: [Vector::zeros(); 4], middle: Vector::zeros() }
    }
}

impl<const D: usize> TracedFace<D> {
    /// A face of a cell through which the volume `flux` leaves the cell; without one, what the face sweeps does.
    pub(super) fn new<C: Cell<D>>(
        [now, before]: &[[Vector<D>; 8]; 2],
        face: usize,
        flux: Option<f64>,
    ) -> Self {
        let index = C::FACE_NODES[face];
        let pick = |nodes: &[Vector<D>; 8]| {
            let mut picked = [Vector::zeros(); 4];
            for (x, &i) in picked.iter_mut().zip(index) {
                *x = nodes[i];
            }
            picked
        };
        let (now, before) = (pick(now), pick(before));
        let (front, back) = (&now[..index.len()], &before[..index.len()]);
        let mean = back.iter().sum::<Vector<D>>() / index.len() as f64;
        let Some(flux) = flux else { return Self { now, before, middle: mean } };
        let area = C::area_vector(back);
        let square = area.norm_squared();
        let extent = back.iter().map(|x| (x - back[0]).amax()).fold(0.0, f64::max);
        // A collapsed face lets nothing through.
        let middle = if square.sqrt() > FACE_COLLAPSED * extent.powi(D as i32 - 1) {
            let excess = C::swept(back, front).volume() - flux;
            mean + area * (D as f64 * excess / square)
        } else {
            mean
        };
        Self { now, before, middle }
    }

    /// The region that the face swept; it counts positive where volume left the cell.
    pub(super) fn swept<C: Cell<D>>(&self) -> RegionOf<C, D> {
        let count = C::FACE_NODES[0].len();
        let swept = C::swept(&self.before[..count], &self.now[..count]);
        let mut middles = C::Tile::middles(&swept);
        middles[C::SWEPT_BACK] = self.middle;
        Region::fans(swept.nodes(), &middles[..C::FACES])
    }
}

/// The pre-image of a cell: its traced nodes and faces, relative to its first node.
pub(super) fn preimage<C: Cell<D>, const D: usize>(
    nodes: &[[Vector<D>; 8]; 2],
    faces: &[TracedFace<D>],
) -> RegionOf<C, D> {
    let mut middles = [Vector::zeros(); 6];
    for (middle, face) in middles.iter_mut().zip(faces) {
        *middle = face.middle;
    }
    Region::fans(&nodes[1][..C::OFFSETS.len()], &middles[..faces.len()])
}
