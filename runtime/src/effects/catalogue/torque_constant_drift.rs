//! A torque constant that fades as a motor warms up: the recorded torque grows by a factor that changes with time.
//!
//! Magnets and windings follow their temperature, which approaches its end as 1 - exp(-t / T); where T is longer than the
//! recording, that is a line. A constant that is wrong from the start does not change, and friction that changes with time
//! leaves what inertia and gravity ask for as it is: only what neither of them explains is this.

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, SpecialCase, Step, ToldBy, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "torque_constant_drift",
    name: "torque constant drift",
    what: "The factor between recorded and real torque changes in the course of the recording: magnets and windings grow warm.",
    looks_like: "a residual proportional to the whole torque, gravity and inertia too, that grows or fades with time",
    revealed_by: "time",
    experiment: "the same motion repeated from a cold start until the motors are warm, with the arm stretched out",
    source: "Krishnan 2010 on magnets that weaken with temperature",
    symbols: &[
        (
            "factor_at_end",
            "recorded torque at the end for the same real torque, in multiples of that at the start",
        ),
        ("duration", "duration of the recording"),
        ("tau", "time constant"),
    ],
    put_in: "the law as a torque of the joint",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: true,
    repeats: false,
    special_case: Some(SpecialCase {
        effects: &[&super::torque_constant_error::TorqueConstantError, &super::friction_drift::FrictionDrift],
        told_by: ToldBy::Certainty,
    }),
    abscissa: Abscissa::Time,
    along_motion: true,
    may_stand: false,
    is_factor: false,
};

/// Time constants to try, in durations of the recording. With the last one a hundredth is not told from a line.
const TIMES: [f64; 3] = [0.2, 0.7, 20.0];

/// In durations of the recording: what takes longer is told as a line.
const LINE: f64 = 5.0;

/// The effect.
pub(super) struct TorqueConstantDrift;

/// Part of the way to the end of the recording that a change has come, at a time since it began; `shape` is its time constant and the
/// duration of the recording, s.
fn way(shape: &[f64], time: f64) -> f64 {
    let gone = |t: f64| -(-t / shape[0]).exp_m1();
    gone(time) / gone(shape[1])
}

impl Effect for TorqueConstantDrift {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&TorqueConstantDrift)
    }

    fn detail(&self, q: &Quantities) -> String {
        let how = if q.has("tau") {
            format!("with a time constant of {}", q.text("tau"))
        } else {
            "at a constant rate".to_owned()
        };
        format!(
            "after {} the recorded torque is {} times what it was for the same real torque, {how}",
            q.value("duration"),
            q.text("factor_at_end")
        )
    }

    fn formula(&self, q: &Quantities) -> String {
        let (factor, duration) = (q.value("factor_at_end"), q.value("duration"));
        if q.has("tau") {
            let tau = q.value("tau");
            format!("({factor} - 1)·(model torque)·(1 - exp(-t / {tau})) / (1 - exp(-{duration} / {tau}))")
        } else {
            format!("({factor} - 1)·(model torque)·t / {duration}")
        }
    }
}

impl JointLaw for TorqueConstantDrift {
    /// The change at the end of the recording, in parts of the torque.
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let duration = if scale.duration > 0.0 { scale.duration } else { 1.0 };
        TIMES.iter().map(|t| vec![t * duration, duration]).collect()
    }

    /// Motors on one supply and in one room warm up together.
    fn may_be_common(&self) -> bool {
        true
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        vec![Step::Times(1.8), Step::Keep]
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn looks_at_torque(&self) -> bool {
        true
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = at.torque * way(shape, scale.age(at.time));
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Smooth
    }

    fn parameters(&self, _: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let mut list = vec![
            Parameter::new("factor_at_end", 1.0 + a[0], s[0], "1"),
            Parameter::new("duration", shape[1], 0.0, "s"),
        ];
        if shape[0] < LINE * shape[1] {
            list.push(Parameter::new("tau", shape[0], 0.0, "s"));
        }
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_begins_at_nothing_and_ends_at_its_amplitude() {
        for shape in TorqueConstantDrift.shapes(&Scale::UNIT) {
            assert_eq!(way(&shape, 0.0), 0.0);
            assert!((way(&shape, shape[1]) - 1.0).abs() < 1e-12);
        }
        let slow = [20.0, 1.0];
        assert!((way(&slow, 0.5) - 0.5).abs() < 0.01, "what is slower than the recording is a line");
    }
}
