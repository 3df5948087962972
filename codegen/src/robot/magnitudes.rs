//! How large the numbers of a table may be, and which are allowed but probably not meant.

use super::document::Node;
use super::expression::Expression;
use super::reader::Reader;
use dynid_description::bounds::{LONGEST, NEGLIGIBLE, WIDEST};
use std::f64::consts::TAU;

/// How far a turn may be rounded, rad: 6.29 is one.
const ROUNDING: f64 = 0.01;

/// Reports an entry of the table that no robot has, and warns of one that is negligible or looks like degrees.
pub(super) fn check(reader: &mut Reader, node: &Node, key: &str, entry: &Expression) {
    let value = entry.value();
    let is_angle = matches!(key, "alpha" | "gamma" | "theta");
    let (most, unit) = if is_angle { (WIDEST, "rad") } else { (LONGEST, "m") };
    let size = value.abs();
    if size > most {
        reader.report(node.place, format!("{key} is {value:e} {unit}: expected at most {most} {unit}"));
    } else if size > 0.0 && size < NEGLIGIBLE {
        reader.warn(
            node.place,
            format!(
                "{key} is {value:e} {unit}: taken as it stands it makes base parameters that no motion shows; write 0 if \
                 0 is meant"
            ),
        );
    } else if is_angle && size > TAU + ROUNDING {
        reader.warn(
            node.place,
            format!(
                "{key} is {value} rad, more than a turn: is it in degrees? Write {value}*pi/180 if it is"
            ),
        );
    }
}

/// A number whose size lies between `least` and `most`, or that is 0 where `least` is; otherwise it is reported.
pub(super) fn within(reader: &mut Reader, node: &Node, what: &str, value: f64, [least, most]: [f64; 2]) {
    let size = value.abs();
    if size > most {
        reader.report(node.place, format!("{what} is {value:e}: expected at most {most:e}"));
    } else if size < least {
        reader.report(node.place, format!("{what} is {value:e}: expected at least {least:e}"));
    }
}
