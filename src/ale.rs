//! Calls for codes that keep the mesh and its state in arrays of their own: plain slices of nodes, face fluxes and displacements go
//! in, a new [`State`] and a [`Ledger`] come out.
//!
//! Cells are counted with the first axis fastest, and so are nodes, of which there is one more along each axis. Quantities of the
//! materials are taken along. Nothing is changed in place, so that a step that fails costs nothing.

use vofkit_geometry::{Cell, Vector};

use crate::advection::{Ledger, RemapError, StepError, remap as remap_mesh, step_with_fluxes};
use crate::interface::Reconstruction;
use crate::mesh::{Grid, Mesh, MeshError};
use crate::quantity::State;
use crate::tolerance::FLUX_BALANCE;

/// Arrays that do not make up a step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AleError {
    /// An array of the wrong length.
    #[error("there are {given} {what}, and the mesh needs {wanted}")]
    Length {
        /// What is in it.
        what: &'static str,
        /// Its length.
        given: usize,
        /// The length that it should have.
        wanted: usize,
    },
    /// A number that is not finite.
    #[error("number {index} of the {what} is {value}")]
    NotFinite {
        /// What is in the array.
        what: &'static str,
        /// The place in it.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A cell that the fluxes fill or drain: contents could not be those of a mesh that stands still.
    #[error(
        "the fluxes take the volume {net:e} from cell {cell:?}, which has {volume:e}; they should cancel"
    )]
    Unbalanced {
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// What leaves it less what enters.
        net: f64,
        /// Its volume.
        volume: f64,
    },
    /// Nodes that make up no valid cells.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A state that is none, or a remapping that cannot be done.
    #[error(transparent)]
    Remap(#[from] RemapError),
    /// A step that cannot be done.
    #[error(transparent)]
    Step(#[from] StepError),
}

/// Points as vectors.
fn vectors<const D: usize>(
    what: &'static str,
    points: &[[f64; D]],
    wanted: usize,
) -> Result<Vec<Vector<D>>, AleError> {
    if points.len() != wanted {
        return Err(AleError::Length { what, given: points.len(), wanted });
    }
    for (index, point) in points.iter().enumerate() {
        if let Some(&value) = point.iter().find(|value| !value.is_finite()) {
            return Err(AleError::NotFinite { what, index, value });
        }
    }
    Ok(points.iter().map(|&point| Vector::from(point)).collect())
}

/// The state of materials at rest after the nodes of a mesh with so many cells along each axis went from their old to their new
/// places, however far: the arbitrary Lagrangian-Eulerian step from the old mesh to the new one. Beyond the old mesh there is void.
///
/// # Errors
/// See [`AleError`].
///
/// ```
/// use vofkit::prelude::*;
///
/// let node = |i: usize, j: usize| [i as f64 / 8.0, j as f64 / 8.0];
/// let old_nodes: Vec<[f64; 2]> = (0..81).map(|k| node(k % 9, k / 9)).collect();
/// // The inner nodes move.
/// let bend = |[x, y]: [f64; 2]| [x + 0.9 * x * (1.0 - x) * y * (1.0 - y), y];
/// let new_nodes: Vec<[f64; 2]> = old_nodes.iter().map(|&x| bend(x)).collect();
/// // One material to the left, with a density.
/// let fractions: Vec<f64> = (0..64).map(|cell| if cell % 8 < 4 { 1.0 } else { 0.0 }).collect();
/// let density = MaterialQuantity::new(0, vec![vec![7.8; 64]]);
/// let state = State { fractions: vec![fractions], quantities: vec![density] };
///
/// let (state, ledger) =
///     ale::remap::<Quad, 2>([8, 8], &old_nodes, &new_nodes, &state, Reconstruction::default())?;
/// assert!(ledger.materials[0].clipped <= 1e-15 && ledger.quantities[0].limited <= 1e-13);
/// for (f, density) in state.fractions[0].iter().zip(&state.quantities[0].values[0]) {
///     assert!(*f == 0.0 || (density - 7.8).abs() <= 1e-12);
/// }
/// # Ok::<(), ale::AleError>(())
/// ```
pub fn remap<C: Cell<D>, const D: usize>(
    cells: [usize; D],
    old_nodes: &[[f64; D]],
    new_nodes: &[[f64; D]],
    state: &State,
    reconstruction: Reconstruction,
) -> Result<(State, Ledger), AleError> {
    let grid = Grid::new(cells, [false; D]);
    let wanted = grid.node_count();
    let mesh = |what: &'static str, nodes: &[[f64; D]]| -> Result<Mesh<C, D>, AleError> {
        Ok(Mesh::from_nodes(grid.clone(), vectors(what, nodes, wanted)?)?)
    };
    let (from, to) = (mesh("old nodes", old_nodes)?, mesh("new nodes", new_nodes)?);
    Ok(remap_mesh(&from, &to, state, reconstruction)?)
}

