//! Windows of time from instants that were pushed or not.

use crate::diagnosis::rules::{HIGHEST_CONFIDENCE, SHORTEST_PUSH};

/// Windows in which instants follow each other as pushed, gaps shorter than a shortest push closed, those shorter than
/// it left out. `instants` are times with whether they were pushed, in order.
pub(in crate::diagnosis) fn windows(instants: impl Iterator<Item = (f64, bool)>) -> Vec<[f64; 2]> {
    let mut windows: Vec<[f64; 2]> = Vec::new();
    for (time, _) in instants.filter(|(_, pushed)| *pushed) {
        match windows.last_mut() {
            Some(last) if time - last[1] < SHORTEST_PUSH => last[1] = time,
            _ => windows.push([time, time]),
        }
    }
    windows.retain(|w| w[1] - w[0] >= SHORTEST_PUSH);
    windows
}

/// Duration of windows, s.
pub(in crate::diagnosis) fn duration(windows: &[[f64; 2]]) -> f64 {
    windows.iter().map(|w| w[1] - w[0]).sum()
}

/// Confidence of a window.
pub(super) fn told(doubt: f64) -> f64 {
    (1.0 - doubt).clamp(0.0, HIGHEST_CONFIDENCE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten seconds at 50 instants a second, pushed within these times.
    fn found(pushes: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let times = (0..500).map(|k| f64::from(k) / 50.0);
        windows(times.map(|t| (t, pushes.iter().any(|p| (p[0]..=p[1]).contains(&t)))))
    }

    #[test]
    fn a_push_is_a_window_from_its_first_to_its_last_instant() {
        assert_eq!(found(&[[2.0, 2.5]]), [[2.0, 2.5]]);
        assert_eq!(found(&[[2.0, 2.5], [7.0, 9.98]]), [[2.0, 2.5], [7.0, 9.98]]);
        assert_eq!(found(&[[0.0, 9.98]]), [[0.0, 9.98]]);
    }

    #[test]
    fn a_burst_that_is_too_short_is_none() {
        assert!(found(&[[2.0, 2.1]]).is_empty());
        assert!(found(&[[2.0, 2.0], [5.0, 5.0]]).is_empty());
        assert!(found(&[]).is_empty());
    }

    #[test]
    fn pushes_with_a_short_gap_are_one() {
        assert_eq!(found(&[[2.0, 2.1], [2.2, 2.3]]), [[2.0, 2.3]]);
        assert_eq!(found(&[[2.0, 2.3], [2.5, 2.8]]), [[2.0, 2.3], [2.5, 2.8]]);
    }

    #[test]
    fn their_durations_add_up() {
        assert!((duration(&found(&[[2.0, 2.5], [7.0, 7.3]])) - 0.8).abs() < 1e-12);
    }
}
