//! Where the fields should be at a time, where that is known.

use vofkit_geometry::{Cell, Vector};

use super::super::exact::{inside, is_inside, translated};
use crate::mesh::Mesh;
use crate::profile::Profile;
use crate::scene::{FieldSetup, Resolved};
use crate::shape::Rotation;
use crate::space::planar;
use crate::velocity::RigidMotion;

/// The profiles of the components of each field after the motion of the material; none where they are not known:
/// they deform, or something else flows in than what was there.
pub(in crate::run) fn exact<C: Cell<D>, const D: usize>(
    scene: &Resolved<D>,
    mesh: &Mesh<C, D>,
    motion: Option<RigidMotion>,
) -> Vec<Option<Vec<Profile<D>>>> {
    let of_field = |setup: &FieldSetup<D>| {
        let profiles = setup.initial.iter().enumerate();
        profiles.map(|(component, profile)| moved(profile, setup, component, mesh, motion)).collect()
    };
    scene.fields.iter().map(of_field).collect()
}

fn moved<C: Cell<D>, const D: usize>(
    profile: &Profile<D>,
    setup: &FieldSetup<D>,
    component: usize,
    mesh: &Mesh<C, D>,
    motion: Option<RigidMotion>,
) -> Option<Profile<D>> {
    let is_open = mesh.grid().periodic().contains(&false);
    let is_fed_alike = |background: f64| {
        !is_open || setup.inflow.as_ref().is_none_or(|inflow| inflow[component] == background)
    };
    match (profile, motion) {
        (Profile::Inclusions { background, shapes }, _) if shapes.is_empty() => {
            is_fed_alike(*background).then(|| profile.clone())
        }
        (_, None) => None,
        (_, Some(RigidMotion::Identity)) => Some(profile.clone()),
        (Profile::Inclusions { background, shapes }, Some(RigidMotion::Translation { shift })) => {
            let shift = planar(&shift);
            let shapes =
                shapes.iter().map(|(shape, value)| (translated(&inside(shape, mesh), &shift, mesh), *value));
            is_fed_alike(*background)
                .then(|| Profile::Inclusions { background: *background, shapes: shapes.collect() })
        }
        (Profile::Inclusions { background, shapes }, Some(RigidMotion::Rotation { centre, axis, angle })) => {
            let rotation = Rotation::from_axis_angle(axis, angle);
            let known = is_fed_alike(*background) && shapes.iter().all(|(shape, _)| is_inside(shape, mesh));
            known.then(|| profile.moved(&rotation, &planar(&centre), &Vector::zeros()))
        }
        (Profile::Sine { .. }, Some(RigidMotion::Translation { shift })) => {
            let shift = planar(&shift);
            let joined = (0..D).all(|axis| mesh.grid().periodic()[axis] || shift[axis] == 0.0);
            joined.then(|| profile.moved(&Rotation::identity(), &Vector::zeros(), &shift))
        }
        (Profile::Sine { .. }, Some(RigidMotion::Rotation { .. })) => None,
    }
}
