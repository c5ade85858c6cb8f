//! How long the stages of a run take, as it tells them.

use std::time::Instant;

use super::measure::Named;
use crate::run::Progress;

/// A clock that listens.
#[derive(Debug, Default)]
pub(super) struct Stages {
    done: Vec<Named>,
    running: Option<(String, Instant)>,
}

impl Stages {
    /// The stages in their order.
    pub(super) fn finish(mut self) -> Vec<Named> {
        self.stop();
        self.done
    }

    fn start(&mut self, what: &str) {
        self.stop();
        self.running = Some((what.to_owned(), Instant::now()));
    }

    fn stop(&mut self) {
        if let Some((name, start)) = self.running.take() {
            self.done.push(Named::new(name, start.elapsed().as_secs_f64()));
        }
    }
}

impl Progress for Stages {
    fn stage(&mut self, what: &str) {
        self.start(what);
    }

    fn begin(&mut self, _: usize) {
        self.start("steps");
    }

    fn step(&mut self, _: usize, _: f64, _: usize) {}

    fn end(&mut self) {
        self.stop();
    }
}
