//! The exact final state, where the velocity moves everything rigidly.

use vofkit_geometry::{Cell, Vector};

use super::prepare::Setup;
use crate::advection::End;
use crate::fractions::volume_fractions;
use crate::mesh::Mesh;
use crate::scene::{Resolved, ReversalSetup};
use crate::shape::{Rotation, Shape};
use crate::space::planar;
use crate::velocity::RigidMotion;

/// Overlap of the box of a shape with that of the domain that is rounding, relative to the domain.
const TOUCHING: f64 = 1e-12;

/// The exact fractions at the end; none where they are not known: the shapes deform, a material flows in, or something
/// crossed the boundary that a rigid motion would bring back.
pub(super) fn fractions<C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &Mesh<C, D>,
    setup: &Setup<'_, C, D>,
    crossed: bool,
) -> Option<Vec<Vec<f64>>> {
    if is_fed(scene, setup) {
        return None;
    }
    if scene.mesh.motion.is_some() {
        // The material rests; what lay beyond the mesh at the start is not known.
        return scene.shapes().filter(|_| !crossed).map(|shapes| volume_fractions(mesh, &shapes));
    }
    let motion = setup.mover.rigid_motion(setup.plan.end)?;
    let is_translation = matches!(motion, RigidMotion::Translation { .. });
    if crossed && !(is_translation && scene.reversal == ReversalSetup::None) {
        return None;
    }
    let shapes: Option<Vec<Shape<D>>> = scene
        .shapes()?
        .iter()
        .map(|shape| match motion {
            RigidMotion::Identity => Some(shape.clone()),
            RigidMotion::Translation { shift } => {
                Some(translated(&inside(shape, mesh), &planar(&shift), mesh))
            }
            RigidMotion::Rotation { centre, axis, angle } => {
                // What was cut off at the start is not there to be turned in.
                let rotation = Rotation::from_axis_angle(axis, angle);
                let whole = is_inside(shape, mesh);
                whole.then(|| shape.moved(&rotation, &planar(&centre), &Vector::zeros()))
            }
        })
        .collect();
    Some(volume_fractions(mesh, &shapes?))
}

/// Whether a material may have come in: its amount is no measure, for as much may have left elsewhere.
fn is_fed<C: Cell<D>, const D: usize>(scene: &Resolved<D>, setup: &Setup<'_, C, D>) -> bool {
    let (ends, periodic) = (setup.boundary.ends, scene.boundary.periodic);
    let is_open = (0..D).any(|axis| !periodic[axis] && ends[axis].contains(&End::Outflow));
    scene.boundary.inflow.is_some() && is_open && setup.plan.courant > 0.0
}

pub(super) fn is_inside<C: Cell<D>, const D: usize>(shape: &Shape<D>, mesh: &Mesh<C, D>) -> bool {
    let [lower, upper] = mesh.bounds();
    shape.bounding_box().is_some_and(|[a, b]| (0..D).all(|k| a[k] >= lower[k] && b[k] <= upper[k]))
}

/// The part of a shape in the domain.
pub(super) fn inside<C: Cell<D>, const D: usize>(shape: &Shape<D>, mesh: &Mesh<C, D>) -> Shape<D> {
    if is_inside(shape, mesh) {
        return shape.clone();
    }
    let [lower, upper] = mesh.bounds();
    let domain =
        Shape::Box { centre: (lower + upper) * 0.5, lengths: upper - lower, rotation: Rotation::identity() };
    Shape::Intersection(vec![shape.clone(), domain])
}

/// The shifted shape; along periodic axes with all its images that reach into the domain.
pub(super) fn translated<C: Cell<D>, const D: usize>(
    shape: &Shape<D>,
    shift: &Vector<D>,
    mesh: &Mesh<C, D>,
) -> Shape<D> {
    let moved = |shift: &Vector<D>| shape.moved(&Rotation::identity(), &Vector::zeros(), shift);
    let Some([a, b]) = shape.bounding_box() else { return moved(shift) };
    let [lower, upper] = mesh.bounds();
    let mut shifts = vec![*shift];
    for axis in (0..D).filter(|&axis| mesh.grid().periodic()[axis]) {
        let length = upper[axis] - lower[axis];
        let first = ((lower[axis] - b[axis] - shift[axis]) / length + TOUCHING).ceil() as i64;
        let last = ((upper[axis] - a[axis] - shift[axis]) / length - TOUCHING).floor() as i64;
        shifts = shifts
            .iter()
            .flat_map(|shift| {
                (first..=last).map(move |times| {
                    let mut image = *shift;
                    image[axis] += times as f64 * length;
                    image
                })
            })
            .collect();
    }
    match shifts.as_slice() {
        [only] => moved(only),
        all => Shape::Union(all.iter().map(moved).collect()),
    }
}
