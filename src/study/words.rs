//! Parts of a study file, read with their places in it.

use std::ops::Range;

use toml_edit::{Item, Table, TableLike, Value};

use crate::scene::{SceneError, Source};

/// Where to learn what study files can say.
const HELP: &str = "the README says what a study file holds; those in `studies` are examples";

/// A table of a study file.
#[derive(Clone, Copy)]
pub(super) struct Words<'a> {
    pub(super) source: &'a Source,
    pub(super) table: &'a dyn TableLike,
    /// What it is, for messages.
    pub(super) what: &'a str,
    /// Where it is.
    pub(super) place: &'a Range<usize>,
}

/// The place of a key, as far as it has one.
pub(super) fn key_place(table: &dyn TableLike, key: &str) -> Range<usize> {
    table.key(key).and_then(toml_edit::Key::span).unwrap_or_default()
}

/// The place of a value, or else of its key.
pub(super) fn place(table: &dyn TableLike, key: &str) -> Range<usize> {
    table.get(key).and_then(Item::span).unwrap_or_else(|| key_place(table, key))
}

impl<'a> Words<'a> {
    pub(super) fn error(
        &self,
        place: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        self.source.error(place, message, help)
    }

    /// An error that one of the examples helps with.
    pub(super) fn wrong(&self, key: &str, message: impl Into<String>) -> SceneError {
        self.error(place(self.table, key), message, HELP)
    }

    /// Refuses keys that are not known.
    pub(super) fn only(&self, known: &[&str]) -> Result<(), SceneError> {
        let odd = self.table.iter().map(|(key, _)| key).find(|key| !known.contains(key));
        let Some(odd) = odd else { return Ok(()) };
        let message = format!("unknown key `{odd}` in {}", self.what);
        Err(self.error(key_place(self.table, odd), message, format!("known: {}", known.join(", "))))
    }

    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>, SceneError> {
        let Some(item) = self.table.get(key) else { return Ok(None) };
        let text = item.as_str().filter(|text| !text.trim().is_empty());
        text.map(Some).ok_or_else(|| self.wrong(key, format!("`{key}` is not a text, or an empty one")))
    }

    pub(super) fn required(&self, key: &str) -> Result<&'a str, SceneError> {
        let missing =
            || self.error(self.place.clone(), format!("missing key `{key}` in {}", self.what), HELP);
        self.text(key)?.ok_or_else(missing)
    }

    /// A number above zero.
    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, SceneError> {
        let Some(item) = self.table.get(key) else { return Ok(None) };
        let number = item.as_float().or_else(|| item.as_integer().map(|number| number as f64));
        let number = number.filter(|number| number.is_finite() && *number > 0.0);
        number.map(Some).ok_or_else(|| self.wrong(key, format!("`{key}` is not a number above 0")))
    }

    /// A table inside; none if it is not there.
    pub(super) fn inner(&self, key: &str) -> Result<Option<&'a dyn TableLike>, SceneError> {
        let Some(item) = self.table.get(key) else { return Ok(None) };
        item.as_table_like().map(Some).ok_or_else(|| self.wrong(key, format!("`{key}` is not a table")))
    }

    /// Tables in `[[double brackets]]`.
    pub(super) fn tables(&self, key: &str) -> Result<Vec<&'a Table>, SceneError> {
        let Some(item) = self.table.get(key) else { return Ok(Vec::new()) };
        let list = item.as_array_of_tables();
        list.map(|list| list.iter().collect())
            .ok_or_else(|| self.wrong(key, format!("`{key}` is not written as [[{key}]] sections")))
    }

    /// A list of values that is not empty.
    pub(super) fn list(&self, key: &str) -> Result<Vec<&'a Value>, SceneError> {
        let list = self.table.get(key).and_then(Item::as_array);
        let list =
            list.ok_or_else(|| self.wrong(key, format!("`{key}` is not a list of values to cross")))?;
        if list.is_empty() {
            return Err(self.wrong(key, format!("the list of `{key}` is empty, so nothing would be run")));
        }
        Ok(list.iter().collect())
    }
}

/// The settings `key=value` that a table stands for.
pub(super) fn settings(table: &dyn TableLike) -> Vec<String> {
    let of = |(key, item): (&str, &Item)| match item {
        Item::Table(inner) => {
            settings(inner).into_iter().map(|rest| format!("{}.{rest}", quoted(key))).collect()
        }
        item => item.as_value().map(|value| setting(key, value)).into_iter().collect(),
    };
    table.iter().flat_map(|entry| -> Vec<String> { of(entry) }).collect()
}

/// A key that may have dots in it already, unless it has characters that dotted keys have not.
fn quoted(key: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
    if key.chars().all(plain) { key.to_owned() } else { format!("'{key}'") }
}

/// `key=value` for one value; an empty text removes the key, as with --set.
pub(super) fn setting(key: &str, value: &Value) -> String {
    let text = if value.as_str() == Some("") { String::new() } else { bare(value) };
    format!("{}={text}", quoted(key))
}

/// A value as it is written in TOML, on one line.
pub(super) fn bare(value: &Value) -> String {
    value.clone().decorated("", "").to_string().replace('\n', " ")
}

/// A value as people read it.
pub(super) fn label(value: &Value) -> String {
    match value {
        Value::String(text) => text.value().clone(),
        Value::Array(list) if list.iter().all(Value::is_integer) => {
            list.iter().map(bare).collect::<Vec<_>>().join(" x ").replace('"', "")
        }
        value => bare(value).replace('"', ""),
    }
}
