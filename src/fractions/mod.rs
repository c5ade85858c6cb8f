//! Volume fractions of shapes on a mesh, and, where they are asked for, centroids.
//!
//! Totals are right to 1e-9 of a shape's volume and better on any mesh, however coarse or distorted; shapes with flat sides, and bodies
//! given by their surfaces on undistorted meshes, come out to rounding. The cost follows the surfaces: one bound settles a pure cell.
//!
//! Read in this order: `region` takes shapes apart into surfaces and logic; `cut` splits a cut cell into bricks; `integral`
//! integrates over one what `measure` says; `solid` and `apart` deal with cells that bodies cut, by way of `facet`; `form` knows where lines cross surfaces and where that changes; `brick`, `polynomial`, `quadrature`
//! and `tolerance` are the tools.

mod apart;
mod brick;
mod cut;
mod facet;
mod form;
mod integral;
mod measure;
mod polynomial;
mod quadrature;
mod region;
mod solid;
mod tolerance;

use vofkit_geometry::{Cell, HalfSpace, Vector};

use crate::mesh::Mesh;
use crate::parallel;
use crate::shape::Shape;

use brick::{Brick, CORNERS, bits};
use cut::Cut;
use measure::{Measure, Moments};
use region::Region;
use solid::Solid;
use tolerance::FULL;

/// The volume fractions of materials that fill the `shapes`: one vector by cell index for each. Where shapes overlap the earlier one
/// has the material.
///
/// Fractions are in `[0, 1]`, exactly 0 or 1 in pure cells, and those of one cell add up to at most 1, up to rounding. The
/// result is the same for any number of threads. The shapes are taken to be valid: see [`Shape::check`].
pub fn volume_fractions<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, shapes: &[Shape<D>]) -> Vec<Vec<f64>> {
    let mut left = vec![1.0_f64; mesh.grid().len()];
    let of_material = |region: Region<D>| {
        let found = parallel::map(left.len(), |cell| {
            if left[cell] <= 0.0 {
                return 0.0;
            }
            settled(mesh_brick(mesh, cell).fraction::<C>(&region), left[cell])
        });
        left.iter_mut().zip(&found).for_each(|(left, fraction)| *left -= fraction);
        found
    };
    regions(shapes).map(of_material).collect()
}

/// What each shape has without the earlier ones. Those whose box lies apart from its own take nothing away.
fn regions<const D: usize>(shapes: &[Shape<D>]) -> impl Iterator<Item = Region<D>> {
    let boxes: Vec<_> = shapes.iter().map(Shape::bounding_box).collect();
    let may_meet = |a: &Option<[Vector<D>; 2]>, b: &Option<[Vector<D>; 2]>| match (a, b) {
        (Some([a, b]), Some([c, d])) => (0..D).all(|k| !(b[k] < c[k] || d[k] < a[k])),
        _ => true,
    };
    shapes.iter().enumerate().map(move |(own, shape)| {
        let earlier = (0..own).filter(|&other| may_meet(&boxes[own], &boxes[other]));
        Region::new(shape, earlier.map(|other| &shapes[other]))
    })
}

/// Volume fractions and centroids of materials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialMoments<const D: usize> {
    /// By material and cell: see [`volume_fractions`].
    pub fractions: Vec<Vec<f64>>,
    /// By material and cell, the middle of what the material has of the cell,
    ///
    /// ```text
    /// c = int x dV / int dV,
    /// ```
    ///
    /// in the coordinates of the mesh; not a number where it has nothing of it.
    pub centroids: Vec<Vec<Vector<D>>>,
}

/// [`volume_fractions`] together with the centroids.
///
/// Centroids are right to 1e-9 of a cell and better on any mesh, however little of the material a cell has, and to rounding where the
/// shape has flat sides; those of bodies given by their surfaces are as exact as the fractions. The last digits of the fractions may
/// differ from those without centroids, since the quadrature looks at both.
pub fn material_moments<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    shapes: &[Shape<D>],
) -> MaterialMoments<D> {
    let mut left = vec![1.0_f64; mesh.grid().len()];
    let mut all = MaterialMoments::default();
    for region in regions(shapes) {
        let found = parallel::map(left.len(), |cell| {
            if left[cell] <= 0.0 {
                return (0.0, Vector::repeat(f64::NAN));
            }
            let (fraction, centroid) = mesh_brick(mesh, cell).fraction_and_centroid::<C>(&region);
            (settled(fraction, left[cell]), centroid)
        });
        left.iter_mut().zip(&found).for_each(|(left, (fraction, _))| *left -= fraction);
        let (fractions, centroids) = found.into_iter().unzip();
        all.fractions.push(fractions);
        all.centroids.push(centroids);
    }
    all
}

