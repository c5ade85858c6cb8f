//! Schemes that solve the advection equation at the integration points (Sect. 4.2 and Eq. 57-59 of the paper): not conservative, not
//! monotone, there to be compared with those on face fluxes.
//!
//! - `element`: the functions of the corners of a cell; `projection`: from points to nodes;
//! - `direct` and `galerkin`: the two schemes; this file: a step of either.

mod direct;
mod element;
mod galerkin;
mod projection;

use vofkit_geometry::{Cell, Vector};

pub use direct::Smoothing;
pub use projection::VolumeMatrix;

use super::limiter::AlphaRange;
use super::points::count;
use crate::mesh::{Grid, Mesh};
use crate::parallel;
use element::{Basis, CORNERS, Element};
use projection::{Projection, assemble};

/// A scheme at integration points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointScheme {
    /// The advection equation with a continuous gradient (Eq. 37-43).
    Direct {
        /// The smoothing.
        smoothing: Smoothing,
        /// The volume matrix of the nodes.
        matrix: VolumeMatrix,
    },
    /// Lax-Wendroff with projected gradients (Eq. 57-59).
    LaxWendroffGalerkin {
        /// The volume matrix of the nodes.
        matrix: VolumeMatrix,
    },
}

impl PointScheme {
    fn matrix(&self) -> VolumeMatrix {
        let (Self::Direct { matrix, .. } | Self::LaxWendroffGalerkin { matrix }) = self;
        *matrix
    }
}

/// Values at integration points that cannot be moved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PointError {
    /// A cell without a gradient at an integration point.
    #[error(
        "cell {cell:?} is folded: det J = {determinant:e} at an integration point, where a gradient is wanted"
    )]
    Folded {
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// The least determinant at its integration points.
        determinant: f64,
    },
    /// A consistent volume matrix that rounding made indefinite.
    #[error("the consistent volume matrix has no Cholesky factors; take the lumped one")]
    Matrix,
    /// Neither one value per cell nor one at each integration point.
    #[error("there are values at {found} points of each cell, not at 1 or {wanted}")]
    Points {
        /// Lists of values.
        found: usize,
        /// The integration points of a cell.
        wanted: usize,
    },
    /// A list that is not as long as the mesh has cells or nodes.
    #[error("there are {found} values for {wanted} cells or nodes")]
    Length {
        /// The values.
        found: usize,
        /// Cells or nodes.
        wanted: usize,
    },
    /// A value that is not a number.
    #[error("the value at point {point} of cell {cell:?} is {value}")]
    NotFinite {
        /// The number of the integration point.
        point: usize,
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// The value.
        value: f64,
    },
    /// A weight of the smoothing out of range.
    #[error(transparent)]
    Alpha(#[from] AlphaRange),
}

/// Moves values at the integration points of a mesh.
#[derive(Clone, Debug)]
pub struct PointTransport<const D: usize> {
    centre: Basis<D>,
    points: Vec<Basis<D>>,
    faces: Vec<Vec<Basis<D>>>,
    projection: Projection<D>,
}

impl<const D: usize> PointTransport<D> {
    /// A transport through this mesh.
    ///
    /// # Errors
    /// A cell that is folded at one of its integration points.
    pub fn new<C: Cell<D>>(mesh: &Mesh<C, D>) -> Result<Self, PointError> {
        let points = Basis::at_points();
        let projection = Projection::new(mesh, &points)?;
        let faces = (0..2 * D).map(|face| Basis::at_face(face / 2, face % 2)).collect();
        Ok(Self { centre: Basis::new(&Vector::repeat(0.5)), points, faces, projection })
    }

    /// Goes on with the places of the nodes in `mesh`, whose cells are counted alike.
    ///
    /// # Errors
    /// As [`PointTransport::new`].
    pub fn set_mesh<C: Cell<D>>(&mut self, mesh: &Mesh<C, D>) -> Result<(), PointError> {
        self.projection = Projection::new(mesh, &self.points)?;
        Ok(())
    }

