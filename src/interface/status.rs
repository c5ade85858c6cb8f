//! What a cell is to one material, in one word.

use super::Placed;
use crate::normal::NoNormal;

/// What a cell is to one material; the discriminants are the numbers in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum CellStatus {
    /// Nothing of the material is in it.
    Empty = 0,
    /// It holds nothing else.
    Full = 1,
    /// It is mixed and has a plane.
    Plane = 2,
    /// It is mixed and has a plane that the cells around do not determine.
    Undetermined = 3,
    /// It is mixed without a plane: [`NoNormal::Flat`].
    Flat = 4,
    /// It is mixed without a plane: [`NoNormal::Isolated`].
    Isolated = 5,
    /// It is mixed without a plane: [`NoNormal::Balanced`].
    Balanced = 6,
    /// It is mixed without a plane: [`NoNormal::NoCentroid`].
    NoCentroid = 7,
    /// It is mixed and shared with other materials, which are cut one after the other: [`Placed::Nested`].
    Nested = 8,
}

impl CellStatus {
    /// The status of a pure cell by its fraction.
    pub fn of_pure(fraction: f64) -> Self {
        if fraction > 0.0 { Self::Full } else { Self::Empty }
    }

    /// The number in files.
    pub fn code(self) -> i64 {
        self as i64
    }
}

impl<const D: usize> From<&Placed<D>> for CellStatus {
    fn from(placed: &Placed<D>) -> Self {
        match placed {
            Placed::Plane { determined: true, .. } => Self::Plane,
            Placed::Plane { determined: false, .. } => Self::Undetermined,
            Placed::NoNormal(NoNormal::Flat) => Self::Flat,
            Placed::NoNormal(NoNormal::Isolated) => Self::Isolated,
            Placed::NoNormal(NoNormal::Balanced) => Self::Balanced,
            Placed::NoNormal(NoNormal::NoCentroid) => Self::NoCentroid,
            Placed::Nested(_) => Self::Nested,
        }
    }
}
