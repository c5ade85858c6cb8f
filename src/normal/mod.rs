//! Interface normals from the fractions around a cell: one file per method, an enum at the edge.
//!
//! - Gradients: `youngs` (and what a stencil's gradient is in space), `least_squares`, and `slic`, which keeps the largest component;
//! - heights of columns of cells (`columns`): `myc`, `elvira`;
//! - planes fitted to the patch of cells around one (`patch`, in the cell's own `frame`): `lvira` and `elvira` by fractions, `swartz` by
//!   the middles of the neighbours' sections; `mof` fits the cell's own centroid. `descent` is the search for the least misfit.
//!
//! A method gives a [`Direction`], or says why there is none: it never invents one.

mod columns;
mod descent;
mod elvira;
pub(crate) mod frame;
mod least_squares;
mod lvira;
pub(crate) mod mof;
mod myc;
mod patch;
mod slic;
mod stencil;
mod swartz;
mod youngs;

use vofkit_geometry::{Cell, PositionMethod, Vector};

use crate::mesh::Mesh;
use crate::parallel;

pub use stencil::Stencil;

/// How the normal of the interface in a mixed cell is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum NormalMethod {
    /// Youngs' gradient over the 3^D stencil, taken to physical space with the Jacobian of the same stencil.
    Youngs,
    /// The paper's form of Youngs' gradient: the logical axes stand for the Cartesian ones (Eq. 82).
    YoungsLogical,
    /// The gradient that fits the differences to all neighbours best, near ones counting more.
    LeastSquares,
    /// The plane with the least misfit of fractions over the patch (Puckett 1991; Eq. 85).
    Lvira,
    /// The best of the planes that differences of column heights give (Pilliod & Puckett 2004).
    Elvira,
    /// The plane through the middles of the sections of the neighbours, until it stays (Swartz 1989; Mosso et al. 1996). The default:
    /// on nearly all meshes, undistorted or distorted, it leaves the smallest errors; scenes that move in space, where it takes
    /// far more time than gradients, have [`Self::Youngs`].
    #[default]
    Swartz,
    /// Along the logical direction in which the fractions change most (Noh & Woodward 1976).
    Slic,
    /// Moment of fluid: the plane that gives the material's own centroid (Dyadechko & Shashkov 2005; in space Ahn & Shashkov 2007). It needs
    /// the [centroids](Material::centroids), which fractions that were advected do not have.
    Mof,
    /// Youngs' normal or that of central column heights, whichever is less aligned with an axis (Aulisa et al. 2007).
    Myc,
}

/// One material on a mesh: what the methods read.
#[derive(Clone, Copy, Debug)]
pub struct Material<'a, C, const D: usize> {
    /// The mesh.
    pub mesh: &'a Mesh<C, D>,
    /// The material's fraction in each cell, in `[0, 1]`.
    pub fractions: &'a [f64],
    /// The centroid of the material in each cell, in the coordinates of the mesh; only [`NormalMethod::Mof`] reads them.
    pub centroids: Option<&'a [Vector<D>]>,
}

/// A normal with what it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction<const D: usize> {
    /// Unit normal, out of the material.
    pub normal: Vector<D>,
    /// Whether the patch determines the plane. If not (it crosses too few cells of it) the normal is the one that the
    /// method started from.
    pub determined: bool,
    /// Plane constants found on the way.
    pub trials: usize,
}

/// Why a mixed cell has no normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NoNormal {
    /// All fractions around are the same, the cell's own too.
    Flat,
    /// All fractions around are the same, the cell's own is not.
    Isolated,
    /// The fractions around differ, but pull in no direction: as at a film between two pure neighbours.
    Balanced,
    /// The method needs the material's centroid, and none is given.
    NoCentroid,
}

/// What a method found for one mixed cell.
pub type Found<const D: usize> = Result<Direction<D>, NoNormal>;

/// One mixed cell with what is around it.
struct Around<'a, C, const D: usize> {
    material: Material<'a, C, D>,
    index: usize,
    offset: [usize; D],
    /// [`Mesh::local_cell`].
    cell: &'a C,
    stencil: Stencil<D>,
}

impl<C, const D: usize> Around<'_, C, D> {
    fn fraction(&self) -> f64 {
        self.stencil.middle()
    }
}

impl<const D: usize> Direction<D> {
    /// A normal that took no plane constants.
    fn direct(normal: Vector<D>) -> Self {
        Self { normal, determined: true, trials: 0 }
    }
}

impl NormalMethod {
    /// Whether the method reads the planes of neighbouring cells, so that all of them have to be found at once.
    pub fn reads_neighbours(self) -> bool {
        self == Self::Swartz
    }

    /// Whether the method reads the centroids of the materials.
    pub fn reads_centroids(self) -> bool {
        self == Self::Mof
    }

    /// The normals in the mixed `cells` (indices, ascending). A method that [reads its
    /// neighbours](NormalMethod::reads_neighbours) finds them among these cells alone.
    pub fn normals<C: Cell<D>, const D: usize>(
        self,
        material: Material<'_, C, D>,
        cells: &[usize],
        position: PositionMethod,
    ) -> Vec<Found<D>> {
        if self == Self::Swartz {
            return swartz::relaxed(material, cells, position);
        }
        parallel::map(cells.len(), |i| {
            let cell = material.mesh.local_cell(cells[i]);
            self.normal(material, cells[i], &cell, position)
        })
    }

    /// The normal in the mixed cell with this index, for methods that read no neighbours' planes; others give the one that they
    /// start from. `cell` is [`Mesh::local_cell`].
    pub fn normal<C: Cell<D>, const D: usize>(
        self,
        material: Material<'_, C, D>,
        index: usize,
        cell: &C,
        position: PositionMethod,
    ) -> Found<D> {
        let grid = material.mesh.grid();
        let stencil = Stencil::new(grid, material.fractions, grid.offset(index));
        self.normal_among(material, index, cell, stencil, position)
    }

    /// The same, with other fractions around the cell than the material's own.
    pub(crate) fn normal_among<C: Cell<D>, const D: usize>(
        self,
        material: Material<'_, C, D>,
        index: usize,
        cell: &C,
        stencil: Stencil<D>,
        position: PositionMethod,
    ) -> Found<D> {
        let offset = material.mesh.grid().offset(index);
        let around = Around { material, index, offset, cell, stencil };
        match self {
            Self::Youngs | Self::Swartz => youngs::physical(&around),
            Self::YoungsLogical => youngs::logical(&around),
            Self::LeastSquares => least_squares::normal(&around),
            Self::Lvira => lvira::normal(&around, position),
            Self::Elvira => elvira::normal(&around, position),
            Self::Slic => slic::normal(&around),
            Self::Mof => mof::normal(&around, position),
            Self::Myc => myc::normal(&around),
        }
    }
}
