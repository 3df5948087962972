//! Friction that changes as the joint warms up: (viscous, Coulomb)·exp(-t/tau), or one of the two times a temperature T that
//! its motion raises, tau·dT/dt = |dq|/speed - T.
//!
//! The first is the second where the joint moves as fast all the time. Coulomb friction makes heat in proportion to the speed,
//! and it flows off to the surroundings in proportion to the temperature (Bittencourt et al. 2010 for friction over it).

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Moved, Parameter, Properties, Quantities, Scale,
    SmoothingWindow, Sought, SpecialCase, Step, ToldBy, Words,
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
        (
            "T",
            "temperature that the motion raises, tau·dT/dt = abs(dq)/speed - T: 0 at its start, 1 after long at speed",
        ),
        ("speed", "speed at which T becomes 1"),
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
        if q.has("speed") {
            format!(
                "friction follows a temperature that motion raises, with a time constant of {}",
                q.text("tau")
            )
        } else {
            format!("friction fades with a time constant of {}", q.text("tau"))
        }
    }

    fn formula(&self, q: &Quantities) -> String {
        let viscous = q.has("viscous").then(|| format!("{}·dq", q.value("viscous")));
        let coulomb = q.has("coulomb").then(|| format!("{}·sign(dq)", q.value("coulomb")));
        let parts: Vec<String> = viscous.into_iter().chain(coulomb).collect();
        let friction = parts.join(" + ");
        if q.has("speed") {
            format!("({friction})·T")
        } else {
            format!("({friction})·exp(-t / {})", q.value("tau"))
        }
    }
}

/// The law of a shape.
struct Kind {
    viscous: bool,
    coulomb: bool,
    /// Whether it follows a temperature, or time alone.
    is_heated: bool,
}

impl Kind {
    /// The first number of a shape: 0 viscous, 1 Coulomb, 2 both over time; 3 viscous, 4 Coulomb over a temperature.
    fn of(shape: &[f64]) -> Self {
        let is_heated = shape[0] > 2.5;
        let part = if is_heated { shape[0] - 3.0 } else { shape[0] };
        Self { viscous: !(0.5..1.5).contains(&part), coulomb: part > 0.5, is_heated }
    }
}

impl JointLaw for FrictionDrift {
    fn amplitudes(&self, shape: &[f64]) -> usize {
        let kind = Kind::of(shape);
        usize::from(kind.viscous) + usize::from(kind.coulomb)
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let of_time = [0.05, 0.1, 0.2, 0.4, 0.8, 1.5, 4.0];
        // What warms up stores heat: a temperature that follows single strokes, or is what it will be after a tenth of the
        // motion, is a memory of the speed and no drift. The search goes one step below the first of these.
        let of_heat = [0.16, 0.25, 0.4, 0.8, 1.5, 4.0];
        let stroke = scale.range / scale.speed;
        let shape = |kind: f64, part: &f64| vec![kind, part * scale.duration];
        let over_time =
            [0.0, 1.0, 2.0].into_iter().flat_map(|kind| of_time.iter().map(move |t| shape(kind, t)));
        let heated = [3.0, 4.0].into_iter().flat_map(|kind| of_heat.iter().map(move |t| shape(kind, t)));
        over_time.chain(heated.filter(|shape| shape[1] >= stroke)).collect()
    }

    /// What drifts with what is one of five forms.
    fn steps(&self, _: &Scale) -> Vec<Step> {
        vec![Step::Keep, Step::Times(1.6)]
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, memory: f64, out: &mut [f64]) {
        let kind = Kind::of(shape);
        let factor = if kind.is_heated { memory } else { (-scale.age(at.time) / shape[1]).exp() };
        let parts = [(kind.viscous, at.dq / scale.speed), (kind.coulomb, at.sign)];
        let there = parts.into_iter().filter(|(is_part, _)| *is_part);
        out.iter_mut().zip(there).for_each(|(out, (_, friction))| *out = friction * factor);
    }

    fn has_memory(&self) -> bool {
        true
    }

    /// The temperature, exactly for a speed that stays what it is in the step.
    fn advance(&self, scale: &Scale, shape: &[f64], memory: f64, moved: Moved) -> f64 {
        if !Kind::of(shape).is_heated || moved.step <= 0.0 {
            return memory;
        }
        let toward = moved.travel.abs() / (moved.step * scale.speed);
        toward + (memory - toward) * (-moved.step / shape[1]).exp()
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Dry
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let (kind, unit) = (Kind::of(shape), scale.kind.viscous_unit());
        let mut out = Vec::new();
        if kind.viscous {
            out.push(Parameter::new("viscous", a[0] / scale.speed, s[0] / scale.speed, unit));
        }
        if kind.coulomb {
            let last = a.len() - 1;
            out.push(Parameter::new("coulomb", a[last], s[last], scale.kind.torque_unit()));
        }
        if kind.is_heated {
            out.push(Parameter::new("speed", scale.speed, 0.0, scale.kind.speed_unit()));
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
            let at = At { time, dq: 1.0, sign: 1.0, ..At::default() };
            FrictionDrift.law(&scale, &[1.0, 2.0], &at, 0.0, &mut out);
            out[0]
        };
        assert_eq!((coulomb(10.0), coulomb(3.0)), (1.0, 1.0));
        assert!((coulomb(12.0) - (-1.0_f64).exp()).abs() < 1e-12);
    }

    #[test]
    fn no_temperature_follows_a_single_stroke() {
        let scale = Scale { duration: 20.0, range: 3.0, ..Scale::UNIT };
        let shapes = FrictionDrift.shapes(&scale);
        let heated: Vec<f64> = shapes.iter().filter(|s| Kind::of(s).is_heated).map(|s| s[1]).collect();
        assert_eq!(heated.len(), 12);
        assert!(heated.iter().all(|tau| *tau > 3.0), "{heated:?}");
        let slow = FrictionDrift.shapes(&Scale { range: 10.0, ..scale });
        assert_eq!(slow.iter().filter(|s| Kind::of(s).is_heated).count(), 6);
    }

    #[test]
    fn a_temperature_rises_with_the_motion_and_falls_at_rest() {
        let after = |speed: f64, seconds: f64, from: f64| {
            let steps = 100;
            let step = seconds / f64::from(steps);
            (0..steps).fold(from, |memory, _| {
                FrictionDrift.advance(
                    &Scale::UNIT,
                    &[4.0, 2.0],
                    memory,
                    Moved { travel: -speed * step, step },
                )
            })
        };
        assert!((after(1.0, 2.0, 0.0) - (1.0 - (-1.0_f64).exp())).abs() < 1e-12, "as fast all the time");
        assert!((after(0.0, 2.0, 1.0) - (-1.0_f64).exp()).abs() < 1e-12, "at rest");
        assert!((after(0.5, 100.0, 0.0) - 0.5).abs() < 1e-12);
        let warm = |kind: f64| {
            let mut out = [0.0];
            let at = At { dq: -0.5, sign: -1.0, ..At::default() };
            FrictionDrift.law(&Scale::UNIT, &[kind, 2.0], &at, 0.25, &mut out);
            out[0]
        };
        assert_eq!((warm(3.0), warm(4.0)), (-0.125, -0.25));
    }
}
