//! The largest factor on MinMod with which the scheme `tvd` lets no total variation grow.

use vofkit::geometry::{Quad, Vector};
use vofkit::mesh::{Distortion, Grid, Mesh};
use vofkit::metrics::total_variation;
use vofkit::velocity::{FaceFluxes, Field};
use vofkit::volume_associated::{Limiter, Quantity, Scheme, Splitting, VolumeTransport};

/// Where it is looked for: once where the bound is above the largest factor that there is, and above.
pub(crate) const COURANT_NUMBERS: [f64; 7] = [0.5, 0.55, 0.6, 0.7, 0.8, 0.9, 0.95];

/// Cells of the bar, steps of a trial, halvings of the interval from 0 to 2, and growth of the total variation that is rounding.
const CELLS: usize = 24;
const STEPS: usize = 200;
const HALVINGS: usize = 12;
const ROUNDING: f64 = 1e-12;

/// The bound that the total variation gives: `2 (1/Cr - 1)`, and 2 beyond which no factor goes.
pub(crate) fn bound(courant: f64) -> f64 {
    (2.0 * (1.0 / courant - 1.0)).min(2.0)
}

/// Whether the total variation of waves of all lengths along a bar grows in any step.
pub(crate) fn grows(courant: f64, alpha: f64) -> Result<bool, Box<dyn std::error::Error>> {
    let grid = Grid::new([CELLS, 1], [true, false]);
    let upper = [1.0, 1.0 / CELLS as f64].into();
    let mesh = Mesh::<Quad, 2>::new(grid, Vector::zeros(), upper, &Distortion::None)?;
    let fluxes = FaceFluxes::new(&mesh, &Field::Uniform { velocity: Vector::<3>::x() })?;
    let mut transport = VolumeTransport::new(&mesh, Splitting::Alternating, false);
    let quantity = Quantity { scheme: Scheme::Tvd(Limiter::ScaledMinMod { alpha }), ..Quantity::default() };
    let mut values = vec![(0..CELLS).map(|i| ((i * i + 3 * i) % 11) as f64 / 11.0).collect::<Vec<f64>>()];
    for step in 0..STEPS {
        let before = total_variation(mesh.grid(), &values[0]);
        transport.flow(&fluxes.step(courant / CELLS as f64), step, &[quantity], &mut values)?;
        if total_variation(mesh.grid(), &values[0]) > before * (1.0 + ROUNDING) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// The largest factor with which it does not, to `2^-11`.
pub(crate) fn largest_factor(courant: f64) -> Result<f64, Box<dyn std::error::Error>> {
    let (mut fine, mut grown) = (0.0, 2.0);
    if !grows(courant, grown)? {
        return Ok(grown);
    }
    for _ in 0..HALVINGS {
        let alpha = 0.5 * (fine + grown);
        if grows(courant, alpha)? { grown = alpha } else { fine = alpha }
    }
    Ok(fine)
}
