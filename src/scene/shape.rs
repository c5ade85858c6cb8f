//! Shapes as scene files write them.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use toml::Spanned;
use vofkit_geometry::{HalfSpace, Vector};

use super::context::{Context, Numbers};
use super::error::SceneError;
use crate::body_file;
use crate::shape::{Rotation, Shape};

#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum ShapeChoice {
    #[serde(alias = "disc")]
    Sphere {
        centre: Numbers,
        radius: f64,
    },
    #[serde(alias = "ellipse")]
    Ellipsoid {
        centre: Numbers,
        semi_axes: Numbers,
        #[serde(skip_serializing_if = "Option::is_none")]
        angle: Option<Spanned<f64>>,
        #[serde(skip_serializing_if = "Option::is_none")]
        axis: Option<Numbers>,
    },
    #[serde(alias = "rectangle")]
    Box {
        centre: Numbers,
        lengths: Numbers,
        #[serde(skip_serializing_if = "Option::is_none")]
        angle: Option<Spanned<f64>>,
        #[serde(skip_serializing_if = "Option::is_none")]
        axis: Option<Numbers>,
    },
    HalfSpace {
        normal: Numbers,
        constant: f64,
    },
    Cylinder {
        point: Numbers,
        axis: Numbers,
        radius: f64,
        #[serde(skip_serializing_if = "Option::is_none")]
        length: Option<f64>,
    },
    SlottedDisc {
        centre: Numbers,
        radius: f64,
        slot_width: f64,
        bridge: f64,
        #[serde(skip_serializing_if = "Option::is_none")]
        angle: Option<Spanned<f64>>,
    },
    Body {
        file: Spanned<String>,
        #[serde(skip_serializing_if = "Option::is_none")]
        scale: Option<Spanned<f64>>,
        #[serde(skip_serializing_if = "Option::is_none")]
        angle: Option<Spanned<f64>>,
        #[serde(skip_serializing_if = "Option::is_none")]
        axis: Option<Numbers>,
        #[serde(skip_serializing_if = "Option::is_none")]
        translation: Option<Numbers>,
    },
    Union(Vec<Spanned<ShapeChoice>>),
    Intersection(Vec<Spanned<ShapeChoice>>),
    Difference(Vec<Spanned<ShapeChoice>>),
}

/// The shape of the toolkit, checked.
pub(super) fn resolve<const D: usize>(
    shape: &Spanned<ShapeChoice>,
    context: Context<'_>,
) -> Result<Shape<D>, SceneError> {
    let all = |shapes: &[Spanned<ShapeChoice>]| -> Result<Vec<Shape<D>>, SceneError> {
        shapes.iter().map(|shape| resolve(shape, context)).collect()
    };
    let resolved = match shape.get_ref() {
        ShapeChoice::Sphere { centre, radius } => {
            Shape::Sphere { centre: context.vector("the centre of the sphere", centre)?, radius: *radius }
        }
        ShapeChoice::Ellipsoid { centre, semi_axes, angle, axis } => Shape::Ellipsoid {
            centre: context.vector("the centre of the ellipsoid", centre)?,
            semi_axes: context.vector("semi_axes of the ellipsoid", semi_axes)?,
            rotation: rotation(angle.as_ref(), axis.as_ref(), context)?,
        },
        ShapeChoice::Box { centre, lengths, angle, axis } => Shape::Box {
            centre: context.vector("the centre of the box", centre)?,
            lengths: context.vector("lengths of the box", lengths)?,
            rotation: rotation(angle.as_ref(), axis.as_ref(), context)?,
        },
        ShapeChoice::HalfSpace { normal, constant } => {
            let normal: Vector<D> = context.vector("the normal of the half-space", normal)?;
            // A unit normal: the constant is in the normal's own length.
            let length = normal.norm();
            let scale = if length > 0.0 { length } else { 1.0 };
            Shape::HalfSpace(HalfSpace { normal: normal / scale, constant: constant / scale })
        }
        ShapeChoice::Cylinder { point, axis, radius, length } => Shape::Cylinder {
            point: context.vector("the point of the cylinder", point)?,
            axis: context.vector("the axis of the cylinder", axis)?,
            radius: *radius,
            length: *length,
        },
        ShapeChoice::SlottedDisc { centre, radius, slot_width, bridge, angle } => Shape::SlottedDisc {
            centre: context.vector("the centre of the slotted disc", centre)?,
            radius: *radius,
            slot_width: *slot_width,
            bridge: *bridge,
            rotation: rotation(angle.as_ref(), None, context)?,
        },
        ShapeChoice::Body { file, scale, angle, axis, translation } => {
            let scale =
                scale.as_ref().map_or(Ok(1.0), |scale| context.positive("the scale of the body", scale))?;
            let rotation = rotation(angle.as_ref(), axis.as_ref(), context)?;
            let shift = translation
                .as_ref()
                .map_or(Ok(Vector::zeros()), |shift| context.vector("the translation of the body", shift))?;
            let path = context.source.beside(file.get_ref());
            let body = body_file::read::<D>(&path)
                .map_err(|error| context.error(file.span(), error.to_string(), error.help()))?;
            Shape::Body(Arc::new(body.placed(scale, &rotation, &shift)))
        }
        ShapeChoice::Union(shapes) => Shape::Union(all(shapes)?),
        ShapeChoice::Intersection(shapes) => Shape::Intersection(all(shapes)?),
        ShapeChoice::Difference(shapes) => match shapes.as_slice() {
            [first, others @ ..] if !others.is_empty() => {
                Shape::Difference(Box::new(resolve(first, context)?), all(others)?)
            }
            _ => {
                return Err(context.error(
                    shape.span(),
                    format!("the difference is a list of {}", shapes.len()),
                    "give a first shape and at least one that is taken away from it",
                ));
            }
        },
    };
    resolved.check().map_err(|error| context.error(shape.span(), error.to_string(), help(&error)))?;
    Ok(resolved)
}

fn help(error: &crate::shape::ShapeError) -> &'static str {
    use crate::shape::ShapeError as E;
    match error {
        E::NotFinite { .. } => "give finite numbers",
        E::NotPositive { .. } => "give a length above 0",
        E::ZeroDirection { .. } => "give a direction in which at least one number is not 0",
        E::NoSlot { .. } => "make it smaller than twice the radius",
        E::Empty { .. } => "list at least one shape",
    }
}

/// The rotation by an angle in radians about an axis; the z axis by default, and the only one in two dimensions.
fn rotation<const D: usize>(
    angle: Option<&Spanned<f64>>,
    axis: Option<&Numbers>,
    context: Context<'_>,
) -> Result<Rotation<D>, SceneError> {
    let Some(angle) = angle else {
        return match axis {
            None => Ok(Rotation::identity()),
            Some(axis) => Err(context.error(
                axis.span(),
                "there is an axis but no angle",
                "give the angle in radians too",
            )),
        };
    };
    let angle = context.finite("the angle", angle)?;
    let Some(axis) = axis else { return Ok(Rotation::from_angle(angle)) };
    Ok(Rotation::from_axis_angle(super::context::axis::<D>(axis, context)?, angle))
}
