//! Parameters that are known before anything is identified: links without inertia, rotors that do not count, a mass that was
//! weighed.

use super::diagnostic::nearest;
use super::document::{Node, Value, shortened};
use super::magnitudes::within;
use super::reader::Reader;
use dynid_description::bounds::LARGEST_NOMINAL;
use dynid_description::{ParameterKind, StandardParameter};

/// Standard parameters by index, ascending.
#[derive(Default)]
pub(super) struct Known {
    /// Those that are 0.
    pub zero: Vec<usize>,
    /// Those that have another value.
    pub fixed: Vec<(usize, f64)>,
}

/// Reads `massless` and `known`.
pub(super) fn read_known(
    reader: &mut Reader,
    (massless, known): (Option<&Node>, Option<&Node>),
    standard: &[StandardParameter],
    constants: &[(String, f64)],
) -> Known {
    let mut all = Known::default();
    for item in
        massless.and_then(|node| reader.list(node, "massless as a list of frame numbers")).unwrap_or(&[])
    {
        let Some(j) = reader.integer(item, "the number j of a frame") else { continue };
        let frames = standard.iter().map(|p| p.frame + 1).max().unwrap_or(0);
        if !(1..=frames).contains(&j) {
            reader.report(item.place, format!("massless names {j}: the table has frames 1 to {frames}"));
        }
        let of_frame = |k: &usize| standard[*k].frame + 1 == j && standard[*k].kind <= ParameterKind::M;
        all.zero.extend((0..standard.len()).filter(of_frame));
    }
    if let Some(node) = known {
        read_values(reader, node, standard, constants, &mut all);
    }
    all.zero.sort_unstable();
    all.zero.dedup();
    all.fixed.sort_by_key(|&(k, _)| k);
    all
}

/// The parameters of `known`.
fn read_values(
    reader: &mut Reader,
    node: &Node,
    standard: &[StandardParameter],
    constants: &[(String, f64)],
    all: &mut Known,
) {
    let Value::Mapping(pairs) = &node.value else {
        let found = node.describe();
        reader.report(node.place, format!("expected known parameters by name ({{M4: 0}}), found {found}"));
        return;
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
        if all.fixed.iter().any(|&(known, _)| known == k) || number != 0.0 && all.zero.contains(&k) {
            reader.report(key.place, format!("{name} is known already, with another value or by `massless`"));
        } else if number == 0.0 {
            all.zero.push(k);
        } else {
            within(reader, value, name, number, [0.0, LARGEST_NOMINAL]);
            all.fixed.push((k, number));
        }
    }
}
