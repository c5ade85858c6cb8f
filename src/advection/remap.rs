//! Remapping: the content of the cells of another mesh, wherever they lie.
//!
//! Each new cell is cut by every old cell that it meets and by the planes of the materials there. Old cells, their materials and
//! the void tile space, and so do the new cells: the volume of every material is conserved where both meshes fill the same
//! space, fractions are in `[0, 1]` without correction, and how far the nodes have moved does not matter.

use vofkit_geometry::Cell;
use vofkit_geometry::clip::{Full, Tile};

use super::content::{Held, Scratch, Source};
use super::ledger::Ledger;
use super::nested::Nested;
use super::settle::settle;
use crate::interface::{Reconstruction, ReconstructionError, check_fractions};
use crate::mesh::Mesh;
use crate::mesh::locate::Locator;
use crate::parallel;

/// Fractions on another mesh, and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Remapped {
    /// By material, then by cell of the new mesh.
    pub fractions: Vec<Vec<f64>>,
    /// What was done; `preimages_cut` counts the new cells that were cut.
    pub ledger: Ledger,
}

/// A remapping that cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RemapError {
    /// A fraction that is none, or a plane that was not found.
    #[error(transparent)]
    Reconstruction(#[from] ReconstructionError),
    /// A new cell whose faces are so twisted that there is no room for its parts.
    #[error("cell {cell:?} of the new mesh is too twisted to be cut")]
    Twisted {
        /// The cell's index along each axis.
        cell: Vec<usize>,
    },
}

/// The fractions on the mesh `to` of materials that have `fractions[material][cell]` on the mesh `from` and stay where they are. The
/// two meshes need not have the same number of cells. Beyond the ends of `from` there is void.
///
/// # Errors
/// See [`RemapError`].
///
/// ```
/// use vofkit::prelude::*;
///
/// let old = Mesh::<Quad, 2>::unit([16; 2], &Distortion::Random { amplitude: 0.3, seed: 1 })?;
/// let new = Mesh::<Quad, 2>::unit([20; 2], &Distortion::Wave { amplitude: 0.5 })?;
/// let fractions = volume_fractions(&old, &[Shape::Sphere { centre: [0.5; 2].into(), radius: 0.3 }]);
/// let remapped = remap(&old, &new, &fractions, Reconstruction::default())?;
/// let change = material_volume(&new, &remapped.fractions[0]) - material_volume(&old, &fractions[0]);
/// assert!(change.abs() <= 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn remap<C: Cell<D>, const D: usize>(
    from: &Mesh<C, D>,
    to: &Mesh<C, D>,
    fractions: &[Vec<f64>],
    reconstruction: Reconstruction,
) -> Result<Remapped, RemapError> {
    for fractions in fractions {
        check_fractions(from.grid(), fractions)?;
    }
    let materials = fractions.len();
    let cells = to.grid().len();
    let mut remapped =
        Remapped { fractions: vec![vec![0.0; cells]; materials], ledger: Ledger::new(materials) };
    if materials == 0 {
        return Ok(remapped);
    }
    let Remapped { fractions: found, ledger } = &mut remapped;
    let mut nested = Nested::new(from.grid().len());
    ledger.counts = nested.place(from, fractions, 0..from.grid().len(), reconstruction)?;
    let locator = Locator::new(from);
    let source = Source { mesh: from, locator: &locator, fractions, nested: &nested, outside: None };
    let mut held = vec![Ok(Held::One); cells];
    let mut volumes = vec![0.0; cells * materials];
    parallel::for_each_with_scratch(
        &mut held,
        &mut volumes,
        Scratch::new,
        |scratch, index, held, volumes| {
            let region = C::Tile::region(&to.local_cell(index));
            *held = source.contents(&region, &to.anchor(index), to.volumes()[index], scratch, volumes);
        },
    );
    if let Some(index) = held.iter().position(|held| *held == Err(Full)) {
        return Err(RemapError::Twisted { cell: to.grid().offset(index).to_vec() });
    }
    ledger.cells_visited = cells;
    ledger.preimages_cut = held.iter().filter(|held| **held == Ok(Held::Several)).count();
    for (index, volumes) in volumes.chunks(materials).enumerate() {
        settle(index, to.volumes()[index], volumes, found, ledger);
    }
    Ok(remapped)
}
