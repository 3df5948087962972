//! What a format cannot hold, with units and formulas: printed, and written beside the file.

use std::path::{Path, PathBuf};

use dynid_runtime::effects::EffectTerm;
use dynid_runtime::model::{Coupling, JointIndex, ParameterKind, Robot, StandardParameter};
use dynid_runtime::model_file::Bodies;
use dynid_runtime::report::significant;
use dynid_urdf::stiffness_and_rest;
use serde::Serialize;

use super::Target;
use super::bodies::Fitted;
use crate::body_report::report;
use crate::failure::Failure;
use crate::output::{print, write_json};

/// How large gravity is for every reader of a URDF, m/s2.
const GRAVITY: f64 = 9.81;

/// One thing that a format cannot hold.
#[derive(Debug, Serialize)]
struct LeftOut {
    /// What it is.
    name: String,
    /// Numbers of its joints in the table.
    joints: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    unit: String,
    /// Torque of the joint, N.m or N, from the joint's q, dq, ddq.
    formula: String,
    /// An effect with its shape and amplitudes, as a model file has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    effect: Option<EffectTerm>,
}

/// A parameter as it was written, and who decided it.
#[derive(Debug, Serialize)]
struct Written<'a> {
    name: &'a str,
    value: f64,
    unit: &'static str,
    prior: f64,
    /// Part of it that the data decided; the rest is the prior's.
    #[serde(skip_serializing_if = "Option::is_none")]
    from_data: Option<f64>,
}

/// A base parameter as the bodies have it.
#[derive(Debug, Serialize)]
struct Base<'a> {
    name: &'a str,
    value: f64,
    unit: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    identified: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sigma: Option<f64>,
}

/// What is written beside an exported file.
#[derive(Debug, Serialize)]
struct Beside<'a> {
    robot: &'a str,
    model: &'a str,
    not_in_the_format: Vec<LeftOut>,
    /// Squared distance of the base parameters from the identified ones in units of their uncertainty, and the least that
    /// bodies can have.
    #[serde(skip_serializing_if = "Option::is_none")]
    distance: Option<[f64; 2]>,
    /// What holds the bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    bodies: Option<Bodies>,
    standard_parameters: Vec<Written<'a>>,
    base_parameters: Vec<Base<'a>>,
}

/// Says what the format cannot hold, and writes it beside `out` with every parameter; returns the path.
pub(super) fn tell(fitted: &Fitted, to: Target, what: &str, out: &Path) -> Result<(), Failure> {
    let beside = beside(out);
    let left_out = left_out(fitted, to);
    let format = if to == Target::Urdf { "URDF" } else { "MJCF" };
    let mut text = String::new();
    if !left_out.is_empty() {
        text.push_str(&format!("\n{format} cannot hold (all of it is in {}):", beside.display()));
        for one in &left_out {
            let value =
                one.value.map_or_else(String::new, |v| format!(" {} {}", significant(v, 4), one.unit));
            text.push_str(&format!("\n  {}{value}: {}", one.name, one.formula));
        }
        text.push('\n');
    }
    print(&format!("{}\n{text}\nwritten: {}", fitted.words(), out.display()));
    let robot = &fitted.robot;
    let near = fitted.identified.as_ref();
    let chi = robot.base_from_standard(&fitted.standard);
    let named =
        |name: &str| near.and_then(|(model, _)| model.base_parameters.iter().find(|p| p.name == name));
    write_json(
        &beside,
        &Beside {
            robot: &robot.name,
            model: what,
            not_in_the_format: left_out,
            distance: near.map(|(_, bodies)| [bodies.near.distance, bodies.near.least]),
            bodies: near.map(|(_, bodies)| report(bodies, robot, None, None)),
            standard_parameters: (0..robot.standard.len())
                .map(|k| Written {
                    name: &robot.standard[k].name,
                    value: fitted.standard[k],
                    unit: robot.standard[k]
                        .unit(robot.frames[robot.standard[k].frame].kind, &robot.couplings),
                    prior: fitted.prior[k],
                    from_data: near.map(|(_, bodies)| bodies.near.from_data[k]),
                })
                .collect(),
            base_parameters: (0..robot.base.len())
                .map(|k| Base {
                    name: &robot.base[k].name,
                    value: chi[k],
                    unit: &robot.base[k].unit,
                    identified: named(&robot.base[k].name).map(|p| p.value),
                    sigma: named(&robot.base[k].name).and_then(|p| p.sigma),
                })
                .collect(),
        },
    )
}

/// `better.urdf` has `better.urdf.json` beside it.
fn beside(out: &Path) -> PathBuf {
    let mut name = out.as_os_str().to_owned();
    name.push(".json");
    name.into()
}

