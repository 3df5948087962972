//! What a case hides: which effect, where, and its drawn shape.

use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::{JointKind, Model, ParameterKind, Robot};

use crate::random::Random;

/// An effect that is hidden.
#[derive(Debug, Clone)]
pub struct Secret {
    /// Which.
    pub effect: EffectKind,
    /// 0-based joint that it must be named on; `None` where it is the whole robot's.
    pub joint: Option<usize>,
    /// What its law needs of chance, each uniform in 0..1.
    pub chance: [f64; 4],
    /// Largest torque of its joint in what is diagnosed, N.m or N; 0 where its law does not count against it.
    pub most_torque: f64,
}

impl Secret {
    /// Draws a place and a shape. A joint that is `taken` is used only where there is no other.
    pub fn draw(
        effect: EffectKind,
        model: &dyn Model,
        taken: Option<usize>,
        random: &mut Random,
    ) -> Option<Self> {
        let places = places(effect, model);
        let joint = match places {
            Places::Robot => None,
            Places::Joints(mut joints) => {
                if joints.len() > 1 {
                    joints.retain(|j| Some(*j) != taken);
                }
                Some(*joints.get(random.below(joints.len()))?)
            }
        };
        Some(Self { effect, joint, chance: std::array::from_fn(|_| random.share()), most_torque: 0.0 })
    }

    /// The k-th number of chance, uniform in `low..high`.
    pub fn between(&self, k: usize, low: f64, high: f64) -> f64 {
        low + (high - low) * self.chance[k]
    }

    /// When a contact lasts, s.
    pub fn window(&self) -> [f64; 2] {
        let from = self.between(2, 1.5, 5.0);
        [from, from + self.between(3, 0.4, 0.7)]
    }
}

/// Whether the effect is a change since an earlier recording.
pub fn is_change(effect: EffectKind) -> bool {
    effect.needs_baseline() || matches!(effect, EffectKind::TorqueConstantError | EffectKind::BaseTilt)
}

enum Places {
    Robot,
    Joints(Vec<usize>),
}

/// Joints on which an effect can show at all.
fn places(effect: EffectKind, model: &dyn Model) -> Places {
    use EffectKind as E;
    let robot = model.robot();
    let n = robot.joints();
    let revolute = revolute(robot);
    Places::Joints(match effect {
        E::BaseTilt | E::TimeDelay | E::WrongSampleRate | E::Contact => return Places::Robot,
        E::Payload => vec![n - 1],
        E::AddedMass => (1..n - 1).collect(),
        // Turning about the first axis, or the last link about its own, is turning the frames.
        E::PositionOffset => (1..n - 1).filter(|&j| revolute[j]).collect(),
        E::GeometryError => lengths(robot).into_iter().map(|l| l.joint).collect(),
        E::CoupledTransmission => {
            (1..n).filter(|&j| revolute[j - 1] && revolute[j] && !coupled(robot, j)).collect()
        }
        E::JointElasticity | E::Backlash => {
            (0..n).filter(|&j| revolute[j] && !coupled(robot, j) && swings(model, j)).collect()
        }
        _ => (0..n).collect(),
    })
}

fn revolute(robot: &Robot) -> Vec<bool> {
    robot.joint_kinds().iter().map(|&kind| kind == JointKind::Revolute).collect()
}

/// Whether a motor turns with this joint and another.
fn coupled(robot: &Robot, joint: usize) -> bool {
    let n = robot.joints();
    let gear = |motor: usize, joint: usize| robot.drive.gear.get(motor * n + joint).copied().unwrap_or(0.0);
    (0..n).any(|other| other != joint && (gear(joint, other) != 0.0 || gear(other, joint) != 0.0))
}

/// Rotor and link inertia of a joint in the zero position, kg.m2.
pub fn inertias(model: &dyn Model, joint: usize) -> [f64; 2] {
    let robot = model.robot();
    let n = robot.joints();
    let Some(nominal) = &robot.nominal else { return [0.0; 2] };
    let chi = robot.base_from_standard(&nominal.standard);
    let (rest, mut mass, mut bias) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n]);
    model.mass_and_bias(&chi, &rest, &rest, &mut mass, &mut bias);
    let rotor = of_joint(robot, ParameterKind::Ia, joint).map_or(0.0, |k| nominal.standard[k]);
    [rotor, mass[joint * (n + 1)] - rotor]
}

/// Behind a spring, a link that is light beside its rotor is not felt.
fn swings(model: &dyn Model, joint: usize) -> bool {
    let [rotor, link] = inertias(model, joint);
    rotor > 0.0 && link > 0.3 * rotor
}

/// A joint's own parameter in chi_st.
pub fn of_joint(robot: &Robot, kind: ParameterKind, joint: usize) -> Option<usize> {
    let joint_of = robot.joint_of_frame();
    (0..robot.standard.len())
        .find(|&k| robot.standard[k].kind == kind && joint_of[robot.standard[k].frame] == Some(joint))
}

/// A length of the table whose error acts on the torques.
#[derive(Debug, Clone, Copy)]
pub struct Length {
    /// Frame, 0-based.
    pub frame: usize,
    /// Whether it is d; otherwise r.
    pub is_d: bool,
    /// Joint that it is named on.
    pub joint: usize,
}

/// Lengths between axes. Those along the first axis and along the last only move the frames.
pub fn lengths(robot: &Robot) -> Vec<Length> {
    let joint_of = robot.joint_of_frame();
    let last = joint_of.iter().rposition(Option::is_some).unwrap_or(0);
    let mut all = Vec::new();
    for (frame, row) in robot.frames.iter().enumerate().take(last + 1).skip(1) {
        let Some(joint) = joint_of[frame] else { continue };
        if row.d != 0.0 {
            all.push(Length { frame, is_d: true, joint });
        }
        if row.r != 0.0 && frame < last && row.kind == JointKind::Revolute {
            all.push(Length { frame, is_d: false, joint });
        }
    }
    all
}
