//! How a text file is laid out, by its first lines.

use std::path::Path;

use super::fields::{is_passed_over, split};
use super::{Layout, RecordingError};
use crate::regular_file;

/// Bytes and lines that are looked at.
const BYTES: u64 = 1 << 16;
const LINES: usize = 30;

/// A layout, the names of the columns, and whether it is another one than the default.
pub(super) struct Guess {
    pub layout: Layout,
    pub names: Option<Vec<String>>,
    pub unusual: bool,
}

/// The layout of a file.
pub(super) fn of_file(path: &Path, file: &str) -> Result<Guess, RecordingError> {
    let text = beginning(path).map_err(|e| RecordingError::io(path, &e))?;
    guess(&text).ok_or_else(|| RecordingError::File {
        file: file.into(),
        message: "no rows of numbers are found in it, whatever separates them".into(),
    })
}

fn beginning(path: &Path) -> std::io::Result<Vec<u8>> {
    use std::io::Read;
    let mut text = Vec::new();
    regular_file::open(path)?.take(BYTES).read_to_end(&mut text)?;
    if text.len() as u64 == BYTES {
        // The last line may be cut.
        let end = text.iter().rposition(|b| *b == b'\n').unwrap_or(text.len());
        text.truncate(end);
    }
    Ok(text)
}

/// Fields of a row.
pub(super) fn fields(path: &Path, layout: &Layout) -> usize {
    let text = beginning(path).unwrap_or_default();
    lines(&text).first().map_or(0, |line| split(line, layout.delimiter).len())
}

fn lines(text: &[u8]) -> Vec<&[u8]> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    text.split(|b| *b == b'\n').filter(|line| !is_passed_over(line)).take(LINES).collect()
}

fn is_number(field: &[u8], decimal: u8) -> bool {
    let Ok(text) = std::str::from_utf8(field.trim_ascii()) else { return false };
    if decimal != b'.' && text.contains('.') {
        return false;
    }
    text.replace(char::from(decimal), ".").parse::<f64>().is_ok()
}

/// The layout in which most fields of the rows are numbers; of equal ones that with a point, then the one with more
/// columns. `None` where no row has two numbers.
pub(super) fn guess(text: &[u8]) -> Option<Guess> {
    let lines = lines(text);
    let mut best: Option<(usize, usize, Layout)> = None;
    for (delimiter, decimal) in
        [(b',', b'.'), (b';', b'.'), (b'\t', b'.'), (b' ', b'.'), (b';', b','), (b'\t', b','), (b' ', b',')]
    {
        let rows: Vec<Vec<&[u8]>> = lines.iter().map(|line| split(line, delimiter)).collect();
        let columns = rows.last().map_or(0, Vec::len);
        let right = |row: &&Vec<&[u8]>| row.len() == columns && row.iter().all(|f| is_number(f, decimal));
        let numbers = rows.iter().skip(1).filter(right).count();
        if columns < 2 || numbers == 0 {
            continue;
        }
        let header = !rows.first().is_some_and(|row| row.iter().any(|f| is_number(f, decimal)));
        let better = best.as_ref().is_none_or(|(n, c, _)| numbers > *n || (numbers == *n && columns > *c));
        if better {
            best = Some((numbers, columns, Layout { header, delimiter, decimal, skip: 0 }));
        }
    }
    let (_, _, layout) = best?;
    let name =
        |field: &&[u8]| String::from_utf8_lossy(field.trim_ascii()).trim_matches('"').trim().to_owned();
    let names = layout.header.then(|| split(lines[0], layout.delimiter).iter().map(name).collect());
    Some(Guess { unusual: layout != Layout::default(), layout, names })
}

/// The option of `layout` that mends a text, where its beginning looks as if it were laid out otherwise.
pub(super) fn remedy(text: &[u8], layout: &Layout) -> Option<String> {
    let found = guess(text)?.layout;
    let same =
        (found.delimiter, found.decimal, found.header) == (layout.delimiter, layout.decimal, layout.header);
    if same || layout.skip > 0 {
        return None;
    }
    Some(format!("its lines look like `{}`", found.yaml()))
}

impl Layout {
    /// As a recording YAML says it.
    pub fn yaml(&self) -> String {
        let byte = |b: u8| if b == b'\t' { "\\t".to_owned() } else { char::from(b).to_string() };
        let decimal = if self.decimal == b'.' {
            String::new()
        } else {
            format!(", decimal: \"{}\"", byte(self.decimal))
        };
        let skip = if self.skip == 0 { String::new() } else { format!(", skip: {}", self.skip) };
        format!("layout: {{header: {}, delimiter: \"{}\"{decimal}{skip}}}", self.header, byte(self.delimiter))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delimiter_decimal_comma_and_header_are_found() {
        let of = |text: &str| guess(text.as_bytes()).map(|g| (g.layout.yaml(), g.names));
        let names = |n: &[&str]| Some(n.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>());
        let found = |yaml: &str, n| Some((format!("layout: {{{yaml}}}"), n));
        assert_eq!(of("t,q\n0,1\n1,2\n"), found("header: true, delimiter: \",\"", names(&["t", "q"])));
        assert_eq!(
            of("t;q\n0,5;1,5\n1,0;2\n"),
            found("header: true, delimiter: \";\", decimal: \",\"", names(&["t", "q"]))
        );
        assert_eq!(of("0 1.5\n1 2.5\n2 2\n"), found("header: false, delimiter: \" \"", None));
        assert_eq!(of("t\tq\n0\t1\n"), found("header: true, delimiter: \"\\t\"", names(&["t", "q"])));
        assert_eq!(of("hello\nworld\n"), None);
        assert_eq!(remedy(b"t,q\n0,1\n", &Layout::default()), None);
        assert!(remedy(b"t;q\n0;1\n", &Layout::default()).is_some_and(|r| r.contains("delimiter: \";\"")));
    }
}
