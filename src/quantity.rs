//! Quantities that belong to a material: density, stress, internal variables; values in every cell that holds the material.

use crate::interface::{ReconstructionError, check_fractions};
use crate::mesh::{Grid, Mesh};
use crate::parallel;
use crate::volume_associated::Weighting;
use vofkit_geometry::Cell;

/// How values are distributed over a cell while they are carried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Distribution {
    /// Constant: first order.
    Constant,
    /// Linear with limited slopes, in cells that hold nothing but the material and lie among such.
    #[default]
    Linear,
}

/// A quantity of one material.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialQuantity {
    /// The material.
    pub material: usize,
    /// What it is conserved with: the volume of the material (Eq. 48 of the paper) or its mass (Eq. 51), with the density at this
    /// place among the quantities: one of the same material with one component, conserved with the volume.
    pub weighting: Weighting,
    /// How it is distributed over a cell.
    pub distribution: Distribution,
    /// Its values by component, then by cell. Cells without the material are not read; they get 0.
    pub values: Vec<Vec<f64>>,
    /// The values in material that flows in through open ends, by component; needed where it does.
    pub inflow: Option<Vec<f64>>,
}

impl MaterialQuantity {
    /// A quantity with these values by component, then by cell; conserved with the volume.
    pub fn new(material: usize, values: Vec<Vec<f64>>) -> Self {
        let distribution = Distribution::default();
        Self { material, weighting: Weighting::Volume, distribution, values, inflow: None }
    }

    /// The same, conserved with the mass: `density` is its place among the quantities.
    #[must_use]
    pub fn by_mass(self, density: usize) -> Self {
        Self { weighting: Weighting::Mass(density), ..self }
    }

    fn components(&self) -> usize {
        self.values.len()
    }
}

/// Materials on a mesh: their fractions, and what belongs to them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// Volume fractions by material, then by cell.
    pub fractions: Vec<Vec<f64>>,
    /// Quantities of the materials.
    pub quantities: Vec<MaterialQuantity>,
}

/// A quantity that cannot be carried.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuantityError {
    /// A material that is not there.
    #[error("quantity {quantity} belongs to material {material}, and there are {materials}")]
    Material {
        /// The place of the quantity.
        quantity: usize,
        /// Its material.
        material: usize,
        /// The number of materials.
        materials: usize,
    },
    /// Values that are not one for each cell.
    #[error(
        "component {component} of quantity {quantity} has {given} values, and the mesh has {cells} cells"
    )]
    Length {
        /// The place of the quantity.
        quantity: usize,
        /// The component.
        component: usize,
        /// The number of its values.
        given: usize,
        /// The number of cells.
        cells: usize,
    },
    /// A value that is not finite, where there is material.
    #[error("component {component} of quantity {quantity} is {value} in cell {cell:?}")]
    Value {
        /// The place of the quantity.
        quantity: usize,
        /// The component.
        component: usize,
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// The value.
        value: f64,
    },
    /// Inflow values that are missing, or not one finite number for each component.
    #[error("material {material} flows in, and quantity {quantity} needs {components} finite inflow values")]
    Inflow {
        /// The place of the quantity.
        quantity: usize,
        /// Its material.
        material: usize,
        /// Its components.
        components: usize,
    },
    /// A density that is none.
    #[error(
        "quantity {quantity} is conserved with the mass, and quantity {density} is no density: one component, of the same \
         material, conserved with the volume"
    )]
    Density {
        /// The place of the quantity.
        quantity: usize,
        /// That of the density.
        density: usize,
    },
    /// A density that is not positive, where there is material.
    #[error("the density, quantity {density}, is {value} in cell {cell:?}, and should be above 0")]
    NotPositive {
        /// The place of the density.
        density: usize,
        /// The cell's index along each axis; empty for what flows in.
        cell: Vec<usize>,
        /// The value.
        value: f64,
    },
    /// Fractions that are none.
    #[error(transparent)]
    Fractions(#[from] ReconstructionError),
}

impl State {
    /// Materials without quantities.
    pub fn of_fractions(fractions: Vec<Vec<f64>>) -> Self {
        Self { fractions, quantities: Vec::new() }
    }

