//! Inputs of the fuzz targets: any bytes become finite nodes, normals, numbers, meshes with what moves through them, or a file.
//!
//! A failing input prints as Rust source, to be pasted into a test of the kernel under a name of its own.

use std::path::{Path, PathBuf};
use std::{env, fs, process};

use arbitrary::{Arbitrary, Result, Unstructured};
use vofkit::normal::NormalMethod;
use vofkit::velocity::Field;
use vofkit_geometry::{Cell, Hexahedron, Vector};

/// Coordinates stay below this.
const LARGEST: f64 = 1e6;

/// A finite number: a small multiple of 1/8, so that nodes coincide and heights vanish, or anything up to [`LARGEST`].
fn number(u: &mut Unstructured<'_>) -> Result<f64> {
    let any = match u.int_in_range(0..=3)? {
        0 => f64::arbitrary(u)?,
        1 => return Ok(f64::from(i16::arbitrary(u)?) / 32768.0),
        _ => return Ok(f64::from(i8::arbitrary(u)?) / 8.0),
    };
    Ok(if any.is_finite() { any.clamp(-LARGEST, LARGEST) } else { 0.0 })
}

fn vector(u: &mut Unstructured<'_>) -> Result<Vector<3>> {
    Ok(Vector::<3>::new(number(u)?, number(u)?, number(u)?))
}

/// A cell and a plane.
#[derive(Clone, Debug)]
pub struct Input {
    /// Nodes: anything, or those of the unit cube moved a little.
    pub nodes: [Vector<3>; 8],
    /// Any finite normal; it may be zero.
    pub normal: Vector<3>,
    /// Any number; not finite ones only from targets that expect them.
    pub number: f64,
}

impl<'a> Arbitrary<'a> for Input {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let near_cube = u.ratio(1, 2)?;
        let mut nodes = [Vector::<3>::zeros(); 8];
        for (node, offset) in nodes.iter_mut().zip(Hexahedron::OFFSETS) {
            let corner = Vector::<3>::from_fn(|axis, _| offset[axis] as f64);
            *node = if near_cube {
                let mut shift = || Ok(0.3 * f64::from(i8::arbitrary(u)?) / 128.0);
                corner + Vector::<3>::new(shift()?, shift()?, shift()?)
            } else {
                vector(u)?
            };
        }
        let number = if u.ratio(1, 8)? { f64::arbitrary(u)? } else { number(u)? };
        Ok(Self { nodes, normal: vector(u)?, number })
    }
}

impl Input {
    /// The largest distance of two nodes along an axis.
    pub fn extent(&self) -> f64 {
        let [first, ..] = self.nodes;
        2.0 * self.nodes.iter().map(|x| (x - first).amax()).fold(0.0, f64::max)
    }

    /// The largest coordinate.
    pub fn distance(&self) -> f64 {
        self.nodes.iter().map(|x| x.amax()).fold(0.0, f64::max)
    }
}

/// A mesh, what it holds, and what moves it.
#[derive(Clone, Debug)]
pub struct StepInput {
    /// Whether there are three dimensions.
    pub is_solid: bool,
    /// Cells along each axis.
    pub cells: [usize; 3],
    /// How many materials.
    pub materials: usize,
    /// Of the step, relative to the scheme's limit.
    pub courant: f64,
    /// The normal method.
    pub normal: NormalMethod,
    field: u8,
    turn: f64,
    bytes: Vec<u8>,
}

impl<'a> Arbitrary<'a> for StepInput {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let methods =
            [NormalMethod::Youngs, NormalMethod::Lvira, NormalMethod::Swartz, NormalMethod::LeastSquares];
        Ok(Self {
            is_solid: u.ratio(1, 3)?,
            cells: [u.int_in_range(1..=4)?, u.int_in_range(1..=4)?, u.int_in_range(1..=3)?],
            materials: u.int_in_range(1..=3)?,
            courant: f64::from(u.int_in_range(1..=100_u8)?) / 100.0,
            normal: *u.choose(&methods)?,
            field: u.arbitrary()?,
            turn: f64::from(u.arbitrary::<i8>()?) / 16.0,
            bytes: u.arbitrary()?,
        })
    }
}

impl StepInput {
    fn byte(&self, place: usize) -> u8 {
        // What is missing is what was there, shifted.
        let count = self.bytes.len().max(1);
        self.bytes.get(place % count).map_or(0, |byte| byte.wrapping_add((place / count) as u8))
    }

    /// How far a node is from its place, in cells.
    pub fn shift(&self, place: usize) -> f64 {
        0.3 * f64::from(self.byte(place) as i8) / 128.0
    }

    /// The fraction of a material in a cell: often none or all, and together at most 1.
    pub fn fraction(&self, cell: usize, material: usize) -> f64 {
        let part = match self.byte(7 * cell + 3 * material + 1) {
            0..=60 => 0.0,
            byte @ 61..=200 => f64::from(byte - 60) / 141.0,
            201..=205 => 1e-15,
            206..=210 => 1e-300,
            211..=215 => 1.0 - 1e-15,
            _ => 1.0,
        };
        part / self.materials as f64
    }

    /// The velocity.
    pub fn field(&self, dimension: usize) -> Field {
        let turn = Vector::<3>::new(
            self.turn.cos(),
            self.turn.sin(),
            if dimension == 3 { self.turn / 4.0 } else { 0.0 },
        );
        match (self.field % 4, dimension) {
            (0, _) => Field::Uniform { velocity: turn },
            (1, 3) => Field::Deformation3d,
            (1, _) => Field::ReversedVortex,
            (2, _) => Field::Uniform { velocity: Vector::<3>::zeros() },
            _ => Field::RudmanShear,
        }
    }
}

/// A folder of this process for files to read.
#[derive(Debug)]
pub struct Folder(PathBuf);

impl Default for Folder {
    /// Makes it.
    ///
    /// # Panics
    /// If there is no room for temporary files.
    fn default() -> Self {
        let folder = env::temp_dir().join(format!("vofkit-fuzz-{}", process::id()));
        fs::create_dir_all(&folder).expect("a folder for files");
        Self(folder)
    }
}

impl Folder {
    /// The path of a file in it.
    pub fn join(&self, name: impl AsRef<Path>) -> PathBuf {
        self.0.join(name)
    }
}
