//! Figures of the evidence, each a file that stands by itself.

use dynid_runtime::diagnosis::{Diagnosis, Finding};
use dynid_runtime::effects::EffectKind;
use dynid_runtime::prediction::{Evaluation, JointRows};
use dynid_runtime::report::{Panel, Sheet};

/// What every finding rests on: the residual over the variable that reveals it, and the law.
pub fn findings(robot: &str, found: &Diagnosis) -> Option<String> {
    let panels: Vec<Panel> = found.findings.iter().filter_map(revealing).collect();
    (!panels.is_empty()).then(|| {
        Sheet {
            title: format!("{robot}: what the standard model leaves, and the law that was found"),
            x: String::new(),
            columns: if panels.len() > 1 { 2 } else { 1 },
            panel: [460.0, 240.0],
            panels,
        }
        .to_svg()
    })
}

fn revealing(finding: &Finding) -> Option<Panel> {
    let curve = finding.curve.as_ref()?;
    let line = |y: &[f64]| curve.x.iter().copied().zip(y.iter().copied()).collect::<Vec<(f64, f64)>>();
    let bound = |sign: f64| -> Vec<f64> {
        curve.residual.iter().zip(&curve.error).map(|(r, e)| r + sign * 2.0 * e).collect()
    };
    let title = EffectKind::title_of(&finding.effect);
    let on: Vec<String> = finding.joints.iter().map(ToString::to_string).collect();
    let place = if on.is_empty() { String::new() } else { format!(", joint {}", on.join(" and ")) };
    Some(Panel {
        title: format!("{title}{place}: {} over {}", curve.unit, curve.variable),
        lines: vec![
            ("fitted law".to_owned(), line(&curve.law)),
            ("mean residual".to_owned(), line(&curve.residual)),
            ("two standard errors more".to_owned(), line(&bound(1.0))),
            ("and less".to_owned(), line(&bound(-1.0))),
        ],
    })
}

/// The number of a joint (0-based) in the table.
pub fn joint_number(compared: &Evaluation, joint: usize) -> String {
    let number = compared.left_out.iter().find(|rows| rows.equation == joint).and_then(|rows| rows.joint);
    number.map_or_else(String::new, |number| number.to_string())
}

/// What both models leave of the torques of the first test motion, joint by joint.
pub fn held_out(robot: &str, compared: &Evaluation) -> String {
    let first: Vec<&JointRows> = compared.rows.iter().filter(|rows| rows.trajectory == 0).collect();
    let panels = first
        .iter()
        .map(|rows| {
            let left = |model: &[f64]| -> Vec<(f64, f64)> {
                let rest = rows.measured.iter().zip(model).map(|(y, m)| y - m);
                rows.time.iter().copied().zip(rest).collect()
            };
            let lines =
                [("standard model", rows.predicted.first()), ("with what was found", rows.predicted.last())];
            Panel {
                title: format!("joint {}, N.m", joint_number(compared, rows.joint)),
                lines: lines
                    .into_iter()
                    .filter_map(|(name, model)| Some((name.to_owned(), left(model?))))
                    .collect(),
            }
        })
        .collect();
    let motion = compared.trajectories.first().map_or("", |name| name.rsplit('/').next().unwrap_or(name));
    Sheet {
        title: format!("{robot}: what is left of the torques of a test motion ({motion})"),
        x: "time, s".to_owned(),
        columns: 2,
        panel: [460.0, 190.0],
        panels,
    }
    .to_svg()
}
