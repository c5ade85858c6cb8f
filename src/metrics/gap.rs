//! How well the planes of neighbouring cells meet.

use vofkit_geometry::{Cell, Vector};

use crate::facet::Facet;
use crate::mesh::Mesh;

/// The mean gap between the planes of neighbouring mixed cells, in cell sizes `V^(1/D)`: over all edges of their common face
/// (2D: the face itself) that both planes cross, the distance of the two points. None where no planes meet.
///
/// The facets are in the order of [`crate::interface::reconstruct`].
pub fn facet_gap_mean<C: Cell<D>, const D: usize>(mesh: &Mesh<C, D>, facets: &[Facet<D>]) -> Option<f64> {
    let grid = mesh.grid();
    let (mut sum, mut count) = (0.0, 0_usize);
    for facet in facets {
        let offset = grid.offset(facet.cell);
        let size = mesh.volumes()[facet.cell].powf(1.0 / D as f64);
        for axis in (0..D).filter(|&axis| offset[axis] + 1 < grid.cells()[axis]) {
            let key = (facet.material, facet.cell + grid.stride(axis));
            let first = facets.partition_point(|f| (f.material, f.cell) < key);
            let across = facets[first..].iter().take_while(|f| (f.material, f.cell) == key);
            let nodes = C::FACE_NODES[2 * axis + 1];
            let node = |i: usize| {
                let corner = C::OFFSETS[nodes[i % nodes.len()]];
                mesh.nodes()[grid.node_index(std::array::from_fn(|k| offset[k] + corner[k]))]
            };
            // A face in 2D is one edge.
            let edges = if D == 2 { 1 } else { nodes.len() };
            for (a, b) in (0..edges).map(|i| (node(i), node(i + 1))) {
                let Some(one) = crossing(facet, &a, &b) else { continue };
                // Where materials share a cell, there may be several facets: the nearest goes on.
                let gaps =
                    across.clone().filter_map(|f| crossing(f, &a, &b)).map(|other| (one - other).abs());
                if let Some(gap) = gaps.reduce(f64::min) {
                    sum += gap * (b - a).norm() / size;
                    count += 1;
                }
            }
        }
    }
    (count > 0).then(|| sum / count as f64)
}

/// Where the facet's plane crosses the edge from `a` to `b`, between 0 and 1.
fn crossing<const D: usize>(facet: &Facet<D>, a: &Vector<D>, b: &Vector<D>) -> Option<f64> {
    let height = |x: &Vector<D>| facet.normal.dot(x) - facet.plane_constant;
    let (from, to) = (height(a), height(b));
    ((from <= 0.0) != (to <= 0.0)).then(|| from / (from - to))
}
