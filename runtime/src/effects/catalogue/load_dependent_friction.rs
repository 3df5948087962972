//! Coulomb friction that grows with the transmitted torque: mu·|load|·sign v.

use crate::effects::closed_form::number;
use crate::effects::gear_load::{self, GearLoad};
use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "load_dependent_friction",
    name: "load-dependent friction",
    what: "The friction level grows with the torque that the joint transmits: gear teeth and bearings are pressed harder.",
    looks_like: "a residual with the sign of the speed whose size follows the load torque",
    revealed_by: "load torque",
    experiment: "the same strokes at low speed with the arm stretched out and folded, or with and without a payload",
    source: "Gogoussis and Donath 1988; Hamon, Gautier and Garrec 2011",
    symbols: &[
        ("mu", "coefficient of friction"),
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
    special_case: None,
    abscissa: Abscissa::Load,
    along_motion: true,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct LoadDependentFriction;

impl Effect for LoadDependentFriction {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&LoadDependentFriction)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("friction grows by {} of {}", q.text("mu"), GearLoad::words(q))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("{}·|{}|·sign(dq)", q.value("mu"), GearLoad::symbol(q))
    }
}

impl JointLaw for LoadDependentFriction {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        gear_load::shapes(scale)
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        gear_load::steps()
    }

    fn only_positive(&self) -> bool {
        true
    }

    fn needs_gravity(&self, shape: &[f64]) -> bool {
        GearLoad::of(shape).needs_gravity()
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let losses = GearLoad::of(shape).losses(scale, at);
        out[0] = (losses.driving + losses.driven) * at.sign;
    }

    /// The load without the rotor, that of gravity alone and that with fast torques are no variables of the language.
    fn closed_form(&self, _: &Scale, shape: &[f64], amplitude: &[f64], j: usize) -> Option<String> {
        GearLoad::of(shape).is_plain().then(|| {
            format!("{}*abs(load{j})*sign(dq{j})", number(amplitude.first().copied().unwrap_or(0.0)))
        })
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Dry
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let mu = Parameter::new("mu", a[0], s[0], "1");
        std::iter::once(mu).chain(GearLoad::of(shape).parameters(scale)).collect()
    }
}
