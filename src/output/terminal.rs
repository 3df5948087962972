//! Words on the terminal: results on standard output, everything else on standard error.
//!
//! Titles and names come from files that anybody may have written, so control characters are shown and not sent.

use std::io::{self, ErrorKind, Write};
use std::sync::Mutex;

use crate::failure::Failure;

/// What standard output said when it could no longer be written.
static REFUSED: Mutex<Option<String>> = Mutex::new(None);

/// Prints a text and a line end to standard output. A reader that has gone away (`dynid show | head`) ends the output
/// and not the program; any other failure is kept for [`finished`].
pub fn print(text: &str) {
    to_standard_output(&format!("{}\n", shown(text)));
}

/// Tells a person what to know before believing the result, on standard error.
pub fn warn(text: &str) {
    complain(&format!("warning: {text}"));
}

/// Tells a person what went wrong, on standard error. Where that cannot be written, nobody is left to be told.
pub fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "{}", shown(text));
}

/// Whether all that was printed has arrived.
///
/// # Errors
/// [`Failure::Input`] with what the system said, for a full disk for example. A closed pipe is no failure: its reader
/// has seen enough.
pub fn finished() -> Result<(), Failure> {
    let refused = REFUSED.lock().map_or(None, |mut refused| refused.take());
    match refused {
        Some(why) => Err(Failure::Input(format!("standard output: cannot write it: {why}"))),
        None => Ok(()),
    }
}

/// Writes to standard output as it stands.
pub(super) fn to_standard_output(text: &str) {
    let mut out = io::stdout().lock();
    let written = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    if let Err(error) = written
        && error.kind() != ErrorKind::BrokenPipe
        && let Ok(mut refused) = REFUSED.lock()
    {
        refused.get_or_insert_with(|| error.to_string());
    }
}

/// A text whose control characters are written out (`\u{1b}`), but for line ends; so are the characters that turn the
/// direction of writing around, which make a text look like another one.
pub fn shown(text: &str) -> String {
    let turns = |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if c != '\n' && (c.is_control() || turns(c)) {
            out.extend(c.escape_unicode());
        } else {
            out.push(c);
        }
    }
    out
}

/// [`shown`] on one line: what is quoted from a file can add no line of its own.
pub fn on_one_line(text: &str) -> String {
    shown(&text.replace('\n', " "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_command_a_terminal_is_written_out() {
        assert_eq!(shown("a\u{1b}[31mb\nc\r\u{9b}\u{202e}"), "a\\u{1b}[31mb\nc\\u{d}\\u{9b}\\u{202e}");
        assert_eq!(on_one_line("title\nwarning: no"), "title warning: no");
        assert_eq!(shown("Stäubli TX-40, ±0,1 °"), "Stäubli TX-40, ±0,1 °");
    }
}
