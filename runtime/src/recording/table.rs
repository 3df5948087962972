//! Text tables, read in blocks.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::fields::{blanks_at, find, is_passed_over, no_text, split};
use super::format::Format;
use super::layout_guess::remedy;
use super::number::{Field, parse_field, plain_decimal};
use super::{Column, Layout, Reason, RecordingError, Rows};
use crate::regular_file;

/// Reads the wanted columns of a delimited text file block by block, so that text and numbers are never in memory
/// together.
///
/// Blank lines and lines that begin with `#` or `%` are passed over, as are a byte-order mark, carriage returns,
/// quotes and one delimiter at the end of a line. A row with a field that is no number, that is not finite, or
/// with another number of fields than the header (or the first row) is reported as a fault, not as an error.
pub struct TableReader<R = File> {
    file: String,
    layout: Layout,
    source: R,
    buffer: Vec<u8>,
    /// Unread text in `buffer`; it holds whole lines up to `whole`.
    start: usize,
    whole: usize,
    end: usize,
    at_end: bool,
    /// The file did not end with a line end.
    unterminated: bool,
    /// Lines passed so far.
    line: u64,
    /// For each column of the file up to the last wanted one: which wanted column it is.
    plan: Vec<Option<usize>>,
    /// Fields of a right row.
    fields: usize,
    /// How it is perhaps laid out, where it does not look as it should.
    remedy: Option<String>,
}

/// Bytes read at a time.
const BLOCK: usize = 1 << 18;
/// A line longer than this is cut; what is cut off counts as a row at fault.
const LONGEST_LINE: usize = 1 << 20;

impl TableReader<File> {
    /// Opens a file and finds the wanted columns. `file` is what messages call it.
    ///
    /// # Errors
    /// A file that cannot be read, an empty one, a column that is not there (the message names those
    /// that are), a name where there is no header.
    pub fn open(path: &Path, file: &str, layout: &Layout, wanted: &[Column]) -> Result<Self, RecordingError> {
        let source = regular_file::open(path).map_err(|e| RecordingError::io(path, &e))?;
        Self::new(source, file, layout, wanted)
    }
}

impl<R: Read> TableReader<R> {
    /// Reads from anything.
    ///
    /// # Errors
    /// As [`TableReader::open`].
    pub fn new(source: R, file: &str, layout: &Layout, wanted: &[Column]) -> Result<Self, RecordingError> {
        let mut reader = Self {
            file: file.into(),
            layout: layout.clone(),
            source,
            buffer: Vec::new(),
            start: 0,
            whole: 0,
            end: 0,
            at_end: false,
            unterminated: false,
            line: 0,
            plan: Vec::new(),
            fields: 0,
            remedy: None,
        };
        reader.fill()?;
        if reader.buffer[..reader.end].starts_with(&[0xef, 0xbb, 0xbf]) {
            reader.start = 3;
        }
        for _ in 0..layout.skip {
            if reader.next_line()?.is_none() {
                break;
            }
        }
        let first = reader.first_line()?;
        let names = split(&reader.buffer[first.0..first.1], layout.delimiter);
        reader.fields = names.len();
        let remedy = remedy(&reader.buffer[first.0..reader.whole], layout);
        reader.plan = plan(&names, wanted, layout.header).map_err(|message| {
            let remedy = remedy.as_ref().map_or_else(String::new, |remedy| format!("; {remedy}"));
            reader.error(reader.line, format!("{message}{remedy}"))
        })?;
        reader.remedy = remedy;
        if !layout.header {
            // The first line is a row.
            reader.start = first.0;
            reader.line -= 1;
        }
        Ok(reader)
    }

    /// The first line that says something, as a range of the buffer.
    fn first_line(&mut self) -> Result<(usize, usize), RecordingError> {
        loop {
            match self.next_line()? {
                None => return Err(self.error(1, "the file holds no rows".into())),
                Some((from, to)) if is_passed_over(&self.buffer[from..to]) => {}
                Some((from, to)) => {
                    return match no_text(&self.buffer[from..to]) {
                        Some(message) => Err(self.error(self.line, message.into())),
                        None => Ok((from, to)),
                    };
                }
            }
        }
    }

    fn error(&self, line: u64, message: String) -> RecordingError {
        RecordingError::Table { file: self.file.clone(), line, message }
    }

    /// What messages call the file.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Appends up to `most` rows to `rows`, which has one column per wanted column. Returns how many; 0 at the end.
    ///
    /// # Errors
    /// What the source says when it cannot be read.
    pub fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError> {
        let mut count = 0;
        while count < most {
            if self.start == self.whole && !self.fill()? {
                break;
            }
            while count < most && self.start < self.whole {
                self.line += 1;
                if self.take_row(rows) {
                    count += 1;
                }
            }
        }
        Ok(count)
    }

