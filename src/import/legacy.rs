//! Legacy VTK files (`.vtk`): lines of words, and behind the line that names an array its numbers, as text or as big-endian bytes.
//!
//! [`parse`] finds out what there is and where, and says it as an XML file would, so that all that follows is the same for both. It goes
//! through the file once, takes no memory for a count before it has seen the numbers, and keeps only the arrays that are wanted.

use std::path::Path;

use super::document::{ArrayText, Document, Wanted, count_nodes};
use super::error::ImportError;
use super::legacy_text::{Line, Text, plain};

/// What the first line starts with.
const FIRST: &[u8] = b"# vtk DataFile Version ";

const REWRITE: &str = "write the file anew with its own program, as text or binary";
const CONVERT: &str = "convert it to a structured grid: DATASET STRUCTURED_GRID, or a .vts";
const SHORTEN: &str = "let it have as many numbers as it announces, one value for each node or cell";

/// Whether a file is a legacy one, or is meant to be.
pub(super) fn is_legacy(path: &Path, bytes: &[u8]) -> bool {
    let named_so = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("vtk"));
    bytes.starts_with(b"#") || named_so && !bytes.starts_with(b"<")
}

/// Takes a structured grid apart; arrays that are not wanted are passed over.
///
/// # Errors
/// What is no legacy file or no structured grid, a line that does not belong where it is, and counts that do not fit the grid or go
/// beyond the file.
pub(super) fn parse<'a>(
    path: &Path,
    bytes: &'a [u8],
    wanted: Wanted<'_>,
) -> Result<Document<'a>, ImportError> {
    let mut reader = Reader {
        path,
        text: Text { bytes, at: 0, binary: false },
        wanted,
        extent: None,
        section: None,
        arrays: Vec::new(),
        last: String::new(),
    };
    reader.head()?;
    while let Some(line) = reader.text.line() {
        reader.statement(&line)?;
    }
    let extent = reader.extent.ok_or_else(|| reader.wrong("it has no DIMENSIONS"))?;
    Ok(Document::bare(path, bytes, extent, reader.arrays))
}

/// A name, whose unusual bytes are written as `%20` and the like.
fn name(word: &[u8]) -> String {
    let digit = |at: usize| word.get(at).and_then(|&byte| char::from(byte).to_digit(16));
    let (mut bytes, mut at) = (Vec::new(), 0);
    while at < word.len() {
        match (word[at], digit(at + 1), digit(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                bytes.push((16 * high + low) as u8);
                at += 3;
            }
            (byte, ..) => {
                bytes.push(byte);
                at += 1;
            }
        }
    }
    plain(&bytes)
}

/// The XML name of a type of numbers; another one stays what it is.
fn kind(word: &[u8]) -> String {
    let word = plain(word).to_ascii_lowercase();
    match word.as_str() {
        "double" => "Float64",
        "float" => "Float32",
        "char" | "signed_char" => "Int8",
        "unsigned_char" => "UInt8",
        "short" => "Int16",
        "unsigned_short" => "UInt16",
        // Indices are written with four bytes, whatever they have in memory.
        "int" | "vtkidtype" => "Int32",
        "unsigned_int" => "UInt32",
        "long" | "vtktypeint64" => "Int64",
        "unsigned_long" | "vtktypeuint64" => "UInt64",
        other => other,
    }
    .to_owned()
}

struct Reader<'r, 'a> {
    path: &'r Path,
    text: Text<'a>,
    wanted: Wanted<'r>,
    /// The first and the last node along each axis.
    extent: Option<[i64; 6]>,
    /// Where the arrays are, and how many values each of them has.
    section: Option<(&'static str, usize)>,
    arrays: Vec<ArrayText>,
    /// The name of the array before.
    last: String,
}

/// What the line of an array says.
struct Announced {
    name: String,
    kind: String,
    components: usize,
    values: usize,
}

impl<'a> Reader<'_, 'a> {
    fn wrong(&self, problem: impl Into<String>) -> ImportError {
        ImportError::Grid { path: self.path.to_owned(), problem: problem.into(), help: REWRITE }
    }

