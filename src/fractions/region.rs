//! Shapes taken apart: surfaces with an inside, and the logic that joins them.

use std::sync::Arc;

use nalgebra::{SMatrix, SVector};
use vofkit_geometry::{HalfSpace, Vector};

use crate::shape::{Body, Shape};

/// A surface whose inside is `y_0 <= 0` (plane) or `|y| <= 1` (curved) in its own frame `y = map (x - point)`, or a body.
///
/// Balls, ellipsoids and infinite cylinders are curved surfaces, with a map of rank `D` or `D - 1`. The frame of a body is of no use.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Surface<const D: usize> {
    pub(super) curved: bool,
    map: SMatrix<f64, D, D>,
    point: Vector<D>,
    /// The largest stretch of the map.
    stretch: f64,
    body: Option<Arc<Body<D>>>,
}

impl<const D: usize> Surface<D> {
    /// The body, if the surface is that of one.
    pub(super) fn body(&self) -> Option<&Body<D>> {
        self.body.as_deref()
    }

    /// The half-space whose plane touches the surface next to `x = anchor + local`, with `anchor` as the origin: exact for a plane, and
    /// for a curved surface up to the square of the distance in its frame.
    pub(super) fn tangent(&self, anchor: &Vector<D>, local: &Vector<D>) -> HalfSpace<D> {
        let y = self.frame(anchor, local);
        let (height, slope) = match self.curved {
            true => (0.5 * (y.norm_squared() - 1.0), self.map.transpose() * y),
            false => (y[0], self.map.row(0).transpose().into_owned()),
        };
        HalfSpace { normal: slope, constant: slope.dot(local) - height }
    }

    /// The surface's own coordinates of `x = anchor + local`.
    pub(super) fn frame(&self, anchor: &Vector<D>, local: &Vector<D>) -> Vector<D> {
        self.map * (local + (anchor - self.point))
    }

    /// Whether the ball around `x` is all inside or all outside; none where the surface may cross it.
    pub(super) fn side(&self, anchor: &Vector<D>, local: &Vector<D>, radius: f64) -> Option<bool> {
        if let Some(body) = &self.body {
            let x = anchor + local;
            let around = Vector::repeat(radius);
            return body.is_clear([x - around, x + around]).then(|| body.contains(&x));
        }
        let y = self.frame(anchor, local);
        let height = if self.curved { y.norm() - 1.0 } else { y[0] };
        let reach = self.stretch * radius;
        (height.abs() > reach).then_some(height < 0.0)
    }

    fn plane(half_space: &HalfSpace<D>) -> Self {
        let scale = half_space.normal.amax();
        let scaled = half_space.normal / scale;
        let length = scaled.norm();
        let normal = scaled / length;
        let mut map = SMatrix::<f64, D, D>::zeros();
        map.set_row(0, &normal.transpose());
        Self {
            curved: false,
            map,
            point: normal * (half_space.constant / scale / length),
            stretch: 1.0,
            body: None,
        }
    }

    fn curved(map: SMatrix<f64, D, D>, point: Vector<D>, stretch: f64) -> Self {
        Self { curved: true, map, point, stretch, body: None }
    }
}

/// How surfaces make up a shape.
#[derive(Clone, Debug)]
enum Logic {
    Inside(usize),
    Any(Vec<Logic>),
    All(Vec<Logic>),
    Not(Box<Logic>),
}

/// A shape as surfaces and logic.
#[derive(Clone, Debug)]
pub(super) struct Region<const D: usize> {
    pub(super) surfaces: Vec<Surface<D>>,
    logic: Logic,
}

