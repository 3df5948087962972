//! Numbers as they are read.

use crate::filter::Estimated;

/// A number with this many significant digits.
pub fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".into() } else { "unknown".into() };
    }
    let magnitude = value.abs().log10().floor() as i32;
    if !(-4..7).contains(&magnitude) {
        return format!("{value:.*e}", (digits - 1).max(0) as usize);
    }
    let decimals = digits - 1 - magnitude;
    if decimals >= 0 {
        return format!("{value:.*}", decimals as usize);
    }
    let unit = 10_f64.powi(-decimals);
    format!("{:.0}", (value / unit).round() * unit)
}

/// A value and its standard deviation, both to the place of the first digit of the latter.
pub fn plus_minus(value: f64, sigma: f64, unit: &str) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let place = sigma.abs().log10().floor();
    if !(place.is_finite() && (-6.0..6.0).contains(&place)) {
        return format!("{}{unit}", significant(value, 3));
    }
    let decimals = (-place).max(0.0) as usize;
    format!("{value:.decimals$} ± {sigma:.decimals$}{unit}")
}

/// A change with its sign, to the place of the first digit of `sigma`: `+0.01`.
pub fn signed(change: f64, sigma: f64) -> String {
    let size = plus_minus(change.abs(), sigma, "");
    let size = size.split(" ±").next().unwrap_or_default();
    let sign = match size.parse() {
        Ok(0.0) => "",
        _ if change < 0.0 => "\u{2212}",
        _ => "+",
    };
    format!("{sign}{size}")
}

/// ` (12 %)` where the level before is known well enough to be divided by.
pub(crate) fn percent_of(change: Estimated, before: Estimated) -> String {
    let part = 100.0 * (change.mean / before.mean).abs();
    if before.mean.abs() > 5.0 * before.sigma && part.is_finite() && part < 1e4 {
        format!(" ({} %)", significant(part, 2))
    } else {
        String::new()
    }
}

/// How rare so much evidence is (Ville's inequality).
pub(crate) fn rarity(ln_e_value: f64) -> String {
    if ln_e_value >= 1e6_f64.ln() {
        return "Without a change, less than one series in a million would ever look so.".into();
    }
    let rounded = significant(ln_e_value.exp(), 1);
    format!("Without a change, at most one series in {rounded} would ever look so.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_long_as_they_are_certain() {
        assert_eq!(plus_minus(1.2345, 0.067, "N.m"), "1.23 ± 0.07 N.m");
        assert_eq!(plus_minus(1234.5, 20.0, ""), "1234 ± 20");
        assert_eq!(plus_minus(3.0, 0.0, "kg"), "3.00 kg");
        assert_eq!(significant(45_678.0, 1), "50000");
        assert_eq!(
            [signed(0.26, 0.03), signed(-12.0, 3.0), signed(-0.01, 0.3)],
            ["+0.26", "\u{2212}12", "0.0"]
        );
    }
}
