//! A file of rows, whatever its format.

use std::path::Path;

use super::table::TableReader;
use super::{Column, Layout, RecordingError, Rows};

/// A data file that hands out its wanted columns block by block.
pub(super) enum Source {
    /// Delimited text.
    Table(TableReader),
}

impl Source {
    pub(super) fn open(
        path: &Path,
        file: &str,
        layout: &Layout,
        wanted: &[Column],
    ) -> Result<Self, RecordingError> {
        TableReader::open(path, file, layout, wanted).map(Self::Table)
    }

    pub(super) fn file(&self) -> &str {
        match self {
            Self::Table(table) => table.file(),
        }
    }

    pub(super) fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError> {
        match self {
            Self::Table(table) => table.read(rows, most),
        }
    }
}
