//! How far a run is: a bar on a terminal, a line now and then elsewhere.

use std::io::{self, IsTerminal, Write};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use crate::run::Progress;

/// Lines are printed this many times over a run.
const LINES: usize = 10;

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

/// Plain lines, about every tenth part of the run.
#[derive(Debug, Default)]
pub struct Lines {
    steps: usize,
    printed: usize,
    start: Option<Instant>,
}

impl Progress for Lines {
    fn stage(&mut self, _: &str) {}

    fn begin(&mut self, steps: usize) {
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
        self.start = None;
    }
}
