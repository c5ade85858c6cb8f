//! A parallelogram or parallelepiped along one normal: a unit square or cube in its frame, and everything in closed form.

use crate::cell::Truncation;
use crate::frame::{Direction, Frame};
use crate::parallelepiped::UnitCube;
use crate::plane_constant::{self, Monotone, PlaneConstant, PositionError, PositionMethod};
use crate::root::Value;
use crate::simd::{self, either};
use crate::{HalfSpace, Vector};

/// What a plane leaves of the parallelepiped with this frame and first node.
pub(crate) fn truncate<const D: usize>(
    frame: &Frame<D>,
    x0: &Vector<D>,
    half_space: &HalfSpace<D>,
) -> Truncation {
    simd::widest(
        #[inline(always)]
        || {
            let mut along = Affine::new(frame.along(&half_space.normal, x0, &Vector::zeros()));
            let part = along.volume(along.depth(half_space.constant));
            frame.truncation(part, &along.direction)
        },
    )
}

/// The plane constant for `fraction <= 1/2` of it along `sign` times the normal.
pub(crate) fn plane_constant<const D: usize>(
    frame: &Frame<D>,
    x0: &Vector<D>,
    normal: &Vector<D>,
    sign: f64,
    fraction: f64,
    method: PositionMethod,
) -> Result<PlaneConstant, PositionError> {
    simd::widest(
        #[inline(always)]
        || {
            let mut along = Affine::new(frame.along(&(normal * sign), x0, &Vector::zeros()));
            let found = plane_constant::find(&mut along, fraction, method)?;
            Ok(found.plane(&along.direction, along.low, sign))
        },
    )
}

/// The unit square or cube in a frame, along one direction.
struct Affine<const D: usize> {
    direction: Direction<D>,
    cube: UnitCube,
    /// `m.y` of the lowest corner.
    low: f64,
}

impl<const D: usize> Affine<D> {
    #[inline(always)]
    fn new(direction: Direction<D>) -> Self {
        let low = direction.m.iter().fold(0.0, |low, &m| low + either(m < 0.0, m, 0.0));
        Self { cube: UnitCube::new(direction.m.as_slice()), low, direction }
    }

    /// The depth of a plane over the lowest corner.
    #[inline(always)]
    fn depth(&self, constant: f64) -> f64 {
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

    #[inline(always)]
    fn start(&self, fraction: f64) -> f64 {
        self.cube.position(fraction)
    }

    #[inline(always)]
    fn closed_form(&mut self, fraction: f64) -> Option<(f64, usize)> {
        Some((self.cube.position(fraction), 0))
    }
}
