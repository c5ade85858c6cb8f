//! Tables as text.

use std::fs;

use crate::cli_support::Place;

/// A table as text, by rows and names.
pub(crate) struct Table {
    pub(crate) header: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn parse(text: &str) -> Self {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let fields = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect::<Vec<_>>();
        let header = fields(reader.headers().unwrap());
        Self { header, rows: reader.records().map(|record| fields(&record.unwrap())).collect() }
    }

    pub(crate) fn read(place: &Place, name: &str) -> Self {
        Self::parse(&fs::read_to_string(place.path(name)).unwrap())
    }

    pub(crate) fn at(&self, name: &str) -> usize {
        self.header.iter().position(|column| column == name).unwrap_or_else(|| panic!("no column {name}"))
    }

    pub(crate) fn column(&self, name: &str) -> Vec<&str> {
        let at = self.at(name);
        self.rows.iter().map(|row| row[at].as_str()).collect()
    }

    pub(crate) fn numbers(&self, name: &str) -> Vec<f64> {
        self.column(name).into_iter().map(|field| field.parse().unwrap()).collect()
    }

    pub(crate) fn without(mut self, names: &[&str]) -> Self {
        for name in names {
            let at = self.at(name);
            self.header.remove(at);
            self.rows.iter_mut().for_each(|row| drop(row.remove(at)));
        }
        self
    }

    pub(crate) fn text(&self) -> String {
        let lines = std::iter::once(&self.header).chain(&self.rows).map(|row| row.join(",") + "\n");
        lines.collect()
    }

    /// The largest coordinate, and the volume of the bounding box, of the nodes of a row.
    pub(crate) fn extent(&self, row: usize) -> (f64, f64) {
        let (mut far, mut volume) = (0.0_f64, 1.0);
        for axis in ["x", "y", "z"] {
            let x: Vec<f64> =
                (0..8).map(|i| self.rows[row][self.at(&format!("{axis}{i}"))].parse().unwrap()).collect();
            let [low, high] = [f64::min, f64::max].map(|end| x.iter().copied().reduce(end).unwrap());
            far = far.max(high.abs()).max(low.abs());
            volume *= high - low;
        }
        (far, volume)
    }
}
