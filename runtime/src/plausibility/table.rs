//! A robot with another gravity, or other angles, than its table says.

use std::f64::consts::{PI, TAU};

use crate::model::{RecursiveModel, Robot};

/// What of the table is another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Table {
    /// Gravity, m/s2, in frame 0.
    Gravity([f64; 3]),
    /// Angles beyond a turn are degrees.
    Degrees,
}

/// The robot with another table. Its base parameters are the standard ones, because what is regrouped depends on the
/// table; those that do not act are left out by the estimate.
pub(super) fn altered(robot: &Robot, table: Table) -> Option<RecursiveModel> {
    let (mut gravity, mut frames) = (robot.gravity, robot.frames.to_vec());
    match table {
        Table::Gravity(other) => gravity = other,
        Table::Degrees => {
            let angles = frames.iter_mut().flat_map(|f| [&mut f.alpha, &mut f.gamma, &mut f.theta]);
            angles.filter(|a| turns(**a)).for_each(|a| *a *= PI / 180.0);
        }
    }
    let (drive, limits) = (robot.drive.clone(), robot.limits.clone());
    let mut other = Robot::with_standard_as_base(&robot.name, gravity, frames, drive, limits);
    other.dependent = robot.dependent.clone();
    other.known = robot.known.clone();
    other.base.to_mut().retain(|base| !robot.known.contains(&base.standard));
    RecursiveModel::new(other).ok()
}

/// Gravity of the same size along the axes of frame 0, both ways, but for the one of the table; that of the Earth where
/// the table has none.
pub(super) fn other_gravities(robot: &Robot) -> impl Iterator<Item = [f64; 3]> {
    const EARTH: f64 = 9.81;
    let own = robot.gravity;
    let size = own.iter().map(|g| g * g).sum::<f64>().sqrt();
    let size = if size > 0.0 { size } else { EARTH };
    let along = move |k: usize| {
        let mut gravity = [0.0; 3];
        gravity[k / 2] = if k.is_multiple_of(2) { size } else { -size };
        gravity
    };
    let differs = move |g: &[f64; 3]| g.iter().zip(&own).any(|(a, b)| (a - b).abs() > 0.01 * size);
    (0..6).map(along).filter(differs)
}

/// Whether the table has an angle that is hardly meant in rad.
pub(super) fn beyond_a_turn(robot: &Robot) -> bool {
    robot.frames.iter().any(|f| [f.alpha, f.gamma, f.theta].into_iter().any(turns))
}

fn turns(angle: f64) -> bool {
    angle.abs() > TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Drive, Frame, JointKind, Limits, Model};

    fn robot(gravity: [f64; 3], alpha: f64) -> Robot {
        let frame = Frame {
            parent: None,
            kind: JointKind::Revolute,
            gamma: 0.0,
            b: 0.0,
            alpha,
            d: 0.0,
            theta: 0.5,
            r: 0.0,
        };
        let drive = Drive { gear: vec![1.0].into(), coupled_friction: vec![].into() };
        Robot::with_standard_as_base("axis", gravity, vec![frame], drive, Limits::default())
    }

    #[test]
    fn every_other_direction_of_gravity_is_tried() {
        let others: Vec<[f64; 3]> = other_gravities(&robot([0.0, 0.0, -9.8], 0.0)).collect();
        assert_eq!(others.len(), 5);
        assert!(others.contains(&[0.0, 0.0, 9.8]) && !others.contains(&[0.0, 0.0, -9.8]));
        assert_eq!(other_gravities(&robot([0.0; 3], 0.0)).count(), 6);
    }

    #[test]
    fn angles_beyond_a_turn_become_degrees_and_others_stay() {
        assert!(!beyond_a_turn(&robot([0.0; 3], 1.5)));
        let odd = robot([0.0; 3], 90.0);
        assert!(beyond_a_turn(&odd));
        let model = altered(&odd, Table::Degrees).expect("a valid table");
        let frame = model.robot().frames[0];
        assert!((frame.alpha - PI / 2.0).abs() < 1e-12);
        assert_eq!(frame.theta, 0.5);
    }
}
