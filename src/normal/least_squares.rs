//! The gradient that fits the differences of fractions to all neighbours best:
//!
//! ```text
//! sum over neighbours of w (f - f_0 - g.(y - y_0))^2 -> min,   w = 1 / |y - y_0|^2
//! ```
//!
//! with the means `y` of the cells' nodes. It needs no symmetry of the patch, so that neither distortion nor a missing layer at an
//! end of the mesh turns it. Places are taken in the frame of the cell, in which near and far mean the same in all directions.

use nalgebra::SMatrix;
use vofkit_geometry::{Cell, Vector};

use super::patch::Patch;
use super::youngs::{against, slopes};
use super::{Around, Found};
use crate::tolerance::NORMAL_EQUATIONS;

pub(super) fn normal<C: Cell<D>, const D: usize>(around: &Around<'_, C, D>) -> Found<D> {
    // The same neighbourhoods have no gradient.
    slopes(&around.stencil)?;
    fitted(&Patch::new(around))
}

/// The normal in space of the best gradient over a patch.
pub(super) fn fitted<C: Cell<D>, const D: usize>(patch: &Patch<C, D>) -> Found<D> {
    let middle = patch.middle(Patch::<C, D>::MIDDLE);
    let own = patch.fraction(Patch::<C, D>::MIDDLE);
    let (mut matrix, mut right) = (SMatrix::<f64, D, D>::zeros(), Vector::<D>::zeros());
    for place in patch.neighbours() {
        let step = patch.middle(place) - middle;
        let weighted = step / step.norm_squared();
        matrix += weighted * step.transpose();
        right += weighted * (patch.fraction(place) - own);
    }
    // Where the mesh is one cell wide nothing is known of the slope across it: it becomes zero.
    let trace = matrix.trace();
    matrix += SMatrix::identity() * (NORMAL_EQUATIONS * trace);
    let gradient = matrix.try_inverse().map_or_else(Vector::zeros, |inverse| inverse * right);
    let direction = against(gradient)?;
    Ok(super::Direction { normal: patch.frame.in_space(&direction.normal), ..direction })
}
