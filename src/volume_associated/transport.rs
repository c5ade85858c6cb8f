//! The transport of volume-associated quantities: what stays the same over a run, and one step.

use vofkit_geometry::Cell;

use super::carrier::{Carrier, Overdrawn};
use super::face_values::{self, Means};
use super::face_volumes::{FaceVolumes, Splitting};
use super::fct::Correction;
use super::limiter::AlphaRange;
use super::pointwise::PointError;
use super::scheme::Scheme;
use super::spacing::Spacing;
use super::update;
use crate::advection::StepError;
use crate::mesh::{Grid, Mesh, SweptVolumes};
use crate::parallel;
use crate::velocity::StepFluxes;

/// What carries a quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighting {
    /// Volume (Eq. 48): `sum phi V` is conserved.
    #[default]
    Volume,
    /// Mass (Eq. 51), with the density that is the quantity of this index: `sum phi rho V` is conserved.
    Mass(usize),
}

/// How one scalar quantity, or one component of a vector or tensor, is transported.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quantity {
    /// The scheme.
    pub scheme: Scheme,
    /// What carries it.
    pub weighting: Weighting,
    /// Its value in what flows in through open ends; none for that of the cell it flows into.
    pub inflow: Option<f64>,
}

/// A transport that cannot be done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TransportError {
    /// A cell gives away more than it holds.
    #[error(transparent)]
    Step(#[from] StepError),
    /// As many lists of values as quantities are wanted, one value per cell each.
    #[error("quantity {quantity} has {found} values for {wanted} cells")]
    Length {
        /// The quantity.
        quantity: usize,
        /// Its values.
        found: usize,
        /// The cells.
        wanted: usize,
    },
    /// There are not as many lists of values as quantities.
    #[error("there are {found} lists of values for {wanted} quantities")]
    Count {
        /// Lists of values.
        found: usize,
        /// Quantities.
        wanted: usize,
    },
    /// A value that is not a number.
    #[error("quantity {quantity} is {value} in cell {cell:?}")]
    NotFinite {
        /// The quantity.
        quantity: usize,
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// The value.
        value: f64,
    },
    /// A density below zero.
    #[error("the density that is quantity {quantity} is {value} in cell {cell:?}: masses are not negative")]
    NegativeMass {
        /// The quantity.
        quantity: usize,
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// The density.
        value: f64,
    },
    /// A density that is no quantity, or itself weighted with mass.
    #[error(
        "quantity {quantity} is weighted with the density {density}, which is no quantity weighted with volume"
    )]
    NoDensity {
        /// The quantity.
        quantity: usize,
        /// Its density.
        density: usize,
    },
    /// A limiter out of range.
    #[error(transparent)]
    Alpha(#[from] AlphaRange),
    /// Values at integration points that cannot be moved.
    #[error(transparent)]
    Points(#[from] PointError),
}

/// What a step did to each quantity.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldLedger {
    /// By quantity: the amount `phi V` (or `phi rho V`) that left through open ends, less what came in.
    pub outflow: Vec<f64>,
}

/// Moves quantities through a mesh. All of them share the volumes that cross the faces.
#[derive(Clone, Debug)]
pub struct VolumeTransport<const D: usize> {
    grid: Grid<D>,
    splitting: Splitting,
    overdraft: bool,
    spacing: Spacing<D>,
    volumes: Vec<f64>,
    crossing: FaceVolumes<D>,
    carrier: Carrier<D>,
    change: Vec<f64>,
    work: Workspace<D>,
}

/// Memory that the passes use again.
#[derive(Clone, Debug)]
struct Workspace<const D: usize> {
    half: Vec<f64>,
    faces: [Vec<f64>; D],
    density_faces: [Vec<f64>; D],
    next: Vec<f64>,
    /// The density before a pass.
    density: Vec<f64>,
    /// For mass-weighted quantities.
    mass: Option<Box<Carrier<D>>>,
    /// For flux-corrected ones.
    correction: Option<Box<Correction<D>>>,
}

