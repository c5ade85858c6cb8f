//! What can be wrong with a cell.

use std::fmt;

use crate::tolerance::{EDGE_COLLAPSED, ORIENTATION};
use crate::{Hexahedron, Vector, jacobian};

/// Something wrong with a cell, or odd about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Defect {
    /// A node's coordinate is NaN or infinite.
    NotFinite {
        /// The node's place in the cell.
        node: usize,
    },
    /// The volume (2D: area) is zero, negative, or not finite.
    NonPositiveVolume {
        /// The volume.
        volume: f64,
    },
    /// Two opposite edges of a quadrilateral cross.
    SelfIntersecting,
    /// The Jacobian determinant of a hexahedron's trilinear map is negative somewhere.
    NegativeJacobian {
        /// The smallest value found, relative to the largest Bernstein coefficient of the determinant.
        determinant: f64,
        /// The local coordinates where it was found.
        at: [f64; 3],
    },
    /// Two neighbouring nodes coincide: legal.
    CollapsedEdge {
        /// The places of the edge's nodes in the cell.
        nodes: [usize; 2],
    },
    /// The inner angle of a simple quadrilateral is above 180 degrees at a node: legal.
    NonConvex {
        /// The node's place in the cell.
        node: usize,
    },
}

impl Defect {
    /// Whether the cell cannot be used; otherwise it is legal, and only noticed.
    pub fn is_error(&self) -> bool {
        !matches!(self, Self::CollapsedEdge { .. } | Self::NonConvex { .. })
    }
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { node } => write!(f, "node {node} has a coordinate that is not a finite number"),
            Self::NonPositiveVolume { volume } => write!(f, "the volume {volume:e} is not positive"),
            Self::SelfIntersecting => write!(f, "two opposite edges cross"),
            Self::NegativeJacobian { determinant, at: [xi, eta, zeta] } => write!(
                f,
                "the Jacobian determinant is negative, {determinant:.3e} of its bound, at the local \
                 coordinates ({xi:.3}, {eta:.3}, {zeta:.3})"
            ),
            Self::CollapsedEdge { nodes: [a, b] } => {
                write!(f, "the edge between the nodes {a} and {b} has collapsed")
            }
            Self::NonConvex { node } => write!(f, "the inner angle at node {node} is above 180 degrees"),
        }
    }
}

/// `local` are the nodes in a frame in which they are of order one, whose Jacobian determinant has the given `sign`.
pub(crate) fn of_hexahedron(
    nodes: &[Vector<3>; 8],
    volume: f64,
    local: &[Vector<3>; 8],
    sign: f64,
) -> Vec<Defect> {
    let mut defects = of_nodes(nodes, volume, &Hexahedron::EDGES);
    if let Some(jacobian::Smallest { determinant, at }) = jacobian::negative(local, sign) {
        defects.push(Defect::NegativeJacobian { determinant, at });
    }
    defects
}

pub(crate) fn of_quad(nodes: &[Vector<2>; 4], area: f64) -> Vec<Defect> {
    let mut defects = of_nodes(nodes, area, &[[0, 1], [1, 2], [2, 3], [3, 0]]);
    let turn = |a: usize, b: usize, c: usize| orientation([&nodes[a], &nodes[b], &nodes[c]]);
    let cross = |[a, b]: [usize; 2], [c, d]: [usize; 2]| {
        turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
    };
    if cross([0, 1], [2, 3]) || cross([1, 2], [3, 0]) {
        defects.push(Defect::SelfIntersecting);
    } else if area > 0.0 {
        let reflex = (0..4).filter(|&i| turn((i + 3) & 3, i, (i + 1) & 3) < 0.0);
        defects.extend(reflex.map(|node| Defect::NonConvex { node }));
    }
    defects
}

/// What needs no more than the nodes, the volume and the edges.
fn of_nodes<const D: usize>(nodes: &[Vector<D>], volume: f64, edges: &[[usize; 2]]) -> Vec<Defect> {
    let mut defects = Vec::new();
    for (node, x) in nodes.iter().enumerate() {
        if !x.iter().all(|c| c.is_finite()) {
            defects.push(Defect::NotFinite { node });
        }
    }
    if !(volume > 0.0 && volume.is_finite()) {
        defects.push(Defect::NonPositiveVolume { volume });
    }
    // The largest component measures length without the squares that over- or underflow.
    let length = |[a, b]: &[usize; 2]| (nodes[*b] - nodes[*a]).amax();
    let longest = edges.iter().map(length).fold(0.0, f64::max);
    let collapsed = edges.iter().filter(|edge| length(edge) <= EDGE_COLLAPSED * longest);
    defects.extend(collapsed.map(|&nodes| Defect::CollapsedEdge { nodes }));
    defects
}

