//! The quantities of a run that belong to the mesh: their values, their steps and their account.
//!
//! - this file: what they are and how they move; `state`: their values and where these start; `measure`: the numbers that judge them; `exact`: where they should be;
//! - `table`: those numbers after every step; `view`: the values for files and pictures.

mod exact;
mod measure;
mod state;
mod table;
mod view;

use std::borrow::Cow;
use std::ops::Range;

use serde::{Deserialize, Serialize};
use vofkit_geometry::{Cell, Vector};

pub(super) use exact::exact;
pub(super) use measure::Measure;
pub(super) use table::{FIELD_TABLE, FieldTable};
pub(super) use view::{is_field_picture, picture_files};

use state::{State, sampled, sampled_at_points};

use super::prepare::Mover;
use crate::advection::{Scheme, StepError, SweepOrder};
use crate::mesh::{Mesh, SweptVolumes};
use crate::profile::Profile;
use crate::report::FieldSummary;
use crate::scene::{FieldSetup, Location, Method, Part, Resolved, SceneError, Substeps};
use crate::velocity::FlowStep;
use crate::volume_associated::{
    FieldLedger, PointError, PointTransport, Quantity, Splitting, TransportError, VolumeTransport, Weighting,
    points,
};

/// All fields of a run.
#[derive(Debug)]
pub(super) struct Fields<'a, const D: usize> {
    setups: &'a [FieldSetup<D>],
    transport: VolumeTransport<D>,
    /// For fields that are moved at their integration points.
    points: Option<PointTransport<D>>,
    /// Those that cross faces.
    quantities: Vec<Quantity>,
    /// The quantities of each field, all components one after the other: first those that cross faces.
    ranges: Vec<Range<usize>>,
    state: State,
    /// The state before the last step.
    before: State,
    start: Vec<Measure>,
    /// By field: what left through open ends less what came in, and the least and largest value so far.
    outflow: Vec<f64>,
    extremes: Vec<[f64; 2]>,
}

/// What changes of the fields from step to step.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct FieldValues<'a> {
    state: Cow<'a, State>,
    outflow: Cow<'a, [f64]>,
    extremes: Cow<'a, [[f64; 2]]>,
}

impl<'a, const D: usize> Fields<'a, D> {
    /// The fields of a scene at its start.
    ///
    /// # Errors
    /// A mesh at whose integration points a scheme has no gradient, and a density below zero whose mass carries a field.
    pub(super) fn new<C: Cell<D>>(scene: &'a Resolved<D>, mesh: &Mesh<C, D>) -> Result<Self, SceneError> {
        let setups = &scene.fields;
        let at_points = setups.iter().any(|setup| matches!(setup.method, Method::Points(_)));
        let points = at_points.then(|| PointTransport::new(mesh)).transpose().map_err(|error| {
            scene.error(
                Part::Mesh,
                error.to_string(),
                "use a scheme on face fluxes, or distort the mesh less",
            )
        })?;
        // Cells may be overdrawn below the limit of the scheme too, through two faces.
        let overdraft = scene.advection.substeps == Substeps::Off;
        let mut fields = Self {
            setups,
            transport: VolumeTransport::new(mesh, splitting(scene), overdraft),
            points,
            quantities: Vec::new(),
            ranges: vec![0..0; setups.len()],
            state: State::default(),
            before: State::default(),
            start: Vec::new(),
            outflow: vec![0.0; setups.len()],
            extremes: Vec::new(),
        };
        let mut first = 0;
        for by_faces in [true, false] {
            for (range, setup) in fields.ranges.iter_mut().zip(setups) {
                if matches!(setup.method, Method::Faces(_)) == by_faces {
                    *range = first..first + setup.initial.len() * quantities_per_component(setup, D);
                    first = range.end;
                }
            }
        }
        fields.state.means = vec![Vec::new(); first];
        for (k, setup) in setups.iter().enumerate() {
            fields.start_field(k, setup, mesh);
        }
        fields.check_masses(scene, mesh)?;
        fields.start = fields.measures(mesh, None);
        fields.extremes = fields.start.iter().map(|measure| measure.extremes).collect();
        Ok(fields)
    }

    fn check_masses<C: Cell<D>>(&self, scene: &Resolved<D>, mesh: &Mesh<C, D>) -> Result<(), SceneError> {
        for density in self.setups.iter().filter_map(|setup| setup.density) {
            let means = &self.state.means[self.ranges[density].start];
            if let Some(cell) = means.iter().position(|&value| value < 0.0) {
                let (name, at) = (&self.setups[density].name, mesh.grid().offset(cell));
                return Err(scene.error(
                    Part::Initial(density),
                    format!(
                        "the density \"{name}\" is {} in cell {at:?}: masses are not negative",
                        means[cell]
                    ),
                    "let it start from values of at least 0, or carry the other field by \"volume\"",
                ));
            }
        }
        Ok(())
    }