/// The state of materials after a step through a mesh that stands still, by the unsplit scheme.
///
/// `face_fluxes[axis]` are the volumes that cross the faces across an axis towards higher indices, the first axis fastest; there is
/// one more face than cells along that axis. In every cell they should cancel. `displacements` say for each node how far what is
/// there now has come; the fluxes decide on volumes, the displacements where they come from. Ends that no face crosses are walls;
/// through others void flows in.
///
/// # Errors
/// See [`AleError`].
///
/// ```
/// use std::f64::consts::PI;
/// use vofkit::prelude::*;
///
/// let n = 16;
/// let mesh = Mesh::<Quad, 2>::unit([n, n], &Distortion::None)?;
/// let fractions = volume_fractions(&mesh, &[Shape::Sphere { centre: [0.5, 0.7].into(), radius: 0.2 }]);
/// let stress = MaterialQuantity::new(0, vec![vec![1.0; n * n], vec![2.0; n * n], vec![-0.5; n * n]]);
/// let state = State { fractions, quantities: vec![stress] };
///
/// // A vortex of the stream function sin(pi x) sin(pi y), for a time of 0.01.
/// let dt = 0.01;
/// let psi = |i: usize, j: usize| {
///     let at = |k: usize| if k % n == 0 { 0.0 } else { (PI * k as f64 / n as f64).sin() };
///     dt * at(i) * at(j)
/// };
/// let across_x: Vec<f64> =
///     (0..(n + 1) * n).map(|k| (k % (n + 1), k / (n + 1))).map(|(i, j)| psi(i, j + 1) - psi(i, j)).collect();
/// let across_y: Vec<f64> =
///     (0..n * (n + 1)).map(|k| (k % n, k / n)).map(|(i, j)| psi(i, j) - psi(i + 1, j)).collect();
/// let velocity = |x: &Vector<2>| {
///     [PI * (PI * x[0]).sin() * (PI * x[1]).cos(), -PI * (PI * x[0]).cos() * (PI * x[1]).sin()]
/// };
/// let displacements: Vec<[f64; 2]> = mesh.nodes().iter().map(|x| velocity(x).map(|u| u * dt)).collect();
///
/// let (after, ledger) =
///     ale::advance(&mesh, &[&across_x, &across_y], &displacements, &state, Reconstruction::default())?;
/// let change = material_volume(&mesh, &after.fractions[0]) - material_volume(&mesh, &state.fractions[0]);
/// assert!(change.abs() <= 1e-15 && ledger.materials[0].clipped <= 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn advance<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    face_fluxes: &[&[f64]; D],
    displacements: &[[f64; D]],
    state: &State,
    reconstruction: Reconstruction,
) -> Result<(State, Ledger), AleError> {
    let grid = mesh.grid();
    state.check(grid, None).map_err(StepError::from)?;
    let displacements = vectors("displacements", displacements, grid.node_count())?;
    let extents: [[usize; D]; D] = std::array::from_fn(|axis| {
        let mut extent = grid.cells();
        extent[axis] += 1;
        extent
    });
    for (fluxes, extent) in face_fluxes.iter().zip(&extents) {
        let (given, wanted) = (fluxes.len(), extent.iter().product());
        if given != wanted {
            return Err(AleError::Length { what: "face fluxes", given, wanted });
        }
        if let Some(index) = fluxes.iter().position(|flux| !flux.is_finite()) {
            return Err(AleError::NotFinite { what: "face fluxes", index, value: fluxes[index] });
        }
    }
    let through = |mut offset: [usize; D], axis: usize, side: usize| {
        offset[axis] += side;
        if grid.periodic()[axis] {
            // The two ends are one face.
            offset[axis] %= grid.cells()[axis];
        }
        face_fluxes[axis][(0..D).rev().fold(0, |index, k| index * extents[axis][k] + offset[k])]
    };
    for (cell, &volume) in mesh.volumes().iter().enumerate() {
        let offset = grid.offset(cell);
        let net = (0..D).map(|axis| through(offset, axis, 1) - through(offset, axis, 0)).sum::<f64>();
        if net.abs() > FLUX_BALANCE * volume {
            return Err(AleError::Unbalanced { cell: offset.to_vec(), net, volume });
        }
    }
    let mut after = state.clone();
    let ledger = step_with_fluxes(mesh, &through, &displacements, &mut after, reconstruction)?;
    Ok((after, ledger))
}
