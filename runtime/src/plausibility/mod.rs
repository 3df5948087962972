//! Whether a recording can be one of the robot that it names: what physics says, and what would explain it better.

mod channels;
mod instead;
mod judged;
mod position;
mod table;
mod tilt;
mod zeros;

pub use channels::{ChannelFault, faulty_channel};
pub use instead::{AngleUnit, Instead, Signal};
pub use judged::Judged;

use std::f64::consts::FRAC_1_SQRT_2;

use crate::estimation::observe::Observation;
use crate::estimation::{Estimate, PhysicalFit, physical_fit};
use crate::model::{JointIndex, Model};
use crate::parallel;
use instead::{POOR, mistakes, other_gravities, single_mistakes};
use position::with_torques_over_position;
use tilt::best_tilt;
use zeros::other_zeros;

/// Strain from which the parameters are said not to be those of a real robot.
const STRAINED: f64 = 1.1;
/// A joint's error from which other directions of gravity and other zeros are tried: parameters of several links can take over
/// most of a gravity that points the other way.
const GRAVITY: f64 = 0.05;
/// A joint's error, and a strain, from which signs and units of single joints are tried as well. These limits cost time
/// only: what is believed is decided by [`ROBOT`] and [`MISTAKE`].
const DOUBTFUL: f64 = 0.125;
const TENSE: f64 = 1.05;
/// A joint's error, and a strain, from which orders, units of angles and offsets are tried as well.
const BAD: f64 = 0.5;
const OVERSTRAINED: f64 = 2.0;
/// Another robot is believed where it lowers the joints' errors by this factor, on their geometric mean.
const ROBOT: f64 = 1.25;
/// A mistake about one or two joints is believed where it lowers the joints' errors as if that of one of them were
/// halved. What a recording does not say anything about, as the sign of an axis that nothing is coupled to, changes
/// no error.
const MISTAKE: f64 = 2.0;
/// Robots count as equally good where they lower the errors within this share of the best.
const AS_GOOD: f64 = 0.95;
/// So do mistakes of one kind, of the logarithm of the best: two signs that nearly undo each other are both named.
const NEARLY: f64 = 0.75;
/// What parameters that no robot can have do not explain this nearly, those of a robot do not either.
const PROMISING: f64 = 0.9;
/// A joint's error where half of its squared torque is explained.
const HALF: f64 = FRAC_1_SQRT_2;

/// Equations for each parameter from which mistakes are looked for: with fewer, errors of single joints are what the
/// parameters happened to leave there, and halve by accident.
const ENOUGH_ROWS: f64 = 3.0;

/// What physics says of a recording.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Verdict {
    /// The robot can have made it, or nothing can be said.
    Plausible,
    /// It can have made it, but the free parameters are none that a robot can have.
    Strained {
        /// Relative error with the best parameters that a robot can have.
        possible: f64,
        /// The same of the free ones.
        free: f64,
    },
    /// Something else explains it far better.
    Better {
        /// Relative error with the best parameters that such a robot can have.
        own: f64,
        /// The joint that these explain worst, and its error.
        worst: (JointIndex, f64),
        /// What explains it better, with its error: the best first, and others of its kind (robots, signs, units, ...)
        /// that are as good.
        instead: Vec<(Instead, f64)>,
    },
    /// The torques of some joints depend on their own positions as those of no rigid robot do: a spring, a cable.
    OverPosition {
        /// Which joints, each with its error with the best parameters that a robot can have, and with such a torque too.
        joints: Vec<(JointIndex, [f64; 2])>,
    },
    /// No such robot can have made it, and nothing that was tried explains it.
    Impossible {
        /// The joint of which physics takes most away.
        joint: JointIndex,
        /// Its error with the best parameters that a robot can have.
        error: f64,
    },
}

/// Judges whether a recording can be one of its robot. `torques` are its torque equations, `estimated` their free
/// weighted estimate, `others` the robots that it could be of instead.
///
/// The free fit is compared with the best one that a real robot can have ([`physical_fit`]). Where physics costs
/// something or a joint is explained poorly, other robots of the same joints are tried, other directions of gravity, and
/// signs and units of single joints, other zeros; where it costs much or a joint is explained badly, so are orders of
/// columns, units of angles and offsets.
pub fn judge(
    judged: &Judged<'_>,
    torques: &Observation,
    estimated: &Estimate,
    others: &[&dyn Model],
) -> Verdict {
    let robot = judged.model.robot();
    let Some(own) = physical_fit(robot, torques, estimated) else { return Verdict::Plausible };
    // Without any torque there is nothing to judge.
    let (Some(overall), Some(free)) = (own.relative_error, estimated.relative_error) else {
        return Verdict::Plausible;
    };
    let errors = errors_of(&own.per_equation);
    let Some(worst) = largest(errors.len(), |j| errors[j]) else { return Verdict::Plausible };
    let error = errors[worst];
    let instead = if estimated.rows_per_parameter() < ENOUGH_ROWS {
        Vec::new()
    } else {
        let found = better(judged, others, &candidates(judged, others, &own, error), &own);
        simpler(judged, found, &own)
    };
    let impossible = impossible(&errors, estimated);
    let best = instead.first().map_or(f64::INFINITY, |(_, error)| *error);
    if let Some((joints, error)) = over_position(judged, estimated, &errors, &impossible)
        && error < best
    {
        return Verdict::OverPosition { joints };
    }
    if !instead.is_empty() {
        let worst = (JointIndex(worst), error);
        return Verdict::Better { own: overall, worst, instead };
    }
    if let Some(&joint) = impossible.first() {
        return Verdict::Impossible { joint, error: errors[joint.0] };
    }
    if own.strain > STRAINED {
        return Verdict::Strained { possible: overall, free };
    }
    Verdict::Plausible
}