    fn start_field<C: Cell<D>>(&mut self, k: usize, setup: &FieldSetup<D>, mesh: &Mesh<C, D>) {
        let state = &mut self.state;
        let values = sampled(setup, &setup.initial, mesh);
        let means = values.iter().flat_map(|values| match setup.location {
            Location::Cell | Location::Points => vec![values.clone()],
            Location::Node(nodal) => nodal.to_cells(mesh.grid(), values),
        });
        state.means[self.ranges[k].clone()].iter_mut().zip(means).for_each(|(mean, value)| *mean = value);
        if let Method::Faces(scheme) = setup.method {
            let weighting =
                setup.density.map_or(Weighting::Volume, |k| Weighting::Mass(self.ranges[k].start));
            for component in 0..setup.initial.len() {
                let inflow = setup.inflow.as_ref().map(|inflow| inflow[component]);
                let quantity = Quantity { scheme, weighting, inflow };
                self.quantities.extend(vec![quantity; quantities_per_component(setup, D)]);
            }
        }
        let has_points = setup.location == Location::Points && matches!(setup.method, Method::Points(_));
        let at_points = |profile: &Profile<D>| sampled_at_points(profile, mesh);
        state.points.push(if has_points {
            setup.initial.iter().map(at_points).collect()
        } else {
            Vec::new()
        });
        let at_nodes = matches!(setup.location, Location::Node(_));
        state.nodes.push(if at_nodes { values } else { Vec::new() });
    }