impl<const D: usize> VolumeTransport<D> {
    /// A transport through this mesh; with `overdraft` it goes on where cells give away more than they hold.
    pub fn new<C: Cell<D>>(mesh: &Mesh<C, D>, splitting: Splitting, overdraft: bool) -> Self {
        let grid = mesh.grid().clone();
        let crossing = FaceVolumes::zero(&grid);
        let cells = vec![0.0; grid.len()];
        let work = Workspace {
            half: cells.clone(),
            faces: crossing.through.clone(),
            density_faces: std::array::from_fn(|_| Vec::new()),
            next: cells.clone(),
            density: Vec::new(),
            mass: None,
            correction: None,
        };
        Self {
            splitting,
            overdraft,
            spacing: Spacing::new(mesh),
            volumes: mesh.volumes().to_vec(),
            carrier: Carrier::new(&grid),
            crossing,
            change: cells,
            work,
            grid,
        }
    }

    /// Moves `values[quantity][cell]` in flow mode, by the fluxes of a step. The order of the sweeps follows `step`.
    ///
    /// # Errors
    /// See [`TransportError`]; the values are then as before.
    pub fn flow(
        &mut self,
        fluxes: &StepFluxes<'_, D>,
        step: usize,
        quantities: &[Quantity],
        values: &mut [Vec<f64>],
    ) -> Result<FieldLedger, TransportError> {
        self.crossing.set_flow(&self.grid, fluxes);
        self.step(step, quantities, values)
    }

    /// Moves `values[quantity][cell]` in remesh mode, while the nodes move and the faces sweep volumes; [`VolumeTransport::set_mesh`] with the
    /// mesh before comes first. The values are then those of the cells of the mesh after.
    ///
    /// # Errors
    /// See [`TransportError`]; the values are then as before.
    pub fn remesh(
        &mut self,
        swept: &SweptVolumes<D>,
        step: usize,
        quantities: &[Quantity],
        values: &mut [Vec<f64>],
    ) -> Result<FieldLedger, TransportError> {
        self.crossing.set_swept(&self.grid, swept);
        self.step(step, quantities, values)
    }

    /// Goes on with the places of the nodes in `mesh`, whose cells are counted alike.
    pub fn set_mesh<C: Cell<D>>(&mut self, mesh: &Mesh<C, D>) {
        self.spacing = Spacing::new(mesh);
        self.volumes.clone_from_slice(mesh.volumes());
    }

    fn step(
        &mut self,
        step: usize,
        quantities: &[Quantity],
        values: &mut [Vec<f64>],
    ) -> Result<FieldLedger, TransportError> {
        let order = crate::advection::sweep_order(step);
        self.check(order, quantities, values)?;
        Ok(self.go(order, quantities, values))
    }

    fn check(
        &mut self,
        order: [usize; D],
        quantities: &[Quantity],
        values: &[Vec<f64>],
    ) -> Result<(), TransportError> {
        check_values(&self.grid, quantities, values)?;
        if self.overdraft {
            return Ok(());
        }
        let Self { grid, volumes, crossing, carrier, change, .. } = self;
        change.fill(0.0);
        for pass in self.splitting.passes(order) {
            carrier.set_volume(grid, pass, crossing, volumes, change);
            if let Some(Overdrawn { cell, holds, outflow }) = carrier.overdrawn(grid, pass, volumes) {
                let cell = grid.offset(cell).to_vec();
                return Err(StepError::Overdrawn { cell, volume: holds, outflow }.into());
            }
        }
        Ok(())
    }

