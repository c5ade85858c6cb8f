//! Numbers that judge a field.

use vofkit_geometry::Cell;

use super::{Fields, state::sampled};
use crate::mesh::{Grid, Mesh};
use crate::metrics::{extremes, total_variation};
use crate::nodal::nodal_integral;
use crate::parallel;
use crate::profile::Profile;
use crate::scene::Location;

/// What a field is worth at one time; components are added up.
#[derive(Clone, Debug)]
pub(in crate::run) struct Measure {
    /// `sum phi V`, or `sum phi rho V`, by component.
    pub(super) amounts: Vec<f64>,
    /// `sum |phi| V`, or `sum |phi| rho V`.
    pub(super) magnitude: f64,
    /// The least and the largest value of any component.
    pub(super) extremes: [f64; 2],
    /// The total variation of cell means or node values.
    pub(super) total_variation: f64,
    /// `sum |phi - exact| V` over the volume of the mesh; none where the exact values are not known.
    pub(super) l1_error: Option<f64>,
}

impl<const D: usize> Fields<'_, D> {
    /// The least and the largest value of a field.
    pub(super) fn extremes_of(&self, field: usize) -> [f64; 2] {
        // Those at integration points, where they are kept.
        let at_points = self.state.points[field].as_slice().concat();
        let values = if at_points.is_empty() { self.values(field) } else { &at_points };
        values
            .iter()
            .map(|values| extremes(values))
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], [c, d]| [a.min(c), b.max(d)])
    }

    /// The measures of all fields, with the profiles where they should be, if they are known.
    pub(in crate::run) fn measures<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        exact: Option<&[Option<Vec<Profile<D>>>]>,
    ) -> Vec<Measure> {
        let grid = mesh.grid();
        let of_field = |k: usize| {
            let setup = &self.setups[k];
            let weights = self.amounts(k, mesh);
            let at_nodes = matches!(setup.location, Location::Node(_));
            let integral = |values: &[f64], weights: &[f64]| {
                if at_nodes {
                    return nodal_integral(grid, values, weights);
                }
                parallel::sum(values.len(), |cell| values[cell] * weights[cell])
            };
            let lattice = lattice(grid, at_nodes);
            let values = self.values(k);
            let magnitudes = |values: &[f64]| values.iter().map(|v| v.abs()).collect::<Vec<f64>>();
            let exact =
                exact.and_then(|exact| exact[k].as_ref()).map(|profiles| sampled(setup, profiles, mesh));
            let error = |exact: Vec<Vec<f64>>| {
                let of_component = |(values, exact): (&Vec<f64>, &Vec<f64>)| {
                    let differences: Vec<f64> =
                        values.iter().zip(exact).map(|(a, b)| (a - b).abs()).collect();
                    integral(&differences, mesh.volumes())
                };
                values.iter().zip(&exact).map(of_component).sum::<f64>() / mesh.total_volume()
            };
            Measure {
                amounts: values.iter().map(|values| integral(values, &weights)).collect(),
                magnitude: values.iter().map(|values| integral(&magnitudes(values), &weights)).sum(),
                extremes: self.extremes_of(k),
                total_variation: values.iter().map(|values| total_variation(&lattice, values)).sum(),
                l1_error: exact.map(error),
            }
        };
        (0..self.setups.len()).map(of_field).collect()
    }
}

/// The grid of the values: that of the cells, or one with the nodes as its cells.
fn lattice<const D: usize>(grid: &Grid<D>, at_nodes: bool) -> Grid<D> {
    if at_nodes { Grid::new(grid.cells().map(|n| n + 1), [false; D]) } else { grid.clone() }
}
