//! Whether a term that comes from a file can be evaluated on a robot.

use super::{At, EffectTerm, Form, FreeLaw, JointLaw, Moved, Place, Scale};
use crate::model::{JointNumber, Robot};

/// What of a term cannot be.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {what}")]
pub struct TermError {
    /// The field, as it is called in the file: `shape`, `place.joint`, ...
    pub field: String,
    /// What is wrong with it, and what it should be.
    pub what: String,
}

/// A joint on which every law offers all of its shapes.
const WIDE: Scale = Scale { range: 1e3, fast: 1.0, inertia: 1.0, ..Scale::UNIT };

impl EffectTerm {
    /// Checks that every place, length and number of the term is one that its effect has on this robot.
    ///
    /// # Errors
    /// The first field that is not.
    pub fn check(&self, robot: &Robot) -> Result<(), TermError> {
        self.check_numbers()?;
        for (k, &j) in self.joints.iter().enumerate() {
            if robot.joint_index(JointNumber(j)).is_none() {
                return wrong(format!("joints[{k}]"), format!("{} has no joint {j}", robot.name));
            }
        }
        match self.effect.form() {
            Form::Joint(law) => {
                if !(law.may_be_common() && self.place == Place::Robot) {
                    self.check_joint(robot)?;
                }
                self.check_law(law)
            }
            Form::Heard(law) => {
                let n = robot.joints();
                let Place::Hears(a, b) = self.place else {
                    return self.wrong_place("joint that hears another");
                };
                if a >= n || b >= n || a == b {
                    return wrong("place.hears", format!("[{a}, {b}]: two different ones of 0 to {}", n - 1));
                }
                self.check_law(law)
            }
            Form::Compliance(law) => {
                self.check_joint(robot)?;
                self.check_shape(&law.shapes().iter().map(|s| s.len()).collect::<Vec<_>>())?;
                self.check_amplitudes(&[4])?;
                let positive = self.amplitude[0] > 0.0 && self.amplitude[1..].iter().all(|&x| x >= 0.0);
                if !positive {
                    let what = "stiffness must be positive; damping, rotor inertia and play not negative";
                    return wrong("amplitude", what.to_owned());
                }
                Ok(())
            }
            Form::Sensitivity(law) => {
                let known = if law.together() { 1 } else { law.variants(robot).len() };
                self.check_variant(known, robot)
            }
            Form::Body(_) => match self.place {
                Place::Link(frame) if frame < robot.frames.len() => Ok(()),
                Place::Link(frame) => {
                    wrong("place.link", format!("{frame}: {} has {} frames", robot.name, robot.frames.len()))
                }
                _ => self.wrong_place("link"),
            },
            Form::Coupled => {
                let n = robot.joints();
                let Place::Pair(a, b) = self.place else { return self.wrong_place("pair") };
                if a >= n || b >= n || a == b {
                    return wrong("place.pair", format!("[{a}, {b}]: two different ones of 0 to {}", n - 1));
                }
                self.check_shape(&[1])
            }
            Form::Window => self.check_wrenches(robot),
            Form::Free => {
                self.check_joint(robot)?;
                let Some(law) = FreeLaw::from_shape(&self.shape, robot.joints()) else {
                    return wrong("shape", format!("no {} has {:?}", self.effect.id(), self.shape));
                };
                self.check_amplitudes(&[law.amplitudes()])
            }
            Form::User => self.check_user_law(robot),
        }
    }

    /// A law of a joint: its shape is one that the law offers, and its torque is finite.
    fn check_law(&self, law: &dyn JointLaw) -> Result<(), TermError> {
        let lengths: Vec<usize> = law.all_shapes(&WIDE).iter().map(Vec::len).collect();
        if self.shape.is_empty() || !law.repeats_its_shape() {
            self.check_shape(&lengths)?;
        }
        self.check_amplitudes(&[law.amplitudes(&self.shape)])?;
        let scale = self.scale.map_or(WIDE, Scale::from);
        let mut out = vec![0.0; self.amplitude.len()];
        for dq in [0.0, 1e-3, -1.0] {
            let memory = law.advance(&scale, &self.shape, 0.0, Moved { travel: dq, step: 1.0 });
            law.law(&scale, &self.shape, &At { dq, sign: 1.0, ..At::default() }, memory, &mut out);
            if out.iter().any(|x| !x.is_finite()) {
                return wrong("shape", format!("no {} has {:?}", self.effect.id(), self.shape));
            }
        }
        Ok(())
    }

