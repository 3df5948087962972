//! What is computed of a table: its checks, and which entries of the regressor do not vanish.

use super::columns::standard_idm;
use super::error::{MAX_FRAMES, RecursiveModelError};
use super::kinematics::Link;
use crate::model::Robot;
use dynid_description::MAX_TERMS;

/// Entries of one (joint, frame) block that are wanted: (place among the ten columns, entry of the pattern).
pub(super) type Wanted = Vec<(usize, usize)>;

/// Whether the table can be evaluated.
pub(super) fn check(robot: &Robot) -> Result<(), RecursiveModelError> {
    let found = robot.frames.len();
    if found > MAX_FRAMES {
        return Err(RecursiveModelError::TooManyFrames { found });
    }
    for (k, frame) in robot.frames.iter().enumerate() {
        if frame.parent.is_some_and(|p| p >= k) {
            return Err(RecursiveModelError::ParentOrder { frame: k + 1 });
        }
    }
    for dependent in robot.dependent.iter() {
        let fits = dependent.terms.iter().all(|&(joint, c)| joint < robot.joints() && c.is_finite());
        if dependent.frame >= found || dependent.terms.len() > MAX_TERMS || !fits {
            return Err(RecursiveModelError::Dependent { frame: dependent.frame.saturating_add(1) });
        }
    }
    for coupling in robot.couplings.iter() {
        let known = |&(joint, c): &(usize, f64)| joint < robot.joints() && c.is_finite();
        let rest = coupling.law.rest().unwrap_or(0.0);
        let placed = coupling.law.between().is_none_or(|between| {
            let in_table = between.frames.iter().flatten().all(|&frame| frame < found);
            in_table && between.points.iter().flatten().all(|x| x.is_finite())
        });
        if coupling.terms.is_empty() || !coupling.terms.iter().all(known) || !rest.is_finite() || !placed {
            return Err(RecursiveModelError::Coupling { name: coupling.name.to_string() });
        }
    }
    for base in robot.base.iter() {
        let exists = robot.standard.get(base.standard).is_some_and(|s| s.frame < found);
        if !exists {
            return Err(RecursiveModelError::Parameter { name: base.name.to_string() });
        }
    }
    Ok(())
}

/// For each block that [`standard_idm`] visits: which of its ten columns are base columns and do not vanish, and
/// where they go: (place among the ten, (joint, base parameter)).
pub(super) fn generic_entries(
    robot: &Robot,
    links: &[Link<f64>],
    columns: &[Wanted],
) -> Vec<Vec<(usize, (usize, usize))>> {
    const STATES: usize = 8;
    let n = robot.joints();
    // Multiples of the golden ratio, modulo 1: generic, and the same on every run.
    let mut counter = 0.0;
    let mut next = || {
        counter += 1.0;
        6.0 * ((counter * 0.618_033_988_749_894_9_f64).fract() - 0.5)
    };
    let mut blocks: Vec<(usize, usize, [f64; 10])> = Vec::new();
    for state in 0..STATES {
        let mut values: [Vec<f64>; 3] = Default::default();
        for signal in &mut values {
            signal.extend((0..n).map(|_| next()));
        }
        let [q, dq, ddq] = &values;
        let mut visited = 0;
        standard_idm(links, robot.gravity, q, dq, ddq, |joint, frame, row| {
            if state == 0 {
                blocks.push((joint, frame, [0.0; 10]));
            }
            for (largest, value) in blocks[visited].2.iter_mut().zip(row) {
                *largest = largest.max(value.abs());
            }
            visited += 1;
        });
    }
    blocks
        .iter()
        .map(|&(joint, frame, largest)| {
            let scale = largest.iter().copied().fold(1.0, f64::max);
            columns[frame]
                .iter()
                .filter(|&&(kind, _)| largest[kind] > 1e-12 * scale)
                .map(|&(kind, column)| (kind, (joint, column)))
                .collect()
        })
        .collect()
}
