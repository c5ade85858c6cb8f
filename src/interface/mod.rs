//! Interface reconstruction: a plane in every mixed cell that leaves the material its volume.

use vofkit_geometry::{Cell, HalfSpace, PositionError, PositionMethod};

use crate::facet::Facet;
use crate::mesh::{Grid, Mesh};
use crate::normal::{NormalMethod, Stencil};
use crate::parallel;

/// How the interface is reconstructed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Reconstruction {
    /// The normal.
    pub normal: NormalMethod,
    /// The plane constant.
    pub position: PositionMethod,
}

/// What the reconstruction of one mixed cell gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placed<const D: usize> {
    /// A plane, in the coordinates of [`Mesh::local_cell`].
    Plane {
        /// The material's half-space.
        half_space: HalfSpace<D>,
        /// Evaluations of the truncated volume for the plane constant.
        evaluations: usize,
        /// Whether a closed form gave it.
        closed_form: bool,
    },
    /// The fractions around the cell give no direction: it is alone, or among equals.
    NoNormal,
}

/// Why there is no reconstruction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReconstructionError {
    /// A fraction that is none, or a plane constant that was not found.
    #[error("no plane in cell {cell:?} with fraction {fraction}: {source}")]
    Cell {
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// Its fraction.
        fraction: f64,
        /// What went wrong.
        source: PositionError,
    },
    /// Fractions that are not one for each cell.
    #[error("{given} fractions are given for a mesh of {cells} cells")]
    Length {
        /// Number of fractions.
        given: usize,
        /// Number of cells.
        cells: usize,
    },
}

/// Counts of what a reconstruction did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Mixed cells, one for each material in them.
    pub mixed: usize,
    /// Those for which no normal exists.
    pub no_normal: usize,
    /// Plane constants in closed form.
    pub closed_form: usize,
    /// Plane constants by iteration.
    pub iterative: usize,
    /// Evaluations of truncated volumes by the iterations.
    pub evaluations: usize,
}

impl Counts {
    /// Counts one mixed cell.
    pub fn count<const D: usize>(&mut self, placed: &Placed<D>) {
        self.mixed += 1;
        match *placed {
            Placed::NoNormal => self.no_normal += 1,
            Placed::Plane { closed_form: true, .. } => self.closed_form += 1,
            Placed::Plane { evaluations, .. } => {
                self.iterative += 1;
                self.evaluations += evaluations;
            }
        }
    }

    /// Adds other counts.
    pub fn add(&mut self, other: &Self) {
        self.mixed += other.mixed;
        self.no_normal += other.no_normal;
        self.closed_form += other.closed_form;
        self.iterative += other.iterative;
        self.evaluations += other.evaluations;
    }
}

/// Whether a fraction needs a plane.
pub fn is_mixed(fraction: f64) -> bool {
    fraction > 0.0 && fraction < 1.0
}

/// Checks that there is one fraction for each cell, and that all lie in `[0, 1]`.
///
/// # Errors
/// Another number of fractions, or the first fraction that does not, or is not a number.
pub fn check_fractions<const D: usize>(grid: &Grid<D>, fractions: &[f64]) -> Result<(), ReconstructionError> {
    if fractions.len() != grid.len() {
        return Err(ReconstructionError::Length { given: fractions.len(), cells: grid.len() });
    }
    match fractions.iter().position(|fraction| !(0.0..=1.0).contains(fraction)) {
        None => Ok(()),
        Some(index) => Err(ReconstructionError::Cell {
            cell: grid.offset(index).to_vec(),
            fraction: fractions[index],
            source: PositionError::Fraction(fractions[index]),
        }),
    }
}

/// Places the plane of one mixed cell; `cell` is [`Mesh::local_cell`] of `index`.
///
/// # Errors
/// A fraction that is not in `[0, 1]`, or no convergence.
pub fn place<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fractions: &[f64],
    index: usize,
    cell: &C,
    method: Reconstruction,
) -> Result<Placed<D>, ReconstructionError> {
    let offset = mesh.grid().offset(index);
    let stencil = Stencil::new(mesh.grid(), fractions, offset);
    let Some(normal) = method.normal.normal(mesh, offset, cell, &stencil) else {
        return Ok(Placed::NoNormal);
    };
    let found = cell.plane_constant(&normal, fractions[index], method.position).map_err(|source| {
        ReconstructionError::Cell { cell: offset.to_vec(), fraction: fractions[index], source }
    })?;
    Ok(Placed::Plane {
        half_space: HalfSpace { normal, constant: found.constant },
        evaluations: found.evaluations,
        closed_form: found.closed_form,
    })
}

/// The reconstructed interface of all materials as polygons, with what it took.
#[derive(Clone, Debug, Default)]
pub struct Interface<const D: usize> {
    /// One facet for each mixed cell and material that has a plane; by material, then cell.
    pub facets: Vec<Facet<D>>,
    /// What was done.
    pub counts: Counts,
}

/// Reconstructs the interface of every material (`fractions[material][cell]`) in every mixed cell.
///
/// # Errors
/// See [`check_fractions`] and [`place`].
pub fn reconstruct<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fractions: &[Vec<f64>],
    method: Reconstruction,
) -> Result<Interface<D>, ReconstructionError> {
    let mut interface = Interface::default();
    for (material, fractions) in fractions.iter().enumerate() {
        check_fractions(mesh.grid(), fractions)?;
        let mixed: Vec<usize> = (0..fractions.len()).filter(|&i| is_mixed(fractions[i])).collect();
        let placed = parallel::map(mixed.len(), |i| {
            let index = mixed[i];
            let cell = mesh.local_cell(index);
            let placed = place(mesh, fractions, index, &cell, method)?;
            let facet = match placed {
                Placed::NoNormal => None,
                Placed::Plane { half_space, .. } => Some(facet(mesh, index, material, &cell, &half_space)),
            };
            Ok((placed, facet))
        });
        for result in placed {
            let (placed, facet) = result?;
            interface.counts.count(&placed);
            interface.facets.extend(facet);
        }
    }
    Ok(interface)
}

fn facet<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    index: usize,
    material: usize,
    cell: &C,
    local: &HalfSpace<D>,
) -> Facet<D> {
    // Polygons are made in the coordinates of the mesh, so that neighbours agree on the points of a common face.
    let half_space = local.translated(&mesh.anchor(index));
    Facet {
        cell: index,
        material,
        normal: half_space.normal,
        plane_constant: half_space.constant,
        area: cell.truncate(local).section_area,
        loops: mesh.cell(index).section(&half_space),
    }
}