    /// A law of the user on a joint of the robot, over variables of its joints.
    fn check_user_law(&self, robot: &Robot) -> Result<(), TermError> {
        let Place::Law(law) = self.place else { return self.wrong_place("joint, by a law of a user") };
        if law.joint() >= robot.joints() {
            let last = robot.joints().saturating_sub(1);
            let what = format!("{}: {} has the joints 0 to {last}", law.joint(), robot.name);
            return wrong("place.law.joint", what);
        }
        if let Err(name) = law.variables(robot) {
            return wrong("place.law.law", format!("{name}: {} has no such joint", robot.name));
        }
        if !law.has_shape(&self.shape) {
            return wrong("shape", format!("{:?} is outside of the ranges of {}", self.shape, law.id()));
        }
        self.check_amplitudes(&[law.constants().len()])
    }

    /// One of the `known` numbers of the model that the effect can be an error of.
    fn check_variant(&self, known: usize, robot: &Robot) -> Result<(), TermError> {
        let Place::Variant(v) = self.place else { return self.wrong_place("variant") };
        if v < known {
            return Ok(());
        }
        wrong("place.variant", format!("{v}: {} has {known} on {}", self.effect.id(), robot.name))
    }

    /// Forces of a contact on links that the robot has.
    fn check_wrenches(&self, robot: &Robot) -> Result<(), TermError> {
        let known = |link: usize| (1..=robot.frames.len()).contains(&link);
        match self.wrenches.iter().position(|w| !known(w.link)) {
            Some(k) => wrong(format!("wrenches[{k}].link"), format!("{} has no such link", robot.name)),
            None => Ok(()),
        }
    }

    /// Every number is finite, and what must be positive is.
    fn check_numbers(&self) -> Result<(), TermError> {
        for (field, numbers) in
            [("shape", &self.shape), ("amplitude", &self.amplitude), ("sigma", &self.sigma)]
        {
            if let Some(k) = numbers.iter().position(|x| !x.is_finite()) {
                return wrong(format!("{field}[{k}]"), "it is not a finite number".to_owned());
            }
        }
        if !self.sigma.is_empty() && self.sigma.len() < self.amplitude.len() {
            return wrong(
                "sigma",
                format!("{} values for {} amplitudes", self.sigma.len(), self.amplitude.len()),
            );
        }
        let Some(s) = self.scale else { return Ok(()) };
        for (field, value) in [("speed", s.speed), ("range", s.range), ("torque", s.torque), ("gear", s.gear)]
        {
            if !(value.is_finite() && value > 0.0) {
                return wrong(format!("scale.{field}"), format!("{value}: it must be positive"));
            }
        }
        for (field, value) in [("start", s.start), ("duration", s.duration)] {
            if !value.is_finite() {
                return wrong(format!("scale.{field}"), "it is not a finite number".to_owned());
            }
        }
        Ok(())
    }

    fn check_joint(&self, robot: &Robot) -> Result<(), TermError> {
        let n = robot.joints();
        match self.place {
            Place::Joint(j) if j < n => Ok(()),
            Place::Joint(j) => wrong(
                "place.joint",
                format!("{j}: {} has the joints 0 to {}", robot.name, n.saturating_sub(1)),
            ),
            _ => self.wrong_place("joint"),
        }
    }

    fn check_shape(&self, lengths: &[usize]) -> Result<(), TermError> {
        if lengths.contains(&self.shape.len()) {
            return Ok(());
        }
        wrong("shape", format!("{} has {}, here are {}", self.effect.id(), counts(lengths), self.shape.len()))
    }

    fn check_amplitudes(&self, counts_known: &[usize]) -> Result<(), TermError> {
        if counts_known.contains(&self.amplitude.len()) {
            return Ok(());
        }
        let (known, found) = (counts(counts_known), self.amplitude.len());
        wrong("amplitude", format!("{} has {known}, here are {found}", self.effect.id()))
    }

    fn wrong_place(&self, expected: &str) -> Result<(), TermError> {
        wrong("place", format!("{} acts on a {expected}", self.effect.id()))
    }
}

fn wrong(field: impl Into<String>, what: String) -> Result<(), TermError> {
    Err(TermError { field: field.into(), what })
}

/// `2 numbers`, `0 or 1 numbers`.
fn counts(known: &[usize]) -> String {
    let mut known = known.to_vec();
    known.sort_unstable();
    known.dedup();
    let words: Vec<String> = known.iter().map(ToString::to_string).collect();
    format!("{} numbers", words.join(" or "))
}
