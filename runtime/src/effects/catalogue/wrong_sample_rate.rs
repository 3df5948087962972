//! A declared time base that is wrong: the derivative of the model with respect to the scale of time.

use crate::effects::{
    Abscissa, Distortion, Effect, Form, Parameter, Properties, Quantities, Seeds, Sensitivity,
    SmoothingWindow, Sought, Variant, Words,
};
use crate::model::Robot;

/// What a person is told.
const WORDS: Words = Words {
    id: "wrong_sample_rate",
    name: "wrong sample rate",
    what: "The time base is wrong: speeds and accelerations are off by a factor and its square while gravity is not.",
    looks_like: "inertia and gravity torques that do not agree on one scale of time",
    revealed_by: "acceleration",
    experiment: "slow and fast runs of one path; a stopwatch",
    source: "Khalil and Dombre 2002",
    symbols: &[("rate_error", "real sampling rate over the declared one, less 1")],
    put_in: "another `rate` in the recording YAML",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: false,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::Acceleration,
    along_motion: false,
    may_stand: false,
    is_factor: false,
};

/// The effect.
pub(super) struct WrongSampleRate;

impl Effect for WrongSampleRate {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Sensitivity(&WrongSampleRate)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("the true sampling rate differs by a fraction of {}", q.text("rate_error"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("dq·(1 + {0}), ddq·(1 + {0})²", q.value("rate_error"))
    }
}

impl Sensitivity for WrongSampleRate {
    fn variants(&self, _: &Robot) -> Vec<Variant> {
        vec![Variant { joint: None, index: 0, name: "rate_error", unit: "1" }]
    }

    fn together(&self) -> bool {
        false
    }

    fn in_recording(&self, amplitude: &[f64]) -> Option<Distortion> {
        amplitude.first().map(|a| Distortion::Faster(a.exp()))
    }

    /// The true rate is (1 + e) times the declared one: dq (1 + e), ddq (1 + e)².
    fn seed(&self, _: &Variant, seeds: &mut Seeds<'_>) {
        for j in 0..seeds.q.len() {
            seeds.dq[j].slope = seeds.dq[j].value;
            seeds.ddq[j].slope = 2.0 * seeds.ddq[j].value;
        }
    }

    /// Along the way to it a factor grows exponentially.
    fn quantity(&self, variant: &Variant, amplitude: f64, sigma: f64) -> Parameter {
        Parameter::new(variant.name, amplitude.exp_m1(), sigma * amplitude.exp(), variant.unit)
    }
}
