//! Friction between links or of a tendon, and springs: what the table says acts on several joints at once.

use super::between::{joints_of, read_points};
use super::coupled_robot::Known;
use super::document::{Node, Value};
use super::drive_table::DriveTable;
use super::identifier::check_identifier;
use super::magnitudes::within;
use super::reader::{Fields, Reader};
use super::table::TableRow;
use crate::exact::{Number, Span, decimal};
use crate::robot::formula::joint_variable;
use dynid_description::bounds::{LONGEST, WIDEST};
use dynid_description::{Between, Coupling, CouplingLaw, DependentFrame, JointKind};

const FRICTION_KEYS: [&str; 2] = ["joints", "name"];
const SPRING_KEYS: [&str; 6] = ["joint", "joints", "between", "law", "rest", "name"];

/// Reads `friction` and `springs`, in this order.
pub(super) fn read_couplings(
    reader: &mut Reader,
    (friction, springs): (Option<&Node>, Option<&Node>),
    (frames, dependent, drive): (&[TableRow], &[DependentFrame], &DriveTable),
    constants: &[(String, f64)],
) -> Vec<Coupling> {
    let joints = frames.iter().filter(|f| f.kind != JointKind::Fixed).map(|f| f.j).collect();
    let known = Known { joints, frames, dependent, drive, constants };
    let mut found = Vec::new();
    let what = "friction as a list of entries ({joints: {q6: 1, q7: -1}})";
    for item in friction.and_then(|node| reader.list(node, what)).unwrap_or_default() {
        read_friction(reader, item, &known, &mut found);
    }
    let what = "springs as a list of entries ({joint: 2}, {joints: {q2: 1, q3: -1}, rest: 0.3})";
    let mut stiffnesses = Span::default();
    for item in springs.and_then(|node| reader.list(node, what)).unwrap_or_default() {
        read_spring(reader, item, &known, &mut found, &mut stiffnesses);
    }
    found
}

fn read_friction(reader: &mut Reader, node: &Node, known: &Known<'_>, found: &mut Vec<Coupling>) {
    let Some(fields) = reader.fields(node, "friction between links", &FRICTION_KEYS) else { return };
    let Some(terms) = reader.required(&fields, "joints").and_then(|at| read_terms(reader, at, known)) else {
        return;
    };
    if let [(joint, _)] = terms[..] {
        let j = known.joints[joint];
        let message = format!(
            "friction of joint {j} alone is what Fv{j} and Fc{j} are: name two joints or more, or leave the entry out"
        );
        return reader.report(node.place, message);
    }
    let is_motor = |&motor: &usize| same_direction(&terms, &motor_form(known.drive, motor));
    if let Some(motor) = known.drive.coupled_friction.iter().copied().find(is_motor) {
        let j = known.joints[motor];
        let message = format!("this is the speed of motor {j}, whose friction Fvm{j} and Fcm{j} are already");
        return reader.report(node.place, message);
    }
    let is_same = |c: &&Coupling| c.law == CouplingLaw::Friction && same_direction(&terms, &c.terms);
    if let Some(other) = found.iter().find(is_same) {
        let name = &other.name;
        return reader.report(
            node.place,
            format!("this is the combination whose friction Fvc{name} and Fcc{name} are"),
        );
    }
    let Some(name) = read_name(reader, &fields, node, (&terms, known)) else { return };
    if found.iter().any(|c| c.name == name && c.law == CouplingLaw::Friction) {
        let message = format!("there is friction of the name '{name}' already: give this entry a `name`");
        return reader.report(node.place, message);
    }
    found.push(Coupling { name: name.into(), terms: terms.into(), law: CouplingLaw::Friction });
}

fn read_spring(
    reader: &mut Reader,
    node: &Node,
    known: &Known<'_>,
    found: &mut Vec<Coupling>,
    stiffnesses: &mut Span,
) {
    let Some(fields) = reader.fields(node, "a spring", &SPRING_KEYS) else { return };
    if let Some(law) = fields.get("law")
        && reader.text(law, "the law of the spring").is_some_and(|text| text != "linear")
    {
        reader.report(law.place, format!("the law is linear, found {}", law.describe()));
    }
    if let (Some(between), None, None) = (fields.get("between"), fields.get("joint"), fields.get("joints")) {
        return read_between(reader, node, &fields, between, (known, found));
    }
    let terms = match (fields.get("joint"), fields.get("joints"), fields.get("between")) {
        (Some(joint), None, None) => read_joint(reader, joint, known),
        (None, Some(joints), None) => read_terms(reader, joints, known),
        _ => {
            reader.report(
                node.place,
                "expected a spring on one joint (joint: 2), on a sum (joints: {q2: 1, q3: -1}), or between two points \
                 (between: [{frame: 0, point: [0, 0, 1]}, {frame: 2, point: [0.3, 0, 0]}])",
            );
            None
        }
    };
    let rest = read_rest(reader, &fields, known, WIDEST);
    let Some(terms) = terms else { return };
    let Some(name) = read_name(reader, &fields, node, (&terms, known)) else { return };
    if found.iter().any(|c| c.name == name && c.law != CouplingLaw::Friction) {
        let message = format!("there is a spring of the name '{name}' already: give this one a `name`");
        return reader.report(node.place, message);
    }
    // Two springs on one combination, or four on two joints, are together what fewer can do.
    if !stiffnesses.insert(gram(&terms, known.joints.len())) {
        let message = format!(
            "the stiffness of the spring '{name}' cannot be told from those of the springs above it: torques know their sum \
             only"
        );
        return reader.report(node.place, message);
    }
    let law = rest.map_or(CouplingLaw::Spring, CouplingLaw::SpringAt);
    found.push(Coupling { name: name.into(), terms: terms.into(), law });
}

