//! What every YAML file of a recording is checked for before its values are read.

mod positions;

pub(super) use positions::{MAX_BYTES, Mistake, Node, Place, read_positions};
