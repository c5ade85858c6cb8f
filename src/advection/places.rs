//! Some of many: a list of cells or nodes, and the place of each in it.

/// What is not in the list.
const NONE: u32 = u32::MAX;

/// A list of numbers below a limit, without repetition.
#[derive(Clone, Debug)]
pub(super) struct Places {
    place: Vec<u32>,
    items: Vec<u32>,
}

impl Places {
    /// None yet of this many.
    pub(super) fn new(limit: usize) -> Self {
        Self { place: vec![NONE; limit], items: Vec::new() }
    }

    /// The numbers, in the order in which they came.
    pub(super) fn items(&self) -> &[u32] {
        &self.items
    }

    /// The place of a number in the list.
    pub(super) fn of(&self, item: usize) -> Option<usize> {
        let place = self.place[item];
        (place != NONE).then_some(place as usize)
    }

    /// Empties the list.
    pub(super) fn clear(&mut self) {
        for &item in &self.items {
            self.place[item as usize] = NONE;
        }
        self.items.clear();
    }

    /// Adds a number unless it is there.
    pub(super) fn insert(&mut self, item: usize) {
        if self.place[item] == NONE {
            self.place[item] = self.items.len() as u32;
            self.items.push(item as u32);
        }
    }
}
