//! Stiff and extreme cases in families, each with a statement of what must hold: drawn at random from a seed, judged, and the worst
//! one kept as a reproducer that `vofkit kernel` or `vofkit run` take as it is.
//!
//! - this file: families, and how their cases are worked through; [`case`]: inputs and verdicts;
//! - `cells`: cells and planes; `kernel`: what the geometry kernel owes them; `exact`: how near it comes to the `oracle`, which has twice
//!   its digits; `motion`: scenes, and what every run of them owes; `fields`: fractions that are none, and meshes that scenes cannot name;
//! - [`pages`]: the report.

pub mod case;
mod cells;
mod exact;
mod fields;
mod kernel;
mod motion;
mod oracle;
pub mod pages;
mod scenery;

use std::panic::{AssertUnwindSafe, catch_unwind};

use serde::Serialize;

use crate::parallel;
use case::{CaseFile, Input, Random, Verdict};

/// What is drawn and what must hold of it.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// The room and the name, such as `geometry/parts`.
    pub name: &'static str,
    /// What must hold.
    pub holds: &'static str,
    /// How many times fewer cases there are than of a cell and a plane, as each takes so much longer.
    weight: usize,
    draw: fn(&mut Random) -> Input,
    judge: fn(&Input) -> Verdict,
}

/// What became of a family.
#[derive(Clone, Debug, Serialize)]
pub struct Tally {
    /// The name.
    pub name: &'static str,
    /// What must hold.
    pub holds: &'static str,
    /// Cases.
    pub cases: usize,
    /// Those that fell short.
    pub failures: usize,
    /// The worst case.
    pub worst: Worst,
}

/// The worst case of a family.
#[derive(Clone, Debug, Serialize)]
pub struct Worst {
    /// What was wrong, relative to what is allowed: above 1 it falls short. None is worse than all, such as a panic.
    pub badness: Option<f64>,
    /// What was found.
    pub found: String,
    /// The case: a table for `vofkit kernel`, or a scene for `vofkit run` and a grid that it names.
    pub reproducer: Vec<CaseFile>,
}

/// All families.
pub fn families() -> Vec<Family> {
    [kernel::FAMILIES, exact::FAMILIES, fields::FAMILIES, motion::FAMILIES].concat()
}

/// Works through the cases of a family: `cases` of one that is a cell and a plane, fewer of others.
pub fn run(family: &Family, seed: u64, cases: usize) -> Tally {
    let count = cases.div_ceil(family.weight).max(1);
    let verdicts = parallel::map(count, |number| {
        let input = (family.draw)(&mut Random::new(seed, family.name, number));
        judged(family, &input)
    });
    let failures = verdicts.iter().filter(|verdict| !verdict.holds()).count();
    let worse = |a: &usize, b: &usize| verdicts[*a].rank().total_cmp(&verdicts[*b].rank()).then(b.cmp(a));
    let place = (0..count).max_by(worse).unwrap_or_default();
    let reproducer = (family.draw)(&mut Random::new(seed, family.name, place)).files();
    let Verdict { badness, found } = &verdicts[place];
    let badness = badness.is_finite().then_some(*badness);
    let worst = Worst { badness, found: found.clone(), reproducer };
    Tally { name: family.name, holds: family.holds, cases: count, failures, worst }
}

/// The verdict on a case; a panic is one.
fn judged(family: &Family, input: &Input) -> Verdict {
    let judged = catch_unwind(AssertUnwindSafe(|| (family.judge)(input)));
    judged.unwrap_or_else(|_| Verdict::broken("it panicked"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn family(judge: fn(&Input) -> Verdict) -> Family {
        Family {
            name: "test",
            holds: "numbers stay below 0.5",
            weight: 1,
            draw: |random| {
                Input::Number(random.within(0.0, 1.0), |number| vec![CaseFile::scene(format!("{number:?}"))])
            },
            judge,
        }
    }

    fn number(input: &Input) -> f64 {
        if let Input::Number(number, _) = input { *number } else { f64::NAN }
    }

    #[test]
    fn what_falls_short_is_counted_and_the_worst_is_kept() {
        let tally = run(&family(|input| Verdict::of(number(input), 0.5, "a number")), 1, 1000);
        assert!((450..=550).contains(&tally.failures), "{tally:?}");
        let worst: f64 = tally.worst.reproducer[0].text.parse().unwrap();
        assert!(worst > 0.99 && tally.worst.badness == Some(worst / 0.5), "{tally:?}");
    }

    #[test]
    fn panics_and_what_is_not_a_number_fall_short() {
        let panics =
            run(&family(|input| if number(input) > 0.9 { panic!("no") } else { Verdict::good("") }), 1, 100);
        assert!(
            panics.failures >= 3 && panics.worst.badness.is_none() && panics.worst.found == "it panicked"
        );
        let nan = run(&family(|_| Verdict::of(f64::NAN, 1.0, "")), 1, 10);
        assert!(nan.failures == 10 && nan.worst.badness.is_none(), "{nan:?}");
    }

    #[test]
    fn seeds_and_families_draw_their_own_cases() {
        let of = |seed: u64, name: &str| Random::new(seed, name, 3).within(0.0, 1.0);
        assert_eq!(of(1, "a"), of(1, "a"));
        assert!(of(1, "a") != of(2, "a") && of(1, "a") != of(1, "b"));
    }
}
