//! Friction that differs between two recordings by a factor.

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "friction_level_change",
    name: "friction level change",
    what: "Friction has changed since the baseline while inertias have not: other temperature, other lubricant, wear.",
    looks_like: "a residual proportional to the friction of the baseline",
    revealed_by: "friction torque of the baseline",
    experiment: "repeat the baseline motion at the same temperature",
    source: "Bittencourt and Gunnarsson 2012",
    symbols: &[
        ("factor", "friction now, in multiples of that of the baseline"),
        ("viscous_change", "change of the viscous friction"),
        ("coulomb_change", "change of the Coulomb friction"),
        ("Fv", "viscous friction of the baseline"),
        ("Fc", "Coulomb friction of the baseline"),
    ],
    put_in: "the law as a torque of the joint",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::OnlyAgainstBaseline,
    follows_parameters: true,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::ModelTorque,
    along_motion: false,
    may_stand: false,
    is_factor: false,
};

/// The effect.
pub(super) struct FrictionLevelChange;

impl Effect for FrictionLevelChange {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&FrictionLevelChange)
    }

    fn detail(&self, q: &Quantities) -> String {
        if !q.has("viscous_change") {
            return format!("friction is {} times that of the baseline", q.text("factor"));
        }
        format!(
            "viscous friction has changed by {} and Coulomb friction by {}: at half of the top speed friction is {} times that \
             of the baseline",
            q.text("viscous_change"),
            q.text("coulomb_change"),
            q.text("factor")
        )
    }

    fn formula(&self, q: &Quantities) -> String {
        if !q.has("viscous_change") {
            return format!("({} - 1)·(Fv·dq + Fc·sign(dq))", q.value("factor"));
        }
        format!("{}·dq + {}·sign(dq)", q.value("viscous_change"), q.value("coulomb_change"))
    }
}

/// Without a shape, one factor on the friction of the baseline; with the baseline's viscous and Coulomb coefficients as
/// shape, the change of each of them.
impl JointLaw for FrictionLevelChange {
    fn amplitudes(&self, shape: &[f64]) -> usize {
        if shape.len() == 2 { 2 } else { 1 }
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        // The search takes the baseline's own coefficients for these.
        vec![vec![], vec![1.0, 1.0]]
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        Vec::new()
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn law(&self, _: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        if let ([_, _], [viscous, coulomb]) = (shape, &mut *out) {
            (*viscous, *coulomb) = (at.dq, at.sign);
        } else {
            out[0] = at.friction;
        }
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Dry
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let (&[viscous, coulomb], [by_speed, level], [by_speed_sigma, level_sigma]) = (shape, a, s) else {
            return vec![Parameter::new("factor", 1.0 + a[0], s[0], "1")];
        };
        // The factor is that of the friction at half of the joint's top speed.
        let speed = 0.5 * scale.speed;
        let whole = (viscous * speed + coulomb).abs().max(1e-12);
        let factor = 1.0 + (by_speed * speed + level) / whole;
        let factor_sigma = (by_speed_sigma * speed).hypot(*level_sigma) / whole;
        let per_speed = scale.kind.viscous_unit();
        vec![
            Parameter::new("factor", factor, factor_sigma, "1"),
            Parameter::new("viscous_change", *by_speed, *by_speed_sigma, per_speed),
            Parameter::new("coulomb_change", *level, *level_sigma, scale.kind.torque_unit()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_of_both_coefficients_has_the_factor_of_the_friction_at_half_speed() {
        let scale = Scale { speed: 2.0, ..Scale::UNIT };
        let shape = [3.0, 1.0];
        assert_eq!(FrictionLevelChange.amplitudes(&shape), 2);
        let found = FrictionLevelChange.parameters(&scale, &shape, &[1.0, -0.2], &[0.0, 0.1]);
        assert!((found[0].value - 1.2).abs() < 1e-12);
        assert!((found[0].sigma - 0.025).abs() < 1e-12);
        assert_eq!((found[1].value, found[2].value), (1.0, -0.2));
        let mut out = [0.0; 2];
        let at = At { dq: -1.5, sign: -1.0, friction: 9.0, ..At::default() };
        FrictionLevelChange.law(&scale, &shape, &at, 0.0, &mut out);
        assert_eq!(out, [-1.5, -1.0]);
    }
}
