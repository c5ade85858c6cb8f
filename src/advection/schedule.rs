//! The order of the sweeps of a step.

/// The order of sweeps within a step (Sect. 4.6 of the paper).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum SweepOrder {
    /// One sweep per axis, in an order that alternates from step to step.
    #[default]
    Alternating,
    /// Half the volumes along all axes but one, that one in the middle, then the rest in reverse: x/2, y, x/2; in 3D x/2, y/2, z,
    /// y/2, x/2. The axis in the middle changes from step to step.
    Symmetric,
}

/// The part of a flux that one sweep moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Share {
    Whole,
    FirstHalf,
    /// What the first half left.
    SecondHalf,
}

/// One sweep: its axis and its share of the volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Turn {
    pub(super) axis: usize,
    pub(super) share: Share,
}

/// The sweeps of a step.
pub(super) fn turns<const D: usize>(order: SweepOrder, step: usize) -> Vec<Turn> {
    let axes = sweep_order::<D>(step);
    let turn = |share: Share| move |&axis: &usize| Turn { axis, share };
    match order {
        SweepOrder::Alternating => axes.iter().map(turn(Share::Whole)).collect(),
        SweepOrder::Symmetric => {
            let (middle, outer) = axes.split_last().expect("there is at least one axis");
            let first = outer.iter().map(turn(Share::FirstHalf));
            let second = outer.iter().rev().map(turn(Share::SecondHalf));
            first.chain([Turn { axis: *middle, share: Share::Whole }]).chain(second).collect()
        }
    }
}

/// The axes in the order of a step's sweeps: all orders in turn, each followed by its reverse.
pub(crate) fn sweep_order<const D: usize>(step: usize) -> [usize; D] {
    let shift = step / 2 % D;
    std::array::from_fn(|i| {
        let i = if step.is_multiple_of(2) { i } else { D - 1 - i };
        if D == 2 { i } else { (i + shift) % D }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symmetric_sweeps_read_the_same_backwards() {
        for step in 0..6 {
            let turns = turns::<3>(SweepOrder::Symmetric, step);
            let axes: Vec<usize> = turns.iter().map(|turn| turn.axis).collect();
            let reversed: Vec<usize> = axes.iter().rev().copied().collect();
            assert_eq!(axes, reversed);
            assert_eq!(axes.len(), 5);
            assert!(turns[..2].iter().all(|turn| turn.share == Share::FirstHalf));
            assert_eq!(turns[2].share, Share::Whole);
            assert!(turns[3..].iter().all(|turn| turn.share == Share::SecondHalf));
        }
    }

    #[test]
    fn alternating_sweeps_come_in_every_order() {
        let mut orders: Vec<Vec<usize>> = (0..6)
            .map(|step| turns::<3>(SweepOrder::Alternating, step).iter().map(|turn| turn.axis).collect())
            .collect();
        orders.sort();
        orders.dedup();
        assert_eq!(orders.len(), 6);
    }
}
