//! Shapes that initialise a material: primitives and their unions, intersections and differences.
//!
//! This file holds the shapes and how they move; [`rotation`] the rotations, [`check`] what is wrong with a shape,
//! [`body`] bodies given by their surfaces, [`extent`] volumes and bounding boxes in closed form, `membership` which points a shape holds. [`crate::fractions`] turns shapes into volume fractions.

pub mod body;
pub mod check;
pub mod extent;
mod membership;
pub mod rotation;

use std::sync::Arc;

use vofkit_geometry::{HalfSpace, Vector};

pub use body::{Body, BodyDefect, BodyError, BodyNotice};
pub use check::ShapeError;
pub use rotation::Rotation;

/// A set of points, in two or in three dimensions.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape<const D: usize> {
    /// A ball (2D: a disc).
    Sphere {
        /// The centre.
        centre: Vector<D>,
        /// The radius.
        radius: f64,
    },
    /// An ellipsoid (2D: an ellipse).
    Ellipsoid {
        /// The centre.
        centre: Vector<D>,
        /// Half the length of each axis.
        semi_axes: Vector<D>,
        /// Turns the coordinate axes into the axes of the ellipsoid.
        rotation: Rotation<D>,
    },
    /// A box (2D: a rectangle).
    Box {
        /// The centre.
        centre: Vector<D>,
        /// The full length along each axis.
        lengths: Vector<D>,
        /// Turns the coordinate axes into the axes of the box.
        rotation: Rotation<D>,
    },
    /// A half-space (2D: a half-plane).
    HalfSpace(HalfSpace<D>),
    /// A circular cylinder (2D: the strip of all points nearer than `radius` to a line).
    Cylinder {
        /// A point of the axis; the middle of a cylinder with a length.
        point: Vector<D>,
        /// The direction of the axis, of any length.
        axis: Vector<D>,
        /// The radius.
        radius: f64,
        /// The length between the two flat ends; without it the cylinder is infinite.
        length: Option<f64>,
    },
    /// Zalesak's disc (3D: ball) with a slot, in Rudman's version:
    /// `{|y| <= radius} \ {|y_0| <= slot_width / 2 and y_1 <= radius - bridge}` with `x = centre + R y`.
    /// The slot opens downwards and runs through along the third axis.
    SlottedDisc {
        /// The centre of the disc.
        centre: Vector<D>,
        /// The radius.
        radius: f64,
        /// The width of the slot.
        slot_width: f64,
        /// The thickness of the material left above the slot.
        bridge: f64,
        /// Turns the disc with its slot, about its centre.
        rotation: Rotation<D>,
    },
    /// What a closed surface encloses.
    Body(Arc<Body<D>>),
    /// All points of any of the shapes.
    Union(Vec<Shape<D>>),
    /// The points that all the shapes have in common.
    Intersection(Vec<Shape<D>>),
    /// The points of the first shape that belong to none of the others.
    Difference(Box<Shape<D>>, Vec<Shape<D>>),
}

impl<const D: usize> Shape<D> {
    /// The bodies given by their surfaces among its parts.
    pub fn bodies(&self) -> Vec<&Body<D>> {
        match self {
            Self::Body(body) => vec![body],
            Self::Union(shapes) | Self::Intersection(shapes) => {
                shapes.iter().flat_map(Self::bodies).collect()
            }
            Self::Difference(shape, others) => {
                std::iter::once(&**shape).chain(others).flat_map(Self::bodies).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The shape after `x -> about + R (x - about) + shift`.
    #[must_use]
    pub fn moved(&self, rotation: &Rotation<D>, about: &Vector<D>, shift: &Vector<D>) -> Self {
        let place = |x: &Vector<D>| about + rotation.apply(&(x - about)) + shift;
        let all = |shapes: &[Self]| shapes.iter().map(|shape| shape.moved(rotation, about, shift)).collect();
        match self {
            Self::Sphere { centre, radius } => Self::Sphere { centre: place(centre), radius: *radius },
            Self::Ellipsoid { centre, semi_axes, rotation: own } => {
                Self::Ellipsoid { centre: place(centre), semi_axes: *semi_axes, rotation: own.then(rotation) }
            }
            Self::Box { centre, lengths, rotation: own } => {
                Self::Box { centre: place(centre), lengths: *lengths, rotation: own.then(rotation) }
            }
            Self::HalfSpace(HalfSpace { normal, constant }) => {
                let turned = rotation.apply(normal);
                // The height of `about` over the plane stays as it is.
                let constant = constant - normal.dot(about) + turned.dot(&(about + shift));
                Self::HalfSpace(HalfSpace { normal: turned, constant })
            }
            Self::Cylinder { point, axis, radius, length } => Self::Cylinder {
                point: place(point),
                axis: rotation.apply(axis),
                radius: *radius,
                length: *length,
            },
            Self::SlottedDisc { centre, radius, slot_width, bridge, rotation: own } => Self::SlottedDisc {
                centre: place(centre),
                radius: *radius,
                slot_width: *slot_width,
                bridge: *bridge,
                rotation: own.then(rotation),
            },
            Self::Body(body) => Self::Body(Arc::new(body.placed(1.0, rotation, &place(&Vector::zeros())))),
            Self::Union(shapes) => Self::Union(all(shapes)),
            Self::Intersection(shapes) => Self::Intersection(all(shapes)),
            Self::Difference(shape, others) => {
                Self::Difference(Box::new(shape.moved(rotation, about, shift)), all(others))
            }
        }
    }
}
