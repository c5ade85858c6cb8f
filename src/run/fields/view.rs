//! The values of fields for files and pictures.

#[cfg(feature = "vtk")]
use std::path::Path;

use vofkit_geometry::Cell;
#[cfg(feature = "vtk")]
use vofkit_geometry::Vector;

use super::{Fields, state::sampled};
use crate::export::ExportError;
#[cfg(feature = "vtk")]
use crate::export::vtk::{CellArray, write_points};
use crate::mesh::{Mesh, axis_name};
use crate::profile::Profile;
use crate::run::draw::{Draw, FieldView, Places};
use crate::run::output::{FIRST, LAST};
use crate::scene::{FieldSetup, Kind, Location, Resolved};
#[cfg(feature = "vtk")]
use crate::volume_associated::points;

/// How the names of pictures of fields start.
const PICTURE: &str = "field_";

fn picture_file(part: &str, when: &str) -> String {
    format!("{PICTURE}{part}_{when}.svg")
}

/// Whether it is the name of a picture of a field.
pub(in crate::run) fn is_field_picture(name: &str) -> bool {
    let whens = [FIRST, LAST].map(|when| format!("_{when}.svg"));
    name.starts_with(PICTURE) && whens.iter().any(|end| name.ends_with(end))
}

/// The names of the pictures of fields of a scene.
pub(in crate::run) fn picture_files<const D: usize>(scene: &Resolved<D>) -> Vec<String> {
    let drawn = if D == 2 { &scene.fields[..] } else { &[] };
    let parts: Vec<String> = drawn.iter().flat_map(parts).collect();
    [FIRST, LAST].iter().flat_map(|when| parts.iter().map(move |part| picture_file(part, when))).collect()
}

/// The name of each component of a field.
fn parts<const D: usize>(setup: &FieldSetup<D>) -> Vec<String> {
    let name = &setup.name;
    let axes = |list: &[usize]| list.iter().map(|&k| axis_name(k)).collect::<String>();
    match setup.kind {
        Kind::Scalar => vec![name.clone()],
        Kind::Vector => (0..D).map(|k| format!("{name}_{}", axes(&[k]))).collect(),
        Kind::Tensor => {
            let mixed = [[0, 1], [1, 2], [0, 2]].into_iter().take(D * (D - 1) / 2);
            (0..D).map(|k| [k, k]).chain(mixed).map(|pair| format!("{name}_{}", axes(&pair))).collect()
        }
    }
}

impl<const D: usize> Fields<'_, D> {
    /// The fields at cells, and those at integration points by their means, or the fields at nodes.
    #[cfg(feature = "vtk")]
    pub(in crate::run) fn arrays(&self, at_nodes: bool) -> Vec<CellArray<'_, D>> {
        let wanted = |setup: &FieldSetup<D>| matches!(setup.location, Location::Node(_)) == at_nodes;
        let array = |(k, setup): (usize, &FieldSetup<D>)| {
            let parts: Vec<&[f64]> = self.values(k).iter().map(Vec::as_slice).collect();
            CellArray::components(setup.name.clone(), &parts)
        };
        self.setups.iter().enumerate().filter(|(_, setup)| wanted(setup)).map(array).collect()
    }

    /// Writes the fields at integration points; returns whether there are any.
    #[cfg(feature = "vtk")]
    pub(in crate::run) fn write_points<C: Cell<D>>(
        &self,
        path: &Path,
        mesh: &Mesh<C, D>,
    ) -> Result<bool, ExportError> {
        let at_points: Vec<usize> =
            (0..self.setups.len()).filter(|&k| self.setups[k].location == Location::Points).collect();
        if at_points.is_empty() {
            return Ok(false);
        }
        let cells = mesh.grid().len();
        let places: Vec<Vector<D>> = (0..points::count(D))
            .flat_map(|number| (0..cells).map(move |cell| mesh.cell(cell).map(&points::local(number))))
            .collect();
        let values: Vec<Vec<Vec<f64>>> = at_points
            .iter()
            .map(|&k| {
                let moved = &self.state.points[k];
                if !moved.is_empty() {
                    return moved.iter().map(|of_component| of_component.concat()).collect();
                }
                let limiter = self.setups[k].method.limiter();
                let of_component = |means: &Vec<f64>| points::redistribute(mesh, limiter, means).concat();
                self.values(k).iter().map(of_component).collect()
            })
            .collect();
        let arrays: Vec<CellArray<'_, D>> = at_points
            .iter()
            .zip(&values)
            .map(|(&k, values)| {
                let parts: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
                CellArray::components(self.setups[k].name.clone(), &parts)
            })
            .collect();
        write_points(path, &places, &arrays)?;
        Ok(true)
    }

    /// Draws each component of each field; `exact` as from [`super::exact`]. Returns the names of the files.
    pub(in crate::run) fn draw<C: Draw<D>>(
        &self,
        folder: &std::path::Path,
        mesh: &Mesh<C, D>,
        when: &str,
        time: &str,
        exact: &[Option<Vec<Profile<D>>>],
    ) -> Result<Vec<String>, ExportError> {
        let mut files = Vec::new();
        for (k, setup) in self.setups.iter().enumerate() {
            let exact = exact[k].as_ref().map(|profiles| sampled(setup, profiles, mesh));
            let start = sampled(setup, &setup.initial, mesh);
            let at_nodes = matches!(setup.location, Location::Node(_));
            for (component, part) in parts(setup).iter().enumerate() {
                let title = format!("{part}, t = {time}");
                let view = FieldView {
                    mesh,
                    places: if at_nodes { Places::Nodes } else { Places::Cells },
                    values: &self.values(k)[component],
                    start: &start[component],
                    exact: exact.as_ref().map(|exact| exact[component].as_slice()),
                    title: &title,
                };
                let name = picture_file(part, when);
                if C::draw_field(&folder.join(&name), &view)? {
                    files.push(name);
                }
            }
        }
        Ok(files)
    }
}
