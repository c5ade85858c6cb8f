//! Scenes to start from, with every key explained: one text, filled in for each kind.

use clap::ValueEnum;

/// The text with `@name@` where the kinds differ.
const TEXT: &str = include_str!("template.toml");

/// Where comments after values start.
const COLUMN: usize = 29;

/// The kinds of scenes to start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// A disc carried along the diagonal.
    Disc,
    /// A sphere carried along the diagonal.
    Sphere,
    /// A disc drawn out by a vortex and brought back.
    Vortex,
}

/// The scene of a kind.
pub fn text(kind: Kind) -> String {
    let disc = [
        ("name", "my_disc"),
        ("what", "a disc carried along the diagonal of a square"),
        ("cells", "[30, 30]"),
        ("lower", "[0.0, 0.0]"),
        ("upper", "[10.0, 10.0]"),
        ("material", "disc"),
        ("shape", "{ disc = { centre = [2.5, 2.5], radius = 1.5 } }"),
        ("field", "{ uniform = { velocity = [1.0, 1.0] } }"),
        ("end", "5.0"),
        ("times", "[0.0, 2.5, 5.0]"),
        ("z", "# z = [\"wall\", \"wall\"]   # in three dimensions"),
    ];
    let sphere = [
        ("name", "my_sphere"),
        ("what", "a sphere carried along the diagonal of a cube"),
        ("cells", "[30, 30, 30]"),
        ("lower", "[0.0, 0.0, 0.0]"),
        ("upper", "[10.0, 10.0, 10.0]"),
        ("material", "sphere"),
        ("shape", "{ sphere = { centre = [2.5, 2.5, 2.5], radius = 1.5 } }"),
        ("field", "{ uniform = { velocity = [1.0, 1.0, 1.0] } }"),
        ("z", "# z = [\"wall\", \"wall\"]"),
    ];
    let vortex = [
        ("name", "my_vortex"),
        ("what", "a disc drawn out by a vortex and brought back"),
        ("cells", "[64, 64]"),
        ("upper", "[1.0, 1.0]"),
        ("shape", "{ disc = { centre = [0.5, 0.75], radius = 0.15 } }"),
        ("field", "{ reversed_vortex = { period = 8.0 } }"),
        ("end", "8.0"),
        ("times", "[0.0, 4.0, 8.0]"),
    ];
    let own: &[(&str, &str)] = match kind {
        Kind::Disc => &[],
        Kind::Sphere => &sphere,
        Kind::Vortex => &vortex,
    };
    // What a kind does not say is as in the first one.
    let filled = |text: &str| {
        own.iter()
            .chain(&disc)
            .fold(text.to_owned(), |text, (key, value)| text.replace(&format!("@{key}@"), value))
    };
    TEXT.lines().map(|line| aligned(line, filled) + "\n").collect()
}

/// A line filled in; the comment after a value stays in its column.
fn aligned(line: &str, filled: impl Fn(&str) -> String) -> String {
    match line.split_once("  #") {
        Some((value, comment)) if !value.starts_with('#') && value.contains('@') => {
            format!("{:<COLUMN$}#{}", filled(value.trim_end()), filled(comment))
        }
        _ => filled(line),
    }
}
