//! Volume fractions of shapes on a mesh.
//!
//! Totals are right to 1e-9 of a shape's volume and better on any mesh, however coarse or distorted; shapes with flat sides, and bodies
//! given by their surfaces on undistorted meshes, come out to rounding. The cost follows the surfaces: one bound settles a pure cell.
//!
//! Read in this order: `region` takes shapes apart into surfaces and logic; `cut` splits a cut cell into bricks; `integral`
//! integrates over one; `solid` and `apart` deal with cells that bodies cut, by way of `facet`; `form` knows where lines cross surfaces and where that changes; `brick`, `polynomial`, `quadrature`
//! and `tolerance` are the tools.

mod apart;
mod brick;
mod cut;
mod facet;
mod form;
mod integral;
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
    let mut fractions = Vec::with_capacity(shapes.len());
    for (material, shape) in shapes.iter().enumerate() {
        let region = Region::new(shape, &shapes[..material]);
        let found = parallel::map(left.len(), |cell| {
            if left[cell] <= 0.0 {
                return 0.0;
            }
            let fraction = mesh_brick(mesh, cell).fraction::<C>(&region);
            if left[cell] - fraction <= FULL { left[cell] } else { fraction }
        });
        left.iter_mut().zip(&found).for_each(|(left, fraction)| *left -= fraction);
        fractions.push(found);
    }
    fractions
}

/// The volume of the part of a shape inside the mesh.
pub fn shape_volume<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, shape: &Shape<D>) -> f64 {
    let region = Region::new(shape, &[]);
    let volumes = parallel::map(mesh.grid().len(), |cell| mesh_brick(mesh, cell).volume::<C>(&region));
    parallel::sum(volumes.len(), |cell| volumes[cell])
}

/// The volume fraction of a shape in one cell.
pub fn cell_fraction<C: Cell<D>, const D: usize>(cell: &C, shape: &Shape<D>) -> f64 {
    let anchor = cell.nodes()[0];
    Anchored { brick: Brick::of_cell(cell, &anchor), anchor }.fraction::<C>(&Region::new(shape, &[]))
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
    let region = Region::new(&Shape::Union(vec![one, other]), &[]);
    let anchor = cell.nodes()[0];
    let brick = Brick::of_cell(cell, &anchor);
    let sides = vec![None; region.surfaces.len()];
    match region.has_bodies() {
        true => Solid::<C, D>::new(&region, anchor).volume(&brick, &sides, 0),
        false => Cut::sampled(&region, anchor).volume(&brick, &sides, 0),
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
    /// Whether the cell is all inside or all outside a region, as far as one bound per surface can tell.
    fn pure(&self, region: &Region<D>) -> Option<bool> {
        let (centre, radius) = self.brick.ball();
        region.decide(&|i| region.surfaces[i].side(&self.anchor, &centre, radius))
    }

    fn volume<C: Cell<D>>(&self, region: &Region<D>) -> f64 {
        match self.pure(region) {
            Some(false) => 0.0,
            Some(true) => self.brick.volume(),
            None => {
                let sides = vec![None; region.surfaces.len()];
                match region.has_bodies() {
                    true => Solid::<C, D>::new(region, self.anchor).volume(&self.brick, &sides, 0),
                    false => Cut::new(region, self.anchor).volume(&self.brick, &sides, 0),
                }
            }
        }
    }

    fn fraction<C: Cell<D>>(&self, region: &Region<D>) -> f64 {
        match self.pure(region) {
            Some(inside) => f64::from(u8::from(inside)),
            None => {
                let fraction = self.volume::<C>(region) / self.brick.volume();
                if fraction >= 1.0 - FULL { 1.0 } else { fraction.max(0.0) }
            }
        }
    }
}
