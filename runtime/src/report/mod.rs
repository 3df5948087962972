//! What a person reads: numbers in words, plots, pages. Text in, text out; no file is written here.
//!
//! ```
//! use dynid_runtime::report::{Page, Plot, Role, SeriesKind, percent};
//!
//! let points = (0..100).map(|k| (f64::from(k) * 0.01, (f64::from(k) * 0.1).sin())).collect();
//! let plot = Plot::new("Torque", "time, s", "N.m").with("measured", Role::Measured, SeriesKind::Line, points);
//! let mut page = Page::new("A recording");
//! page.paragraph(&format!("The model explains all but {}.", percent(0.034))).plot(&plot);
//! assert!(page.to_html().contains("<svg"));
//! ```

mod alone;
mod axis;
mod escape;
mod figure;
mod html;
mod numbers;
mod plot;
mod samples;
mod series;
mod sheet;
mod thin;
mod words;

pub use alone::alone;
pub use escape::escape;
pub use html::Page;
pub use numbers::{change_of_error, percent, significant};
pub use plot::{Over, Plot};
pub use series::{Band, Role, Series, SeriesKind};
pub use sheet::{Panel, Sheet};
pub use words::capital;
