//! The study file.
//!
//! ```toml
//! name = "reversed_vortex"                      # of the study, and of its folder
//! about = "What is asked."                      # a sentence for the report
//! task = "run"                                  # or "reconstruct", "truncate", "position"
//! scene = "../scenes/reversed_vortex.toml"      # from the folder of the study file; for truncate and position: table = "cells.csv"
//! target = 1e-2                                 # the error that a recommendation stays below
//!
//! [set]                                         # settings of every run, as with --set; "" removes a key
//! "advection.courant" = 1.0
//!
//! [cross]                                       # every value with every other one
//! "mesh.cells" = [[32, 32], [64, 64]]           # any key of the scene;
//! threads = [1]                                 # and the number of threads; for truncate and position: method
//!
//! [variant.mesh]                                # one more list, of several settings each, by names
//! undistorted = {}
//! random = { "mesh.distortion.random.amplitude" = 0.2 }
//!
//! [average]                                     # errors are means over these
//! "mesh.distortion.random.seed" = [1, 2, 3]
//!
//! [quick]                                       # lists in place of those above, with --quick
//! "mesh.cells" = [[16, 16], [32, 32]]
//! mesh = ["undistorted"]
//!
//! [[skip]]                                      # combinations that are not run
//! mesh = "random"
//! because = "the scheme needs boxes of one size"
//!
//! [[reference]]                                 # published errors
//! label = "EMFPA"
//! source = "Lopez et al. 2004"
//! cells = 64                                    # along an axis
//! error = 6.58e-3
//! ```

use std::ops::Range;
use std::path::{Path, PathBuf};

use toml_edit::{Document, Item, Table, Value};

use super::plan::Combination;
use super::words::{Words, bare, key_place, label, place, setting, settings};
use crate::scene::{SceneError, Source, read_text};

/// Names of the lists that are no keys of a scene.
pub(super) const THREADS: &str = "threads";
pub(super) const METHOD: &str = "method";
/// The list that errors are plotted against.
pub(super) const CELLS: &str = "mesh.cells";

/// What is done with every combination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// The scene is run.
    Run,
    /// Its interface is reconstructed as it stands.
    Reconstruct,
    /// The cells of a table are truncated.
    Truncate,
    /// Planes are found in them.
    Position,
}

impl Task {
    const WORDS: [(&str, Self); 4] = [
        ("run", Self::Run),
        ("reconstruct", Self::Reconstruct),
        ("truncate", Self::Truncate),
        ("position", Self::Position),
    ];

    /// Whether a table of cells is what it works on.
    pub fn is_of_kernel(self) -> bool {
        matches!(self, Self::Truncate | Self::Position)
    }
}

/// A list of the product.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The key.
    pub key: String,
    /// Its values.
    pub choices: Vec<Choice>,
}

/// A value of a list.
#[derive(Clone, Debug)]
pub struct Choice {
    /// What it is called in the report.
    pub label: String,
    /// What it sets in the scene.
    pub settings: Vec<String>,
    /// Where it stands.
    pub place: Range<usize>,
}

/// Combinations that are not run.
#[derive(Clone, Debug)]
pub struct Skip {
    /// For some of the lists the labels that it is about.
    pub labels: Vec<(String, Vec<String>)>,
    /// Why.
    pub because: String,
}

/// A published error.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The method.
    pub label: String,
    /// Who published it.
    pub source: String,
    /// Cells along an axis.
    pub cells: f64,
    /// Which of the errors it is; the first one where that is not said.
    pub measure: Option<String>,
    /// Its value.
    pub error: f64,
}

