//! The interface of a scene as it stands: how far its planes are from the shapes, and how long they take.

use vofkit_geometry::{Cell, Hexahedron, Quad};

use super::file::Study;
use super::measure::{Measures, Named, Spread};
use super::plan::{self, Combination};
use super::subject::{along_axis, mean, repeated};
use crate::facet::Facet;
use crate::interface::{Body, Counts, is_mixed, planes_timed, reconstruct};
use crate::mesh::Mesh;
use crate::run::shape_errors::ShapeErrors;
use crate::run::{RunError, prepare};
use crate::scene::{Still, StillScene};
use crate::stopwatch::{PhaseSeconds, Stopwatch};

/// What is known of one sample.
struct Sample {
    /// Of normals and plane constants.
    seconds: PhaseSeconds,
    /// Volume of the symmetric difference.
    difference: f64,
    /// The mean Hausdorff distance, of spheres.
    hausdorff: Option<f64>,
    counts: Counts,
    cells_along_axis: f64,
    memory: u64,
}

/// Measures the reconstruction of a combination, errors being means over its samples.
pub(super) fn measured(study: &Study, combination: &Combination) -> Result<Measures, String> {
    let one = |sample: &Vec<String>| -> Result<Sample, RunError> {
        match plan::still(study, combination, sample)? {
            StillScene::Plane(scene) => reconstructed::<Quad, 2>(&scene),
            StillScene::Space(scene) => reconstructed::<Hexahedron, 3>(&scene),
        }
    };
    let pass =
        || combination.samples.iter().map(one).collect::<Result<Vec<_>, _>>().map_err(|e| e.to_string());
    let passes = repeated(study.quick, pass)?;
    let Some(samples) = passes.first() else { return Err("nothing was reconstructed".to_owned()) };
    let mut counts = Counts::default();
    samples.iter().for_each(|sample| counts.add(&sample.counts));
    let over = |value: fn(&PhaseSeconds) -> f64| {
        let pass = |samples: &Vec<Sample>| mean(samples.iter().map(|sample| Some(value(&sample.seconds))));
        Spread::of(passes.iter().filter_map(pass).collect())
    };
    let seconds = over(|seconds| seconds.normals + seconds.positions);
    let stages = [
        Named::new("normals", over(|seconds| seconds.normals).median),
        Named::new("positions", over(|seconds| seconds.positions).median),
    ];
    let mixed = counts.mixed as f64 / samples.len().max(1) as f64;
    let errors = [
        ("symmetric difference", mean(samples.iter().map(|sample| Some(sample.difference)))),
        ("Hausdorff", mean(samples.iter().map(|sample| sample.hausdorff))),
    ];
    let positions = counts.closed_form + counts.iterative;
    Ok(Measures {
        errors: errors.into_iter().filter_map(|(name, value)| Some(Named::new(name, value?))).collect(),
        seconds,
        cells_along_axis: samples.first().map(|sample| sample.cells_along_axis),
        mixed_cells: Some(mixed),
        seconds_per_mixed_cell: (mixed > 0.0).then(|| seconds.median / mixed),
        evaluations_per_position: counts.evaluations_per_position(),
        closed_form: (positions > 0).then(|| counts.closed_form as f64 / positions as f64),
        stages: stages.to_vec(),
        memory_estimate: samples.iter().map(|sample| sample.memory).max(),
        undetermined: Some(counts.undetermined + counts.no_normal()),
        ..Measures::default()
    })
}

fn reconstructed<C: Cell<D>, const D: usize>(scene: &Still<D>) -> Result<Sample, RunError> {
    let mesh: Mesh<C, D> = prepare::still_mesh(scene)?;
    let start = prepare::start(scene, &mesh)?;
    let (mut stopwatch, mut counts) = (Stopwatch::started(), Counts::default());
    for (k, fractions) in start.fractions.iter().enumerate() {
        let mixed: Vec<usize> = (0..fractions.len()).filter(|&cell| is_mixed(fractions[cell])).collect();
        let material = start.parts().material(&mesh, k);
        stopwatch.lap(|seconds| &mut seconds.initialise);
        let placed = planes_timed(Body::Cell, material, &mixed, scene.reconstruction, &mut stopwatch)?;
        placed.iter().for_each(|placed| counts.count(placed));
    }
    let facets = reconstruct(&mesh, start.parts(), scene.reconstruction)?.facets;
    let (mut difference, mut hausdorff) = (0.0, None);
    let shapes = scene.shapes().unwrap_or_default();
    for k in 0..shapes.len() {
        let own: Vec<Facet<D>> = facets.iter().filter(|facet| facet.material == k).cloned().collect();
        let errors = ShapeErrors::new(&mesh, &own, &shapes[..=k]);
        difference += errors.symmetric_difference.unwrap_or_default();
        hausdorff = hausdorff.or(errors.hausdorff_mean);
    }
    let memory = prepare::still_memory(scene);
    let cells_along_axis = along_axis(&scene.mesh.cells);
    let seconds = stopwatch.seconds();
    Ok(Sample { seconds, difference, hausdorff, counts, cells_along_axis, memory })
}