impl<const D: usize> Region<D> {
    /// The points of `shape` that belong to none of the `earlier` shapes.
    pub(super) fn new<'a>(shape: &Shape<D>, earlier: impl IntoIterator<Item = &'a Shape<D>>) -> Self {
        let mut surfaces = Vec::new();
        let logic = build(&mut surfaces, shape);
        let mut earlier = earlier.into_iter().peekable();
        let logic = match earlier.peek() {
            Some(_) => without(&mut surfaces, logic, earlier),
            None => logic,
        };
        Self { surfaces, logic }
    }

    /// Whether all is inside or all outside, given the sides that are known of the surfaces.
    pub(super) fn decide(&self, side: &impl Fn(usize) -> Option<bool>) -> Option<bool> {
        self.logic.decide(side)
    }

    /// What is left of the region where the sides of some surfaces are known, or whether all is inside or all outside.
    pub(super) fn near(&self, side: &impl Fn(usize) -> Option<bool>) -> Result<Self, bool> {
        let mut open = Vec::new();
        let logic = self.logic.near(side, &mut open)?;
        Ok(Self { surfaces: open.into_iter().map(|surface| self.surfaces[surface].clone()).collect(), logic })
    }

    /// Whether it has bodies given by their surfaces.
    pub(super) fn has_bodies(&self) -> bool {
        self.surfaces.iter().any(|surface| surface.body.is_some())
    }

    /// The surfaces whose side is not known and matters.
    pub(super) fn open(&self, sides: &[Option<bool>]) -> Vec<usize> {
        let mut open = Vec::new();
        self.logic.open(sides, &mut open);
        open.sort_unstable();
        open.dedup();
        open
    }
}

impl Logic {
    fn decide(&self, side: &impl Fn(usize) -> Option<bool>) -> Option<bool> {
        // A part with the `deciding` answer decides; without one, all parts must have the other.
        let decide_by = |parts: &[Self], deciding: bool| {
            let mut open = false;
            for part in parts {
                match part.decide(side) {
                    Some(answer) if answer == deciding => return Some(deciding),
                    Some(_) => {}
                    None => open = true,
                }
            }
            (!open).then_some(!deciding)
        };
        match self {
            Self::Inside(surface) => side(*surface),
            Self::Any(parts) => decide_by(parts, true),
            Self::All(parts) => decide_by(parts, false),
            Self::Not(part) => part.decide(side).map(|answer| !answer),
        }
    }

    /// What is left where sides are known, or the answer; `open` are the surfaces that are left, by their new numbers.
    fn near(&self, side: &impl Fn(usize) -> Option<bool>, open: &mut Vec<usize>) -> Result<Self, bool> {
        // As in `decide`; parts with the other answer are left out.
        let mut undecided = |parts: &[Self], deciding: bool| {
            let mut left = Vec::new();
            for part in parts {
                match part.near(side, open) {
                    Ok(part) => left.push(part),
                    Err(answer) if answer == deciding => return Err(deciding),
                    Err(_) => {}
                }
            }
            if left.is_empty() { Err(!deciding) } else { Ok(left) }
        };
        match self {
            Self::Inside(surface) => match side(*surface) {
                Some(answer) => Err(answer),
                None => {
                    let known = open.iter().position(|other| other == surface);
                    open.extend(known.is_none().then_some(*surface));
                    Ok(Self::Inside(known.unwrap_or(open.len() - 1)))
                }
            },
            Self::Any(parts) => undecided(parts, true).map(Self::Any),
            Self::All(parts) => undecided(parts, false).map(Self::All),
            Self::Not(part) => match part.near(side, open) {
                Ok(part) => Ok(Self::Not(Box::new(part))),
                Err(answer) => Err(!answer),
            },
        }
    }

    fn open(&self, sides: &[Option<bool>], found: &mut Vec<usize>) {
        if self.decide(&|i| sides[i]).is_some() {
            return;
        }
        match self {
            Self::Inside(surface) => found.push(*surface),
            Self::Any(parts) | Self::All(parts) => parts.iter().for_each(|part| part.open(sides, found)),
            Self::Not(part) => part.open(sides, found),
        }
    }
}

/// The inside of a surface; equal surfaces are kept once.
fn inside<const D: usize>(surfaces: &mut Vec<Surface<D>>, surface: Surface<D>) -> Logic {
    let known = surfaces.iter().position(|s| *s == surface);
    Logic::Inside(known.unwrap_or_else(|| {
        surfaces.push(surface);
        surfaces.len() - 1
    }))
}