    fn go(&mut self, order: [usize; D], quantities: &[Quantity], values: &mut [Vec<f64>]) -> FieldLedger {
        let Self { grid, spacing, volumes, crossing, carrier, change, work, .. } = self;
        let mut ledger = FieldLedger { outflow: vec![0.0; quantities.len()] };
        change.fill(0.0);
        for pass in self.splitting.passes(order) {
            carrier.set_volume(grid, pass, crossing, volumes, change);
            let by_volume = |k: &usize| quantities[*k].weighting == Weighting::Volume;
            for k in (0..quantities.len()).filter(by_volume) {
                let by_mass = |other: &usize| quantities[*other].weighting == Weighting::Mass(k);
                let is_density = (0..quantities.len()).any(|other| by_mass(&other));
                if is_density {
                    work.density.clone_from(&values[k]);
                }
                ledger.outflow[k] += work.pass(grid, spacing, pass, carrier, quantities[k], &mut values[k]);
                if !is_density {
                    continue;
                }
                std::mem::swap(&mut work.faces, &mut work.density_faces);
                if work.faces[0].is_empty() {
                    work.faces.clone_from(&work.density_faces);
                }
                let mut mass = work.mass.take().unwrap_or_else(|| Box::new(Carrier::new(grid)));
                mass.set_mass(grid, pass, carrier, [&work.density, &values[k]], &work.density_faces);
                for other in (0..quantities.len()).filter(by_mass) {
                    ledger.outflow[other] +=
                        work.pass(grid, spacing, pass, &mass, quantities[other], &mut values[other]);
                }
                work.mass = Some(mass);
            }
        }
        ledger
    }
}

impl<const D: usize> Workspace<D> {
    /// One quantity through one pass; returns what left through open ends.
    fn pass(
        &mut self,
        grid: &Grid<D>,
        spacing: &Spacing<D>,
        pass: super::face_volumes::Pass,
        carrier: &Carrier<D>,
        quantity: Quantity,
        values: &mut Vec<f64>,
    ) -> f64 {
        let Self { half, faces, next, correction, .. } = self;
        let means = Means { grid, spacing, values, inflow: quantity.inflow };
        face_values::set(means, quantity.scheme, carrier, pass, half, faces);
        if quantity.scheme == Scheme::Fct {
            let correction = correction.get_or_insert_with(|| Box::new(Correction::new(grid)));
            correction.limit(means, carrier, pass, faces);
        }
        update::advance(grid, pass, carrier, values, faces, next);
        std::mem::swap(values, next);
        update::left(grid, pass, carrier, faces)
    }
}

/// Whether the values can be moved: everything but the time step.
fn check_values<const D: usize>(
    grid: &Grid<D>,
    quantities: &[Quantity],
    values: &[Vec<f64>],
) -> Result<(), TransportError> {
    if values.len() != quantities.len() {
        return Err(TransportError::Count { found: values.len(), wanted: quantities.len() });
    }
    let first = |values: &[f64], odd: fn(f64) -> bool| {
        let row = grid.cells()[0];
        let of_row =
            |r: usize| values[r * row..(r + 1) * row].iter().position(|&v| odd(v)).map(|i| r * row + i);
        parallel::map(values.len() / row, of_row).into_iter().flatten().next()
    };
    for (quantity, (of_quantity, values)) in quantities.iter().zip(values).enumerate() {
        if values.len() != grid.len() {
            return Err(TransportError::Length { quantity, found: values.len(), wanted: grid.len() });
        }
        if let Some(limiter) = of_quantity.scheme.limiter() {
            limiter.check()?;
        }
        if let Some(cell) = first(values, |value| !value.is_finite()) {
            return Err(TransportError::NotFinite {
                quantity,
                cell: grid.offset(cell).to_vec(),
                value: values[cell],
            });
        }
    }
    for (quantity, of_quantity) in quantities.iter().enumerate() {
        let Weighting::Mass(density) = of_quantity.weighting else { continue };
        if quantities.get(density).is_none_or(|density| density.weighting != Weighting::Volume) {
            return Err(TransportError::NoDensity { quantity, density });
        }
        if let Some(cell) = first(&values[density], |value| value < 0.0) {
            return Err(TransportError::NegativeMass {
                quantity: density,
                cell: grid.offset(cell).to_vec(),
                value: values[density][cell],
            });
        }
    }
    Ok(())
}
