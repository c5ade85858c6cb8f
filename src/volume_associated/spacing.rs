//! Distances along mesh lines.

use vofkit_geometry::Cell;

use super::runs::Lines;
use crate::mesh::Mesh;
use crate::parallel;

/// For every face the share `l / (l + l')` of the distance between the middles of its two cells that lies below it, with the lengths `l` below
/// and `l'` above: the distances between the middles of opposite faces.
#[derive(Clone, Debug)]
pub(crate) struct Spacing<const D: usize> {
    pub(super) below: [Vec<f64>; D],
}

impl<const D: usize> Spacing<D> {
    pub(crate) fn new<C: Cell<D>>(mesh: &Mesh<C, D>) -> Self {
        let below = std::array::from_fn(|axis| {
            let lines = Lines::new(mesh.grid(), axis);
            let mut below = vec![0.5; lines.faces()];
            if mesh.is_undistorted() {
                return below;
            }
            let length =
                parallel::map(mesh.grid().len(), |cell| mesh.local_cell(cell).mean_edge(axis).norm());
            parallel::for_each_chunk(&mut below, lines.face_row(), |row, share| {
                for run in lines.face_runs(row) {
                    // At open ends no value is interpolated.
                    let (Some(b), Some(a)) = (run.below, run.above) else { continue };
                    for i in 0..run.len {
                        share[run.start + i] = length[b + i] / (length[b + i] + length[a + i]);
                    }
                }
            });
            below
        });
        Self { below }
    }
}
