//! Two-dimensional meshes lie in the plane z = 0 of space.

use vofkit_geometry::Vector;

/// The point of a mesh, or a direction in it, as one in space.
pub(crate) fn spatial<const D: usize>(x: &Vector<D>) -> Vector<3> {
    Vector::from_fn(|axis, _| if axis < D { x[axis] } else { 0.0 })
}

/// The first `D` components of a vector in space.
pub(crate) fn planar<const D: usize>(x: &Vector<3>) -> Vector<D> {
    Vector::from_fn(|axis, _| x[axis])
}
