//! The ways to truncate a hexahedron, by name.

use crate::cell::{Cell, Truncation};
use crate::submesh::{self, Triangulation};
use crate::{HalfSpace, Hexahedron, kothe};

/// How a hexahedron is truncated. All but [`TruncationMethod::Exact`] are there to be compared with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TruncationMethod {
    /// Ruled faces, exact in every case: [`Cell::truncate`].
    #[default]
    Exact,
    /// Ruled faces by the paper's closed form and fall-back: [`kothe::truncate`].
    Kothe,
    /// Two triangles a face, the cheapest polyhedron: [`Triangulation::TwoPerFace`].
    Submesh2,
    /// Four triangles a face, which other codes use: [`Triangulation::FourPerFace`].
    Submesh4,
}

/// What a method says of a plane through a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodTruncation {
    /// Volume of the part of the cell inside the half-space.
    pub volume: f64,
    /// Area of the section for a unit normal; Kothe's formula has none.
    pub section_area: Option<f64>,
}

impl From<Truncation> for MethodTruncation {
    fn from(Truncation { volume, section_area }: Truncation) -> Self {
        Self { volume, section_area: Some(section_area) }
    }
}

impl TruncationMethod {
    /// All methods.
    pub const ALL: [Self; 4] = [Self::Exact, Self::Kothe, Self::Submesh2, Self::Submesh4];

    /// What the plane leaves of the cell.
    pub fn truncate(self, cell: &Hexahedron, half_space: &HalfSpace<3>) -> MethodTruncation {
        match self {
            Self::Exact => cell.truncate(half_space).into(),
            Self::Kothe => {
                let volume = kothe::truncate(cell, half_space).volume;
                MethodTruncation { volume, section_area: None }
            }
            Self::Submesh2 => submesh::truncate(cell, half_space, Triangulation::TwoPerFace).into(),
            Self::Submesh4 => submesh::truncate(cell, half_space, Triangulation::FourPerFace).into(),
        }
    }

    /// The volume of the whole cell as the method sees it: that of the ruled cell, but for
    /// [`TruncationMethod::Submesh2`].
    pub fn cell_volume(self, cell: &Hexahedron) -> f64 {
        match self {
            Self::Exact | Self::Kothe => cell.volume(),
            Self::Submesh2 => submesh::volume(cell, Triangulation::TwoPerFace),
            Self::Submesh4 => submesh::volume(cell, Triangulation::FourPerFace),
        }
    }
}
