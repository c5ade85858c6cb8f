//! The quantities of a run that belong to the mesh: their values, their steps and their account.
//!
//! - this file: what they are and how they move; `measure`: the numbers that judge them; `exact`: where they should be;
//! - `table`: those numbers after every step; `view`: the values for files and pictures.

mod exact;
mod measure;
mod table;
mod view;

use std::ops::Range;

use vofkit_geometry::Cell;

pub(super) use exact::exact;
pub(super) use measure::Measure;
pub(super) use table::{FIELD_TABLE, FieldTable};
pub(super) use view::{is_field_picture, picture_files};

use super::prepare::Mover;
use crate::advection::{Scheme, StepError, SweepOrder};
use crate::mesh::{Mesh, SweptVolumes};
use crate::profile::Profile;
use crate::report::FieldSummary;
use crate::scene::{FieldSetup, Location, Resolved};
use crate::velocity::Velocity;
use crate::volume_associated::{Quantity, Splitting, TransportError, VolumeTransport, Weighting, points};

/// All fields of a run.
#[derive(Debug)]
pub(super) struct Fields<'a, const D: usize> {
    setups: &'a [FieldSetup<D>],
    transport: VolumeTransport<D>,
    quantities: Vec<Quantity>,
    /// Means over the cells, by quantity; those of fields at nodes belong to their last step.
    means: Vec<Vec<f64>>,
    /// The quantities of each field, all components one after the other.
    ranges: Vec<Range<usize>>,
    /// Values at nodes, by field and component; none for other fields.
    nodes: Vec<Vec<Vec<f64>>>,
    /// Means and node values before the last step.
    before: (Vec<Vec<f64>>, Vec<Vec<Vec<f64>>>),
    start: Vec<Measure>,
    /// By field: what left through open ends less what came in, and the least and largest value so far.
    outflow: Vec<f64>,
    extremes: Vec<[f64; 2]>,
}

impl<'a, const D: usize> Fields<'a, D> {
    /// The fields of a scene at its start; `overdraft` where cells may give away more than they hold.
    pub(super) fn new<C: Cell<D>>(scene: &'a Resolved<D>, mesh: &Mesh<C, D>, overdraft: bool) -> Self {
        let setups = &scene.fields;
        let mut fields = Self {
            setups,
            transport: VolumeTransport::new(mesh, splitting(scene), overdraft),
            quantities: Vec::new(),
            means: Vec::new(),
            ranges: Vec::new(),
            nodes: Vec::new(),
            before: (Vec::new(), Vec::new()),
            start: Vec::new(),
            outflow: vec![0.0; setups.len()],
            extremes: Vec::new(),
        };
        let mut first = 0;
        for setup in setups {
            let count = setup.initial.len() * quantities_per_component(setup, D);
            fields.ranges.push(first..first + count);
            first += count;
        }
        for setup in setups {
            let weighting =
                setup.density.map_or(Weighting::Volume, |k| Weighting::Mass(fields.ranges[k].start));
            let values = sampled(setup, &setup.initial, mesh);
            for (component, values) in values.iter().enumerate() {
                let inflow = setup.inflow.as_ref().map(|inflow| inflow[component]);
                let quantity = Quantity { scheme: setup.scheme, weighting, inflow };
                let quantities = match setup.location {
                    Location::Cell | Location::Points => vec![values.clone()],
                    Location::Node(nodal) => nodal.to_cells(mesh.grid(), values),
                };
                fields.quantities.extend(vec![quantity; quantities.len()]);
                fields.means.extend(quantities);
            }
            let at_nodes = matches!(setup.location, Location::Node(_));
            fields.nodes.push(if at_nodes { values } else { Vec::new() });
        }
        fields.start = fields.measures(mesh, None);
        fields.extremes = fields.start.iter().map(|measure| measure.extremes).collect();
        fields
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.setups.is_empty()
    }

    /// Moves all fields by a part of a run that ends at `run_end`, from one time to another, as the materials will be.
    pub(super) fn step<C: Cell<D>>(
        &mut self,
        mover: &Mover<'_, C, D>,
        velocity: &Velocity,
        [start, end]: [f64; 2],
        run_end: f64,
        step: usize,
    ) -> Result<(), TransportError> {
        let before = mover.mesh();
        let grid = before.grid();
        self.before.0.clone_from(&self.means);
        self.before.1.clone_from(&self.nodes);
        for (k, setup) in self.setups.iter().enumerate() {
            let Location::Node(nodal) = setup.location else { continue };
            let each = nodal.quantities(D);
            for (component, values) in self.nodes[k].iter().enumerate() {
                let first = self.ranges[k].start + component * each;
                self.means[first..first + each].clone_from_slice(&nodal.to_cells(grid, values));
            }
        }
        let Self { transport, quantities, means, .. } = self;
        let mut place = None;
        let moved = match mover {
            Mover::Flow(materials) => {
                transport.flow(materials.fluxes(), velocity.duration(start, end), step, quantities, means)
            }
            Mover::Remesh { path, at, .. } => {
                let after = place.insert(path.mesh(end / run_end).map_err(StepError::from)?);
                transport.set_mesh(at);
                let swept = SweptVolumes::new(at, after).map_err(StepError::from)?;
                transport.remesh(&swept, step, quantities, means)
            }
        };
        let after = place.as_ref().unwrap_or(before);
        let ledger = match moved {
            Ok(ledger) => ledger,
            Err(error) => {
                self.restore();
                return Err(error);
            }
        };
        for (k, setup) in self.setups.iter().enumerate() {
            let each = quantities_per_component(setup, D);
            let range = self.ranges[k].clone();
            self.outflow[k] += ledger.outflow[range.clone()].iter().sum::<f64>() / each as f64;
            if let Location::Node(nodal) = setup.location {
                let amounts = self.amounts(k, after);
                for (component, values) in self.nodes[k].iter_mut().enumerate() {
                    let first = range.start + component * each;
                    nodal.to_nodes(grid, &self.means[first..first + each], &amounts, values);
                }
            }
            let [low, high] = self.extremes_of(k);
            let [least, most] = self.extremes[k];
            self.extremes[k] = [least.min(low), most.max(high)];
        }
        Ok(())
    }

