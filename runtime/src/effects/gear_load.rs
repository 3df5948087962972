//! The load that losses in a gear are proportional to.
//!
//! Where the inertia of the rotor is a part of that of the link, as on the first joint of every robot, motion does not tell
//! which part of the load passes through the gear: there that inertia is a number of the law.
//!
//! Teeth and bearings are pressed by what passes through them. A rotor in front of the gear does not press them; where
//! the pressing has a slow part only, as by a preload that follows the weight, gravity alone counts (Hamon, Gautier and
//! Garrec 2011 compare the quasi-static load with the full one).
//!
//! What the motor does faster than the signals that a law is evaluated on, as where a controller answers to the noise of
//! its encoders, may pass through the teeth, too. It has no mean, but its size has: where the slow load passes through
//! zero, teeth are pressed nevertheless. With fast torques of normal distribution the expected losses are those of the
//! folded normal distribution (Leone, Nelson and Nottingham 1961). How large they are a recording does not tell: drives
//! report the mean of their current over a while, which is steadier than the current, and sensors add noise that is none.

use super::joint_law::{At, Scale};
use super::quantity::{Parameter, Quantities};
use super::shape::Step;
use crate::model::ParameterKind;
use statrs::function::erf::erf;

/// Which load counts.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    /// Gravity alone.
    Gravity,
    /// Inertia and gravity, the rotor's inertia included.
    Whole,
    /// Inertia and gravity of the links.
    Links,
    /// The whole load but for that of a rotor whose inertia is no parameter of its own, kg.m2 or kg.
    Behind(f64),
}

/// What a loss is proportional to. The shape of a law has no number for the whole load, one for a part of it, a second one where
/// fast torques count, and a third one for the inertia of a rotor, behind a second one of zero where they do not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GearLoad {
    part: Part,
    /// Standard deviation of the fast torques that pass through the gear, in that of those that were recorded.
    fast: Option<f64>,
}

/// Expected losses at an instant, N.m or N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Losses {
    /// Mean of the load while it is driven, times the direction of motion.
    pub driving: f64,
    /// Mean of the load while it drives, against the direction of motion.
    pub driven: f64,
}

/// First numbers of shapes, by which saved models tell the loads apart.
const GRAVITY: f64 = 0.0;
const LINKS: f64 = 1.0;
const WHOLE_AND_FAST: f64 = 2.0;
const LINKS_AND_FAST: f64 = 3.0;
const BEHIND: f64 = 4.0;

/// Inertias of a rotor to try, in parts of the least that its joint moves, and the factor by which the search varies them.
const ROTORS: [f64; 3] = [0.25, 0.45, 0.8];
const ROTOR_STEP: f64 = 1.3;

/// Sizes of fast torques to try, and the factor by which the search varies them: a drive that reports the mean of what it
/// has had over two control periods hides half of the noise of a differentiated position.
const FAST: [f64; 2] = [1.0, 2.5];
const FAST_STEP: f64 = 1.6;

/// Shapes to try on a joint, the usual load in the middle: those with fast torques where it has some.
pub(super) fn shapes(scale: &Scale) -> Vec<Vec<f64>> {
    let mut shapes = vec![vec![GRAVITY], Vec::new(), vec![LINKS]];
    if scale.fast > 0.0 {
        shapes.extend(
            [WHOLE_AND_FAST, LINKS_AND_FAST].iter().flat_map(|part| FAST.map(|fast| vec![*part, fast])),
        );
    }
    if scale.inertia > 0.0 {
        let fast = if scale.fast > 0.0 { &[0.0, FAST[0]][..] } else { &[0.0] };
        let behind = |fast: &f64| ROTORS.map(|part| vec![BEHIND, *fast, part * scale.inertia]);
        shapes.extend(fast.iter().flat_map(behind));
    }
    shapes
}

/// The same without the loads that count the rotor's inertia.
pub(super) fn shapes_behind_the_rotor(scale: &Scale) -> Vec<Vec<f64>> {
    let behind = |shape: &Vec<f64>| GearLoad::of(shape).part != Part::Whole;
    shapes(scale).into_iter().filter(behind).collect()
}

/// How the numbers of a shape are varied.
pub(super) fn steps() -> Vec<Step> {
    vec![Step::Keep, Step::Times(FAST_STEP), Step::Times(ROTOR_STEP)]
}

impl GearLoad {
    /// The load that a shape means.
    pub(super) fn of(shape: &[f64]) -> Self {
        let part = match shape.first() {
            None => Part::Whole,
            Some(x) if *x < 0.5 * (GRAVITY + LINKS) => Part::Gravity,
            Some(x) if *x < 0.5 * (LINKS + WHOLE_AND_FAST) => Part::Links,
            Some(x) if *x < 0.5 * (WHOLE_AND_FAST + LINKS_AND_FAST) => Part::Whole,
            Some(x) if *x < 0.5 * (LINKS_AND_FAST + BEHIND) => Part::Links,
            Some(_) => Part::Behind(shape.get(2).copied().unwrap_or(0.0)),
        };
        Self { part, fast: shape.get(1).copied().filter(|fast| *fast > 0.0) }
    }

    /// Whether it takes gravity to tell it from others.
    pub(super) fn needs_gravity(self) -> bool {
        self.part == Part::Gravity
    }

    /// Whether it is inertia and gravity as they are, without fast torques.
    pub(super) fn is_plain(self) -> bool {
        self.part == Part::Whole && self.fast.is_none()
    }

