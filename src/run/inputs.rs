//! What a run takes from the files that its scene names, so that one that goes on knows them again.

use vofkit_geometry::Vector;

use super::checkpoint::sum;
use crate::mesh::MeshMotion;
use crate::profile::Profile;
use crate::scene::Resolved;
use crate::shape::Shape;
use crate::velocity::Flow;

/// The check sum of all numbers of these files: nodes of the mesh and of its way, fractions and centroids, bodies, and velocities.
pub(super) fn inputs<const D: usize>(scene: &Resolved<D>, flow: Option<&Flow<D>>) -> u64 {
    let nodes = scene.mesh.file.iter().flat_map(|file| coordinates(&file.nodes));
    let way = match &scene.mesh.motion {
        Some(MeshMotion::Through(sets)) => sets.as_slice(),
        _ => &[],
    };
    let fractions = scene.parts.iter().flat_map(|parts| parts.fractions.iter().flatten().copied());
    let centroids = scene.parts.iter().flat_map(|parts| parts.centroids.iter().flatten());
    let velocities = flow.into_iter().flat_map(Flow::numbers);
    let meshes = nodes.chain(way.iter().flat_map(|nodes| coordinates(nodes)));
    let parts = fractions.chain(centroids.flat_map(|centroids| coordinates(centroids)));
    sum(meshes.chain(parts).chain(bodies(scene)).chain(velocities))
}

/// The coordinates of the surfaces of all bodies.
fn bodies<const D: usize>(scene: &Resolved<D>) -> impl Iterator<Item = f64> {
    let quantities = scene.materials.iter().flat_map(|material| &material.quantities);
    let carried = quantities.flat_map(|quantity| &quantity.initial);
    let profiles = carried.chain(scene.fields.iter().flat_map(|field| &field.initial));
    let inclusions = profiles.flat_map(|profile| match profile {
        Profile::Inclusions { shapes, .. } => shapes.as_slice(),
        Profile::Sine { .. } => &[],
    });
    let materials = scene.materials.iter().filter_map(|material| material.shape.as_ref());
    let shapes = materials.chain(inclusions.map(|(shape, _)| shape));
    let pieces =
        shapes.flat_map(Shape::bodies).flat_map(|body| (0..body.piece_count()).map(|i| body.piece(i)));
    pieces.flat_map(|piece| piece.into_iter().flat_map(|x| std::array::from_fn::<f64, D, _>(|k| x[k])))
}

fn coordinates<const D: usize>(points: &[Vector<D>]) -> impl Iterator<Item = f64> {
    points.iter().flat_map(|x| x.iter().copied())
}
