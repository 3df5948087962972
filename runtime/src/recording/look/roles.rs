//! Which signal is what, by its name.

use std::collections::BTreeMap;

use serde::Serialize;

use super::Contents;
use crate::recording::Rows;

/// What a signal measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// Time.
    Time,
    /// A joint's angle or travel.
    Position,
    /// A joint's speed.
    Velocity,
    /// A joint's torque or force.
    Torque,
    /// A motor's current.
    Current,
}

const TIME: &[&str] = &["t", "time", "timestamp", "stamp", "clock", "seconds", "sec"];
const VELOCITY: &[&str] = &["dq", "qd", "qdot", "vel", "velocity", "velocities", "speed", "omega"];
const TORQUE: &[&str] = &["tau", "torque", "torques", "effort", "trq", "u", "force", "load"];
const CURRENT: &[&str] = &["i", "cur", "curr", "current", "currents", "amp", "amps"];
const POSITION: &[&str] = &["q", "pos", "position", "positions", "angle", "angles", "theta"];
/// What is not measured, or is derived.
const NOT: &[&str] = &[
    "target",
    "desired",
    "des",
    "cmd",
    "command",
    "commanded",
    "reference",
    "ref",
    "error",
    "ddq",
    "qdd",
    "acc",
    "accel",
    "acceleration",
    "temperature",
    "voltage",
    "planned",
    "setpoint",
    "limit",
];

/// The words of a name: `actual_q_0` is actual, q, 0; `dq1` is dq, 1.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in name.chars() {
        let goes_on =
            c.is_alphanumeric() && before.is_alphanumeric() && c.is_ascii_digit() == before.is_ascii_digit();
        match words.last_mut() {
            Some(word) if goes_on => word.extend(c.to_lowercase()),
            _ if c.is_alphanumeric() => words.push(c.to_lowercase().collect()),
            _ => {}
        }
        before = c;
    }
    words
}

/// What a name says, and the rest of it, which tells the joint.
fn role(name: &str) -> Option<(Role, String)> {
    let mut words = words(name);
    if words.iter().any(|word| NOT.contains(&word.as_str())) {
        return None;
    }
    let all = [
        (VELOCITY, Role::Velocity),
        (CURRENT, Role::Current),
        (TORQUE, Role::Torque),
        (POSITION, Role::Position),
    ];
    let (at, role) = all.into_iter().find_map(|(known, role)| {
        Some((words.iter().position(|word| known.contains(&word.as_str()))?, role))
    })?;
    words.remove(at);
    Some((role, words.join(" ")))
}

/// What a name says that a signal measures.
pub(super) fn role_of(name: &str) -> Option<Role> {
    role(name).map(|(role, _)| role)
}

/// The columns of a recording, by their names.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Channels {
    /// One per joint, in the order of the file; empty where none are found.
    pub position: Vec<String>,
    /// The same for speeds.
    pub velocity: Vec<String>,
    /// The same for torques, or for currents.
    pub torque: Vec<String>,
    /// Whether these are currents.
    pub current: bool,
    /// What tells the joint in the names of the positions.
    pub keys: Vec<String>,
}

/// The columns that hold positions, speeds and torques: for each the largest family of names that differ in the joint
/// only, of as many joints as there are positions.
pub fn channels(names: &[String]) -> Channels {
    // Family of names, of those with numbers by their other words, to names and keys.
    let mut families: BTreeMap<(Role, String), Vec<(String, String)>> = BTreeMap::new();
    for name in names {
        let Some((role, key)) = role(name) else { continue };
        let numbered = key.split(' ').any(|word| word.parse::<u32>().is_ok());
        let stem: Vec<&str> = key.split(' ').filter(|word| word.parse::<u32>().is_err()).collect();
        // The elements of a list in a message are a family of their own.
        let list = name.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
        let family = match list {
            Some((list, _)) => list.to_owned(),
            None if numbered => stem.join(" "),
            None => String::new(),
        };
        families.entry((role, family)).or_default().push((name.clone(), key));
    }
    let of = |role: Role, joints: Option<&[String]>| {
        let fits = |list: &Vec<(String, String)>| joints.is_none_or(|joints| joints.len() == list.len());
        let found = families.iter().filter(|((of, _), list)| *of == role && fits(list));
        // The same joints first, then the most.
        found
            .map(|(_, list)| list)
            .max_by_key(|list| (joints.is_some_and(|j| list.iter().map(|(_, key)| key).eq(j)), list.len()))
            .cloned()
            .unwrap_or_default()
    };
    let position = of(Role::Position, None);
    let keys: Vec<String> = position.iter().map(|(_, key)| key.clone()).collect();
    let names = |list: Vec<(String, String)>| list.into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    let torque = names(of(Role::Torque, Some(&keys)));
    let current = torque.is_empty();
    let torque = if current { names(of(Role::Current, Some(&keys))) } else { torque };
    Channels {
        velocity: names(of(Role::Velocity, Some(&keys))),
        current: current && !torque.is_empty(),
        torque,
        position: names(position),
        keys,
    }
}

