//! Planes in cells as polygons.

use vofkit_geometry::section::area_vector;
use vofkit_geometry::{Cell, HalfSpace, Vector};

use super::Placed;
use super::nested::Cut;
use crate::facet::Facet;
use crate::mesh::Mesh;
use crate::space::spatial;

/// The piece of interface in a cell whose plane was placed; none where there is no plane.
pub(super) fn facet<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    index: usize,
    material: usize,
    placed: &Placed<D>,
) -> Option<Facet<D>> {
    let Placed::Plane { half_space, determined, .. } = placed else { return None };
    Some(section(mesh, index, material, half_space, *determined))
}

/// The section of a cell with the plane of a material; `local` is in the coordinates of [`Mesh::local_cell`].
fn section<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    index: usize,
    material: usize,
    local: &HalfSpace<D>,
    determined: bool,
) -> Facet<D> {
    // Polygons are made in the coordinates of the mesh, so that neighbours agree on the points of a common face.
    let half_space = local.translated(&mesh.anchor(index));
    Facet {
        cell: index,
        material,
        normal: half_space.normal,
        plane_constant: half_space.constant,
        determined,
        area: mesh.local_cell(index).truncate(local).section_area,
        loops: mesh.cell(index).section(&half_space),
    }
}

/// The facets of the materials in a cell that were cut one after the other: of each, all sides of its part, clipped to it. `last`
/// is the material that got what the cuts left, if one did.
pub(super) fn nested_facets<C: Cell<D>, const D: usize>(
    mesh: &Mesh<C, D>,
    index: usize,
    cuts: &[Cut<D>],
    last: Option<usize>,
) -> Vec<Facet<D>> {
    let anchor = mesh.anchor(index);
    let parts = cuts.iter().map(|cut| cut.material).chain([last]).enumerate();
    let mut facets = Vec::new();
    for (part, material) in parts.filter_map(|(part, material)| Some((part, material?))) {
        // The half-spaces that the part lies in: outside all cuts before its own, and inside that.
        let sides = cuts
            .iter()
            .take(part + 1)
            .enumerate()
            .map(|(place, cut)| if place == part { cut.half_space } else { cut.half_space.complement() });
        for (place, side) in sides.clone().enumerate() {
            let mut facet = section(mesh, index, material, &side, true);
            for (_, other) in sides.clone().enumerate().filter(|(other, _)| *other != place) {
                let other = other.translated(&anchor);
                facet.loops = facet.loops.iter().map(|points| clipped(points, &other)).collect();
            }
            facet.loops.retain(|points| points.len() >= D);
            if !facet.loops.is_empty() {
                facet.area = facet.loops.iter().map(|points| area(points, &facet.normal)).sum();
                facets.push(facet);
            }
        }
    }
    facets
}

/// The part of a plane polygon (2D: of a segment) in a half-space, of a convex one exactly; what remains of others may be joined by
/// edges of no width (Sutherland & Hodgman 1974).
fn clipped<const D: usize>(points: &[Vector<D>], half_space: &HalfSpace<D>) -> Vec<Vector<D>> {
    let heights: Vec<f64> = points.iter().map(|x| half_space.height(x)).collect();
    let mut kept = Vec::with_capacity(points.len() + 1);
    for (i, x) in points.iter().enumerate() {
        let next = (i + 1) % points.len();
        if heights[i] <= 0.0 {
            kept.push(*x);
        }
        if (heights[i] <= 0.0) != (heights[next] <= 0.0) {
            // From the lower end, so that a segment there and back gives one point.
            let (low, high) = if heights[i] <= 0.0 { (i, next) } else { (next, i) };
            kept.push(
                points[low] + (points[high] - points[low]) * (heights[low] / (heights[low] - heights[high])),
            );
        }
    }
    kept.dedup();
    if kept.len() > 1 && kept.first() == kept.last() {
        kept.pop();
    }
    kept
}

/// The area of a polygon across its normal, in 2D the length of a segment.
fn area<const D: usize>(points: &[Vector<D>], normal: &Vector<D>) -> f64 {
    if D == 2 {
        return points.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
    }
    let points: Vec<_> = points.iter().map(spatial).collect();
    area_vector(&points).dot(&spatial(normal))
}
