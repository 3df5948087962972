//! From equations to a module of readable Rust.

mod comments;
mod data;
mod function;
mod functions;
mod header;
mod module;
mod program;
mod rust;
mod statement;

pub use comments::{comment, restore};
pub use function::Signature;
pub use functions::{Function, functions};
pub use header::table_lines;
pub use module::{module, rust_functions};
pub use statement::{Binding, Formula, Statement};
