//! The quantities of a run that belong to its materials: their values and their account.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use vofkit_geometry::Cell;

use crate::advection::QuantityLedger;
#[cfg(feature = "vtk")]
use crate::export::vtk::CellArray;
use crate::mesh::Mesh;
#[cfg(feature = "vtk")]
use crate::quantity::effective;
use crate::quantity::{MaterialQuantity, totals};
use crate::report::QuantitySummary;
use crate::scene::{QuantitySetup, Resolved};

/// All quantities of materials of a run.
#[derive(Debug)]
pub(super) struct Quantities<'a, const D: usize> {
    /// With the names of their materials.
    setups: Vec<(&'a str, &'a QuantitySetup<D>)>,
    pub(super) values: Vec<MaterialQuantity>,
    /// Sums over components, and of magnitudes, at the start.
    start: Vec<(f64, f64)>,
    extremes: Vec<[f64; 2]>,
    ledger: Vec<QuantityLedger>,
}

/// What changes of them from step to step, and what they started from.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct QuantityValues<'a> {
    /// By quantity, component and cell.
    values: Vec<Cow<'a, [Vec<f64>]>>,
    start: Cow<'a, [(f64, f64)]>,
    extremes: Cow<'a, [[f64; 2]]>,
    ledger: Cow<'a, [QuantityLedger]>,
}

impl<'a, const D: usize> Quantities<'a, D> {
    /// The quantities of a scene at its start.
    pub(super) fn new<C: Cell<D>>(scene: &'a Resolved<D>, mesh: &Mesh<C, D>, fractions: &[Vec<f64>]) -> Self {
        let (mut setups, mut values) = (Vec::new(), Vec::new());
        for (material, of) in scene.materials.iter().enumerate() {
            let first = values.len();
            for setup in &of.quantities {
                let start = setup.initial.iter().map(|profile| profile.cell_means(mesh)).collect();
                let quantity = MaterialQuantity {
                    distribution: setup.distribution,
                    inflow: setup.inflow.clone(),
                    ..MaterialQuantity::new(material, start)
                };
                values.push(match setup.density {
                    None => quantity,
                    Some(density) => quantity.by_mass(first + density),
                });
                setups.push((of.name.as_str(), setup));
            }
        }
        // As they are from the first step on.
        for MaterialQuantity { material, values, .. } in &mut values {
            for values in values {
                for (value, f) in values.iter_mut().zip(&fractions[*material]) {
                    *value = if *f > 0.0 { *value } else { 0.0 };
                }
            }
        }
        let mut quantities = Self {
            ledger: vec![QuantityLedger::default(); values.len()],
            extremes: vec![[f64::INFINITY, f64::NEG_INFINITY]; values.len()],
            start: Vec::new(),
            setups,
            values,
        };
        quantities.start = quantities.totals(mesh, fractions);
        quantities.note(fractions, &[]);
        quantities
    }