/// The column of time: one that is called so, else the first one that only grows.
pub(super) fn time_of(names: &[String], rows: &Rows) -> Option<usize> {
    let grows = |k: usize| {
        let column: Vec<f64> = rows.columns[k].iter().copied().filter(|x| x.is_finite()).collect();
        column.len() > 2
            && column.windows(2).filter(|pair| pair[1] > pair[0]).count() * 100 >= 95 * (column.len() - 1)
    };
    // Of a log with several publishers stamps may stand still.
    if let Some(stamped) = names.iter().position(|name| matches!(name.as_str(), "header.stamp" | "log_time"))
    {
        return Some(stamped);
    }
    let called = |k: &usize| words(&names[*k]).first().is_some_and(|word| TIME.contains(&word.as_str()));
    let numbered = |k: &usize| names[*k].parse::<usize>().is_ok();
    let columns = 0..names.len();
    columns
        .clone()
        .filter(called)
        .find(|&k| grows(k))
        .or_else(|| columns.filter(numbered).find(|&k| grows(k)))
}

/// Seconds per unit of a column of time: by its name, else by its steps, as recordings have 2 to 50,000 rows a second.
pub(super) fn time_unit(name: &str, column: &[f64]) -> f64 {
    for word in words(name) {
        match word.as_str() {
            "ms" | "msec" | "millis" => return 1e-3,
            "us" | "usec" | "micros" => return 1e-6,
            "ns" | "nsec" | "nanos" => return 1e-9,
            _ => {}
        }
    }
    let mut steps: Vec<f64> =
        column.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    steps.sort_unstable_by(f64::total_cmp);
    match steps.get(steps.len() / 2) {
        Some(step) if *step >= 5e5 => 1e-9,
        Some(step) if *step >= 500.0 => 1e-6,
        Some(step) if *step >= 0.5 => 1e-3,
        _ => 1.0,
    }
}

/// What looks wrong.
pub(super) fn doubts(contents: &mut Contents) {
    let mut wrong = Vec::new();
    if contents.time.is_none() {
        wrong.push("no column of time was found".to_owned());
    }
    for signal in &contents.signals {
        let name = &signal.name;
        if signal.count == 0 {
            wrong.push(format!("`{name}` has no numbers"));
        } else if signal.missing > 0 && contents.format != "MCAP" {
            wrong.push(format!("`{name}` lacks a number in {} of {} rows", signal.missing, contents.rows));
        }
        let of_joint = role(name).map(|(role, _)| role);
        if of_joint.is_some() && signal.count > 1 && signal.low == signal.high {
            wrong.push(format!("`{name}` is {} all the time", signal.low));
        }
        if of_joint == Some(Role::Position) && signal.low.abs().max(signal.high.abs()) > 7.0 {
            wrong.push(format!(
                "`{name}` reaches {:.1}: more than a turn, or degrees (`unit: deg`)",
                signal.high
            ));
        }
    }
    let time = contents.signals.iter().find(|signal| Some(&signal.name) == contents.time.as_ref());
    if let Some(time) = time {
        // Publishers of one topic may tell of the same instant.
        let still = if contents.format == "MCAP" { 0 } else { time.repeated };
        if time.backwards + still > 0 {
            wrong.push(format!("time does not go forward in {} rows", time.backwards + still));
        }
        if let (true, Some([gap, after])) = (time.gaps > 0, time.largest_gap) {
            wrong.push(format!("{} gaps, the largest of {gap:.3} s after {after:.3} s", time.gaps));
        }
    }
    contents.wrong.extend(wrong);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: &[&str]) -> Channels {
        channels(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn elements_of_a_list_belong_together() {
        let found = of(&[
            "actual.positions[a]",
            "actual.positions[b]",
            "actual.effort[a]",
            "actual.effort[b]",
            "load",
        ]);
        assert_eq!(found.position, ["actual.positions[a]", "actual.positions[b]"]);
        assert_eq!(found.torque, ["actual.effort[a]", "actual.effort[b]"]);
    }

    #[test]
    fn names_tell_positions_speeds_and_torques() {
        let found = of(&["t", "q1", "q2", "dq1", "dq2", "tau1", "tau2"]);
        assert_eq!(
            (found.position, found.velocity),
            (vec!["q1".into(), "q2".into()], vec!["dq1".into(), "dq2".into()])
        );
        assert_eq!((found.torque, found.current), (vec!["tau1".to_owned(), "tau2".into()], false));
        let ur = of(&[
            "timestamp",
            "target_q_0",
            "actual_q_0",
            "actual_q_1",
            "actual_qd_0",
            "actual_qd_1",
            "actual_current_0",
            "actual_current_1",
        ]);
        assert_eq!(
            (ur.position, ur.torque.len(), ur.current),
            (vec!["actual_q_0".to_owned(), "actual_q_1".into()], 2, true)
        );
        let log = of(&["header.stamp", "elbow.position", "elbow.effort", "wrist.position", "wrist.effort"]);
        assert_eq!(log.keys, ["elbow", "wrist"]);
        assert_eq!(log.torque, ["elbow.effort", "wrist.effort"]);
        assert_eq!(of(&["a", "b"]), Channels::default());
    }

    #[test]
    fn units_of_time_follow_from_names_and_steps() {
        let steps = |step: f64| (0..50).map(|k| f64::from(k) * step).collect::<Vec<_>>();
        assert_eq!(time_unit("t", &steps(0.001)), 1.0);
        assert_eq!(time_unit("t", &steps(2.0)), 1e-3);
        assert_eq!(time_unit("time_ns", &steps(1.0)), 1e-9);
        assert_eq!(time_unit("t", &steps(1e6)), 1e-9);
    }
}
