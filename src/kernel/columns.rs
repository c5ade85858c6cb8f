//! Which column is what.

use csv::StringRecord;
use vofkit_geometry::TruncationMethod;

use super::Task;
use super::error::ColumnsError;

/// What can be computed, in the order of the output: those of every task, then those of positions.
pub(super) const QUANTITIES: [&str; 10] = [
    "cell_volume",
    "truncated_volume",
    "section_area",
    "moment_x",
    "moment_y",
    "moment_z",
    "d",
    "local_constant",
    "residual",
    "evaluations",
];

/// How many of [`QUANTITIES`] every task computes; these may have references.
pub(super) const OF_ALL_TASKS: usize = 6;

/// The columns of the nodes and the normal.
const CELL: [&str; 27] = [
    "x0", "y0", "z0", "x1", "y1", "z1", "x2", "y2", "z2", "x3", "y3", "z3", "x4", "y4", "z4", "x5", "y5",
    "z5", "x6", "y6", "z6", "x7", "y7", "z7", "nx", "ny", "nz",
];

/// Where the plane is said, or what it leaves.
#[derive(Clone, Copy, Debug)]
pub(super) enum Given<T> {
    /// The plane constant.
    Constant(T),
    /// The one relative to the first node.
    Local(T),
    /// The fraction.
    Fraction(T),
}

/// Where a field of the output comes from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Field {
    /// From this place in the input.
    Input(usize),
    /// It is one of [`QUANTITIES`].
    Computed(usize),
}

/// The places of all columns.
#[derive(Debug)]
pub(super) struct Columns {
    /// How many there are.
    pub(super) count: usize,
    /// Those of the nodes and the normal.
    pub(super) cell: [usize; 27],
    /// That of the plane.
    pub(super) given: Given<usize>,
    /// That of a plane constant that must agree with the one in `given`.
    pub(super) agrees: Option<usize>,
    /// Those of references.
    pub(super) references: [Option<usize>; OF_ALL_TASKS],
    category: Option<usize>,
    output: Vec<Field>,
    header: Vec<String>,
}

impl Columns {
    /// Finds the columns that a task needs.
    pub(super) fn of(header: &StringRecord, task: Task) -> Result<Self, ColumnsError> {
        if header.iter().all(|name| name.trim().is_empty()) {
            return Err(ColumnsError::Empty);
        }
        let mut missing = Vec::new();
        let mut cell = [0; 27];
        for (place, name) in cell.iter_mut().zip(CELL) {
            match find(header, name)? {
                Some(at) => *place = at,
                None => missing.push(name.to_owned()),
            }
        }
        let constants = [find(header, "d")?, find(header, "local_constant")?];
        let fraction = find(header, "f")?;
        let (given, wanted, hint) = match task {
            Task::Truncate(_) => {
                let given = constants[1].map(Given::Local).or(constants[0].map(Given::Constant));
                let hint =
                    fraction.map(|_| "find planes for the fractions `f` with `vofkit kernel position`");
                (given, "d (or local_constant)", hint)
            }
            Task::Position(_) => {
                let hint = constants
                    .iter()
                    .any(Option::is_some)
                    .then_some("truncate with given planes by `vofkit kernel truncate`");
                (fraction.map(Given::Fraction), "f", hint)
            }
        };
        if given.is_none() {
            missing.push(wanted.to_owned());
        }
        let given = match given {
            Some(given) if missing.is_empty() => given,
            _ => {
                return Err(ColumnsError::Missing {
                    hint: hint.filter(|_| missing.len() == 1),
                    names: missing,
                });
            }
        };
        let mut references = [None; OF_ALL_TASKS];
        for (place, name) in references.iter_mut().zip(QUANTITIES) {
            *place = find(header, name)?;
        }
        let computed = match task {
            Task::Truncate(_) => &QUANTITIES[..OF_ALL_TASKS],
            Task::Position(_) => &QUANTITIES[..],
        };
        let names = || header.iter().map(str::trim);
        let quantity = |name: &str| computed.iter().position(|quantity| *quantity == name);
        let field = |(at, name)| quantity(name).map_or(Field::Input(at), Field::Computed);
        let mut output: Vec<Field> = names().enumerate().map(field).collect();
        for (quantity, name) in computed.iter().enumerate() {
            if find(header, name)?.is_none() {
                output.push(Field::Computed(quantity));
            }
        }
        Ok(Self {
            count: header.len(),
            cell,
            given,
            agrees: constants[0].filter(|_| matches!(given, Given::Local(_))),
            references,
            category: find(header, "category")?,
            output,
            header: header.iter().map(str::to_owned).collect(),
        })
    }

    /// The name of the column in a place of the input.
    pub(super) fn name(&self, at: usize) -> &str {
        self.header.get(at).map_or("", |name| name.trim())
    }

    /// The fields of a row of the output.
    pub(super) fn output(&self) -> &[Field] {
        &self.output
    }

    /// The first row of the output.
    pub(super) fn output_header(&self) -> impl Iterator<Item = &str> {
        self.output.iter().map(|field| match *field {
            Field::Input(at) => self.header.get(at).map_or("", String::as_str),
            Field::Computed(quantity) => QUANTITIES[quantity],
        })
    }

    /// The category of a row.
    pub(super) fn category<'a>(&self, record: &'a StringRecord) -> Option<&'a str> {
        record.get(self.category?)
    }

    /// Whether there is anything to compare with.
    pub(super) fn has_references(&self) -> bool {
        self.references.iter().any(Option::is_some)
    }
}

/// The place of a column, if there is one; an error if there are two.
pub(super) fn find(header: &StringRecord, name: &str) -> Result<Option<usize>, ColumnsError> {
    let mut places = header.iter().enumerate().filter(|(_, column)| column.trim() == name).map(|(at, _)| at);
    match (places.next(), places.next()) {
        (Some(first), Some(second)) => {
            Err(ColumnsError::Duplicate { name: name.to_owned(), places: [first + 1, second + 1] })
        }
        (first, _) => Ok(first),
    }
}

/// The quantities of [`QUANTITIES`] that a method leaves empty.
pub(super) fn left_empty(task: Task) -> &'static [&'static str] {
    match task {
        Task::Truncate(TruncationMethod::Kothe) => &QUANTITIES[2..OF_ALL_TASKS],
        Task::Truncate(TruncationMethod::Submesh2 | TruncationMethod::Submesh4) => {
            &QUANTITIES[3..OF_ALL_TASKS]
        }
        _ => &[],
    }
}
