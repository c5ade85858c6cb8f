//! What the toolkit asks of a cell, in two and in three dimensions.

use crate::clip::Tile;
use crate::{Defect, HalfSpace, PlaneConstant, PositionError, PositionMethod, Vector};

/// What a plane leaves of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Truncation {
    /// Volume (2D: area) of the part of the cell inside the half-space; algebraic for inverted cells.
    pub volume: f64,
    /// Area (2D: length) of the section for a unit normal: the derivative of `volume` with respect to the
    /// plane constant. Undefined, but finite, where a whole face lies in the plane.
    pub section_area: f64,
}

/// A plane constant that is wanted: see [`Cell::plane_constants`].
#[derive(Clone, Copy, Debug)]
pub struct Wanted<C, const D: usize> {
    /// The cell.
    pub cell: C,
    /// The normal, of any length.
    pub normal: Vector<D>,
    /// The part of the cell's volume inside the half-space, in `[0, 1]`.
    pub fraction: f64,
}

/// A cell with `2^D` nodes and ruled faces, prepared for any number of cuts: [`crate::Quad`] for `D = 2`,
/// [`crate::Hexahedron`] for `D = 3`.
///
/// The cell is the image of the unit square or cube under the multilinear map that takes the corner with
/// *offset* `[i, j(, k)]`, each 0 or 1, to the node of that corner. Face `2 a + b` is the one where the
/// coordinate along the logical axis `a` equals `b`.
pub trait Cell<const D: usize>: Copy + Send + Sync + std::fmt::Debug + 'static {
    /// How regions are cut by it.
    type Tile: Tile<D, Cell = Self>;

    /// Number of faces, `2 D`.
    const FACES: usize;

    /// The cell type that VTK gives these nodes in this order.
    const VTK_CELL_TYPE: u8;

    /// The offset of each node, in node order.
    const OFFSETS: &'static [[usize; D]];

    /// The nodes of each face, in outward order: counter-clockwise seen from outside; in 2D in the direction
    /// in which the boundary runs counter-clockwise.
    const FACE_NODES: &'static [&'static [usize]];

    /// The face of [`Cell::swept`] that is the displaced one.
    const SWEPT_BACK: usize;

    /// The cell whose nodes are given by the offsets of their corners.
    fn from_corners(node: impl Fn([usize; D]) -> Vector<D>) -> Self;

    /// The region between a face and the same face displaced, both in outward order: positive where the
    /// `back` face lies inside, on the side against the outward normal.
    ///
    /// # Panics
    /// If the slices do not hold the `2^(D-1)` nodes of a face.
    fn swept(back: &[Vector<D>], face: &[Vector<D>]) -> Self;

    /// The volume of [`Cell::swept`], to the rounding of the volume of a cell of that extent, without what cuts need.
    ///
    /// # Panics
    /// If the slices do not hold the `2^(D-1)` nodes of a face.
    fn swept_volume(back: &[Vector<D>], face: &[Vector<D>]) -> f64 {
        Self::swept(back, face).volume()
    }

    /// The nodes, in node order.
    fn nodes(&self) -> &[Vector<D>];

    /// The exact volume (Eq. 22 of the paper; 2D: the area, Eq. 18).
    fn volume(&self) -> f64;

    /// Whether the cell is a parallelogram or parallelepiped, so that truncation and its inverse are closed forms.
    fn is_affine(&self) -> bool;

    /// The point of the cell at local coordinates in `[0, 1]^D`.
    fn map(&self, local: &Vector<D>) -> Vector<D>;

    /// The determinant of the derivative of [`Cell::map`] at local coordinates.
    fn jacobian_determinant(&self, local: &Vector<D>) -> f64;

    /// The vector from the middle of face `2 axis` to the middle of face `2 axis + 1`: a column of the mean Jacobian.
    fn mean_edge(&self, axis: usize) -> Vector<D>;

    /// The physical gradient `J^-T g` of a field with the logical gradient `g` (differences per cell), with
    /// the mean Jacobian `J`. Not finite where `J` is singular.
    fn physical_gradient(&self, logical: &Vector<D>) -> Vector<D>;

    /// The area vector of a face with these nodes in outward order: the integral of its unit normal (Eq. 21).
    ///
    /// # Panics
    /// If the slice does not hold the `2^(D-1)` nodes of a face.
    fn area_vector(nodes: &[Vector<D>]) -> Vector<D>;

    /// The area vector of one of the cell's faces, outward.
    fn face_area(&self, face: usize) -> Vector<D> {
        let mut nodes = [Vector::zeros(); 4];
        let index = Self::FACE_NODES[face];
        for (node, &i) in nodes.iter_mut().zip(index) {
            *node = self.nodes()[i];
        }
        Self::area_vector(&nodes[..index.len()])
    }

    /// What a plane leaves of the cell.
    fn truncate(&self, half_space: &HalfSpace<D>) -> Truncation;

    /// The integral of `x - point` over the part of the cell inside the half-space (algebraic for inverted cells).
    /// Where the cell is far from the origin, one of its nodes as `point` keeps digits that world coordinates lose.
    fn first_moment_about(&self, half_space: &HalfSpace<D>, point: &Vector<D>) -> Vector<D>;

    /// The integral of position over the part of the cell inside the half-space: moment over volume is its centroid.
    fn first_moment(&self, half_space: &HalfSpace<D>) -> Vector<D> {
        self.first_moment_about(half_space, &Vector::zeros())
    }

    /// The centroid of the section, of all its loops together (2D: segments); none where the plane misses the cell or
    /// only touches it. Exact for ruled faces, unlike the mean of sampled points.
    fn section_centroid(&self, half_space: &HalfSpace<D>) -> Option<Vector<D>>;

    /// The plane constant for which [`Cell::truncate`] gives `fraction` of the volume: its inverse.
    ///
    /// `fraction` 0 and 1 give the tangent planes. The normal need not have unit length.
    ///
    /// # Errors
    /// A fraction outside `[0, 1]` or not a number, a normal that is zero or not finite, a cell whose volume
    /// is not positive, or no convergence (on an inverted cell).
    fn plane_constant(
        &self,
        normal: &Vector<D>,
        fraction: f64,
        method: PositionMethod,
    ) -> Result<PlaneConstant, PositionError>;

    /// [`Cell::plane_constant`] for many cells: `give` is called once for each, in any order, with its place among the wanted.
    ///
    /// The results are the same bits as those for the cells one by one, whatever the number and the order of the cells.
    fn plane_constants(
        wanted: &[Wanted<Self, D>],
        method: PositionMethod,
        mut give: impl FnMut(usize, Result<PlaneConstant, PositionError>),
    ) {
        for (i, Wanted { cell, normal, fraction }) in wanted.iter().enumerate() {
            give(i, cell.plane_constant(normal, *fraction, method));
        }
    }

    /// The part of the cell next to `face` that holds `fraction` of its volume, cut off along a surface of
    /// constant local coordinate. Its nodes and faces are numbered as those of the cell. `fraction` is limited to `[0, 1]`.
    fn slab(&self, face: usize, fraction: f64) -> Self;

    /// The section as closed loops of points (2D: segments of two points), counter-clockwise seen from
    /// outside the material. Curved edges are sampled so that the chord error stays below
    /// [`crate::tolerance::SECTION_CHORD`] of the face; the points of an edge depend on face and plane alone, so that
    /// one plane through several cells gives a watertight surface.
    fn section(&self, half_space: &HalfSpace<D>) -> Vec<Vec<Vector<D>>>;

    /// Everything that is wrong with the cell, or odd; empty for a good cell.
    fn defects(&self) -> Vec<Defect>;
}
