//! Remapping: the content of the cells of another mesh, wherever they lie.
//!
//! Each new cell is cut by every old cell that it meets and by the planes of the materials there. Old cells, their materials and
//! the void tile space, and so do the new cells: the volume of every material is conserved where both meshes fill the same
//! space, fractions are in `[0, 1]` without correction, and how far the nodes have moved does not matter.

use vofkit_geometry::Cell;
use vofkit_geometry::clip::{Full, Tile};

use super::carry::{Along, Carry, carried};
use super::content::{Finding, Held, Load, Scratch, Source};
use super::ledger::Ledger;
use super::nested::Nested;
use super::settle::settle;
use crate::interface::{Reconstruction, ReconstructionError};
use crate::mesh::Mesh;
use crate::mesh::locate::Locator;
use crate::parallel;
use crate::quantity::{QuantityError, State};
use crate::stopwatch::Stopwatch;

/// A remapping that cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RemapError {
    /// A fraction or a quantity that is none.
    #[error(transparent)]
    State(#[from] QuantityError),
    /// A plane that was not found.
    #[error(transparent)]
    Reconstruction(#[from] ReconstructionError),
    /// A new cell whose faces are so twisted that there is no room for its parts.
    #[error("cell {cell:?} of the new mesh is too twisted to be cut")]
    Twisted {
        /// The cell's index along each axis.
        cell: Vec<usize>,
    },
}

/// The state on the mesh `to` of materials that have `state` on the mesh `from` and stay where they are, and an account in which
/// `preimages_cut` counts the new cells that were cut. The two meshes need not have the same number of cells. Beyond the ends of `from`
/// there is void.
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
/// let density = MaterialQuantity::new(0, vec![vec![7.8; 256]]);
/// let state = State { fractions, quantities: vec![density] };
/// let (remapped, ledger) = remap(&old, &new, &state, Reconstruction::default())?;
/// let change = material_volume(&new, &remapped.fractions[0]) - material_volume(&old, &state.fractions[0]);
/// assert!(change.abs() <= 1e-14 && ledger.materials[0].clipped <= 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn remap<C: Cell<D>, const D: usize>(
    from: &Mesh<C, D>,
    to: &Mesh<C, D>,
    state: &State,
    reconstruction: Reconstruction,
) -> Result<(State, Ledger), RemapError> {
    state.check(from.grid(), None)?;
    let State { fractions, quantities } = state;
    let (materials, cells) = (fractions.len(), to.grid().len());
    let mut quantities_after = quantities.clone();
    for values in quantities_after.iter_mut().flat_map(|quantity| &mut quantity.values) {
        values.clear();
        values.resize(cells, 0.0);
    }
    let mut remapped = State { fractions: vec![vec![0.0; cells]; materials], quantities: quantities_after };
    let mut ledger = Ledger::new(materials);
    if materials == 0 {
        return Ok((remapped, ledger));
    }
    let mut nested = Nested::new(from.grid().len());
    let untimed = &mut Stopwatch::default();
    ledger.counts = nested.place(from, fractions, 0..from.grid().len(), reconstruction, untimed)?;
    let tiles = &nested.tiles(from);
    let locator = Locator::new(from);
    let carried = carried(quantities, materials);
    let mut carry = Carry::new();
    let numbers = |count: usize| (0..count as u32).collect::<Vec<u32>>();
    if !quantities.is_empty() {
        carry.begin(quantities, fractions, from.volumes(), 0..from.grid().len());
        carry.find_slopes(from, fractions, quantities, &numbers(from.grid().len()), Along::Space);
    }
    let load = Load { carry: &carry, quantities, carried: &carried };
    let load = (!quantities.is_empty()).then_some(load);
    let source =
        Source { mesh: from, locator: &locator, fractions, nested: &nested, tiles, outside: None, load };
    let mut findings = vec![Finding::new(); cells];
    let mut volumes = vec![0.0; cells * materials];
    parallel::for_each_with_scratch(
        &mut findings,
        &mut volumes,
        Scratch::new,
        |scratch, index, finding, volumes| {
            let region = C::Tile::region(&to.local_cell(index));
            let (origin, whole) = (to.anchor(index), to.volumes()[index]);
            finding.held = source.contents(&region, &origin, whole, scratch, volumes, &mut finding.arriving);
        },
    );
    if let Some(index) = findings.iter().position(|finding| finding.held == Err(Full)) {
        return Err(RemapError::Twisted { cell: to.grid().offset(index).to_vec() });
    }
    ledger.cells_visited = cells;
    ledger.preimages_cut = findings.iter().filter(|finding| finding.held == Ok(Held::Several)).count();
    for (index, volumes) in volumes.chunks(materials).enumerate() {
        settle(index, to.volumes()[index], volumes, &mut remapped.fractions, &mut ledger);
    }
    if !quantities.is_empty() {
        let cells = numbers(cells);
        carry.resize(cells.len());
        carry.pass(&cells, &findings[..], Some(quantities), &mut remapped.quantities, &mut ledger);
        let State { fractions, quantities } = &mut remapped;
        carry.finish(&cells, |index| to.volumes()[index], fractions, quantities, &mut ledger);
    }
    Ok((remapped, ledger))
}
