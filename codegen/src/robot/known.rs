//! Parameters that are known before anything is identified: links without inertia, rotors that do not count.

use super::diagnostic::nearest;
use super::document::{Node, Value, shortened};
use super::drive_table::DriveTable;
use super::reader::Reader;
use super::table::{TableRow, standard_parameters};
use dynid_description::{ParameterKind, StandardParameter};

/// Reads `massless` and `known`: the standard parameters that are 0, as indices, ascending.
pub(super) fn read_known(
    reader: &mut Reader,
    (massless, known): (Option<&Node>, Option<&Node>),
    (frames, drive): (&[TableRow], &DriveTable),
    constants: &[(String, f64)],
) -> Vec<usize> {
    let standard = standard_parameters(frames, drive);
    let mut zero = Vec::new();
    for item in
        massless.and_then(|node| reader.list(node, "massless as a list of frame numbers")).unwrap_or(&[])
    {
        let Some(j) = reader.integer(item, "the number j of a frame") else { continue };
        if !frames.iter().any(|f| f.j == j) {
            reader.report(
                item.place,
                format!("massless names {j}: the table has frames 1 to {}", frames.len()),
            );
        }
        let of_frame = |k: &usize| standard[*k].frame + 1 == j && standard[*k].kind <= ParameterKind::M;
        zero.extend((0..standard.len()).filter(of_frame));
    }
    if let Some(node) = known {
        zero.extend(read_values(reader, node, (&standard, drive), constants));
    }
    zero.sort_unstable();
    zero.dedup();
    zero
}

/// The parameters of `known`, by index.
fn read_values(
    reader: &mut Reader,
    node: &Node,
    (standard, drive): (&[StandardParameter], &DriveTable),
    constants: &[(String, f64)],
) -> Vec<usize> {
    let mut zero = Vec::new();
    let Value::Mapping(pairs) = &node.value else {
        let found = node.describe();
        reader.report(node.place, format!("expected known parameters by name ({{M4: 0}}), found {found}"));
        return zero;
    };
    for (key, value) in pairs {
        let Some(name) = reader.text(key, "the name of a standard parameter") else { continue };
        let Some(k) = standard.iter().position(|p| p.name == name) else {
            let names = standard.iter().map(|p| p.name.as_ref());
            let hint =
                nearest(name, names).map_or_else(String::new, |close| format!("; did you mean {close}?"));
            let shown = shortened(name);
            reader.report(key.place, format!("'{shown}' is not a standard parameter of this robot{hint}"));
            continue;
        };
        let Some(number) = reader.number(value, name, constants) else { continue };
        if number != 0.0 {
            reader.report(
                value.place,
                format!(
                    "{name} is known to be {number}: only 0 is supported, which takes its column out of the model. Leave \
                     {name} out of `known`, and name it in `nominal` as a prior"
                ),
            );
        }
        if standard[k].kind >= ParameterKind::Fv && !drive.coupled_friction.is_empty() {
            reader.report(
                key.place,
                format!("{name}: friction of coupled motors is compared with that of the joints, which cannot be left out"),
            );
        }
        zero.push(k);
    }
    zero
}
