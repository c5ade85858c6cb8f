//! One value for each face of a mesh, and the flux of nodal velocities through a face.

use vofkit_geometry::{Cell, Vector};

use crate::mesh::{Grid, Mesh};
use crate::parallel;
use crate::space::spatial;

/// One value for each face of a mesh, counted towards higher indices; the two ends of a joined axis are one face.
#[derive(Clone, Debug)]
pub(super) struct Faces<const D: usize> {
    grid: Grid<D>,
    /// By the axis that the faces lie across; the first axis of their offsets runs fastest.
    values: [Vec<f64>; D],
}

/// A face: the axis that it lies across, and the offset of the cell above it, which beyond the upper end there is none of.
pub(super) type Face<const D: usize> = (usize, [usize; D]);

/// Layers of faces across each axis in the numbering of those across `axis`.
fn extent<const D: usize>(grid: &Grid<D>, axis: usize) -> [usize; D] {
    let mut extent = grid.cells();
    extent[axis] += usize::from(!grid.periodic()[axis]);
    extent
}

impl<const D: usize> Faces<D> {
    /// The value that `of_face` has for each face.
    pub(super) fn new(grid: &Grid<D>, of_face: impl Fn(Face<D>) -> f64 + Sync + Send) -> Self {
        let values = std::array::from_fn(|axis| {
            let extent = Grid::new(extent(grid, axis), [false; D]);
            parallel::map(extent.len(), |index| of_face((axis, extent.offset(index))))
        });
        Self { grid: grid.clone(), values }
    }

    /// The value of face `2 axis + side` of the cell at `offset`.
    #[inline]
    pub(super) fn of_cell(&self, mut offset: [usize; D], axis: usize, side: usize) -> f64 {
        let extent = extent(&self.grid, axis);
        offset[axis] = (offset[axis] + side) % extent[axis];
        self.values[axis][index(extent, offset)]
    }

    /// The value of a face.
    pub(super) fn of_face(&self, (axis, offset): Face<D>) -> f64 {
        self.values[axis][index(extent(&self.grid, axis), offset)]
    }

    /// Calls `change` with every face and its value.
    pub(super) fn change(&mut self, mut change: impl FnMut(Face<D>, &mut f64)) {
        for (axis, values) in self.values.iter_mut().enumerate() {
            let extent = Grid::new(extent(&self.grid, axis), [false; D]);
            for (index, value) in values.iter_mut().enumerate() {
                change((axis, extent.offset(index)), value);
            }
        }
    }

    /// The largest value, without sign; NaN if any is.
    pub(super) fn largest(&self) -> f64 {
        self.values.iter().flatten().fold(0.0, |largest: f64, value| {
            // Not `max`, which drops NaN.
            if value.abs() <= largest { largest } else { value.abs() }
        })
    }

    /// The sum over the faces of the cell at `offset` of what leaves it, and half of the sum without signs.
    pub(super) fn balance(&self, offset: [usize; D]) -> [f64; 2] {
        let (mut net, mut through) = (0.0, 0.0);
        for axis in 0..D {
            let [low, high] = [0, 1].map(|side| self.of_cell(offset, axis, side));
            net += high - low;
            through += 0.5 * (high.abs() + low.abs());
        }
        [net, through]
    }
}

fn index<const D: usize>(extent: [usize; D], offset: [usize; D]) -> usize {
    (0..D).rev().fold(0, |index, axis| index * extent[axis] + offset[axis])
}

/// The cell next to a face, by its side of the face (0 below, 1 above); none beyond the ends of the mesh.
pub(super) fn beside<const D: usize>(
    grid: &Grid<D>,
    (axis, mut offset): Face<D>,
    side: usize,
) -> Option<[usize; D]> {
    let n = grid.cells()[axis];
    match (side, offset[axis]) {
        (0, 0) if !grid.periodic()[axis] => return None,
        (0, at) => offset[axis] = (at + n - 1) % n,
        (_, at) if at == n => return None,
        _ => {}
    }
    Some(offset)
}

/// The nodes of a face, in an order that turns about the direction towards higher indices, and how many there are.
pub(super) fn nodes<C: Cell<D>, const D: usize>(
    grid: &Grid<D>,
    (axis, offset): Face<D>,
) -> ([usize; 4], usize) {
    // The lower face of the cell above it, whose outward order turns the other way.
    let corners = C::FACE_NODES[2 * axis];
    let mut nodes = [0; 4];
    for (node, &corner) in nodes.iter_mut().zip(corners.iter().rev()) {
        *node = grid.node_index(std::array::from_fn(|k| offset[k] + C::OFFSETS[corner][k]));
    }
    (nodes, corners.len())
}

/// The area vector of a face, towards higher indices.
pub(super) fn area<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, face: Face<D>) -> Vector<D> {
    let (nodes, count) = nodes::<C, D>(mesh.grid(), face);
    C::area_vector(&nodes.map(|node| mesh.nodes()[node])[..count])
}

/// The volume per time that crosses a face towards higher indices, if the velocity is linear along mesh lines between the nodes: the
/// exact integral over the straight or ruled face.
///
/// In two dimensions the mean velocity times the area vector. In three, with the velocities `u_i` at the corners `x_i` and the normals
/// `n_j = (x_j+1 - x_j) x (x_j-1 - x_j)` there, between which the normal of a ruled face is linear,
///
/// ```text
/// F = sum_ij M_ij u_i . n_j,   M = 1/9 for i = j, 1/18 for neighbours, 1/36 for opposite corners
/// ```
pub(super) fn flux<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocities: &[Vector<D>],
    face: Face<D>,
) -> f64 {
    let (nodes, count) = nodes::<C, D>(mesh.grid(), face);
    let velocity = |i: usize| velocities[nodes[i]];
    if count == 2 {
        return area(mesh, face).dot(&((velocity(0) + velocity(1)) * 0.5));
    }
    let edge = |from: usize, to: usize| spatial(&(mesh.nodes()[nodes[to]] - mesh.nodes()[nodes[from]]));
    let mut flux = 0.0;
    for j in 0..4 {
        let [next, opposite, last] = [1, 2, 3].map(|step| (j + step) % 4);
        let normal = edge(j, next).cross(&edge(j, last));
        let mean = velocity(j) * 4.0 + (velocity(next) + velocity(last)) * 2.0 + velocity(opposite);
        flux += normal.dot(&spatial(&mean));
    }
    flux / 36.0
}
