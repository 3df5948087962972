//! The rows of the modified-DH table.

use super::document::{Node, Place, Value};
use super::reader::Reader;
use super::{Expression, Frame, JointKind};

const KEYS: [&str; 9] = ["j", "parent", "sigma", "gamma", "b", "alpha", "d", "theta", "r"];
/// Most rows that a table may have.
const MAX_FRAMES: usize = 64;

/// Reads `frames`. `None` where a row is so wrong that nothing that counts joints can be checked.
pub(super) fn read_frames(
    reader: &mut Reader,
    node: &Node,
    constants: &[(String, f64)],
) -> Option<Vec<Frame>> {
    let rows =
        reader.list(node, "frames as a list of rows {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}")?;
    if rows.is_empty() {
        reader.report(node.place, "frames is empty; expected at least one row");
        return None;
    }
    if rows.len() > MAX_FRAMES {
        reader.report(node.place, format!("frames has {} rows; expected at most {MAX_FRAMES}", rows.len()));
        return None;
    }
    let frames: Vec<_> =
        rows.iter().enumerate().map(|(k, row)| read_frame(reader, row, k + 1, constants)).collect();
    check_parents(reader, &frames, rows.len());
    let frames: Option<Vec<Frame>> = frames.into_iter().map(|f| f.map(|row| row.frame)).collect();
    let frames = frames?;
    if frames.iter().all(|f| f.kind == JointKind::Fixed) {
        reader
            .report(node.place, "every frame is fixed (sigma 2); expected at least one joint (sigma 0 or 1)");
        return None;
    }
    Some(frames)
}

struct Row {
    frame: Frame,
    parent_place: Place,
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
    let parent = match fields.get("parent") {
        Some(node) => reader.integer(node, "parent as the number of a frame (0 is the base)"),
        None => Some(j - 1),
    };
    let mut constant = |key: &str, needed: bool| {
        let node = if needed { reader.required(&fields, key) } else { fields.get(key) };
        match node {
            Some(node) => reader.constant(node, key, constants),
            None => (!needed).then_some(Expression::ZERO),
        }
    };
    let gamma = constant("gamma", false);
    let b = constant("b", false);
    let alpha = constant("alpha", true);
    let d = constant("d", true);
    let mut moving = |key: &str, moves: Option<bool>| {
        let node = reader.required(&fields, key)?;
        let formula = reader.formula(node, key, constants)?;
        let signs: Vec<(usize, i32)> = formula.variables.iter().map(|&(k, sign, _)| (k, sign)).collect();
        let sigma = match kind {
            Some(JointKind::Revolute) => "0 (revolute)",
            Some(JointKind::Prismatic) => "1 (prismatic)",
            _ => "2 (fixed)",
        };
        match (moves, signs.as_slice()) {
            (None, _) | (Some(false), []) => {}
            (Some(true), &[(k, 1)]) if k == j => {}
            (Some(true), []) => {
                reader.report(
                    node.place,
                    format!("{key} of frame {j} does not match sigma {sigma}: expected q{j} plus a constant"),
                );
            }
            (Some(true), _) => {
                reader.report(node.place, format!("{key} of frame {j}: expected q{j} once, plus a constant"));
            }
            (Some(false), &[(k, _), ..]) => {
                reader.report(
                    node.place,
                    format!(
                        "{key} of frame {j} does not match sigma {sigma}: expected a constant, found q{k}"
                    ),
                );
            }
        }
        Some(formula.constant.unwrap_or(Expression::ZERO))
    };
    let theta = moving("theta", kind.map(|k| k == JointKind::Revolute));
    let r = moving("r", kind.map(|k| k == JointKind::Prismatic));
    let frame = Frame {
        j,
        parent: parent?,
        kind: kind?,
        gamma: gamma?,
        b: b?,
        alpha: alpha?,
        d: d?,
        theta: theta?,
        r: r?,
    };
    let parent_place = fields.get("parent").map_or(node.place, |node| node.place);
    Some(Row { frame, parent_place })
}

/// Every parent must be a frame that comes earlier.
fn check_parents(reader: &mut Reader, rows: &[Option<Row>], count: usize) {
    let parent_of =
        |j: usize| rows.get(j.wrapping_sub(1)).and_then(Option::as_ref).map(|row| row.frame.parent);
    for row in rows.iter().flatten() {
        let Frame { j, parent, .. } = row.frame;
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
