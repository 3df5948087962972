//! The combination of joints that friction or a spring acts on, exactly.

use crate::exact::decimal;
use crate::robot::RobotTable;
use dynid_description::{ParameterKind, StandardParameter};
use num_rational::BigRational;

impl RobotTable {
    /// One number per joint: 1 for the joint of a parameter of its own, the motor's speed in units of its joint for what is at
    /// the motor, what the table says for a coupling.
    pub(super) fn acts_on(&self, parameter: &StandardParameter) -> Vec<BigRational> {
        let joint_frames = self.joint_frames();
        let mut form = vec![BigRational::from_integer(0.into()); joint_frames.len()];
        if let Some(coupling) = parameter.coupling {
            self.couplings[coupling].terms.iter().for_each(|&(joint, c)| form[joint] = decimal(c));
        } else if let Some(joint) = joint_frames.iter().position(|&f| f == parameter.frame) {
            let row = &self.drive.gear[joint];
            match parameter.kind {
                ParameterKind::Fvm | ParameterKind::Fcm => {
                    form = row.iter().map(|&x| decimal(x) / decimal(row[joint])).collect();
                }
                _ => form[joint] = BigRational::from_integer(1.into()),
            }
        }
        form
    }
}
