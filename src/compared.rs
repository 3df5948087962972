//! Models on the rows of a recording, with the states at which these were measured: what pages draw and `--residuals`
//! writes.

use std::path::{Path, PathBuf};

use dynid_runtime::model::{JointKind, Robot};
use dynid_runtime::prediction::{Evaluation, JointRows, StateRows};
use dynid_runtime::recording::{Columns, DataFormat, JointFields, JointLog};

use crate::failure::Failure;
use crate::output::fill;
use crate::start::numbered;
use crate::words::joint_number;

/// Reads the path of a file for residuals.
///
/// # Errors
/// An end that stands for no format.
pub fn residual_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match DataFormat::of_file(&path) {
        Some(_) => Ok(path),
        None => Err("its name must end in .csv, .parquet or .mcap".to_owned()),
    }
}

/// Models on the rows of a recording.
#[derive(Debug, Clone, Copy)]
pub struct Compared<'a> {
    /// The robot.
    pub robot: &'a Robot,
    /// The models that were evaluated, the one that counts last.
    pub evaluation: &'a Evaluation,
    /// The states at the rows, in the order of the evaluation's.
    pub states: &'a [StateRows],
    /// What each model is called.
    pub models: &'a [&'a str],
}

/// Signals of all joints at the rows of one motion, `[j][t]`.
struct MotionRows {
    time: Vec<f64>,
    /// q, dq, ddq, measured torque.
    signals: [Vec<Vec<f64>>; 4],
    /// For each model.
    predicted: Vec<Vec<Vec<f64>>>,
    /// Of the last model; and the same with NaN where a row was left out.
    residual: [Vec<Vec<f64>>; 2],
    /// 1 where a row is used, else 0.
    used: Vec<Vec<f64>>,
}

impl<'a> Compared<'a> {
    /// The rows of a joint, motion by motion, with their states.
    pub fn of_joint(self, joint: usize) -> impl Iterator<Item = (&'a JointRows, &'a StateRows)> {
        self.evaluation.rows.iter().zip(self.states).filter(move |(rows, _)| rows.joint == joint)
    }

    /// `joint 3`, by the table, for a joint counted from 0.
    pub fn joint(self, joint: usize) -> String {
        format!("joint {}", joint_number(self.robot, joint))
    }

    /// What kind of joint it is, which says its units.
    pub fn kind(self, joint: usize) -> JointKind {
        self.robot.joint_kinds().get(joint).copied().unwrap_or(JointKind::Revolute)
    }

    /// Writes states, torques and residuals row by row in the format that the end of the path stands for. `joints` are
    /// the names of the joints in a log; where there are none, they are numbered.
    ///
    /// # Errors
    /// [`Failure::Input`] naming the path.
    pub fn write(self, path: &Path, joints: &[String]) -> Result<(), Failure> {
        let format = DataFormat::of_file(path).unwrap_or_default();
        let names = if joints.is_empty() { numbered(self.robot) } else { joints.to_vec() };
        let motions: Vec<MotionRows> =
            (0..self.evaluation.trajectories.len()).map(|motion| self.motion(motion)).collect();
        let logs: Vec<JointLog<'_>> =
            motions.iter().enumerate().flat_map(|(k, motion)| self.logs(k, motion)).collect();
        let table = self.table(&motions);
        let columns: Columns<'_> = table.iter().map(|(name, values)| (name.clone(), &values[..])).collect();
        fill(path, &mut |out| format.write_table(&columns, &logs, &names, out))
    }

    fn motion(self, motion: usize) -> MotionRows {
        let own =
            || self.evaluation.rows.iter().zip(self.states).filter(move |(r, _)| r.trajectory == motion);
        let state = |f: fn(&StateRows) -> &Vec<f64>| own().map(|(_, s)| f(s).clone()).collect();
        let left = |rows: &JointRows, whole: bool| -> Vec<f64> {
            let predicted = rows.predicted.last().map_or(&[][..], Vec::as_slice);
            let each = rows.measured.iter().zip(predicted).zip(&rows.used);
            each.map(|((y, p), used)| if whole || *used { y - p } else { f64::NAN }).collect()
        };
        let of_model = |k: usize| own().map(|(r, _)| r.predicted[k].clone()).collect();
        MotionRows {
            time: own().next().map_or_else(Vec::new, |(rows, _)| rows.time.clone()),
            signals: [
                state(|s| &s.position),
                state(|s| &s.speed),
                state(|s| &s.acceleration),
                own().map(|(rows, _)| rows.measured.clone()).collect(),
            ],
            predicted: (0..self.models.len()).map(of_model).collect(),
            residual: [true, false].map(|whole| own().map(|(rows, _)| left(rows, whole)).collect()),
            used: own()
                .map(|(r, _)| r.used.iter().map(|&used| f64::from(u8::from(used))).collect())
                .collect(),
        }
    }

    /// The columns of a table: the motion counted from 1, t, then q, dq, ddq, tau, the torque of each model, the residual
    /// of the last one and whether the row counts, joint by joint.
    fn table(self, motions: &[MotionRows]) -> Vec<(String, Vec<f64>)> {
        let numbers = (1..).zip(motions);
        let motion = numbers.flat_map(|(k, m)| vec![f64::from(k); m.time.len()]).collect();
        let time = motions.iter().flat_map(|m| m.time.iter().copied()).collect();
        let mut table = vec![("motion".to_owned(), motion), ("t".to_owned(), time)];
        let mut add = |name: &str, of: &dyn Fn(&MotionRows) -> &[Vec<f64>]| {
            for j in 0..self.robot.joints() {
                let values =
                    motions.iter().flat_map(|m| of(m).get(j).into_iter().flatten().copied()).collect();
                table.push((format!("{name}{}", joint_number(self.robot, j)), values));
            }
        };
        for (k, name) in ["q", "dq", "ddq", "tau"].into_iter().enumerate() {
            add(name, &|m| &m.signals[k]);
        }
        for (k, name) in self.models.iter().enumerate() {
            add(name, &|m| &m.predicted[k]);
        }
        add("residual", &|m| &m.residual[0]);
        add("used", &|m| &m.used);
        table
    }

    /// The topics of a motion; its name is in them where there are several.
    fn logs(self, k: usize, motion: &'a MotionRows) -> Vec<JointLog<'a>> {
        let several = self.evaluation.trajectories.len() > 1;
        let topic =
            |name: &str| if several { format!("/motion{}/{name}", k + 1) } else { format!("/{name}") };
        let [q, dq, ddq, torque] = &motion.signals;
        let log = |name: &str, fields| JointLog::new(topic(name), &motion.time, fields);
        let effort = |effort: &'a [Vec<f64>]| JointFields::States(vec![&[], &[], effort]);
        let mut logs = vec![
            log("measured", JointFields::States(vec![q, dq, torque])),
            log("acceleration", JointFields::Accelerations(ddq)),
        ];
        logs.extend(self.models.iter().zip(&motion.predicted).map(|(name, p)| log(name, effort(p))));
        logs.push(log("residual", effort(&motion.residual[1])));
        logs
    }
}
