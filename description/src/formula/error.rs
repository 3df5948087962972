//! What is wrong with an expression.

/// What is wrong with an expression and where: characters from its start.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FormulaError {
    /// Characters from the start of the text.
    pub offset: usize,
    /// What was found and what was expected.
    pub message: String,
}

impl FormulaError {
    /// An error at a character.
    pub fn new(offset: usize, message: impl Into<String>) -> Self {
        Self { offset, message: message.into() }
    }
}

/// The error at a character.
pub(super) fn error<T>(offset: usize, message: impl Into<String>) -> Result<T, FormulaError> {
    Err(FormulaError::new(offset, message))
}