/// What is tried instead of what was declared: the more, the worse the best parameters of a real robot do. `error` is that
/// of the joint that they explain worst.
fn candidates(judged: &Judged<'_>, others: &[&dyn Model], own: &PhysicalFit, error: f64) -> Vec<Instead> {
    let (robot, mut candidates) = (judged.model.robot(), Vec::new());
    if own.strain > STRAINED || error > POOR {
        let kinds = robot.joint_kinds();
        let alike =
            |other: &&&dyn Model| other.robot().name != robot.name && other.robot().joint_kinds() == kinds;
        candidates.extend(others.iter().filter(alike).map(|m| Instead::Robot(m.robot().name.to_string())));
    }
    if own.strain > TENSE || error > DOUBTFUL || table::beyond_a_turn(robot) {
        candidates.extend(single_mistakes(robot));
    }
    if candidates.is_empty() && error > GRAVITY {
        candidates.extend(other_gravities(robot));
    }
    if own.strain > OVERSTRAINED || error > BAD {
        candidates.extend(mistakes(robot, own));
    }
    if error > GRAVITY {
        candidates.extend(other_zeros(judged, own).map(Instead::Zeros));
    }
    candidates
}

/// Joints of which physics takes more than a quarter of the squared torque and leaves less than half of it explained, the
/// one of which it takes most first. `errors` are those with the best parameters that a robot can have.
fn impossible(errors: &[f64], free: &Estimate) -> Vec<JointIndex> {
    let free = errors_of(&free.per_equation);
    let taken = |j: usize| errors[j].powi(2) - free[j].powi(2);
    let mut joints: Vec<usize> = (0..errors.len()).filter(|&j| errors[j] > HALF && taken(j) > 0.25).collect();
    joints.sort_by(|&a, &b| taken(b).total_cmp(&taken(a)));
    joints.into_iter().map(JointIndex).collect()
}

/// Impossible joints whose errors a torque over their own position lowers as much as a mistake must that is believed, where
/// that leaves no impossible joint: each with its errors before and after, and that of all joints after.
fn over_position(
    judged: &Judged<'_>,
    free: &Estimate,
    before: &[f64],
    joints: &[JointIndex],
) -> Option<(Vec<OfJoint>, f64)> {
    if joints.is_empty() {
        return None;
    }
    let (after, overall) = with_torques_over_position(judged, joints)?;
    let explained = joints.iter().all(|j| MISTAKE * after[j.0] <= before[j.0]);
    let all = || joints.iter().map(|&j| (j, [before[j.0], after[j.0]])).collect();
    (explained && impossible(&after, free).is_empty()).then(|| (all(), overall))
}

/// A joint with its errors before and after.
type OfJoint = (JointIndex, [f64; 2]);

/// Relative errors, 0 for a joint without torque: nothing of it is left unexplained.
fn errors_of(per_equation: &[Option<f64>]) -> Vec<f64> {
    per_equation.iter().map(|error| error.unwrap_or_default()).collect()
}

/// The joint with the largest value.
fn largest(joints: usize, value: impl Fn(usize) -> f64) -> Option<usize> {
    (0..joints).max_by(|&a, &b| value(a).total_cmp(&value(b)))
}

/// By which factor something lowers the joints' errors, what it is, and the error that it leaves.
type Found = (f64, Instead, f64);

