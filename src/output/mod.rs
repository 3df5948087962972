//! Words and tables on a terminal, files for other programs.

mod file;
mod terminal;
mod together;

use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

use comfy_table::presets::NOTHING;
use comfy_table::{CellAlignment, ContentArrangement, Table};

pub use file::Fill;
pub use terminal::{complain, finished, on_one_line, print, shown, warn};
pub use together::Together;

use crate::failure::{Failure, file_failure};

/// A table for a terminal. A header that starts with `<` sets its column to the left; the others hold numbers.
pub fn table(header: &[&str], rows: Vec<Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_style(NOTHING).set_content_arrangement(ContentArrangement::Disabled);
    table.set_header(header.iter().map(|name| name.trim_start_matches('<')));
    for row in rows {
        table.add_row(row);
    }
    for (column, name) in table.column_iter_mut().zip(header) {
        if !name.starts_with('<') {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table.to_string().lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
}

/// Prints a text that this program made to standard output as it stands.
pub fn print_bytes(text: &[u8]) {
    terminal::to_standard_output(&String::from_utf8_lossy(text));
}

/// Replaces a file as a whole, or writes to standard output for `-`.
///
/// # Errors
/// [`Failure::Input`] naming the path; what the file held before is still there then.
pub fn write(path: &Path, text: &str) -> Result<(), Failure> {
    if path == Path::new("-") {
        terminal::to_standard_output(&format!("{text}\n"));
        return finished();
    }
    fill(path, &mut |out: &mut dyn Write| out.write_all(text.as_bytes()))
}

/// Replaces a file as a whole by what `fill` writes.
///
/// # Errors
/// [`Failure::Input`] naming the path; what the file held before is still there then.
pub fn fill(path: &Path, fill: Fill<'_>) -> Result<(), Failure> {
    file::replace(path, fill).map_err(|error| file_failure("write it", path, &error))
}

/// Whether files that were asked for can be made where long work will write them; `-`, devices and pipes are not asked.
///
/// # Errors
/// [`Failure::Input`] naming the first path at which no file can be.
pub fn can_write<'p>(paths: impl IntoIterator<Item = &'p Option<PathBuf>>) -> Result<(), Failure> {
    for path in paths.into_iter().flatten().filter(|path| *path != Path::new("-")) {
        file::can_replace(path).map_err(|error| file_failure("write it", path, &error))?;
    }
    Ok(())
}

/// Makes a folder, before long work that would be lost without it.
///
/// # Errors
/// [`Failure::Input`] naming the path.
pub fn make_folder(path: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path).map_err(|error| file_failure("make the folder", path, &error))
}

/// Writes a page that is made by a command. What the file already has from its line `## Discussion` on is a person's
/// and stays.
///
/// # Errors
/// [`Failure::Input`] naming the path.
pub fn write_page(path: &Path, text: &str) -> Result<(), Failure> {
    let before = std::fs::read_to_string(path).unwrap_or_default();
    let discussion = before.find("\n## Discussion\n").map_or("", |at| &before[at..]);
    write(path, &format!("{}\n{}", text.trim_end(), discussion))
}

/// Writes a value as JSON, or to standard output for `-`.
///
/// # Errors
/// [`Failure::Input`] naming the path.
pub fn write_json<T: serde::Serialize>(path: &Path, value: &T) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::Data(format!("the result cannot be written as JSON: {error}")))?;
    write(path, &text)
}

/// True where progress may be drawn: a person is watching, and has not asked for a terminal without control codes
/// (<https://no-color.org>), which a bar is drawn with.
pub fn watched() -> bool {
    let plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    std::io::stderr().is_terminal() && !plain
}

/// A progress bar on standard error; silent where nobody watches.
pub struct Bar(indicatif::ProgressBar);

impl Bar {
    /// A bar that counts `what`.
    pub fn new(what: &'static str) -> Self {
        let bar = if watched() { indicatif::ProgressBar::new(0) } else { indicatif::ProgressBar::hidden() };
        // The template is a literal; should it not parse, the default style serves as well.
        if let Ok(style) = indicatif::ProgressStyle::with_template("{msg} {wide_bar} {percent} % {eta}") {
            bar.set_style(style);
        }
        bar.set_message(what);
        Self(bar)
    }

    /// Moves it to `done` of `all`.
    pub fn at(&self, done: usize, all: usize) {
        self.0.set_length(all as u64);
        self.0.set_position(done as u64);
    }
}

impl Bar {
    /// Moves it to a share of the whole, and says what is being done.
    pub fn share(&self, done: f64, what: &str) {
        self.0.set_message(on_one_line(what));
        self.at((1000.0 * done.clamp(0.0, 1.0)) as usize, 1000);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
