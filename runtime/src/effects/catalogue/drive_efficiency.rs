//! Losses of a drive in proportion to the power that it transmits, different by its direction.
//!
//! A gear of efficiency eta asks the motor for load / eta where it drives the load, and gives it load·eta' where the load
//! drives it. Coulomb friction that grows with the load is the case of equal losses, a wrong torque constant that of
//! opposite ones; only what neither of them explains is this.

use crate::effects::gear_load::{self, GearLoad};
use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, SpecialCase, Step, ToldBy, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "drive_efficiency",
    name: "drive efficiency",
    what: "The drive loses a part of the power that it transmits, and not the same part when it drives the load as when the load drives it.",
    looks_like: "a residual proportional to the load torque, with one factor where torque and speed agree and another where they oppose",
    revealed_by: "load torque",
    experiment: "lifting and lowering the outstretched arm at low speed, with and without a payload",
    source: "Giberti, Cinquemani and Legnani 2010; Hamon, Gautier and Garrec 2011",
    symbols: &[
        ("efficiency_driving", "part of the power that arrives where the motor drives the load"),
        ("efficiency_driven", "part of the power that arrives where the load drives the motor"),
        ("load", "torque of inertia and gravity on the joint"),
        ("gravity", "torque of gravity alone"),
        ("link load", "load without that of the rotor's inertia"),
        ("load_of_gravity_alone", "there where the load is that of gravity alone"),
        ("load_without_rotor", "there where the load is that of the links alone"),
        (
            "rotor_inertia",
            "inertia of the rotor that the link load is without, where the robot has no parameter for it",
        ),
        ("fast_torque", "standard deviation of the torques in the gear that are faster than the signals"),
        ("fast", "those torques: the mean over all that they may be counts"),
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
        effects: &[
            &super::load_dependent_friction::LoadDependentFriction,
            &super::torque_constant_error::TorqueConstantError,
        ],
        told_by: ToldBy::Certainty,
    }),
    abscissa: Abscissa::Load,
    along_motion: true,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct DriveEfficiency;

impl Effect for DriveEfficiency {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&DriveEfficiency)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!(
            "its efficiency is {} where it drives {} and {} where that drives it",
            q.text("efficiency_driving"),
            GearLoad::words(q),
            q.text("efficiency_driven")
        )
    }

    fn formula(&self, q: &Quantities) -> String {
        let load = GearLoad::symbol(q);
        format!(
            "(1 / {} - 1)·{load} where {load}·dq > 0, ({} - 1)·{load} where {load}·dq < 0",
            q.value("efficiency_driving"),
            q.value("efficiency_driven")
        )
    }
}

impl JointLaw for DriveEfficiency {
    /// What is lost when driving, and when driven, in parts of the load.
    fn amplitudes(&self, _: &[f64]) -> usize {
        2
    }

    /// A rotor is in front of the gear: its inertia is no load of it.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        gear_load::shapes_behind_the_rotor(scale)
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        gear_load::steps()
    }

    /// A drive that gains power is something else.
    fn only_positive(&self) -> bool {
        true
    }

    fn needs_gravity(&self, shape: &[f64]) -> bool {
        GearLoad::of(shape).needs_gravity()
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let losses = GearLoad::of(shape).losses(scale, at);
        out[0] = losses.driving * at.sign;
        out[1] = losses.driven * at.sign;
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Dry
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let driving = 1.0 / (1.0 + a[0]);
        let mut list = vec![
            Parameter::new("efficiency_driving", driving, s[0] * driving * driving, "1"),
            Parameter::new("efficiency_driven", 1.0 - a[1], s[1], "1"),
        ];
        list.extend(GearLoad::of(shape).parameters(scale));
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_losses_are_friction_that_grows_with_the_load() {
        for (load, sign) in [(3.0, 1.0), (3.0, -1.0), (-2.0, 1.0), (-2.0, -1.0)] {
            let at = At { link: load, sign, ..At::default() };
            let (mut own, mut friction) = ([0.0; 2], [0.0]);
            DriveEfficiency.law(&Scale::UNIT, &[1.0], &at, 0.0, &mut own);
            let simpler = super::super::load_dependent_friction::LoadDependentFriction;
            simpler.law(&Scale::UNIT, &[1.0], &at, 0.0, &mut friction);
            assert_eq!(own[0] + own[1], friction[0]);
            assert_eq!((own[0] - own[1]).abs(), load.abs(), "opposite ones are a factor on the load");
        }
    }
}
