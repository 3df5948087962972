//! What a torque may depend on.

use crate::model::{JointIndex, JointKind, Robot};

/// Below this part of its speeds a joint has no direction: the sign is noise there.
pub(crate) const STANDSTILL: f64 = 0.02;

/// A quantity of a joint (0-based), or of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Variable {
    /// Position.
    Position(usize),
    /// Speed, and the direction with it.
    Speed(usize),
    /// Acceleration.
    Acceleration(usize),
    /// Torque that the joint transmits to the links: inertia and gravity.
    Load(usize),
    /// Torque of the joint's drive: by the standard model, and by the laws that it has beside it.
    Torque(usize),
    /// Time in the motion.
    Time,
    /// Time since the joint last reversed or stood.
    TimeSinceReversal(usize),
    /// Distance since the joint last reversed or stood.
    TravelSinceReversal(usize),
}

impl Variable {
    /// Every variable that a torque of joint `own` may depend on, in a robot of `joints` joints. The drive of the joint
    /// itself counts by its load, the others by all of their torque.
    pub fn all(own: usize, joints: usize) -> Vec<Self> {
        let mut list = vec![Self::Time];
        for k in 0..joints {
            list.extend([
                Self::Position(k),
                Self::Speed(k),
                Self::Acceleration(k),
                if k == own { Self::Load(k) } else { Self::Torque(k) },
                Self::TimeSinceReversal(k),
                Self::TravelSinceReversal(k),
            ]);
        }
        list
    }

    /// Its number among the kinds of variables, and its joint: how it is saved.
    pub fn code(self) -> [f64; 2] {
        let (kind, joint) = match self {
            Self::Position(j) => (0, j),
            Self::Speed(j) => (1, j),
            Self::Acceleration(j) => (2, j),
            Self::Load(j) => (3, j),
            Self::Torque(j) => (4, j),
            Self::Time => (5, 0),
            Self::TimeSinceReversal(j) => (6, j),
            Self::TravelSinceReversal(j) => (7, j),
        };
        [f64::from(kind), joint as f64]
    }

    /// The variable with a code; `None` where there is none, or no such joint among `joints`.
    pub fn from_code([kind, joint]: [f64; 2], joints: usize) -> Option<Self> {
        let j = (0..joints).find(|j| *j as f64 == joint)?;
        let known = [
            Self::Position(j),
            Self::Speed(j),
            Self::Acceleration(j),
            Self::Load(j),
            Self::Torque(j),
            Self::Time,
            Self::TimeSinceReversal(j),
            Self::TravelSinceReversal(j),
        ];
        known.into_iter().find(|v| v.code() == [kind, joint])
    }

    /// The joint, where it is one's.
    pub fn joint(self) -> Option<usize> {
        match self {
            Self::Time => None,
            Self::Position(j)
            | Self::Speed(j)
            | Self::Acceleration(j)
            | Self::Load(j)
            | Self::Torque(j)
            | Self::TimeSinceReversal(j)
            | Self::TravelSinceReversal(j) => Some(j),
        }
    }

    /// Whether what depends on it fades, so that most happens where it is small: its curves bend more narrowly there.
    pub(super) fn fades(self) -> bool {
        matches!(self, Self::TimeSinceReversal(_) | Self::TravelSinceReversal(_))
    }

    /// Whether it has a direction, at whose change a torque may jump.
    pub fn has_direction(self) -> bool {
        matches!(self, Self::Speed(_))
    }

    /// Its name in the JSON: `q3`, `dq2`, `ddq1`, `load4`, `torque2`, `time`, with the numbers j of the joints.
    pub fn name(self, robot: &Robot) -> String {
        let number =
            self.joint().map_or_else(String::new, |j| robot.joint_number(JointIndex(j)).0.to_string());
        let kind = match self {
            Self::Position(_) => "q",
            Self::Speed(_) => "dq",
            Self::Acceleration(_) => "ddq",
            Self::Load(_) => "load",
            Self::Torque(_) => "torque",
            Self::Time => "time",
            Self::TimeSinceReversal(_) => "time_since_reversal",
            Self::TravelSinceReversal(_) => "travel_since_reversal",
        };
        format!("{kind}{number}")
    }

