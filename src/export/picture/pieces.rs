//! Every connected piece of a material as if it were a material of its own.

use vofkit_geometry::Cell;

use crate::export::Snapshot;
use crate::export::palette::{AREAS, Colour, GREY};
use crate::facet::Facet;
use crate::metrics::pieces;

/// Materials taken apart into their pieces.
pub(super) struct ByPiece<const D: usize> {
    names: Vec<String>,
    fractions: Vec<Vec<f64>>,
    facets: Vec<Facet<D>>,
    /// One for each name.
    pub(super) colours: Vec<Colour>,
}

impl<const D: usize> ByPiece<D> {
    /// The largest pieces of all materials have names and colours; the others and stray remainders share the last, if there are any.
    pub(super) fn new<C: Cell<D>>(snapshot: &Snapshot<'_, C, D>) -> Self {
        let Snapshot { mesh, names, fractions, facets, .. } = *snapshot;
        let of_material: Vec<_> = fractions.iter().map(|fractions| pieces(mesh, fractions)).collect();
        let mut all: Vec<(f64, usize, usize)> = Vec::new();
        for (material, pieces) in of_material.iter().enumerate() {
            all.extend(pieces.volumes.iter().enumerate().map(|(piece, &volume)| (volume, material, piece)));
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        let named = all.len().min(AREAS.len());
        let others = all.len() - named;
        let rank = |material: usize, cell: usize| {
            let piece = of_material[material].of_cell[cell];
            all[..named].iter().position(|&(_, of, at)| of == material && Some(at) == piece).unwrap_or(named)
        };
        let mut split = vec![vec![0.0; mesh.grid().len()]; named + 1];
        for (material, fractions) in fractions.iter().enumerate() {
            for (cell, &fraction) in fractions.iter().enumerate().filter(|(_, fraction)| **fraction != 0.0) {
                split[rank(material, cell)][cell] += fraction;
            }
        }
        let facets: Vec<Facet<D>> = facets
            .iter()
            .map(|facet| Facet { material: rank(facet.material, facet.cell), ..facet.clone() })
            .collect();
        let described =
            |&(volume, material, _): &(f64, usize, usize)| format!("{}, {volume:.3e}", names[material]);
        let mut names: Vec<String> = all[..named].iter().map(described).collect();
        let mut colours = AREAS[..named].to_vec();
        let strays = split[named].iter().any(|&fraction| fraction != 0.0);
        names.push(match (others, strays) {
            (0, _) => "remainders".to_owned(),
            _ => format!("{others} smaller"),
        });
        colours.push(GREY);
        if others == 0 && !strays && facets.iter().all(|facet| facet.material < named) {
            names.pop();
            colours.pop();
            split.pop();
        }
        Self { names, fractions: split, facets, colours }
    }

    /// The snapshot of the pieces.
    pub(super) fn snapshot<'a, C>(&'a self, whole: &Snapshot<'a, C, D>) -> Snapshot<'a, C, D> {
        Snapshot { names: &self.names, fractions: &self.fractions, facets: &self.facets, ..*whole }
    }
}
