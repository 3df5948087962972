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

pub use module::module;
