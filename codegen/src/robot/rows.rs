//! The rows of the modified-DH table.

use super::document::{Node, Place, Value};
use super::expression::Expression;
use super::formula::Formula;
use super::magnitudes;
use super::reader::Reader;
use super::table::TableRow;
use super::variables::{Moving, dependent_frames};
use dynid_description::bounds::MAX_FRAMES;
use dynid_description::{DependentFrame, JointKind};
use std::f64::consts::FRAC_PI_4;

const KEYS: [&str; 9] = ["j", "parent", "sigma", "gamma", "b", "alpha", "d", "theta", "r"];

/// Reads `frames`. An entry that is wrong is reported and taken as 0, so that what counts joints can be checked too;
/// `None` where the joints cannot be counted.
pub(super) fn read_frames(
    reader: &mut Reader,
    node: &Node,
    constants: &[(String, f64)],
) -> Option<(Vec<TableRow>, Vec<DependentFrame>)> {
    let rows =
        reader.list(node, "frames as a list of rows {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}")?;
    if rows.is_empty() {
        reader.report(node.place, "frames is empty; expected at least one row");
        return None;
    }
    if rows.len() > MAX_FRAMES {
        let place = rows[MAX_FRAMES].place;
        reader.report(place, format!("frames has {} rows; expected at most {MAX_FRAMES}", rows.len()));
        return None;
    }
    let mut read: Vec<_> =
        rows.iter().enumerate().map(|(k, row)| read_frame(reader, row, k + 1, constants)).collect();
    check_parents(reader, &read, rows.len());
    let moving: Vec<Option<Moving>> =
        read.iter_mut().map(|row| row.as_mut().and_then(|row| row.moving.take())).collect();
    let complete = read.iter().all(Option::is_some);
    // Where a row could not be read its variable may be missing only because of that.
    let dependent = if complete { dependent_frames(reader, &moving) } else { Vec::new() };
    let frames: Option<Vec<TableRow>> = read.into_iter().map(|f| f.map(|row| row.frame)).collect();
    let frames = frames?;
    if frames.iter().all(|f| f.kind == JointKind::Fixed) && moving.iter().all(Option::is_none) {
        reader
            .report(node.place, "every frame is fixed (sigma 2); expected at least one joint (sigma 0 or 1)");
    }
    // Without a joint there is nothing to count: what is wrong has been reported.
    frames.iter().any(|f| f.kind != JointKind::Fixed).then_some((frames, dependent))
}

struct Row {
    frame: TableRow,
    parent_place: Place,
    /// What moves it, unless it is fixed.
    moving: Option<Moving>,
}

fn read_frame(reader: &mut Reader, node: &Node, j: usize, constants: &[(String, f64)]) -> Option<Row> {
    let fields = reader.fields(node, "a frame", &KEYS)?;
    if let Some(number) = reader.required(&fields, "j")
        && let Some(found) = reader.integer(number, "j as a whole number")
        && found != j
    {
        reader.report(number.place, format!("j is {found} on row {j} of the table, expected {j}"));
    }
    let kind = reader.required(&fields, "sigma").and_then(|sigma| {
        let words = "sigma as 0 (revolute), 1 (prismatic) or 2 (fixed)";
        match &sigma.value {
            Value::Scalar { text, .. } if text == "0" => Some(JointKind::Revolute),
            Value::Scalar { text, .. } if text == "1" => Some(JointKind::Prismatic),
            Value::Scalar { text, .. } if text == "2" => Some(JointKind::Fixed),
            _ => {
                let found = sigma.describe();
                reader.report(sigma.place, format!("expected {words}, found {found}"));
                None
            }
        }
    });
    let parent = fields.get("parent");
    let parent_place = parent.map_or(node.place, |node| node.place);
    let parent =
        parent.and_then(|node| reader.integer(node, "parent as the number of a frame (0 is the base)"));
    let mut constant = |key: &str, needed: bool| {
        let node = if needed { reader.required(&fields, key) } else { fields.get(key) };
        let Some(node) = node else { return Expression::ZERO };
        let value = reader.constant(node, key, constants).unwrap_or(Expression::ZERO);
        magnitudes::check(reader, node, key, &value);
        if matches!(key, "alpha" | "gamma") {
            warn_of_rounded(reader, node, key, &value);
        }
        value
    };
    let (gamma, b) = (constant("gamma", false), constant("b", false));
    let (alpha, d) = (constant("alpha", true), constant("d", true));
    let mut moving = None;
    let mut entry = |key: &'static str, moves: JointKind| {
        let node = reader.required(&fields, key)?;
        read_entry(reader, (node, key), j, (kind, moves), constants, &mut moving)
    };
    let theta = entry("theta", JointKind::Revolute).unwrap_or(Expression::ZERO);
    let r = entry("r", JointKind::Prismatic).unwrap_or(Expression::ZERO);
    // A row that moves with other variables only has no joint; one whose variables could not be read counts as a joint, so
    // that what counts joints can be checked too.
    let own = match (&moving, kind?) {
        (Some(row), _) if !row.is_own(j) => JointKind::Fixed,
        (_, kind) => kind,
    };
    let frame = TableRow { j, parent: parent.unwrap_or(j - 1), kind: own, gamma, b, alpha, d, theta, r };
    Some(Row { frame, parent_place, moving })
}

