//! What reads a data file.

use super::{RecordingError, Rows};

/// A data file that hands out its wanted columns block by block.
pub(super) trait Format {
    /// What messages call the file.
    fn file(&self) -> &str;

    /// Appends up to `most` rows to `rows`, which has one column per wanted column. Returns how many; 0 at the end.
    fn read(&mut self, rows: &mut Rows, most: usize) -> Result<usize, RecordingError>;

    /// How a file of which many rows cannot be read is perhaps laid out.
    fn remedy(&self) -> Option<String> {
        None
    }

    /// What is known of the stamps in the wanted column `slot`.
    fn stamps(&self, slot: usize) -> Stamps {
        let _ = slot;
        Stamps::Numbers
    }

    /// What of the file was passed over, for a person; complete at the end of the file.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

/// What a file says of its stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stamps {
    /// Their type says their unit.
    #[cfg_attr(not(feature = "parquet"), allow(dead_code, reason = "Parquet alone says units"))]
    In(&'static str),
    /// They are whole numbers of some unit.
    #[cfg_attr(not(feature = "parquet"), allow(dead_code, reason = "Parquet alone has types"))]
    Whole,
    /// Nothing.
    Numbers,
}
