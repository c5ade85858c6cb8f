//! Volumes and bounding boxes of shapes, where they are closed forms.

use std::f64::consts::PI;

use vofkit_geometry::Vector;

use super::Shape;

/// Volume of the unit ball: `pi` in two, `4 pi / 3` in three dimensions.
fn unit_ball(dimension: usize) -> f64 {
    if dimension == 2 { PI } else { 4.0 / 3.0 * PI }
}

impl<const D: usize> Shape<D> {
    /// The volume (2D: the area) of shapes for which it is a simple closed form: spheres, ellipsoids, boxes, finite
    /// cylinders, bodies in closed surfaces, and the slotted disc in 2D whose slot ends inside the disc,
    ///
    /// ```text
    /// pi r^2 - (r - bridge) w - (w/2) sqrt(r^2 - w^2/4) - r^2 asin(w / (2 r))
    /// ```
    pub fn volume(&self) -> Option<f64> {
        match self {
            Self::Sphere { radius, .. } => Some(unit_ball(D) * radius.powi(D as i32)),
            Self::Ellipsoid { semi_axes, .. } => Some(unit_ball(D) * semi_axes.product()),
            Self::Box { lengths, .. } => Some(lengths.product()),
            Self::Cylinder { radius, length, .. } => {
                let section = if D == 2 { 2.0 * radius } else { PI * radius * radius };
                length.map(|length| section * length)
            }
            Self::SlottedDisc { radius: r, slot_width: w, bridge, .. } if D == 2 => {
                let (top, shoulder) = (r - bridge, (r * r - 0.25 * w * w).sqrt());
                (top.abs() <= shoulder)
                    .then(|| PI * r * r - top * w - 0.5 * w * shoulder - r * r * (0.5 * w / r).asin())
            }
            Self::Body(body) => Some(body.volume()),
            _ => None,
        }
    }

    /// The lower and upper corner of a box that holds the shape, as tight as its parts allow; none where the shape is
    /// unbounded.
    pub fn bounding_box(&self) -> Option<[Vector<D>; 2]> {
        let around = |centre: &Vector<D>, half: Vector<D>| Some([centre - half, centre + half]);
        match self {
            Self::Sphere { centre, radius } | Self::SlottedDisc { centre, radius, .. } => {
                around(centre, Vector::repeat(*radius))
            }
            Self::Ellipsoid { centre, semi_axes, rotation } => {
                let r = rotation.matrix();
                around(centre, Vector::from_fn(|i, _| r.row(i).transpose().component_mul(semi_axes).norm()))
            }
            Self::Box { centre, lengths, rotation } => {
                around(centre, rotation.matrix().abs() * lengths * 0.5)
            }
            Self::HalfSpace(_) | Self::Cylinder { length: None, .. } => None,
            Self::Cylinder { point, axis, radius, length: Some(length) } => {
                let axis = axis / axis.norm();
                let half = axis.map(|a| 0.5 * length * a.abs() + radius * (1.0 - a * a).max(0.0).sqrt());
                around(point, half)
            }
            Self::Body(body) => Some(body.bounding_box()),
            Self::Union(shapes) => {
                let boxes = shapes.iter().map(Self::bounding_box);
                boxes.reduce(|a, b| a.zip(b).map(|([a, b], [c, d])| [a.inf(&c), b.sup(&d)]))?
            }
            Self::Intersection(shapes) => {
                let boxes = shapes.iter().filter_map(Self::bounding_box);
                boxes.reduce(|[a, b], [c, d]| {
                    let lower = a.sup(&c);
                    [lower, b.inf(&d).sup(&lower)]
                })
            }
            Self::Difference(shape, _) => shape.bounding_box(),
        }
    }
}
