//! From integration points to nodes by least squares (Eq. 38): `sum_J V_IJ phi_J = R_I` with `V_IJ = int N_I N_J dv`.

use nalgebra::DMatrix;
use nalgebra_sparse::factorization::CscCholesky;
use nalgebra_sparse::{CooMatrix, CscMatrix};
use vofkit_geometry::{Cell, Vector};

use super::PointError;
use super::element::{Basis, CORNERS, Element};
use crate::mesh::{Grid, Mesh};
use crate::parallel;
use crate::volume_associated::points::count;

/// The volume matrix of the nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VolumeMatrix {
    /// Its row sums: explicit.
    #[default]
    Lumped,
    /// The matrix itself, by sparse Cholesky factors without reordering: their number grows with the cells of a layer times the nodes, so
    /// that this is for plane meshes and for small ones in space.
    Consistent,
}

/// The volume matrices of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Projection<const D: usize> {
    lumped: Vec<f64>,
    consistent: Option<Consistent>,
}

#[derive(Clone, Debug)]
struct Consistent {
    factors: CscCholesky<f64>,
    /// The row of each node; one for all that are the same at joined ends.
    row: Vec<usize>,
}

impl<const D: usize> Projection<D> {
    /// # Errors
    /// A cell that is folded at one of its integration points.
    pub(super) fn new<C: Cell<D>>(mesh: &Mesh<C, D>, points: &[Basis<D>]) -> Result<Self, PointError> {
        let grid = mesh.grid();
        let determinants = |cell: usize| {
            let element = Element::new(mesh, cell);
            let mut determinants = [0.0; CORNERS];
            for (value, point) in determinants.iter_mut().zip(points) {
                *value = element.frame(point).determinant;
            }
            determinants
        };
        let determinants = parallel::map(grid.len(), determinants);
        let least = |cell: usize| determinants[cell][..count(D)].iter().fold(f64::INFINITY, |a, &b| a.min(b));
        if let Some(cell) = (0..grid.len()).find(|&cell| !(least(cell) > 0.0)) {
            return Err(PointError::Folded { cell: grid.offset(cell).to_vec(), determinant: least(cell) });
        }
        let part = |cell: usize| {
            let mut part = [Vector::<1>::zeros(); CORNERS];
            for (point, determinant) in points.iter().zip(&determinants[cell]) {
                for number in 0..count(D) {
                    part[number][0] += determinant * point.values[number] / count(D) as f64;
                }
            }
            part
        };
        let parts = parallel::map(grid.len(), part);
        let mut sums = vec![Vector::<1>::zeros(); grid.node_count()];
        assemble(grid, &parts, &mut sums);
        Ok(Self { lumped: sums.iter().map(|sum| sum[0]).collect(), consistent: None })
    }

    /// Makes the factors of the consistent matrix, unless they are there.
    pub(super) fn factorize<C: Cell<D>>(
        &mut self,
        mesh: &Mesh<C, D>,
        points: &[Basis<D>],
    ) -> Result<(), PointError> {
        if self.consistent.is_some() {
            return Ok(());
        }
        let grid = mesh.grid();
        let unknowns = Grid::new(grid.unique_nodes(), [false; D]);
        let row = |node: usize| {
            let (at, extent) = (grid.node_offset(node), unknowns.cells());
            unknowns.index(std::array::from_fn(|axis| at[axis] % extent[axis]))
        };
        let row: Vec<usize> = (0..grid.node_count()).map(row).collect();
        let mut matrix = CooMatrix::new(unknowns.len(), unknowns.len());
        for cell in 0..grid.len() {
            let element = Element::new(mesh, cell);
            let mut entries = [[0.0; CORNERS]; CORNERS];
            for point in points {
                let weight = element.frame(point).determinant / count(D) as f64;
                for (i, of_row) in entries.iter_mut().enumerate() {
                    for (j, entry) in of_row.iter_mut().enumerate() {
                        *entry += weight * point.values[i] * point.values[j];
                    }
                }
            }
            for (i, &a) in element.nodes().iter().enumerate() {
                for (j, &b) in element.nodes().iter().enumerate() {
                    matrix.push(row[a], row[b], entries[i][j]);
                }
            }
        }
        let factors = CscCholesky::factor(&CscMatrix::from(&matrix)).map_err(|_| PointError::Matrix)?;
        self.consistent = Some(Consistent { factors, row });
        Ok(())
    }

    /// Turns right-hand sides into node values, with the consistent matrix where that was made and is asked for.
    pub(super) fn solve<const M: usize>(&self, matrix: VolumeMatrix, nodes: &mut [Vector<M>]) {
        let Some(Consistent { factors, row }) =
            self.consistent.as_ref().filter(|_| matrix == VolumeMatrix::Consistent)
        else {
            for (value, volume) in nodes.iter_mut().zip(&self.lumped) {
                *value /= *volume;
            }
            return;
        };
        let mut sides = DMatrix::<f64>::zeros(factors.l().nrows(), M);
        for (&row, value) in row.iter().zip(&*nodes) {
            (0..M).for_each(|k| sides[(row, k)] = value[k]);
        }
        factors.solve_mut(&mut sides);
        for (&row, value) in row.iter().zip(nodes) {
            *value = Vector::from_fn(|k, _| sides[(row, k)]);
        }
    }
}

/// Adds up at every node what the cells around it have for it; a node at a joined end gets the same as its image.
pub(super) fn assemble<const D: usize, const M: usize>(
    grid: &Grid<D>,
    parts: &[[Vector<M>; CORNERS]],
    nodes: &mut [Vector<M>],
) {
    let row = grid.cells()[0] + 1;
    parallel::for_each_chunk(nodes, row, |r, nodes| {
        for (i, node) in nodes.iter_mut().enumerate() {
            *node = grid.around_node(r * row + i).map(|(number, cell)| parts[cell][number]).sum();
        }
    });
}
