//! What is wrong with a shape.

use vofkit_geometry::Vector;

use super::Shape;

/// Why a shape cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShapeError {
    /// A coordinate, an angle or a rotation's axis that is not a finite number.
    #[error("the {what} of the {shape} is not finite")]
    NotFinite {
        /// The shape.
        shape: &'static str,
        /// Which of its values.
        what: &'static str,
    },
    /// A length that is not a positive number.
    #[error("the {what} of the {shape} is {value}, not a positive length")]
    NotPositive {
        /// The shape.
        shape: &'static str,
        /// Which of its values.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// A normal or an axis of zero length.
    #[error("the {what} of the {shape} has zero length")]
    ZeroDirection {
        /// The shape.
        shape: &'static str,
        /// Which direction.
        what: &'static str,
    },
    /// A bridge that leaves no slot, or a slot as wide as the disc.
    #[error("the {what} of the slotted disc is {value}, not below its diameter {diameter}")]
    NoSlot {
        /// Which of its values.
        what: &'static str,
        /// The value.
        value: f64,
        /// Twice the radius.
        diameter: f64,
    },
    /// A union, an intersection or the subtracted part of a difference without shapes.
    #[error("the {shape} has no shapes")]
    Empty {
        /// The combination.
        shape: &'static str,
    },
}

impl<const D: usize> Shape<D> {
    /// Whether the shape is well defined.
    ///
    /// # Errors
    /// The first value that is not finite or not positive, the first direction of zero length, the first empty list.
    pub fn check(&self) -> Result<(), ShapeError> {
        match self {
            Self::Sphere { centre, radius } => {
                Named("sphere").finite("centre", centre)?;
                Named("sphere").positive("radius", *radius)
            }
            Self::Ellipsoid { centre, semi_axes, rotation } => {
                let named = Named("ellipsoid");
                named.finite("centre", centre)?;
                named.rotation(rotation.is_finite())?;
                semi_axes.iter().try_for_each(|&a| named.positive("semi-axis", a))
            }
            Self::Box { centre, lengths, rotation } => {
                let named = Named("box");
                named.finite("centre", centre)?;
                named.rotation(rotation.is_finite())?;
                lengths.iter().try_for_each(|&length| named.positive("length", length))
            }
            Self::HalfSpace(half_space) => {
                let named = Named("half-space");
                named.direction("normal", &half_space.normal)?;
                named.finite("constant", &Vector::<1>::new(half_space.constant))
            }
            Self::Cylinder { point, axis, radius, length } => {
                let named = Named("cylinder");
                named.finite("point", point)?;
                named.direction("axis", axis)?;
                named.positive("radius", *radius)?;
                length.map_or(Ok(()), |length| named.positive("length", length))
            }
            Self::SlottedDisc { centre, radius, slot_width, bridge, rotation } => {
                let named = Named("slotted disc");
                named.finite("centre", centre)?;
                named.rotation(rotation.is_finite())?;
                named.positive("radius", *radius)?;
                let diameter = 2.0 * radius;
                [("slot width", *slot_width), ("bridge", *bridge)].into_iter().try_for_each(
                    |(what, value)| {
                        named.positive(what, value)?;
                        if value < diameter {
                            Ok(())
                        } else {
                            Err(ShapeError::NoSlot { what, value, diameter })
                        }
                    },
                )
            }
            // Checked when it was made.
            Self::Body(_) => Ok(()),
            Self::Union(shapes) => Named("union").all(shapes),
            Self::Intersection(shapes) => Named("intersection").all(shapes),
            Self::Difference(shape, others) => {
                shape.check()?;
                Named("difference").all(others)
            }
        }
    }
}

/// The name of the shape whose values are checked.
#[derive(Clone, Copy)]
struct Named(&'static str);

impl Named {
    fn finite<const N: usize>(self, what: &'static str, value: &Vector<N>) -> Result<(), ShapeError> {
        let finite = value.iter().all(|c| c.is_finite());
        if finite { Ok(()) } else { Err(ShapeError::NotFinite { shape: self.0, what }) }
    }

    fn rotation(self, finite: bool) -> Result<(), ShapeError> {
        if finite { Ok(()) } else { Err(ShapeError::NotFinite { shape: self.0, what: "rotation" }) }
    }

    fn positive(self, what: &'static str, value: f64) -> Result<(), ShapeError> {
        if value > 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(ShapeError::NotPositive { shape: self.0, what, value })
        }
    }

    fn direction<const N: usize>(self, what: &'static str, value: &Vector<N>) -> Result<(), ShapeError> {
        self.finite(what, value)?;
        if value.amax() > 0.0 { Ok(()) } else { Err(ShapeError::ZeroDirection { shape: self.0, what }) }
    }

    fn all<const D: usize>(self, shapes: &[Shape<D>]) -> Result<(), ShapeError> {
        if shapes.is_empty() {
            return Err(ShapeError::Empty { shape: self.0 });
        }
        shapes.iter().try_for_each(Shape::check)
    }
}
