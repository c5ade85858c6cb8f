//! The interface of a scene as it stands: fractions, planes and files; nothing moves.

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use super::draw::Draw;
use super::folder::{Folder, SUMMARY};
use super::notes::of_start;
use super::output::{Beside, FIRST, Output};
use super::planes::CellPlanes;
use super::prepare::{self, Start};
use super::progress::Progress;
use super::shape_errors::ShapeErrors;
use super::tally::{mixed_cells, not_asked_for};
use super::{RunError, RunOptions};
use crate::export::write_file;
use crate::facet::Facet;
use crate::interface::{Body, Counts, Parts, ReconstructionError, is_mixed, planes_of_all, with_planes};
use crate::mesh::Mesh;
use crate::metrics::{facet_gap_mean, material_volume};
use crate::report::still::{CountsByStatus, StageSeconds, StillMaterial, StillSummary};
use crate::scene::Still;
use crate::stopwatch::Stopwatch;

/// Reconstructs the interface of a scene and writes what it asks for: the files that a run writes at its start, and on the mesh
/// also the planes.
///
/// Scene and folder are checked before anything is written, and files are complete or absent.
///
/// # Errors
/// See [`RunError`].
pub fn reconstruct<C: Draw<D>, const D: usize>(
    scene: &Still<D>,
    options: &RunOptions,
    progress: &mut dyn Progress,
) -> Result<StillSummary, RunError> {
    let done = reconstructed::<C, D>(scene, options, progress);
    progress.end();
    done
}

fn reconstructed<C: Draw<D>, const D: usize>(
    scene: &Still<D>,
    options: &RunOptions,
    progress: &mut dyn Progress,
) -> Result<StillSummary, RunError> {
    let clock = Instant::now();
    Folder::check(&options.folder, options.force)?;
    let mut seconds = StageSeconds::default();
    progress.stage("mesh");
    let mesh: Mesh<C, D> = timed(&mut seconds.mesh, || prepare::still_mesh(scene))?;
    progress.stage("fractions");
    let start = timed(&mut seconds.fractions, || prepare::start(scene, &mesh))?;
    progress.stage("planes");
    let found = Found::new(scene, &mesh, start.parts(), &mut seconds)?;
    progress.stage("errors");
    let errors = timed(&mut seconds.errors, || found.errors(scene, &mesh));
    let mut summary = found.summary(scene, &mesh, &start.fractions, &errors, seconds);
    summary.threads = options.threads;

    let folder = Folder::open(&options.folder, options.force)?;
    let Found { mut planes, facets, .. } = found;
    let Start { fractions, centroids } = start;
    for (planes, centroids) in planes.iter_mut().zip(centroids.into_iter().flatten()) {
        planes.centroids = Some(centroids);
    }
    let mut output = Output::new(scene, Beside::Planes(planes), folder.path().to_owned());
    let done = write(scene, &mut output, &mesh, &fractions, &facets).and_then(|()| {
        output.files.push(SUMMARY.to_owned());
        summary.obj_scale = output.obj_scale;
        summary.files = output.files.clone();
        summary.wall_seconds = clock.elapsed().as_secs_f64();
        write_summary(folder.path(), &summary)
    });
    if let Err(error) = done {
        output.discard();
        folder.remove_if_empty();
        return Err(error);
    }
    Ok(summary)
}

/// Does something and adds the seconds that it takes.
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let clock = Instant::now();
    let done = work();
    *seconds += clock.elapsed().as_secs_f64();
    done
}

fn write<C: Draw<D>, const D: usize>(
    scene: &Still<D>,
    output: &mut Output<'_, D>,
    mesh: &Mesh<C, D>,
    fractions: &[Vec<f64>],
    facets: &[Facet<D>],
) -> Result<(), RunError> {
    output.state(mesh, 0.0, fractions, facets, None)?;
    if scene.output.picture {
        output.picture(FIRST, mesh, 0.0, fractions, facets)?;
    }
    Ok(())
}

fn write_summary(folder: &Path, summary: &StillSummary) -> Result<(), RunError> {
    Ok(write_file(folder.join(SUMMARY), |writer| {
        serde_json::to_writer_pretty(&mut *writer, summary)?;
        writeln!(writer)
    })?)
}

/// The interface of all materials.
struct Found<const D: usize> {
    /// What was done, whatever the material.
    all: Counts,
    /// By material.
    counts: Vec<CountsByStatus>,
    /// By material; none where no fields are asked for.
    planes: Vec<CellPlanes<D>>,
    /// By material, then cell.
    facets: Vec<Facet<D>>,
    /// By material: the cells in which it is one of several that are cut one after the other, ascending.
    nested: Vec<Vec<usize>>,
}

