//! Advection of quantities at the nodes, such as velocities (Sect. 4.7 of the paper), over any scheme for cell means.
//!
//! Node values become cell means, these are moved by [`crate::volume_associated`], and the node values are put together again with the
//! volumes or masses of the cells, of which each node has `1 / 2^D`:
//!
//! ```text
//! Phi+ = sum over the cells around the node of phi+ M+ / sum of M+          (Eq. 76)
//! ```
//!
//! With [`NodalScheme::HalfIndexShift`] every node of a cell becomes a cell quantity of its own; with [`NodalScheme::Averaging`] there is but
//! one, the mean of the nodes, so that values spread even where nothing moves. Both keep the sum of `Phi` times nodal mass.

use crate::mesh::Grid;
use crate::parallel;
use crate::volume_associated::points::{corner, count};

/// How node values become cell means and back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NodalScheme {
    /// One cell quantity for each node of a cell (HIS; Benson 1992): as accurate and monotone as the scheme that moves them.
    #[default]
    HalfIndexShift,
    /// The mean of the nodes of a cell (SALE; Amsden, Ruppel & Hirt 1980): diffusive, there to be compared with.
    Averaging,
}

impl NodalScheme {
    /// The number of cell quantities for one quantity at the nodes.
    pub fn quantities(self, dimension: usize) -> usize {
        match self {
            Self::HalfIndexShift => count(dimension),
            Self::Averaging => 1,
        }
    }

    /// The cell quantities of node values (the projection of Eq. 75).
    pub fn to_cells<const D: usize>(self, grid: &Grid<D>, nodes: &[f64]) -> Vec<Vec<f64>> {
        let at_corner = |cell: usize, number: usize| {
            let (at, corner) = (grid.offset(cell), corner::<D>(number));
            nodes[grid.node_index(std::array::from_fn(|axis| at[axis] + corner[axis]))]
        };
        match self {
            Self::HalfIndexShift => (0..count(D))
                .map(|number| parallel::map(grid.len(), |cell| at_corner(cell, number)))
                .collect(),
            Self::Averaging => {
                let mean =
                    |cell| (0..count(D)).map(|number| at_corner(cell, number)).sum::<f64>() / count(D) as f64;
                vec![parallel::map(grid.len(), mean)]
            }
        }
    }

    /// Puts node values together from cell quantities and the volumes or masses of the cells. Nodes without any keep their values.
    pub fn to_nodes<const D: usize>(
        self,
        grid: &Grid<D>,
        cells: &[Vec<f64>],
        amounts: &[f64],
        nodes: &mut [f64],
    ) {
        let old: &[f64] = nodes;
        let new = parallel::map(old.len(), |node| {
            let (mut amount, mut sum) = (0.0, 0.0);
            for (number, cell) in grid.around_node(node) {
                amount += amounts[cell];
                sum += amounts[cell] * cells[number % cells.len()][cell];
            }
            if amount > 0.0 { sum / amount } else { old[node] }
        });
        nodes.copy_from_slice(&new);
    }
}

/// The volumes or masses of the nodes: `1 / 2^D` of those of the cells around them. At joined ends a node and its image have
/// all of it, once each.
pub fn nodal_amounts<const D: usize>(grid: &Grid<D>, amounts: &[f64]) -> Vec<f64> {
    parallel::map(grid.node_count(), |node| {
        grid.around_node(node).map(|(_, cell)| amounts[cell]).sum::<f64>() / count(D) as f64
    })
}

/// `sum Phi M` over the nodes, those at joined ends once.
pub fn nodal_integral<const D: usize>(grid: &Grid<D>, nodes: &[f64], amounts: &[f64]) -> f64 {
    let masses = nodal_amounts(grid, amounts);
    parallel::sum(nodes.len(), |node| {
        let at = grid.node_offset(node);
        let is_image = (0..D).any(|axis| grid.periodic()[axis] && at[axis] == grid.cells()[axis]);
        if is_image { 0.0 } else { nodes[node] * masses[node] }
    })
}