fn build<const D: usize>(surfaces: &mut Vec<Surface<D>>, shape: &Shape<D>) -> Logic {
    match shape {
        Shape::Sphere { centre, radius } => {
            let stretch = radius.recip();
            inside(surfaces, Surface::curved(SMatrix::identity() * stretch, *centre, stretch))
        }
        Shape::Ellipsoid { centre, semi_axes, rotation } => {
            let inverse = semi_axes.map(f64::recip);
            let map = SMatrix::from_diagonal(&inverse) * rotation.matrix().transpose();
            inside(surfaces, Surface::curved(map, *centre, inverse.max()))
        }
        Shape::Box { centre, lengths, rotation } => {
            let sides = (0..D).flat_map(|axis| {
                let normal: Vector<D> = rotation.matrix().column(axis).into_owned();
                slab(centre, &normal, 0.5 * lengths[axis])
            });
            Logic::All(sides.map(|surface| inside(surfaces, surface)).collect())
        }
        Shape::HalfSpace(half_space) => inside(surfaces, Surface::plane(half_space)),
        Shape::Cylinder { point, axis, radius, length } => {
            let scaled = axis / axis.amax();
            let axis = scaled / scaled.norm();
            let stretch = radius.recip();
            let across: SMatrix<f64, D, D> = SMatrix::identity() - axis * axis.transpose();
            let mut parts = vec![inside(surfaces, Surface::curved(across * stretch, *point, stretch))];
            if let Some(length) = length {
                parts.extend(slab(point, &axis, 0.5 * length).map(|surface| inside(surfaces, surface)));
            }
            Logic::All(parts)
        }
        Shape::SlottedDisc { centre, radius, slot_width, bridge, rotation } => {
            let [across, up] =
                [0, 1].map(|k| -> SVector<f64, D> { rotation.matrix().column(k).into_owned() });
            let disc = build(surfaces, &Shape::Sphere { centre: *centre, radius: *radius });
            let top = through(&(centre + up * (radius - bridge)), &up);
            let slot = slab(centre, &across, 0.5 * slot_width).into_iter().chain([top]);
            let slot = Logic::All(slot.map(|surface| inside(surfaces, surface)).collect());
            Logic::All(vec![disc, Logic::Not(Box::new(slot))])
        }
        Shape::Body(body) => {
            let nowhere = Surface::curved(SMatrix::zeros(), Vector::zeros(), 0.0);
            inside(surfaces, Surface { body: Some(body.clone()), ..nowhere })
        }
        Shape::Union(shapes) => Logic::Any(shapes.iter().map(|shape| build(surfaces, shape)).collect()),
        Shape::Intersection(shapes) => {
            Logic::All(shapes.iter().map(|shape| build(surfaces, shape)).collect())
        }
        Shape::Difference(shape, others) => {
            let logic = build(surfaces, shape);
            without(surfaces, logic, others)
        }
    }
}

fn without<'a, const D: usize>(
    surfaces: &mut Vec<Surface<D>>,
    logic: Logic,
    others: impl IntoIterator<Item = &'a Shape<D>>,
) -> Logic {
    let others = others.into_iter().map(|shape| build(surfaces, shape)).collect();
    Logic::All(vec![logic, Logic::Not(Box::new(Logic::Any(others)))])
}

/// The plane through a point, kept by that very point so that no digits go to a distance from the origin.
fn through<const D: usize>(point: &Vector<D>, normal: &Vector<D>) -> Surface<D> {
    let surface = Surface::plane(&HalfSpace { normal: *normal, constant: 0.0 });
    Surface { point: *point, ..surface }
}

/// The two planes at a distance `half` from a point.
fn slab<const D: usize>(point: &Vector<D>, normal: &Vector<D>, half: f64) -> [Surface<D>; 2] {
    [1.0, -1.0].map(|sign| through(&(point + normal * (sign * half)), &(normal * sign)))
}