/// A fraction of which nothing but rounding is `left` takes that too.
fn settled(fraction: f64, left: f64) -> f64 {
    if left - fraction <= FULL { left } else { fraction }
}

/// The volume of the part of a shape inside the mesh.
pub fn shape_volume<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, shape: &Shape<D>) -> f64 {
    let region = Region::new(shape, []);
    let volumes = parallel::map(mesh.grid().len(), |cell| mesh_brick(mesh, cell).integral::<C, f64>(&region));
    parallel::sum(volumes.len(), |cell| volumes[cell])
}

/// The volume fraction of a shape in one cell.
pub fn cell_fraction<C: Cell<D>, const D: usize>(cell: &C, shape: &Shape<D>) -> f64 {
    let anchor = cell.nodes()[0];
    Anchored { brick: Brick::of_cell(cell, &anchor), anchor }.fraction::<C>(&Region::new(shape, []))
}

/// The volume in which a half-space and a shape differ inside one cell, by lines at fixed places: to about a thousandth of it.
///
/// Where the two have the same boundary it is zero up to rounding. An adaptive integral would follow two surfaces that nearly
/// coincide at great cost.
pub fn symmetric_difference<C: Cell<D>, const D: usize>(
    cell: &C,
    half_space: &HalfSpace<D>,
    shape: &Shape<D>,
) -> f64 {
    let plane = Shape::HalfSpace(*half_space);
    let [one, other] = [[&plane, shape], [shape, &plane]]
        .map(|[all, without]| Shape::Difference(Box::new(all.clone()), vec![without.clone()]));
    let region = Region::new(&Shape::Union(vec![one, other]), []);
    let anchor = cell.nodes()[0];
    let brick = Brick::of_cell(cell, &anchor);
    let sides = vec![None; region.surfaces.len()];
    match region.has_bodies() {
        true => Solid::<C, D>::new(&region, anchor).integral(&brick, &sides, 0),
        false => Cut::sampled(&region, anchor).integral(&brick, &sides, 0),
    }
}

/// A cell as a brick relative to its first node, so that no digits are lost to the place of the mesh.
struct Anchored<const D: usize> {
    brick: Brick<D>,
    anchor: Vector<D>,
}

fn mesh_brick<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, cell: usize) -> Anchored<D> {
    let (grid, nodes) = (mesh.grid(), mesh.nodes());
    let at = grid.offset(cell);
    let anchor = nodes[grid.node_index(at)];
    let mut corners = [Vector::zeros(); CORNERS];
    for offset in C::OFFSETS {
        let node = grid.node_index(std::array::from_fn(|axis| at[axis] + offset[axis]));
        corners[bits(offset)] = nodes[node] - anchor;
    }
    Anchored { brick: Brick { corners }, anchor }
}

impl<const D: usize> Anchored<D> {
    /// The part of a region next to the cell, or whether the cell is all inside or all outside, as far as one bound per surface can tell.
    fn near(&self, region: &Region<D>) -> Result<Region<D>, bool> {
        let (centre, radius) = self.brick.ball();
        region.near(&|i| region.surfaces[i].side(&self.anchor, &centre, radius))
    }

    /// The measure of the part of the cell inside a region.
    fn integral<C: Cell<D>, M: Measure<D>>(&self, region: &Region<D>) -> M {
        match self.near(region) {
            Err(false) => M::default(),
            Err(true) => M::of_brick(&self.brick),
            Ok(near) => self.cut::<C, M>(&near),
        }
    }

    /// The same for the part of the region next to the cell.
    fn cut<C: Cell<D>, M: Measure<D>>(&self, near: &Region<D>) -> M {
        let sides = vec![None; near.surfaces.len()];
        match near.has_bodies() {
            true => Solid::<C, D>::new(near, self.anchor).integral(&self.brick, &sides, 0),
            false => Cut::new(near, self.anchor).integral(&self.brick, &sides, 0),
        }
    }

    fn fraction<C: Cell<D>>(&self, region: &Region<D>) -> f64 {
        match self.near(region) {
            Err(inside) => f64::from(u8::from(inside)),
            Ok(near) => self.fraction_of(self.cut::<C, f64>(&near)),
        }
    }

    /// The part that a volume is of the cell.
    fn fraction_of(&self, volume: f64) -> f64 {
        let fraction = volume / self.brick.volume();
        if fraction >= 1.0 - FULL { 1.0 } else { fraction.max(0.0) }
    }

    fn fraction_and_centroid<C: Cell<D>>(&self, region: &Region<D>) -> (f64, Vector<D>) {
        let moments: Moments<D> = self.integral::<C, _>(region);
        let fraction = self.fraction_of(moments.volume);
        let has_any = fraction > 0.0;
        let centroid = if has_any { moments.first / moments.volume } else { Vector::repeat(f64::NAN) };
        (fraction, self.anchor + centroid)
    }
}