/// Sign of the area of the triangle `a b c`, and zero where rounding could decide it.
fn orientation([a, b, c]: [&Vector<2>; 3]) -> f64 {
    let (mut to_a, mut to_b) = (a - c, b - c);
    for edge in [&mut to_a, &mut to_b] {
        let size = edge.amax();
        if size > 0.0 {
            *edge /= size;
        }
    }
    let (left, right) = (to_a[0] * to_b[1], to_a[1] * to_b[0]);
    let area = left - right;
    if area.abs() > ORIENTATION * (left.abs() + right.abs()) { area.signum() } else { 0.0 }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{Cell, Quad};

    /// All eight corner determinants are above 0.37; on the edge between the nodes 3 and 2 it falls below -0.4.
    pub(crate) fn positive_corners_negative_inside() -> [Vector<3>; 8] {
        [
            [-1.0, 1.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.5, 1.0, -0.5],
            [0.5, 1.0, 1.0],
            [-0.5, -0.5, 0.5],
            [1.0, 0.0, 1.5],
            [0.5, 1.5, 1.5],
            [-1.0, 0.5, 1.0],
        ]
        .map(Vector::<3>::from)
    }

    fn unit_cube() -> [Vector<3>; 8] {
        std::array::from_fn(|i| Vector::<3>::from_fn(|axis, _| Hexahedron::OFFSETS[i][axis] as f64))
    }

    fn quad(nodes: [[f64; 2]; 4]) -> Vec<Defect> {
        Quad::new(nodes.map(Vector::<2>::from)).defects()
    }

    fn has_error(defects: &[Defect]) -> bool {
        defects.iter().any(Defect::is_error)
    }

    #[test]
    fn negative_inside_is_an_error_at_any_size_and_in_slivers() {
        for scale in [1e-75, 1e-9, 1.0, 1e9, 1e75] {
            for flat in [1e-6, 1.0] {
                let stretch = Vector::<3>::new(scale, scale, scale * flat);
                let of = |nodes: [Vector<3>; 8]| {
                    Hexahedron::new(nodes.map(|x| x.component_mul(&stretch))).defects()
                };
                let bad = of(positive_corners_negative_inside());
                assert!(
                    matches!(bad[..], [Defect::NegativeJacobian { determinant, .. }] if determinant < -0.01)
                );
                assert_eq!(of(unit_cube()), []);
            }
        }
    }

    #[test]
    fn inverted_cells_have_every_error() {
        let mut nodes = unit_cube();
        nodes.rotate_left(4);
        let defects = Hexahedron::new(nodes).defects();
        assert!(matches!(
            defects[..],
            [Defect::NonPositiveVolume { volume: -1.0 }, Defect::NegativeJacobian { determinant: -1.0, .. }]
        ));
        assert!(has_error(&quad([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]])));
    }

    #[test]
    fn wedge_pyramid_and_tetrahedron_are_legal() {
        let collapse = |pairs: &[[usize; 2]]| {
            let mut nodes = unit_cube();
            for &[from, to] in pairs {
                nodes[from] = nodes[to];
            }
            Hexahedron::new(nodes).defects()
        };
        let wedge = collapse(&[[2, 3], [6, 7]]);
        assert_eq!(wedge, [Defect::CollapsedEdge { nodes: [3, 2] }, Defect::CollapsedEdge { nodes: [7, 6] }]);
        let pyramid = collapse(&[[5, 4], [6, 4], [7, 4]]);
        assert!(pyramid.len() == 4 && !has_error(&pyramid), "{pyramid:?}");
        let tetrahedron = collapse(&[[2, 3], [5, 4], [6, 4], [7, 4]]);
        assert!(tetrahedron.len() == 5 && !has_error(&tetrahedron), "{tetrahedron:?}");
    }

    #[test]
    fn not_finite_nodes_are_all_listed() {
        let mut nodes = unit_cube();
        nodes[2][1] = f64::NAN;
        nodes[7][0] = f64::INFINITY;
        let defects = Hexahedron::new(nodes).defects();
        assert!(
            defects.contains(&Defect::NotFinite { node: 2 })
                && defects.contains(&Defect::NotFinite { node: 7 })
        );
        assert!(defects.iter().any(|d| matches!(d, Defect::NonPositiveVolume { .. })));
    }

    #[test]
    fn quads_that_touch_themselves_or_bend_inwards_are_legal() {
        assert_eq!(quad([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), []);
        assert_eq!(quad([[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]]), [Defect::NonConvex { node: 2 }]);
        // A triangle with a node on its edge, and one with two nodes that coincide.
        assert_eq!(quad([[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0]]), []);
        assert_eq!(
            quad([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]),
            [Defect::CollapsedEdge { nodes: [1, 2] }]
        );
        // The reflex node touches the opposite corner or edge.
        for touching in [[0.0, 0.0], [0.0, 0.5]] {
            let defects = quad([[0.0, 0.0], [1.0, 0.0], touching, [0.0, 1.0]]);
            assert!(!defects.contains(&Defect::SelfIntersecting), "{defects:?}");
        }
    }

    #[test]
    fn crossing_edges_are_an_error_at_any_size() {
        for scale in [1e-75, 1.0, 1e75] {
            let crossed = [[0.0, 0.0], [1.0, 0.0], [-0.25, 0.5], [0.0, 1.0]].map(|x| x.map(|c| c * scale));
            assert!(quad(crossed).contains(&Defect::SelfIntersecting), "{scale:e}");
        }
    }

    #[test]
    fn texts_carry_numbers() {
        let text = Defect::NegativeJacobian { determinant: -0.125, at: [0.5, 0.0, 1.0] }.to_string();
        assert!(text.contains("-1.250e-1") && text.contains("(0.500, 0.000, 1.000)"), "{text}");
        assert!(Defect::NonPositiveVolume { volume: -2.0 }.to_string().contains("-2e0"));
    }
}
