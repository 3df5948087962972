//! Loads that a joint bears once.
//!
//! A law of the load, as of a motor that saturates or a gear that loses the more the more it bears, shows where the load is
//! large. Of a load that is larger than anywhere else in a recording nothing tells whether a law or a push is what the model
//! does not explain there.

use crate::diagnosis::rules::PASSAGE;

/// What a joint bears at a time of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Load {
    pub motion: usize,
    /// s.
    pub time: f64,
    /// Of the model.
    pub torque: f64,
}

/// Whether each load is larger, in its direction, than all that are borne in other motions or more than [`PASSAGE`] from
/// the largest of all.
pub(in crate::diagnosis) fn borne_once(loads: &[Load]) -> Vec<bool> {
    let mut once = vec![false; loads.len()];
    for direction in [1.0, -1.0] {
        let size = |load: &Load| direction * load.torque;
        let Some(peak) = loads.iter().max_by(|a, b| size(a).total_cmp(&size(b))) else { continue };
        let beside = |load: &&Load| load.motion != peak.motion || (load.time - peak.time).abs() > PASSAGE;
        let seen = loads.iter().filter(beside).map(size).fold(f64::NEG_INFINITY, f64::max);
        // Where all of it is one passage nothing is beside it that it could be larger than.
        if seen.is_finite() {
            once.iter_mut().zip(loads).for_each(|(once, load)| *once |= size(load) > seen);
        }
    }
    once
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(motion: usize, torques: &[f64]) -> Vec<Load> {
        let load = |(k, &torque): (usize, &f64)| Load { motion, time: 0.5 * k as f64, torque };
        torques.iter().enumerate().map(load).collect()
    }

    #[test]
    fn a_load_is_borne_once_where_all_that_comes_near_it_is_of_one_passage() {
        let loads = motion(0, &[0.0, 1.0, 5.0, 9.0, 6.0, 1.0, 0.0, 4.0, 0.0, -1.0, -2.0, 0.0, 0.0, -2.0]);
        let once = borne_once(&loads);
        assert_eq!((0..loads.len()).filter(|&k| once[k]).collect::<Vec<_>>(), [2, 3, 4]);
    }

    #[test]
    fn what_another_motion_bears_too_is_not_borne_once() {
        let mut loads = motion(0, &[0.0, 8.0, 9.0, 8.0, 0.0]);
        loads.extend(motion(1, &[0.0, 8.5, 0.0]));
        assert_eq!(borne_once(&loads), [false, false, true, false, false, false, false, false]);
    }

    #[test]
    fn of_a_single_short_passage_nothing_is_said() {
        assert_eq!(borne_once(&motion(0, &[1.0, 2.0, 1.0])), [false; 3]);
        assert!(borne_once(&[]).is_empty());
    }
}
