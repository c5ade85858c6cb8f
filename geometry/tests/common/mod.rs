//! What the tests share: the exact cases of `truncation.csv`, cells and a seeded generator.
#![allow(dead_code)]

use proptest::prelude::ProptestConfig;
use proptest::test_runner::RngSeed;
use vofkit_geometry::{Cell, HalfSpace, Hexahedron, Vector};

/// One exact case: cell, plane and results rounded once from 60 digits or more.
pub(crate) struct Case {
    pub(crate) category: &'static str,
    pub(crate) nodes: [Vector<3>; 8],
    pub(crate) half_space: HalfSpace<3>,
    pub(crate) cell_volume: f64,
    pub(crate) truncated_volume: f64,
    pub(crate) section_area: f64,
    pub(crate) moment: Vector<3>,
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

/// The cases of `rotated.csv`: slivers and needles turned by any rotation.
pub(crate) fn rotated() -> Vec<Case> {
    include_str!("../rotated.csv").lines().skip(1).map(parse).collect()
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
        // Not in every table.
        moment: if values.len() > 31 { vector(31) } else { Vector::<3>::repeat(f64::NAN) },
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

/// What all property tests run with.
pub(crate) fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 500,
        rng_seed: RngSeed::Fixed(20),
        failure_persistence: None,
        // A smaller seed is not a simpler cell.
        max_shrink_iters: 0,
        ..ProptestConfig::default()
    }
}

/// Kinds of cells: each is made from a seed, so that a failure prints one number.
pub(crate) const KINDS: u64 = 6;

/// A random valid cell: little or much distorted, flat, with collapsed edges, of any size, or far from the origin.
pub(crate) fn valid_cell<const D: usize, C: Cell<D>>(seed: u64) -> C {
    let mut random = Random(seed);
    loop {
        let cell: C = random.cell(if seed % KINDS == 1 { 0.45 } else { 0.2 });
        let scale = 10.0_f64.powf(random.within(-9.0, 9.0));
        let flat = 10.0_f64.powf(random.within(-6.0, 0.0));
        let shift = random.vector::<D>(1e3);
        let node = |offset: [usize; D]| {
            let mut offset = offset;
            if seed % KINDS == 2 && offset[1] == 1 {
                // A wedge, a triangle.
                offset[0] = 0;
            }
            let place = C::OFFSETS.iter().position(|o| *o == offset).expect("an offset");
            let mut x = cell.nodes()[place];
            match seed % KINDS {
                3 => x[D - 1] *= flat,
                4 => x *= scale,
                5 => x += shift,
                _ => {}
            }
            x
        };
        let cell = C::from_corners(node);
        if !cell.defects().iter().any(|defect| defect.is_error()) {
            return cell;
        }
    }
}

/// Heights of the lowest and the highest node.
pub(crate) fn range<const D: usize>(nodes: &[Vector<D>], normal: &Vector<D>) -> (f64, f64) {
    let heights = nodes.iter().map(|x| normal.dot(x));
    heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)))
}

/// The plane at the given part of the height of the nodes.
pub(crate) fn at<const D: usize>(nodes: &[Vector<D>], normal: Vector<D>, part: f64) -> HalfSpace<D> {
    let (low, high) = range(nodes, &normal);
    HalfSpace { normal, constant: low + part * (high - low) }
}

/// Largest and root mean square of errors.
#[derive(Default)]
pub(crate) struct Errors {
    pub(crate) largest: f64,
    squares: f64,
    pub(crate) count: usize,
}

impl Errors {
    pub(crate) fn add(&mut self, error: f64) {
        // Keeps a NaN, which no bound then lets pass.
        self.largest = if error <= self.largest { self.largest } else { error };
        self.squares += error * error;
        self.count += 1;
    }

    pub(crate) fn rms(&self) -> f64 {
        (self.squares / self.count as f64).sqrt()
    }
}

impl std::fmt::Display for Errors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "largest {:.1e}, rms {:.1e} of {}", self.largest, self.rms(), self.count)
    }
}
