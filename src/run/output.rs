//! Interfaces, fields and pictures of a run, as far as the scene asks for them.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::draw::Draw;
use super::fields::{FIELD_TABLE, Fields, picture_files};
use super::folder::SUMMARY;
use super::history::HISTORY;
use super::plan::Plan;
use super::planes::CellPlanes;
use super::quantities::Quantities;
#[cfg(feature = "vtk")]
use super::series::Series;
#[cfg(feature = "vtk")]
use crate::export::vtk::Collection;
use crate::export::{ExportError, Snapshot};
use crate::facet::Facet;
use crate::mesh::Mesh;
use crate::profile::Profile;
use crate::scene::{Location, OutputSetup, Resolved, Still};
use crate::velocity::Flow;

/// Stems and extensions of the files of a state.
pub(super) const STATES: [(&str, &str); 3] = [("interface", "obj"), ("fields", "vts"), ("interface", "vtp")];
/// Those of fields at integration points.
pub(super) const POINTS: (&str, &str) = ("points", "vtp");

/// The pictures of a run.
pub(super) const FIRST: &str = "first";
pub(super) const LAST: &str = "last";

/// After which steps something is written, and which times are never reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    steps: Vec<usize>,
    /// Times after the end.
    pub after_end: Vec<f64>,
}

impl Schedule {
    /// Each time becomes the step that ends at it, else the first one after it.
    pub(crate) fn new(output: &OutputSetup, plan: &Plan) -> Self {
        let times = output.times.clone().unwrap_or_else(|| vec![0.0, plan.end]);
        let (reached, after_end): (Vec<f64>, Vec<f64>) =
            times.iter().partition(|time| plan.step_at(**time).is_some());
        let mut steps: Vec<usize> = reached.iter().filter_map(|&time| plan.step_at(time)).collect();
        steps.sort_unstable();
        steps.dedup();
        Self { steps, after_end }
    }

    /// Whether something is written after a number of steps.
    pub(crate) fn includes(&self, step: usize) -> bool {
        self.steps.binary_search(&step).is_ok()
    }

    /// The steps after which something is written.
    pub fn steps(&self) -> &[usize] {
        &self.steps
    }
}

/// The names of the files that a run of the scene writes, its summary included.
pub fn names<const D: usize>(scene: &Resolved<D>, schedule: &Schedule) -> Vec<String> {
    let output = &scene.output;
    let mut names = states(output, schedule.steps().len(), &scene.name);
    if output.fields && scene.fields.iter().any(|field| field.location == Location::Points) {
        names.extend((0..schedule.steps().len()).map(|number| state_file(POINTS.0, number, POINTS.1)));
    }
    if output.picture {
        if !scene.materials.is_empty() {
            names.extend([FIRST, LAST].map(picture_file::<D>));
        }
        names.extend(picture_files(scene));
    }
    if output.history {
        names.push(HISTORY.to_owned());
        names.extend((!scene.fields.is_empty()).then(|| FIELD_TABLE.to_owned()));
    }
    names.push(SUMMARY.to_owned());
    names
}

/// The names of the files of a reconstruction of which nothing moves, its summary included.
pub fn still_names<const D: usize>(scene: &Still<D>) -> Vec<String> {
    let output = &scene.output;
    let mut names = states(output, 1, &scene.name);
    if output.picture {
        names.push(picture_file::<D>(FIRST));
    }
    names.push(SUMMARY.to_owned());
    names
}

/// The names of the files of a number of states.
fn states(output: &OutputSetup, count: usize, scene: &str) -> Vec<String> {
    let mut names = Vec::new();
    for number in 0..count {
        let asked = STATES.iter().zip([output.obj, output.fields, output.vtk]).filter(|(_, asked)| *asked);
        names.extend(asked.map(|((stem, extension), _)| state_file(stem, number, extension)));
    }
    if count > 0 && (output.fields || output.vtk) {
        names.push(series_file(scene));
    }
    names
}

pub(super) fn state_file(stem: &str, number: usize, extension: &str) -> String {
    format!("{stem}_{number:04}.{extension}")
}

pub(super) fn series_file(scene: &str) -> String {
    format!("{scene}.pvd")
}

pub(super) fn picture_file<const D: usize>(when: &str) -> String {
    let extension = if D == 2 { "svg" } else { "png" };
    format!("picture_{when}.{extension}")
}

/// What the fields show besides the fractions.
pub(super) enum Beside<const D: usize> {
    /// The velocity.
    Velocity,
    /// The planes of the materials; none if there are no fields.
    Planes(Vec<CellPlanes<D>>),
}

/// What a run moves besides the fractions.
#[derive(Clone, Copy)]
pub(super) struct Moved<'a, const D: usize> {
    pub(super) fields: &'a Fields<'a, D>,
    pub(super) quantities: &'a Quantities<'a, D>,
    /// What moves them; none where they rest.
    pub(super) flow: Option<&'a Flow<D>>,
}

