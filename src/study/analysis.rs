//! What the results of a study say: series, orders of convergence, the front of what pays, and what noise hides.

use super::file::{CELLS, Study};
use super::measure::{Measures, Record, Spread, time};

/// A combination that has run, as far as its error and time are known.
#[derive(Clone, Copy, Debug)]
pub struct Point<'a> {
    /// The combination.
    pub record: &'a Record,
    /// What was measured.
    pub measures: &'a Measures,
    /// The error that counts.
    pub error: f64,
}

/// Combinations that differ in the mesh alone.
#[derive(Clone, Debug)]
pub struct Series<'a> {
    /// What they have in common.
    pub name: String,
    /// Those of them that have run, in the order of the plan.
    pub records: Vec<&'a Record>,
}

/// The combinations that have run, with the error of this name (the first one without a name).
pub fn points<'a>(records: &'a [Record], name: Option<&str>) -> Vec<Point<'a>> {
    let point = |record: &'a Record| {
        let measures = record.measures()?;
        let error = measures.error(name).filter(|error| error.is_finite())?;
        Some(Point { record, measures, error })
    };
    records.iter().filter_map(point).collect()
}

/// The results by everything but the number of cells; lists with one value are not named.
pub fn series<'a>(study: &Study, records: &'a [Record]) -> Vec<Series<'a>> {
    let named = |place: usize| study.axes[place].choices.len() > 1 && study.axes[place].key != CELLS;
    let mut all: Vec<(Vec<&str>, Series<'a>)> = Vec::new();
    for record in records.iter().filter(|record| record.measures().is_some()) {
        let labels = (0..study.axes.len()).filter(|&place| named(place));
        let labels: Vec<&str> = labels.map(|place| record.labels[place].as_str()).collect();
        match all.iter_mut().find(|(known, _)| *known == labels) {
            Some((_, series)) => series.records.push(record),
            None => {
                let name = labels.join(", ");
                all.push((labels, Series { name, records: vec![record] }));
            }
        }
    }
    all.into_iter().map(|(_, series)| series).collect()
}

/// A combination in few words: the labels of the lists that have several values.
pub fn short_title(study: &Study, record: &Record) -> String {
    let several = study.axes.iter().zip(&record.labels).filter(|(axis, _)| axis.choices.len() > 1);
    several.map(|(_, label)| label.as_str()).collect::<Vec<_>>().join(", ")
}

/// The order of convergence, `p` in `E ~ N^-p`: the slope of the least squares line through the logarithms of cells along an axis and
/// error. None with fewer than two different numbers of cells, or an error that is not above zero.
pub fn order(points: &[(f64, f64)]) -> Option<f64> {
    if !points.iter().all(|&(cells, error)| cells > 0.0 && error > 0.0) {
        return None;
    }
    let logs: Vec<(f64, f64)> = points.iter().map(|(cells, error)| (cells.ln(), error.ln())).collect();
    let count = logs.len() as f64;
    let [x, y] = [
        logs.iter().map(|log| log.0).sum::<f64>() / count,
        logs.iter().map(|log| log.1).sum::<f64>() / count,
    ];
    let (mut above, mut below) = (0.0, 0.0);
    for (a, b) in logs {
        above += (a - x) * (b - y);
        below += (a - x) * (a - x);
    }
    (below > 0.0).then(|| -above / below)
}

/// The combinations that no other one beats in both error and time, from the fastest to the most accurate.
pub fn front<'a>(points: &[Point<'a>]) -> Vec<Point<'a>> {
    let mut sorted = points.to_vec();
    let seconds = |point: &Point<'_>| point.measures.seconds.median;
    sorted.sort_by(|a, b| seconds(a).total_cmp(&seconds(b)).then(a.error.total_cmp(&b.error)));
    let mut front: Vec<Point<'a>> = Vec::new();
    for point in sorted {
        if front.last().is_none_or(|last| point.error < last.error) {
            front.push(point);
        }
    }
    front
}

