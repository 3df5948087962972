//! What is wrong with the file of a model, and where.

/// What of a saved model cannot be.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct FileError {
    /// Where: `line:column`, or the path of the field, as in `effects[2].shape`.
    pub place: String,
    /// What is wrong.
    pub what: String,
}

impl FileError {
    pub(super) fn new(place: String, what: &str) -> Self {
        Self { place, what: what.to_owned() }
    }
}
