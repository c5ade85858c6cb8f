//! Time steps: how many, how long, and after which of them something is written.

use crate::scene::{Part, Resolved, ReversalSetup, SceneError, Stepping, Substeps};
use crate::velocity::Reversal;

/// Rounding of a Courant number or of a number of steps, relative.
const ROUNDING: f64 = 1e-9;

/// More steps than this are a slip in the scene.
const MOST_STEPS: f64 = 1e9;

/// Equal time steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Their number.
    pub steps: usize,
    /// The time after the last one.
    pub end: f64,
    /// The Courant number of one of them at the largest amplitude of the velocity.
    pub courant: f64,
    /// How many parts each is split into.
    pub substeps: usize,
    /// Whether the run goes on where a cell would give more than it holds.
    pub overdraft: bool,
}

impl Plan {
    /// The steps of a scene whose Courant number is `rate` times the time step.
    ///
    /// # Errors
    /// No time step follows from the scene, or it is larger than the scheme can do.
    pub(crate) fn new<const D: usize>(scene: &Resolved<D>, rate: f64) -> Result<Self, SceneError> {
        let (steps, end) = steps(scene, rate)?;
        let courant = rate * end / steps as f64;
        let mut plan = Self { steps, end, courant, substeps: 1, overdraft: false };
        let scheme = scene.advection.scheme;
        let limit = scheme.courant_limit(D);
        if courant > limit * (1.0 + ROUNDING) {
            match scene.advection.substeps {
                Substeps::Off => plan.overdraft = true,
                Substeps::Auto => plan.substeps = (courant / limit * (1.0 - ROUNDING)).ceil() as usize,
                Substeps::Error => {
                    return Err(scene.error(
                        Part::Courant,
                        format!(
                            "the Courant number {courant:.4} is above {limit}, the limit of the scheme `{}`",
                            scheme
                        ),
                        "lower advection.courant or take more steps; advection.substeps = \"auto\" splits the steps, \
                         \"off\" runs anyway",
                    ));
                }
            }
        }
        Ok(plan)
    }

    /// The time step.
    pub fn dt(&self) -> f64 {
        self.end / self.steps as f64
    }

    /// The time after a number of steps.
    pub fn time(&self, step: usize) -> f64 {
        if step == self.steps { self.end } else { self.end * (step as f64 / self.steps as f64) }
    }

    /// The number of steps after which a time is reached: the step that ends at it but for rounding, else the first one
    /// after it; none after the end.
    pub fn step_at(&self, time: f64) -> Option<usize> {
        let steps = time / self.dt();
        let step = (steps - ROUNDING * steps.max(1.0)).ceil().max(0.0);
        (step <= self.steps as f64).then_some(step as usize)
    }

    /// The reversal, with the time of a flip that is given by its step.
    pub(crate) fn reversal(&self, setup: ReversalSetup) -> Reversal {
        match setup {
            ReversalSetup::None => Reversal::None,
            ReversalSetup::Cosine { period } => Reversal::Cosine { period },
            ReversalSetup::FlipAtTime { time } => Reversal::Flip { time },
            ReversalSetup::FlipAtStep { step } => {
                let step = usize::try_from(step).unwrap_or(usize::MAX);
                let time = if step <= self.steps { self.time(step) } else { step as f64 * self.dt() };
                Reversal::Flip { time }
            }
        }
    }
}

fn steps<const D: usize>(scene: &Resolved<D>, rate: f64) -> Result<(usize, f64), SceneError> {
    let checked = |steps: f64, end: f64| {
        if steps <= MOST_STEPS && end.is_finite() && end > 0.0 {
            return Ok((steps as usize, end));
        }
        Err(scene.error(
            Part::Steps,
            format!("the run would take {steps:.3e} steps to the time {end:.3e}"),
            format!("shorten it to at most {MOST_STEPS:e} steps of finite length"),
        ))
    };
    let (courant, asked) = match scene.advection.stepping {
        Stepping::StepsToTime { steps, end_time } => return checked(steps as f64, end_time),
        Stepping::CourantToTime { courant, end_time } => (courant, Ok(end_time)),
        Stepping::CourantForSteps { courant, steps } => (courant, Err(steps as f64)),
    };
    if rate.is_nan() || rate <= 0.0 {
        return Err(scene.error(
            Part::Field,
            "the velocity is zero at every face, so no time step follows from a Courant number",
            "give advection.steps and advection.end_time",
        ));
    }
    match asked {
        Ok(end) => {
            let least = rate * end / courant;
            checked((least * (1.0 - ROUNDING)).ceil().max(1.0), end)
        }
        Err(steps) => checked(steps, steps * courant / rate),
    }
}
