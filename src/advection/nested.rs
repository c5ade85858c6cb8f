//! The materials of mixed cells, one after the other: what one leaves goes to the next, and the last takes all that is left. So
//! the materials and the void of a cell tile it, however their planes lie.
//!
//! The planes are placed on the cells' [tiles](vofkit_geometry::clip::tile), so that the pieces that are cut from them later add
//! up to what the cells hold.

use vofkit_geometry::Cell;
use vofkit_geometry::clip::Tile;

use super::places::Places;
use crate::interface::{
    Body, Counts, Dissector, Materials, Placed, Reconstruction, ReconstructionError, Share, Shared, is_mixed,
    planes_of_all,
};
use crate::mesh::Mesh;
use crate::parallel;
use crate::stopwatch::Stopwatch;
use crate::tolerance::FRACTION_ROUNDING;

/// The shares of all materials in mixed cells.
#[derive(Clone, Debug)]
pub(super) struct Nested<const D: usize> {
    cells: Places,
    /// By place in `cells`, with the component: a material by its number, then void. None beyond the last.
    shares: Vec<Option<(usize, Share<D>)>>,
    /// The most that a cell has.
    components: usize,
}

impl<const D: usize> Nested<D> {
    /// No shares yet in a mesh of this many cells.
    pub(super) fn new(cells: usize) -> Self {
        Self { cells: Places::new(cells), shares: Vec::new(), components: 1 }
    }

    /// The shares in a cell, the last of which takes the rest; none if it is pure, or was not among those given.
    pub(super) fn of(&self, cell: usize) -> Option<&[Option<(usize, Share<D>)>]> {
        self.cells.of(cell).map(|slot| &self.shares[slot * self.components..][..self.components])
    }

    /// The tiles of the cells that have shares, relative to their [anchors](Mesh::anchor): many regions meet each.
    pub(super) fn tiles<C: Cell<D>>(&self, mesh: &Mesh<C, D>) -> Vec<C::Tile> {
        let cells = self.cells.items();
        parallel::map(cells.len(), |slot| C::Tile::new(&mesh.local_cell(cells[slot] as usize)))
    }

    /// The place of a cell among those that have shares; none if it is pure, or was not among those given.
    pub(super) fn place_of(&self, cell: usize) -> Option<usize> {
        self.cells.of(cell)
    }

    /// Places the planes in the mixed ones of some cells, and counts them.
    ///
    /// # Errors
    /// A plane that was not found.
    pub(super) fn place<C: Cell<D>>(
        &mut self,
        mesh: &Mesh<C, D>,
        fractions: &[Vec<f64>],
        cells: impl Iterator<Item = usize>,
        mut method: Reconstruction,
        stopwatch: &mut Stopwatch,
    ) -> Result<Counts, ReconstructionError> {
        if method.materials == Materials::Independent {
            method.materials = Materials::Nested;
        }
        self.cells.clear();
        let mixed = |cell: &usize| fractions.iter().any(|f| is_mixed(f[*cell]));
        cells.filter(mixed).for_each(|cell| self.cells.insert(cell));
        let cells: Vec<usize> = self.cells.items().iter().map(|&cell| cell as usize).collect();
        let mut counts = Counts::default();
        let planes =
            planes_of_all(Body::Tile, mesh, fractions.into(), &cells, method, &mut counts, stopwatch)?;
        self.components = fractions.len() + 1;
        self.shares.clear();
        self.shares.resize(cells.len() * self.components, None);
        let mut results = vec![Ok(Counts::default()); cells.len()];
        parallel::for_each_with_scratch(
            &mut results,
            &mut self.shares,
            || None,
            |dissector, slot, result, shares| {
                let planes = &planes[slot * fractions.len()..][..fractions.len()];
                let index = cells[slot];
                if !planes.iter().flatten().any(Placed::is_nested) {
                    alone(fractions, index, planes, shares);
                    return;
                }
                let cell = mesh.local_cell(index);
                let dissector = dissector.get_or_insert_with(Dissector::default);
                let shared = Shared { mesh, parts: fractions.into(), planes, index, cell: &cell };
                *result = dissector.dissect(shared, [cell], method, |_, _, _| {});
                for (place, (material, share)) in shares.iter_mut().zip(dissector.shares()) {
                    *place = Some((material.unwrap_or(fractions.len()), share));
                }
            },
        );
        for result in results {
            counts.add(&result?);
        }
        stopwatch.lap(|seconds| &mut seconds.positions);
        Ok(counts)
    }
}

/// The shares of one material and void, or of two materials that fill a cell.
fn alone<const D: usize>(
    fractions: &[Vec<f64>],
    index: usize,
    planes: &[Option<Placed<D>>],
    shares: &mut [Option<(usize, Share<D>)>],
) {
    let mut here = (0..fractions.len()).filter(|&k| fractions[k][index] > 0.0);
    let (Some(first), second) = (here.next(), here.next()) else { return };
    let fraction = fractions[first][index];
    let share = match planes[first] {
        Some(Placed::Plane { half_space, .. }) if fraction < 1.0 - FRACTION_ROUNDING => {
            Share::Below(half_space)
        }
        _ => Share::Even(fraction),
    };
    shares[0] = Some((first, share));
    shares[1] = Some((second.unwrap_or(fractions.len()), Share::Rest));
}