/// Where a spring is at rest, if the entry says it.
fn read_rest(reader: &mut Reader, fields: &Fields<'_>, known: &Known<'_>, most: f64) -> Option<f64> {
    fields.get("rest").map(|node| {
        let rest = reader.number(node, "rest", known.constants).unwrap_or_default();
        within(reader, node, "rest", rest, [0.0, most]);
        rest
    })
}

/// A spring between two points.
fn read_between(
    reader: &mut Reader,
    node: &Node,
    fields: &Fields<'_>,
    between: &Node,
    (known, found): (&Known<'_>, &mut Vec<Coupling>),
) {
    let rest = read_rest(reader, fields, known, LONGEST);
    let Some(ends) = read_points(reader, between, known) else { return };
    let others: Vec<Between> = found.iter().filter_map(|c| c.law.between()).collect();
    let law = Between { rest, ..ends };
    let terms = match joints_of(&law, &others, known) {
        Ok(terms) => terms,
        Err(message) => return reader.report(between.place, message),
    };
    let Some(name) = read_name(reader, fields, node, (&terms, known)) else { return };
    if found.iter().any(|c| c.name == name && c.law != CouplingLaw::Friction) {
        let message = format!("there is a spring of the name '{name}' already: give this one a `name`");
        return reader.report(node.place, message);
    }
    found.push(Coupling { name: name.into(), terms: terms.into(), law: CouplingLaw::Between(law) });
}

/// The number of one joint as a combination.
fn read_joint(reader: &mut Reader, node: &Node, known: &Known<'_>) -> Option<Vec<(usize, f64)>> {
    let j = reader.integer(node, "the number j of a joint")?;
    let joint = known.joints.iter().position(|&k| k == j);
    if joint.is_none() {
        let joints = &known.joints;
        reader.report(node.place, format!("there is no joint {j}: expected one of {joints:?}"));
    }
    Some(vec![(joint?, 1.0)])
}

/// The combination `{q6: 1, q7: -1}`, joints ascending.
fn read_terms(reader: &mut Reader, node: &Node, known: &Known<'_>) -> Option<Vec<(usize, f64)>> {
    let Value::Mapping(pairs) = &node.value else {
        let found = node.describe();
        reader.report(
            node.place,
            format!("expected joints with their coefficients ({{q6: 1, q7: -1}}), found {found}"),
        );
        return None;
    };
    let mut terms: Vec<(usize, f64)> = Vec::new();
    let before = reader.diagnostics.len();
    for (key, value) in pairs {
        let Some(name) = reader.text(key, "a joint variable, as q6") else { continue };
        let joint = joint_variable(name).and_then(|j| known.joints.iter().position(|&k| k == j));
        let Some(joint) = joint else {
            let names: Vec<String> = known.joints.iter().map(|j| format!("q{j}")).collect();
            let message = format!("{} is no joint: expected one of {}", key.describe(), names.join(", "));
            reader.report(key.place, message);
            continue;
        };
        let Some(coefficient) = reader.number(value, name, known.constants) else { continue };
        if coefficient == 0.0 {
            reader.report(value.place, format!("the coefficient of {name} is 0: leave the joint out"));
        } else if terms.iter().any(|t| t.0 == joint) {
            reader.report(key.place, format!("{name} is there twice"));
        } else {
            within(
                reader,
                value,
                &format!("the coefficient of {name}"),
                coefficient,
                [1.0 / LONGEST, LONGEST],
            );
            terms.push((joint, coefficient));
        }
    }
    if pairs.is_empty() {
        reader.report(node.place, "expected one joint at least ({q6: 1, q7: -1})");
    }
    terms.sort_by_key(|t| t.0);
    (reader.diagnostics.len() == before).then_some(terms)
}

/// What the names of its parameters end with: the numbers of its joints, or `_` and the name that it has.
fn read_name(
    reader: &mut Reader,
    fields: &Fields<'_>,
    node: &Node,
    (terms, known): (&[(usize, f64)], &Known<'_>),
) -> Option<String> {
    let Some(given) = fields.get("name") else {
        let numbers: Vec<String> = terms.iter().map(|t| known.joints[t.0].to_string()).collect();
        return Some(numbers.join("_"));
    };
    let name = reader.text(given, "a name")?;
    if let Err(why) = check_identifier(name) {
        reader.report(given.place, format!("name {} of {} {why}", given.describe(), node.describe()));
        return None;
    }
    Some(format!("_{name}"))
}

/// The speed of a motor in units of its own joint.
fn motor_form(drive: &DriveTable, motor: usize) -> Vec<(usize, f64)> {
    let row = &drive.gear[motor];
    (0..row.len()).filter(|&k| row[k] != 0.0).map(|k| (k, row[k])).collect()
}

/// Whether two combinations are the same but for a factor.
fn same_direction(a: &[(usize, f64)], b: &[(usize, f64)]) -> bool {
    let exact = |terms: &[(usize, f64)], k: usize| decimal(terms[k].1);
    a.len() == b.len()
        && (0..a.len()).all(|k| a[k].0 == b[k].0 && exact(a, k) * exact(b, 0) == exact(b, k) * exact(a, 0))
}

/// The matrix c cT of a combination, row by row: stiffnesses are independent where these are.
fn gram(terms: &[(usize, f64)], joints: usize) -> Vec<Number> {
    let mut matrix = vec![Number::ZERO; joints * joints];
    for &(i, a) in terms {
        for &(k, b) in terms {
            matrix[i * joints + k] = (decimal(a) * decimal(b)).into();
        }
    }
    matrix
}