/// A study file that was read.
#[derive(Clone, Debug)]
pub struct Study {
    /// The name of the study.
    pub name: String,
    /// What it is about.
    pub about: Option<String>,
    /// What is done.
    pub task: Task,
    /// The scene or the table.
    pub subject: PathBuf,
    /// The text of the scene; empty for tables.
    pub subject_text: String,
    /// Whether the short lists are taken.
    pub quick: bool,
    /// What is set in every run.
    pub settings: Vec<String>,
    /// The lists of the product.
    pub axes: Vec<Axis>,
    /// The lists that errors are averaged over.
    pub average: Vec<Axis>,
    /// What is not run.
    pub skips: Vec<Skip>,
    /// Published errors.
    pub references: Vec<Reference>,
    /// The error that a recommendation stays below.
    pub target: Option<f64>,
    pub(super) source: Source,
    path: PathBuf,
}

impl Study {
    /// Reads a study file.
    ///
    /// # Errors
    /// Whatever is wrong with it, with its place; a scene or table that is not there.
    pub fn load(path: impl AsRef<Path>, quick: bool) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let source = Source::new(path.display().to_string(), read_text(path, "study")?);
        let parsed = Document::parse(source.text().to_owned()).map_err(|error| {
            let help = "write it as TOML; the studies in `studies` are examples";
            source.error(error.span().unwrap_or(0..0), error.message().trim(), help)
        })?;
        let whole = 0..0;
        let words = Words { source: &source, table: parsed.as_table(), what: "a study", place: &whole };
        words.only(&[
            "name",
            "about",
            "task",
            "scene",
            "table",
            "target",
            "set",
            "cross",
            "variant",
            "average",
            "quick",
            "skip",
            "reference",
        ])?;
        let task = task(&words)?;
        let (subject, subject_text) = subject(&words, task, path)?;
        let name = name(&words, path)?;
        let (mut axes, mut average) = (axes(&words, task)?, averages(&words, task)?);
        if let Some(quick_table) = words.inner("quick")? {
            let place = key_place(words.table, "quick");
            let part = Words { table: quick_table, what: "[quick]", place: &place, ..words };
            shorten(&part, &mut axes, &mut average, quick)?;
        }
        let set = words.inner("set")?.map(settings).unwrap_or_default();
        let skips = words.tables("skip")?.into_iter().map(|table| skip(&words, table, &axes));
        let references = words.tables("reference")?.into_iter().map(|table| reference(&words, table));
        Ok(Self {
            name,
            about: words.text("about")?.map(str::to_owned),
            task,
            subject,
            subject_text,
            quick,
            settings: set,
            skips: skips.collect::<Result<_, _>>()?,
            references: references.collect::<Result<_, _>>()?,
            target: words.number("target")?,
            axes,
            average,
            path: path.to_owned(),
            source,
        })
    }

    /// The folder of the study file.
    pub fn folder(&self) -> PathBuf {
        folder(self.path.as_path())
    }

    /// The text of the study file.
    pub fn text(&self) -> &str {
        self.source.text()
    }

    /// A combination in words.
    pub fn title(&self, combination: &Combination) -> String {
        let parts =
            self.axes.iter().zip(&combination.labels).map(|(axis, label)| format!("{} {label}", axis.name()));
        parts.collect::<Vec<_>>().join(", ")
    }
}

impl Axis {
    /// The last word of the key.
    pub fn name(&self) -> &str {
        self.key.rsplit('.').next().unwrap_or_default()
    }
}

fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

fn task(words: &Words<'_>) -> Result<Task, SceneError> {
    let text = words.required("task")?;
    let known = Task::WORDS.iter().find(|(word, _)| *word == text);
    known.map(|(_, task)| *task).ok_or_else(|| {
        let names = Task::WORDS.map(|(word, _)| word).join(", ");
        words.error(
            place(words.table, "task"),
            format!("the task \"{text}\" is not known"),
            format!("known: {names}"),
        )
    })
}

