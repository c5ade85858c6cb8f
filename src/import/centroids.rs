//! Centroids of materials in cells: cell data `centroid.<material>`, read only when they are asked for.

use vofkit_geometry::Vector;
use vofkit_geometry::clip::bounds;

use super::error::OddCentroid;
use super::{ImportError, StructuredGrid, reverse_layers, take_apart};
use crate::interface::is_mixed;
use crate::mesh::Grid;
use crate::tolerance::CENTROID_OUTSIDE;
use crate::whole_file;

/// What the names of centroids start with.
const CENTROID: &str = "centroid.";

impl StructuredGrid {
    /// The centroids of a material by cell, in the coordinates of the mesh. Those of cells that are not mixed may be anything. The file
    /// is read for them again.
    ///
    /// # Errors
    /// There are none, the array has not three numbers for each cell, or one in a mixed cell is no number or lies outside of the box
    /// around its cell.
    pub fn centroids<const D: usize>(&self, material: &str) -> Result<Vec<Vector<D>>, ImportError> {
        let fractions = self.fractions(material)?;
        let name = format!("{CENTROID}{material}");
        let bytes = whole_file::bytes(&self.path)
            .map_err(|error| ImportError::Read { path: self.path.clone(), error })?;
        let wanted = |section: &str, name: &str| section == "CellData" && name.starts_with(CENTROID);
        let document = take_apart(&self.path, &bytes, &wanted)?;
        let Some(array) = document.array("CellData", &name)? else {
            let there: Vec<String> = document.section("CellData").map(|array| array.name.clone()).collect();
            let there = if there.is_empty() { "none".to_owned() } else { there.join(", ") };
            return Err(self.error(
                format!("there is no cell array `{name}`; of this kind there are: {there}"),
                "write the centroids of every material as cell data called centroid.<material>, three numbers each, or use another normal",
            ));
        };
        let numbers = document.numbers(array, 3, fractions.len())?;
        let mut centroids: Vec<Vector<D>> =
            numbers.chunks_exact(3).map(|x| Vector::from_fn(|k, _| x[k])).collect();
        if self.reversed {
            let cells = self.cells::<D>();
            reverse_layers(&mut centroids, cells[..D - 1].iter().product());
        }
        self.check_centroids(&name, fractions, &centroids)?;
        Ok(centroids)
    }

    fn check_centroids<const D: usize>(
        &self,
        name: &str,
        fractions: &[f64],
        centroids: &[Vector<D>],
    ) -> Result<(), ImportError> {
        let grid = Grid::new(self.cells::<D>(), [false; D]);
        let mixed = (0..grid.len()).filter(|&index| is_mixed(fractions[index]));
        for index in mixed {
            let at = grid.offset(index);
            let corners: Vec<Vector<D>> = (0..1 << D)
                .map(|corner: usize| {
                    let node = grid.node_index(std::array::from_fn(|k| at[k] + (corner >> k & 1)));
                    Vector::from_fn(|k, _| self.nodes[node][k])
                })
                .collect();
            let [lower, upper] = bounds(&corners);
            let rounding = CENTROID_OUTSIDE * lower.amax().max(upper.amax());
            let centroid = centroids[index];
            let is_inside =
                (0..D).all(|k| centroid[k] >= lower[k] - rounding && centroid[k] <= upper[k] + rounding);
            if !is_inside {
                let mut cell = at.to_vec();
                if self.reversed {
                    cell[D - 1] = self.cells[D - 1] - 1 - cell[D - 1];
                }
                let [centroid, lower, upper] = [centroid, lower, upper].map(|x| x.as_slice().to_vec());
                let (path, array) = (self.path.clone(), name.to_owned());
                let odd = Box::new(OddCentroid { cell, centroid, lower, upper });
                return Err(ImportError::Centroid { path, array, odd });
            }
        }
        Ok(())
    }
}