    /// A line that is none of this format.
    fn unknown(&self, line: &Line<'_>) -> ImportError {
        let mut whole: String = plain(line.whole).chars().take(40).collect();
        if whole.len() < line.whole.len() {
            whole.push('…');
        }
        let behind =
            if self.last.is_empty() { String::new() } else { format!(", behind the array `{}`,", self.last) };
        self.wrong(format!(
            "the line {whole:?} at byte {}{behind} is none that belongs there in a legacy VTK file",
            line.start
        ))
    }

    /// The four lines in front.
    fn head(&mut self) -> Result<(), ImportError> {
        if !self.text.bytes.starts_with(FIRST) {
            return Err(
                self.wrong("it is no legacy VTK file: it does not start with \"# vtk DataFile Version\"")
            );
        }
        // Version and title say nothing that matters.
        self.text.raw_line();
        self.text.raw_line();
        let form = self.text.line().ok_or_else(|| self.wrong("it ends behind its title"))?;
        self.text.binary = match form.keyword(0).as_str() {
            "ASCII" => false,
            "BINARY" => true,
            other => return Err(self.wrong(format!("its third line is {other:?}, neither ASCII nor BINARY"))),
        };
        let set = self.text.line().ok_or_else(|| self.wrong("it has no DATASET"))?;
        match (set.keyword(0).as_str(), set.keyword(1).as_str()) {
            ("DATASET", "STRUCTURED_GRID") => Ok(()),
            ("DATASET", other) => Err(ImportError::Grid {
                path: self.path.to_owned(),
                problem: format!("it holds {other}, not a STRUCTURED_GRID"),
                help: CONVERT,
            }),
            _ => Err(self.unknown(&set)),
        }
    }

    /// A line with what follows it.
    fn statement(&mut self, line: &Line<'a>) -> Result<(), ImportError> {
        let keyword = line.keyword(0);
        match keyword.as_str() {
            "METADATA" => self.text.skip_metadata(),
            "DIMENSIONS" | "EXTENT" if self.extent.is_none() => {
                self.extent = Some(self.find_extent(line, &keyword)?)
            }
            "POINTS" => {
                let [nodes, _] = self.counts()?;
                self.check_count(line, nodes, "nodes")?;
                let kind = kind(line.words.get(2).ok_or_else(|| self.unknown(line))?);
                let points = Announced { name: String::new(), kind, components: 3, values: nodes };
                self.take("Points", points)?;
            }
            "POINT_DATA" => {
                let [nodes, _] = self.counts()?;
                self.check_count(line, nodes, "nodes")?;
                self.section = Some(("PointData", nodes));
            }
            "CELL_DATA" => {
                let [_, cells] = self.counts()?;
                self.check_count(line, cells, "cells")?;
                self.section = Some(("CellData", cells));
            }
            "FIELD" => {
                for _ in 0..line.number::<usize>(2).ok_or_else(|| self.unknown(line))? {
                    self.field_array()?;
                }
            }
            _ => {
                let (section, values) = self.section.ok_or_else(|| self.unknown(line))?;
                let (section, announced) =
                    self.attribute(line, section, values).ok_or_else(|| self.unknown(line))?;
                if keyword == "SCALARS" {
                    let table = self.text.line();
                    table.filter(|table| table.keyword(0) == "LOOKUP_TABLE").ok_or_else(|| {
                        self.array_error(&announced.name, "has no line LOOKUP_TABLE".to_owned(), REWRITE)
                    })?;
                }
                self.take(section, announced)?;
            }
        }
        Ok(())
    }

    fn find_extent(&self, line: &Line<'_>, keyword: &str) -> Result<[i64; 6], ImportError> {
        let number = |index: usize| line.number::<i64>(index + 1);
        let extent: Option<Vec<i64>> = if keyword == "EXTENT" {
            (0..6).map(number).collect()
        } else {
            (0..6).map(|end| if end % 2 == 0 { Some(0) } else { number(end / 2)?.checked_sub(1) }).collect()
        };
        let extent = extent.and_then(|extent| <[i64; 6]>::try_from(extent).ok());
        extent.filter(|extent| count_nodes(extent).is_some()).ok_or_else(|| {
            let words: Vec<String> = line.words[1..].iter().map(|word| plain(word)).collect();
            self.wrong(format!("its {keyword} \"{}\" count no nodes", words.join(" ")))
        })
    }

