//! Lines, words and numbers of legacy VTK files.

use super::array::Kind;

/// A line has no more words that matter.
const MOST_WORDS: usize = 8;

/// A line that is not empty.
pub(super) struct Line<'a> {
    pub(super) start: usize,
    pub(super) words: Vec<&'a [u8]>,
    pub(super) whole: &'a [u8],
}

impl<'a> Line<'a> {
    /// A word in upper case.
    pub(super) fn keyword(&self, index: usize) -> String {
        self.words.get(index).map(|word| plain(word).to_ascii_uppercase()).unwrap_or_default()
    }

    pub(super) fn number<T: std::str::FromStr>(&self, index: usize) -> Option<T> {
        std::str::from_utf8(self.words.get(index)?).ok()?.parse().ok()
    }
}

/// What it says, as far as it is text.
pub(super) fn plain(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The bytes of a file, and what comes next.
pub(super) struct Text<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
    pub(super) binary: bool,
}

impl<'a> Text<'a> {
    /// The next line without its end; it may be empty.
    pub(super) fn raw_line(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += (length + 1).min(rest.len());
        Some(&rest[..length])
    }

    /// The next line with words.
    pub(super) fn line(&mut self) -> Option<Line<'a>> {
        loop {
            let start = self.at;
            let whole = self.raw_line()?.trim_ascii();
            if !whole.is_empty() {
                let words = whole.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
                return Some(Line { start, words: words.take(MOST_WORDS).collect(), whole });
            }
        }
    }

    /// Metadata end with an empty line.
    pub(super) fn skip_metadata(&mut self) {
        while self.raw_line().is_some_and(|line| !line.trim_ascii().is_empty()) {}
    }

    /// Goes behind so many numbers of a type.
    pub(super) fn skip(&mut self, kind: &str, count: usize) -> Result<(), String> {
        match (kind, self.binary) {
            ("string" | "utf8_string", _) => self.skip_strings(count),
            ("bit", true) => self.skip_bytes(count.div_ceil(8)),
            (_, true) => {
                let kind = Kind::parse(kind)
                    .ok_or_else(|| format!("has the type \"{kind}\", which is no type of numbers"))?;
                self.skip_bytes(count.checked_mul(kind.bytes()).ok_or("is too long")?)
            }
            (_, false) => self.skip_words(count),
        }
    }

    fn skip_bytes(&mut self, count: usize) -> Result<(), String> {
        let rest = self.bytes.len() - self.at;
        if count > rest {
            return Err(format!("announces {count} bytes, the file ends after {rest}"));
        }
        self.at += count;
        Ok(())
    }

    fn skip_words(&mut self, count: usize) -> Result<(), String> {
        for done in 0..count {
            let rest = &self.bytes[self.at..];
            let start = rest.iter().position(|byte| !byte.is_ascii_whitespace()).unwrap_or(rest.len());
            let word = &rest[start..];
            let word = &word[..word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len())];
            if word.is_empty() {
                return Err(format!("announces {count} numbers, the file ends after {done}"));
            }
            if !may_be_number(word) {
                return Err(format!("has the word {:?} after {done} of its {count} numbers", plain(word)));
            }
            self.at += start + word.len();
        }
        Ok(())
    }

    /// Lines, or bytes behind their number, which has one to eight bytes as the first two bits say.
    fn skip_strings(&mut self, count: usize) -> Result<(), String> {
        for done in 0..count {
            let ended = || format!("announces {count} strings, the file ends after {done}");
            if !self.binary {
                self.raw_line().ok_or_else(ended)?;
                continue;
            }
            let first = *self.bytes.get(self.at).ok_or_else(ended)?;
            let header = 8_usize >> (first >> 6);
            let bytes = self.bytes.get(self.at..self.at + header).ok_or_else(ended)?;
            let start = u64::from(first & 0x3f);
            let length = bytes[1..].iter().fold(start, |length, &byte| length << 8 | u64::from(byte));
            self.at += header;
            self.skip_bytes(usize::try_from(length).unwrap_or(usize::MAX))?;
        }
        Ok(())
    }
}

/// Whether a word starts like a number, so that it is not the line behind the numbers.
fn may_be_number(word: &[u8]) -> bool {
    let starts = |with: &[u8]| word.get(..3).is_some_and(|start| start.eq_ignore_ascii_case(with));
    matches!(word[0], b'0'..=b'9' | b'+' | b'-' | b'.') || starts(b"nan") || starts(b"inf")
}
