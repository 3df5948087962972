//! What every YAML file of a recording is checked for before its values are read.

mod positions;

pub(crate) use positions::{MAX_BYTES, Mistake, Node, Place, read_positions, read_positions_of};
