//! The plane constant for a given part of a cell: the inverse of truncation (Eq. 86 of the paper).

use std::fmt;

use crate::frame::Direction;
use crate::root::{self, Root, Search, Value};
use crate::tolerance::{
    POSITION_EVALUATIONS, POSITION_FAILURE, POSITION_LEAST, POSITION_RESIDUAL, POSITION_ROUNDING,
};

/// How the plane constant is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PositionMethod {
    /// In closed form for every quadrilateral and for parallelepipeds, else by [`PositionMethod::Newton`].
    #[default]
    Auto,
    /// Newton's method with the section area as derivative, bracketed, from the closed form of the cell's affine part.
    Newton,
    /// Brent's method over the whole range of the cell: the paper's choice.
    Brent,
}

/// A plane constant with the numbers that say how good it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneConstant {
    /// The plane constant `d`, rounded: far from the origin that moves the plane by more than rounding of the cell.
    pub constant: f64,
    /// `n.(x - x0)` on the plane, with the first node `x0` of the cell: the plane constant where that node is the origin. It has all
    /// its digits however far from the origin the cell lies.
    pub local_constant: f64,
    /// Truncated volume minus the volume asked for, relative to the cell's volume, before the constants were rounded.
    pub residual: f64,
    /// Evaluations of the truncated volume, the one of the residual included.
    pub evaluations: usize,
    /// Whether a closed form gave it.
    pub closed_form: bool,
}

/// Why there is no plane constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PositionError {
    /// The fraction is not in `[0, 1]`.
    Fraction(f64),
    /// The normal is zero or not finite.
    Normal,
    /// The cell's volume is not positive, or not finite.
    Volume(f64),
    /// The search ended with this residual, relative to the cell's volume.
    NoConvergence {
        /// Residual relative to the cell's volume.
        residual: f64,
        /// Evaluations spent.
        evaluations: usize,
    },
}

impl fmt::Display for PositionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fraction(fraction) => write!(f, "the fraction {fraction} is not between 0 and 1"),
            Self::Normal => write!(f, "the normal is zero or not finite"),
            Self::Volume(volume) => write!(f, "the cell's volume {volume:e} is not positive"),
            Self::NoConvergence { residual, evaluations } => write!(
                f,
                "no plane constant found: {residual:.3e} of the cell's volume is left after {evaluations} evaluations"
            ),
        }
    }
}

impl std::error::Error for PositionError {}

/// A cell along one normal, in its own frame: volume as a function of the depth of the plane over the lowest node.
pub(crate) trait Monotone {
    /// Depth of the highest node.
    fn span(&self) -> f64;
    /// The whole volume.
    fn total(&self) -> f64;
    /// Volume below the plane and its derivative.
    fn volume(&mut self, depth: f64) -> Value;
    /// A good first guess for the depth of a part of the volume.
    fn start(&self, fraction: f64) -> f64;
    /// The depth in closed form, where there is one, with the evaluations that it took.
    fn closed_form(&mut self, fraction: f64) -> Option<(f64, usize)>;
}

pub(crate) fn check(normal: &[f64], fraction: f64, volume: f64) -> Result<(), PositionError> {
    if !(0.0..=1.0).contains(&fraction) {
        return Err(PositionError::Fraction(fraction));
    }
    if !normal.iter().all(|c| c.is_finite()) || normal.iter().all(|&c| c == 0.0) {
        return Err(PositionError::Normal);
    }
    if !(volume > 0.0 && volume.is_finite()) {
        return Err(PositionError::Volume(volume));
    }
    Ok(())
}

/// Searches from the side of the smaller part, which keeps that part accurate: `search` is given the sign of the
/// normal to use and the fraction, and returns the plane constant for the original normal.
pub(crate) fn from_smaller_part(
    fraction: f64,
    search: impl Fn(f64, f64) -> Result<PlaneConstant, PositionError>,
) -> Result<PlaneConstant, PositionError> {
    let (sign, fraction) = smaller_part(fraction);
    search(sign, fraction)
}

