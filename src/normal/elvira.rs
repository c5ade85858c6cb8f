//! ELVIRA (Pilliod & Puckett 2004): of the planes that backward, central and forward differences of column heights give along
//! every axis, the one with the least [misfit](super::lvira). In 2D on undistorted meshes one of the six is exact for a line; elsewhere
//! they serve LVIRA as starts.

use vofkit_geometry::{Cell, PositionMethod};

use super::columns::Columns;
use super::lvira::Fit;
use super::youngs::{against, in_space, slopes};
use super::{Around, Direction, Found, NoNormal};

pub(super) fn normal<C: Cell<D>, const D: usize>(
    around: &Around<'_, C, D>,
    position: PositionMethod,
) -> Found<D> {
    slopes(&around.stencil)?;
    let mut fit = Fit::new(around, position);
    let found = best(around, &mut fit)?;
    Ok(Direction { trials: fit.trials, ..found })
}

/// The candidate with the least misfit.
pub(super) fn best<C: Cell<D>, const D: usize>(around: &Around<'_, C, D>, fit: &mut Fit<C, D>) -> Found<D> {
    let mut best = Err(NoNormal::Balanced);
    let mut least = f64::INFINITY;
    for axis in 0..D {
        let columns = Columns::new(&around.stencil, axis);
        for choice in 0..3_usize.pow(D as u32 - 1) {
            // One digit to base 3 for each other axis.
            let digit = |k: usize| choice / 3_usize.pow(if k > axis { k - 1 } else { k } as u32) % 3;
            let candidate = against(in_space(around, &-columns.normal(digit)))?;
            let misfit = fit.misfit(&fit.patch.frame.normal(&candidate.normal));
            if misfit.is_some_and(|misfit| misfit < least) {
                least = misfit.unwrap_or(least);
                best = Ok(candidate);
            }
        }
    }
    best
}
