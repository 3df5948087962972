//! A file of rows, whatever its format.

use std::fs::File;
use std::path::Path;

use super::npy::NpyReader;
use super::table::TableReader;
use super::{Column, Layout, RecordingError, Rows};

/// A data file that hands out its wanted columns block by block.
pub(super) enum Source {
    /// Delimited text.
    Table(TableReader),
    /// A `.npy` array.
    Npy(NpyReader<File>),
}

impl Source {
    /// Opens a file; one that is called `.npy` is read as such, everything else as text.
    pub(super) fn open(
        path: &Path,
        file: &str,
        layout: &Layout,
        wanted: &[Column],
    ) -> Result<Self, RecordingError> {
        if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy")) {
            return NpyReader::open(path, file, wanted).map(Self::Npy);
        }
        TableReader::open(path, file, layout, wanted).map(Self::Table)
    }

    pub(super) fn file(&self) -> &str {
        match self {
            Self::Table(table) => table.file(),
            Self::Npy(npy) => npy.file(),
        }
    }

    pub(super) fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError> {
        match self {
            Self::Table(table) => table.read(rows, most),
            Self::Npy(npy) => npy.read(rows, most),
        }
    }
}
