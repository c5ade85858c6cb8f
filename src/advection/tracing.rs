//! Where what is at the nodes comes from in a step, for the schemes that trace regions or cells back.

use std::borrow::Cow;

use vofkit_geometry::{Cell, Vector};

use super::settings::{Scheme, Settings};
use super::unsplit::{radius, reach};
use crate::mesh::Mesh;
use crate::velocity::{Flow, FlowStep, NodalMotion};

/// What is kept from step to step.
#[derive(Clone, Debug)]
pub(super) struct Tracing<const D: usize> {
    /// Whether schemes ask for the nodes; those that have a formula are traced by it in the unsplit scheme.
    needs_nodes: bool,
    /// The motion of the nodes, where it is the same in all steps but for the amplitude.
    steady: Option<NodalMotion<D>>,
    /// For the unsplit scheme: cells along an axis of a cell that the fastest node moves per time at full amplitude, and its acceleration
    /// per time squared. None where they change.
    reach: Option<[f64; 2]>,
}

/// The motion of the nodes in a step, and for how long it lasts.
pub(super) struct Traced<'a, const D: usize> {
    pub(super) nodes: Cow<'a, NodalMotion<D>>,
    pub(super) duration: f64,
}

impl<const D: usize> Traced<'_, D> {
    /// How far what is at a node has come.
    pub(super) fn displacement(&self, node: usize) -> Vector<D> {
        self.nodes.displacement(node, self.duration)
    }
}

impl<const D: usize> Tracing<D> {
    pub(super) fn new<C: Cell<D>>(mesh: &Mesh<C, D>, flow: &Flow<D>, settings: &Settings<D>) -> Self {
        let is_unsplit = settings.scheme == Scheme::Unsplit;
        let in_sweeps = settings.scheme == Scheme::Isotropic || settings.splits_displacement(mesh);
        let by_formula = is_unsplit && flow.is_field();
        let needs_nodes = in_sweeps || is_unsplit && !by_formula;
        let steady = if needs_nodes { flow.steady_motion(mesh) } else { None };
        let reach = match &steady {
            _ if by_formula => {
                let unit = flow.at_full_amplitude();
                Some([reach(mesh, |node| unit.straight(mesh, node)), 0.0])
            }
            Some(nodes) if is_unsplit => {
                Some([reach(mesh, |node| nodes.velocity(node)), reach(mesh, |node| nodes.acceleration(node))])
            }
            _ => None,
        };
        Self { needs_nodes, steady, reach }
    }

    /// The motion of the nodes in a step; none where nobody asks for it.
    pub(super) fn of_step<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        step: &FlowStep<'_, D>,
    ) -> Option<Traced<'_, D>> {
        self.needs_nodes.then(|| match &self.steady {
            Some(nodes) => Traced { nodes: Cow::Borrowed(nodes), duration: step.duration() },
            None => Traced { nodes: Cow::Owned(step.motion(mesh)), duration: 1.0 },
        })
    }

    /// How many cells away from one that is not settled the unsplit scheme can change contents in a step.
    pub(super) fn radius<C: Cell<D>>(
        &self,
        mesh: &Mesh<C, D>,
        step: &FlowStep<'_, D>,
        traced: Option<&Traced<'_, D>>,
    ) -> usize {
        let duration = step.duration();
        match (self.reach, traced) {
            (Some([velocity, acceleration]), _) => {
                radius(velocity * duration.abs() + 0.5 * acceleration * duration * duration)
            }
            (None, Some(traced)) => radius(reach(mesh, |node| traced.displacement(node))),
            (None, None) => radius(0.0),
        }
    }
}