/// The sign of the normal to use, and the fraction along it.
#[inline(always)]
pub(crate) fn smaller_part(fraction: f64) -> (f64, f64) {
    if fraction <= 0.5 { (1.0, fraction) } else { (-1.0, 1.0 - fraction) }
}

/// A depth over the lowest node, with the other numbers of a [`PlaneConstant`].
pub(crate) struct Depth {
    depth: f64,
    residual: f64,
    evaluations: usize,
    closed_form: bool,
}

impl Depth {
    /// Where a search ended.
    ///
    /// # Errors
    /// A residual that is larger than rounding.
    #[inline(always)]
    pub(crate) fn of_root(root: Root, total: f64) -> Result<Self, PositionError> {
        let Root { position: depth, residual, evaluations } = root;
        let accepted = residual.abs() <= (POSITION_FAILURE * total).max(POSITION_ROUNDING);
        let residual = residual / total;
        if accepted {
            Ok(Self { depth, residual, evaluations, closed_form: false })
        } else {
            Err(PositionError::NoConvergence { residual, evaluations })
        }
    }

    /// The plane constant of `n`, where `direction` is that of `sign n` and the lowest node has `m.y = low`.
    #[inline(always)]
    pub(crate) fn plane<const D: usize>(
        self,
        direction: &Direction<D>,
        low: f64,
        sign: f64,
    ) -> PlaneConstant {
        let Self { depth, residual, evaluations, closed_form } = self;
        let level = low + depth;
        PlaneConstant {
            constant: sign * direction.constant(level),
            local_constant: sign * direction.local_constant(level),
            residual: sign * residual,
            evaluations,
            closed_form,
        }
    }
}

/// The depth for `fraction <= 1/2`.
#[inline(always)]
pub(crate) fn find<M: Monotone>(
    cell: &mut M,
    fraction: f64,
    method: PositionMethod,
) -> Result<Depth, PositionError> {
    let total = cell.total();
    let target = fraction * total;
    if target <= 0.0 {
        return Ok(Depth { depth: 0.0, residual: 0.0, evaluations: 0, closed_form: true });
    }
    if method == PositionMethod::Auto
        && let Some((depth, evaluations)) = cell.closed_form(fraction)
    {
        let residual = (cell.volume(depth).value - target) / total;
        return Ok(Depth { depth, residual, evaluations: evaluations + 1, closed_form: true });
    }
    let span = cell.span();
    let tolerance = residual_allowed(target);
    let root = match method {
        PositionMethod::Brent => root::brent(
            |depth| cell.volume(depth).value - target,
            [0.0, span],
            [-target, total - target],
            tolerance,
            POSITION_EVALUATIONS,
        ),
        _ => {
            let mut search = Search::new([0.0, span], cell.start(fraction), tolerance);
            loop {
                let volume = cell.volume(search.position);
                if search.advance(volume.less(target), POSITION_EVALUATIONS) {
                    break search.best;
                }
            }
        }
    };
    Depth::of_root(root, total)
}

/// The residual with which a search may end.
#[inline(always)]
pub(crate) fn residual_allowed(target: f64) -> f64 {
    (POSITION_RESIDUAL * target).max(POSITION_LEAST)
}

/// The depth of a slab that holds `fraction` of the volume, for an integrated Jacobian determinant that is the
/// quadratic through the three values at depths 0, 1/2 and 1.
pub(crate) fn slab_depth([a0, middle, a1]: [f64; 3], fraction: f64) -> f64 {
    let linear = 4.0 * middle - 3.0 * a0 - a1;
    let square = 2.0 * (a0 + a1 - 2.0 * middle);
    let total = (a0 + 4.0 * middle + a1) / 6.0;
    let fraction = fraction.clamp(0.0, 1.0);
    if fraction == 0.0 || fraction == 1.0 {
        return fraction;
    }
    let target = fraction * total;
    let volume = |t: f64| Value {
        value: t * (a0 + t * (linear / 2.0 + t * square / 3.0)) - target,
        derivative: a0 + t * (linear + t * square),
        second: linear + 2.0 * t * square,
    };
    root::newton(volume, [0.0, 1.0], fraction, POSITION_RESIDUAL * target, POSITION_EVALUATIONS).position
}
