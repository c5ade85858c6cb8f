//! How long the phases of a run take. The clock is read between them, a few times in a step, never in loops over cells; a
//! stopwatch that was not started reads none.

use std::time::Instant;

/// Seconds by phase: time that passed, with all threads at work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "cli", derive(serde::Serialize))]
pub struct PhaseSeconds {
    /// Mesh, fractions at the start, fluxes of the velocity, and what else is made once.
    pub initialise: f64,
    /// The normals of mixed cells. Where other materials are around, a normal is found together with its plane constant, and here.
    pub normals: f64,
    /// Their plane constants.
    pub positions: f64,
    /// Cutting what crosses faces, or what cells come from; materials that are cut from a cell one after the other get their
    /// planes at that.
    pub fluxes: f64,
    /// What cells hold afterwards, what is taken along, and the next place of a mesh that moves.
    pub update: f64,
    /// Steps of fields.
    pub fields: f64,
    /// Accounts, tables, pictures and other files.
    pub output: f64,
}

impl PhaseSeconds {
    /// Names and seconds in the order in which the phases come.
    pub fn named(&self) -> [(&'static str, f64); 7] {
        [
            ("initialise", self.initialise),
            ("normals", self.normals),
            ("positions", self.positions),
            ("fluxes", self.fluxes),
            ("update", self.update),
            ("fields", self.fields),
            ("output", self.output),
        ]
    }

    /// The seconds of time steps: all but what is done before, between and after them.
    pub fn steps(&self) -> f64 {
        self.normals + self.positions + self.fluxes + self.update + self.fields
    }
}

/// Adds up the time of phases.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stopwatch {
    seconds: PhaseSeconds,
    /// The end of the last phase; none before the start.
    last: Option<Instant>,
}

impl Stopwatch {
    /// One that runs. The default one stands still.
    pub fn started() -> Self {
        Self { seconds: PhaseSeconds::default(), last: Some(Instant::now()) }
    }

    /// Ends a phase, one of the fields of [`PhaseSeconds`]: the time since the last end, or the start, is added to it.
    pub fn lap(&mut self, phase: impl FnOnce(&mut PhaseSeconds) -> &mut f64) {
        if let Some(last) = &mut self.last {
            let now = Instant::now();
            *phase(&mut self.seconds) += now.duration_since(*last).as_secs_f64();
            *last = now;
        }
    }

    /// The time of all phases so far.
    pub fn seconds(&self) -> PhaseSeconds {
        self.seconds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn laps_add_up_to_the_time_that_passed() {
        let start = Instant::now();
        let mut stopwatch = Stopwatch::started();
        let nap = Duration::from_millis(2);
        for _ in 0..2 {
            std::thread::sleep(nap);
            stopwatch.lap(|seconds| &mut seconds.normals);
            std::thread::sleep(nap);
            stopwatch.lap(|seconds| &mut seconds.output);
        }
        let seconds = stopwatch.seconds();
        let least = 2.0 * nap.as_secs_f64();
        assert!(seconds.normals >= least && seconds.output >= least, "{seconds:?}");
        assert!(seconds.steps() == seconds.normals, "{seconds:?}");
        let sum: f64 = seconds.named().iter().map(|(_, value)| value).sum();
        assert!(sum <= start.elapsed().as_secs_f64() * (1.0 + 1e-12), "{seconds:?}");
    }

    #[test]
    fn without_a_start_nothing_is_timed() {
        let mut stopwatch = Stopwatch::default();
        stopwatch.lap(|seconds| &mut seconds.update);
        assert_eq!(stopwatch.seconds(), PhaseSeconds::default());
    }
}
