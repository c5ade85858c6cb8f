//! The names of the schemes on face fluxes.

use super::limiter::Limiter;

/// How the value of a quantity that crosses a face is found from the means of the cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// The mean of the cell that gives (Eq. 53): first order, monotone.
    Donor,
    /// Linear between the two cells, half a step earlier (Eq. 56): second order, not monotone.
    LaxWendroff,
    /// Lax-Wendroff, limited so that no new extremum arises (Eq. 60; Zalesak 1979).
    Fct,
    /// The limited line of the giving cell at its face (Eq. 63-72), as in the paper.
    Tvd(Limiter),
    /// The mean of the limited line over the swept region, that is at the distance `(1 - Cr)` of the way from the middle of the giving
    /// cell to its face (van Leer 1979): second order in space and time.
    Muscl(Limiter),
}

impl Default for Scheme {
    fn default() -> Self {
        Self::Muscl(Limiter::default())
    }
}

impl Scheme {
    /// The limiter of the slopes, where the scheme has slopes.
    pub fn limiter(&self) -> Option<Limiter> {
        match *self {
            Self::Tvd(limiter) | Self::Muscl(limiter) => Some(limiter),
            Self::Donor | Self::LaxWendroff | Self::Fct => None,
        }
    }
}
