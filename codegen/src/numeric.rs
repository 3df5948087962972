//! The table evaluated.

use crate::base::BaseSet;
use crate::robot::{DriveTable, Expression, NominalValues, RobotTable, TableRow};
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
        dependent: table.dependent.clone().into(),
        drive: Drive {
            gear: table.drive.gear.concat().into(),
            coupled_friction: table.drive.coupled_friction.clone().into(),
        },
        couplings: table.couplings.clone().into(),
        known: table.known.clone().into(),
        fixed: table.fixed.clone().into(),
        ellipsoids: table.ellipsoids.clone().into(),
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

/// The way back: a table of numbers and the base parameters of a robot that was read already, with the same equations.
/// Symbols of constants and values for simulation are not among them.
pub(crate) fn table_of(robot: &Robot) -> (RobotTable, BaseSet) {
    let number = Expression::Number;
    let frames = robot
        .frames
        .iter()
        .enumerate()
        .map(|(k, frame)| TableRow {
            j: k + 1,
            parent: frame.parent.map_or(0, |p| p + 1),
            kind: frame.kind,
            gamma: number(frame.gamma),
            b: number(frame.b),
            alpha: number(frame.alpha),
            d: number(frame.d),
            theta: number(frame.theta),
            r: number(frame.r),
        })
        .collect();
    let gear = robot.drive.gear.chunks(robot.joints().max(1)).map(<[f64]>::to_vec).collect();
    let table = RobotTable {
        name: robot.name.to_string(),
        description: robot.description.to_string(),
        gravity: robot.gravity,
        constants: Vec::new(),
        frames,
        dependent: robot.dependent.to_vec(),
        drive: DriveTable { gear, coupled_friction: robot.drive.coupled_friction.to_vec() },
        couplings: robot.couplings.to_vec(),
        known: robot.known.to_vec(),
        fixed: robot.fixed.to_vec(),
        ellipsoids: robot.ellipsoids.to_vec(),
        limits: robot.limits.clone(),
        nominal: None,
    };
    (table, BaseSet { standard: robot.standard.to_vec(), base: robot.base.to_vec() })
}
