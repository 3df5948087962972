//! One line of a text table: its fields, and the columns that the first one names.

use super::column::Column;
use super::names::{listed, meant};

/// Blanks at the start of a text.
pub(super) fn blanks_at(text: &[u8]) -> usize {
    text.iter().take_while(|b| matches!(b, b' ' | b'\t')).count()
}

/// Whether a line holds no row: blank, or a comment.
pub(super) fn is_passed_over(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start().first(), None | Some(b'#' | b'%'))
}

/// Fields of a line, quotes respected; a delimiter at the very end closes the last field.
pub(super) fn split(line: &[u8], delimiter: u8) -> Vec<&[u8]> {
    let line = line.trim_ascii_end();
    let line = if delimiter == b' ' { line.trim_ascii_start() } else { line };
    let mut fields = Vec::new();
    let (mut from, mut quoted) = (0, false);
    for (at, &b) in line.iter().enumerate() {
        match b {
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b' ' | b'\t' if delimiter == b' ' => {
                if at > from {
                    fields.push(&line[from..at]);
                }
                from = at + 1;
            }
            b if b == delimiter => {
                fields.push(&line[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    if from < line.len() || fields.is_empty() {
        fields.push(&line[from..]);
    }
    fields
}

/// What is wrong with a first line that no table of text begins with.
pub(super) fn no_text(line: &[u8]) -> Option<&'static str> {
    if line.contains(&0) {
        return Some(
            "this is not a text of one byte a character (UTF-16, or a binary file): save it as CSV in UTF-8",
        );
    }
    let inside = line.strip_suffix(b"\r").unwrap_or(line);
    inside
        .contains(&b'\r')
        .then_some("the lines end in CR alone: save the file with line ends of LF or CR LF")
}

/// Index of a wanted column among the fields of the first line; otherwise why there is none.
pub(super) fn find(column: &Column, names: &[&[u8]], header: bool) -> Result<usize, String> {
    let texts: Vec<_> = names.iter().map(|n| String::from_utf8_lossy(trim_quotes(n))).collect();
    let listed = || listed(texts.iter().map(AsRef::as_ref));
    match column {
        Column::Index(index) if *index < names.len() => Ok(*index),
        Column::Index(index) => {
            let last = names.len() - 1;
            Err(format!(
                "there is no column {index}: the columns go from 0 to {last}; is the delimiter right?"
            ))
        }
        Column::Name(name) if !header => {
            Err(format!("column `{name}` is asked for by name, but `layout` says that there is no header"))
        }
        Column::Name(name) => {
            let mut found = names.iter().enumerate().filter(|(_, n)| trim_quotes(n) == name.as_bytes());
            match (found.next(), found.next()) {
                (Some((index, _)), None) => Ok(index),
                (Some(_), Some(_)) => Err(format!("two columns are called `{name}`; name them by index")),
                (None, _) => {
                    let meant = meant(name, texts.iter().map(AsRef::as_ref));
                    Err(format!("there is no column `{name}`{meant}; there are: {}", listed()))
                }
            }
        }
    }
}

fn trim_quotes(name: &[u8]) -> &[u8] {
    match name.trim_ascii() {
        [b'"', inner @ .., b'"'] => inner.trim_ascii(),
        other => other,
    }
}
