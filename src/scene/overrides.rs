//! Values set on the command line: `key=value` with a dotted key, applied to the text of the scene.
//!
//! The changed text is then read like any other, so that a wrong value fails with the same message.

use toml_edit::{DocumentMut, InlineTable, Item, Key, Table, TableLike, Value};

use super::error::{SceneError, Source};

/// The word that gives way to a table when a key in it is set, as in `mesh.distortion.wave.amplitude=0.2`.
const NONE: &str = "none";

/// The text with every `key=value` set, in their order. A value is read as TOML, and as a string where it does not look like
/// any; an empty value removes the key. Parts of a key are names, or places in a list counted from 0: `material.0.name`.
pub(super) fn apply(source: &Source, settings: &[String]) -> Result<String, SceneError> {
    let mut document: DocumentMut = source.text().parse().map_err(|error: toml_edit::TomlError| {
        source.error(error.span().unwrap_or(0..0), error.message().trim(), super::TEMPLATE_HELP)
    })?;
    for setting in settings {
        let wrong = |why: String| {
            SceneError::of_file(
                format!("cannot set `{setting}`: {why}"),
                "write --set key=value with a key of the scene, such as --set 'mesh.cells=[32,32]' or \
                 --set material.0.name=water",
            )
        };
        let (path, value) = setting.split_once('=').ok_or_else(|| wrong("there is no `=`".to_owned()))?;
        let keys = Key::parse(path.trim()).map_err(|_| wrong(format!("`{path}` is not a dotted key")))?;
        let keys: Vec<&str> = keys.iter().map(Key::get).collect();
        if let [first, _, ..] = keys[..] {
            document.entry(first).or_insert(Item::Table(Table::new()));
        }
        let value = parse(value.trim()).map_err(wrong)?;
        set(document.as_table_mut(), &keys, value).map_err(wrong)?;
    }
    Ok(document.to_string())
}

/// The value, or none to remove the key.
fn parse(text: &str) -> Result<Option<Value>, String> {
    let Some(first) = text.chars().next() else { return Ok(None) };
    match text.parse::<Value>() {
        Ok(value) => Ok(Some(value)),
        Err(error) if first.is_ascii_digit() || "[{\"'+-.".contains(first) => {
            let why = error.message().trim().replace('\n', ", ");
            let quoted = text.replace('"', "");
            Err(format!("the value is no TOML: {why} (a text would need quotes: '\"{quoted}\"')"))
        }
        Err(_) => Ok(Some(Value::from(text))),
    }
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
            match (&rest[1..], value) {
                ([], None) => drop(list.remove(place)),
                ([], Some(Value::InlineTable(new))) => *table = new.into_table(),
                ([], Some(_)) => {
                    return Err(format!(
                        "`{key}.{place}` is a whole section; set a key in it, such as {key}.{place}.name"
                    ));
                }
                (rest, value) => return set(table, rest, value),
            }
            Ok(())
        }
        Item::Value(inner) => {
            if inner.as_str() == Some(NONE) {
                replace(inner, InlineTable::new().into());
            }
            set_in_value(key, inner, rest, value)
        }
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
        _ => {
            let shown = outer.clone().decorated("", "");
            Err(format!("`{key}` is no table but a value, {shown}; set it as a whole"))
        }
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
