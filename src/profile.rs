//! How a scalar quantity is distributed in space at the start: values at points, means over cells.

use vofkit_geometry::{Cell, Vector};

use crate::fractions::volume_fractions;
use crate::mesh::Mesh;
use crate::parallel;
use crate::shape::{Rotation, Shape};

/// Gauss points along each axis for the mean of a smooth profile over a cell.
const POINTS: usize = 4;

/// A distribution in space.
#[derive(Clone, Debug, PartialEq)]
pub enum Profile<const D: usize> {
    /// Shapes with a value each, the first one on top, in a background; a constant without any shapes.
    Inclusions {
        /// The value outside of all shapes.
        background: f64,
        /// The shapes and their values.
        shapes: Vec<(Shape<D>, f64)>,
    },
    /// `mean + amplitude sin(wave . x + phase)`.
    Sine {
        /// The mean.
        mean: f64,
        /// The amplitude.
        amplitude: f64,
        /// The wave vector in radians per length.
        wave: Vector<D>,
        /// The phase in radians.
        phase: f64,
    },
}

impl<const D: usize> Profile<D> {
    /// The same value everywhere.
    pub fn constant(value: f64) -> Self {
        Self::Inclusions { background: value, shapes: Vec::new() }
    }

    /// The value at a point.
    pub fn value(&self, x: &Vector<D>) -> f64 {
        match self {
            Self::Inclusions { background, shapes } => {
                shapes.iter().find(|(shape, _)| shape.contains(x)).map_or(*background, |(_, value)| *value)
            }
            Self::Sine { mean, amplitude, wave, phase } => mean + amplitude * (wave.dot(x) + phase).sin(),
        }
    }

    /// The mean values over the cells: of shapes by their exact volume fractions, of sines by quadrature.
    pub fn cell_means<C: Cell<D>>(&self, mesh: &Mesh<C, D>) -> Vec<f64> {
        let count = mesh.grid().len();
        match self {
            Self::Inclusions { background, shapes } => {
                let (shapes, values): (Vec<_>, Vec<_>) = shapes.iter().cloned().unzip();
                let fractions = volume_fractions(mesh, &shapes);
                let excess = |cell: usize| {
                    fractions
                        .iter()
                        .zip(&values)
                        .map(|(f, value)| f[cell] * (value - background))
                        .sum::<f64>()
                };
                parallel::map(count, |cell| background + excess(cell))
            }
            Self::Sine { .. } => {
                let rule = gauss_quad::legendre::GaussLegendre::new(
                    POINTS.try_into().expect("the number of points is not zero"),
                );
                let rule: Vec<(f64, f64)> = rule.iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect();
                parallel::map(count, |index| {
                    let (anchor, cell) = (mesh.anchor(index), mesh.local_cell(index));
                    let (mut volume, mut integral) = (0.0, 0.0);
                    for point in 0..POINTS.pow(D as u32) {
                        let of_axis = |axis: usize| rule[point / POINTS.pow(axis as u32) % POINTS];
                        let local = Vector::from_fn(|axis, _| of_axis(axis).0);
                        let weight = (0..D).map(|axis| of_axis(axis).1).product::<f64>();
                        let part = weight * cell.jacobian_determinant(&local);
                        volume += part;
                        integral += part * self.value(&(anchor + cell.map(&local)));
                    }
                    integral / volume
                })
            }
        }
    }

    /// The profile after `x -> about + R (x - about) + shift`.
    #[must_use]
    pub fn moved(&self, rotation: &Rotation<D>, about: &Vector<D>, shift: &Vector<D>) -> Self {
        match self {
            Self::Inclusions { background, shapes } => Self::Inclusions {
                background: *background,
                shapes: shapes
                    .iter()
                    .map(|(shape, value)| (shape.moved(rotation, about, shift), *value))
                    .collect(),
            },
            Self::Sine { mean, amplitude, wave, phase } => {
                let turned = rotation.apply(wave);
                let phase = phase + wave.dot(about) - turned.dot(&(about + shift));
                Self::Sine { mean: *mean, amplitude: *amplitude, wave: turned, phase }
            }
        }
    }
}
