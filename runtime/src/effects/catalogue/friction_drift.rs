//! Friction that changes with time as the joint warms up: (viscous, Coulomb)·exp(-t/tau).

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, SpecialCase, Step, ToldBy, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "friction_drift",
    name: "friction drift",
    what: "Friction changes in the course of the motion: the joint warms up and its lubricant thins.",
    looks_like: "a residual proportional to friction that fades with time in every motion",
    revealed_by: "time",
    experiment: "the same motion repeated for several minutes from a cold start",
    source: "Bittencourt et al. 2010; Simoni et al. 2015",
    symbols: &[
        ("viscous", "viscous friction that fades"),
        ("coulomb", "Coulomb friction that fades"),
        ("tau", "time constant"),
        ("t", "time since the motion began"),
    ],
    put_in: "the law as a torque of the joint",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: false,
    repeats: false,
    special_case: Some(SpecialCase {
        effects: &[&super::friction_level_change::FrictionLevelChange],
        told_by: ToldBy::Gain(0.9),
    }),
    abscissa: Abscissa::Time,
    along_motion: true,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct FrictionDrift;

impl Effect for FrictionDrift {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&FrictionDrift)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("friction fades with a time constant of {}", q.text("tau"))
    }

    fn formula(&self, q: &Quantities) -> String {
        let viscous = q.has("viscous").then(|| format!("{}·dq", q.value("viscous")));
        let coulomb = q.has("coulomb").then(|| format!("{}·sign(dq)", q.value("coulomb")));
        let parts: Vec<String> = viscous.into_iter().chain(coulomb).collect();
        format!("({})·exp(-t / {})", parts.join(" + "), q.value("tau"))
    }
}

impl JointLaw for FrictionDrift {
    /// The first shape parameter says what drifts: 0 viscous, 1 Coulomb, 2 both.
    fn amplitudes(&self, shape: &[f64]) -> usize {
        if shape[0] > 1.5 { 2 } else { 1 }
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let times = [0.05, 0.1, 0.2, 0.4, 0.8, 1.5, 4.0];
        [0.0, 1.0, 2.0]
            .iter()
            .flat_map(|&what| times.iter().map(move |t| vec![what, t * scale.duration]))
            .collect()
    }

    /// What drifts is one of three forms.
    fn steps(&self, _: &Scale) -> Vec<Step> {
        vec![Step::Keep, Step::Times(1.6)]
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let faded = (-scale.age(at.time) / shape[1]).exp();
        let viscous = at.dq / scale.speed * faded;
        let coulomb = at.sign * faded;
        if shape[0] < 0.5 {
            out[0] = viscous;
        } else if shape[0] < 1.5 {
            out[0] = coulomb;
        } else {
            out[0] = viscous;
            out[1] = coulomb;
        }
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Dry
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let unit = scale.kind.viscous_unit();
        let mut out = Vec::new();
        if shape[0] < 0.5 || shape[0] > 1.5 {
            out.push(Parameter::new("viscous", a[0] / scale.speed, s[0] / scale.speed, unit));
        }
        if shape[0] > 0.5 {
            let last = a.len() - 1;
            out.push(Parameter::new("coulomb", a[last], s[last], scale.kind.torque_unit()));
        }
        out.push(Parameter::new("tau", shape[1], 0.0, "s"));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_fades_from_the_beginning_of_the_motion_on_and_is_what_it_was_then_before() {
        let scale = Scale { start: 10.0, ..Scale::UNIT };
        let coulomb = |time: f64| {
            let mut out = [0.0];
            let at = At {
                time,
                q: 0.0,
                dq: 1.0,
                ddq: 0.0,
                sign: 1.0,
                load: 0.0,
                link: 0.0,
                gravity: 0.0,
                torque: 0.0,
                friction: 0.0,
            };
            FrictionDrift.law(&scale, &[1.0, 2.0], &at, 0.0, &mut out);
            out[0]
        };
        assert_eq!((coulomb(10.0), coulomb(3.0)), (1.0, 1.0));
        assert!((coulomb(12.0) - (-1.0_f64).exp()).abs() < 1e-12);
    }
}
