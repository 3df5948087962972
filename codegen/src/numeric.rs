//! The table evaluated.

use crate::base::BaseSet;
use crate::robot::{NominalValues, RobotTable};
use dynid_description::{Drive, Nominal, Robot, StandardParameter};

/// The robot as numbers, with the base parameters `set` of the same table ([`crate::base::base_set`]).
///
/// ```
/// use dynid_codegen::{base::base_set, numeric_robot, robot::parse};
///
/// let yaml = b"
/// name: arm
/// frames:
///   - {j: 1, sigma: 0, alpha: pi/2, d: 0, theta: q1, r: 0}
/// ";
/// let table = parse("arm.yaml", yaml).expect("a table without mistakes");
/// let robot = numeric_robot(&table, &base_set(&table));
/// assert_eq!(robot.joints(), 1);
/// assert_eq!(robot.frames[0].alpha, std::f64::consts::FRAC_PI_2);
/// ```
pub fn numeric_robot(table: &RobotTable, set: &BaseSet) -> Robot {
    Robot {
        name: table.name.clone().into(),
        description: table.description.clone().into(),
        gravity: table.gravity,
        frames: table.frames.iter().map(|row| row.evaluated()).collect(),
        drive: Drive {
            gear: table.drive.gear.concat().into(),
            coupled_friction: table.drive.coupled_friction.clone().into(),
        },
        limits: table.limits.clone(),
        standard: set.standard.clone().into(),
        base: set.base.clone().into(),
        nominal: table.nominal.as_ref().map(|values| nominal(values, &set.standard)),
    }
}

/// The values in the order of the standard parameters; 0 where none is named.
fn nominal(values: &NominalValues, standard: &[StandardParameter]) -> Nominal {
    let value = |name: &str| values.standard.iter().find(|(known, _)| known == name).map_or(0.0, |(_, x)| *x);
    Nominal {
        standard: standard.iter().map(|p| value(&p.name)).collect(),
        kp: values.kp.clone().into(),
        kd: values.kd.clone().into(),
        ki: values.ki.clone().into(),
        position_noise: values.position_noise.clone().into(),
        torque_noise: values.torque_noise.clone().into(),
    }
}
