//! Ringing that motions begin with.

use crate::diagnosis::candidates::trial::on_rows;
use crate::diagnosis::rows::context::{Context, Series};
use crate::diagnosis::rows::design::Design;

/// Torques of a transmission of joint `j` with this shape that rings from the start of a motion, as columns on all rows: two
/// for every motion.
pub(in crate::diagnosis) fn ringing(
    context: &Context<'_>,
    design: &Design,
    j: usize,
    shape: &[f64],
) -> Vec<Vec<f64>> {
    let of_motion = |motion: usize| {
        let ringing = |k: usize| {
            let rings = context.ringing(k, j, shape);
            if k == motion { rings } else { rings.into_iter().map(silent).collect() }
        };
        on_rows(context, design, ringing)
    };
    (0..context.signals.len()).flat_map(of_motion).collect()
}

fn silent(series: Series) -> Series {
    series.into_iter().map(|(j, values)| (j, vec![0.0; values.len()])).collect()
}
