//! SLIC (Noh & Woodward 1976), the baseline: interfaces along mesh lines only.
//!
//! The logical direction `k` along which the fractions change most, `max |df/dxi_k|`, gives the normal `-+ grad xi_k`. The
//! original chooses anew for each direction of a split step; this is its static form.

use vofkit_geometry::{Cell, Vector};

use super::youngs::{against, slopes};
use super::{Around, Found};

pub(super) fn normal<C: Cell<D>, const D: usize>(around: &Around<'_, C, D>) -> Found<D> {
    let gradient = slopes(&around.stencil)?;
    let steepest = gradient.iamax();
    let alone = Vector::from_fn(|k, _| if k == steepest { gradient[k] } else { 0.0 });
    against(around.cell.physical_gradient(&alone))
}
