//! The multilinear functions of the corners of a cell, and what a cell makes of them.

use vofkit_geometry::{Cell, Vector};

use crate::mesh::Mesh;
use crate::space::{planar, spatial};
use crate::volume_associated::points::{corner, count, local};

/// The most corners that a cell has.
pub(super) const CORNERS: usize = 8;

/// The functions `N_I` of all corners and their logical derivatives at one point of the unit square or cube.
#[derive(Clone, Copy, Debug)]
pub(super) struct Basis<const D: usize> {
    pub(super) values: [f64; CORNERS],
    slopes: [Vector<D>; CORNERS],
}

impl<const D: usize> Basis<D> {
    pub(super) fn new(local: &Vector<D>) -> Self {
        let mut basis = Self { values: [0.0; CORNERS], slopes: [Vector::zeros(); CORNERS] };
        for number in 0..count(D) {
            let corner = corner::<D>(number);
            let factor = |axis: usize| if corner[axis] == 1 { local[axis] } else { 1.0 - local[axis] };
            let others = |axis: usize| (0..D).filter(|&k| k != axis).map(factor).product::<f64>();
            basis.values[number] = (0..D).map(factor).product();
            basis.slopes[number] =
                Vector::from_fn(|axis, _| if corner[axis] == 1 { others(axis) } else { -others(axis) });
        }
        basis
    }

    /// The functions at all integration points.
    pub(super) fn at_points() -> Vec<Self> {
        (0..count(D)).map(|number| Self::new(&local(number))).collect()
    }

    /// The functions at the two-point rule of a face; each point has the same share of the face.
    pub(super) fn at_face(axis: usize, side: usize) -> Vec<Self> {
        let on_face = |number: &usize| corner::<D>(*number)[axis] == side;
        let flattened = |number: usize| {
            let mut point = local::<D>(number);
            point[axis] = side as f64;
            Self::new(&point)
        };
        (0..count(D)).filter(on_face).map(flattened).collect()
    }
}

/// The corners of a cell, the first one at the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element<const D: usize> {
    nodes: [usize; CORNERS],
    corners: [Vector<D>; CORNERS],
}

impl<const D: usize> Element<D> {
    pub(super) fn new<C: Cell<D>>(mesh: &Mesh<C, D>, cell: usize) -> Self {
        let (grid, places) = (mesh.grid(), mesh.nodes());
        let at = grid.offset(cell);
        let mut element = Self { nodes: [0; CORNERS], corners: [Vector::zeros(); CORNERS] };
        for number in 0..count(D) {
            let corner = corner::<D>(number);
            let node = grid.node_index(std::array::from_fn(|axis| at[axis] + corner[axis]));
            element.nodes[number] = node;
            element.corners[number] = places[node] - places[element.nodes[0]];
        }
        element
    }

    /// The nodes, by the number of the corner.
    pub(super) fn nodes(&self) -> &[usize] {
        &self.nodes[..count(D)]
    }

    /// The shape of the cell at a point.
    pub(super) fn frame(&self, basis: &Basis<D>) -> Frame<D> {
        let mut edges = [Vector::<D>::zeros(); D];
        for number in 0..count(D) {
            for (axis, edge) in edges.iter_mut().enumerate() {
                *edge += self.corners[number] * basis.slopes[number][axis];
            }
        }
        // In two dimensions the third edge is the unit vector along z.
        let edge = |axis: usize| edges.get(axis).map_or(Vector::<3>::z(), spatial);
        let areas = std::array::from_fn(|axis| planar(&edge((axis + 1) % 3).cross(&edge((axis + 2) % 3))));
        Frame { areas, determinant: edges[0].dot(&areas[0]) }
    }
}

/// The derivative of the map of a cell at a point, as its determinant and its cofactors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<const D: usize> {
    /// By axis, `det J` times the gradient of the logical coordinate: the area vector of the surface where it is constant.
    pub(super) areas: [Vector<D>; D],
    /// `det J`.
    pub(super) determinant: f64,
}

impl<const D: usize> Frame<D> {
    /// `det J grad N_I`.
    pub(super) fn weighted_gradient(&self, basis: &Basis<D>, number: usize) -> Vector<D> {
        let slope = &basis.slopes[number];
        self.areas.iter().zip(slope.iter()).map(|(area, slope)| area * *slope).sum()
    }
}