impl<const D: usize> Found<D> {
    fn new<C: Draw<D>>(
        scene: &Still<D>,
        mesh: &Mesh<C, D>,
        parts: Parts<'_, D>,
        seconds: &mut StageSeconds,
    ) -> Result<Self, ReconstructionError> {
        parts.check(mesh.grid())?;
        let fractions = parts.fractions;
        let is_mixed = |&cell: &usize| fractions.iter().any(|f| is_mixed(f[cell]));
        let cells: Vec<usize> = (0..mesh.grid().len()).filter(is_mixed).collect();
        let mut all = Counts::default();
        let method = scene.reconstruction;
        let mut stopwatch = Stopwatch::started();
        let placed = planes_of_all(Body::Cell, mesh, parts, &cells, method, &mut all, &mut stopwatch)?;
        seconds.normals += stopwatch.seconds().normals;
        seconds.positions += stopwatch.seconds().positions;
        let interface = timed(&mut seconds.facets, || with_planes(mesh, parts, &cells, &placed, method))?;
        all.add(&interface.counts);
        let facets = interface.facets;
        let mut found = Self { all, counts: Vec::new(), planes: Vec::new(), facets, nested: Vec::new() };
        for (k, fractions) in fractions.iter().enumerate() {
            let of_cell = |(&cell, placed)| Some((cell, Option::as_ref(placed)?));
            let own =
                || cells.iter().zip(placed.iter().skip(k).step_by(scene.materials.len())).filter_map(of_cell);
            let mut counts = Counts::default();
            own().for_each(|(_, placed)| counts.count(placed));
            let nested: Vec<usize> =
                own().filter(|(_, placed)| placed.is_nested()).map(|(cell, _)| cell).collect();
            if scene.output.fields {
                let facets = found.facets.iter().filter(|facet| facet.material == k);
                found.planes.push(CellPlanes::new(fractions, own(), facets));
            }
            found.counts.push(CountsByStatus { nested: nested.len(), ..CountsByStatus::from(&counts) });
            found.nested.push(nested);
        }
        Ok(found)
    }

    /// How far the planes of each material are from its shape.
    fn errors<C: Draw<D>>(&self, scene: &Still<D>, mesh: &Mesh<C, D>) -> Vec<ShapeErrors> {
        let Some(shapes) = scene.shapes() else { return vec![ShapeErrors::default(); self.counts.len()] };
        let of_material = |k: usize| {
            let alone = |facet: &Facet<D>| self.nested[k].binary_search(&facet.cell).is_err();
            let own = self.facets.iter().filter(|facet| facet.material == k && alone(facet));
            let own: Vec<Facet<D>> = own.cloned().collect();
            ShapeErrors::new(mesh, &own, &shapes[..=k])
        };
        (0..shapes.len()).map(of_material).collect()
    }

    /// The account; what is written and how long all of it took is left open.
    fn summary<C: Draw<D>>(
        &self,
        scene: &Still<D>,
        mesh: &Mesh<C, D>,
        fractions: &[Vec<f64>],
        errors: &[ShapeErrors],
        seconds: StageSeconds,
    ) -> StillSummary {
        let all = &self.all;
        let per_plane = |sum: f64| (all.mixed > 0).then(|| sum / all.mixed as f64);
        let material = |k: usize| {
            let own = self.facets.iter().filter(|facet| facet.material == k);
            StillMaterial {
                name: scene.materials[k].name.clone(),
                volume: material_volume(mesh, &fractions[k]),
                area: own.map(|facet| facet.area).sum(),
                planes: self.counts[k],
                symmetric_difference: errors[k].symmetric_difference,
                hausdorff_mean: errors[k].hausdorff_mean,
            }
        };
        StillSummary {
            scene: scene.name.clone(),
            dimension: D,
            cells: mesh.grid().len(),
            cells_per_direction: mesh.grid().cells().to_vec(),
            normal: scene.normal_word().to_owned(),
            mixed_cells: mixed_cells(fractions),
            planes: CountsByStatus::from(all),
            positions_closed_form: all.closed_form,
            positions_iterative: all.iterative,
            evaluations_per_position: all.evaluations_per_position(),
            trials_per_plane: per_plane(all.trials as f64),
            positions_per_plane: per_plane((all.trials + all.closed_form + all.iterative) as f64),
            microseconds_per_plane: per_plane((seconds.normals + seconds.positions) * 1e6),
            seconds,
            facet_gap_mean: facet_gap_mean(mesh, &self.facets),
            skipped_outputs: not_asked_for(&scene.output),
            notes: of_start(scene, mesh),
            materials: (0..fractions.len()).map(material).collect(),
            ..StillSummary::default()
        }
    }
}
