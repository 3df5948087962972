//! What the couplings of a robot are checked against.

use super::drive_table::DriveTable;
use super::table::TableRow;
use dynid_description::DependentFrame;

/// What is known of a robot where the entries of its couplings are read.
pub(super) struct Known<'a> {
    /// Numbers j of the joints.
    pub joints: Vec<usize>,
    pub frames: &'a [TableRow],
    pub dependent: &'a [DependentFrame],
    pub drive: &'a DriveTable,
    pub constants: &'a [(String, f64)],
}
