//! Connected pieces of a material.

use vofkit_geometry::Cell;

use super::material_volume;
use crate::mesh::Mesh;
use crate::tolerance::{FRAGMENT_FRACTION, FRAGMENT_VOLUME};

/// The pieces that a material is in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fragments {
    /// Pieces that hold more than [`FRAGMENT_VOLUME`] of the material.
    pub count: usize,
    /// The part of the material's volume that lies outside the largest piece.
    pub stray_volume: f64,
}

/// The connected pieces of a material: components of cells with more than [`FRAGMENT_FRACTION`] of it, joined by faces, edges or
/// corners.
#[derive(Clone, Debug, PartialEq)]
pub struct Pieces {
    /// The piece that each cell belongs to, if any.
    pub of_cell: Vec<Option<usize>>,
    /// The volume of the material in each piece.
    pub volumes: Vec<f64>,
}

/// Finds the pieces of a material.
pub fn pieces<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, fractions: &[f64]) -> Pieces {
    let mut of_cell = vec![None; fractions.len()];
    let mut volumes = Vec::new();
    let mut stack = Vec::new();
    for start in 0..fractions.len() {
        let mut volume = 0.0;
        stack.push(start);
        while let Some(cell) = stack.pop() {
            if of_cell[cell].is_some() || !(fractions[cell] > FRAGMENT_FRACTION) {
                continue;
            }
            of_cell[cell] = Some(volumes.len());
            volume += fractions[cell] * mesh.volumes()[cell];
            stack.extend(mesh.grid().around(cell, 1));
        }
        if of_cell[start] == Some(volumes.len()) {
            volumes.push(volume);
        }
    }
    Pieces { of_cell, volumes }
}

/// Counts the [`pieces`] of a material.
pub fn fragments<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, fractions: &[f64]) -> Fragments {
    let total = material_volume(mesh, fractions);
    if !(total > 0.0) {
        return Fragments::default();
    }
    let Pieces { volumes, .. } = pieces(mesh, fractions);
    let largest = volumes.iter().fold(0.0_f64, |largest, &volume| largest.max(volume));
    Fragments {
        count: volumes.iter().filter(|&&volume| volume > FRAGMENT_VOLUME * total).count(),
        stray_volume: (1.0 - largest / total).max(0.0),
    }
}
