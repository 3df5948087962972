//! The robot as numbers, as statics of the generated module: a record a line.

use crate::mechanics::Equations;
use dynid_description::{
    BaseParameter, Coupling, CouplingLaw, DependentFrame, Frame, Limits, Nominal, Robot, StandardParameter,
};

/// Longest line of a list.
const WIDTH: usize = 100;

/// `static ROBOT` and `static PATTERN`.
pub fn statics(robot: &Robot, equations: &Equations) -> String {
    let description = super::header::one_line(&robot.description);
    let fields = [
        ("name", borrowed(&robot.name)),
        ("description", borrowed(&description)),
        ("gravity", format!("{:?}", robot.gravity)),
        ("frames", records(robot.frames.iter().map(frame))),
        ("dependent", records(robot.dependent.iter().map(dependent))),
        (
            "drive",
            nested(
                "Drive",
                &[
                    ("gear", floats(8, &robot.drive.gear)),
                    ("coupled_friction", indices(8, &robot.drive.coupled_friction)),
                ],
            ),
        ),
        ("couplings", records(robot.couplings.iter().map(coupling))),
        ("known", indices(4, &robot.known)),
        ("fixed", list(4, robot.fixed.iter().map(|pair| format!("{pair:?}")))),
        ("ellipsoids", records(robot.ellipsoids.iter().map(|pair| format!("{pair:?}")))),
        ("limits", limits(&robot.limits)),
        ("standard", records(robot.standard.iter().map(standard))),
        ("base", records(robot.base.iter().map(base))),
        ("nominal", robot.nominal.as_ref().map_or_else(|| "None".to_owned(), nominal)),
    ];
    let fields: String = fields.iter().map(|(name, value)| format!("    {name}: {value},\n")).collect();
    format!("/// The robot.\npub static ROBOT: Robot = Robot {{\n{fields}}};\n{}", pattern(equations))
}

fn frame(frame: &Frame) -> String {
    let Frame { parent, kind, gamma, b, alpha, d, theta, r } = frame;
    format!(
        "Frame {{ parent: {parent:?}, kind: JointKind::{kind:?}, gamma: {gamma:?}, b: {b:?}, alpha: {alpha:?}, d: {d:?}, \
         theta: {theta:?}, r: {r:?} }}"
    )
}

fn dependent(frame: &DependentFrame) -> String {
    let DependentFrame { frame, kind, terms } = frame;
    format!(
        "DependentFrame {{ frame: {frame}, kind: JointKind::{kind:?}, terms: Cow::Borrowed(&{terms:?}) }}"
    )
}

fn coupling(coupling: &Coupling) -> String {
    let Coupling { name, terms, law } = coupling;
    let law = match law {
        CouplingLaw::Friction => "Friction".to_owned(),
        CouplingLaw::Spring => "Spring".to_owned(),
        CouplingLaw::SpringAt(rest) => format!("SpringAt({rest:?})"),
        CouplingLaw::Between(between) => format!("Between({between:?})"),
    };
    format!(
        "Coupling {{ name: {}, terms: Cow::Borrowed(&{terms:?}), law: CouplingLaw::{law} }}",
        borrowed(name)
    )
}

fn standard(parameter: &StandardParameter) -> String {
    let StandardParameter { name, kind, frame, coupling } = parameter;
    format!(
        "StandardParameter {{ name: {}, kind: ParameterKind::{kind:?}, frame: {frame}, coupling: {coupling:?} }}",
        borrowed(name)
    )
}

fn base(parameter: &BaseParameter) -> String {
    let BaseParameter { name, standard, combination, relation, unit } = parameter;
    let (name, relation, unit) = (borrowed(name), borrowed(relation), borrowed(unit));
    let one_line = format!(
        "BaseParameter {{ name: {name}, standard: {standard}, combination: Cow::Borrowed(&{combination:?}), relation: \
         {relation}, unit: {unit} }}"
    );
    if one_line.len() <= WIDTH + 40 {
        return one_line;
    }
    format!(
        "BaseParameter {{\n            name: {name}, standard: {standard}, unit: {unit},\n            \
         relation: {relation},\n            combination: Cow::Borrowed(&{combination:?}),\n        }}"
    )
}

