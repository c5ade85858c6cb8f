//! Nanoseconds per cell, of one thread.

use std::hint::black_box;
use std::time::{Duration, Instant};

use vofkit_geometry::{Cell, Hexahedron, TruncationMethod};

use super::Task;
use super::columns::Given;
use super::evaluate::Cut;
use super::input::Input;

/// Cells that are measured, at most: few enough to stay in a processor's cache.
pub(super) const CELLS: usize = 1000;

/// Passes over the cells, at most, and how long one quantity may take; three passes are always done.
const PASSES: usize = 31;
const PATIENCE: Duration = Duration::from_millis(300);

/// What one cell takes, in nanoseconds: medians over passes over some of the cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Cells in a pass.
    pub cells: usize,
    /// Making the cell from its nodes.
    pub build: f64,
    /// Truncated volume and section area, or the plane constant, of a cell that is made.
    pub evaluate: f64,
    /// The first moment, where the method gives it.
    pub moment: Option<f64>,
}

/// Measures a task; none without cells.
pub(super) fn measure(task: Task, inputs: &[Input]) -> Option<Timing> {
    if inputs.is_empty() {
        return None;
    }
    let build = median(inputs, |input| {
        black_box(Hexahedron::new(black_box(input.nodes)));
    });
    let (evaluate, moment) = match task {
        Task::Truncate(method) => {
            let cuts: Vec<Cut> = inputs.iter().filter_map(Cut::given).collect();
            let evaluate = median(&cuts, |cut| {
                black_box(method.truncate(&cut.cell, black_box(&cut.half_space)));
            });
            let moment = || {
                median(&cuts, |cut| {
                    black_box(black_box(cut).moment());
                })
            };
            (evaluate, (method == TruncationMethod::Exact).then(moment))
        }
        Task::Position(method) => {
            let asked = |input: &Input| match input.given {
                Given::Fraction(fraction) => Some((Hexahedron::new(input.nodes), input.normal, fraction)),
                _ => None,
            };
            let cells: Vec<_> = inputs.iter().filter_map(asked).collect();
            let evaluate = median(&cells, |(cell, normal, fraction)| {
                let _ = black_box(cell.plane_constant(black_box(normal), *fraction, method));
            });
            (evaluate, None)
        }
    };
    Some(Timing { cells: inputs.len(), build, evaluate, moment })
}

/// The median of the time of a pass, per item.
fn median<T>(items: &[T], work: impl Fn(&T)) -> f64 {
    let start = Instant::now();
    let mut passes = Vec::with_capacity(PASSES);
    while passes.len() < 3 || (passes.len() < PASSES && start.elapsed() < PATIENCE) {
        let start = Instant::now();
        items.iter().for_each(&work);
        passes.push(start.elapsed().as_secs_f64());
    }
    passes.sort_by(f64::total_cmp);
    passes[passes.len() / 2] * 1e9 / items.len().max(1) as f64
}