fn left_out(fitted: &Fitted, to: Target) -> Vec<LeftOut> {
    let robot = &fitted.robot;
    let mut list = Vec::new();
    for (k, p) in robot.standard.iter().enumerate() {
        let value = fitted.standard[k];
        let formula = match p.coupling.and_then(|c| robot.couplings.get(c)) {
            Some(coupling) if to == Target::Mjcf && is_tendon(fitted, p, coupling, value) => None,
            Some(coupling) => of_coupling(robot, p, coupling, value),
            None => formula(robot, p.kind, p.frame, value, to),
        };
        let Some(formula) = formula else { continue };
        let unit = p.unit(robot.frames[p.frame].kind, &robot.couplings).to_owned();
        let joints = match p.coupling {
            Some(_) => robot.acts_on(p).iter().map(|t| robot.joint_number(JointIndex(t.0)).0).collect(),
            None => vec![p.frame + 1],
        };
        list.push(LeftOut {
            name: p.name.to_string(),
            joints,
            value: Some(value),
            unit,
            formula,
            effect: None,
        });
    }
    let size = robot.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
    if to == Target::Urdf && (size - GRAVITY).abs() > 1e-9 {
        list.push(LeftOut {
            name: "gravity".to_owned(),
            joints: Vec::new(),
            value: Some(size),
            unit: "m/s2".to_owned(),
            formula: format!("readers of a URDF take {GRAVITY}"),
            effect: None,
        });
    }
    let Some((identified, _)) = &fitted.identified else { return list };
    for term in &identified.effects {
        list.push(LeftOut {
            name: term.id().to_owned(),
            joints: term.joints.clone(),
            value: None,
            unit: String::new(),
            formula: term.effect.words().what.to_owned(),
            effect: Some(term.clone()),
        });
    }
    if identified.delay != 0.0 {
        list.push(LeftOut {
            name: "delay".to_owned(),
            joints: Vec::new(),
            value: Some(identified.delay),
            unit: "s".to_owned(),
            formula: "recorded torques are later than positions by it".to_owned(),
            effect: None,
        });
    }
    list
}

/// Whether MJCF has a parameter of a coupling in a tendon: in a fixed one, where it gives no power, or between points in a
/// spatial one, where it is a spring with a length at rest.
fn is_tendon(fitted: &Fitted, p: &StandardParameter, coupling: &Coupling, value: f64) -> bool {
    match coupling.law.between() {
        None => value >= 0.0 || p.kind == ParameterKind::KR,
        Some(_) => {
            p.coupling.is_some_and(|k| stiffness_and_rest(&fitted.robot, &fitted.standard, k).is_some())
        }
    }
}

/// The formula of a parameter of friction between links or of a spring; `None` where there is nothing.
fn of_coupling(robot: &Robot, p: &StandardParameter, coupling: &Coupling, value: f64) -> Option<String> {
    let s = coupling.combination(|joint| robot.joint_number(JointIndex(joint)).0);
    let rest = match coupling.law.rest() {
        Some(rest) if rest < 0.0 => format!(" + {}", -rest),
        Some(rest) => format!(" - {rest}"),
        None => String::new(),
    };
    let law = match p.kind {
        ParameterKind::Fvc => "Fvc*ds".to_owned(),
        ParameterKind::Fcc => "Fcc*sign(ds)".to_owned(),
        ParameterKind::K if rest.is_empty() => "K*s".to_owned(),
        ParameterKind::K => format!("K*(s{rest})"),
        _ => "-KR".to_owned(),
    };
    let share = if coupling.law.between().is_some() { "ds/dq" } else { "its coefficient" };
    (value != 0.0).then(|| format!("{law} on s = {s}: on each joint times {share}"))
}

/// The formula of a parameter that the format cannot hold; `None` where it can, or where there is nothing.
fn formula(robot: &Robot, kind: ParameterKind, frame: usize, value: f64, to: Target) -> Option<String> {
    let joint = robot.joint_of_frame()[frame]?;
    let n = robot.joints();
    let number = |j: usize| robot.joint_number(JointIndex(j));
    // Joints that turn this motor, or whose motors this joint turns.
    let gear = |m: usize, j: usize| robot.drive.gear.get(m * n + j).is_some_and(|g| *g != 0.0);
    let coupled = (0..n).any(|k| k != joint && (gear(joint, k) || gear(k, joint)));
    let turns: Vec<String> = (0..n).filter(|&k| gear(joint, k)).map(|k| number(k).to_string()).collect();
    if value == 0.0 {
        return None;
    }
    match kind {
        ParameterKind::Ia if coupled => Some(format!(
            "rotor inertia of motors that several joints turn: torques of joint {} and its neighbours",
            number(joint)
        )),
        ParameterKind::Ia if to == Target::Urdf => Some(format!("Ia*ddq{}", number(joint))),
        ParameterKind::Off => Some("constant torque".to_owned()),
        ParameterKind::Fv if value < 0.0 => Some(format!("Fv*dq{}, below 0: written as 0", number(joint))),
        ParameterKind::Fc if value < 0.0 => {
            Some(format!("Fc*sign(dq{}), below 0: written as 0", number(joint)))
        }
        ParameterKind::Fvm => Some(format!(
            "viscous friction at the speed of motor {}, which joints {} turn",
            number(joint),
            turns.join(", ")
        )),
        ParameterKind::Fcm => Some(format!(
            "Coulomb friction at the speed of motor {}, which joints {} turn",
            number(joint),
            turns.join(", ")
        )),
        _ => None,
    }
}