    /// Moves `values[point][cell]`, with one value in the middle of each cell or one at each of its integration points, by the
    /// `displacement` of the material relative to each node. `mesh` is that of [`PointTransport::new`] or [`PointTransport::set_mesh`];
    /// where its nodes move the values are then those at the points of the cells after.
    ///
    /// # Errors
    /// See [`PointError`]; the values are then as before.
    pub fn step<C: Cell<D>>(
        &mut self,
        mesh: &Mesh<C, D>,
        displacement: &[Vector<D>],
        scheme: PointScheme,
        values: &mut [Vec<f64>],
    ) -> Result<(), PointError> {
        check(mesh.grid(), displacement, scheme, values)?;
        if scheme.matrix() == VolumeMatrix::Consistent {
            self.projection.factorize(mesh, &self.points)?;
        }
        let Self { centre, points, faces, projection } = self;
        let point = |number: usize, count: usize| if count == 1 { &*centre } else { &points[number] };
        let (cells, nodes, lists) = (mesh.grid().len(), mesh.nodes().len(), values.len());
        match scheme {
            PointScheme::Direct { smoothing: Smoothing { local, alpha }, matrix } => {
                let mut parts = vec![[Vector::<1>::zeros(); CORNERS]; cells];
                let mut means = vec![Vector::<1>::zeros(); nodes];
                direct::sides(mesh, points, local, values, &mut parts);
                assemble(mesh.grid(), &parts, &mut means);
                projection.solve(matrix, &mut means);
                for (number, values) in values.iter_mut().enumerate() {
                    let share =
                        |corner: Corner<D>| means[corner.node][0] * (alpha * corner.basis - corner.slope);
                    advance(mesh, point(number, lists), displacement, 1.0 - alpha, share, values);
                }
            }
            PointScheme::LaxWendroffGalerkin { matrix } => {
                let mut parts = vec![[Vector::<D>::zeros(); CORNERS]; cells];
                let mut gradients = vec![Vector::<D>::zeros(); nodes];
                galerkin::sides(mesh, points, faces, values, &mut parts);
                assemble(mesh.grid(), &parts, &mut gradients);
                projection.solve(matrix, &mut gradients);
                for (number, values) in values.iter_mut().enumerate() {
                    let share = |corner: Corner<D>| {
                        gradients[corner.node].dot(&corner.u) * (0.5 * corner.slope - corner.basis)
                    };
                    advance(mesh, point(number, lists), displacement, 1.0, share, values);
                }
            }
        }
        Ok(())
    }
}

fn check<const D: usize>(
    grid: &Grid<D>,
    displacement: &[Vector<D>],
    scheme: PointScheme,
    values: &[Vec<f64>],
) -> Result<(), PointError> {
    if let PointScheme::Direct { smoothing: Smoothing { alpha, .. }, .. } = scheme {
        AlphaRange::check(alpha)?;
    }
    if ![1, count(D)].contains(&values.len()) {
        return Err(PointError::Points { found: values.len(), wanted: count(D) });
    }
    let lengths = values.iter().map(|values| (values.len(), grid.len()));
    let mut lengths = lengths.chain([(displacement.len(), grid.node_count())]);
    if let Some((found, wanted)) = lengths.find(|(found, wanted)| found != wanted) {
        return Err(PointError::Length { found, wanted });
    }
    for (point, values) in values.iter().enumerate() {
        if let Some(cell) = values.iter().position(|value| !value.is_finite()) {
            let value = values[cell];
            return Err(PointError::NotFinite { point, cell: grid.offset(cell).to_vec(), value });
        }
    }
    Ok(())
}

/// What a corner of a cell is at one of its points: its node, `N_I`, the displacement `u` there and `grad N_I . u`.
#[derive(Clone, Copy, Debug)]
struct Corner<const D: usize> {
    node: usize,
    basis: f64,
    u: Vector<D>,
    slope: f64,
}

/// Makes the values at one point of all cells `keep` times what they are, and adds the share of every corner.
fn advance<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    point: &Basis<D>,
    displacement: &[Vector<D>],
    keep: f64,
    share: impl Fn(Corner<D>) -> f64 + Sync + Send,
    values: &mut [f64],
) {
    let row = mesh.grid().cells()[0];
    parallel::for_each_chunk(values, row, |r, values| {
        for (i, value) in values.iter_mut().enumerate() {
            let element = Element::new(mesh, r * row + i);
            let frame = element.frame(point);
            let corners = || element.nodes().iter().zip(point.values).enumerate();
            let u: Vector<D> = corners().map(|(_, (&node, basis))| displacement[node] * basis).sum();
            *value *= keep;
            for (number, (&node, basis)) in corners() {
                let slope = frame.weighted_gradient(point, number).dot(&u) / frame.determinant;
                *value += share(Corner { node, basis, u, slope });
            }
        }
    });
}

/// Sets something in every cell.
fn each<T: Send, const D: usize>(
    parts: &mut [T],
    grid: &Grid<D>,
    of_cell: impl Fn(usize) -> T + Sync + Send,
) {
    let row = grid.cells()[0];
    parallel::for_each_chunk(parts, row, |r, parts| {
        for (i, part) in parts.iter_mut().enumerate() {
            *part = of_cell(r * row + i);
        }
    });
}