    /// Checks fractions and quantities; `inflow` is the material that flows in through open ends.
    ///
    /// # Errors
    /// The first thing that is wrong, with its place.
    pub fn check<const D: usize>(&self, grid: &Grid<D>, inflow: Option<usize>) -> Result<(), QuantityError> {
        self.fractions.iter().try_for_each(|f| check_fractions(grid, f))?;
        check(grid, &self.fractions, &self.quantities, inflow)
    }
}

/// Checks quantities.
pub(crate) fn check<const D: usize>(
    grid: &Grid<D>,
    fractions: &[Vec<f64>],
    quantities: &[MaterialQuantity],
    inflow: Option<usize>,
) -> Result<(), QuantityError> {
    for (place, quantity) in quantities.iter().enumerate() {
        let material = quantity.material;
        let Some(f) = fractions.get(material) else {
            return Err(QuantityError::Material { quantity: place, material, materials: fractions.len() });
        };
        for (component, values) in quantity.values.iter().enumerate() {
            if values.len() != grid.len() {
                let (given, cells) = (values.len(), grid.len());
                return Err(QuantityError::Length { quantity: place, component, given, cells });
            }
            if let Some(cell) = (0..grid.len()).find(|&cell| f[cell] > 0.0 && !values[cell].is_finite()) {
                let (value, cell) = (values[cell], grid.offset(cell).to_vec());
                return Err(QuantityError::Value { quantity: place, component, cell, value });
            }
        }
        let components = quantity.components();
        let given = quantity.inflow.as_deref();
        let fits = given.is_some_and(|v| v.len() == components && v.iter().all(|v| v.is_finite()));
        if !fits && (given.is_some() || inflow == Some(material)) {
            return Err(QuantityError::Inflow { quantity: place, material, components });
        }
    }
    for (place, quantity) in quantities.iter().enumerate() {
        let Weighting::Mass(density) = quantity.weighting else { continue };
        let fits = |other: &&MaterialQuantity| {
            other.material == quantity.material
                && other.components() == 1
                && other.weighting == Weighting::Volume
        };
        let Some(rho) = quantities.get(density).filter(fits) else {
            return Err(QuantityError::Density { quantity: place, density });
        };
        let (f, values) = (&fractions[rho.material], &rho.values[0]);
        if let Some(cell) = (0..grid.len()).find(|&cell| f[cell] > 0.0 && values[cell] <= 0.0) {
            let (value, cell) = (values[cell], grid.offset(cell).to_vec());
            return Err(QuantityError::NotPositive { density, cell, value });
        }
        if let Some(&value) = rho.inflow.iter().flatten().find(|&&value| value <= 0.0) {
            return Err(QuantityError::NotPositive { density, cell: Vec::new(), value });
        }
    }
    Ok(())
}

/// What there is of a quantity in all, `sum phi f V` or `sum phi rho f V`, by component; and the sum of all magnitudes.
pub fn totals<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fractions: &[Vec<f64>],
    quantities: &[MaterialQuantity],
    quantity: usize,
) -> (Vec<f64>, f64) {
    let MaterialQuantity { material, weighting, ref values, .. } = quantities[quantity];
    let amount = |values: &[f64], cell: usize| {
        let f = fractions[material][cell];
        if f == 0.0 {
            return 0.0;
        }
        let weight = match weighting {
            Weighting::Volume => 1.0,
            Weighting::Mass(density) => quantities[density].values[0][cell],
        };
        values[cell] * weight * f * mesh.volumes()[cell]
    };
    let cells = mesh.grid().len();
    let sums = values.iter().map(|values| parallel::sum(cells, |cell| amount(values, cell))).collect();
    let magnitudes = values.iter().map(|values| parallel::sum(cells, |cell| amount(values, cell).abs()));
    (sums, magnitudes.sum())
}

/// The effective values of one component of a quantity that several materials have, `sum over materials of phi f` (Eq. 12 of the
/// paper), by cell. `parts` are the places of the quantity of each material.
pub fn effective(
    fractions: &[Vec<f64>],
    quantities: &[MaterialQuantity],
    parts: &[usize],
    component: usize,
) -> Vec<f64> {
    let cells = fractions.first().map_or(0, Vec::len);
    parallel::map(cells, |cell| {
        let of_part = |&part: &usize| {
            let quantity = &quantities[part];
            let f = fractions[quantity.material][cell];
            if f > 0.0 { quantity.values[component][cell] * f } else { 0.0 }
        };
        parts.iter().map(of_part).sum()
    })
}
