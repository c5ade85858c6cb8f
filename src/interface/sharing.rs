//! Which planes the materials of a cell need.

use vofkit_geometry::Cell;

use super::order::{Next, Queue};
use super::{
    Body, Counts, Parts, Placed, Reconstruction, ReconstructionError, is_mixed, place_along, planes_timed,
};
use crate::mesh::Mesh;
use crate::normal::{NoNormal, Stencil};
use crate::parallel;
use crate::stopwatch::Stopwatch;
use crate::tolerance::{FRACTION_ROUNDING, OVERFULL};

/// How several materials in one cell are reconstructed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Materials {
    /// Cut one after the other from what the earlier ones left, so that they tile the cell; the order follows from the fractions: see
    /// [`super::nested`].
    #[default]
    Nested,
    /// The same, in the order in which the materials are listed.
    Listed,
    /// Each by a plane of its own, as if the others were void (the paper's way). Parts may overlap. Where parts have to tile their cell, in
    /// unsplit advection and in remapping, this is [`Materials::Nested`].
    Independent,
}

/// How the materials in one cell are told apart.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sharing<const D: usize> {
    /// Each has a plane of its own: it is alone, or the planes are independent.
    Own,
    /// Two fill the cell: the plane of one is that of both. It is placed already where other materials are around.
    Two { materials: [usize; 2], placed: Option<Placed<D>> },
    /// They are cut one after the other.
    Nested,
}

/// Places the planes of all materials in `cells` (indices, ascending), by cell and material; none where a material is absent or
/// fills its cell. What was placed is counted; what is [`Placed::Nested`] is up to the caller. About methods that
/// read their neighbours see [`planes`](super::planes).
///
/// # Errors
/// Fractions of a cell that add up to more than 1, and those of [`planes`](super::planes).
pub(crate) fn planes_of_all<C: Cell<D>, const D: usize>(
    body: Body,
    mesh: &Mesh<C, D>,
    parts: Parts<'_, D>,
    cells: &[usize],
    method: Reconstruction,
    counts: &mut Counts,
    stopwatch: &mut Stopwatch,
) -> Result<Vec<Option<Placed<D>>>, ReconstructionError> {
    let fractions = parts.fractions;
    let materials = fractions.len();
    let sharing = if materials > 1 && method.materials != Materials::Independent {
        parallel::map(cells.len(), |i| sharing(body, mesh, parts, cells[i], method))
            .into_iter()
            .collect::<Result<_, _>>()?
    } else {
        vec![Sharing::Own; cells.len()]
    };
    let mut all = vec![None; cells.len() * materials];
    for (material, f) in fractions.iter().enumerate() {
        // A method that reads its neighbours reads those too whose planes are not used.
        let needed = |i: usize| match sharing[i] {
            Sharing::Own => true,
            Sharing::Two { materials: [first, _], placed: None } if first == material => true,
            _ => method.normal.reads_neighbours(),
        };
        let (places, mixed): (Vec<usize>, Vec<usize>) =
            cells.iter().enumerate().filter(|&(i, &cell)| is_mixed(f[cell]) && needed(i)).unzip();
        let own = parts.material(mesh, material);
        let placed = planes_timed(body, own, &mixed, method, stopwatch)?;
        for (place, placed) in places.into_iter().zip(placed) {
            all[place * materials + material] = Some(placed);
        }
    }
    for ((&cell, sharing), planes) in cells.iter().zip(sharing).zip(all.chunks_mut(materials.max(1))) {
        match sharing {
            Sharing::Own => planes.iter().flatten().for_each(|placed| counts.count(placed)),
            Sharing::Two { materials: [first, second], placed } => {
                if let Some(placed) = placed.or(planes[first]) {
                    counts.count(&placed);
                    planes[first] = Some(placed);
                    planes[second] = Some(placed.complement());
                }
            }
            Sharing::Nested => {
                let here = fractions.iter().map(|f| f[cell] > 0.0);
                for (plane, here) in planes.iter_mut().zip(here) {
                    *plane = here.then(|| Placed::Nested(plane.as_ref().and_then(Placed::direction)));
                }
            }
        }
    }
    Ok(all)
}

fn sharing<C: Cell<D>, const D: usize>(
    body: Body,
    mesh: &Mesh<C, D>,
    parts: Parts<'_, D>,
    index: usize,
    method: Reconstruction,
) -> Result<Sharing<D>, ReconstructionError> {
    let fractions = parts.fractions;
    let mut here = (0..fractions.len()).filter(|&material| fractions[material][index] > 0.0);
    let (Some(first), Some(second)) = (here.next(), here.next()) else { return Ok(Sharing::Own) };
    if void(mesh, fractions, index)? > 0.0 || here.next().is_some() {
        return Ok(Sharing::Nested);
    }
    let around = |material: usize| Stencil::new(mesh.grid(), &fractions[material], mesh.grid().offset(index));
    let others = Stencil::uniform(1.0).plus(&around(first), -1.0).plus(&around(second), -1.0);
    // A centroid says how its material lies, whatever is around.
    if others.largest() <= OVERFULL || method.normal.reads_centroids() {
        return Ok(Sharing::Two { materials: [first, second], placed: None });
    }
    let mut queue = Queue::<C, D>::new();
    queue.fill(mesh.grid(), fractions, 0.0, index, method.materials);
    let Some(Next { place, sought, .. }) = queue.next() else {
        let placed = Some(Placed::NoNormal(NoNormal::Balanced));
        return Ok(Sharing::Two { materials: [first, second], placed });
    };
    let materials = if place == 0 { [first, second] } else { [second, first] };
    let material = parts.material(mesh, materials[0]);
    let cell = mesh.local_cell(index);
    let found = method.normal.normal_among(material, index, &cell, sought, method.position);
    let placed = Some(place_along(body, material, index, &cell, found, method.position)?);
    Ok(Sharing::Two { materials, placed })
}

/// The fraction of a cell without material; zero where there is no more than rounding.
pub(super) fn void<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    fractions: &[Vec<f64>],
    index: usize,
) -> Result<f64, ReconstructionError> {
    let sum: f64 = fractions.iter().map(|f| f[index]).sum();
    if sum > 1.0 + OVERFULL {
        return Err(ReconstructionError::Overfull { cell: mesh.grid().offset(index).to_vec(), sum });
    }
    Ok(if sum < 1.0 - FRACTION_ROUNDING { 1.0 - sum } else { 0.0 })
}
