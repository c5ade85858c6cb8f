//! What the tests share: the exact cases of `truncation.csv`, cells and a seeded generator.
#![allow(dead_code)]

use vofkit_geometry::{Cell, HalfSpace, Hexahedron, Vector};

/// One exact case: cell, plane and results rounded once from 60 digits or more.
pub(crate) struct Case {
    pub(crate) category: &'static str,
    pub(crate) nodes: [Vector<3>; 8],
    pub(crate) half_space: HalfSpace<3>,
    pub(crate) cell_volume: f64,
    pub(crate) truncated_volume: f64,
    pub(crate) section_area: f64,
}

impl Case {
    pub(crate) fn cell(&self) -> Hexahedron {
        Hexahedron::new(self.nodes)
    }

    /// Volume of the nodes' bounding box: a bound for the terms that are summed, where they cancel.
    pub(crate) fn box_volume(&self) -> f64 {
        box_volume(&self.nodes)
    }
}

/// The cases of `truncation.csv`, in its order.
pub(crate) fn golden() -> Vec<Case> {
    include_str!("../truncation.csv").lines().skip(1).map(parse).collect()
}

/// Whether the cells of a category are valid ones.
pub(crate) fn is_valid(category: &str) -> bool {
    !matches!(category, "swept" | "bow_tie")
}

fn parse(line: &'static str) -> Case {
    let mut fields = line.split(',');
    let category = fields.next().expect("a category");
    let values: Vec<f64> = fields.map(|field| field.parse().expect("a number")).collect();
    let vector = |i: usize| Vector::<3>::from_row_slice(&values[i..i + 3]);
    Case {
        category,
        nodes: std::array::from_fn(|i| vector(3 * i)),
        half_space: HalfSpace { normal: vector(24), constant: values[27] },
        cell_volume: values[28],
        truncated_volume: values[29],
        section_area: values[30],
    }
}

/// Volume (2D: area) of the smallest box with edges along the axes around the nodes.
pub(crate) fn box_volume<const D: usize>(nodes: &[Vector<D>]) -> f64 {
    let low = nodes.iter().fold(nodes[0], |low, x| low.inf(x));
    let high = nodes.iter().fold(nodes[0], |high, x| high.sup(x));
    (high - low).product()
}

/// SplitMix64 (Steele, Lea & Flood 2014): a generator of a few lines, the same on every platform.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in `[low, high)`.
    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.next() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// Uniform in the cube `[-size, size)^D`.
    pub(crate) fn vector<const D: usize>(&mut self, size: f64) -> Vector<D> {
        Vector::<D>::from_fn(|_, _| self.within(-size, size))
    }

    /// Uniform on the unit sphere.
    pub(crate) fn unit<const D: usize>(&mut self) -> Vector<D> {
        loop {
            let v = self.vector::<D>(1.0);
            if (0.01..=1.0).contains(&v.norm_squared()) {
                return v.normalize();
            }
        }
    }

    /// The unit square or cube with its nodes moved by up to `size` along each axis.
    pub(crate) fn cell<const D: usize, C: Cell<D>>(&mut self, size: f64) -> C {
        let shifts: [Vector<D>; 8] = std::array::from_fn(|_| self.vector(size));
        C::from_corners(|offset| {
            let place = offset.iter().rev().fold(0, |place, c| 2 * place + c);
            corner(offset) + shifts[place]
        })
    }
}

/// A corner of the unit square or cube.
pub(crate) fn corner<const D: usize>(offset: [usize; D]) -> Vector<D> {
    Vector::<D>::from_fn(|axis, _| offset[axis] as f64)
}