    /// Nodes and cells of the grid.
    fn counts(&self) -> Result<[usize; 2], ImportError> {
        let counts = self.extent.as_ref().and_then(count_nodes);
        let counts = counts.ok_or_else(|| self.wrong("it has no DIMENSIONS before its points and arrays"))?;
        Ok([counts.iter().product(), counts.iter().map(|&count| (count - 1).max(1)).product()])
    }

    fn check_count(&self, line: &Line<'_>, needed: usize, things: &str) -> Result<(), ImportError> {
        let announced: usize = line.number(1).ok_or_else(|| self.unknown(line))?;
        if announced == needed {
            return Ok(());
        }
        let keyword = line.keyword(0);
        Err(self.wrong(format!("its {keyword} announces {announced}, the grid has {needed} {things}")))
    }

    /// Name, type and number of components of an attribute, and where XML has it; those of colours mean none of the numbers that they have.
    fn attribute(
        &self,
        line: &Line<'_>,
        section: &'static str,
        values: usize,
    ) -> Option<(&'static str, Announced)> {
        let second = || line.words.get(2).map(|word| kind(word));
        let colour = || if self.text.binary { "UInt8" } else { "Float32" }.to_owned();
        let (section, kind, components, values) = match line.keyword(0).as_str() {
            "SCALARS" => {
                let components = if line.words.len() > 3 { line.number(3)? } else { 1 };
                (section, second()?, components, values)
            }
            "VECTORS" | "NORMALS" => (section, second()?, 3, values),
            "TENSORS" => (section, second()?, 9, values),
            "TENSORS6" => (section, second()?, 6, values),
            "GLOBAL_IDS" | "PEDIGREE_IDS" | "EDGE_FLAGS" => (section, second()?, 1, values),
            "TEXTURE_COORDINATES" => (section, kind(line.words.get(3)?), line.number(2)?, values),
            "COLOR_SCALARS" => ("Colours", colour(), line.number(2)?, values),
            "LOOKUP_TABLE" => ("Colours", colour(), 4, line.number(2)?),
            _ => return None,
        };
        Some((section, Announced { name: name(line.words.get(1)?), kind, components, values }))
    }

    /// The next array of a field.
    fn field_array(&mut self) -> Result<(), ImportError> {
        let line = loop {
            let line = self.text.line().ok_or_else(|| self.wrong("it ends within a FIELD"))?;
            match line.words[..] {
                [word] if word.eq_ignore_ascii_case(b"METADATA") => self.text.skip_metadata(),
                _ => break line,
            }
        };
        let announced = match (line.number(1), line.number(2), &line.words[..]) {
            (Some(components), Some(values), [word, _, _, type_word]) => {
                Announced { name: name(word), kind: kind(type_word), components, values }
            }
            _ => return Err(self.unknown(&line)),
        };
        let (section, values) = self.section.unwrap_or(("FieldData", announced.values));
        if announced.values != values && (self.wanted)(section, &announced.name) {
            let problem = format!("announces {} values, the grid needs {values}", announced.values);
            return Err(self.array_error(&announced.name, problem, SHORTEN));
        }
        self.take(section, announced)
    }

    fn array_error(&self, name: &str, problem: String, help: &'static str) -> ImportError {
        let array = if name.is_empty() { "Points" } else { name }.to_owned();
        ImportError::Array { path: self.path.to_owned(), array, problem, help }
    }

    /// Goes behind the numbers of an array, and keeps where they are if it is wanted.
    fn take(&mut self, section: &str, announced: Announced) -> Result<(), ImportError> {
        let Announced { name, kind, components, values } = announced;
        let start = self.text.at;
        let numbers = components.checked_mul(values).ok_or_else(|| "is too long".to_owned());
        let skipped = numbers.and_then(|numbers| self.text.skip(&kind, numbers));
        skipped.map_err(|problem| self.array_error(&name, problem, SHORTEN))?;
        if (self.wanted)(section, &name) {
            let text = &self.text.bytes[start..self.text.at];
            self.arrays.push(ArrayText {
                section: section.to_owned(),
                name: name.clone(),
                kind,
                components: components.to_string(),
                format: if self.text.binary { "appended" } else { "ascii" }.to_owned(),
                offset: start.to_string(),
                text: if self.text.binary { String::new() } else { plain(text) },
            });
        }
        self.last = if name.is_empty() { "Points".to_owned() } else { name };
        Ok(())
    }
}