/// Writes the state of a run.
pub(super) struct Output<'a, const D: usize> {
    scene: &'a Still<D>,
    names: Vec<String>,
    folder: PathBuf,
    #[cfg(feature = "vtk")]
    series: Series<'a, D>,
    written: usize,
    /// The names of the files.
    pub(super) files: Vec<String>,
    /// The factor on the coordinates in OBJ files.
    pub(super) obj_scale: Option<f64>,
}

/// What was written of a run so far.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(super) struct Written {
    states: usize,
    #[cfg(feature = "vtk")]
    series: Collection,
    files: Vec<String>,
    obj_scale: Option<f64>,
}

impl Written {
    /// The names of the files.
    pub(super) fn files(&self) -> &[String] {
        &self.files
    }
}

impl<'a, const D: usize> Output<'a, D> {
    #[cfg_attr(not(feature = "vtk"), expect(unused_variables, reason = "only fields show it"))]
    pub(super) fn new(scene: &'a Still<D>, beside: Beside<D>, folder: PathBuf) -> Self {
        Self {
            scene,
            names: scene.material_names(),
            #[cfg(feature = "vtk")]
            series: Series::new(scene, beside, &folder),
            folder,
            written: 0,
            files: Vec::new(),
            obj_scale: None,
        }
    }

    /// What was written so far.
    pub(super) fn written(&self) -> Written {
        Written {
            states: self.written,
            #[cfg(feature = "vtk")]
            series: self.series.collection.clone(),
            files: self.files.clone(),
            obj_scale: self.obj_scale,
        }
    }

    /// Goes on behind what was written.
    pub(super) fn go_on(&mut self, written: Written) {
        self.written = written.states;
        self.files = written.files;
        self.obj_scale = written.obj_scale;
        #[cfg(feature = "vtk")]
        {
            let path = self.series.collection.path().to_owned();
            self.series.collection = written.series.moved_to(path);
        }
    }

    /// Whether facets are written with the state.
    pub(super) fn needs_facets(&self) -> bool {
        self.scene.output.obj || self.scene.output.vtk
    }

    /// The state at one of the times asked for.
    pub(super) fn state<C: Draw<D>>(
        &mut self,
        mesh: &Mesh<C, D>,
        time: f64,
        fractions: &[Vec<f64>],
        facets: &[Facet<D>],
        moved: Option<Moved<'_, D>>,
    ) -> Result<(), ExportError> {
        let number = self.written;
        self.written += 1;
        #[cfg(feature = "obj")]
        if self.scene.output.obj {
            let smallest = mesh.volumes().iter().fold(f64::INFINITY, |a, &b| a.min(b));
            let size = smallest.powf(1.0 / D as f64);
            let name = state_file("interface", number, "obj");
            let path = self.folder.join(&name);
            let scale = crate::export::obj::write_obj(path, &self.names, facets, size)?;
            self.obj_scale = Some(scale).filter(|&scale| scale != 1.0);
            self.files.push(name);
        }
        #[cfg(feature = "vtk")]
        self.files.extend(self.series.add(mesh, number, time, fractions, facets, moved)?);
        #[cfg(not(all(feature = "obj", feature = "vtk")))]
        let _ = (mesh, number, time, fractions, facets, moved);
        Ok(())
    }

    /// Removes what was written.
    pub(super) fn discard(&mut self) {
        for name in self.files.drain(..) {
            // Whatever made the run fail is reported.
            let _ = std::fs::remove_file(self.folder.join(name));
        }
    }

    /// Pictures of the fields with `when` in their names.
    pub(super) fn field_pictures<C: Draw<D>>(
        &mut self,
        when: &str,
        mesh: &Mesh<C, D>,
        time: f64,
        fields: &Fields<'_, D>,
        exact: &[Option<Vec<Profile<D>>>],
    ) -> Result<(), ExportError> {
        let time = rounded(time).to_string();
        self.files.extend(fields.draw(&self.folder, mesh, when, &time, exact)?);
        Ok(())
    }

    /// A picture with `when` in its name.
    pub(super) fn picture<C: Draw<D>>(
        &mut self,
        when: &str,
        mesh: &Mesh<C, D>,
        time: f64,
        fractions: &[Vec<f64>],
        facets: &[Facet<D>],
    ) -> Result<(), ExportError> {
        let name = picture_file::<D>(when);
        let title = title(&self.scene.name, time);
        let snapshot = Snapshot { mesh, names: &self.names, fractions, facets, title: &title };
        if C::draw(&self.folder.join(&name), &snapshot)? {
            self.files.push(name);
        }
        Ok(())
    }
}

/// What stands above a picture of a scene.
pub(crate) fn title(scene: &str, time: f64) -> String {
    format!("{scene}, t = {}", rounded(time))
}

/// A time with no more digits than people read.
fn rounded(time: f64) -> f64 {
    format!("{time:.6}").parse().unwrap_or(time)
}
