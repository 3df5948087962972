//! Limits, and the nominal values for simulation.

use super::diagnostic::nearest;
use super::document::{Node, Value, shortened};
use super::magnitudes::within;
use super::reader::Reader;
use super::table::NominalValues;
use dynid_description::bounds::{LARGEST_NOMINAL, WIDEST_LIMIT};
use dynid_description::{Limits, StandardParameter};

/// Reads `limits`: per joint a number x, which stands for [-x, x], or [low, high]; one number stands for every joint.
pub(super) fn read_limits(
    reader: &mut Reader,
    node: &Node,
    joints: usize,
    constants: &[(String, f64)],
) -> Limits {
    let mut limits = Limits::default();
    let Some(fields) = reader.fields(node, "limits", &["position", "velocity", "acceleration", "torque"])
    else {
        return limits;
    };
    let mut ranges = |key: &str| {
        let Some(node) = fields.get(key) else { return Vec::new() };
        let single_range = matches!(&node.value, Value::Sequence(items) if joints == 1 && items.len() == 2 && items.iter().all(is_scalar));
        if single_range || is_scalar(node) {
            return vec![range(reader, node, key, constants).unwrap_or_default(); joints];
        }
        let Some(items) = reader.list(node, &format!("limits of {key} as a list with one entry per joint"))
        else {
            return Vec::new();
        };
        let ranges =
            items.iter().map(|item| range(reader, item, key, constants).unwrap_or_default()).collect();
        reader.length(node, &format!("limits of {key}"), items.len(), joints);
        ranges
    };
    limits.position = ranges("position").into();
    limits.velocity = ranges("velocity").into();
    limits.acceleration = ranges("acceleration").into();
    limits.torque = ranges("torque").into();
    limits
}

fn is_scalar(node: &Node) -> bool {
    matches!(node.value, Value::Scalar { .. })
}

fn range(reader: &mut Reader, node: &Node, key: &str, constants: &[(String, f64)]) -> Option<[f64; 2]> {
    let what = format!("limit of {key}");
    if is_scalar(node) {
        let size = reader.number(node, &what, constants)?;
        if size <= 0.0 {
            reader.report(node.place, format!("{what} is {size}: expected a number above 0, or [low, high]"));
            return None;
        }
        within(reader, node, &what, size, [1.0 / WIDEST_LIMIT, WIDEST_LIMIT]);
        return Some([-size, size]);
    }
    let ends = reader.numbers(node, &what, 2, constants)?;
    if ends[0] >= ends[1] {
        reader.report(
            node.place,
            format!("{what} is [{}, {}]: expected [low, high] with low < high", ends[0], ends[1]),
        );
        return None;
    }
    ends.iter().for_each(|&end| within(reader, node, &what, end, [0.0, WIDEST_LIMIT]));
    within(
        reader,
        node,
        &format!("the width of the {what}"),
        ends[1] - ends[0],
        [1.0 / WIDEST_LIMIT, f64::MAX],
    );
    Some([ends[0], ends[1]])
}

/// Reads `nominal`.
pub(super) fn read_nominal(
    reader: &mut Reader,
    node: &Node,
    joints: usize,
    standard: &[StandardParameter],
    constants: &[(String, f64)],
) -> Option<NominalValues> {
    let fields = reader.fields(node, "nominal", &["parameters", "controller", "noise"])?;
    let mut nominal = NominalValues {
        standard: Vec::new(),
        kp: Vec::new(),
        kd: Vec::new(),
        ki: Vec::new(),
        position_noise: Vec::new(),
        torque_noise: Vec::new(),
    };
    if let Some(node) = fields.get("parameters") {
        nominal.standard = read_parameters(reader, node, standard, constants);
    }
    let mut per_joint = |group: &str, what: &'static str, keys: [&str; 3]| {
        let mut lists = [Vec::new(), Vec::new(), Vec::new()];
        let known: Vec<&str> = keys.into_iter().filter(|key| !key.is_empty()).collect();
        let Some(fields) = fields.get(group).and_then(|node| reader.fields(node, what, &known)) else {
            return lists;
        };
        for (list, key) in lists.iter_mut().zip(keys) {
            if let Some(node) = fields.get(key) {
                *list = not_negative(reader, node, &format!("{key} of {what}"), joints, constants);
            }
        }
        lists
    };
    [nominal.kp, nominal.kd, nominal.ki] = per_joint("controller", "the controller", ["kp", "kd", "ki"]);
    [nominal.position_noise, nominal.torque_noise, _] =
        per_joint("noise", "the noise", ["position", "torque", ""]);
    Some(nominal)
}

/// One number for every joint, or a list with one per joint; none below 0.
fn not_negative(
    reader: &mut Reader,
    node: &Node,
    what: &str,
    joints: usize,
    constants: &[(String, f64)],
) -> Vec<f64> {
    let values = if is_scalar(node) {
        reader.number(node, what, constants).map(|x| vec![x; joints])
    } else {
        reader.numbers(node, what, joints, constants)
    };
    let values = values.unwrap_or_default();
    if let Some(negative) = values.iter().find(|&&x| x < 0.0) {
        reader.report(node.place, format!("{what} has {negative}: expected no number below 0"));
    }
    if let Some(&largest) = values.iter().max_by(|a, b| a.total_cmp(b)) {
        within(reader, node, what, largest, [0.0, LARGEST_NOMINAL]);
    }
    values
}

fn read_parameters(
    reader: &mut Reader,
    node: &Node,
    standard: &[StandardParameter],
    constants: &[(String, f64)],
) -> Vec<(String, f64)> {
    let names: Vec<&str> = standard.iter().map(|p| p.name.as_ref()).collect();
    let mut values = Vec::new();
    let Value::Mapping(pairs) = &node.value else {
        let found = node.describe();
        reader.report(
            node.place,
            format!("expected parameters by name ({{ZZ1: 0.35, Fv1: 7.9}}), found {found}"),
        );
        return values;
    };
    for (key, value) in pairs {
        let Some(name) = reader.text(key, "the name of a standard parameter") else { continue };
        if !names.contains(&name) {
            let hint = match nearest(name, names.iter().copied()) {
                Some(close) => format!("did you mean {close}?"),
                None => format!("expected names such as {} to {}", names[0], names[names.len() - 1]),
            };
            reader.report(
                key.place,
                format!("'{}' is not a standard parameter of this robot; {hint}", shortened(name)),
            );
        } else if let Some(first) = reader.first_of(pairs, name, key.place) {
            reader
                .report(key.place, format!("parameter {name} is there twice; first at line {}", first.line));
        } else if let Some(number) = reader.number(value, name, constants) {
            within(reader, value, name, number, [0.0, LARGEST_NOMINAL]);
            values.push((name.to_owned(), number));
        }
    }
    values
}