fn limits(limits: &Limits) -> String {
    let Limits { position, velocity, acceleration, torque } = limits;
    let pairs = |values: &[[f64; 2]]| list(8, values.iter().map(|pair| format!("{pair:?}")));
    nested(
        "Limits",
        &[
            ("position", pairs(position)),
            ("velocity", pairs(velocity)),
            ("acceleration", pairs(acceleration)),
            ("torque", pairs(torque)),
        ],
    )
}

fn nominal(nominal: &Nominal) -> String {
    let Nominal { standard, kp, kd, ki, position_noise, torque_noise } = nominal;
    let fields = [
        ("standard", floats(8, standard)),
        ("kp", floats(8, kp)),
        ("kd", floats(8, kd)),
        ("ki", floats(8, ki)),
        ("position_noise", floats(8, position_noise)),
        ("torque_noise", floats(8, torque_noise)),
    ];
    format!("Some({})", nested("Nominal", &fields))
}

fn pattern(equations: &Equations) -> String {
    let entries = equations.pattern();
    let rows: Vec<usize> =
        (0..=equations.idm.len()).map(|i| entries.iter().filter(|e| e.0 < i).count()).collect();
    let columns: Vec<usize> = entries.iter().map(|e| e.1).collect();
    let values: Vec<_> = entries.iter().map(|&(i, k)| equations.idm[i][k]).collect();
    // The value itself is among the values, so that a position is always found.
    let same_as: Vec<usize> = values.iter().filter_map(|v| values.iter().position(|x| x == v)).collect();
    let lists = [("rows", rows), ("columns", columns), ("same_as", same_as)];
    let fields: String =
        lists.iter().map(|(name, values)| format!("    {name}: {},\n", indices(4, values))).collect();
    format!(
        "/// The entries of IDM that are not identically zero.\npub static PATTERN: Pattern = Pattern {{\n{fields}}};\n"
    )
}

/// A value of a field whose own fields are a line each.
fn nested(name: &str, fields: &[(&str, String)]) -> String {
    let fields: String = fields.iter().map(|(name, value)| format!("        {name}: {value},\n")).collect();
    format!("{name} {{\n{fields}    }}")
}

/// A list with a record a line.
fn records(items: impl Iterator<Item = String>) -> String {
    let lines: String = items.map(|item| format!("        {item},\n")).collect();
    if lines.is_empty() {
        "Cow::Borrowed(&[])".to_owned()
    } else {
        format!("Cow::Borrowed(&[\n{lines}    ])")
    }
}

/// A list of a field that is so deep, in lines that are filled.
fn list(depth: usize, items: impl Iterator<Item = String>) -> String {
    let items: Vec<String> = items.collect();
    let one_line = items.join(", ");
    if one_line.len() <= WIDTH - 40 {
        return format!("Cow::Borrowed(&[{one_line}])");
    }
    let (inner, outer) = (" ".repeat(depth + 4), " ".repeat(depth));
    let mut lines = vec![String::new()];
    for item in items {
        if lines.last().is_some_and(|line| line.len() + item.len() + 2 > WIDTH) {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            line.push_str(if line.is_empty() { &inner } else { " " });
            line.push_str(&item);
            line.push(',');
        }
    }
    format!("Cow::Borrowed(&[\n{}\n{outer}])", lines.join("\n"))
}

fn floats(depth: usize, values: &[f64]) -> String {
    list(depth, values.iter().map(|x| format!("{x:?}")))
}

fn indices(depth: usize, values: &[usize]) -> String {
    list(depth, values.iter().map(usize::to_string))
}

fn borrowed(text: &str) -> String {
    format!("Cow::Borrowed({text:?})")
}
