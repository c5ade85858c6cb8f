//! What materials have of the cells.

use vofkit_geometry::Vector;

use super::{ReconstructionError, check_fractions};
use crate::fractions::MaterialMoments;
use crate::mesh::{Grid, Mesh};
use crate::normal::Material;

/// What materials have of the cells: volume fractions and, where they are known, centroids.
///
/// Fractions alone become parts by [`From`], as do [`MaterialMoments`].
#[derive(Clone, Copy, Debug)]
pub struct Parts<'a, const D: usize> {
    /// By material and cell, in `[0, 1]`.
    pub fractions: &'a [Vec<f64>],
    /// By material and cell, in the coordinates of the mesh; those of cells that are not mixed are not read.
    pub centroids: Option<&'a [Vec<Vector<D>>]>,
}

impl<'a, const D: usize> Parts<'a, D> {
    /// One of the materials.
    pub(crate) fn material<C>(self, mesh: &'a Mesh<C, D>, material: usize) -> Material<'a, C, D> {
        let centroids = self.centroids.and_then(|all| all.get(material)).map(Vec::as_slice);
        Material { mesh, fractions: &self.fractions[material], centroids }
    }

    /// Checks that there is one fraction in `[0, 1]` for each cell and material, and one centroid where there are any.
    ///
    /// # Errors
    /// Another number of fractions or centroids, or the first fraction that is none.
    pub fn check(self, grid: &Grid<D>) -> Result<(), ReconstructionError> {
        self.fractions.iter().try_for_each(|f| check_fractions(grid, f))?;
        let Some(centroids) = self.centroids else { return Ok(()) };
        let [given, wanted] = [centroids.len(), self.fractions.len()];
        if given != wanted {
            return Err(ReconstructionError::Centroids { given, wanted, of: "materials" });
        }
        match centroids.iter().find(|of_material| of_material.len() != grid.len()) {
            None => Ok(()),
            Some(odd) => {
                Err(ReconstructionError::Centroids { given: odd.len(), wanted: grid.len(), of: "cells" })
            }
        }
    }
}

impl<'a, const D: usize> From<&'a [Vec<f64>]> for Parts<'a, D> {
    fn from(fractions: &'a [Vec<f64>]) -> Self {
        Self { fractions, centroids: None }
    }
}

impl<'a, const D: usize> From<&'a Vec<Vec<f64>>> for Parts<'a, D> {
    fn from(fractions: &'a Vec<Vec<f64>>) -> Self {
        fractions.as_slice().into()
    }
}

impl<'a, const D: usize, const N: usize> From<&'a [Vec<f64>; N]> for Parts<'a, D> {
    fn from(fractions: &'a [Vec<f64>; N]) -> Self {
        fractions.as_slice().into()
    }
}

impl<'a, const D: usize> From<&'a MaterialMoments<D>> for Parts<'a, D> {
    fn from(MaterialMoments { fractions, centroids }: &'a MaterialMoments<D>) -> Self {
        Self { fractions, centroids: Some(centroids) }
    }
}
