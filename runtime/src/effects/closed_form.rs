//! Effects as formulas of the motion, in the language of a user's law, for code that leaves dynid.

use super::form::Form;
use super::joint_law::Scale;
use super::place::Place;
use super::term::EffectTerm;
use crate::model::{JointIndex, Robot};

/// A torque on one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedForm {
    /// 0-based.
    pub joint: usize,
    /// Its torque, N.m or N, over `q<j>`, `dq<j>`, `ddq<j>` and `load<j>`, with the numbers of the term.
    pub text: String,
}

impl EffectTerm {
    /// The term as formulas; 0 is the sign of a speed of 0.
    ///
    /// # Errors
    /// Why there are none: its torque is not a formula of the instant.
    pub fn closed_forms(&self, robot: &Robot) -> Result<Vec<ClosedForm>, &'static str> {
        match self.effect.form() {
            Form::Joint(law) => {
                let (Place::Joint(joint), Some(scale)) = (self.place, self.scale) else {
                    return Err("a law of all joints at once");
                };
                let number = robot.joint_number(JointIndex(joint)).0;
                law.closed_form(&Scale::from(scale), &self.shape, &self.amplitude, number)
                    .map(|text| vec![ClosedForm { joint, text }])
                    .ok_or("its law has a memory, or looks at the time or another torque")
            }
            Form::User => self.of_user(),
            Form::Coupled => self.of_rotor(robot).ok_or("it has no numbers"),
            Form::Heard(_) => Err("it hears the torque of another joint"),
            Form::Sensitivity(_) => Err("an error of the table or of the recording, to be corrected there"),
            Form::Compliance(_) => Err("the transmission has a state of its own"),
            Form::Body(_) => Err("a body, which is no formula of the motion"),
            Form::Window => Err("an outside force of one recording"),
            Form::Free => Err("curves that no formula says"),
        }
    }

    fn of_user(&self) -> Result<Vec<ClosedForm>, &'static str> {
        let Some(law) = self.place.law() else { return Err("its law is not there") };
        if law.inputs().iter().any(|name| name == "t") {
            return Err("it looks at the time in the motion");
        }
        let names = law.constants().zip(&self.amplitude).chain(law.shapes().zip(&self.shape));
        let values: Vec<(&str, String)> = names.map(|(name, x)| (name, number(*x))).collect();
        let text = law.with_numbers(|name| values.iter().find(|v| v.0 == name).map(|v| v.1.clone()));
        Ok(vec![ClosedForm { joint: law.joint(), text }])
    }

    /// A rotor that two joints turn.
    fn of_rotor(&self, robot: &Robot) -> Option<Vec<ClosedForm>> {
        let [a, b] = self.place.pair()?;
        let ratio = number(*self.shape.first()?);
        let &[viscous, coulomb, inertia] = &self.amplitude[..] else { return None };
        let [viscous, coulomb, inertia] = [viscous, coulomb, inertia].map(number);
        let [i, k] = [a, b].map(|joint| robot.joint_number(JointIndex(joint)).0);
        let speed = format!("{ratio}*dq{i} + dq{k}");
        let torque =
            format!("({viscous}*({speed}) + {coulomb}*sign({speed}) + {inertia}*({ratio}*ddq{i} + ddq{k}))");
        let on_a = ClosedForm { joint: a, text: format!("{ratio}*{torque}") };
        Some(vec![on_a, ClosedForm { joint: b, text: torque }])
    }
}

/// All digits of a number, in parentheses where it has a sign.
pub(in crate::effects) fn number(value: f64) -> String {
    if value.is_sign_negative() { format!("({value:?})") } else { format!("{value:?}") }
}
