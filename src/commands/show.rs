//! `dynid show ROBOT`: its table, what can be identified, what evaluating it costs.

use clap::Args;
use dynid_runtime::model::{Between, Coupling, CouplingLaw, JointIndex, JointKind, Motion, Robot};
use dynid_runtime::report::significant;

use crate::failure::Failure;
use crate::models;
use crate::output::{print, table};
use crate::robots::{Dynamics, resolve};
use crate::words::table_doubts;

/// What to show.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A robot of `dynid robots`, or the path of a robot YAML or a URDF
    robot: String,
    /// What is regrouped into each base parameter
    #[arg(long)]
    base: bool,
    /// Operations of the generated h, dh and IDM
    #[arg(long)]
    ops: bool,
}

/// Prints the table, and what was asked for.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let dynamics = resolve(&arguments.robot, None)?;
    let robot = dynamics.model().robot();
    print(&format!("{}: {}", robot.name, robot.description));
    let [x, y, z] = robot.gravity;
    print(&format!("gravity ({x}, {y}, {z}) m/s2, {} joints", robot.joints()));
    print("");
    print(&frames(robot));
    let acting = couplings(robot);
    if !acting.is_empty() {
        print("");
        print(&acting);
    }
    for doubt in table_doubts(robot) {
        print(&format!("warning: {doubt}"));
    }
    print("");
    print(&format!("{} standard parameters, {} base parameters:", robot.standard.len(), robot.base.len()));
    if arguments.base {
        print(&relations(robot));
    } else {
        print(&names(robot));
    }
    if arguments.ops {
        print("");
        print(&operations(&dynamics)?);
    }
    Ok(())
}

/// The modified-DH table; angles in rad, lengths in m.
fn frames(robot: &Robot) -> String {
    let number = |value: f64| {
        let text = significant(value, 6);
        if text.contains('.') && !text.contains('e') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    };
    let variable = |motion: &Motion, kind: JointKind, constant: f64| {
        if motion.kind != kind {
            return number(constant);
        }
        motion.entry(|joint| robot.joint_number(JointIndex(joint)).0, &number(constant))
    };
    let branched = robot.frames.iter().any(|f| f.gamma != 0.0 || f.b != 0.0);
    let mut header = vec!["j", "a(j)", "sigma", "alpha", "d", "theta", "r"];
    if branched {
        header.splice(3..3, ["gamma", "b"]);
    }
    let rows = robot
        .frames
        .iter()
        .zip(robot.motions())
        .enumerate()
        .map(|(k, (frame, motion))| {
            let j = k + 1;
            let sigma = match motion.kind {
                JointKind::Revolute => "0",
                JointKind::Prismatic => "1",
                JointKind::Fixed => "2",
            };
            let mut row = vec![
                j.to_string(),
                frame.parent.map_or(0, |p| p + 1).to_string(),
                sigma.to_owned(),
                number(frame.alpha),
                number(frame.d),
                variable(&motion, JointKind::Revolute, frame.theta),
                variable(&motion, JointKind::Prismatic, frame.r),
            ];
            if branched {
                row.splice(3..3, [number(frame.gamma), number(frame.b)]);
            }
            row
        })
        .collect();
    table(&header, rows)
}

/// Friction between links and springs, a line each.
fn couplings(robot: &Robot) -> String {
    let line = |coupling: &Coupling| {
        let name = &coupling.name;
        let s = coupling.combination(|joint| robot.joint_number(JointIndex(joint)).0);
        match coupling.law {
            CouplingLaw::Friction => format!("friction on s = {s}: Fvc{name}*ds + Fcc{name}*sign(ds)"),
            CouplingLaw::Spring => format!("spring on s = {s}: K{name}*s - KR{name}"),
            CouplingLaw::SpringAt(rest) => {
                format!("spring on s = {s}: K{name}*(s - {})", significant(rest, 6))
            }
            CouplingLaw::Between(Between { rest: None, .. }) => {
                format!("spring on s = {s}: K{name}*s - KR{name}")
            }
            CouplingLaw::Between(Between { rest: Some(rest), .. }) => {
                format!("spring on s = {s}: K{name}*(s - {})", significant(rest, 6))
            }
        }
    };
    robot.couplings.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// The names of the base parameters, a line a frame.
fn names(robot: &Robot) -> String {
    let mut lines: Vec<(usize, String)> = Vec::new();
    for parameter in robot.base.iter() {
        // What acts on several joints stands last.
        let standard = &robot.standard[parameter.standard];
        let frame = if standard.coupling.is_some() { robot.frames.len() } else { standard.frame };
        match lines.last_mut() {
            Some((known, line)) if *known == frame => {
                line.push(' ');
                line.push_str(&parameter.name);
            }
            _ => lines.push((frame, format!("  {}", parameter.name))),
        }
    }
    lines.into_iter().map(|(_, line)| line).collect::<Vec<_>>().join("\n")
}

fn relations(robot: &Robot) -> String {
    let rows = robot
        .base
        .iter()
        .map(|p| vec![format!("  {}", p.name), format!("[{}]", p.unit), format!("= {}", p.relation)])
        .collect();
    let silent: Vec<&str> =
        robot.without_effect().into_iter().map(|k| robot.standard[k].name.as_ref()).collect();
    let mut text = table(&["<", "<", "<"], rows);
    if !silent.is_empty() {
        text.push_str(&format!("\nwithout any effect on the joint torques: {}", silent.join(" ")));
    }
    if !robot.known.is_empty() {
        let known: Vec<&str> = robot.known.iter().map(|&k| robot.standard[k].name.as_ref()).collect();
        text.push_str(&format!("\nknown to be 0: {}", known.join(" ")));
    }
    if !robot.fixed.is_empty() {
        let known: Vec<String> = robot
            .fixed
            .iter()
            .map(|&(k, value)| format!("{} {}", robot.standard[k].name, significant(value, 6)))
            .collect();
        text.push_str(&format!("\nknown: {}", known.join(", ")));
        let base: Vec<&str> = robot.fixed_base().into_iter().map(|(k, _)| &*robot.base[k].name).collect();
        if !base.is_empty() {
            text.push_str(&format!(
                "\nnot identified, because all that is part of them is known: {}",
                base.join(" ")
            ));
        }
    }
    text
}

fn operations(dynamics: &Dynamics) -> Result<String, Failure> {
    let Dynamics::Generated(model) = dynamics else {
        return Err(Failure::Input(
            "operation counts are those of generated code: put the YAML into robots/ and build".to_owned(),
        ));
    };
    let counts = models::operations(&model.robot().name).unwrap_or_default();
    let rows = counts
        .iter()
        .map(|c| {
            vec![
                c.function.to_owned(),
                c.multiplications.to_string(),
                c.additions.to_string(),
                c.sine_cosine_pairs.to_string(),
                (c.multiplications + c.additions).to_string(),
            ]
        })
        .collect();
    Ok(table(&["<", "multiplications", "additions", "sin/cos pairs", "mul + add"], rows))
}