    /// What a person calls it, with the numbers j of the joints.
    pub fn words(self, number: impl Fn(usize) -> usize) -> String {
        let of = |what: &str, j: usize| format!("{what} of joint {}", number(j));
        match self {
            Self::Position(j) => of("position", j),
            Self::Speed(j) => of("speed", j),
            Self::Acceleration(j) => of("acceleration", j),
            Self::Load(j) => of("load", j),
            Self::Torque(j) => of("torque", j),
            Self::Time => "time".into(),
            Self::TimeSinceReversal(j) => of("time since the last reversal or rest", j),
            Self::TravelSinceReversal(j) => of("distance since the last reversal or rest", j),
        }
    }

    /// Its unit, where its joint is of this kind.
    pub fn unit(self, kind: JointKind) -> &'static str {
        match self {
            Self::Position(_) | Self::TravelSinceReversal(_) => kind.position_unit(),
            Self::Speed(_) => kind.speed_unit(),
            Self::Acceleration(_) => kind.acceleration_unit(),
            Self::Load(_) | Self::Torque(_) => kind.torque_unit(),
            Self::Time | Self::TimeSinceReversal(_) => "s",
        }
    }
}

/// Time and distance since a joint last reversed or stood, from instant to instant: what a contact that slides has forgotten
/// of its rest.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SinceReversal {
    /// s.
    pub time: f64,
    /// rad or m.
    pub travel: f64,
    /// Direction of motion, 0 where the joint stands.
    direction: f64,
}

impl SinceReversal {
    /// The joint has moved on by `travel` in `step` seconds and has speed `dq`, 0 where it stands.
    pub fn advance(&mut self, dq: f64, travel: f64, step: f64) {
        let direction = if dq == 0.0 { 0.0 } else { dq.signum() };
        if direction != 0.0 && direction == self.direction {
            self.time += step;
            self.travel += travel.abs();
        } else {
            *self = Self { direction, ..Self::default() };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_variable_is_found_by_its_code_and_no_other_is() {
        for own in 0..3 {
            for variable in Variable::all(own, 3) {
                assert_eq!(Variable::from_code(variable.code(), 3), Some(variable));
            }
        }
        assert_eq!(Variable::from_code([0.0, 3.0], 3), None);
        assert_eq!(Variable::from_code([0.5, 1.0], 3), None);
        assert_eq!(Variable::from_code([8.0, 1.0], 3), None);
        assert_eq!(Variable::from_code([f64::NAN, 0.0], 3), None);
    }

    #[test]
    fn time_and_distance_start_anew_at_a_reversal() {
        let mut since = SinceReversal::default();
        for (dq, travel) in [(1.0, 0.1), (1.0, 0.1), (1.0, 0.1), (-1.0, -0.1), (-1.0, -0.1)] {
            since.advance(dq, travel, 0.5);
        }
        assert!((since.time - 0.5).abs() < 1e-12 && (since.travel - 0.1).abs() < 1e-12);
    }

    #[test]
    fn time_and_distance_start_anew_after_a_rest_in_either_direction() {
        for direction in [1.0, -1.0] {
            let mut since = SinceReversal::default();
            (0..4).for_each(|_| since.advance(direction, 0.1 * direction, 0.5));
            (0..3).for_each(|_| since.advance(0.0, 1e-6 * direction, 0.5));
            assert_eq!((since.time, since.travel), (0.0, 0.0), "it stands");
            (0..3).for_each(|_| since.advance(direction, 0.1 * direction, 0.5));
            assert!((since.time - 1.0).abs() < 1e-12 && (since.travel - 0.2).abs() < 1e-12);
        }
    }
}
