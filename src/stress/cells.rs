//! Hexahedra and planes to try.

use vofkit_geometry::{Cell, Defect, HalfSpace, Hexahedron, Vector};

use super::case::{Given, Input, Random, Row};

/// Nodes of the unit cube, moved by up to `size` along each axis.
pub(super) fn ruled(random: &mut Random, size: f64) -> [Vector<3>; 8] {
    let mut nodes = cube();
    nodes.iter_mut().for_each(|node| *node += random.vector(size));
    nodes
}

pub(super) fn cube() -> [Vector<3>; 8] {
    std::array::from_fn(|node| Vector::<3>::from_fn(|axis, _| Hexahedron::OFFSETS[node][axis] as f64))
}

/// Cells that are valid, or nearly always: boxes, parallelepipeds, and weakly and strongly ruled ones.
pub(super) fn common(random: &mut Random) -> [Vector<3>; 8] {
    match random.below(4) {
        0 => {
            let lengths = Vector::<3>::from_fn(|_, _| random.within(0.1, 2.0));
            cube().map(|x| x.component_mul(&lengths))
        }
        1 => parallelepiped(random),
        2 => ruled(random, 0.08),
        _ => ruled(random, 0.25),
    }
}

/// Nodes anywhere: swept regions, bow-ties, folded and inverted cells.
pub(super) fn anything(random: &mut Random) -> [Vector<3>; 8] {
    if random.below(2) == 0 {
        return std::array::from_fn(|_| random.vector(1.0));
    }
    swept(random)
}

pub(super) fn parallelepiped(random: &mut Random) -> [Vector<3>; 8] {
    let edges = [0, 1, 2].map(|axis| {
        let mut edge = random.vector(0.4);
        edge[axis] += 1.0;
        edge
    });
    cube().map(|x| edges[0] * x[0] + edges[1] * x[1] + edges[2] * x[2])
}

/// A face, and the same one moved by less than its size to either side.
pub(super) fn swept(random: &mut Random) -> [Vector<3>; 8] {
    let base = ruled(random, 0.2);
    let moves: [Vector<3>; 4] = std::array::from_fn(|_| random.vector(0.3));
    std::array::from_fn(|node| if node < 4 { base[node] } else { base[node - 4] + moves[node - 4] })
}

/// The same nodes with up to five edges collapsed.
pub(super) fn collapsed(random: &mut Random, mut nodes: [Vector<3>; 8]) -> [Vector<3>; 8] {
    for _ in 0..=random.below(4) {
        let (node, axis) = (random.below(8), random.below(3));
        let beside = Hexahedron::OFFSETS
            .iter()
            .position(|offset| (0..3).all(|k| (offset[k] != Hexahedron::OFFSETS[node][k]) == (k == axis)));
        nodes[node] = nodes[beside.unwrap_or(node)];
    }
    nodes
}

/// Whether the check lets a cell pass.
pub(super) fn is_valid(cell: &Hexahedron) -> bool {
    !cell.defects().iter().any(Defect::is_error)
}

/// The volume of the box around a cell.
pub(super) fn box_volume(cell: &Hexahedron) -> f64 {
    let nodes = cell.nodes();
    let low = nodes.iter().fold(nodes[0], |low, x| low.inf(x));
    let high = nodes.iter().fold(nodes[0], |high, x| high.sup(x));
    (high - low).product()
}

/// The row of a cell with a plane at a share of its height.
pub(super) fn cut(nodes: [Vector<3>; 8], normal: Vector<3>, share: f64) -> Input {
    let constant = at_share(nodes.map(|x| normal.dot(&(x - nodes[0]))), share);
    Input::Cell(Box::new(Row { nodes, normal, given: Given::Local(constant) }))
}

/// Where a share of the way from the lowest to the highest is done.
pub(super) fn at_share(heights: [f64; 8], share: f64) -> f64 {
    let low = heights.iter().fold(f64::INFINITY, |a, &b| a.min(b));
    let high = heights.iter().fold(f64::NEG_INFINITY, |a, &b| a.max(b));
    low + share * (high - low)
}

/// The row of a cell with a fraction.
pub(super) fn filled(nodes: [Vector<3>; 8], normal: Vector<3>, fraction: f64) -> Input {
    Input::Cell(Box::new(Row { nodes, normal, given: Given::Fraction(fraction) }))
}

impl Row {
    /// The cell in the place where its first node is the origin.
    pub(super) fn cell(&self) -> Hexahedron {
        Hexahedron::new(self.nodes).relative_to_first_node()
    }

    /// The plane in that place.
    pub(super) fn half_space(&self) -> HalfSpace<3> {
        let constant = match self.given {
            Given::Local(constant) => constant,
            Given::Constant(constant) => constant - self.normal.dot(&self.nodes[0]),
            Given::Fraction(_) => 0.0,
        };
        HalfSpace { normal: self.normal, constant }
    }

    /// The plane constant, where there is one.
    pub(super) fn constant(&self) -> f64 {
        if let Given::Constant(constant) = self.given { constant } else { f64::NAN }
    }

    /// The fraction, where there is one.
    pub(super) fn fraction(&self) -> f64 {
        if let Given::Fraction(fraction) = self.given { fraction } else { f64::NAN }
    }

    /// The same with every node moved by a map of the axes that keeps doubles exact.
    pub(super) fn stretched(&self, factors: [f64; 3]) -> Self {
        let factors = Vector::<3>::from(factors);
        let nodes = self.nodes.map(|x| x.component_mul(&factors));
        Self { nodes, normal: self.normal.component_div(&factors), given: self.given }
    }
}