    /// Parses the line at `start` and moves behind it. False if it was no row.
    fn take_row(&mut self, rows: &mut Rows) -> bool {
        let text = &self.buffer[self.start..self.whole];
        let row = rows.len();
        if let Some(taken) = self.take_plain(text, rows) {
            rows.lines.push(self.line);
            self.start += taken;
            return true;
        }
        // Something unusual: undo, and take the line field by field.
        rows.columns.iter_mut().for_each(|c| c.truncate(row));
        let length = text.iter().position(|b| *b == b'\n').unwrap_or(text.len());
        let line = &text[..length];
        self.start += (length + 1).min(text.len());
        if is_passed_over(line) {
            return false;
        }
        let mut fault = None;
        let mut fields = 0;
        rows.columns.iter_mut().for_each(|c| c.push(f64::NAN));
        for (index, field) in split(line, self.layout.delimiter).into_iter().enumerate() {
            fields += 1;
            let Some(&Some(slot)) = self.plan.get(index) else { continue };
            match parse_field(field, self.layout.decimal) {
                Field::Number(value) => rows.columns[slot][row] = value,
                Field::NotFinite => fault = fault.or(Some((Reason::NotFinite, Some(index)))),
                Field::NotANumber => fault = fault.or(Some((Reason::NotANumber, Some(index)))),
            }
        }
        if fields != self.fields {
            let last = self.at_end && self.unterminated && self.start == self.whole;
            let reason = match (fields < self.fields, last) {
                (true, true) => Reason::CutOff,
                (true, false) => Reason::TooFewFields,
                (false, _) => Reason::WrongFieldCount,
            };
            fault = Some((reason, None));
        }
        if let Some((reason, index)) = fault {
            rows.faults.push((row, reason, index));
        }
        rows.lines.push(self.line);
        true
    }

    /// The common case in one pass: plain decimals, the right number of fields. Returns the bytes taken, with the
    /// line end; `None` if the line is anything else.
    #[inline]
    fn take_plain(&self, text: &[u8], rows: &mut Rows) -> Option<usize> {
        let (delimiter, point) = (self.layout.delimiter, self.layout.decimal);
        let blanks = delimiter == b' ';
        let mut at = if blanks { blanks_at(text) } else { 0 };
        if matches!(text.get(at), Some(b'#' | b'%')) {
            return None;
        }
        let mut field = 0;
        loop {
            match self.plan.get(field) {
                Some(Some(slot)) => {
                    let (value, taken) = plain_decimal(&text[at..], point)?;
                    rows.columns[*slot].push(value);
                    at += taken;
                }
                _ => {
                    let rest = &text[at..];
                    let stop = |b: &u8| *b == delimiter || *b == b'\n' || *b == b'\r' || *b == b'"';
                    at += rest.iter().position(stop)?;
                }
            }
            field += 1;
            match *text.get(at)? {
                b if b == delimiter => {
                    at += 1;
                    if blanks {
                        at += blanks_at(&text[at..]);
                    }
                    // One delimiter at the end of the line closes the last field.
                    if field == self.fields && matches!(text.get(at), Some(b'\n' | b'\r')) {
                        at += usize::from(text[at] == b'\r');
                        return (text.get(at) == Some(&b'\n')).then_some(at + 1);
                    }
                }
                b'\r' if text.get(at + 1) == Some(&b'\n') && field == self.fields => return Some(at + 2),
                b'\n' if field == self.fields => return Some(at + 1),
                _ => return None,
            }
        }
    }

    /// The next line as a range of the buffer, without its end.
    fn next_line(&mut self) -> Result<Option<(usize, usize)>, RecordingError> {
        if self.start == self.whole && !self.fill()? {
            return Ok(None);
        }
        let text = &self.buffer[self.start..self.whole];
        let length = text.iter().position(|b| *b == b'\n').unwrap_or(text.len());
        let range = (self.start, self.start + length);
        self.start += (length + 1).min(text.len());
        self.line += 1;
        Ok(Some(range))
    }

    /// Reads until the buffer holds at least one whole unread line; false at the end of the file.
    fn fill(&mut self) -> Result<bool, RecordingError> {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        self.whole = 0;
        let mut seen = 0;
        while !self.at_end {
            if self.buffer.len() < self.end + BLOCK {
                self.buffer.resize(self.end + BLOCK, 0);
            }
            let room = self.buffer.len() - 1;
            let got = match self.source.read(&mut self.buffer[self.end..room]) {
                Ok(got) => got,
                Err(e) if e.kind() == std::io::ErrorKind::Interrupted => continue,
                Err(e) => {
                    return Err(RecordingError::File { file: self.file.clone(), message: e.to_string() });
                }
            };
            self.end += got;
            if got == 0 {
                self.at_end = true;
                if self.end > 0 && self.buffer[self.end - 1] != b'\n' {
                    self.unterminated = true;
                    self.buffer[self.end] = b'\n';
                    self.end += 1;
                }
                self.whole = self.end;
            } else if let Some(last) = self.buffer[seen..self.end].iter().rposition(|b| *b == b'\n') {
                self.whole = seen + last + 1;
            } else if self.end >= LONGEST_LINE {
                self.buffer[self.end] = b'\n';
                self.end += 1;
                self.whole = self.end;
            }
            if self.whole > 0 {
                break;
            }
            seen = self.end;
        }
        Ok(self.whole > 0)
    }
}

impl<R: Read> Format for TableReader<R> {
    fn file(&self) -> &str {
        &self.file
    }

    fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError> {
        TableReader::read(self, rows, most)
    }

    fn remedy(&self) -> Option<String> {
        self.remedy.clone()
    }
}

/// For each column of the file up to the last wanted one: which wanted column it is.
fn plan(names: &[&[u8]], wanted: &[Column], header: bool) -> Result<Vec<Option<usize>>, String> {
    let indices = wanted.iter().map(|column| find(column, names, header)).collect::<Result<Vec<_>, _>>()?;
    let mut plan = vec![None; indices.iter().max().map_or(0, |m| m + 1)];
    for (slot, &index) in indices.iter().enumerate() {
        if plan[index].replace(slot).is_some() {
            return Err(format!("column {index} is asked for twice"));
        }
    }
    Ok(plan)
}

#[cfg(test)]
#[path = "table_tests.rs"]
mod tests;
