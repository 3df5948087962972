//! Smooth curves over a joint's own state, beside which pushes are looked for.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rules::{SCAN_KNOTS, SCAN_ROWS_PER_KNOT};

/// Columns over the rows of a joint, `rows` (motion, sample) in their order: a constant, and continuous curves, straight
/// from knot to knot, over position, the same by direction of motion, over speed and the torque of the model.
pub(in crate::diagnosis) fn curves(
    context: &Context<'_>,
    joint: usize,
    rows: &[(usize, usize)],
) -> Vec<Vec<f64>> {
    let signals = context.signals;
    let state =
        |of: &dyn Fn(usize, usize) -> f64| -> Vec<f64> { rows.iter().map(|&(k, t)| of(k, t)).collect() };
    let direction = state(&|k, t| signals[k].dq[joint][t].signum());
    let knots = (rows.len() / SCAN_ROWS_PER_KNOT).clamp(SCAN_KNOTS[0], SCAN_KNOTS[1]);
    let over_position = bent(&state(&|k, t| signals[k].q[joint][t]), knots);
    let by_direction = over_position.iter().map(|c| c.iter().zip(&direction).map(|(x, s)| x * s).collect());
    let mut out: Vec<Vec<f64>> = by_direction.collect();
    out.extend([direction.clone(), vec![1.0; rows.len()]]);
    out.extend(over_position);
    out.extend(bent(&state(&|k, t| signals[k].dq[joint][t]), knots));
    out.extend(bent(&state(&|k, t| context.torques(k).total[joint][t]), knots));
    out
}

/// Hat functions over quantiles, all but the first: with a constant they make every such curve.
fn bent(x: &[f64], knots: usize) -> Vec<Vec<f64>> {
    let mut sorted = x.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = |k: usize| sorted.get(k * sorted.len().saturating_sub(1) / (knots - 1).max(1)).copied();
    let mut at: Vec<f64> = (0..knots).filter_map(at).collect();
    at.dedup();
    let hat = |k: usize, x: f64| {
        let part = |from: usize, to: usize| ((x - at[from]) / (at[to] - at[from])).clamp(0.0, 1.0);
        let (rise, fall) = (part(k - 1, k), if k + 1 < at.len() { part(k, k + 1) } else { 0.0 });
        rise - fall
    };
    (1..at.len()).map(|k| x.iter().map(|&x| hat(k, x)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hats_and_a_constant_make_a_curve_that_bends_at_the_knots() {
        let x: Vec<f64> = (0..=100).map(|k| f64::from(k) / 100.0).collect();
        let hats = bent(&x, 3);
        assert_eq!(hats.len(), 2);
        for (k, &x) in x.iter().enumerate() {
            // A line, and one that is bent in the middle.
            assert!((0.5 * hats[0][k] + hats[1][k] - x).abs() < 1e-12);
            assert!((hats[0][k] - (1.0 - (2.0 * x - 1.0).abs())).abs() < 1e-12);
        }
    }

    #[test]
    fn a_state_that_never_changes_has_no_curve() {
        assert!(bent(&[2.0; 50], 4).is_empty());
        assert!(bent(&[], 4).is_empty());
    }
}
