//! Numbers as a person reads them.

/// A number with `digits` significant digits, in scientific notation only where plain digits would be long.
///
/// ```
/// use dynid_runtime::report::significant;
/// assert_eq!(significant(0.0123456, 3), "0.0123");
/// assert_eq!(significant(1234.5, 3), "1234");
/// assert_eq!(significant(1.5e-7, 2), "1.5e-7");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.max(1);
    let scientific = format!("{:.*e}", digits - 1, value);
    // The exponent after rounding: 9.99 with two digits is 1.0e1.
    let exponent: i32 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        scientific
    }
}

/// A ratio as a percentage with three significant digits: 0.0678 is `6.78 %`. A ratio to nothing, `None`, is
/// `undefined`.
pub fn percent(ratio: impl Into<Option<f64>>) -> String {
    let words = |ratio: f64| format!("{} %", significant(100.0 * ratio, 3));
    ratio.into().map_or_else(|| "undefined".to_owned(), words)
}

/// What an error does from `before` to `after`: a sentence must not say that it falls where it does not, nor that it rises
/// where nobody sees it.
pub fn change_of_error(before: f64, after: f64) -> String {
    let [was, is] = [before, after].map(percent);
    if was == is {
        return format!("stays at {is}");
    }
    format!("{} from {was} to {is}", if after > before { "rises" } else { "falls" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_digits_asked_for_after_rounding_up() {
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(-0.000_099_96, 3), "-0.000100");
    }

    #[test]
    fn says_what_is_not_a_number() {
        assert_eq!(significant(f64::NAN, 3), "NaN");
        assert_eq!(significant(f64::INFINITY, 3), "inf");
    }

    #[test]
    fn an_error_that_grows_does_not_fall() {
        assert_eq!(change_of_error(0.034, 0.038), "rises from 3.40 % to 3.80 %");
        assert_eq!(change_of_error(0.06, 0.045), "falls from 6.00 % to 4.50 %");
        assert_eq!(change_of_error(0.033_31, 0.033_32), "stays at 3.33 %");
    }

    #[test]
    fn writes_a_percentage() {
        assert_eq!(percent(0.067_83), "6.78 %");
    }
}
