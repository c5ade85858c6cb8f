//! Ctrl-C, and a polite request to end.

use std::process::exit;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::terminal::Failure;
use crate::run::Progress;

/// The exit code of a process that Ctrl-C ended.
const INTERRUPTED: i32 = 130;

/// What Ctrl-C does: it ends a process that prepares a run at once, one that runs after the step at hand.
pub(super) struct Interrupt {
    /// Set by Ctrl-C during a run.
    pub(super) stop: Arc<AtomicBool>,
    running: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens from now on; the second Ctrl-C of a run ends the process at once.
    ///
    /// # Errors
    /// The system does not let one listen.
    pub(super) fn listen() -> Result<Self, Failure> {
        let [stop, running] = [(); 2].map(|()| Arc::new(AtomicBool::new(false)));
        let (set, is_running) = (stop.clone(), running.clone());
        ctrlc::set_handler(move || {
            if !is_running.load(Ordering::Relaxed) || set.swap(true, Ordering::Relaxed) {
                exit(INTERRUPTED);
            }
            eprintln!("stopping after this step; once more ends at once");
        })
        .map_err(|error| {
            Failure::other(format!("cannot listen to Ctrl-C: {error}"), "run vofkit from a terminal")
        })?;
        Ok(Self { stop, running })
    }

    /// Listens to a run, to know when it starts to write, and tells all to another listener.
    pub(super) fn watch<'a>(&self, inner: &'a mut dyn Progress) -> impl Progress + use<'a> {
        Watch { inner, running: self.running.clone() }
    }
}

struct Watch<'a> {
    inner: &'a mut dyn Progress,
    running: Arc<AtomicBool>,
}

impl Progress for Watch<'_> {
    fn stage(&mut self, what: &str) {
        self.inner.stage(what);
    }

    fn begin(&mut self, steps: usize) {
        self.running.store(true, Ordering::Relaxed);
        self.inner.begin(steps);
    }

    fn step(&mut self, done: usize, time: f64, mixed_cells: usize) {
        self.inner.step(done, time, mixed_cells);
    }

    fn end(&mut self) {
        self.inner.end();
    }
}
