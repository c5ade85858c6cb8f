//! What the kernel says of a row.

use std::fmt::Write;

use vofkit_geometry::{Cell, HalfSpace, Hexahedron, TruncationMethod, Vector};

use super::Task;
use super::columns::{Given, QUANTITIES};
use super::error::RowError;
use super::input::Input;

/// The numbers of a row in the order of [`QUANTITIES`]; those that the method does not give, or that were not asked for,
/// are none.
#[derive(Clone, Debug, Default)]
pub(super) struct Values {
    pub(super) numbers: [Option<f64>; QUANTITIES.len()],
    /// Whether the plane constant has a closed form.
    pub(super) closed_form: bool,
}

impl Values {
    /// A number so that reading it gives the same one, in a buffer.
    pub(super) fn print<'a>(&self, quantity: usize, buffer: &'a mut String) -> &'a str {
        buffer.clear();
        if let Some(number) = self.numbers[quantity] {
            // Writing to a string cannot fail.
            let _ = match QUANTITIES[quantity] {
                // A count.
                "evaluations" => write!(buffer, "{number}"),
                _ => write!(buffer, "{number:?}"),
            };
        }
        buffer
    }
}

/// A cell and a plane through it, in the same place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) cell: Hexahedron,
    pub(super) half_space: HalfSpace<3>,
    /// Where the origin was before the cell was moved.
    shift: Vector<3>,
}

impl Cut {
    /// A cell in the place where its first node is the origin, and the plane with this constant there.
    fn at_origin(cell: &Hexahedron, normal: &Vector<3>, local: f64) -> Self {
        Self {
            cell: cell.relative_to_first_node(),
            half_space: HalfSpace { normal: *normal, constant: local },
            shift: cell.nodes()[0],
        }
    }

    /// A row, unless it asks for the plane.
    pub(super) fn given(input: &Input) -> Option<Self> {
        let cell = || Hexahedron::new(input.nodes);
        match input.given {
            Given::Local(local) => Some(Self::at_origin(&cell(), &input.normal, local)),
            Given::Constant(constant) => {
                let half_space = HalfSpace { normal: input.normal, constant };
                Some(Self { cell: cell(), half_space, shift: Vector::zeros() })
            }
            Given::Fraction(_) => None,
        }
    }

    /// The first moment in the coordinates of the table.
    pub(super) fn moment(&self) -> Vector<3> {
        self.cell.first_moment_about(&self.half_space, &-self.shift)
    }

    fn values(&self, method: TruncationMethod) -> Values {
        let cell = &self.cell;
        let truncation = method.truncate(cell, &self.half_space);
        let area = truncation.section_area.map(|area| area * length(&self.half_space.normal));
        let moment = (method == TruncationMethod::Exact).then(|| self.moment());
        let mut values = Values::default();
        let [x, y, z] = [0, 1, 2].map(|axis| moment.map(|moment| moment[axis]));
        let numbers = [Some(method.cell_volume(cell)), Some(truncation.volume), area, x, y, z];
        values.numbers[..numbers.len()].copy_from_slice(&numbers);
        values
    }
}

/// The length of a normal: the section is the derivative of the volume for a unit normal.
fn length(normal: &Vector<3>) -> f64 {
    let largest = normal.amax();
    largest * (normal / largest).norm()
}

/// Computes a row.
pub(super) fn evaluate(task: Task, input: &Input) -> Result<Values, RowError> {
    let values = match (task, Cut::given(input), input.given) {
        (Task::Truncate(method), Some(cut), _) => cut.values(method),
        (Task::Position(method), _, Given::Fraction(fraction)) => {
            let cell = Hexahedron::new(input.nodes);
            let found = cell.plane_constant(&input.normal, fraction, method).map_err(RowError::Position)?;
            // As a truncation with this constant sees it.
            let cut = Cut::at_origin(&cell, &input.normal, found.local_constant);
            let mut values = cut.values(TruncationMethod::Exact);
            // The plane may have been moved by the rounding of its constant.
            let [volume, truncated] = [0, 1].map(|quantity| values.numbers[quantity].unwrap_or(f64::NAN));
            let residual = truncated / volume - fraction;
            let numbers =
                [found.constant, found.local_constant, residual, found.evaluations as f64].map(Some);
            values.numbers[QUANTITIES.len() - numbers.len()..].copy_from_slice(&numbers);
            values.closed_form = found.closed_form;
            values
        }
        // Columns are looked up by task.
        _ => Values::default(),
    };
    let too_large = |(number, _): &(&Option<f64>, _)| number.is_some_and(|number| !number.is_finite());
    match values.numbers.iter().zip(QUANTITIES).find(too_large) {
        Some((_, name)) => Err(RowError::Overflow(name)),
        None => Ok(values),
    }
}
