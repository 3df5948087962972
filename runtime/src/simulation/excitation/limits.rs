//! The robot's limits, and whether a motion keeps them.

use crate::model::{Model, Robot};
use crate::simulation::drive::DriveFriction;
use crate::simulation::{Reference, SimulationError};

/// Position range and symmetric speed and acceleration limits that a motion may use.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Limits {
    pub position: Vec<[f64; 2]>,
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
}

impl Limits {
    /// `share` of the robot's limits, and of its position range no more than `reach` about the middle.
    ///
    /// # Errors
    /// A robot that does not give all of them; a share or reach out of (0, 1].
    pub fn of(robot: &Robot, share: f64, reach: f64) -> Result<Self, SimulationError> {
        for (what, found) in [("share of the limits", share), ("reach", reach)] {
            if !(found > 0.0 && found <= 1.0) {
                return Err(SimulationError::Setting { what, expected: "above 0, at most 1", found });
            }
        }
        let n = robot.joints();
        let limits = &robot.limits;
        let needed = [
            ("position", &limits.position),
            ("velocity", &limits.velocity),
            ("acceleration", &limits.acceleration),
        ];
        let missing: Vec<&str> =
            needed.iter().filter(|(_, list)| list.len() != n).map(|(key, _)| *key).collect();
        if !missing.is_empty() {
            return Err(SimulationError::NoLimits { robot: robot.name.to_string(), missing, joints: n });
        }
        let symmetric = |list: &[[f64; 2]]| list.iter().map(|x| share * x[1].min(-x[0])).collect();
        let inner = |x: &[f64; 2]| {
            let (middle, half) = (0.5 * (x[0] + x[1]), 0.5 * share.min(reach) * (x[1] - x[0]));
            [middle - half, middle + half]
        };
        Ok(Self {
            position: limits.position.iter().map(inner).collect(),
            velocity: symmetric(&limits.velocity),
            acceleration: symmetric(&limits.acceleration),
        })
    }
}

/// Largest share of a torque limit that a motion takes, with Coulomb friction against the motion throughout; 0 for
/// a robot without torque limits.
///
/// Torques are worked out 2000 times a second. Between two samples a torque can pass the larger one by half of its
/// second difference at most (a peak or a bend in the middle); that much is added, so that limits hold there too.
///
/// # Errors
/// Parameters that no robot has.
pub fn peak_torque_share(
    model: &dyn Model,
    chi: &[f64],
    motion: &dyn Reference,
) -> Result<f64, SimulationError> {
    let robot = model.robot();
    let n = robot.joints();
    if robot.limits.torque.len() != n {
        return Ok(0.0);
    }
    let joints: Vec<usize> = (0..n).collect();
    let kept = robot.base.iter().zip(chi).map(|(p, &value)| {
        let standard = &robot.standard[p.standard];
        (&*p.name, standard, value)
    });
    let friction = DriveFriction::new(robot, kept, &joints, false)?;
    let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let (mut mass, mut bias) = (vec![0.0; n * n], vec![0.0; n]);
    let mut dry = vec![0.0; n];
    for element in &friction.elements {
        for &(joint, factor) in &element.direction {
            dry[joint] += (factor * element.level).abs();
        }
    }
    let samples = (motion.duration() * 2000.0).ceil() as usize;
    let mut share = 0.0_f64;
    // The torques of the last two samples; the first ones have no bend.
    let mut last: [Option<Vec<f64>>; 2] = [None, None];
    for k in 0..=samples {
        motion.at(motion.duration() * k as f64 / samples as f64, &mut q, &mut dq, &mut ddq);
        model.mass_and_bias(chi, &q, &dq, &mut mass, &mut bias);
        for &(joint, offset) in &friction.offset {
            bias[joint] += offset;
        }
        for &(row, column, coefficient) in &friction.viscous {
            bias[row] += coefficient * dq[column];
        }
        let torque: Vec<f64> =
            (0..n).map(|j| bias[j] + (0..n).map(|s| mass[j * n + s] * ddq[s]).sum::<f64>()).collect();
        for j in 0..n {
            let between = match &last {
                [Some(before), Some(middle)] => 0.5 * (torque[j] - 2.0 * middle[j] + before[j]).abs(),
                _ => 0.0,
            };
            let nearest = last[1].as_ref().map_or(torque[j], |middle| middle[j]);
            let [low, high] = robot.limits.torque[j];
            for value in [torque[j], nearest] {
                share = share.max((value + dry[j] + between) / high).max((value - dry[j] - between) / low);
            }
        }
        last.swap(0, 1);
        last[1] = Some(torque);
    }
    Ok(share)
}
