//! Sentences for a person.

use crate::diagnosis::outcome::{Diagnosis, Finding, NotJudged};
use crate::effects::EffectKind;
use crate::model::Robot;
use crate::report::falls_or_rises;

/// A number with three significant digits.
fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let digits = (2 - x.abs().log10().floor() as i32).clamp(0, 9) as usize;
    format!("{x:.digits$}")
}

fn quantity(finding: &Finding, name: &str) -> String {
    finding.parameters.get(name).map_or_else(String::new, |p| {
        let unit = if p.unit == "1" { String::new() } else { format!(" {}", p.unit) };
        if p.sigma > 0.0 && p.sigma < p.value.abs() {
            format!("{} ± {}{unit}", short(p.value), short(p.sigma))
        } else {
            format!("{}{unit}", short(p.value))
        }
    })
}

/// What was found, where, how large, and what it gains.
pub(in crate::diagnosis) fn sentence(robot: &Robot, effect: EffectKind, f: &Finding) -> String {
    let words = effect.words();
    let place = match f.joints.as_slice() {
        [] => format!("On the whole {}", robot.name),
        [j] => format!("On joint {j}"),
        many => {
            format!("On joints {}", many.iter().map(ToString::to_string).collect::<Vec<_>>().join(" and "))
        }
    };
    let q = |name: &str| quantity(f, name);
    let detail = match effect {
        EffectKind::Stribeck => {
            format!("{} more friction close to rest, gone above about {}", q("fs"), q("vs"))
        }
        EffectKind::NonlinearViscous => format!("friction bends with speed to the power {}", q("p")),
        EffectKind::LoadDependentFriction => format!("friction grows by {} of the load torque", q("mu")),
        EffectKind::PositionDependentFriction => {
            format!("the friction level swings by {} along the travel", q("amplitude"))
        }
        EffectKind::AsymmetricFriction => {
            format!("viscous friction differs by direction, half the difference is {}", q("half_difference"))
        }
        EffectKind::PreslidingHysteresis => {
            format!("{} of the friction builds up over {} after a reversal", q("level"), q("distance"))
        }
        EffectKind::FrictionDrift => format!("friction fades with a time constant of {}", q("tau")),
        EffectKind::FrictionLevelChange => format!("friction is {} times that of the baseline", q("factor")),
        EffectKind::TorqueRipple => format!(
            "a torque ripple of {} at {} waves per joint turn, that is {} per motor turn",
            q("amplitude"),
            q("order"),
            q("order_per_motor_turn")
        ),
        EffectKind::Spring if f.parameters.contains_key("k") => format!("a spring of {}", q("k")),
        EffectKind::Spring => "a spring that acts through a lever".into(),
        EffectKind::Payload | EffectKind::AddedMass => {
            format!("a body of {} at ({}, {}, {})", q("mass"), q("x"), q("y"), q("z"))
        }
        EffectKind::BaseTilt => format!("the base is tilted by {} and {}", q("tilt_1"), q("tilt_2")),
        EffectKind::CoupledTransmission => {
            format!("its motor also turns with the neighbour, ratio {}", q("ratio"))
        }
        EffectKind::TorqueConstantError => {
            format!("the recorded torque is {} times the real one", q("factor"))
        }
        EffectKind::TorqueSaturation => {
            format!("the torque constant is off by {} at the highest torque", q("droop_at_most_torque"))
        }
        EffectKind::JointElasticity => {
            format!("the transmission is a spring of {}, ringing at about {}", q("k"), q("frequency"))
        }
        EffectKind::Backlash => format!("there is a play of {}", q("gap")),
        EffectKind::TimeDelay => format!("torques were recorded {} after the positions", q("delay")),
        EffectKind::WrongSampleRate => {
            format!("the true sampling rate differs by a fraction of {}", q("rate_error"))
        }
        EffectKind::PositionOffset => format!("the encoder zero is off by {}", q("offset")),
        EffectKind::GeometryError => {
            format!("a length of the table is off by {}{}", q("error_d"), q("error_r"))
        }
        EffectKind::Contact => String::new(),
    };
    format!(
        "{place}: {}. {}: {detail}. Held-out error of {} {} from {:.2} % to {:.2} %.",
        words.title.to_lowercase(),
        capital(words.what.trim_end_matches('.')),
        if f.joints.is_empty() { "all joints" } else { "its joints" },
        falls_or_rises(f.held_out_before, f.held_out_after),
        100.0 * f.held_out_before,
        100.0 * f.held_out_after
    )
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |c| c.to_uppercase().collect::<String>() + chars.as_str())
}

/// A contact.
pub(in crate::diagnosis) fn contact(f: &Finding) -> String {
    let windows: Vec<String> = f
        .contacts
        .iter()
        .map(|w| {
            let place = if w.force == [0.0; 3] {
                let joints: Vec<String> = w
                    .joint_torques
                    .iter()
                    .map(|t| format!("{} ({} N.m)", t.joint, short(t.largest)))
                    .collect();
                format!("joint {}", joints.join(" and "))
            } else {
                format!("link {}", w.link)
            };
            format!("{} from {:.2} s to {:.2} s on {place}", w.motion, w.window[0], w.window[1])
        })
        .collect();
    let much = if f.parameters.contains_key("largest_force") {
        quantity(f, "largest_force")
    } else {
        quantity(f, "largest_joint_torque")
    };
    let why = if f.contacts.iter().any(|w| w.force != [0.0; 3]) {
        " Several joints jump together in the ratio of one force on one link."
    } else {
        ""
    };
    format!("Something pushed the robot, with up to {much}: {}.{why}", windows.join("; "))
}

/// Joints about which nothing is said.
pub(in crate::diagnosis) fn not_judged(joints: &[NotJudged]) -> Option<String> {
    let list: Vec<String> = joints.iter().map(|j| j.joint.to_string()).collect();
    match list.as_slice() {
        [] => None,
        [one] => Some(format!("Joint {one} hardly moves: nothing is said about it.")),
        [most @ .., last] => {
            Some(format!("Joints {} and {last} hardly move: nothing is said about them.", most.join(", ")))
        }
    }
}

/// The verdict first.
pub(in crate::diagnosis) fn verdict(d: &Diagnosis) -> Vec<String> {
    let mut lines = Vec::new();
    if d.findings.is_empty() {
        lines.push(format!(
            "The standard model explains this recording: its held-out error is {:.2} %, and none of {} things tried improves it reliably.",
            100.0 * d.held_out.before,
            d.tried
        ));
    } else {
        let names: Vec<String> = d
            .findings
            .iter()
            .map(|f| {
                let title = EffectKind::from_id(&f.effect).map_or("", |k| k.words().title).to_lowercase();
                match f.joints.as_slice() {
                    [] => title,
                    joints => {
                        let list: Vec<String> = joints.iter().map(ToString::to_string).collect();
                        format!("{title} on joint {}", list.join(" and "))
                    }
                }
            })
            .collect();
        lines.push(format!("The standard model leaves out: {}.", names.join("; ")));
        lines.push(format!(
            "With it, the error on motion that was held back ({}) {} from {:.2} % to {:.2} %.",
            d.held_out.how,
            falls_or_rises(d.held_out.before, d.held_out.after),
            100.0 * d.held_out.before,
            100.0 * d.held_out.after
        ));
    }
    if d.unexplained.share > 0.3 {
        lines.push(format!(
            "{:.0} % of what remains is not noise: something is left that nothing in the catalogue explains.",
            100.0 * d.unexplained.share
        ));
    }
    lines
}