/// The file that the study is about: it must be there.
fn subject(words: &Words<'_>, task: Task, path: &Path) -> Result<(PathBuf, String), SceneError> {
    let [key, other] = if task.is_of_kernel() { ["table", "scene"] } else { ["scene", "table"] };
    if words.table.contains_key(other) {
        return Err(words.wrong(other, format!("this task works on a `{key}`, not on a `{other}`")));
    }
    let subject = folder(path).join(words.required(key)?);
    let unreadable = |why: &dyn std::fmt::Display| {
        let message = format!("cannot read the {key} {}: {why}", subject.display());
        words.error(
            place(words.table, key),
            message,
            "name an existing file, as seen from the folder of the study file",
        )
    };
    if task.is_of_kernel() {
        std::fs::File::open(&subject).map_err(|error| unreadable(&error))?;
        return Ok((subject, String::new()));
    }
    let text = read_text(&subject, "scene").map_err(|error| unreadable(&error))?;
    Ok((subject, text))
}

fn name(words: &Words<'_>, path: &Path) -> Result<String, SceneError> {
    let fallback = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("study");
    let name = words.text("name")?.unwrap_or(fallback);
    let plain = |c: char| c.is_alphanumeric() || "_-+".contains(c);
    if name.chars().all(plain) {
        return Ok(name.to_owned());
    }
    Err(words.wrong("name", format!("a study cannot be called \"{name}\": its folder gets the same name")))
}

/// The lists of the product: those of [cross], then those of [variant].
fn axes(words: &Words<'_>, task: Task) -> Result<Vec<Axis>, SceneError> {
    let mut axes = Vec::new();
    if let Some(table) = words.inner("cross")? {
        let part = Words { table, what: "[cross]", ..*words };
        for (key, _) in table.iter() {
            axes.push(axis(&part, key, task)?);
        }
    }
    if let Some(table) = words.inner("variant")? {
        let part = Words { table, what: "[variant]", ..*words };
        for (key, _) in table.iter() {
            if axes.iter().any(|axis: &Axis| axis.key == key) {
                return Err(part.wrong(key, format!("`{key}` is a list of [cross] already")));
            }
            axes.push(variants(&part, key)?);
        }
    }
    if axes.is_empty() {
        let help = "add a [cross] section such as \"mesh.cells\" = [[32, 32], [64, 64]]";
        return Err(words.error(
            0..0,
            "the study crosses nothing: there is neither [cross] nor [variant]",
            help,
        ));
    }
    Ok(axes)
}

fn averages(words: &Words<'_>, task: Task) -> Result<Vec<Axis>, SceneError> {
    let Some(table) = words.inner("average")? else { return Ok(Vec::new()) };
    if task.is_of_kernel() {
        return Err(words.wrong("average", "errors over a table are means already"));
    }
    let part = Words { table, what: "[average]", ..*words };
    table.iter().map(|(key, _)| axis(&part, key, task)).collect()
}

fn axis(words: &Words<'_>, key: &str, task: Task) -> Result<Axis, SceneError> {
    if task.is_of_kernel() && key != METHOD {
        let message = format!("`{key}` is no list of this task");
        return Err(words.error(key_place(words.table, key), message, "cross `method`"));
    }
    let choices = words.list(key)?.into_iter().map(|value| choice(words, key, value));
    Ok(Axis { key: key.to_owned(), choices: choices.collect::<Result<_, _>>()? })
}

fn choice(words: &Words<'_>, key: &str, value: &Value) -> Result<Choice, SceneError> {
    let place = value.span().unwrap_or_default();
    let wrong = |message: &str| Err(words.error(place.clone(), message, "see the examples in `studies`"));
    let settings = match key {
        THREADS if !value.as_integer().is_some_and(|count| (1..=1024).contains(&count)) => {
            return wrong("a number of threads is a whole number from 1 to 1024");
        }
        METHOD if !value.is_str() => return wrong("a method is a text"),
        THREADS | METHOD => Vec::new(),
        _ => vec![setting(key, value)],
    };
    Ok(Choice { label: label(value), settings, place })
}

