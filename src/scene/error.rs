//! What is wrong with a scene, with the place in the file.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};

use super::quote::{Quoted, short};

/// A scene that cannot be run: what is wrong, where, and what would be right.
#[derive(Clone, Debug)]
pub struct SceneError(Box<Inner>);

#[derive(Clone, Debug)]
struct Inner {
    message: String,
    details: Vec<String>,
    help: String,
    place: Option<(Source, Range<usize>)>,
}

/// The text of a scene and the name of its file.
#[derive(Clone, Debug)]
pub struct Source {
    code: Arc<Quoted>,
    /// The text as it was before values were set in it.
    original: Option<Arc<Quoted>>,
}

impl Source {
    /// The text of the file with this name.
    pub fn new(name: impl AsRef<str>, text: impl Into<String>) -> Self {
        let code = NamedSource::new(name, text.into()).with_language("toml");
        Self { code: Arc::new(Quoted(code)), original: None }
    }

    /// The text with values set in it. Errors in lines that were there before point at the file.
    pub(super) fn changed(&self, text: String) -> Self {
        let name = format!("{} (with --set)", self.code.0.name());
        Self { original: Some(self.code.clone()), ..Self::new(name, text) }
    }

    /// The name of the file.
    pub(super) fn file(&self) -> &str {
        self.original.as_ref().unwrap_or(&self.code).0.name()
    }

    /// The path of a file that the text names relative to its own folder.
    pub(super) fn beside(&self, file: &str) -> PathBuf {
        Path::new(self.file()).parent().unwrap_or(Path::new("")).join(file)
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        self.code.0.inner()
    }

    /// An error at a range of bytes of the text.
    pub fn error(
        &self,
        place: Range<usize>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        let place = Some(self.in_original(&place).unwrap_or_else(|| (self.clone(), place)));
        let [message, help] = [short(message.into()), help.into()];
        SceneError(Box::new(Inner { message, details: Vec::new(), help, place }))
    }
}

impl Source {
    /// The place in the original text, if its lines are there, and in both texts once.
    fn in_original(&self, place: &Range<usize>) -> Option<(Self, Range<usize>)> {
        // What is missing is missing after the change.
        let original = self.original.as_ref().filter(|_| !place.is_empty())?;
        let text = self.text();
        let start = text.get(..place.start)?.rfind('\n').map_or(0, |end| end + 1);
        let end = place.end + text.get(place.end..)?.find('\n').unwrap_or(text.len() - place.end);
        let lines = text.get(start..end)?;
        only_place(text, lines)?;
        let shift = only_place(original.0.inner(), lines)?;
        let place = place.start - start + shift..place.end - start + shift;
        Some((Self { code: original.clone(), original: None }, place))
    }
}

/// Where a text has these lines, if it has them once.
fn only_place(text: &str, lines: &str) -> Option<usize> {
    let whole = |&(at, _): &(usize, &str)| {
        let rest = &text[at + lines.len()..];
        (at == 0 || text[..at].ends_with('\n')) && (rest.is_empty() || rest.starts_with('\n'))
    };
    let mut places = text.match_indices(lines).filter(whole);
    places.next().filter(|_| places.next().is_none()).map(|(at, _)| at)
}

impl SceneError {
    /// An error of the whole file, before there is a text to point at.
    pub(super) fn of_file(message: impl Into<String>, help: impl Into<String>) -> Self {
        let [message, help] = [message.into(), help.into()];
        Self(Box::new(Inner { message, details: Vec::new(), help, place: None }))
    }

    /// The error with a list of everything that it is about.
    #[must_use]
    pub(crate) fn with_details(mut self, details: Vec<String>) -> Self {
        self.0.details = details;
        self
    }

    /// What is wrong.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// Everything that the error is about, such as each unusable cell of the mesh; empty where the message says it all.
    pub fn details(&self) -> &[String] {
        &self.0.details
    }

    /// The line of the file, counted from 1.
    pub fn line(&self) -> Option<usize> {
        let (source, place) = self.0.place.as_ref()?;
        let before = source.text().get(..place.start)?;
        Some(before.matches('\n').count() + 1)
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.message)
    }
}

impl std::error::Error for SceneError {}

impl Diagnostic for SceneError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        (!self.0.help.is_empty()).then(|| Box::new(&self.0.help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.0.place.as_ref().map(|(source, _)| &*source.code as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let (source, place) = self.0.place.as_ref()?;
        let label = LabeledSpan::new(None, place.start, source.code.shown(place));
        Some(Box::new(std::iter::once(label)))
    }
}
