//! A case, what is found about it, and where cases come from.

use std::fmt::Write;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::Serialize;
use vofkit_geometry::Vector;

use super::oracle;

/// What is judged.
#[derive(Clone, Debug)]
pub enum Input {
    /// A hexahedron, a normal, and a plane constant relative to the first node or a fraction.
    Cell(Box<Row>),
    /// A scene.
    Scene(String),
    /// A number, and what it stands for.
    Number(f64, fn(f64) -> Vec<CaseFile>),
}

/// A file of a case, as `vofkit kernel`, `vofkit run` and `vofkit reconstruct` take it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CaseFile {
    /// What its name ends with.
    pub extension: &'static str,
    /// What is in it.
    pub text: String,
}

impl CaseFile {
    /// A table for `vofkit kernel`.
    pub(super) fn table(text: String) -> Self {
        Self { extension: "csv", text }
    }

    /// A scene.
    pub(super) fn scene(text: String) -> Self {
        Self { extension: "toml", text }
    }

    /// A grid that a scene names.
    pub(super) fn grid(text: String) -> Self {
        Self { extension: "vts", text }
    }
}

/// A line of a table for `vofkit kernel`.
#[derive(Clone, Debug)]
pub struct Row {
    /// Nodes.
    pub nodes: [Vector<3>; 8],
    /// Normal.
    pub normal: Vector<3>,
    /// The plane or the fraction.
    pub given: Given,
}

/// What a line says of the plane.
#[derive(Clone, Copy, Debug)]
pub enum Given {
    /// The plane constant.
    Constant(f64),
    /// The plane constant relative to the first node.
    Local(f64),
    /// The fraction below the plane.
    Fraction(f64),
}

impl Input {
    /// The case as the command line takes it.
    pub fn files(&self) -> Vec<CaseFile> {
        match self {
            Self::Cell(row) => vec![CaseFile::table(row.text())],
            Self::Scene(text) => vec![CaseFile::scene(text.clone())],
            Self::Number(number, files) => files(*number),
        }
    }
}

impl Row {
    /// A header and a line, with exact results where they are looked for.
    pub(super) fn text(&self) -> String {
        let mut header: Vec<String> =
            (0..8).flat_map(|node| ["x", "y", "z"].map(|axis| format!("{axis}{node}"))).collect();
        header.extend(["nx", "ny", "nz"].map(str::to_owned));
        let (name, number) = match self.given {
            Given::Constant(constant) => ("d", constant),
            Given::Local(constant) => ("local_constant", constant),
            Given::Fraction(fraction) => ("f", fraction),
        };
        let mut line = String::new();
        for value in self.nodes.iter().chain([&self.normal]).flat_map(|vector| vector.iter()) {
            // Writing to a string cannot fail.
            let _ = write!(line, "{value:?},");
        }
        header.push(name.to_owned());
        line.push_str(&format!("{number:?}"));
        if let Given::Constant(constant) = self.given {
            let exact = oracle::truncate(&self.nodes, &self.normal, constant);
            header.extend(["cell_volume", "truncated_volume", "section_area"].map(str::to_owned));
            for value in [exact.cell_volume, exact.truncated_volume, exact.section_area] {
                line.push_str(&format!(",{value:?}"));
            }
        }
        format!("{}\n{line}\n", header.join(","))
    }
}

/// How a case came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// What was wrong, relative to what is allowed: at most 1 where it holds.
    pub badness: f64,
    /// What was found.
    pub found: String,
}

impl Verdict {
    /// An error with what is allowed of it.
    pub fn of(error: f64, allowed: f64, found: impl Into<String>) -> Self {
        Self { badness: if error == 0.0 { 0.0 } else { error / allowed }, found: found.into() }
    }

    /// Nothing to find fault with.
    pub fn good(found: impl Into<String>) -> Self {
        Self { badness: 0.0, found: found.into() }
    }

    /// Something that must never be.
    pub fn broken(found: impl Into<String>) -> Self {
        Self { badness: f64::INFINITY, found: found.into() }
    }

    /// Whether it holds; what is not a number does not.
    pub fn holds(&self) -> bool {
        self.badness <= 1.0
    }

    /// The badness, with what is not a number above all.
    pub(super) fn rank(&self) -> f64 {
        if self.badness.is_nan() { f64::INFINITY } else { self.badness }
    }

    /// The worse one of two.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        if other.rank() > self.rank() { other } else { self }
    }
}

/// Numbers that depend on the seed, the family and the place of the case alone.
#[derive(Clone, Debug)]
pub struct Random(ChaCha8Rng);

impl Random {
    pub(super) fn new(seed: u64, family: &str, number: usize) -> Self {
        // FNV-1a (Fowler, Noll & Vo 1991) tells the families apart.
        let hash = family.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        let mut random = ChaCha8Rng::seed_from_u64(seed ^ hash);
        random.set_stream(number as u64);
        Self(random)
    }

    /// Uniform in `[low, high)`.
    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    /// One of `0..count`.
    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }

    /// One of some values.
    pub(super) fn one_of<T: Copy>(&mut self, values: &[T]) -> T {
        values[self.below(values.len())]
    }

    /// Uniform in a cube around the origin.
    pub(super) fn vector(&mut self, size: f64) -> Vector<3> {
        Vector::<3>::from_fn(|_, _| self.within(-size, size))
    }

    /// A direction.
    pub(super) fn unit(&mut self) -> Vector<3> {
        loop {
            let vector = self.vector(1.0);
            if (0.01..=1.0).contains(&vector.norm_squared()) {
                return vector.normalize();
            }
        }
    }
}
