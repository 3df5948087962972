//! From equations to a module of readable Rust.

mod comments;
mod data;
mod function;
mod header;
mod module;
mod program;

pub use module::module;
