//! The materials of mixed cells, one plane after the other: what a plane leaves goes to the next material, and what is left of
//! all is void. So the materials of a cell tile it, however their planes lie.
//!
//! The planes are placed on the cells' [tiles](vofkit_geometry::clip::tile), so that the pieces that are cut from them later add
//! up to what the cells hold.

use vofkit_geometry::clip::{Full, Region, Side, Tile};
use vofkit_geometry::root::brent;
use vofkit_geometry::tolerance::{POSITION_EVALUATIONS, POSITION_FAILURE, POSITION_RESIDUAL};
use vofkit_geometry::{Cell, HalfSpace, PositionError, PositionMethod, Vector};

use super::places::Places;
use crate::interface::{self, Counts, Placed, Reconstruction, ReconstructionError, is_mixed};
use crate::mesh::Mesh;
use crate::normal::Material;
use crate::parallel;
use crate::tolerance::FRACTION_ROUNDING;

/// What one material takes of what those before it leave of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Share<const D: usize> {
    /// Nothing.
    Nothing,
    /// What lies in a half-space, in the coordinates of [`Mesh::local_cell`].
    Below(HalfSpace<D>),
    /// This part everywhere: the fractions around the cell give no direction.
    Even(f64),
    /// All that is left.
    Rest,
}

/// The shares of all materials in mixed cells.
#[derive(Clone, Debug)]
pub(super) struct Nested<const D: usize> {
    cells: Places,
    /// By place in `cells`, then by material.
    shares: Vec<Share<D>>,
    materials: usize,
}

impl<const D: usize> Nested<D> {
    /// No shares yet in a mesh of this many cells.
    pub(super) fn new(cells: usize) -> Self {
        Self { cells: Places::new(cells), shares: Vec::new(), materials: 0 }
    }

    /// The shares in a cell; none if it is pure, or was not among those given.
    pub(super) fn of(&self, cell: usize) -> Option<&[Share<D>]> {
        self.cells.of(cell).map(|slot| &self.shares[slot * self.materials..][..self.materials])
    }

    /// Places the planes in the mixed ones of some cells, and counts them.
    ///
    /// # Errors
    /// A plane that was not found.
    pub(super) fn place<C: Cell<D>>(
        &mut self,
        mesh: &Mesh<C, D>,
        fractions: &[Vec<f64>],
        cells: impl Iterator<Item = usize>,
        method: Reconstruction,
    ) -> Result<Counts, ReconstructionError> {
        self.cells.clear();
        let mixed = |cell: &usize| fractions.iter().any(|f| is_mixed(f[*cell]));
        cells.filter(mixed).for_each(|cell| self.cells.insert(cell));
        self.materials = fractions.len();
        self.shares.clear();
        let mut counts = Counts::default();
        let cells = self.cells.items();
        self.shares.resize(cells.len() * fractions.len(), Share::Nothing);
        let mut normals: Vec<Option<Vector<D>>> = vec![None; self.shares.len()];
        for (k, f) in fractions.iter().enumerate() {
            let (slots, mixed): (Vec<usize>, Vec<usize>) = (0..cells.len())
                .map(|slot| (slot, cells[slot] as usize))
                .filter(|&(_, cell)| is_mixed(f[cell]))
                .unzip();
            let material = Material { mesh, fractions: f, centroids: None };
            for (slot, placed) in slots.into_iter().zip(interface::planes(material, &mixed, method)?) {
                counts.count(&placed);
                if let Placed::Plane { half_space, .. } = placed {
                    normals[slot * fractions.len() + k] = Some(half_space.normal);
                }
            }
        }
        let mut results = vec![Ok(()); cells.len()];
        parallel::for_each_with_chunk(&mut results, &mut self.shares, |slot, result, shares| {
            let normals = &normals[slot * fractions.len()..][..fractions.len()];
            *result = nest(mesh, fractions, cells[slot] as usize, normals, method.position, shares);
        });
        results.into_iter().collect::<Result<(), _>>().map(|()| counts)
    }
}

/// Places the planes of one cell one after the other, along these normals.
fn nest<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fractions: &[Vec<f64>],
    index: usize,
    normals: &[Option<Vector<D>>],
    method: PositionMethod,
    shares: &mut [Share<D>],
) -> Result<(), ReconstructionError> {
    let cell = mesh.local_cell(index);
    // What the materials so far leave: a region, once one of them has a plane, and how full of the rest that is everywhere.
    let mut region: Option<RegionOf<C, D>> = None;
    let (mut left, mut density) = (1.0, 1.0);
    for ((f, normal), share) in fractions.iter().zip(normals).zip(shares) {
        let fraction = f[index];
        if fraction <= 0.0 {
            continue;
        }
        if left - fraction <= FRACTION_ROUNDING {
            *share = Share::Rest;
            break;
        }
        let Some(normal) = *normal else {
            *share = Share::Even(fraction / left);
            density *= 1.0 - fraction / left;
            left -= fraction;
            continue;
        };
        left -= fraction;
        let found = match &region {
            None => C::Tile::plane_constant(&cell, &normal, fraction / density, method)
                .map(|found| found.constant),
            Some(region) => plane_constant_in(region, &normal, fraction / density * cell.volume()),
        };
        let constant = found.map_err(|source| ReconstructionError::Cell {
            cell: mesh.grid().offset(index).to_vec(),
            fraction,
            source,
        })?;
        let half_space = HalfSpace { normal, constant };
        *share = Share::Below(half_space);
        // With one material nobody asks for the rest.
        if fractions.len() > 1 {
            let whole = region.take().unwrap_or_else(|| C::Tile::region(&cell));
            let mut rest = Region::empty();
            region = match whole.cut(&half_space.complement(), &mut rest) {
                Ok(Side::Across) => Some(rest),
                // All but rounding is left, or nothing.
                _ => Some(whole),
            };
        }
    }
    Ok(())
}

/// The region type of a cell.
pub(super) type RegionOf<C, const D: usize> = <<C as Cell<D>>::Tile as Tile<D>>::Region;

/// The plane constant that leaves a volume of a region.
fn plane_constant_in<R: Region<D>, const D: usize>(
    region: &R,
    normal: &Vector<D>,
    volume: f64,
) -> Result<f64, PositionError> {
    let whole = region.volume();
    let heights = region.corners().map(|x| normal.dot(x));
    let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], h| [a.min(h), b.max(h)]);
    let excess = |constant: f64| {
        let mut below = R::empty();
        let part = match region.cut(&HalfSpace { normal: *normal, constant }, &mut below) {
            Ok(Side::Below) => whole,
            Ok(Side::Above) => 0.0,
            Ok(Side::Across) => below.volume(),
            Err(Full) => f64::NAN,
        };
        part - volume
    };
    let tolerance = POSITION_RESIDUAL * volume;
    let found = brent(excess, [low, high], [-volume, whole - volume], tolerance, POSITION_EVALUATIONS);
    let residual = found.residual / whole;
    if residual.abs() <= POSITION_FAILURE {
        Ok(found.position)
    } else {
        Err(PositionError::NoConvergence { residual, evaluations: found.evaluations })
    }
}
