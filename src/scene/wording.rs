//! Names, and the messages of the TOML reader in the words of scene files.

use std::ops::Range;

use toml::Spanned;

use super::context::Context;
use super::error::{SceneError, Source};

/// The longest name of a scene or a material, in bytes: file systems allow 255 with what is appended.
const LONGEST_NAME: usize = 100;

/// How the reader of TOML starts its message about a word without its values.
const BARE_WORD: &str = "invalid type: unit variant, expected ";

/// Words that need values, and values for them.
const VALUES: &[(&[&str], &str)] = &[
    (&["random"], "{ amplitude = 0.2, seed = 1 }"),
    (&["wave"], "{ amplitude = 0.5 }"),
    (&["twist"], "{ angle = 0.5 }"),
    (&["smooth"], "{ swings = 1 }"),
    (&["rotate"], "{ centre = [..], angle = 1.0 }"),
    (&["nodes"], "[\"nodes.csv\"]"),
    (&["sphere", "disc"], "{ centre = [..], radius = 0.2 }"),
    (&["ellipsoid", "ellipse"], "{ centre = [..], semi_axes = [..] }"),
    (&["box", "rectangle"], "{ centre = [..], lengths = [..] }"),
    (&["half_space"], "{ normal = [..], constant = 0.5 }"),
    (&["cylinder"], "{ point = [..], axis = [..], radius = 0.2 }"),
    (&["slotted_disc"], "{ centre = [..], radius = 0.5, slot_width = 0.12, bridge = 0.4 }"),
    (&["union", "intersection", "difference"], "[ .., .. ]"),
    (&["uniform"], "{ velocity = [..] }"),
    (&["rotation"], "{ centre = [..], rate = 1.0 }"),
    (&["reversed_vortex", "deformation_3d", "cosine"], "{ period = 3.0 }"),
    (&["shear_3d"], "{ period = 3.0, speed = 1.0, radius = 0.5 }"),
    (&["flip"], "{ step = 100 }"),
    (&["file"], "{ path = \"flow.vts\" }"),
    (&["constant"], "{ value = 1.0 }"),
    (&["square_wave"], "{ from = 0.1, to = 0.4, value = 1.0 }"),
    (&["circular_wave"], "{ centre = [..], radius = 0.2, value = 1.0 }"),
    (&["sine"], "{ waves = [..], amplitude = 1.0 }"),
    (&["inclusions"], "{ shapes = [{ shape = { .. }, value = 1.0 }] }"),
];

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
    if error.message().starts_with(BARE_WORD) {
        return bare_word(source, error.span().unwrap_or(0..0));
    }
    let message = match error.message() {
        message if message.contains("struct variant ") || message.contains("newtype variant ") => {
            let (found, _) = message.split_once(", expected").unwrap_or((message, ""));
            format!("{found}, expected a table of values")
        }
        "wanted exactly 1 element, more than 1 element" => {
            "one choice is wanted here, and there are several".to_owned()
        }
        message => {
            words.iter().fold(message.to_owned(), |message, (from, to)| replace_word(&message, from, to))
        }
    };
    source.error(error.span().unwrap_or(0..0), message, super::TEMPLATE_HELP)
}

/// A word that stands alone where it needs values.
fn bare_word(source: &Source, place: Range<usize>) -> SceneError {
    let word = source.text().get(place.clone()).unwrap_or_default().trim_matches(['"', '\'']);
    let message = match VALUES.iter().find(|(words, _)| words.contains(&word)) {
        Some((_, values)) => format!("`{word}` needs values: {{ {word} = {values} }}"),
        None => format!("`{word}` needs values: {{ {word} = {{ .. }} }}"),
    };
    source.error(place, message, super::TEMPLATE_HELP)
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
