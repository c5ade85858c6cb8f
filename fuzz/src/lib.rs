//! Inputs of the fuzz targets: any bytes become finite nodes, a normal and numbers.
//!
//! A failing input prints as Rust source, to be pasted into a test of the kernel under a name of its own.

use arbitrary::{Arbitrary, Result, Unstructured};
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
