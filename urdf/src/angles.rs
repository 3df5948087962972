//! Angles that are meant to be a multiple of pi/4.

use std::f64::consts::FRAC_PI_4;

/// Coarsest rounding that is taken for one, rad: 1.57 and 3.14, but not 0.79.
const COARSEST: f64 = 2e-3;

/// The multiple of pi/4 within `tolerance`, or the angle as it is.
pub(crate) fn snapped(angle: f64, tolerance: f64) -> f64 {
    let multiple = (angle / FRAC_PI_4).round() * FRAC_PI_4;
    if (angle - multiple).abs() <= tolerance { multiple } else { angle }
}

/// How far `angle`, written as `text`, is from a multiple of pi/4 that it seems to be the rounding of, where it is one.
pub(crate) fn rounding(text: &str, angle: f64) -> Option<f64> {
    let eighths = (angle / FRAC_PI_4).round();
    let decimals =
        text.split_once('.').map_or(0, |(_, after)| after.bytes().take_while(u8::is_ascii_digit).count());
    let unit = 10_f64.powi(-(decimals.min(300) as i32));
    let off = (angle - eighths * FRAC_PI_4).abs();
    (eighths != 0.0 && off > 0.0 && off <= unit.min(COARSEST)).then_some(off)
}
