//! What every section needs to turn its values into those of the toolkit.

use std::ops::Range;

use toml::Spanned;
use vofkit_geometry::Vector;

use super::error::{SceneError, Source};
use crate::tolerance::RANGE;

/// A list of numbers with its place in the file.
pub(super) type Numbers = Spanned<Vec<f64>>;

/// The scene's text, to point at what is wrong in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Context<'a> {
    pub(super) source: &'a Source,
}

/// A value that no place in the file has given.
pub(super) fn default<T>(value: T) -> Spanned<T> {
    Spanned::new(0..0, value)
}

impl Context<'_> {
    pub(super) fn error(
        self,
        place: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        self.source.error(place, message, help)
    }

    /// A finite number.
    pub(super) fn finite(self, what: &str, value: &Spanned<f64>) -> Result<f64, SceneError> {
        let number = *value.get_ref();
        if number.is_finite() {
            return Ok(number);
        }
        Err(self.error(
            value.span(),
            format!("{what} is {number}, not a finite number"),
            "give a finite number",
        ))
    }

    /// A finite number above zero, in the range of lengths and times.
    pub(super) fn positive(self, what: &str, value: &Spanned<f64>) -> Result<f64, SceneError> {
        let number = self.finite(what, value)?;
        if RANGE.contains(&number) {
            return Ok(number);
        }
        let (least, most) = (RANGE.start(), RANGE.end());
        let help = match number > 0.0 {
            true => format!("give a number from {least:e} to {most:e}"),
            false => "give a number above 0".to_owned(),
        };
        Err(self.error(value.span(), format!("{what} is {number:?}"), help))
    }

    /// As many finite numbers as there are dimensions.
    pub(super) fn vector<const D: usize>(
        self,
        what: &str,
        values: &Numbers,
    ) -> Result<Vector<D>, SceneError> {
        let list = values.get_ref();
        if list.len() != D {
            return Err(self.error(
                values.span(),
                format!("{what} is a list of {}, the mesh has {D} dimensions", list.len()),
                format!(
                    "give {D} numbers, one for each of {}, or change the number of `mesh.cells`",
                    &"x, y, z"[..3 * D - 2]
                ),
            ));
        }
        match list.iter().find(|c| !c.is_finite()) {
            None => Ok(Vector::from_fn(|k, _| list[k])),
            Some(odd) => Err(self.error(
                values.span(),
                format!("{what} holds {odd}, which is not a finite number"),
                "give finite numbers",
            )),
        }
    }

    /// The meaning of a word.
    pub(super) fn word<T: Copy>(
        self,
        what: &str,
        word: &Spanned<String>,
        known: &[(&str, T)],
    ) -> Result<T, SceneError> {
        let text = word.get_ref().as_str();
        if let Some(&(_, meaning)) = known.iter().find(|(name, _)| *name == text) {
            return Ok(meaning);
        }
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        Err(self.error(
            word.span(),
            format!("{what} \"{text}\" is not known"),
            format!("available: {}", names.join(", ")),
        ))
    }
}

/// The direction of an axis in space; not zero, and only in three dimensions.
pub(super) fn axis<const D: usize>(axis: &Numbers, context: Context<'_>) -> Result<Vector<3>, SceneError> {
    if D != 3 {
        return Err(context.error(
            axis.span(),
            "an axis is of use in three dimensions only",
            "leave it out: in two dimensions everything turns about z",
        ));
    }
    let direction: Vector<3> = context.vector("the axis", axis)?;
    if direction.amax() > 0.0 {
        return Ok(direction);
    }
    Err(context.error(
        axis.span(),
        "the axis has zero length",
        "give a direction in which at least one number is not 0",
    ))
}
