//! What is known of a combination when it has run.

use serde::{Deserialize, Serialize};

use super::file::Task;

/// A combination and what became of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Its place in the plan.
    pub number: usize,
    /// What was chosen of each list.
    pub labels: Vec<String>,
    /// What became of it.
    pub outcome: Outcome,
}

/// What became of a combination.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// It has run.
    Done(Box<Measures>),
    /// It makes no sense.
    Skipped(String),
    /// It was tried, and failed.
    Failed(String),
}

/// A number with a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Named {
    /// The name.
    pub name: String,
    /// The number.
    pub value: f64,
}

impl Named {
    /// A number with a name.
    pub fn new(name: impl Into<String>, value: f64) -> Self {
        Self { name: name.into(), value }
    }
}

/// A quantity that was measured several times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The lower quartile.
    pub lower: f64,
    /// The upper quartile.
    pub upper: f64,
    /// How many there are.
    pub count: usize,
}

impl Spread {
    /// The spread of some values; zeros without any.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        if values.is_empty() {
            return Self::default();
        }
        let at = |share: f64| {
            let place = share * (values.len() - 1) as f64;
            let (low, part) = (place as usize, place.fract());
            values[low] + part * (values[(low + 1).min(values.len() - 1)] - values[low])
        };
        Self { median: at(0.5), lower: at(0.25), upper: at(0.75), count: values.len() }
    }

    /// Half of the distance between the quartiles over the median, in percent.
    pub fn percent(&self) -> f64 {
        if self.median > 0.0 { 50.0 * (self.upper - self.lower) / self.median } else { 0.0 }
    }

    /// Whether both could be the same but for noise: the middle halves of their values overlap.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.lower <= other.upper && other.lower <= self.upper
    }
}

/// What was measured; what a task does not give is left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measures {
    /// Errors, the one that counts first.
    pub errors: Vec<Named>,
    /// Seconds: of the whole run; reconstruct: for all planes; kernel: for one cell.
    pub seconds: Spread,
    /// Cells along an axis, the geometric mean.
    pub cells_along_axis: Option<f64>,
    /// Time steps.
    pub steps: Option<usize>,
    /// Mixed cells, on average over steps and samples.
    pub mixed_cells: Option<f64>,
    /// Seconds for a mixed cell and a step, setting up left out; reconstruct: for one plane.
    pub seconds_per_mixed_cell: Option<f64>,
    /// Evaluations of truncated volumes for one plane constant by iteration.
    pub evaluations_per_position: Option<f64>,
    /// The share of plane constants in closed form.
    pub closed_form: Option<f64>,
    /// Seconds by stage.
    pub stages: Vec<Named>,
    /// Bytes that a run takes, by count of what it holds.
    pub memory_estimate: Option<u64>,
    /// The most bytes that the process had during the run.
    pub memory_peak: Option<u64>,
    /// The largest relative change of a material's volume.
    pub drift: Option<f64>,
    /// The farthest that a fraction was below 0 or above 1 before correction.
    pub out_of_bounds: Option<f64>,
    /// Volume moved by corrections.
    pub corrected: Option<f64>,
    /// Planes that the fractions around do not determine, and mixed cells without one.
    pub undetermined: Option<usize>,
    /// The largest error by category of cells.
    pub categories: Vec<Named>,
}

impl Measures {
    /// The error of this name, or the first one.
    pub fn error(&self, name: Option<&str>) -> Option<f64> {
        let named = |error: &&Named| name.is_none_or(|name| error.name == name);
        self.errors.iter().find(named).map(|error| error.value)
    }
}

impl Record {
    /// What was measured, if it has run.
    pub fn measures(&self) -> Option<&Measures> {
        if let Outcome::Done(measures) = &self.outcome { Some(measures) } else { None }
    }
}

impl Outcome {
    /// In a line.
    pub fn text(&self, task: Task) -> String {
        match self {
            Self::Done(measures) => {
                let errors =
                    measures.errors.iter().map(|error| format!("{} {:.3e}, ", error.name, error.value));
                let Spread { count, .. } = measures.seconds;
                let spread = match count {
                    0 | 1 => String::new(),
                    count => format!(" (+- {:.0} % of {count})", measures.seconds.percent()),
                };
                format!("{}{}{spread}", errors.collect::<String>(), time(measures.seconds.median, task))
            }
            Self::Skipped(reason) => format!("skipped: {reason}"),
            Self::Failed(reason) => format!("failed: {reason}"),
        }
    }
}

/// A time in the unit that suits what is timed.
pub fn time(seconds: f64, task: Task) -> String {
    let (factor, unit) = time_unit(task);
    format!("{:.4} {unit}", seconds * factor)
}

/// The unit of times: how many there are in a second, and its name.
pub fn time_unit(task: Task) -> (f64, &'static str) {
    match task {
        Task::Run => (1.0, "s"),
        Task::Reconstruct => (1e3, "ms"),
        Task::Truncate | Task::Position => (1e9, "ns per cell"),
    }
}
