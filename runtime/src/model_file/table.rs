//! The table of a saved model: every index and number of it.

use super::error::FileError;
use crate::model::{CouplingLaw, ParameterKind, RecursiveModel, Robot};
use dynid_description::{JointKind, MAX_TERMS, bounds};

/// Checks that models and effects can be evaluated with a table.
pub(super) fn check(robot: &Robot) -> Result<(), FileError> {
    let wrong = |field: String, what: &str| Err(FileError::new(format!("table.{field}"), what));
    let n = robot.joints();
    if n == 0 {
        return wrong("frames".to_owned(), "a robot has one joint at least");
    }
    let beyond = |x: &f64, most: f64| x.is_nan() || x.abs() > most;
    if robot.gravity.iter().any(|x| beyond(x, bounds::HEAVIEST)) {
        return wrong("gravity".to_owned(), "it is not finite, or no robot has it");
    }
    for (k, f) in robot.frames.iter().enumerate() {
        let angles = [f.gamma, f.alpha, f.theta].iter().any(|x| beyond(x, bounds::WIDEST));
        if angles || [f.b, f.d, f.r].iter().any(|x| beyond(x, bounds::LONGEST)) {
            return wrong(format!("frames[{k}]"), "an angle or a length is not finite, or no robot has it");
        }
    }
    check_dependent(robot, n)?;
    check_couplings(robot, n)?;
    if robot.drive.gear.iter().any(|x| beyond(x, bounds::FASTEST_GEAR)) {
        return wrong("drive.gear".to_owned(), "a ratio is not finite, or no robot has it");
    }
    if let Some(k) = robot.drive.coupled_friction.iter().position(|&motor| motor >= n) {
        return wrong(format!("drive.coupled_friction[{k}]"), "there is no such motor");
    }
    for (k, p) in robot.standard.iter().enumerate() {
        if p.frame >= robot.frames.len() {
            return wrong(format!("standard[{k}].frame"), "there is no such frame");
        }
        let of_coupling = p.kind > ParameterKind::Fcm;
        if p.coupling.is_some() != of_coupling || p.coupling.is_some_and(|c| c >= robot.couplings.len()) {
            return wrong(format!("standard[{k}].coupling"), "there is no such friction or spring");
        }
    }
    for (k, base) in robot.base.iter().enumerate() {
        let known = |&(s, c): &(usize, f64)| s < robot.standard.len() && c.is_finite();
        if base.standard >= robot.standard.len() {
            return wrong(format!("base[{k}].standard"), "there is no such standard parameter");
        }
        if !base.combination.iter().all(known) {
            return wrong(
                format!("base[{k}].combination"),
                "it names a standard parameter that is not there",
            );
        }
    }
    let limits = &robot.limits;
    for (name, limits) in [
        ("position", &limits.position),
        ("velocity", &limits.velocity),
        ("acceleration", &limits.acceleration),
        ("torque", &limits.torque),
    ] {
        let fits = limits.is_empty() || limits.len() == n;
        if !fits || limits.iter().flatten().any(|x| beyond(x, bounds::WIDEST_LIMIT)) {
            return wrong(
                format!("limits.{name}"),
                "one [low, high] per joint that a robot can have, or none at all",
            );
        }
    }
    check_nominal(robot, n)?;
    match RecursiveModel::new(robot.clone()) {
        Ok(_) => Ok(()),
        Err(error) => Err(FileError::new("table".to_owned(), &error.to_string())),
    }
}

/// What moves the frames, and which parameters are known.
fn check_dependent(robot: &Robot, n: usize) -> Result<(), FileError> {
    if let Some(k) = robot.known.iter().position(|&known| known >= robot.standard.len()) {
        let what = "there is no such standard parameter";
        return Err(FileError::new(format!("table.known[{k}]"), what));
    }
    let fits = |&(k, value): &(usize, f64)| k < robot.standard.len() && value.is_finite();
    if let Some(k) = robot.fixed.iter().position(|known| !fits(known)) {
        let what = "there is no such standard parameter, or its value is not finite";
        return Err(FileError::new(format!("table.fixed[{k}]"), what));
    }
    let mut before = None;
    for (k, d) in robot.dependent.iter().enumerate() {
        let wrong =
            |field: &str, what: &str| Err(FileError::new(format!("table.dependent[{k}].{field}"), what));
        let Some(frame) = robot.frames.get(d.frame).filter(|_| before < Some(d.frame)) else {
            return wrong("frame", "there is no such frame, or it is not after the one before");
        };
        before = Some(d.frame);
        let same = frame.kind == JointKind::Fixed || frame.kind == d.kind;
        if d.kind == JointKind::Fixed || !same {
            return wrong("kind", "revolute or prismatic, as the frame's own joint");
        }
        let whole = |c: f64| d.kind == JointKind::Prismatic || c.fract() == 0.0;
        let fits = |c: f64| c != 0.0 && c.abs() <= bounds::LONGEST && whole(c);
        let ascending = d.terms.windows(2).all(|pair| pair[0].0 < pair[1].0);
        let known = d.terms.iter().all(|&(joint, c)| joint < n && fits(c));
        if d.terms.is_empty() || d.terms.len() > MAX_TERMS || !ascending || !known {
            return wrong("terms", "ascending joints with coefficients, whole numbers for an angle");
        }
    }
    Ok(())
}

/// Friction between links and springs: as the YAML says them.
fn check_couplings(robot: &Robot, n: usize) -> Result<(), FileError> {
    for (k, c) in robot.couplings.iter().enumerate() {
        let wrong =
            |field: &str, what: &str| Err(FileError::new(format!("table.couplings[{k}].{field}"), what));
        if c.name.is_empty() || !c.name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_') {
            return wrong("name", "letters, digits and underscores");
        }
        let known = c.terms.iter().all(|&(joint, c)| joint < n && c != 0.0 && c.abs() <= bounds::LONGEST);
        let ascending = c.terms.windows(2).all(|pair| pair[0].0 < pair[1].0);
        if c.terms.is_empty() || !ascending || !known {
            return wrong("terms", "ascending joints with coefficients");
        }
        if matches!(c.law, CouplingLaw::SpringAt(rest) if rest.is_nan() || rest.abs() > bounds::WIDEST) {
            return wrong("law", "its position at rest is not finite, or no robot has it");
        }
        if let CouplingLaw::Between(between) = c.law {
            let lengths = between.points.iter().flatten().chain(&between.rest);
            let in_table = between.frames.iter().flatten().all(|&frame| frame < robot.frames.len());
            if !in_table || lengths.into_iter().any(|x| x.is_nan() || x.abs() > bounds::LONGEST) {
                return wrong("law", "it names a frame that is not there, or a length that no robot has");
            }
        }
    }
    Ok(())
}

fn check_nominal(robot: &Robot, n: usize) -> Result<(), FileError> {
    let Some(nominal) = &robot.nominal else { return Ok(()) };
    let wrong = |field: &str, what: &str| Err(FileError::new(format!("table.nominal.{field}"), what));
    if nominal.standard.len() != robot.standard.len() {
        return wrong("standard", "one value per standard parameter");
    }
    for (name, values) in [
        ("kp", &nominal.kp),
        ("kd", &nominal.kd),
        ("ki", &nominal.ki),
        ("position_noise", &nominal.position_noise),
        ("torque_noise", &nominal.torque_noise),
    ] {
        if !(values.is_empty() || values.len() == n) {
            return wrong(name, "one value per joint, or none at all");
        }
    }
    Ok(())
}
