//! Every threshold of the numerics, each dimensionless and with its reason. Those of the cells are in
//! [`vofkit_geometry::tolerance`], those of the integrals over shapes with these in `fractions`.

/// Fluxes are multiples of the largest edge integral over two to this power: below its rounding, and sums of a cell's
/// fluxes still fit into the 53 bits of a double.
pub const FLUX_BITS: i32 = 49;

/// A fraction this close to 0 or 1 is set to it, and the change is in the ledger. It is the rounding of a step: without it
/// cells that emptied would keep a remainder of a few units in the last place and be carried along as mixed for ever.
pub const FRACTION_ROUNDING: f64 = 1e-14;

/// A gradient below this, relative to the largest fraction of the stencil, is rounding: no normal.
pub const GRADIENT_FLAT: f64 = 16.0 * f64::EPSILON;

/// A swept region whose own volume differs from the flux volume by more than this factor does not resemble the face's motion (its
/// velocity changes sign): the face is then moved as a whole.
pub const SWEPT_VOLUME_RATIO: f64 = 2.0;

/// Two outflows of a cell may ask for this much more than it holds, relative to its volume: rounding.
pub const OUTFLOW_EXCESS: f64 = 1e-12;

/// A reversed flow whose remaining duration is below this, relative to the time it ran, is back at its start: the rounding of the
/// sum of the steps.
pub const REVERSAL_ROUNDING: f64 = 1e-12;

/// The moves of a node and of its image at a joined end may differ by this, relative to the size of the mesh: rounding. Without
/// a limit joined ends could come apart.
pub const PERIODIC_MOTION: f64 = 1e-12;

/// A cell belongs to a fragment of a material where its fraction is above this: wisps below it join nothing.
pub const FRAGMENT_FRACTION: f64 = 1e-6;

/// A fragment counts where it holds more than this part of the material.
pub const FRAGMENT_VOLUME: f64 = 1e-4;

/// Cell volumes and edge integrals of potentials outside this range are refused: their products, quotients and roundings would
/// over- or underflow.
pub const RANGE: std::ops::RangeInclusive<f64> = 1e-250..=1e250;