    /// Puts the values back to those before the last step, whose other half failed.
    pub(super) fn restore(&mut self) {
        std::mem::swap(&mut self.means, &mut self.before.0);
        std::mem::swap(&mut self.nodes, &mut self.before.1);
    }

    /// The volumes, or masses, that carry a field.
    fn amounts<C: Cell<D>>(&self, field: usize, mesh: &Mesh<C, D>) -> Vec<f64> {
        match self.setups[field].density {
            None => mesh.volumes().to_vec(),
            Some(density) => {
                let density = &self.means[self.ranges[density].start];
                mesh.volumes().iter().zip(density).map(|(volume, density)| volume * density).collect()
            }
        }
    }

    /// The values of a field by component: means over cells, or values at nodes.
    fn values(&self, field: usize) -> &[Vec<f64>] {
        match self.setups[field].location {
            Location::Node(_) => &self.nodes[field],
            Location::Cell | Location::Points => &self.means[self.ranges[field].clone()],
        }
    }

    /// The account of the fields at the end; `exact` as from [`exact`].
    pub(super) fn summaries<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        exact: &[Option<Vec<Profile<D>>>],
    ) -> Vec<FieldSummary> {
        let summary = |(k, end): (usize, Measure)| {
            let (setup, start) = (&self.setups[k], &self.start[k]);
            let drift = end.amounts.iter().zip(&start.amounts).map(|(end, start)| end - start);
            let drift = drift.sum::<f64>() + self.outflow[k];
            let [minimum, maximum] = self.extremes[k];
            FieldSummary {
                name: setup.name.clone(),
                conserved: (start.magnitude > 0.0).then(|| drift / start.magnitude),
                minimum,
                maximum,
                total_variation_initial: start.total_variation,
                total_variation_final: end.total_variation,
                l1_error: end.l1_error,
            }
        };
        self.measures(mesh, Some(exact)).into_iter().enumerate().map(summary).collect()
    }
}

/// The sweeps of the fields, as near to those of the materials as there are.
fn splitting<const D: usize>(scene: &Resolved<D>) -> Splitting {
    match (scene.advection.scheme, scene.advection.sweep_order) {
        (Scheme::Isotropic, _) => Splitting::Isotropic,
        (_, SweepOrder::Symmetric) => Splitting::Symmetric,
        (_, SweepOrder::Alternating) => Splitting::Alternating,
    }
}

/// About how many values the fields of a scene take for each cell.
pub(super) fn values_per_cell<const D: usize>(scene: &Resolved<D>) -> u64 {
    let quantities = |setup: &FieldSetup<D>| setup.initial.len() * quantities_per_component(setup, D);
    match scene.fields.iter().map(quantities).sum::<usize>() {
        0 => 0,
        // Each is there twice. Volumes, slopes and new means of a pass, those of masses and of corrected fluxes; by axis the face values,
        // what crosses, its parts, Courant numbers and spacings.
        count => 2 * count as u64 + 14 + 10 * D as u64,
    }
}

/// Cell quantities for each component of a field.
fn quantities_per_component<const D: usize>(setup: &FieldSetup<D>, dimension: usize) -> usize {
    if let Location::Node(nodal) = setup.location { nodal.quantities(dimension) } else { 1 }
}

/// The values of profiles where those of a field are: means over cells, or values at nodes. Fields at integration points start from the
/// means of their values there.
fn sampled<C: Cell<D>, const D: usize>(
    setup: &FieldSetup<D>,
    profiles: &[Profile<D>],
    mesh: &Mesh<C, D>,
) -> Vec<Vec<f64>> {
    let of_component = |profile: &Profile<D>| match setup.location {
        Location::Cell => profile.cell_means(mesh),
        Location::Node(_) => mesh.nodes().iter().map(|x| profile.value(x)).collect(),
        Location::Points => {
            let at_point = |number: usize| {
                let local = points::local(number);
                (0..mesh.grid().len()).map(|cell| profile.value(&mesh.cell(cell).map(&local))).collect()
            };
            points::cell_means(mesh, &(0..points::count(D)).map(at_point).collect::<Vec<_>>())
        }
    };
    profiles.iter().map(of_component).collect()
}
