//! The planes of all materials on all cells, as fields show them.

use vofkit_geometry::Vector;

#[cfg(feature = "vtk")]
use crate::export::vtk::CellArray;
use crate::facet::Facet;
use crate::interface::{CellStatus, Placed};

/// The planes of one material by cell index. Where there is no plane the normal and the area are zero, the plane constant is not a
/// number, and the status says why.
#[derive(Clone, Debug)]
#[cfg_attr(not(feature = "vtk"), expect(dead_code, reason = "only fields show it"))]
pub(super) struct CellPlanes<const D: usize> {
    normals: Vec<Vector<D>>,
    constants: Vec<f64>,
    areas: Vec<f64>,
    status: Vec<i64>,
    /// Not numbers where there is nothing of the material; none where nothing reads them.
    pub(super) centroids: Option<Vec<Vector<D>>>,
}

impl<const D: usize> CellPlanes<D> {
    /// From the material's fractions, what the reconstruction gave in some cells, all mixed ones among them, and its facets. Where it is cut
    /// from its cell after other materials it has an area alone.
    pub(super) fn new<'a>(
        fractions: &[f64],
        placed: impl IntoIterator<Item = (usize, &'a Placed<D>)>,
        facets: impl IntoIterator<Item = &'a Facet<D>>,
    ) -> Self {
        let cells = fractions.len();
        let mut planes = Self {
            normals: vec![Vector::zeros(); cells],
            constants: vec![f64::NAN; cells],
            areas: vec![0.0; cells],
            status: fractions.iter().map(|&f| CellStatus::of_pure(f).code()).collect(),
            centroids: None,
        };
        for (cell, placed) in placed {
            planes.status[cell] = CellStatus::from(placed).code();
        }
        for facet in facets {
            planes.areas[facet.cell] += facet.area;
            if planes.status[facet.cell] != CellStatus::Nested.code() {
                planes.normals[facet.cell] = facet.normal;
                planes.constants[facet.cell] = facet.plane_constant;
            }
        }
        planes
    }

    /// As arrays `normal.<material>`, `plane_constant.<material>`, `area.<material>` and `status.<material>`; `centroid.<material>` where they
    /// are known.
    #[cfg(feature = "vtk")]
    pub(super) fn arrays(&self, material: &str) -> Vec<CellArray<'_, D>> {
        let name = |what: &str| format!("{what}.{material}");
        let mut arrays = vec![
            CellArray::vector(name("normal"), &self.normals),
            CellArray::scalar(name("plane_constant"), &self.constants),
            CellArray::scalar(name("area"), &self.areas),
            CellArray::whole(name("status"), &self.status),
        ];
        let centroids = self.centroids.iter();
        arrays.extend(centroids.map(|centroids| CellArray::vector(name("centroid"), centroids)));
        arrays
    }
}
