//! Short formulas for a curve that is known within a band.

use crate::report::significant;
use nalgebra::{DMatrix, DVector};

/// A point of a curve: y with its standard deviation. Any constant may be added to y: the model has an offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Point {
    pub x: f64,
    pub y: f64,
    pub sigma: f64,
}

/// What is written of a form, given its amplitudes and the name of the variable.
type Wording = Box<dyn Fn(&[f64], &str) -> String>;

/// A form that is tried, for a number that it has no linear place for.
struct Shape {
    /// Its functions of x beside a constant.
    functions: Box<dyn Fn(f64) -> Vec<f64>>,
    words: Wording,
    /// Numbers, the constant aside.
    numbers: usize,
}

/// Waves over an interval that a sine may have at most.
const WAVES: f64 = 1.5;
/// Steps of a number that is looked for.
const STEPS: usize = 40;
/// The band: this many standard deviations.
const BAND: f64 = 2.0;
/// Part of the points that stay in the band by chance if the formula is right. Neighbours go together.
const WITHIN: f64 = 0.95;
/// Least part of the variance of the curve: what explains less is no formula for it, however wide the band.
const EXPLAINED: f64 = 0.95;

/// The formula with the fewest numbers that stays within the band of a curve over `name`, an angle or not; `None` where
/// there is none. It is a proposal: others may do as well.
pub(in crate::diagnosis) fn propose(points: &[Point], name: &str, angle: bool) -> Option<String> {
    let mut shapes = shapes(points, angle);
    shapes.sort_by_key(|s| s.numbers);
    let fits = shapes.iter().filter_map(|s| Some((s, fit(points, s)?)));
    let good: Vec<(&Shape, Fitted)> =
        fits.filter(|(_, f)| f.within >= WITHIN && f.explained >= EXPLAINED).collect();
    let least = good.first()?.0.numbers;
    let same = good.into_iter().filter(|(s, _)| s.numbers == least);
    let (shape, fitted) = same.min_by(|a, b| a.1.chi.total_cmp(&b.1.chi))?;
    Some((shape.words)(&fitted.amplitude, name))
}

struct Fitted {
    amplitude: Vec<f64>,
    /// Part of the points within the band.
    within: f64,
    /// Part of the variance of the curve.
    explained: f64,
    /// Squared deviations in units of the variances.
    chi: f64,
}

/// Weighted least squares with a constant.
fn fit(points: &[Point], shape: &Shape) -> Option<Fitted> {
    let widest = points.iter().map(|p| p.sigma).fold(0.0, f64::max);
    let weight = |p: &Point| 1.0 / p.sigma.max(1e-3 * widest).max(f64::MIN_POSITIVE);
    let row = |p: &Point| -> Vec<f64> { [1.0].into_iter().chain((shape.functions)(p.x)).collect() };
    let rows: Vec<Vec<f64>> = points.iter().map(row).collect();
    let count = rows.first()?.len();
    let w = DMatrix::from_fn(points.len(), count, |r, c| rows[r][c] * weight(&points[r]));
    let y = DVector::from_fn(points.len(), |r, _| points[r].y * weight(&points[r]));
    let solved = w.clone().svd(true, true).solve(&y, 1e-10).ok()?;
    let left = &y - w * &solved;
    let mean = points.iter().map(|p| p.y).sum::<f64>() / points.len() as f64;
    let whole: f64 = points.iter().map(|p| (p.y - mean).powi(2)).sum();
    let apart: f64 = left.iter().zip(points).map(|(l, p)| (l / weight(p)).powi(2)).sum();
    let inside = left.iter().filter(|l| l.abs() <= BAND).count();
    Some(Fitted {
        amplitude: solved.iter().skip(1).copied().collect(),
        within: inside as f64 / points.len() as f64,
        explained: 1.0 - apart / whole.max(f64::MIN_POSITIVE),
        chi: left.norm_squared(),
    })
}

fn number(x: f64) -> String {
    significant(x, 3)
}

