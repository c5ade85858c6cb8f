//! No more of a text than people read.

use std::ops::Range;

use miette::{MietteError, MietteSpanContents, NamedSource, SourceCode, SourceSpan, SpanContents};

/// The most bytes that are shown of a text around a place, half of them for the place itself.
const AROUND: usize = 2000;

/// The most characters of a word in a message, of which so many are its last ones.
const WORD: usize = 300;
const ENDING: usize = 30;

/// A text with the name of its file, of which the surroundings of a place are shown.
#[derive(Debug)]
pub(super) struct Quoted(pub(super) NamedSource<String>);

impl Quoted {
    /// How many bytes of a place are shown.
    pub(super) fn shown(&self, place: &Range<usize>) -> usize {
        let most = place.start.saturating_add(AROUND / 2);
        if place.end <= most { place.len() } else { self.boundary(most) - place.start }
    }

    /// The last place up to `at` between two characters.
    fn boundary(&self, at: usize) -> usize {
        let text = self.0.inner();
        (0..=at).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0)
    }
}

impl SourceCode for Quoted {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let whole = self.0.read_span(span, lines_before, lines_after)?;
        let start = whole.span().offset();
        let end = start + whole.data().len();
        if end - start <= AROUND {
            return Ok(whole);
        }
        let from = self.boundary(span.offset().saturating_sub(AROUND / 2)).max(start);
        let to = self.boundary(from + AROUND).min(end);
        let text = self.0.inner();
        let line = whole.line() + text[start..from].matches('\n').count();
        let part = MietteSpanContents::new_named(
            self.0.name().to_owned(),
            &text.as_bytes()[from..to],
            (from, to - from).into(),
            line,
            whole.column(),
            text[from..to].lines().count(),
        );
        Ok(Box::new(part))
    }
}

/// A message with the middle of words left out that nobody reads.
pub(super) fn short(message: String) -> String {
    let is_long = |word: &&str| word.len() > WORD;
    if !message.split(' ').any(|word| is_long(&word)) {
        return message;
    }
    let shortened = |word: &str| {
        let characters: Vec<char> = word.chars().collect();
        match characters.len().checked_sub(ENDING) {
            Some(ending) if characters.len() > WORD => {
                let [first, last] =
                    [&characters[..WORD - ENDING], &characters[ending..]].map(String::from_iter);
                format!("{first}...{last}")
            }
            _ => word.to_owned(),
        }
    };
    message.split(' ').map(shortened).collect::<Vec<_>>().join(" ")
}
