//! Residual and law as a picture has them: means over bins of a variable.

use crate::diagnosis::outcome::Curve;
use crate::diagnosis::rules::BINS;
use crate::statistics::bins::Bins;

/// Means over bins with equally many rows; (variable, residual, law).
pub(in crate::diagnosis) fn binned(rows: Vec<(f64, f64, f64)>) -> Curve {
    let mut curve = Curve::default();
    for bin in Bins::over(rows, BINS, |row| row.0).iter() {
        let n = bin.len() as f64;
        let mean = |f: fn(&(f64, f64, f64)) -> f64| bin.iter().map(f).sum::<f64>() / n;
        let (x, r, l) = (mean(|b| b.0), mean(|b| b.1), mean(|b| b.2));
        let spread = bin.iter().map(|b| (b.1 - r).powi(2)).sum::<f64>() / n;
        curve.x.push(x);
        curve.residual.push(r);
        curve.law.push(l);
        curve.error.push((spread / n).sqrt());
    }
    curve
}
