//! Why a run cannot go on.

/// Anything that ends a run.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;
