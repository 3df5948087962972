//! Play between motor and link (Nordin and Gutman 2002).

use crate::effects::{
    Abscissa, Compliance, Effect, Form, Properties, Quantities, SmoothingWindow, Sought, SpecialCase, ToldBy,
    Transmission, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "backlash",
    name: "backlash",
    what: "There is play between motor and link: when the load changes its direction the link is free for a moment and then hits the other flank.",
    looks_like: "short bursts in the instants in which the load torque changes its sign, and nowhere else",
    revealed_by: "load torque",
    experiment: "slow reversals of the load at rest, with the motor locked: the free travel of the link is the play",
    source: "Nordin and Gutman 2002",
    symbols: &[
        ("gap", "play, the whole free travel"),
        ("k", "stiffness of the transmission"),
        ("d", "damping of the transmission"),
    ],
    put_in: "a transmission with play between motor and link",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Fast,
    sought: Sought::Always,
    follows_parameters: false,
    repeats: false,
    special_case: Some(SpecialCase {
        effects: &[&super::joint_elasticity::JointElasticity],
        told_by: ToldBy::Gain(0.9),
    }),
    abscissa: Abscissa::Load,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct Backlash;

impl Effect for Backlash {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Compliance(&Backlash)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("there is a play of {}", q.text("gap"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!(
            "{}·x + {}·dx beyond a play of {}, x = motor - link",
            q.value("k"),
            q.value("d"),
            q.value("gap")
        )
    }
}

impl Compliance for Backlash {
    fn shapes(&self) -> Vec<[f64; 4]> {
        let mut shapes = Vec::new();
        for frequency in [12.0, 20.0, 35.0, 55.0] {
            for damping in [0.03, 0.2] {
                for play in [6e-5, 1.2e-4, 2.4e-4, 5e-4, 1e-3, 2e-3, 4e-3] {
                    shapes.push([frequency, damping, 0.3, play]);
                }
            }
        }
        shapes
    }

    fn describe(&self, t: &Transmission) -> Vec<(&'static str, f64, &'static str)> {
        let (p, k, d) = (t.kind.position_unit(), t.kind.stiffness_unit(), t.kind.viscous_unit());
        vec![("gap", t.play, p), ("k", t.stiffness, k), ("d", t.damping, d)]
    }
}
