//! What `diagnose` tells: a page and a summary for the terminal.

mod extras;
mod finding;
mod forward;
mod page;
mod summary;

pub use extras::{Extras, Fitted, Tested};
pub use page::page;
pub use summary::summary;
