//! A cell's own affine frame, and a normal in it.
//!
//! In `x = x0 + J (y - y0)`, with the mean edges of the cell as columns of `J` and the first node at `x0` and `y0`, a cell
//! is the unit square or cube plus dimensionless twists. The plane `n.x = d` becomes `m.y = level` with `m` along `J^T n`,
//! and volumes scale with `det J`.
//!
//! The condition of a frame is the sum of all elements of `|J^-1| |J|` (after Skeel 1979): what rounding of the edges,
//! component by component, may grow to in the frame. It is `D` for boxes of any aspect along the axes and about ten for
//! ordinary cells. Where it is large (slivers and needles that are rotated) the frame is computed with compensated arithmetic, and keeps what rounding
//! took from `J`.

use nalgebra::SMatrix;

use crate::Vector;
use crate::cell::Truncation;
use crate::compensated;
use crate::root::Value;
use crate::tolerance::{DIRECTION_NEGLIGIBLE, FRAME_CONDITION};

/// An affine frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<const D: usize> {
    /// The mean edges as columns: `J`.
    pub(crate) jacobian: SMatrix<f64, D, D>,
    /// What rounding took from `J`, where that matters.
    rest: Option<SMatrix<f64, D, D>>,
    /// `det J`.
    pub(crate) determinant: f64,
}

/// A normal in the frame of a cell, with what its plane constants need.
#[derive(Clone, Copy)]
pub(crate) struct Direction<const D: usize> {
    /// `J^T n / size`, with 1 or -1 as largest component.
    pub(crate) m: Vector<D>,
    /// The largest component of `J^T n`, the unit of levels.
    size: f64,
    /// The inverse of `size`: what a derivative by a level is to be multiplied by for one by a plane constant.
    pub(crate) per_size: f64,
    /// `n.x` of the first node, and what rounding took from it.
    base: [f64; 2],
    /// `m.y` of the first node.
    first: f64,
}

/// Whether a frame with these edges loses digits in plain arithmetic. `rows` are those of `det J J^-1`.
#[inline(always)]
pub(crate) fn is_ill_conditioned<const D: usize>(
    edges: &[Vector<D>; D],
    rows: &[Vector<D>; D],
    determinant: f64,
) -> bool {
    let sum = |vectors: &[Vector<D>; D]| vectors.iter().fold(Vector::<D>::zeros(), |sum, v| sum + v.abs());
    let allowed = FRAME_CONDITION * determinant.abs();
    // A determinant of zero, or one that is not finite, has no frame at all.
    allowed > 0.0 && sum(rows).dot(&sum(edges)) > allowed
}

impl<const D: usize> Frame<D> {
    pub(crate) fn new(edges: [Vector<D>; D], rest: Option<[Vector<D>; D]>, determinant: f64) -> Self {
        let rest = rest.map(|rest| SMatrix::from_columns(&rest));
        Self { jacobian: SMatrix::from_columns(&edges), rest, determinant }
    }

    /// The frame for cells whose mean edges nearly vanish or fall together: a length scale.
    pub(crate) fn scaled(scale: f64) -> Self {
        let determinant = (0..D).fold(1.0, |power, _| power * scale);
        Self { jacobian: SMatrix::identity() * scale, rest: None, determinant }
    }

    /// A normal in the frame, for a cell with the first node at `x0`, in the frame at `y0`.
    #[inline(always)]
    pub(crate) fn along(&self, normal: &Vector<D>, x0: &Vector<D>, y0: &Vector<D>) -> Direction<D> {
        let mut m = self.product(normal);
        let mut size = largest(&m);
        let mut length = 1.0;
        if size < f64::MIN_POSITIVE {
            (m, size, length) = self.along_short(normal);
        }
        // Divided, not multiplied by the rounded inverse, for the largest to be 1 or -1.
        let m = (m / size).map(|c| if c.abs() < DIRECTION_NEGLIGIBLE { 0.0 } else { c });
        let size = size * length;
        let per_size = size.max(f64::MIN_POSITIVE).recip();
        Direction { m, size, per_size, base: compensated::dot(normal, x0), first: m.dot(y0) }
    }

    /// `J^T n`, its largest component, and what both are to be multiplied by, for a normal so short that `J^T n` has lost its
    /// digits or is nothing.
    #[cold]
    fn along_short(&self, normal: &Vector<D>) -> (Vector<D>, f64, f64) {
        let length = largest(normal);
        let m = self.product(&(normal / length));
        let size = largest(&m);
        if size >= f64::MIN_POSITIVE { (m, size, length) } else { (Vector::zeros(), 1.0, 1.0) }
    }

    /// What a plane leaves of the cell, from the volume in the frame and its derivative by the level.
    #[inline(always)]
    pub(crate) fn truncation(&self, part: Value, direction: &Direction<D>) -> Truncation {
        Truncation {
            volume: self.determinant * part.value,
            section_area: self.determinant * (part.derivative * direction.per_size),
        }
    }

    /// `J^T n`.
    #[inline(always)]
    fn product(&self, normal: &Vector<D>) -> Vector<D> {
        match &self.rest {
            None => self.jacobian.tr_mul(normal),
            Some(rest) => self.compensated_product(rest, normal),
        }
    }

    #[cold]
    fn compensated_product(&self, rest: &SMatrix<f64, D, D>, normal: &Vector<D>) -> Vector<D> {
        Vector::from_fn(|axis, _| {
            let [value, lost] = compensated::dot(&self.jacobian.column(axis).into_owned(), normal);
            value + (lost + rest.column(axis).dot(normal))
        })
    }
}

/// The largest magnitude of a component.
///
/// Products of plain ones, or of heights, could over- or underflow: all of a direction is relative to it.
#[inline(always)]
fn largest<const D: usize>(m: &Vector<D>) -> f64 {
    m.iter().fold(0.0, |largest: f64, c| if c.abs() > largest { c.abs() } else { largest })
}

impl<const D: usize> Direction<D> {
    /// No direction.
    pub(crate) const NONE: Self = Self {
        m: Vector::from_array_storage(nalgebra::ArrayStorage([[0.0; D]])),
        size: 0.0,
        per_size: 0.0,
        base: [0.0; 2],
        first: 0.0,
    };

    /// `m.y` on the plane `n.x = constant`.
    #[inline(always)]
    pub(crate) fn level(&self, constant: f64) -> f64 {
        compensated::difference(constant, self.base) * self.per_size + self.first
    }

    /// `n.(x - x0)` on the plane `m.y = level`: the plane constant relative to the first node.
    #[inline(always)]
    pub(crate) fn local_constant(&self, level: f64) -> f64 {
        (level - self.first) * self.size
    }

    /// The plane constant of the plane `m.y = level`: the inverse of [`Direction::level`].
    #[inline(always)]
    pub(crate) fn constant(&self, level: f64) -> f64 {
        self.base[0] + (self.base[1] + self.local_constant(level))
    }
}
