//! Where what is at a point comes from.

use nalgebra::Matrix3;
use vofkit_geometry::{Cell, Vector};

use super::Field;
use crate::mesh::Mesh;
use crate::parallel;
use crate::space::{planar, spatial};

/// How far a point has come while the steady field acted for `duration`: it came from its place minus this (classical Runge-Kutta).
pub(crate) fn displacement<const D: usize>(field: &Field, x: &Vector<D>, duration: f64) -> Vector<D> {
    let x = &spatial(x);
    let k1 = field.velocity(x);
    let k2 = field.velocity(&(x - k1 * (0.5 * duration)));
    let k3 = field.velocity(&(x - k2 * (0.5 * duration)));
    let k4 = field.velocity(&(x - k3 * duration));
    planar(&((k1 + (k2 + k3) * 2.0 + k4) * (duration / 6.0)))
}

/// Velocities and accelerations at the nodes, for tracing them back.
#[derive(Clone, Debug)]
pub(crate) struct NodalMotion<const D: usize> {
    velocity: Vec<Vector<D>>,
    acceleration: Vec<Vector<D>>,
}

impl<const D: usize> NodalMotion<D> {
    /// Those of a steady field.
    pub(crate) fn of_field<C: Cell<D>>(mesh: &Mesh<C, D>, field: &Field) -> Self {
        let nodes = mesh.nodes();
        let at_node = |value: &(dyn Fn(&Vector<3>) -> Vector<3> + Sync)| {
            parallel::map(nodes.len(), |i| planar(&value(&spatial(&nodes[i]))))
        };
        Self { velocity: at_node(&|x| field.velocity(x)), acceleration: at_node(&|x| field.acceleration(x)) }
    }

    /// Those of steady velocities at the nodes, with `(u . grad) u` from the cells around a node, each by its edges there and with the
    /// weight of the parallelepiped that they span.
    pub(super) fn of_nodes<C: Cell<D>>(mesh: &Mesh<C, D>, velocity: Vec<Vector<D>>) -> Self {
        let acceleration = parallel::map(velocity.len(), |node| acceleration(mesh, &velocity, node));
        Self { velocity, acceleration }
    }

    /// How far a node has come in the step: `T u - T^2/2 (u.grad) u`, second order in the duration `T`. The node came
    /// from its place minus this.
    pub(crate) fn displacement(&self, node: usize, duration: f64) -> Vector<D> {
        (self.velocity[node] - self.acceleration[node] * (0.5 * duration)) * duration
    }

    /// The velocity at a node.
    pub(crate) fn velocity(&self, node: usize) -> Vector<D> {
        self.velocity[node]
    }

    /// The acceleration at a node.
    pub(crate) fn acceleration(&self, node: usize) -> Vector<D> {
        self.acceleration[node]
    }
}

/// `(u . grad) u` at a node: nothing where all cells around it have collapsed.
fn acceleration<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    velocity: &[Vector<D>],
    node: usize,
) -> Vector<D> {
    let grid = mesh.grid();
    let (mut sum, mut weight) = (Vector::<D>::zeros(), 0.0);
    for (corner, cell) in grid.around_node(node) {
        let offset = grid.offset(cell);
        let at = |corner: usize| grid.node_index(std::array::from_fn(|k| offset[k] + (corner >> k & 1)));
        let here = at(corner);
        let neighbours: [usize; D] = std::array::from_fn(|axis| at(corner ^ 1 << axis));
        // In the plane the third edge is that of a prism of height 1.
        let mut edges = Matrix3::identity();
        for (axis, &next) in neighbours.iter().enumerate() {
            edges.set_column(axis, &spatial(&(mesh.nodes()[next] - mesh.nodes()[here])));
        }
        let volume = edges.determinant().abs();
        let Some(inverse) = edges.try_inverse().filter(|_| volume > 0.0) else { continue };
        let along = inverse * spatial(&velocity[here]);
        let change = |(&next, part): (&usize, &f64)| (velocity[next] - velocity[here]) * *part;
        let changes = neighbours.iter().zip(along.iter()).map(change);
        sum += changes.sum::<Vector<D>>() * volume;
        weight += volume;
    }
    if weight > 0.0 { sum / weight } else { Vector::zeros() }
}
