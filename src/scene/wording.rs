//! Names, and the messages of the TOML reader in the words of scene files.

use toml::Spanned;

use super::context::Context;
use super::error::{SceneError, Source};

/// The longest name of a scene or a material, in bytes: file systems allow 255 with what is appended.
const LONGEST_NAME: usize = 100;

/// Names of scenes and materials are short printable texts.
pub(super) fn check_text(what: &str, name: &Spanned<String>, context: Context<'_>) -> Result<(), SceneError> {
    let text = name.get_ref();
    let help = "give a name that is not empty, of printable characters and not too long";
    let fault = if text.trim().is_empty() {
        "is empty"
    } else if text.chars().any(char::is_control) {
        "holds a control character"
    } else if text.len() > LONGEST_NAME {
        "is longer than 100 bytes"
    } else {
        return Ok(());
    };
    Err(context.error(name.span(), format!("the name of {what} {fault}"), help))
}

/// The name of a scene is that of its folder, too.
pub(super) fn check_name(what: &str, name: &Spanned<String>, context: Context<'_>) -> Result<(), SceneError> {
    check_text(what, name, context)?;
    let text = name.get_ref();
    let plain = |c: char| c.is_alphanumeric() || "_-+.() ".contains(c);
    if text.chars().all(plain) && !text.starts_with(['.', ' ']) && !text.ends_with(['.', ' ']) {
        return Ok(());
    }
    Err(context.error(
        name.span(),
        format!("{what} cannot be called \"{text}\": its output folder gets the same name"),
        "use letters, digits, `_`, `-` and dots inside, such as \"disc_32\"",
    ))
}

/// What TOML or the types say, in the words of scene files.
pub(super) fn unreadable(source: &Source, error: &toml::de::Error) -> SceneError {
    let words = [
        ("f64", "a number"),
        ("i64", "a whole number"),
        ("u64", "a whole number of at least 0"),
        ("a sequence", "a list"),
        ("a map", "a table"),
        ("a boolean", "true or false"),
        ("sequence", "list"),
        ("map", "table"),
        ("floating point", "number"),
        ("variant", "word"),
        ("field", "key"),
    ];
    let message = match error.message() {
        "wanted exactly 1 element, more than 1 element" => {
            "one choice is wanted here, and there are several".to_owned()
        }
        message => {
            words.iter().fold(message.to_owned(), |message, (from, to)| replace_word(&message, from, to))
        }
    };
    source.error(error.span().unwrap_or(0..0), message, super::TEMPLATE_HELP)
}

/// Replaces whole words outside of backticks.
fn replace_word(text: &str, from: &str, to: &str) -> String {
    let parts = text.split('`').enumerate().map(|(place, part)| {
        if place % 2 == 1 {
            return part.to_owned();
        }
        let mut result = String::new();
        let mut rest = part;
        while let Some(at) = rest.find(from) {
            let end = at + from.len();
            let bounded = |c: Option<char>| c.is_none_or(|c| !c.is_alphanumeric());
            let whole = bounded(rest[..at].chars().next_back()) && bounded(rest[end..].chars().next());
            result.push_str(&rest[..at]);
            result.push_str(if whole { to } else { from });
            rest = &rest[end..];
        }
        result + rest
    });
    parts.collect::<Vec<_>>().join("`")
}
