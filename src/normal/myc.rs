//! Mixed Youngs-centred (Aulisa, Manservisi, Scardovelli & Zaleski 2007), for undistorted meshes.
//!
//! Of the normals `m` (in cells, `sum |m_k| = 1`) that central differences of column heights give along each axis, the one with
//! the largest component along its own axis is the centred one: its columns are the least steep. It competes with Youngs' normal, and the one whose
//! largest component is smaller wins: heights are exact for gentle slopes, Youngs' gradient is better for steep ones. On distorted
//! meshes the result is taken to space as Youngs' gradient is.

use vofkit_geometry::{Cell, Vector};

use super::columns::Columns;
use super::youngs::{against, in_space, slopes};
use super::{Around, Found};

pub(super) fn normal<C: Cell<D>, const D: usize>(around: &Around<'_, C, D>) -> Found<D> {
    let scaled = |m: Vector<D>| m / m.iter().map(|c| c.abs()).sum::<f64>();
    let youngs = scaled(-slopes(&around.stencil)?);
    let mut centred = Vector::zeros();
    let mut least_steep = 0.0;
    for axis in 0..D {
        let m = scaled(Columns::new(&around.stencil, axis).normal(|_| 1));
        if m[axis].abs() > least_steep {
            (centred, least_steep) = (m, m[axis].abs());
        }
    }
    let chosen = if least_steep > youngs.amax() { youngs } else { centred };
    against(in_space(around, &-chosen))
}
