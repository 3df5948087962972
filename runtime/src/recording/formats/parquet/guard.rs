//! Files that are damaged.

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs a decoder of the `parquet` crate. On some pages that are damaged it panics; that is a mistake of the file here. What
/// `work` was doing must not be used after an error.
pub(super) fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| Err("a page of it is damaged".into()))
}