fn shapes(points: &[Point], angle: bool) -> Vec<Shape> {
    let (low, high) =
        points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.x), b.max(p.x)));
    let length = (high - low).max(f64::MIN_POSITIVE);
    let one = |f: fn(f64) -> f64, words: fn(&str) -> String| Shape {
        functions: Box::new(move |x| vec![f(x)]),
        words: Box::new(move |a, name| format!("{}·{}", number(a[0]), words(name))),
        numbers: 1,
    };
    let mut list = vec![one(|x| x, str::to_owned)];
    if low < 0.0 && high > 0.0 {
        list.push(one(f64::abs, |n| format!("|{n}|")));
        list.push(one(f64::signum, |n| format!("sign({n})")));
    }
    list.push(Shape {
        functions: Box::new(|x| vec![x, x * x]),
        words: Box::new(|a, n| format!("{}·{n} + {}·{n}²", number(a[0]), number(a[1]))),
        numbers: 2,
    });
    let step = |k: usize, from: f64, to: f64| from * (to / from).powf(k as f64 / (STEPS - 1) as f64);
    for k in 0..STEPS {
        if angle {
            let order =
                step(k, 0.25 * std::f64::consts::TAU / length, WAVES * std::f64::consts::TAU / length);
            list.push(Shape {
                functions: Box::new(move |x| vec![(order * x).cos(), (order * x).sin()]),
                words: Box::new(move |a, n| {
                    let (size, phase) = (a[0].hypot(a[1]), a[0].atan2(a[1]));
                    let sign = if phase < 0.0 { '-' } else { '+' };
                    format!("{}·sin({}·{n} {sign} {})", number(size), number(order), number(phase.abs()))
                }),
                numbers: 3,
            });
        }
        for sign in [-1.0, 1.0] {
            let rate = step(k, length / 10.0, length * 2.0);
            let from = if sign < 0.0 { low } else { high };
            list.push(Shape {
                functions: Box::new(move |x| vec![(sign * (x - from) / rate).exp()]),
                words: Box::new(move |a, n| {
                    let start = a[0] * (-sign * from / rate).exp();
                    let minus = if sign < 0.0 { "-" } else { "" };
                    format!("{}·exp({minus}{n}/{})", number(start), number(rate))
                }),
                numbers: 2,
            });
        }
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve over -1..=2 with a band of 0.05.
    fn curve(f: impl Fn(f64) -> f64) -> Vec<Point> {
        let x = (0..41).map(|k| 3.0 * f64::from(k) / 40.0 - 0.999);
        // What a fit leaves of noise is smooth.
        x.map(|x| Point { x, y: 0.4 + f(x) + 0.03 * (5.0 * x).sin(), sigma: 0.05 }).collect()
    }

    #[test]
    fn the_shortest_formula_within_the_band_is_proposed() {
        let proposed = |f: &dyn Fn(f64) -> f64| propose(&curve(f), "q2", true).unwrap_or_default();
        assert!(proposed(&|x| 2.0 * x).ends_with("·q2"), "{}", proposed(&|x| 2.0 * x));
        assert!(proposed(&|x: f64| 1.5 * x.abs()).ends_with("·|q2|"));
        assert!(proposed(&|x: f64| x.signum()).ends_with("·sign(q2)"));
        assert!(proposed(&|x| x * x - x).contains("q2²"));
        assert!(proposed(&|x: f64| 3.0 * (-x / 0.6).exp()).contains("exp(-q2/"));
        assert!(
            proposed(&|x: f64| (2.8 * x + 0.3).sin()).contains("sin(2.8"),
            "{}",
            proposed(&|x: f64| (2.8 * x + 0.3).sin())
        );
    }

    #[test]
    fn none_is_proposed_for_a_curve_that_is_none_of_them() {
        let bump = |x: f64| 2.0 * (-((x - 0.4) / 0.3).powi(2)).exp() + 0.8 * x * x * x - x;
        assert_eq!(propose(&curve(bump), "q2", true), None);
        // An angle is needed for a wave.
        assert_eq!(propose(&curve(|x: f64| (2.8 * x + 0.3).sin() + 0.2 * x), "dq2", false), None);
    }
}