/// Pairs of neighbours in time on and beside the front that noise does not let one rank: their times overlap. In words.
pub fn unranked(study: &Study, points: &[Point<'_>]) -> Vec<String> {
    let mut notes = Vec::new();
    for best in front(points) {
        let rivals = points.iter().filter(|other| {
            let Spread { count, .. } = other.measures.seconds;
            other.record.number != best.record.number
                && count > 1
                && other.error <= best.error
                && other.measures.seconds.overlaps(&best.measures.seconds)
        });
        let names: Vec<String> = rivals.map(|rival| short_title(study, rival.record)).collect();
        if !names.is_empty() {
            let title = short_title(study, best.record);
            notes.push(format!(
                "{title}: too noisy to say whether it is faster than {}, which err no more",
                names.join("; ")
            ));
        }
    }
    notes
}

/// The cheapest combination whose error is at most the target, and which others may be as cheap.
pub fn recommendation(study: &Study, records: &[Record], target: Option<f64>) -> String {
    let points = points(records, None);
    let (Some(first), Some(target)) = (points.first(), target) else {
        return match points.is_empty() {
            true => "No combination has run, so there is nothing to recommend.".to_owned(),
            false => "No target is given: name one with --target or in the study file for a recommendation."
                .to_owned(),
        };
    };
    let what = first.measures.errors.first().map_or("error", |error| &error.name);
    let reaching: Vec<Point<'_>> = points.iter().copied().filter(|point| point.error <= target).collect();
    let Some(best) = front(&reaching).first().copied() else {
        let nearest = points.iter().min_by(|a, b| a.error.total_cmp(&b.error)).unwrap_or(first);
        return format!(
            "No combination reaches {what} <= {target:e}; {} comes nearest with {:.3e}.",
            short_title(study, nearest.record),
            nearest.error
        );
    };
    let overlapping = |point: &&Point<'_>| {
        point.record.number != best.record.number && point.measures.seconds.overlaps(&best.measures.seconds)
    };
    let rivals: Vec<String> =
        reaching.iter().filter(overlapping).map(|rival| short_title(study, rival.record)).collect();
    let doubt = match rivals.is_empty() {
        true => String::new(),
        false => format!(" Times overlap, so that these may be as cheap: {}.", rivals.join("; ")),
    };
    format!(
        "For {what} <= {target:e} take {}: {:.3e} in {}.{doubt}",
        short_title(study, best.record),
        best.error,
        time(best.measures.seconds.median, study.task)
    )
}

#[cfg(test)]
mod tests {
    use super::super::measure::{Named, Outcome};
    use super::*;

    fn record(number: usize, error: f64, [lower, median, upper]: [f64; 3]) -> Record {
        let seconds = Spread { median, lower, upper, count: 3 };
        let measures = Measures { errors: vec![Named::new("E", error)], seconds, ..Measures::default() };
        Record { number, labels: vec![number.to_string()], outcome: Outcome::Done(Box::new(measures)) }
    }

    #[test]
    fn the_order_of_a_power_is_its_exponent() {
        let points: Vec<(f64, f64)> = [8.0, 16.0, 64.0].map(|n: f64| (n, 3.0 * n.powf(-1.7))).to_vec();
        let order = order(&points).unwrap();
        assert!((order - 1.7).abs() <= 1e-12, "{order}");
    }

    #[test]
    fn one_mesh_or_no_error_has_no_order() {
        assert_eq!(order(&[(8.0, 1.0)]), None);
        assert_eq!(order(&[(8.0, 1.0), (8.0, 0.5)]), None);
        assert_eq!(order(&[(8.0, 1.0), (16.0, 0.0)]), None);
        assert_eq!(order(&[(8.0, f64::NAN), (16.0, 1.0)]), None);
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let times = |t: f64| [t, t, t];
        let records = [
            record(0, 1e-2, times(1.0)),
            record(1, 2e-2, times(2.0)),
            record(2, 1e-3, times(3.0)),
            record(3, 1e-3, times(4.0)),
        ];
        let numbers: Vec<usize> =
            front(&points(&records, None)).iter().map(|point| point.record.number).collect();
        assert_eq!(numbers, [0, 2]);
    }

    #[test]
    fn the_median_lies_in_the_middle() {
        let spread = Spread::of(vec![3.0, 1.0, 2.0, 10.0]);
        assert_eq!((spread.median, spread.lower, spread.upper, spread.count), (2.5, 1.75, 4.75, 4));
        assert!(spread.overlaps(&Spread::of(vec![4.5])) && !spread.overlaps(&Spread::of(vec![5.0])));
        assert_eq!(Spread::of(Vec::new()), Spread::default());
    }
}