/// What explains the recording far better than what was declared: the best, and others of its kind that are as good.
fn better(
    judged: &Judged<'_>,
    others: &[&dyn Model],
    candidates: &[Instead],
    own: &PhysicalFit,
) -> Vec<Found> {
    // Joints that stand still have no error that could be lowered.
    let judged_by = own.per_equation.iter().filter(|error| error.is_some_and(|e| e > 0.0)).count();
    let tried = |candidate: &Instead| {
        let enough = match *candidate {
            Instead::Robot(_) => ROBOT,
            _ => MISTAKE.powf(1.0 / judged_by.max(1) as f64),
        };
        let promising = |free: &[Option<f64>]| ratio(&own.per_equation, free) >= PROMISING * enough;
        let fit = candidate.fit(judged, others, promising)?;
        let better = ratio(&own.per_equation, &fit.per_equation);
        let error = fit.relative_error?;
        let explains = match *candidate {
            // A factor of a thousand is the worst that is wrong: what is explained worst is explained by it.
            Instead::Scale { .. } => {
                let [before, after] =
                    [own, &fit].map(|f| errors_of(&f.per_equation).into_iter().fold(0.0, f64::max));
                MISTAKE * after <= before
            }
            // Several angles that are free take more than one mistake does.
            Instead::Zeros(_) => own.relative_error.is_some_and(|own| MISTAKE * error <= own),
            // Nor is a joint made right by what makes the torques of all together worse.
            _ => own.relative_error.is_none_or(|own| error <= own),
        };
        (better >= enough && explains).then(|| (better, candidate.clone(), error))
    };
    let found = parallel::map(judged.settings.threads, candidates.len(), |k| tried(&candidates[k]));
    let mut all: Vec<Found> = found.into_iter().flatten().collect();
    // Angles are fitted: what takes no number, and does nearly as well, comes first.
    let rank = |(better, instead, _): &Found| match instead {
        Instead::Zeros(_) => better.powf(NEARLY),
        _ => *better,
    };
    all.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
    let best = all.first().map_or(0.0, |first| first.0);
    let Some(first) = all.first().map(|(_, instead, _)| instead.clone()) else { return Vec::new() };
    let least = match first {
        Instead::Robot(_) => AS_GOOD * best,
        _ => best.powf(NEARLY),
    };
    all.retain(|(better, instead, _)| instead.same_family(&first) && *better > least);
    if exclude_each_other(all.iter().map(|(_, instead, _)| instead)) {
        return Vec::new();
    }
    all
}

/// What explains the recording as well as `found` and supposes less: a base that is tilted, where it would be another robot or gravity
/// along another axis; a torque over the position of a joint whose torque would be in another unit or of the other sign, and that is no
/// mistake.
fn simpler(judged: &Judged<'_>, found: Vec<Found>, own: &PhysicalFit) -> Vec<(Instead, f64)> {
    let without_ratio =
        |found: Vec<Found>| found.into_iter().map(|(_, instead, error)| (instead, error)).collect();
    let Some((better, first, _)) = found.first() else { return Vec::new() };
    match *first {
        Instead::Robot(_) | Instead::Gravity(_) => match best_tilt(judged, own) {
            Some(tilt) if tilt.0 >= *better => without_ratio(vec![tilt]),
            _ => without_ratio(found),
        },
        Instead::Scale { joint, .. } | Instead::Sign { joint, of: Signal::Torque } => {
            let after = with_torques_over_position(judged, &[joint]).map(|(errors, _)| errors);
            let errors: Option<Vec<Option<f64>>> = after.map(|errors| errors.into_iter().map(Some).collect());
            let is_position = errors.is_some_and(|errors| ratio(&own.per_equation, &errors) >= *better);
            if is_position { Vec::new() } else { without_ratio(found) }
        }
        _ => without_ratio(found),
    }
}

/// Whether gravities along several axes are among what is as good. It has one: a recording that any other one explains has
/// something else in its torques that goes with the pose, as a sensor that hears a neighbour.
fn exclude_each_other<'a>(instead: impl Iterator<Item = &'a Instead>) -> bool {
    let axis = |instead: &Instead| match instead {
        Instead::Gravity(g) => g.iter().position(|g| *g != 0.0),
        _ => None,
    };
    let mut axes = instead.filter_map(axis);
    let first = axes.next();
    axes.any(|axis| Some(axis) != first)
}

/// Geometric mean of the joints' errors over those of another fit.
fn ratio(own: &[Option<f64>], other: &[Option<f64>]) -> f64 {
    let pairs = own.iter().zip(other).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
    let pairs: Vec<f64> = pairs.filter(|(a, b)| *a > 0.0 && *b > 0.0).map(|(a, b)| (a / b).ln()).collect();
    (pairs.iter().sum::<f64>() / pairs.len().max(1) as f64).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gravities_along_several_axes_exclude_each_other_and_both_ways_along_one_do_not() {
        let [down, up, aside] = [[0.0, 0.0, -9.81], [0.0, 0.0, 9.81], [9.81, 0.0, 0.0]].map(Instead::Gravity);
        assert!(exclude_each_other([&up, &aside].into_iter()));
        assert!(!exclude_each_other([&up, &down].into_iter()));
        let sign = |joint| Instead::Sign { of: Signal::Torque, joint: JointIndex(joint) };
        assert!(!exclude_each_other([&sign(0), &sign(1)].into_iter()));
        assert!(!exclude_each_other(std::iter::empty()));
    }
}
