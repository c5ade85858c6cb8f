//! Fields and interfaces for ParaView, tied together by their times.

use std::path::{Path, PathBuf};

use vofkit_geometry::{Cell, Vector};

use super::output::{Beside, Moved, POINTS, series_file, state_file};
use crate::export::ExportError;
use crate::export::vtk::{
    CellArray, Collection, fraction_arrays, write_poly_data, write_structured_grid_with_nodes,
};
use crate::facet::Facet;
use crate::mesh::Mesh;
use crate::scene::Still;

/// The VTK files of a run.
pub(super) struct Series<'a, const D: usize> {
    scene: &'a Still<D>,
    beside: Beside<D>,
    folder: PathBuf,
    pub(super) collection: Collection,
    names: Vec<String>,
}

impl<'a, const D: usize> Series<'a, D> {
    pub(super) fn new(scene: &'a Still<D>, beside: Beside<D>, folder: &Path) -> Self {
        let collection = Collection::new(folder.join(series_file(&scene.name)));
        Self { scene, beside, folder: folder.to_owned(), collection, names: scene.material_names() }
    }

    /// Writes the state number `number`, as far as the scene asks for it, and returns the names of the files.
    pub(super) fn add<C: Cell<D>>(
        &mut self,
        mesh: &Mesh<C, D>,
        number: usize,
        time: f64,
        fractions: &[Vec<f64>],
        facets: &[Facet<D>],
        moved: Option<Moved<'_, D>>,
    ) -> Result<Vec<String>, ExportError> {
        let mut files = Vec::new();
        let mut parts = Vec::new();
        if self.scene.output.fields {
            let mut arrays = fraction_arrays(&self.names, fractions);
            let velocities;
            match &self.beside {
                Beside::Velocity => {
                    let flow = moved.and_then(|moved| moved.flow);
                    let rest = || vec![Vector::zeros(); mesh.grid().len()];
                    velocities = flow.map_or_else(rest, |flow| flow.cell_velocities(mesh, time));
                    arrays.push(CellArray::vector("U", &velocities));
                }
                Beside::Planes(planes) => {
                    let each = planes.iter().zip(&self.names);
                    arrays.extend(each.flat_map(|(planes, material)| planes.arrays(material)));
                }
            }
            let fields = moved.map(|moved| moved.fields);
            let mixtures = moved.map_or_else(Vec::new, |moved| moved.quantities.mixtures(fractions));
            arrays.extend(moved.iter().flat_map(|moved| moved.quantities.arrays(&mixtures)));
            arrays.extend(fields.iter().flat_map(|fields| fields.arrays(false)));
            let name = state_file("fields", number, "vts");
            let path = self.folder.join(&name);
            let at_nodes = fields.map_or_else(Vec::new, |fields| fields.arrays(true));
            write_structured_grid_with_nodes(&path, mesh, &arrays, &at_nodes)?;
            files.push(name);
            parts.push(("fields", path));
            let name = state_file(POINTS.0, number, POINTS.1);
            let path = self.folder.join(&name);
            if let Some(fields) = fields
                && fields.write_points(&path, mesh)?
            {
                files.push(name);
                parts.push(("points", path));
            }
        }
        if self.scene.output.vtk {
            let name = state_file("interface", number, "vtp");
            write_poly_data(self.folder.join(&name), facets)?;
            files.push(name.clone());
            parts.push(("interface", self.folder.join(name)));
        }
        if parts.is_empty() {
            return Ok(files);
        }
        let parts: Vec<_> = parts.iter().map(|(group, path)| (*group, path.as_path())).collect();
        self.collection.add(time, &parts)?;
        if number == 0 {
            files.push(series_file(&self.scene.name));
        }
        Ok(files)
    }
}
