//! What every YAML file of a recording, or of a fleet of them, is checked for before its values are read.

mod positions;

pub use positions::{Content, MAX_BYTES, Mistake, Node, Place, read_positions, read_positions_of};
