//! What a person reads: numbers in words, plots, pages. Text in, text out; no file is written here.

mod axis;
mod escape;
mod html;
mod numbers;
mod plot;
mod sheet;

pub use escape::escape;
pub use html::Page;
pub use numbers::{falls_or_rises, percent, significant};
pub use plot::{Band, Plot, Role, Series, SeriesKind};
pub use sheet::{Panel, Sheet};
