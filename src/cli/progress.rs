//! How far a run is: a bar on a terminal, a line now and then elsewhere.

use std::io::{self, IsTerminal, Write};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::run::Progress;

/// Lines are printed this many times over a run.
const LINES: usize = 10;

/// Stages that take longer than this are told.
const PATIENCE: Duration = Duration::from_secs(1);

/// What suits the standard error of this process.
pub fn chosen() -> Box<dyn Progress> {
    if io::stderr().is_terminal() { Box::new(Bar::default()) } else { Box::new(Lines::default()) }
}

/// A bar with the time that is left.
#[derive(Debug, Default)]
pub struct Bar {
    bar: Option<ProgressBar>,
}

impl Progress for Bar {
    fn stage(&mut self, what: &str) {
        self.end();
        let bar = ProgressBar::new_spinner().with_message(what.to_owned());
        bar.tick();
        self.bar = Some(bar);
    }

    fn begin(&mut self, steps: usize) {
        self.end();
        let bar = ProgressBar::new(steps as u64);
        let style = "{elapsed_precise} {bar:32} {pos}/{len} steps, {eta} left, {msg}";
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style);
        }
        self.bar = Some(bar);
    }

    fn step(&mut self, done: usize, time: f64, mixed_cells: usize) {
        let Some(bar) = &self.bar else { return };
        bar.set_message(format!("t = {time:.4}, {mixed_cells} mixed cells"));
        bar.set_position(done as u64);
    }

    fn end(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}

/// Plain lines, about every tenth part of the run and for stages that take their time.
#[derive(Debug, Default)]
pub struct Lines {
    stage: Option<Reminder>,
    steps: usize,
    printed: usize,
    start: Option<Instant>,
}

impl Progress for Lines {
    fn stage(&mut self, what: &str) {
        let line = format!("{what} ...");
        // Nobody may be reading.
        self.stage = Reminder::new(PATIENCE, move || drop(writeln!(io::stderr().lock(), "{line}")));
    }

    fn begin(&mut self, steps: usize) {
        self.stage = None;
        (self.steps, self.printed, self.start) = (steps, 0, Some(Instant::now()));
    }

    fn step(&mut self, done: usize, time: f64, mixed_cells: usize) {
        let part = done * LINES / self.steps.max(1);
        let Some(start) = self.start.filter(|_| part > self.printed) else { return };
        self.printed = part;
        let elapsed = start.elapsed().as_secs_f64();
        let left = elapsed * (self.steps - done) as f64 / done.max(1) as f64;
        // Nobody may be reading.
        let _ = writeln!(
            io::stderr().lock(),
            "step {done} of {}, t = {time:.6}, {mixed_cells} mixed cells, {elapsed:.1} s, {left:.1} s left",
            self.steps
        );
    }

    fn end(&mut self) {
        self.stage = None;
        self.start = None;
    }
}

/// Does something after a while, unless it is dropped before.
#[derive(Debug)]
struct Reminder {
    _alive: Sender<()>,
}

impl Reminder {
    /// None where the system gives no thread for it.
    fn new(patience: Duration, remind: impl FnOnce() + Send + 'static) -> Option<Self> {
        let (alive, dropped) = mpsc::channel();
        let wait = move || {
            if dropped.recv_timeout(patience) == Err(RecvTimeoutError::Timeout) {
                remind();
            }
        };
        thread::Builder::new().spawn(wait).ok()?;
        Some(Self { _alive: alive })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_that_last_are_told_and_short_ones_are_not() {
        let (told, heard) = mpsc::channel();
        let stage = |patience: u64, what: &'static str| {
            let told = told.clone();
            Reminder::new(Duration::from_millis(patience), move || told.send(what).unwrap())
        };
        drop(stage(60_000, "short"));
        let long = stage(1, "long");
        assert!(long.is_some());
        drop(told);
        // Ends when both have told or been dropped.
        assert_eq!(heard.iter().collect::<Vec<_>>(), ["long"]);
    }
}
