//! A table in pieces: what is in memory does not grow with the file.

use std::cell::Cell;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use csv::StringRecord;

use super::error::{KernelError, RowError};

/// The longest row, in bytes. What is not a table may have no line breaks at all.
const LONGEST: usize = 1 << 20;

/// A table that is being read.
pub(super) struct Rows {
    path: PathBuf,
    reader: csv::Reader<Limited>,
    /// Bytes that may still be read before the row is too long.
    allowance: Rc<Cell<usize>>,
    header: StringRecord,
}

impl Rows {
    /// Opens a table and reads its header.
    pub(super) fn open(path: &Path) -> Result<Self, KernelError> {
        let unreadable = |error| KernelError::Read { path: path.to_owned(), error };
        let file = File::open(path).map_err(unreadable)?;
        if file.metadata().map_err(unreadable)?.is_dir() {
            return Err(unreadable(io::ErrorKind::IsADirectory.into()));
        }
        let allowance = Rc::new(Cell::new(LONGEST));
        let limited = Limited { file, allowance: Rc::clone(&allowance), open_line: false };
        // The header is the first record to this reader; rows of other lengths are refused later, with better words. A
        // carriage return at the end of a line is left to `next`: only so does the reader count lines right.
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .terminator(csv::Terminator::Any(b'\n'))
            .from_reader(limited);
        let mut rows = Self { path: path.to_owned(), reader, allowance, header: StringRecord::new() };
        let mut header = StringRecord::new();
        rows.next(&mut header)?;
        rows.header = header;
        Ok(rows)
    }

    /// The names of the columns; none if the file is empty.
    pub(super) fn header(&self) -> &StringRecord {
        &self.header
    }

    /// Reads the next rows, `most` of them unless the table ends. The rows before an error are good.
    pub(super) fn fill(&mut self, chunk: &mut Vec<StringRecord>, most: usize) -> Result<(), KernelError> {
        let mut used = 0;
        let done = loop {
            if used == most {
                break Ok(());
            }
            if used == chunk.len() {
                chunk.push(StringRecord::new());
            }
            match self.next(&mut chunk[used]) {
                Ok(true) => used += 1,
                Ok(false) => break Ok(()),
                Err(error) => break Err(error),
            }
        };
        chunk.truncate(used);
        done
    }

    /// The error for a problem in a row.
    pub(super) fn error_at(&self, record: &StringRecord, problem: RowError) -> KernelError {
        let line = record.position().map_or(0, csv::Position::line);
        KernelError::Row { path: self.path.clone(), line, problem }
    }

    fn next(&mut self, record: &mut StringRecord) -> Result<bool, KernelError> {
        loop {
            self.allowance.set(LONGEST);
            match self.reader.read_record(record) {
                Ok(true) => {}
                Ok(false) => return Ok(false),
                Err(error) => return Err(self.error_of(error)),
            }
            settle(record, self.reader.position().line());
            let blank = record.len() == 1 && record.get(0) == Some("");
            if !blank {
                return Ok(true);
            }
        }
    }

    fn error_of(&self, error: csv::Error) -> KernelError {
        let end = self.reader.position().line();
        let row = |line, problem| KernelError::Row { path: self.path.clone(), line, problem };
        match error.kind() {
            _ if self.allowance.get() == 0 => row(end, RowError::Long(LONGEST)),
            csv::ErrorKind::Utf8 { pos, .. } => row(start(pos.as_ref(), end, 0), RowError::Encoding),
            _ => KernelError::Read { path: self.path.clone(), error: error.into() },
        }
    }
}

/// The line where a row starts, for the line after its end and the line breaks inside: the reader skips blank lines, but
/// begins with them.
fn start(begin: Option<&csv::Position>, end: u64, inside: u64) -> u64 {
    let begin = begin.map_or(1, csv::Position::line);
    begin.max(end.saturating_sub(inside + 1))
}

/// Corrects the line of a record, and removes the carriage return of a line end of Windows.
fn settle(record: &mut StringRecord, end: u64) {
    if let Some(mut position) = record.position().cloned() {
        if end > position.line() + 1 {
            let inside = record.as_slice().bytes().filter(|&byte| byte == b'\n').count() as u64;
            position.set_line(start(Some(&position), end, inside));
        }
        let last = record.len().saturating_sub(1);
        if record.get(last).is_some_and(|field| field.ends_with('\r')) {
            let fields = record.iter().enumerate();
            *record = fields
                .map(|(at, field)| if at == last { field.strip_suffix('\r').unwrap_or(field) } else { field })
                .collect();
        }
        record.set_position(Some(position));
    }
}

/// A file that ends with an error when more is read than is allowed, and else with a line break.
struct Limited {
    file: File,
    allowance: Rc<Cell<usize>>,
    open_line: bool,
}

impl Read for Limited {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let allowed = self.allowance.get();
        if allowed == 0 {
            return Err(io::Error::other("a row is too long"));
        }
        let most = buffer.len().min(allowed);
        let mut read = self.file.read(&mut buffer[..most])?;
        if read == 0 && most > 0 && self.open_line {
            (buffer[0], read) = (b'\n', 1);
        }
        if read > 0 {
            self.open_line = buffer[read - 1] != b'\n';
        }
        self.allowance.set(allowed - read);
        Ok(read)
    }
}
