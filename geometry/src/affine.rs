//! A parallelogram or parallelepiped along one normal: a unit square or cube in its frame, and everything in closed form.

use crate::frame::Direction;
use crate::parallelepiped::UnitCube;
use crate::plane_constant::Monotone;
use crate::root::Value;

/// The unit square or cube in a frame, along one direction.
pub(crate) struct Affine<const D: usize> {
    pub(crate) direction: Direction<D>,
    cube: UnitCube,
    /// `m.y` of the lowest corner.
    pub(crate) low: f64,
}

impl<const D: usize> Affine<D> {
    #[inline(always)]
    pub(crate) fn new(direction: Direction<D>) -> Self {
        let low = direction.m.iter().fold(0.0, |low, m| low + m.min(0.0));
        Self { cube: UnitCube::new(direction.m.as_slice()), low, direction }
    }

    /// The depth of a plane over the lowest corner.
    #[inline(always)]
    pub(crate) fn depth(&self, constant: f64) -> f64 {
        self.direction.level(constant) - self.low
    }
}

impl<const D: usize> Monotone for Affine<D> {
    fn span(&self) -> f64 {
        self.cube.span()
    }

    fn total(&self) -> f64 {
        1.0
    }

    #[inline(always)]
    fn volume(&mut self, depth: f64) -> Value {
        self.cube.volume(depth)
    }

    fn start(&self, fraction: f64) -> f64 {
        self.cube.position(fraction)
    }

    fn closed_form(&mut self, fraction: f64) -> Option<(f64, usize)> {
        Some((self.cube.position(fraction), 0))
    }
}
