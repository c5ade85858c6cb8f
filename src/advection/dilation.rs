//! Fluxes that do not cancel in a cell: what is in it is dilated or compressed.
//!
//! A cell that holds the material `f V` and from which `sum G` of it and `sum F` in all leave ends with
//!
//! ```text
//! f+ = (f V - sum G) / (V - sum F)
//! ```
//!
//! That is what sweeps come to by themselves, whose tracked volumes end at `V - sum F`, and what pre-images hold over their own volumes.
//! The cell is as large as before, so that its material grows by `f+ sum F` beyond what crossed its faces.

use vofkit_geometry::Cell;

use super::ledger::Ledger;
use super::transport::StepError;
use crate::mesh::Mesh;
use crate::parallel;
use crate::velocity::StepFluxes;

/// The volumes that cells have after a step, before they are dilated to their own.
///
/// # Errors
/// A cell that loses more than it holds.
pub(super) fn volumes<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fluxes: &StepFluxes<'_, D>,
) -> Result<Vec<f64>, StepError> {
    let grid = mesh.grid();
    let volumes = parallel::map(grid.len(), |cell| mesh.volumes()[cell] - fluxes.net(grid.offset(cell)));
    match volumes.iter().position(|volume| !(*volume > 0.0)) {
        None => Ok(volumes),
        Some(cell) => {
            let volume = mesh.volumes()[cell];
            let outflow = volume - volumes[cell];
            Err(StepError::Overdrawn { cell: grid.offset(cell).to_vec(), volume, outflow })
        }
    }
}

/// Enters what the materials gained in a step, that left these fractions.
pub(super) fn enter<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fluxes: &StepFluxes<'_, D>,
    fractions: &[Vec<f64>],
    ledger: &mut Ledger,
) {
    let grid = mesh.grid();
    for (fractions, account) in fractions.iter().zip(&mut ledger.materials) {
        account.dilated += parallel::sum(grid.len(), |cell| match fractions[cell] {
            0.0 => 0.0,
            fraction => fraction * fluxes.net(grid.offset(cell)),
        });
    }
}
