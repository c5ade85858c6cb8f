//! Where labels stand beside points of a drawing so that none covers another label or a point, in pixels with y downwards.

/// The room of a letter and of a line of labels.
const LETTER: i32 = 7;
const LINE: i32 = 14;
/// From a point to what stands beside it; symbols are no larger.
const GAP: i32 = 6;
/// How many lines above or below its point a label may stand.
const LINES: i32 = 16;

/// A rectangle: left, top, right, bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Area([i32; 4]);

impl Area {
    fn around((x, y): (i32, i32)) -> Self {
        Self([x - GAP, y - GAP, x + GAP, y + GAP])
    }

    /// The pixels that both cover.
    fn overlap(&self, Self([left, top, right, bottom]): &Self) -> i64 {
        let [a, b, c, d] = self.0;
        let width = (c.min(*right) - a.max(*left)).max(0);
        let height = (d.min(*bottom) - b.max(*top)).max(0);
        i64::from(width) * i64::from(height)
    }

    fn size(&self) -> i64 {
        self.overlap(self)
    }
}

/// Finds places for labels, one after the other.
#[derive(Clone, Debug)]
pub(super) struct Labels {
    inside: Area,
    taken: Vec<Area>,
}

impl Labels {
    /// For a drawing between `[left, top]` and `[right, bottom]` with these points.
    pub(super) fn new(
        [left, top]: [i32; 2],
        [right, bottom]: [i32; 2],
        points: impl Iterator<Item = (i32, i32)>,
    ) -> Self {
        Self { inside: Area([left, top, right, bottom]), taken: points.map(Area::around).collect() }
    }

    /// The upper left corner of the label of a point, relative to it: the nearest place that is free, or the one that covers least.
    pub(super) fn place(&mut self, (x, y): (i32, i32), label: &str) -> (i32, i32) {
        let width = LETTER * label.chars().count() as i32;
        let offsets = (0..LINES).flat_map(|line| {
            let rows = [-LINE - LINE * line, LINE * line];
            rows.map(|dy| [GAP, -GAP - width].map(|dx| (dx, dy))).into_iter().flatten()
        });
        let covered = |&(dx, dy): &(i32, i32)| {
            let area = Area([x + dx, y + dy, x + dx + width, y + dy + LINE]);
            let outside = area.size() - area.overlap(&self.inside);
            outside + self.taken.iter().map(|taken| area.overlap(taken)).sum::<i64>()
        };
        let (dx, dy) = offsets.min_by_key(covered).unwrap_or((GAP, -LINE));
        self.taken.push(Area([x + dx, y + dy, x + dx + width, y + dy + LINE]));
        (dx, dy)
    }
}

/// Where a line from a point to its label ends, relative to the point; none for a label that is next to it.
pub(super) fn leader((dx, dy): (i32, i32)) -> Option<(i32, i32)> {
    let is_near = (-LINE..=0).contains(&dy);
    let x = if dx > 0 { dx } else { -GAP };
    (!is_near).then(|| (x, if dy < 0 { dy + LINE - 2 } else { dy + 4 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_cover_neither_one_another_nor_points() {
        let points: Vec<(i32, i32)> = (0..12).map(|k| (300 + 3 * k, 200 + 5 * (k % 3))).collect();
        let mut labels = Labels::new([0, 0], [700, 500], points.iter().copied());
        let label = "64 x 64, lvira, sweeps";
        for &(x, y) in &points {
            let (dx, dy) = labels.place((x, y), label);
            assert!(dx > 0 || dx < -LETTER * label.len() as i32, "{dx}");
            assert_eq!(leader((dx, dy)).is_none(), (-LINE..=0).contains(&dy));
        }
        let areas = &labels.taken;
        assert_eq!(areas.len(), 24);
        for (i, area) in areas.iter().enumerate().skip(12) {
            assert_eq!(area.overlap(&labels.inside), area.size(), "{area:?} is not inside");
            for other in &areas[..i] {
                assert_eq!(area.overlap(other), 0, "{area:?} covers {other:?}");
            }
        }
    }

    #[test]
    fn a_single_label_stands_beside_its_point_and_inside() {
        let place = |x: i32| Labels::new([0, 0], [400, 300], [(x, 100)].into_iter()).place((x, 100), "lvira");
        assert_eq!((place(50), place(395)), ((GAP, -LINE), (-GAP - 5 * LETTER, -LINE)));
        assert_eq!(leader(place(50)), None);
    }
}
