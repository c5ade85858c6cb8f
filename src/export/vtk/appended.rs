//! VTK XML with appended raw data: the header names each array and its place, the numbers follow.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::escaped;

/// Bytes of a number, and of the length that precedes each array.
const WORD: u64 = 8;

/// The numbers of an array, produced while they are written.
pub(super) enum Values<'a> {
    /// Floating-point numbers.
    Float(Box<dyn Iterator<Item = f64> + 'a>),
    /// Whole numbers: indices and offsets.
    Int(Box<dyn Iterator<Item = i64> + 'a>),
}

impl<'a> Values<'a> {
    pub(super) fn float(values: impl Iterator<Item = f64> + 'a) -> Self {
        Self::Float(Box::new(values))
    }

    pub(super) fn int(values: impl Iterator<Item = i64> + 'a) -> Self {
        Self::Int(Box::new(values))
    }

    /// Indices; those beyond the range of VTK (2^63) are limited to it.
    pub(super) fn index(values: impl Iterator<Item = usize> + 'a) -> Self {
        Self::int(values.map(|value| i64::try_from(value).unwrap_or(i64::MAX)))
    }
}

/// A VTK file under construction: the header so far, and the arrays that it announces.
pub(super) struct Document<'a> {
    header: String,
    open: Vec<&'static str>,
    arrays: Vec<(u64, Values<'a>)>,
    offset: u64,
}

impl<'a> Document<'a> {
    /// A file that holds one data set of this kind.
    pub(super) fn new(kind: &'static str) -> Self {
        let mut document = Self {
            header: "<?xml version=\"1.0\"?>\n".into(),
            open: Vec::new(),
            arrays: Vec::new(),
            offset: 0,
        };
        document.open(
            "VTKFile",
            &format!("type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\""),
        );
        document
    }

    /// Opens an element with these attributes.
    pub(super) fn open(&mut self, element: &'static str, attributes: &str) {
        let blank = if attributes.is_empty() { "" } else { " " };
        self.line(&format!("<{element}{blank}{attributes}>"));
        self.open.push(element);
    }

    /// Closes the element opened last.
    pub(super) fn close(&mut self) {
        if let Some(element) = self.open.pop() {
            self.line(&format!("</{element}>"));
        }
    }

    /// An array of `tuples` times `components` numbers.
    pub(super) fn array(&mut self, name: &str, components: usize, tuples: usize, values: Values<'a>) {
        let kind = match values {
            Values::Float(_) => "Float64",
            Values::Int(_) => "Int64",
        };
        self.line(&format!(
            "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"appended\" \
             offset=\"{}\"/>",
            escaped(name),
            self.offset
        ));
        let bytes = WORD * components as u64 * tuples as u64;
        self.offset += WORD + bytes;
        self.arrays.push((bytes, values));
    }

    fn line(&mut self, text: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.header, "{:1$}{text}", "", 2 * self.open.len());
    }

    /// Writes the header with all elements closed, then the numbers.
    pub(super) fn write(mut self, writer: &mut impl Write) -> io::Result<()> {
        while self.open.len() > 1 {
            self.close();
        }
        writer.write_all(self.header.as_bytes())?;
        writer.write_all(b"  <AppendedData encoding=\"raw\">\n_")?;
        for (bytes, values) in self.arrays {
            writer.write_all(&bytes.to_le_bytes())?;
            let written = match values {
                Values::Float(values) => write_words(writer, values.map(f64::to_le_bytes))?,
                Values::Int(values) => write_words(writer, values.map(i64::to_le_bytes))?,
            };
            if written != bytes {
                let message = format!("an array of {bytes} bytes was announced, {written} came");
                return Err(io::Error::new(io::ErrorKind::InvalidData, message));
            }
        }
        writer.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    }
}

fn write_words(writer: &mut impl Write, words: impl Iterator<Item = [u8; WORD as usize]>) -> io::Result<u64> {
    let mut bytes = 0;
    for word in words {
        writer.write_all(&word)?;
        bytes += WORD;
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::{Document, Values};

    #[test]
    fn an_array_of_another_length_than_announced_is_an_error() {
        for tuples in [1, 3] {
            let mut document = Document::new("PolyData");
            document.array("two", 1, tuples, Values::index([1, 2].into_iter()));
            let error = document.write(&mut Vec::new()).unwrap_err();
            assert!(error.to_string().contains("16 came"), "{error}");
        }
    }

    #[test]
    fn a_full_disk_is_reported() {
        struct Full(usize);
        impl std::io::Write for Full {
            fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
                let room = self.0.min(bytes.len());
                self.0 -= room;
                if room == 0 { Err(std::io::ErrorKind::StorageFull.into()) } else { Ok(room) }
            }
            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        let document = || {
            let mut document = Document::new("PolyData");
            document.array("x", 1, 2, Values::float([1.0, 2.0].into_iter()));
            document
        };
        let mut whole = Vec::new();
        document().write(&mut whole).unwrap();
        document().write(&mut Full(whole.len())).unwrap();
        for room in 0..whole.len() {
            let error = document().write(&mut Full(room)).unwrap_err();
            assert_eq!(error.kind(), std::io::ErrorKind::StorageFull, "{room}");
        }
    }
}
