//! Torque constant that droops at high current: a·tau·|tau/tau_max|^(p-1), or beyond a knee k only:
//! a·tau·(max(|tau/tau_max| - k, 0) / (1 - k))^(p-1).
//!
//! tau is what the motor gives, tau_max the largest torque that is recorded, which the motor gives less of. What a person is
//! told is the part d of that one which is missing: d·tau_max = a·tau·... where tau = (1 - d)·tau_max.

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "torque_saturation",
    name: "torque saturation",
    what: "At high current the motor gives less torque than the recording says: its iron saturates.",
    looks_like: "a residual that bends with the torque of the joint and matters only at high torque",
    revealed_by: "model torque",
    experiment: "strokes with the highest accelerations, and the same motion at a third of them",
    source: "Krishnan 2010",
    symbols: &[
        ("droop_at_most_torque", "part of the largest torque that is missing there"),
        ("most_torque", "largest torque of the recording"),
        ("exponent", "power of the torque with which it droops"),
        ("knee", "part of the largest torque from which it droops"),
        ("torque", "torque that the motor gives: of the standard model and of the other laws of the joint"),
    ],
    put_in: "the law as a torque of the joint",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: true,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::ModelTorque,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// A knee leaves at least this part of the torque beyond it.
const LEAST_BEYOND: f64 = 0.02;

/// The effect.
pub(super) struct TorqueSaturation;

impl Effect for TorqueSaturation {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&TorqueSaturation)
    }

    fn detail(&self, q: &Quantities) -> String {
        let knee = if q.has("knee") {
            format!(", and by nothing below {} of it", q.text("knee"))
        } else {
            String::new()
        };
        format!(
            "the torque constant is off by {} at the highest torque{knee}",
            q.text("droop_at_most_torque")
        )
    }

    fn formula(&self, q: &Quantities) -> String {
        let (droop, most) = (q.value("droop_at_most_torque"), q.value("most_torque"));
        if q.has("knee") {
            let knee = q.value("knee");
            return format!(
                "{droop}·torque·max(|torque / {most}| - {knee}, 0) / ((1 - {droop})·(1 - {droop} - {knee}))"
            );
        }
        let exponent = q.value("exponent");
        format!("{droop}·{most}·|torque / {most} / (1 - {droop})|^{exponent}·sign(torque)")
    }
}

impl JointLaw for TorqueSaturation {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        // Beyond a knee the droop grows with the torque.
        let bent = |p: f64| vec![p];
        let beyond = |knee: f64| vec![2.0, knee];
        vec![bent(2.0), beyond(0.35), beyond(0.5), bent(3.0), beyond(0.65), beyond(0.8), bent(5.0)]
    }

    /// Exponents between those of the grid are not told apart.
    fn steps(&self, _: &Scale) -> Vec<Step> {
        vec![Step::Keep, Step::Times(1.15)]
    }

    fn only_positive(&self) -> bool {
        true
    }

    fn looks_at_torque(&self) -> bool {
        true
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = at.torque * bend(shape, (at.torque / scale.torque).abs());
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Smooth
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let last = match shape.get(1) {
            None => Parameter::new("exponent", shape[0], 0.0, "1"),
            Some(&knee) => Parameter::new("knee", knee, 0.0, "1"),
        };
        let [droop, slope] = droop(shape, a[0]);
        vec![
            Parameter::new("droop_at_most_torque", droop, slope * s[0], "1"),
            Parameter::new("most_torque", scale.torque, 0.0, scale.kind.torque_unit()),
            last,
        ]
    }
}

/// Part of a torque that is missing, per amplitude, where the motor gives `given` of the largest recorded torque.
fn bend(shape: &[f64], given: f64) -> f64 {
    match shape.get(1) {
        None => given.powf(shape[0] - 1.0),
        Some(&knee) => ((given - knee).max(0.0) / (1.0 - knee).max(LEAST_BEYOND)).powf(shape[0] - 1.0),
    }
}

/// Halvings of the interval that a droop is in: to the last bit.
const HALVINGS: usize = 53;

/// The part of the largest recorded torque that is missing there, and its derivative with respect to the amplitude.
fn droop(shape: &[f64], amplitude: f64) -> [f64; 2] {
    let missing = |given: f64| given * bend(shape, given);
    // The motor gives x of it where x + a·missing(x) = 1, which grows with x.
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if middle + amplitude * missing(middle) > 1.0 { high = middle } else { low = middle }
    }
    let step = 1e-6;
    let grows = (missing(high + step) - missing(high - step)) / (2.0 * step);
    [1.0 - high, missing(high) / (1.0 + amplitude * grows)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A drive that records more torque than its motor gives, as a function of what it records.
    #[test]
    fn a_droop_is_the_part_of_the_largest_recorded_torque_that_the_motor_does_not_give() {
        for (shape, amplitude) in [(vec![3.0], 0.1), (vec![2.0], 0.3), (vec![2.0, 0.5], 0.25)] {
            let scale = Scale { torque: 40.0, ..Scale::UNIT };
            let told = TorqueSaturation.parameters(&scale, &shape, &[amplitude], &[0.01]);
            let given = (1.0 - told[0].value) * scale.torque;
            let mut law = [0.0];
            TorqueSaturation.law(&scale, &shape, &At { torque: given, ..At::default() }, 0.0, &mut law);
            assert_relative_eq!(given + amplitude * law[0], scale.torque, max_relative = 1e-12);
            let more = TorqueSaturation.parameters(&scale, &shape, &[amplitude + 1e-5], &[0.0]);
            assert_relative_eq!(told[0].sigma, (more[0].value - told[0].value) * 1e3, max_relative = 1e-3);
        }
        assert_eq!(droop(&[3.0], 0.0)[0], 0.0);
    }

    #[test]
    fn the_formula_that_is_told_is_the_law() {
        let scale = Scale { torque: 40.0, ..Scale::UNIT };
        for shape in [vec![3.0], vec![2.0, 0.4]] {
            let ([d, _], mut law) = (droop(&shape, 0.2), [0.0]);
            TorqueSaturation.law(&scale, &shape, &At { torque: -30.0, ..At::default() }, 0.0, &mut law);
            let told = match shape.get(1) {
                None => -d * 40.0 * (30.0 / 40.0 / (1.0 - d)).powf(shape[0]),
                Some(knee) => d * -30.0 * (30.0 / 40.0 - knee) / ((1.0 - d) * (1.0 - d - knee)),
            };
            assert_relative_eq!(0.2 * law[0], told, max_relative = 1e-9);
        }
    }
}
