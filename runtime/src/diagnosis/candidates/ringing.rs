//! Ringing that motions begin with.

use crate::diagnosis::candidates::trial::{dense, gathered};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;

/// Torques of a transmission of joint `j` with this shape that rings from the start of a motion, as columns on all rows: two
/// for every motion.
pub(in crate::diagnosis) fn ringing(
    context: &Context<'_>,
    design: &Design,
    j: usize,
    shape: &[f64],
) -> Vec<Vec<f64>> {
    let of_motion =
        |motion: usize| gathered(context, design, |k| k != motion, |k| context.ringing(k, j, shape));
    (0..context.signals.len()).flat_map(of_motion).map(|column| dense(design, &column)).collect()
}