    /// What they are after the last step.
    pub(super) fn state(&self) -> QuantityValues<'_> {
        QuantityValues {
            values: self.values.iter().map(|quantity| Cow::Borrowed(&*quantity.values)).collect(),
            start: Cow::Borrowed(&self.start),
            extremes: Cow::Borrowed(&self.extremes),
            ledger: Cow::Borrowed(&self.ledger),
        }
    }

    /// Puts them to where they were; returns false for the values of other quantities.
    pub(super) fn go_on(&mut self, state: QuantityValues<'_>) -> bool {
        let lengths = |values: &[Vec<f64>]| values.iter().map(Vec::len).collect::<Vec<_>>();
        let count = self.values.len();
        let fits = |(quantity, values): (&MaterialQuantity, &Cow<'_, [Vec<f64>]>)| {
            lengths(&quantity.values) == lengths(values)
        };
        if [state.values.len(), state.start.len(), state.extremes.len(), state.ledger.len()] != [count; 4]
            || !self.values.iter().zip(&state.values).all(fits)
        {
            return false;
        }
        for (quantity, values) in self.values.iter_mut().zip(state.values) {
            quantity.values = values.into_owned();
        }
        self.start = state.start.into_owned();
        self.extremes = state.extremes.into_owned();
        self.ledger = state.ledger.into_owned();
        true
    }

    fn totals<C: Cell<D>>(&self, mesh: &Mesh<C, D>, fractions: &[Vec<f64>]) -> Vec<(f64, f64)> {
        let of = |k: usize| {
            let (sums, magnitude) = totals(mesh, fractions, &self.values, k);
            (sums.iter().sum(), magnitude)
        };
        (0..self.values.len()).map(of).collect()
    }

    /// Takes in the values after a step, and what it did.
    pub(super) fn note(&mut self, fractions: &[Vec<f64>], ledger: &[QuantityLedger]) {
        for (total, of_step) in self.ledger.iter_mut().zip(ledger) {
            total.add(of_step);
        }
        for (quantity, extremes) in self.values.iter().zip(&mut self.extremes) {
            for values in &quantity.values {
                for (value, _) in values.iter().zip(&fractions[quantity.material]).filter(|(_, f)| **f > 0.0)
                {
                    *extremes = [extremes[0].min(*value), extremes[1].max(*value)];
                }
            }
        }
    }

    /// The account at the end.
    pub(super) fn summaries<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        fractions: &[Vec<f64>],
    ) -> Vec<QuantitySummary> {
        let summary = |(k, (end, _)): (usize, (f64, f64))| {
            let (material, setup) = self.setups[k];
            let ((start, magnitude), ledger) = (self.start[k], self.ledger[k]);
            let relative = |amount: f64| (magnitude > 0.0).then(|| amount / magnitude);
            let [minimum, maximum] = self.extremes[k];
            QuantitySummary {
                name: setup.name.clone(),
                material: material.to_owned(),
                conserved: relative(end - start + ledger.outflow),
                minimum,
                maximum,
                corrected: relative(ledger.limited),
            }
        };
        self.totals(mesh, fractions).into_iter().enumerate().map(summary).collect()
    }

    /// Effective values (Eq. 12 of the paper) by name and component, where several materials have a quantity of one name and kind.
    #[cfg(feature = "vtk")]
    pub(super) fn mixtures(&self, fractions: &[Vec<f64>]) -> Vec<(String, Vec<Vec<f64>>)> {
        let mut mixtures = Vec::new();
        for (k, (_, setup)) in self.setups.iter().enumerate() {
            let is_same = |other: &usize| {
                let (_, other) = self.setups[*other];
                other.name == setup.name && other.kind == setup.kind
            };
            let parts: Vec<usize> = (0..self.setups.len()).filter(is_same).collect();
            if parts.len() > 1 && parts[0] == k {
                let of_component = |component| effective(fractions, &self.values, &parts, component);
                let values = (0..self.values[k].values.len()).map(of_component).collect();
                mixtures.push((setup.name.clone(), values));
            }
        }
        mixtures
    }

    /// The values for viewers, `name.material`, and with these `mixtures`.
    #[cfg(feature = "vtk")]
    pub(super) fn arrays<'b>(&'b self, mixtures: &'b [(String, Vec<Vec<f64>>)]) -> Vec<CellArray<'b, D>> {
        let array = |name: String, values: &'b [Vec<f64>]| {
            CellArray::components(name, &values.iter().map(Vec::as_slice).collect::<Vec<_>>())
        };
        let own = |((material, setup), quantity): (&(&str, &QuantitySetup<D>), &'b MaterialQuantity)| {
            array(format!("{}.{material}", setup.name), &quantity.values)
        };
        let of_mixtures = mixtures.iter().map(|(name, values)| array(name.clone(), values));
        self.setups.iter().zip(&self.values).map(own).chain(of_mixtures).collect()
    }
}