fn variants(words: &Words<'_>, key: &str) -> Result<Axis, SceneError> {
    let table = words.inner(key)?.filter(|table| !table.is_empty());
    let table = table.ok_or_else(|| words.wrong(key, format!("`{key}` has no variants")))?;
    let choice = |(name, item): (&str, &Item)| {
        let settings = item.as_table_like().map(settings);
        let message = format!("the variant `{name}` is not a table of settings");
        let settings =
            settings.ok_or_else(|| words.error(place(table, name), message, "write {} for none"))?;
        Ok(Choice { label: name.to_owned(), settings, place: key_place(table, name) })
    };
    Ok(Axis { key: key.to_owned(), choices: table.iter().map(choice).collect::<Result<_, SceneError>>()? })
}

/// Puts the lists of [quick] in the place of the long ones, or only checks them.
fn shorten(
    words: &Words<'_>,
    axes: &mut [Axis],
    average: &mut [Axis],
    quick: bool,
) -> Result<(), SceneError> {
    for (key, _) in words.table.iter() {
        let known = axes.iter_mut().chain(average.iter_mut()).find(|axis| axis.key == key);
        let axis =
            known.ok_or_else(|| words.wrong(key, format!("`{key}` of [quick] is no list of the study")))?;
        let named = |value: &Value| axis.choices.iter().find(|choice| choice.label == label(value)).cloned();
        let is_variant = axis.choices.iter().any(|choice| choice.settings != own(key, choice));
        let mut choices = Vec::new();
        for value in words.list(key)? {
            choices.push(match (named(value), is_variant) {
                (Some(choice), _) => choice,
                (None, false) => choice(words, key, value)?,
                (None, true) => {
                    let message = format!("there is no variant {} of `{key}`", bare(value));
                    return Err(words.error(
                        value.span().unwrap_or_default(),
                        message,
                        "name one of [variant]",
                    ));
                }
            });
        }
        if quick {
            axis.choices = choices;
        }
    }
    Ok(())
}

/// What a choice that is no variant sets: its own key or nothing.
fn own(key: &str, choice: &Choice) -> Vec<String> {
    if key == THREADS || key == METHOD {
        return Vec::new();
    }
    choice.settings.iter().filter(|setting| setting.starts_with(&format!("{key}="))).cloned().collect()
}

fn skip(words: &Words<'_>, table: &Table, axes: &[Axis]) -> Result<Skip, SceneError> {
    let place = table.span().unwrap_or_default();
    let part = Words { table, what: "[[skip]]", place: &place, ..*words };
    let because = part.required("because")?.to_owned();
    let mut labels = Vec::new();
    for (key, item) in table.iter().filter(|(key, _)| *key != "because") {
        if !axes.iter().any(|axis| axis.key == key) {
            return Err(part.wrong(key, format!("`{key}` of [[skip]] is no list of the study")));
        }
        let values = match item.as_value() {
            Some(Value::Array(list)) if list.iter().any(Value::is_str) => list.iter().map(label).collect(),
            Some(value) => vec![label(value)],
            None => Vec::new(),
        };
        labels.push((key.to_owned(), values));
    }
    if labels.is_empty() {
        return Err(part.wrong("because", "this [[skip]] names no list, and would skip everything"));
    }
    Ok(Skip { labels, because })
}

fn reference(words: &Words<'_>, table: &Table) -> Result<Reference, SceneError> {
    let place = table.span().unwrap_or_default();
    let part = Words { table, what: "[[reference]]", place: &place, ..*words };
    part.only(&["label", "source", "cells", "measure", "error"])?;
    let number = |key: &str| {
        let missing =
            || words.error(place.clone(), format!("missing key `{key}` in [[reference]]"), "give a number");
        part.number(key)?.ok_or_else(missing)
    };
    Ok(Reference {
        label: part.required("label")?.to_owned(),
        source: part.required("source")?.to_owned(),
        cells: number("cells")?,
        measure: part.text("measure")?.map(str::to_owned),
        error: number("error")?,
    })
}