    /// What they are after the last step.
    pub(super) fn state(&self) -> FieldValues<'_> {
        FieldValues {
            state: Cow::Borrowed(&self.state),
            outflow: Cow::Borrowed(&self.outflow),
            extremes: Cow::Borrowed(&self.extremes),
        }
    }

    /// Puts them to where they were; returns false for the values of other fields.
    pub(super) fn go_on(&mut self, values: FieldValues<'_>) -> bool {
        let FieldValues { state, outflow, extremes } = values;
        if !state.fits(&self.state) || [outflow.len(), extremes.len()] != [self.setups.len(); 2] {
            return false;
        }
        self.state = state.into_owned();
        self.outflow = outflow.into_owned();
        self.extremes = extremes.into_owned();
        true
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.setups.is_empty()
    }

    /// Moves all fields by a part of a run that ends at `run_end`, from one time to another, as the materials will be.
    pub(super) fn step<C: Cell<D>>(
        &mut self,
        mover: &Mover<'_, C, D>,
        [start, end]: [f64; 2],
        run_end: f64,
        step: usize,
    ) -> Result<(), TransportError> {
        let before = mover.mesh();
        let grid = before.grid();
        self.before.clone_from(&self.state);
        for (k, setup) in self.setups.iter().enumerate() {
            let Location::Node(nodal) = setup.location else { continue };
            let each = nodal.quantities(D);
            for (component, values) in self.state.nodes[k].iter().enumerate() {
                let first = self.ranges[k].start + component * each;
                self.state.means[first..first + each].clone_from_slice(&nodal.to_cells(grid, values));
            }
        }
        let mut place = None;
        if let Mover::Remesh { path, .. } = mover {
            place = Some(path.mesh(end / run_end).map_err(StepError::from)?);
        }
        let after = place.as_ref().unwrap_or(before);
        let flow = mover.flow().map(|flow| flow.step(start, end));
        let moved = self.cross_faces(mover, after, flow.as_ref(), step).and_then(|ledger| {
            self.move_points(before, after, flow.as_ref())?;
            Ok(ledger)
        });
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
            if let Method::Faces(_) = setup.method {
                self.outflow[k] += ledger.outflow[range.clone()].iter().sum::<f64>() / each as f64;
            }
            if let Location::Node(nodal) = setup.location {
                let amounts = self.amounts(k, after);
                for (component, values) in self.state.nodes[k].iter_mut().enumerate() {
                    let first = range.start + component * each;
                    nodal.to_nodes(grid, &self.state.means[first..first + each], &amounts, values);
                }
            }
            let [low, high] = self.extremes_of(k);
            let [least, most] = self.extremes[k];
            self.extremes[k] = [least.min(low), most.max(high)];
        }
        Ok(())
    }

    /// What crosses faces, from the mesh of the mover to the one `after` the step.
    fn cross_faces<C: Cell<D>>(
        &mut self,
        mover: &Mover<'_, C, D>,
        after: &Mesh<C, D>,
        flow: Option<&FlowStep<'_, D>>,
        step: usize,
    ) -> Result<FieldLedger, TransportError> {
        let Self { transport, quantities, state, .. } = self;
        let means = &mut state.means[..quantities.len()];
        match flow {
            Some(flow) => transport.flow(&flow.fluxes(), step, quantities, means),
            None => {
                let at = mover.mesh();
                transport.set_mesh(at);
                let swept = SweptVolumes::new(at, after).map_err(StepError::from)?;
                transport.remesh(&swept, step, quantities, means)
            }
        }
    }

    /// The fields that are moved at points, by the displacement of the material relative to the nodes.
    fn move_points<C: Cell<D>>(
        &mut self,
        before: &Mesh<C, D>,
        after: &Mesh<C, D>,
        flow: Option<&FlowStep<'_, D>>,
    ) -> Result<(), PointError> {
        let Self { points: Some(transport), state, ranges, setups, .. } = self else { return Ok(()) };
        let relative = |(node, (old, new)): (usize, (&Vector<D>, &Vector<D>))| {
            flow.map_or_else(Vector::zeros, |flow| flow.straight(before, node)) + old - new
        };
        let places = before.nodes().iter().zip(after.nodes()).enumerate();
        let displacement: Vec<Vector<D>> = places.map(relative).collect();
        for (k, setup) in setups.iter().enumerate() {
            let Method::Points(scheme) = setup.method else { continue };
            for (number, mean) in state.means[ranges[k].clone()].iter_mut().enumerate() {
                match state.points[k].get_mut(number) {
                    Some(values) => {
                        transport.step(before, &displacement, scheme, values)?;
                        *mean = points::cell_means(after, values);
                    }
                    None => transport.step(before, &displacement, scheme, std::slice::from_mut(mean))?,
                }
            }
        }
        // In flow mode both are one mesh.
        if !std::ptr::eq(before, after) {
            transport.set_mesh(after)?;
        }
        Ok(())
    }

    /// Puts the values back to those before the last step, whose other half failed.
    pub(super) fn restore(&mut self) {
        std::mem::swap(&mut self.state, &mut self.before);
    }

    /// The volumes, or masses, that carry a field.
    fn amounts<C: Cell<D>>(&self, field: usize, mesh: &Mesh<C, D>) -> Vec<f64> {
        match self.setups[field].density {
            None => mesh.volumes().to_vec(),
            Some(density) => {
                let density = &self.state.means[self.ranges[density].start];
                mesh.volumes().iter().zip(density).map(|(volume, density)| volume * density).collect()
            }
        }
    }

    /// The values of a field by component: means over cells, or values at nodes.
    fn values(&self, field: usize) -> &[Vec<f64>] {
        match self.setups[field].location {
            Location::Node(_) => &self.state.nodes[field],
            Location::Cell | Location::Points => &self.state.means[self.ranges[field].clone()],
        }
    }

    /// The account of the fields at the end; `exact` as from [`exact`], `closed` where nothing can leave the mesh.
    pub(super) fn summaries<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        exact: &[Option<Vec<Profile<D>>>],
        closed: bool,
    ) -> Vec<FieldSummary> {
        let summary = |(k, end): (usize, Measure)| {
            let (setup, start) = (&self.setups[k], &self.start[k]);
            // What leaves is not known of schemes that move nothing through faces.
            let is_known = matches!(setup.method, Method::Faces(_)) || closed;
            let drift = end.amounts.iter().zip(&start.amounts).map(|(end, start)| end - start);
            let drift = drift.sum::<f64>() + self.outflow[k];
            let [minimum, maximum] = self.extremes[k];
            FieldSummary {
                name: setup.name.clone(),
                conserved: (start.magnitude > 0.0 && is_known).then(|| drift / start.magnitude),
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
    let quantities = |setup: &FieldSetup<D>| {
        let at_points = setup.location == Location::Points && matches!(setup.method, Method::Points(_));
        let each = quantities_per_component(setup, D) + if at_points { points::count(D) } else { 0 };
        setup.initial.len() * each
    };
    let corners = (points::count(D) * (1 + D)) as u64;
    match scene.fields.iter().map(quantities).sum::<usize>() {
        0 => 0,
        // Each is there twice. Volumes, slopes and new means of a pass, those of masses and of corrected fluxes; by axis the face values,
        // what crosses, its parts, Courant numbers and spacings. At points the parts of the corners.
        count if scene.fields.iter().any(|setup| matches!(setup.method, Method::Points(_))) => {
            2 * count as u64 + 16 + 11 * D as u64 + corners
        }
        count => 2 * count as u64 + 16 + 11 * D as u64,
    }
}

/// Cell quantities for each component of a field.
fn quantities_per_component<const D: usize>(setup: &FieldSetup<D>, dimension: usize) -> usize {
    if let Location::Node(nodal) = setup.location { nodal.quantities(dimension) } else { 1 }
}
