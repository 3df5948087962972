//! Torque and position channels that are not simultaneous: the derivative of the model with respect to time.

use crate::effects::{
    Abscissa, Distortion, Effect, Form, Properties, Quantities, Seeds, Sensitivity, SmoothingWindow, Sought,
    Variant, Words,
};
use crate::model::Robot;

/// What a person is told.
const WORDS: Words = Words {
    id: "time_delay",
    name: "time delay",
    what: "Torque and position were not recorded at the same instant.",
    looks_like: "a residual proportional to the rate of change of the torque, on every joint",
    revealed_by: "rate of change of the torque",
    experiment: "any fast motion; compare with a tap on the arm seen in both channels",
    source: "Janot, Vandanjon and Gautier 2014",
    symbols: &[("delay", "by how much the torque channel is later than the positions")],
    put_in: "a torque channel that is written later than the positions",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Separately,
    follows_parameters: false,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::Position,
    along_motion: false,
    may_stand: false,
    is_factor: false,
};

/// The effect.
pub(super) struct TimeDelay;

impl Effect for TimeDelay {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Sensitivity(&TimeDelay)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("torques were recorded {} after the positions", q.text("delay"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("torque(t) was recorded at t {}", q.added("delay"))
    }
}

impl Sensitivity for TimeDelay {
    fn variants(&self, _: &Robot) -> Vec<Variant> {
        vec![Variant { joint: None, index: 0, name: "delay", unit: "s" }]
    }

    fn together(&self) -> bool {
        false
    }

    fn in_recording(&self, _: &[f64]) -> Option<Distortion> {
        Some(Distortion::Skew)
    }

    /// torque(t - delay) = torque(t) - delay · d torque / dt.
    fn seed(&self, _: &Variant, seeds: &mut Seeds<'_>) {
        for j in 0..seeds.q.len() {
            seeds.q[j].slope = -seeds.dq[j].value;
            seeds.dq[j].slope = -seeds.ddq[j].value;
            seeds.ddq[j].slope = -seeds.jerk[j];
        }
    }
}
