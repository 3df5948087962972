//! Rows whose torque was recorded later than the state that it belongs to.

use crate::prediction::JointRows;

/// Leaves out the rows at which a joint hardly moved when what is recorded there happened, `delay` seconds earlier: near rest a
/// model says nothing, however fast the joint moves by the time of the row.
pub(super) fn leave_out_rest(rows: &mut [JointRows], delay: f64) {
    for rows in rows {
        let [first, second, ..] = rows.time[..] else { continue };
        let late = (delay / (second - first)).round() as isize;
        let moves = rows.used.clone();
        for (t, used) in rows.used.iter_mut().enumerate() {
            let state = t.checked_add_signed(-late).and_then(|state| moves.get(state));
            *used &= state.is_none_or(|moves| *moves);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn used_with(delay: f64) -> Vec<bool> {
        let mut rows = [JointRows {
            trajectory: 0,
            joint: 0,
            time: (0..6).map(|k| 0.02 * f64::from(k)).collect(),
            used: vec![true, true, false, true, true, true],
            measured: vec![0.0; 6],
            predicted: vec![],
        }];
        leave_out_rest(&mut rows, delay);
        let [rows] = rows;
        rows.used
    }

    #[test]
    fn a_row_is_left_out_where_its_joint_stood_when_its_torque_was_made() {
        assert_eq!(used_with(0.0), [true, true, false, true, true, true]);
        assert_eq!(used_with(0.009), [true, true, false, true, true, true]);
        assert_eq!(used_with(0.015), [true, true, false, false, true, true]);
        assert_eq!(used_with(0.041), [true, true, false, true, false, true]);
        assert_eq!(used_with(-0.02), [true, false, false, true, true, true]);
        assert_eq!(used_with(10.0), used_with(0.0));
    }
}
