//! Face fluxes made free of divergence by the smallest change.
//!
//! Of all changes `dF` that cancel the divergence of every cell, the one with the least `sum dF^2 / w` over the faces is a difference of a
//! pressure across each face (Chorin 1968),
//!
//! ```text
//! dF = w (p_above - p_below),   w = area / distance,   A p = sum of the fluxes out of each cell
//! ```
//!
//! with the graph Laplacian `A` of the cells, whose edges are the faces with weights `w`. Faces at the ends of the mesh that nothing but
//! rounding crosses stay as they are (`w = 0`); beyond open ones the pressure is 0. The system is solved by conjugate gradients with the diagonal as preconditioner,
//! again for what rounding left of the divergence, until nothing but rounding is left.

use nalgebra::DVector;
use nalgebra_sparse::{CooMatrix, CsrMatrix};
use vofkit_geometry::{Cell, Vector};

use super::faces::{Face, Faces, area, beside, nodes};
use crate::mesh::Mesh;
use crate::tolerance::{
    PROJECTION_ITERATIONS, PROJECTION_REDUCTION, PROJECTION_RESIDUAL, PROJECTION_ROUNDING, PROJECTION_ROUNDS,
    WALL_ROUNDING,
};

/// Makes the fluxes free of divergence.
///
/// # Errors
/// The iterations, and the largest sum of the fluxes of a cell relative to the largest flux, where that is more than rounding.
pub(super) fn project<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fluxes: &mut Faces<D>,
) -> Result<(), (usize, f64)> {
    let largest = fluxes.largest();
    if largest == 0.0 {
        return Ok(());
    }
    let grid = mesh.grid();
    let system = System::new(mesh, fluxes, WALL_ROUNDING * largest);
    let (mut iterations, mut before) = (0, f64::INFINITY);
    for round in 0..=PROJECTION_ROUNDS {
        let sums = (0..grid.len()).map(|cell| fluxes.balance(grid.offset(cell))[0]);
        let sums = DVector::from_iterator(grid.len(), sums);
        let residual = sums.amax() / largest;
        let stands = round == PROJECTION_ROUNDS || !(residual <= 0.5 * before);
        if residual <= PROJECTION_ROUNDING || residual <= PROJECTION_RESIDUAL && stands {
            return Ok(());
        }
        if stands {
            return Err((iterations, residual));
        }
        before = residual;
        let (pressure, count) = system.solve(sums);
        iterations += count;
        let at = |cell: Option<[usize; D]>| cell.map_or(0.0, |cell| pressure[grid.index(cell)]);
        fluxes.change(|face, flux| {
            let [below, above] = [0, 1].map(|side| beside(grid, face, side));
            *flux += system.weights.of_face(face) * (at(above) - at(below));
        });
    }
    Err((iterations, before))
}

/// The graph Laplacian.
struct System<const D: usize> {
    matrix: CsrMatrix<f64>,
    diagonal: DVector<f64>,
    weights: Faces<D>,
    /// Whether nothing leaves the mesh: the pressure is then known but for a constant.
    is_closed: bool,
}

impl<const D: usize> System<D> {
    /// Faces at the ends of the mesh whose flux is at most `closed` stay as they are.
    fn new<C: Cell<D>>(mesh: &Mesh<C, D>, fluxes: &Faces<D>, closed: f64) -> Self {
        let grid = mesh.grid();
        let mut weights = Faces::new(grid, |face| {
            let is_end = [0, 1].iter().any(|&side| beside(grid, face, side).is_none());
            if is_end && fluxes.of_face(face).abs() <= closed { 0.0 } else { weight(mesh, face) }
        });
        let mut matrix = CooMatrix::new(grid.len(), grid.len());
        let mut diagonal = DVector::zeros(grid.len());
        let mut is_closed = true;
        weights.change(|face, &mut weight| {
            let cells = [0, 1].map(|side| beside(grid, face, side).map(|cell| grid.index(cell)));
            match cells {
                [Some(a), Some(b)] => {
                    for (row, column, value) in
                        [(a, a, weight), (b, b, weight), (a, b, -weight), (b, a, -weight)]
                    {
                        matrix.push(row, column, value);
                    }
                    // A cell that is its own neighbour at joined ends gains nothing.
                    if a != b {
                        diagonal[a] += weight;
                        diagonal[b] += weight;
                    }
                }
                [Some(cell), None] | [None, Some(cell)] => {
                    is_closed &= weight == 0.0;
                    matrix.push(cell, cell, weight);
                    diagonal[cell] += weight;
                }
                [None, None] => {}
            }
        });
        Self { matrix: CsrMatrix::from(&matrix), diagonal, weights, is_closed }
    }

    /// The pressures for these sums of fluxes, by preconditioned conjugate gradients (Hestenes & Stiefel 1952), and the iterations.
    fn solve(&self, sums: DVector<f64>) -> (DVector<f64>, usize) {
        let preconditioned = |residual: &DVector<f64>| {
            residual.zip_map(&self.diagonal, |r, d| if d > 0.0 { r / d } else { 0.0 })
        };
        let mut pressure = DVector::zeros(sums.len());
        let mut residual = self.settled(sums);
        let goal = PROJECTION_REDUCTION * residual.norm();
        let mut scaled = preconditioned(&residual);
        let mut direction = scaled.clone();
        let mut product = residual.dot(&scaled);
        for iteration in 0..PROJECTION_ITERATIONS {
            if residual.norm() <= goal {
                return (pressure, iteration);
            }
            let image = &self.matrix * &direction;
            let curvature = direction.dot(&image);
            if !(curvature > 0.0) {
                return (pressure, iteration);
            }
            let step = product / curvature;
            pressure.axpy(step, &direction, 1.0);
            residual.axpy(-step, &image, 1.0);
            scaled = preconditioned(&residual);
            let next = residual.dot(&scaled);
            direction = &scaled + direction * (next / product);
            product = next;
        }
        (pressure, PROJECTION_ITERATIONS)
    }

    /// Without the rounding of a closed mesh, whose sums add up to nothing.
    fn settled(&self, sums: DVector<f64>) -> DVector<f64> {
        if self.is_closed { sums.add_scalar(-sums.mean()) } else { sums }
    }
}

/// The area of a face over the distance between the middles of its cells by way of its own middle.
fn weight<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, face: Face<D>) -> f64 {
    let grid = mesh.grid();
    let distance = |side: usize| {
        let Some(cell) = beside(grid, face, side) else { return 0.0 };
        // At joined ends the face of the cell below is at the other end.
        let mut own = face;
        own.1[face.0] = cell[face.0] + 1 - side;
        let (corners, count) = nodes::<C, D>(grid, own);
        let middle =
            corners[..count].iter().map(|&node| mesh.nodes()[node]).sum::<Vector<D>>() / count as f64;
        (mesh.cell(grid.index(cell)).map(&Vector::repeat(0.5)) - middle).norm()
    };
    let distance = distance(0) + distance(1);
    if distance > 0.0 { area(mesh, face).norm() / distance } else { 0.0 }
}
