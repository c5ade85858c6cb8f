//! Interface reconstruction: a plane in every mixed cell that leaves the material its volume.
//!
//! This file places the planes of one material, and reconstructs whole interfaces; [`sharing`] says which planes the materials
//! of a cell need, and [`nested`] cuts several of them from one cell, in an `order` of its own.

mod centroids;
mod facets;
pub mod nested;
mod order;
mod parts;
pub mod sharing;

use vofkit_geometry::clip::Tile;
use vofkit_geometry::{Cell, HalfSpace, PlaneConstant, PositionError, PositionMethod, Vector, Wanted};

pub(crate) use nested::region;
pub use nested::{Cut, Dissector, Shared};
pub(crate) use nested::{RegionOf, Share};
pub use parts::Parts;
pub use sharing::Materials;
pub(crate) use sharing::planes_of_all;

use facets::{facet, nested_facets};

use crate::facet::Facet;
use crate::mesh::{Grid, Mesh};
use crate::normal::{Direction, Found, Material, NoNormal, NormalMethod};
use crate::parallel;
use crate::stopwatch::Stopwatch;

mod status;

pub use status::CellStatus;

/// How the interface is reconstructed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Reconstruction {
    /// The normal.
    pub normal: NormalMethod,
    /// The plane constant.
    pub position: PositionMethod,
    /// Several materials in one cell.
    pub materials: Materials,
}

/// What the reconstruction of one mixed cell gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Placed<const D: usize> {
    /// A plane, in the coordinates of [`Mesh::local_cell`].
    Plane {
        /// The material's half-space.
        half_space: HalfSpace<D>,
        /// Whether the patch of cells around determines it: see [`Direction::determined`].
        determined: bool,
        /// Plane constants found on the way to the normal.
        trials: usize,
        /// Evaluations of the truncated volume for the plane constant.
        evaluations: usize,
        /// Whether a closed form gave it.
        closed_form: bool,
    },
    /// No plane: the fractions around the cell give no direction.
    NoNormal(NoNormal),
    /// One of several materials that are cut one after the other: see [`Dissector`]; with the direction of its own fractions, where the
    /// method found one that others build on.
    Nested(Option<Direction<D>>),
}

impl<const D: usize> Placed<D> {
    /// Whether it is one of several that are cut one after the other.
    pub fn is_nested(&self) -> bool {
        matches!(self, Self::Nested(_))
    }

    /// Its direction among its own fractions.
    fn direction(&self) -> Option<Direction<D>> {
        match *self {
            Self::Plane { half_space, determined, trials, .. } => {
                Some(Direction { normal: half_space.normal, determined, trials })
            }
            Self::NoNormal(_) => None,
            Self::Nested(direction) => direction,
        }
    }

