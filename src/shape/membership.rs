//! Whether a point belongs to a shape.

use vofkit_geometry::Vector;

use super::Shape;

impl<const D: usize> Shape<D> {
    /// Whether the shape holds the point; its surface belongs to it, but for what a difference takes away.
    pub fn contains(&self, x: &Vector<D>) -> bool {
        match self {
            Self::Sphere { centre, radius } => (x - centre).norm() <= *radius,
            Self::Ellipsoid { centre, semi_axes, rotation } => {
                rotation.inverse().apply(&(x - centre)).component_div(semi_axes).norm() <= 1.0
            }
            Self::Box { centre, lengths, rotation } => {
                let y = rotation.inverse().apply(&(x - centre));
                (0..D).all(|k| y[k].abs() <= 0.5 * lengths[k])
            }
            Self::HalfSpace(half_space) => half_space.normal.dot(x) <= half_space.constant,
            Self::Cylinder { point, axis, radius, length } => {
                let direction = axis.normalize();
                let y = x - point;
                let along = y.dot(&direction);
                (y - direction * along).norm() <= *radius && length.is_none_or(|l| along.abs() <= 0.5 * l)
            }
            Self::SlottedDisc { centre, radius, slot_width, bridge, rotation } => {
                let y = rotation.inverse().apply(&(x - centre));
                let in_slot = y[0].abs() < 0.5 * slot_width && y[1] < radius - bridge;
                y.norm() <= *radius && !in_slot
            }
            Self::Body(body) => body.contains(x),
            Self::Union(shapes) => shapes.iter().any(|shape| shape.contains(x)),
            Self::Intersection(shapes) => shapes.iter().all(|shape| shape.contains(x)),
            Self::Difference(shape, others) => {
                shape.contains(x) && !others.iter().any(|other| other.contains(x))
            }
        }
    }
}
