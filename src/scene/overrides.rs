//! Values set on the command line: `key=value` with a dotted key, applied to the text of the scene.
//!
//! The changed text is then read like any other, so that a wrong value fails with the same message.

use toml_edit::{DocumentMut, InlineTable, Item, Key, Table, TableLike, Value};

use super::error::{SceneError, Source};

/// The text with every `key=value` set, in their order. A value is read as TOML, and as a string where it is none; an empty
/// value removes the key. Parts of a key are names, or places in a list counted from 0: `material.0.name`.
pub(super) fn apply(source: &Source, settings: &[String]) -> Result<String, SceneError> {
    let mut document: DocumentMut = source.text().parse().map_err(|error: toml_edit::TomlError| {
        source.error(error.span().unwrap_or(0..0), error.message().trim(), super::TEMPLATE_HELP)
    })?;
    for setting in settings {
        let wrong = |why: String| {
            SceneError::of_file(
                format!("cannot set `{setting}`: {why}"),
                "write --set key=value with a key of the scene, such as --set mesh.cells=[32,32] or \
                 --set material.0.name=water",
            )
        };
        let (path, value) = setting.split_once('=').ok_or_else(|| wrong("there is no `=`".to_owned()))?;
        let keys = Key::parse(path.trim()).map_err(|_| wrong(format!("`{path}` is not a dotted key")))?;
        let keys: Vec<&str> = keys.iter().map(Key::get).collect();
        if let [first, _, ..] = keys[..] {
            document.entry(first).or_insert(Item::Table(Table::new()));
        }
        set(document.as_table_mut(), &keys, parse(value.trim())).map_err(wrong)?;
    }
    Ok(document.to_string())
}

/// The value, or none to remove the key.
fn parse(text: &str) -> Option<Value> {
    (!text.is_empty()).then(|| text.parse().unwrap_or_else(|_| Value::from(text)))
}

fn set(table: &mut dyn TableLike, keys: &[&str], value: Option<Value>) -> Result<(), String> {
    let [key, rest @ ..] = keys else { return Err("the key is empty".to_owned()) };
    if rest.is_empty() {
        match (value, table.get_mut(key)) {
            (None, _) => drop(table.remove(key)),
            (Some(value), Some(Item::Value(old))) => replace(old, value),
            (Some(value), _) => drop(table.insert(key, Item::Value(value))),
        }
        return Ok(());
    }
    match table.entry(key).or_insert_with(|| Item::Value(InlineTable::new().into())) {
        Item::Table(table) => set(table, rest, value),
        Item::ArrayOfTables(list) => {
            let place = place(key, rest[0], list.len())?;
            let table = list.get_mut(place).ok_or("the list ended")?;
            set(table, &rest[1..], value)
        }
        Item::Value(inner) => set_in_value(key, inner, rest, value),
        Item::None => Err(format!("`{key}` is not there")),
    }
}

fn set_in_value(key: &str, outer: &mut Value, keys: &[&str], value: Option<Value>) -> Result<(), String> {
    match outer {
        Value::InlineTable(table) => set(table, keys, value),
        Value::Array(list) => {
            let place = place(key, keys[0], list.len())?;
            let entry = list.get_mut(place).ok_or("the list ended")?;
            match (&keys[1..], value) {
                ([], Some(value)) => replace(entry, value),
                ([], None) => drop(list.remove(place)),
                (rest, value) => return set_in_value(key, entry, rest, value),
            }
            Ok(())
        }
        _ => Err(format!("`{key}` is no table but a value, {}; set it as a whole", outer.to_string().trim())),
    }
}

fn place(list: &str, text: &str, length: usize) -> Result<usize, String> {
    let place = text.parse().ok().filter(|&place: &usize| place < length);
    place.ok_or_else(|| {
        format!("`{list}` is a list of {length}, counted from 0; `{text}` is not a place in it")
    })
}

/// Keeps the blanks and comments around the old value.
fn replace(old: &mut Value, mut new: Value) {
    *new.decor_mut() = old.decor().clone();
    *old = new;
}