    /// The same plane for the material on its other side.
    fn complement(self) -> Self {
        match self {
            Self::Plane { half_space, determined, trials, evaluations, closed_form } => {
                let half_space = half_space.complement();
                Self::Plane { half_space, determined, trials, evaluations, closed_form }
            }
            _ => self,
        }
    }
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
    /// Fractions of several materials that a cell has no room for.
    #[error("the fractions in cell {cell:?} add up to {sum}, more than 1")]
    Overfull {
        /// The cell's index along each axis.
        cell: Vec<usize>,
        /// Their sum.
        sum: f64,
    },
    /// Centroids that are not one for each cell and material.
    #[error("centroids are given for {given} {of}, not for {wanted}")]
    Centroids {
        /// Number of materials, or of cells.
        given: usize,
        /// How many there are.
        wanted: usize,
        /// Which of the two.
        of: &'static str,
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
#[cfg_attr(feature = "cli", derive(serde::Deserialize, serde::Serialize))]
pub struct Counts {
    /// Mixed cells, one for each material in them.
    pub mixed: usize,
    /// Those without a normal, by [`NoNormal`]: among equals.
    pub flat: usize,
    /// Alone among equals.
    pub isolated: usize,
    /// Between neighbours that differ, but pull in no direction.
    pub balanced: usize,
    /// Without the centroid that the method needs.
    pub no_centroid: usize,
    /// Cells with a plane that the patch around does not determine.
    pub undetermined: usize,
    /// Plane constants in closed form.
    pub closed_form: usize,
    /// Plane constants by iteration.
    pub iterative: usize,
    /// Evaluations of truncated volumes by the iterations.
    pub evaluations: usize,
    /// Plane constants found on the way to normals.
    pub trials: usize,
}

impl Counts {
    /// Counts one mixed cell; materials that are cut one after the other count when they are.
    pub fn count<const D: usize>(&mut self, placed: &Placed<D>) {
        self.mixed += usize::from(!placed.is_nested());
        match *placed {
            Placed::Nested(_) => {}
            Placed::NoNormal(NoNormal::Flat) => self.flat += 1,
            Placed::NoNormal(NoNormal::Isolated) => self.isolated += 1,
            Placed::NoNormal(NoNormal::Balanced) => self.balanced += 1,
            Placed::NoNormal(NoNormal::NoCentroid) => self.no_centroid += 1,
            Placed::Plane { determined, trials, evaluations, closed_form, .. } => {
                self.undetermined += usize::from(!determined);
                self.trials += trials;
                if closed_form {
                    self.closed_form += 1;
                } else {
                    self.iterative += 1;
                    self.evaluations += evaluations;
                }
            }
        }
    }

    /// Cells without a normal, whatever the reason.
    pub fn no_normal(&self) -> usize {
        self.flat + self.isolated + self.balanced + self.no_centroid
    }

    /// Evaluations per plane constant by iteration; none without any.
    pub fn evaluations_per_position(&self) -> Option<f64> {
        (self.iterative > 0).then(|| self.evaluations as f64 / self.iterative as f64)
    }

    /// Adds other counts.
    pub fn add(&mut self, other: &Self) {
        self.mixed += other.mixed;
        self.flat += other.flat;
        self.isolated += other.isolated;
        self.balanced += other.balanced;
        self.no_centroid += other.no_centroid;
        self.undetermined += other.undetermined;
        self.closed_form += other.closed_form;
        self.iterative += other.iterative;
        self.evaluations += other.evaluations;
        self.trials += other.trials;
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

/// What the plane constants are found on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Body {
    /// The cell with its ruled faces.
    Cell,
    /// Its [tile](vofkit_geometry::clip::tile), from which its materials are cut.
    Tile,
}

/// Places the planes of one material in the mixed `cells` (indices, ascending), one for each. A method that
/// [reads its neighbours](NormalMethod::reads_neighbours) finds them among these cells alone, so that all mixed cells around the
/// wanted ones should be among them; for others any set will do.
///
/// # Errors
/// A fraction that is not in `[0, 1]`, or no convergence.
pub fn planes<C: Cell<D>, const D: usize>(
    material: Material<'_, C, D>,
    cells: &[usize],
    method: Reconstruction,
) -> Result<Vec<Placed<D>>, ReconstructionError> {
    planes_timed(Body::Cell, material, cells, method, &mut Stopwatch::default())
}

/// The same on a body of choice, with the normals and the plane constants timed.
pub(crate) fn planes_timed<C: Cell<D>, const D: usize>(
    body: Body,
    material: Material<'_, C, D>,
    cells: &[usize],
    method: Reconstruction,
    stopwatch: &mut Stopwatch,
) -> Result<Vec<Placed<D>>, ReconstructionError> {
    let found = method.normal.normals(material, cells, method.position);
    stopwatch.lap(|seconds| &mut seconds.normals);
    let placed = parallel::map_blocks(cells.len(), |block| {
        place_all(body, material, &cells[block.clone()], &found[block], method.position)
    });
    let placed = placed.into_iter().collect();
    stopwatch.lap(|seconds| &mut seconds.positions);
    placed
}

/// The planes of mixed cells with the normals that were found.
fn place_all<C: Cell<D>, const D: usize>(
    body: Body,
    material: Material<'_, C, D>,
    cells: &[usize],
    found: &[Found<D>],
    position: PositionMethod,
) -> Vec<Result<Placed<D>, ReconstructionError>> {
    let cell = |index: usize| material.mesh.local_cell(index);
    let all = cells.iter().copied().zip(found.iter().copied());
    if body == Body::Tile {
        return all
            .map(|(index, found)| place_along(body, material, index, &cell(index), found, position))
            .collect();
    }
    let wanted: Vec<Wanted<C, D>> = (all.clone())
        .filter_map(|(index, found)| {
            let normal = found.ok()?.normal;
            Some(Wanted { cell: cell(index), normal, fraction: material.fractions[index] })
        })
        .collect();
    let mut constants = vec![Err(PositionError::Normal); wanted.len()];
    C::plane_constants(&wanted, position, |i, found| constants[i] = found);
    // One for each normal, in their order.
    let mut constants = constants.into_iter();
    all.map(|(index, found)| {
        placed(material, index, found, |_| constants.next().unwrap_or(Err(PositionError::Normal)))
    })
    .collect()
}

/// The plane of one mixed cell with the normal that was found.
fn place_along<C: Cell<D>, const D: usize>(
    body: Body,
    material: Material<'_, C, D>,
    index: usize,
    cell: &C,
    found: Found<D>,
    position: PositionMethod,
) -> Result<Placed<D>, ReconstructionError> {
    let fraction = material.fractions[index];
    placed(material, index, found, |normal| match body {
        Body::Cell => cell.plane_constant(normal, fraction, position),
        Body::Tile => C::Tile::plane_constant(cell, normal, fraction, position),
    })
}

/// A plane from the normal that was found and the plane constant along it.
fn placed<C: Cell<D>, const D: usize>(
    material: Material<'_, C, D>,
    index: usize,
    found: Found<D>,
    constant: impl FnOnce(&Vector<D>) -> Result<PlaneConstant, PositionError>,
) -> Result<Placed<D>, ReconstructionError> {
    let Direction { normal, determined, trials } = match found {
        Ok(direction) => direction,
        Err(reason) => return Ok(Placed::NoNormal(reason)),
    };
    let found = constant(&normal).map_err(|source| {
        let cell = material.mesh.grid().offset(index).to_vec();
        ReconstructionError::Cell { cell, fraction: material.fractions[index], source }
    })?;
    Ok(Placed::Plane {
        half_space: HalfSpace { normal, constant: found.constant },
        determined,
        trials,
        evaluations: found.evaluations,
        closed_form: found.closed_form,
    })
}

/// The reconstructed interface of all materials as polygons, with what it took.
#[derive(Clone, Debug, Default)]
pub struct Interface<const D: usize> {
    /// By material, then cell: one facet for each plane of a material in a cell, several where materials share the cell.
    pub facets: Vec<Facet<D>>,
    /// What was done.
    pub counts: Counts,
}

/// Reconstructs the interface of every material in every mixed cell. `parts` are fractions, `[material][cell]`, or these with
/// centroids ([`MaterialMoments`](crate::fractions::MaterialMoments), [`Parts`]).
///
/// # Errors
/// See [`Parts::check`] and [`planes`].
pub fn reconstruct<'a, C: Cell<D>, const D: usize>(
    mesh: &'a Mesh<C, D>,
    parts: impl Into<Parts<'a, D>>,
    method: Reconstruction,
) -> Result<Interface<D>, ReconstructionError> {
    let parts = parts.into();
    parts.check(mesh.grid())?;
    let fractions = parts.fractions;
    let cells: Vec<usize> =
        (0..mesh.grid().len()).filter(|&i| fractions.iter().any(|f| is_mixed(f[i]))).collect();
    let mut counts = Counts::default();
    let untimed = &mut Stopwatch::default();
    let planes = planes_of_all(Body::Cell, mesh, parts, &cells, method, &mut counts, untimed)?;
    let mut interface = with_planes(mesh, parts, &cells, &planes, method)?;
    interface.counts.add(&counts);
    Ok(interface)
}

/// The interface in `cells` with the [planes](planes_of_all) that were placed in them; what is counted is what is cut one after the other.
///
/// # Errors
/// See [`Dissector::dissect`].
pub(crate) fn with_planes<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    parts: Parts<'_, D>,
    cells: &[usize],
    planes: &[Option<Placed<D>>],
    method: Reconstruction,
) -> Result<Interface<D>, ReconstructionError> {
    let mut interface = Interface::default();
    let materials = parts.fractions.len();
    let made = parallel::map(cells.len(), |i| {
        let (index, planes) = (cells[i], &planes[i * materials..][..materials]);
        if planes.iter().flatten().any(Placed::is_nested) {
            let cell = mesh.local_cell(index);
            let mut dissector = Dissector::default();
            let shared = Shared { mesh, parts, planes, index, cell: &cell };
            let counts = dissector.dissect(shared, [cell], method, |_, _, _| {})?;
            return Ok((counts, nested_facets(mesh, index, dissector.cuts(), dissector.last())));
        }
        let own =
            |(material, placed): (usize, &Option<Placed<D>>)| facet(mesh, index, material, placed.as_ref()?);
        Ok((Counts::default(), planes.iter().enumerate().filter_map(own).collect()))
    });
    for made in made {
        let (counts, facets) = made?;
        interface.counts.add(&counts);
        interface.facets.extend(facets);
    }
    interface.facets.sort_by_key(|facet| (facet.material, facet.cell));
    Ok(interface)
}
