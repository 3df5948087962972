//! Numbers as a person reads them.

use std::f64::consts::PI;

/// Angles within this of a multiple of pi/12, rad, are it: rounding of the arithmetic.
const EXACT: f64 = 1e-12;

/// The shortest decimal that is the number to rounding of a few operations: `0.3`, not 0.30000000000000004.
pub(crate) fn number(x: f64) -> String {
    plain(tidy(x, 4.0 * f64::EPSILON * x.abs()))
}

/// A length, m: as [`number`], with the rounding that sums and rotations of the order of a metre leave.
pub(crate) fn length(x: f64) -> String {
    plain(tidy(x, 8.0 * f64::EPSILON * x.abs().max(1.0)))
}

/// An angle, rad: a multiple of pi/12 as such where it is one to rounding, all digits else.
pub(crate) fn angle(x: f64) -> String {
    let twelfths = (x / (PI / 12.0)).round();
    if twelfths.abs() > 48.0 || (x - twelfths * (PI / 12.0)).abs() > EXACT {
        return length(x);
    }
    let k = twelfths as i64;
    if k == 0 {
        return "0".to_owned();
    }
    let (mut over, mut under) = (k.abs(), 12);
    for factor in [2, 2, 3] {
        if over % factor == 0 && under % factor == 0 {
            over /= factor;
            under /= factor;
        }
    }
    let sign = if k < 0 { "-" } else { "" };
    let over = if over == 1 { String::new() } else { format!("{over}*") };
    if under == 1 { format!("{sign}{over}pi") } else { format!("{sign}{over}pi/{under}") }
}

/// A joint variable and a constant: `q2 - pi/2`.
pub(crate) fn variable(j: usize, constant: &str) -> String {
    match constant.strip_prefix('-') {
        _ if constant == "0" => format!("q{j}"),
        Some(positive) => format!("q{j} - {positive}"),
        None => format!("q{j} + {constant}"),
    }
}

/// All digits that a reader needs for the same number, with an exponent where it has many zeros.
pub(crate) fn plain(x: f64) -> String {
    if x == 0.0 {
        "0".to_owned()
    } else if (1e-5..1e9).contains(&x.abs()) {
        x.to_string()
    } else {
        format!("{x:e}")
    }
}

/// The decimal of the fewest digits within `rounding` of a number.
pub(crate) fn tidy(x: f64, rounding: f64) -> f64 {
    if x.abs() <= rounding {
        return 0.0;
    }
    let short = |digits: usize| format!("{x:.digits$e}").parse::<f64>().ok();
    (0..16).filter_map(short).find(|shorter| (shorter - x).abs() <= rounding).unwrap_or(x)
}

/// A text as a double-quoted scalar of YAML, which JSON's is.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() || c == '\u{feff}' => out.push(' '),
            c => out.push(c),
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::approx_constant, reason = "the rounding of a file")]
    fn numbers_are_as_short_as_they_may_be() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(-1.23456789012345e-7), "-1.23456789012345e-7");
        assert_eq!(length(1e-16), "0");
        assert_eq!(angle(PI / 2.0 + 1e-13), "pi/2");
        assert_eq!(angle(-0.75 * PI), "-3*pi/4");
        assert_eq!(angle(1.5708), "1.5708");
        assert_eq!(angle(PI / 6.0), "pi/6");
        assert_eq!(angle(-PI), "-pi");
        assert_eq!(variable(3, "-pi/2"), "q3 - pi/2");
        assert_eq!(variable(3, "0"), "q3");
    }
}
