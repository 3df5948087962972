//! Recordings: manifests, files, units, trajectories.

mod channel;
mod duplicate_key;
mod error;
#[cfg(test)]
mod folder;
mod load;
mod manifest;
mod npy;
mod number;
mod regear;
mod report;
mod rows;
mod screen;
mod source;
mod table;
mod trajectory;
mod unit;
mod window;
mod write;

pub use error::RecordingError;
pub use load::{Loader, Recording, load};
pub use manifest::{Channel, Column, Layout, Manifest, Side, Time, Window};
pub use regear::regear;
pub use report::{Cut, LeftOutRow, MOST_LEFT_OUT, Reason, RowReport};
pub use rows::Rows;
pub use screen::Reach;
pub use table::TableReader;
pub use trajectory::Trajectory;
pub use unit::{Quantity, Unit};
pub use write::write;
