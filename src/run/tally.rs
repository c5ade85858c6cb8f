//! Running totals of a run, and the summary that they end in.

use serde::{Deserialize, Serialize};
use vofkit_geometry::Cell;

use super::history::Line;
use super::prepare::Setup;
use crate::advection::{Ledger, MaterialLedger, Scheme, SweepAxes};
use crate::interface::is_mixed;
use crate::mesh::Mesh;
use crate::metrics::{extremes, fragments, material_volume, shape_error};
use crate::parallel;
use crate::report::{Corrections, MaterialCorrections, MaterialSummary, Normals, Share, Skipped, Summary};
use crate::scene::{OutputSetup, Resolved};

/// A body that stays inside may lose this part of its volume through open ends on a coarse mesh, by the scatter of its
/// interface; more means that it left.
const LEAK: f64 = 1e-2;

/// Totals so far.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Tally {
    ledger: Ledger,
    volumes: Vec<f64>,
    extremes: Vec<[f64; 2]>,
    mixed_now: usize,
    mixed_sum: usize,
    steps: usize,
    substeps: usize,
}

impl Tally {
    /// The totals at the start.
    pub(super) fn new<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, fractions: &[Vec<f64>]) -> Self {
        Self {
            ledger: Ledger::new(fractions.len()),
            volumes: fractions.iter().map(|f| material_volume(mesh, f)).collect(),
            extremes: fractions.iter().map(|f| extremes(f)).collect(),
            mixed_now: mixed_cells(fractions),
            mixed_sum: 0,
            steps: 0,
            substeps: 1,
        }
    }

    /// Adds a step.
    pub(super) fn add(&mut self, fractions: &[Vec<f64>], ledger: &Ledger, substeps: usize) {
        self.ledger.add(ledger);
        self.mixed_now = mixed_cells(fractions);
        self.mixed_sum += self.mixed_now;
        self.steps += 1;
        self.substeps = self.substeps.max(substeps);
    }

    /// Mixed cells after the last step.
    pub(super) fn mixed_cells(&self) -> usize {
        self.mixed_now
    }

    /// Whether more of a material crossed the boundary than leaks there on coarse meshes.
    pub(super) fn crossed(&self) -> bool {
        let leaked = |(material, volume): (&MaterialLedger, &f64)| material.outflow.abs() > LEAK * volume;
        self.ledger.materials.iter().zip(&self.volumes).any(leaked)
    }

    /// The line of the history for the start.
    pub(super) fn first_line(&self) -> Line {
        let of_material = |(&volume, [min, max]): (&f64, &[f64; 2])| [volume, *min, *max, 0.0, 0.0];
        Line {
            step: 0,
            time: 0.0,
            dt: 0.0,
            courant: 0.0,
            mixed_cells: self.mixed_now,
            largest: None,
            materials: self.volumes.iter().zip(&self.extremes).map(of_material).collect(),
        }
    }

    /// The line of the history for the last step added.
    pub(super) fn line<C: Cell<D>, const D: usize>(
        &self,
        mesh: &Mesh<C, D>,
        fractions: &[Vec<f64>],
        ledger: &Ledger,
        [start, end]: [f64; 2],
        courant: f64,
    ) -> Line {
        let materials = fractions.iter().zip(&ledger.materials).map(|(f, account)| {
            // A step without an interface looks at no cell.
            let [min, max] = if account.smallest <= account.largest {
                [account.smallest, account.largest]
            } else {
                extremes(f)
            };
            [material_volume(mesh, f), min, max, account.clipped, account.rescaled]
        });
        let largest = ledger.largest_correction;
        Line {
            largest: (largest.fraction > 0.0).then_some((largest.fraction, largest.cell)),
            step: self.steps,
            time: end,
            dt: end - start,
            courant,
            mixed_cells: self.mixed_now,
            materials: materials.collect(),
        }
    }

    /// The account of the run; what is written and how long it took is left open.
    pub(super) fn summary<C: Cell<D>, const D: usize>(
        &self,
        scene: &Resolved<D>,
        setup: &Setup<'_, C, D>,
        mesh: &Mesh<C, D>,
        fractions: &[Vec<f64>],
        exact: Option<&[Vec<f64>]>,
    ) -> Summary {
        let (counts, plan) = (&self.ledger.counts, &setup.plan);
        let planes = counts.mixed - counts.no_normal();
        let over_all_faces = scene.advection.scheme == Scheme::Isotropic
            || scene.advection.sweep_axes == SweepAxes::Cartesian && !mesh.is_undistorted();
        let rounds = self.ledger.sweeps * fractions.len();
        // Along mesh lines a sweep deals with the faces of one direction.
        let faces = face_count(mesh) * rounds / if over_all_faces { 1 } else { D };
        let cuts = match scene.advection.scheme {
            Scheme::Unsplit | Scheme::Remap => {
                Share::without(self.ledger.preimages_cut, mesh.grid().len() * self.ledger.sweeps)
            }
            _ => Share::without(self.ledger.faces_cut, faces),
        };
        let largest = self.ledger.largest_correction;
        Summary {
            scene: scene.name.clone(),
            dimension: D,
            cells: mesh.grid().len(),
            cells_per_direction: mesh.grid().cells().to_vec(),
            steps: plan.steps,
            end_time: plan.end,
            dt: plan.dt(),
            max_courant: plan.courant,
            max_divergence: setup.divergence,
            substeps: self.substeps,
            mixed_cells_mean: self.mixed_sum as f64 / self.steps.max(1) as f64,
            cells_reconstructed: planes,
            positions_closed_form: counts.closed_form,
            positions_iterative: counts.iterative,
            evaluations_per_position: counts.evaluations_per_position(),
            normals: Normals::from(counts),
            corrections: Corrections {
                largest_fraction: largest.fraction,
                largest_in_cell: if largest.fraction > 0.0 {
                    mesh.grid().offset(largest.cell).to_vec()
                } else {
                    Vec::new()
                },
                no_normal: counts.no_normal(),
                preimages_folded: self.ledger.preimages_folded,
            },
            skipped: Skipped {
                reconstructions: Share::without(planes, mesh.grid().len() * rounds),
                cuts,
                outputs: not_asked_for(&scene.output),
                times_after_end: Vec::new(),
            },
            materials: (0..fractions.len())
                .map(|k| self.material(&scene.materials[k].name, k, mesh, &fractions[k], exact))
                .collect(),
            ..Summary::default()
        }
    }

    fn material<C: Cell<D>, const D: usize>(
        &self,
        name: &str,
        material: usize,
        mesh: &Mesh<C, D>,
        fractions: &[f64],
        exact: Option<&[Vec<f64>]>,
    ) -> MaterialSummary {
        let account = &self.ledger.materials[material];
        let [initial, last] = [self.volumes[material], material_volume(mesh, fractions)];
        let relative = |volume: f64| (initial > 0.0).then(|| volume / initial);
        let error = exact.map(|exact| shape_error(mesh, fractions, &exact[material]));
        let pieces = fragments(mesh, fractions);
        let [min, max] = self.extremes[material];
        MaterialSummary {
            name: name.to_owned(),
            volume_initial: initial,
            volume_final: last,
            boundary_volume: account.outflow,
            volume_drift: relative(last - initial + account.outflow),
            fraction_min: min.min(account.smallest),
            fraction_max: max.max(account.largest),
            shape_error: error,
            shape_error_relative: error.and_then(relative),
            fragments: pieces.count,
            stray_volume: pieces.stray_volume,
            corrections: MaterialCorrections {
                clipped: account.clipped,
                rescaled: account.rescaled,
                wisps: account.wisps,
                dilated: account.dilated,
            },
        }
    }
}

/// Kinds of files that a scene does not ask for.
pub(crate) fn not_asked_for(output: &OutputSetup) -> Vec<String> {
    let kinds = [
        ("interface obj", output.obj),
        ("interface vtk", output.vtk),
        ("fields", output.fields),
        ("picture", output.picture),
        ("history", output.history),
    ];
    kinds.iter().filter(|(_, asked)| !asked).map(|(kind, _)| (*kind).to_owned()).collect()
}

/// Cells in which some material is mixed.
pub(crate) fn mixed_cells(fractions: &[Vec<f64>]) -> usize {
    let cells = fractions.first().map_or(0, Vec::len);
    // Whole numbers add up exactly.
    parallel::sum(cells, |cell| if fractions.iter().any(|f| is_mixed(f[cell])) { 1.0 } else { 0.0 }) as usize
}

/// Faces of a mesh; those at joined ends are one.
fn face_count<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>) -> usize {
    let (cells, periodic) = (mesh.grid().cells(), mesh.grid().periodic());
    let across =
        |axis: usize| (0..D).map(|k| cells[k] + usize::from(k == axis && !periodic[axis])).product::<usize>();
    (0..D).map(across).sum()
}