    /// What a gear that loses a part of it loses at an instant.
    pub(super) fn losses(self, scale: &Scale, at: &At) -> Losses {
        let load = at.sign
            * match self.part {
                Part::Gravity => at.gravity,
                Part::Whole => at.load,
                Part::Links => at.link,
                Part::Behind(rotor) => at.load - rotor * at.ddq,
            };
        let fast = self.fast.unwrap_or(0.0) * scale.fast;
        if fast <= 0.0 {
            return Losses { driving: load.max(0.0), driven: (-load).max(0.0) };
        }
        let z = load / fast;
        let above = 0.5 * (1.0 + erf(z * std::f64::consts::FRAC_1_SQRT_2));
        let density = fast * (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
        Losses { driving: load * above + density, driven: density - load * (1.0 - above) }
    }

    const GRAVITY: &'static str = "load_of_gravity_alone";
    const LINKS: &'static str = "load_without_rotor";
    const ROTOR: &'static str = "rotor_inertia";
    const FAST: &'static str = "fast_torque";

    /// The quantities that say which load it is, where it is not the whole without fast torques.
    pub(super) fn parameters(self, scale: &Scale) -> Vec<Parameter> {
        let part = match self.part {
            Part::Whole => None,
            Part::Gravity => Some((Self::GRAVITY, 1.0, "1")),
            Part::Links => Some((Self::LINKS, 1.0, "1")),
            Part::Behind(rotor) => Some((Self::ROTOR, rotor, ParameterKind::Ia.unit(scale.kind))),
        };
        let unit = scale.kind.torque_unit();
        let fast = self.fast.map(|times| Parameter::new(Self::FAST, times * scale.fast, 0.0, unit));
        part.map(|(name, value, unit)| Parameter::new(name, value, 0.0, unit))
            .into_iter()
            .chain(fast)
            .collect()
    }

    /// The load that quantities tell of, and whether with fast torques.
    fn told(q: &Quantities) -> (Part, bool) {
        let part = if q.has(Self::GRAVITY) {
            Part::Gravity
        } else if q.has(Self::LINKS) {
            Part::Links
        } else if let Some(rotor) = q.number(Self::ROTOR) {
            Part::Behind(rotor)
        } else {
            Part::Whole
        };
        (part, q.has(Self::FAST))
    }

    /// What a person calls the load that quantities tell of.
    pub(super) fn words(q: &Quantities) -> String {
        let (part, fast) = Self::told(q);
        let load = match part {
            Part::Gravity => return "the torque of gravity alone".to_owned(),
            Part::Whole => "the load torque".to_owned(),
            Part::Links => "the load torque without the rotor's inertia".to_owned(),
            Part::Behind(_) => format!("the load torque without a rotor of {}", q.text(Self::ROTOR)),
        };
        load + if fast { ", with what the motor does faster than the signals" } else { "" }
    }

    /// Its name in a formula.
    pub(super) fn symbol(q: &Quantities) -> &'static str {
        match Self::told(q) {
            (Part::Gravity, _) => "gravity",
            (Part::Whole, false) => "load",
            (Part::Whole, true) => "load + fast",
            (Part::Links | Part::Behind(_), false) => "link load",
            (Part::Links | Part::Behind(_), true) => "link load + fast",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale() -> Scale {
        Scale { fast: 0.75, inertia: 2.0, ..Scale::UNIT }
    }

    #[test]
    fn every_shape_is_told_as_the_load_that_it_means() {
        for shape in shapes(&scale()) {
            let load = GearLoad::of(&shape);
            let told = GearLoad::told(&Quantities::new(load.parameters(&scale())));
            assert_eq!(told, (load.part, load.fast.is_some()));
        }
        let at = At { load: 3.0, link: 2.0, gravity: 1.0, sign: 1.0, ..At::default() };
        let plain = shapes(&Scale::UNIT);
        let values: Vec<f64> =
            plain.iter().map(|s| GearLoad::of(s).losses(&Scale::UNIT, &at).driving).collect();
        assert_eq!(values, [1.0, 3.0, 2.0], "none with fast torques where there are none");
        let at = At { ddq: 4.0, ..at };
        let behind = |shape: &[f64]| GearLoad::of(shape).losses(&Scale::UNIT, &at).driving;
        assert_eq!(behind(&[BEHIND, 0.0, 0.25]), 2.0, "a rotor of 0.25 kg.m2 takes 1 N.m of 3");
    }

    #[test]
    fn fast_torques_press_as_the_mean_of_all_that_they_may_be() {
        let load = GearLoad::of(&[2.0, 2.0]);
        for slow in [-4.0, -0.3, 0.0, 1.0, 20.0] {
            let at = At { load: slow, sign: 1.0, ..At::default() };
            let found = load.losses(&scale(), &at);
            // The mean over a normal distribution, by the midpoint rule.
            let (mut driving, mut driven, step) = (0.0, 0.0, 1e-3);
            for k in -10_000..10_000 {
                let z = (f64::from(k) + 0.5) * step;
                let weight = step * (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt();
                let torque: f64 = slow + 1.5 * z;
                driving += weight * torque.max(0.0);
                driven += weight * (-torque).max(0.0);
            }
            assert!((found.driving - driving).abs() < 1e-6, "{slow}: {found:?} {driving}");
            assert!((found.driven - driven).abs() < 1e-6, "{slow}: {found:?} {driven}");
        }
    }
}
