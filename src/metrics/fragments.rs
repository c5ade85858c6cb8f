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

/// Counts the components of cells with more than [`FRAGMENT_FRACTION`] of the material, joined by faces, edges or corners.
pub fn fragments<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, fractions: &[f64]) -> Fragments {
    let total = material_volume(mesh, fractions);
    if !(total > 0.0) {
        return Fragments::default();
    }
    let mut unseen: Vec<bool> = fractions.iter().map(|&f| f > FRAGMENT_FRACTION).collect();
    let mut stack = Vec::new();
    let (mut count, mut largest) = (0, 0.0_f64);
    for start in 0..fractions.len() {
        if !std::mem::take(&mut unseen[start]) {
            continue;
        }
        let mut volume = 0.0;
        stack.push(start);
        while let Some(cell) = stack.pop() {
            volume += fractions[cell] * mesh.volumes()[cell];
            for next in mesh.grid().around(cell, 1) {
                if std::mem::take(&mut unseen[next]) {
                    stack.push(next);
                }
            }
        }
        if volume > FRAGMENT_VOLUME * total {
            count += 1;
        }
        largest = largest.max(volume);
    }
    Fragments { count, stray_volume: (1.0 - largest / total).max(0.0) }
}
