//! Keeping score of a diagnosis against what was hidden.

use serde::Serialize;

use super::outcome::Finding;
use crate::effects::EffectKind;

/// An effect that was hidden in a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Hidden {
    /// Which.
    pub effect: EffectKind,
    /// Numbers j of the joints that it must be named on, any of them; empty: any joint, or none.
    pub joints: Vec<usize>,
}

/// What was found, sorted by whether it was there.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Naming {
    /// True effects that were named on their joint.
    pub named: Vec<String>,
    /// True effects that were not.
    pub missed: Vec<String>,
    /// Findings that are no true effect on its joint.
    pub false_alarms: Vec<String>,
}

impl Naming {
    /// Compares findings with what was hidden.
    pub fn of(hidden: &[Hidden], findings: &[Finding]) -> Self {
        let found: Vec<(&str, &[usize])> =
            findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect();
        Self::compared(hidden, &found)
    }

    fn compared(hidden: &[Hidden], found: &[(&str, &[usize])]) -> Self {
        let is = |h: &Hidden, (effect, joints): (&str, &[usize])| {
            effect == h.effect.id() && (h.joints.is_empty() || h.joints.iter().any(|j| joints.contains(j)))
        };
        let mut naming = Self::default();
        for h in hidden {
            let list = if found.iter().any(|&f| is(h, f)) { &mut naming.named } else { &mut naming.missed };
            list.push(label(h.effect.id(), &h.joints));
        }
        let alarms = found.iter().filter(|&&f| !hidden.iter().any(|h| is(h, f)));
        naming.false_alarms = alarms.map(|(effect, joints)| label(effect, joints)).collect();
        naming
    }

    /// Whether everything hidden was named, and nothing else.
    pub fn is_right(&self) -> bool {
        self.missed.is_empty() && self.false_alarms.is_empty()
    }
}

/// An effect and its joints in a word.
pub fn label(effect: &str, joints: &[usize]) -> String {
    let on: Vec<String> = joints.iter().map(ToString::to_string).collect();
    if on.is_empty() { effect.to_owned() } else { format!("{effect}@{}", on.join("+")) }
}

/// Share of a gap that has to be closed.
pub const ENOUGH: f64 = 0.8;

/// A gap below this share of the standard model's error is too small to be judged by.
pub const LEAST_GAP: f64 = 0.02;

/// Relative errors of the torques on a motion that took no part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TestErrors {
    /// The standard model.
    pub before: f64,
    /// With what was found.
    pub after: f64,
    /// With the true effects, fitted to the same recording; `None` where they cannot be.
    pub true_effect: Option<f64>,
}

impl TestErrors {
    /// Share of the gap between the standard model and the model with the true effects that the findings close;
    /// `None` where there is no gap to speak of.
    pub fn closed(&self) -> Option<f64> {
        let gap = self.before - self.true_effect?;
        (gap >= LEAST_GAP * self.before).then(|| (self.before - self.after) / gap)
    }
}

/// How a case ended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Scored {
    /// Name of its folder.
    pub case: String,
    /// Robot.
    pub robot: String,
    /// Time of the diagnosis, s.
    pub seconds: f64,
    /// What was named.
    #[serde(flatten)]
    pub naming: Naming,
    /// Errors on `test.yaml`.
    pub test: Option<TestErrors>,
    /// Share of the gap that was closed; `null` where the case was judged by naming only.
    pub gap_closed: Option<f64>,
    /// Why there is no diagnosis.
    pub refused: Option<String>,
    /// Whether it counts as solved; `null` without a truth.
    pub solved: Option<bool>,
}

impl Scored {
    /// A case is solved when every true effect is named on its joint, nothing else is named, and 80 % of the gap on
    /// `test.yaml` are closed where there is one.
    pub fn judge(mut self, has_truth: bool) -> Self {
        self.gap_closed = self.test.and_then(|test| test.closed());
        let enough = self.gap_closed.is_none_or(|closed| closed >= ENOUGH);
        self.solved = has_truth.then_some(self.refused.is_none() && self.naming.is_right() && enough);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hidden(effect: EffectKind, joints: &[usize]) -> Hidden {
        Hidden { effect, joints: joints.to_vec() }
    }

    #[test]
    fn an_effect_on_another_joint_is_missed_and_a_false_alarm() {
        let truth = [hidden(EffectKind::Spring, &[4]), hidden(EffectKind::Payload, &[])];
        let naming = Naming::compared(&truth, &[("spring", &[3]), ("payload", &[])]);
        assert_eq!(naming.named, ["payload"]);
        assert_eq!(naming.missed, ["spring@4"]);
        assert_eq!(naming.false_alarms, ["spring@3"]);
        assert!(!naming.is_right());
        assert!(Naming::compared(&[], &[]).is_right());
    }

    fn scored(naming: Naming, test: Option<TestErrors>) -> Scored {
        let (case, robot) = ("a".to_owned(), "tx40".to_owned());
        Scored { case, robot, seconds: 1.0, naming, test, gap_closed: None, refused: None, solved: None }
            .judge(true)
    }

    #[test]
    fn four_fifths_of_the_gap_must_be_closed_where_there_is_one() {
        let errors = |after, truth| Some(TestErrors { before: 0.1, after, true_effect: truth });
        assert_eq!(scored(Naming::default(), errors(0.061, Some(0.05))).solved, Some(false));
        assert_eq!(scored(Naming::default(), errors(0.059, Some(0.05))).solved, Some(true));
        for no_gap in [errors(0.1, Some(0.099)), errors(0.1, Some(0.12)), errors(0.1, None), None] {
            let case = scored(Naming::default(), no_gap);
            assert_eq!((case.solved, case.gap_closed), (Some(true), None));
        }
    }
}
