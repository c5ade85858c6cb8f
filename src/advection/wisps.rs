//! Wisps: tiny detached remainders of a material.

use vofkit_geometry::Cell;

use super::carry::Cargo;
use super::ledger::Ledger;
use crate::mesh::Mesh;
use crate::parallel;
use crate::quantity::totals;

/// Empties every cell that holds less than the fraction `below` of a material among cells (sharing a face, an edge or a corner) that
/// all hold less, too. The volumes, and the quantities that are lost with them, are entered.
pub(super) fn remove<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    cargo: &mut Cargo<'_>,
    below: f64,
    ledger: &mut Ledger,
) {
    let Cargo { fractions, quantities } = cargo;
    let found: Vec<Vec<usize>> = fractions
        .iter()
        .map(|f| {
            let detached = parallel::map(f.len(), |cell| {
                f[cell] > 0.0 && f[cell] < below && mesh.grid().around(cell, 1).all(|next| f[next] < below)
            });
            (0..f.len()).filter(|&cell| detached[cell]).collect()
        })
        .collect();
    if found.iter().all(Vec::is_empty) {
        return;
    }
    let magnitude = |fractions: &[Vec<f64>]| {
        (0..quantities.len()).map(|k| totals(mesh, fractions, quantities, k).1).collect::<Vec<f64>>()
    };
    let before = magnitude(fractions);
    for ((f, cells), account) in fractions.iter_mut().zip(&found).zip(&mut ledger.materials) {
        for &cell in cells {
            account.wisps += std::mem::take(&mut f[cell]) * mesh.volumes()[cell];
        }
    }
    let after = magnitude(fractions);
    for (account, (before, after)) in ledger.quantities.iter_mut().zip(before.iter().zip(&after)) {
        account.limited += before - after;
    }
    for quantity in quantities.iter_mut() {
        for values in &mut quantity.values {
            for &cell in &found[quantity.material] {
                values[cell] = 0.0;
            }
        }
    }
}
