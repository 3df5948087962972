//! Torque that depends on the position alone, as a bounded curve.

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, SpecialCase, Step, ToldBy, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "position_dependent_torque",
    name: "position-dependent torque",
    what: "A torque that is a function of the position alone and no spring: a cable that bends, a magnet, a balancer.",
    looks_like: "a bent residual over the position, the same at every speed and in both directions",
    revealed_by: "joint position",
    experiment: "slow strokes over the full travel in both directions",
    source: "Wang et al. 2019 (cable torques of a master arm)",
    symbols: &[
        ("swing", "difference between the highest and the lowest torque"),
        ("centre", "middle of the travel"),
        ("half_travel", "half of the travel"),
        ("p1", "factors of the polynomials"),
        ("P1", "Legendre polynomials of degree 1 and on"),
    ],
    put_in: "the law as a torque of the joint",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: false,
    repeats: false,
    special_case: Some(SpecialCase { effects: &[&super::spring::Spring], told_by: ToldBy::Gain(SPRING) }),
    abscissa: Abscissa::Position,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// What is a line in so much of its squares over the travel is called a spring.
const SPRING: f64 = 0.75;

/// The effect.
pub(super) struct PositionDependentTorque;

/// Degree of the highest polynomial: a cubic shows a cable that bends, the fifth one the ends of its travel.
const DEGREE: usize = 5;

/// Legendre's polynomials of degree 1 to [`DEGREE`] at x in -1..=1, by their recurrence.
fn legendre(x: f64) -> [f64; DEGREE] {
    let mut out = [x; DEGREE];
    let (mut before, mut last) = (1.0, x);
    for (k, value) in out.iter_mut().enumerate().skip(1) {
        let n = k as f64;
        let next = ((2.0 * n + 1.0) * x * last - n * before) / (n + 1.0);
        (before, last) = (last, next);
        *value = next;
    }
    out
}

impl Effect for PositionDependentTorque {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&PositionDependentTorque)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("a torque that depends on the position and on nothing else swings by {}", q.text("swing"))
    }

    fn formula(&self, q: &Quantities) -> String {
        let terms: Vec<String> = (1..=DEGREE)
            .filter_map(|n| {
                let name = format!("p{n}");
                q.has(&name).then(|| format!("{}·P{n}(x)", q.value(&name)))
            })
            .collect();
        let x = format!("x = (q - {}) / {}", q.value("centre"), q.value("half_travel"));
        format!("{}, {x}", terms.join(" + "))
    }
}

impl JointLaw for PositionDependentTorque {
    /// The shape is the middle and the half of the travel that the curve is over.
    fn amplitudes(&self, _: &[f64]) -> usize {
        DEGREE
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        vec![vec![scale.centre, 0.5 * scale.range]]
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        Vec::new()
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn holds_only_where_seen(&self) -> bool {
        true
    }

    /// Beyond the travel that was seen, the torque stays what it is at its end.
    fn law(&self, _: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let x = ((at.q - shape[0]) / shape[1].abs().max(1e-9)).clamp(-1.0, 1.0);
        out.copy_from_slice(&legendre(x));
    }

    /// Whether three quarters of the squares of the curve are those of its line. What the line explains beside the
    /// standard model says less: gravity takes a part of it.
    fn is_mostly_special(&self, amplitude: &[f64]) -> Option<bool> {
        let squares = |(k, a): (usize, &f64)| a * a / (2.0 * k as f64 + 3.0);
        let whole: f64 = amplitude.iter().enumerate().map(squares).sum();
        amplitude.first().map(|a| a * a / 3.0 >= SPRING * whole)
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Smooth
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let unit = scale.kind.torque_unit();
        let at = |x: f64| legendre(x).iter().zip(a).map(|(p, a)| p * a).sum::<f64>();
        let curve = (-50..=50).map(|i| (f64::from(i) / 50.0, at(f64::from(i) / 50.0)));
        let (low, high) = curve.fold(((0.0, f64::INFINITY), (0.0, f64::NEG_INFINITY)), |(low, high), p| {
            (if p.1 < low.1 { p } else { low }, if p.1 > high.1 { p } else { high })
        });
        let [top, bottom] = [high.0, low.0].map(legendre);
        let sigma = (0..DEGREE).map(|k| ((top[k] - bottom[k]) * s[k]).powi(2)).sum::<f64>().sqrt();
        let mut list = vec![
            Parameter::new("swing", high.1 - low.1, sigma, unit),
            Parameter::new("centre", shape[0], 0.0, scale.kind.position_unit()),
            Parameter::new("half_travel", shape[1], 0.0, scale.kind.position_unit()),
        ];
        list.extend((0..DEGREE).map(|k| Parameter::new(&format!("p{}", k + 1), a[k], s[k], unit)));
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomials_are_those_of_legendre() {
        // numpy.polynomial.legendre.legval(0.4, ..) for P1 to P5.
        let expected = [0.4, -0.26, -0.44, -0.113, 0.270_64];
        for (p, expected) in legendre(0.4).iter().zip(expected) {
            approx::assert_relative_eq!(*p, expected, max_relative = 1e-12);
        }
    }

    #[test]
    fn beyond_the_travel_the_torque_stays() {
        let scale = Scale { range: 2.0, centre: 1.0, ..Scale::UNIT };
        let shape = &PositionDependentTorque.shapes(&scale)[0];
        let at = |q: f64| {
            let mut out = [0.0; DEGREE];
            PositionDependentTorque.law(&scale, shape, &At { q, ..At::default() }, 0.0, &mut out);
            out
        };
        assert_eq!(at(2.0), at(7.0));
        assert_eq!(at(0.0), at(-7.0));
        assert_ne!(at(0.5), at(1.5));
    }
}