/// Reads theta or r of row `j`, which moves where its kind is `moves`: the constant, and into `moving` the variables.
fn read_entry(
    reader: &mut Reader,
    (node, key): (&Node, &'static str),
    j: usize,
    (kind, moves): (Option<JointKind>, JointKind),
    constants: &[(String, f64)],
    moving: &mut Option<Moving>,
) -> Option<Expression> {
    let formula = reader.formula(node, key, constants)?;
    match kind {
        Some(kind) if kind == moves && !formula.variables.is_empty() => {
            let at = |offset: usize| reader.place_in(node, offset);
            let terms = formula.variables.iter().map(|&(k, c, offset)| (k, c, at(offset))).collect();
            *moving = Some(Moving::new(reader, j, (key, kind), terms));
        }
        Some(kind) => {
            if let Err(message) = check_variable(&formula, key, j, kind, kind == moves) {
                reader.report(node.place, message);
            }
        }
        None => {}
    }
    if let Some(value) = &formula.constant {
        magnitudes::check(reader, node, key, value);
    }
    if let Some(angle) = formula.constant.as_ref().filter(|_| key == "theta") {
        warn_of_rounded(reader, node, key, angle);
    }
    formula.constant
}

/// Warns of an angle that is written as a rounded multiple of pi/4: it is taken as it stands, as a general angle.
fn warn_of_rounded(reader: &mut Reader, node: &Node, key: &str, angle: &Expression) {
    if let Some((written, eighths)) = angle.rounded_multiple() {
        let meant = match eighths {
            4 => "pi".to_owned(),
            _ if eighths % 4 == 0 => format!("{}*pi", eighths / 4),
            2 => "pi/2".to_owned(),
            _ if eighths % 2 == 0 => format!("{}*pi/2", eighths / 2),
            1 => "pi/4".to_owned(),
            _ => format!("{eighths}*pi/4"),
        };
        reader.warn(
            node.place,
            format!(
                "{key}: {written} is a general angle, {:.1e} rad from {meant}; write {meant} if that is meant: only then \
                 are sines, cosines and base parameters those of {meant}",
                (written - eighths as f64 * FRAC_PI_4).abs()
            ),
        );
    }
}

/// An entry without variables where the joint does not move (`expected` is false); with some where it does.
fn check_variable(
    formula: &Formula,
    key: &str,
    j: usize,
    kind: JointKind,
    expected: bool,
) -> Result<(), String> {
    let sigma = match kind {
        JointKind::Revolute => "0 (revolute)",
        JointKind::Prismatic => "1 (prismatic)",
        JointKind::Fixed => "2 (fixed)",
    };
    let mismatch = format!("{key} of frame {j} does not match sigma {sigma}");
    match (expected, formula.variables.as_slice()) {
        (false, []) => Ok(()),
        (false, [(k, ..), ..]) => Err(format!("{mismatch}: expected a constant, found q{k}")),
        (true, _) => Err(format!(
            "{mismatch}: expected q{j} plus a constant, or a sum of the variables of several joints"
        )),
    }
}

/// Every parent must be a frame that comes earlier.
fn check_parents(reader: &mut Reader, rows: &[Option<Row>], count: usize) {
    let parent_of =
        |j: usize| rows.get(j.wrapping_sub(1)).and_then(Option::as_ref).map(|row| row.frame.parent);
    for row in rows.iter().flatten() {
        let TableRow { j, parent, .. } = row.frame;
        if parent < j {
            continue;
        }
        let message = if parent == j {
            format!("frame {j} is its own parent: expected 0 to {}", j - 1)
        } else if parent > count {
            format!(
                "frame {j} has parent {parent}, but the table has {count} frames: expected 0 to {}",
                j - 1
            )
        } else {
            let mut chain = vec![j];
            let mut at = Some(parent);
            while let Some(k) = at.filter(|k| *k != 0 && !chain.contains(k)) {
                chain.push(k);
                at = parent_of(k);
            }
            if at == Some(j) {
                let words: Vec<String> = chain.iter().chain([&j]).map(usize::to_string).collect();
                format!("the parents of frame {j} go in a circle: {}", words.join(" -> "))
            } else {
                format!(
                    "parent {parent} of frame {j} comes later: expected 0 to {}; put the parent first",
                    j - 1
                )
            }
        };
        reader.report(row.parent_place, message);
    }
}
