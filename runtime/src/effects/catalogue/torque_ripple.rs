//! Torque that is periodic in the motor or joint angle: c·cos kq + s·sin kq.

use crate::effects::closed_form::number;
use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "torque_ripple",
    name: "torque ripple",
    what: "The torque pulsates with the angle: cogging, current offsets, gear teeth, a wave generator.",
    looks_like: "a sharp line in the order spectrum over the angle, at the same order whatever the speed",
    revealed_by: "joint position",
    experiment: "slow constant-speed strokes over at least ten periods, at two speeds",
    source: "Gan and Qiu 2004; Holtz and Springob 1996",
    symbols: &[
        ("amplitude", "half of the swing of the torque"),
        ("order", "waves per unit of position, times 2 pi; per joint turn on a revolute joint"),
        ("order_per_motor_turn", "waves per turn of the motor"),
        ("phase", "phase of the wave where q is 0"),
    ],
    put_in: "the law as a torque of the joint",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Fast,
    sought: Sought::Always,
    follows_parameters: false,
    repeats: true,
    special_case: None,
    abscissa: Abscissa::WaveAngle,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct TorqueRipple;

impl Effect for TorqueRipple {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&TorqueRipple)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!(
            "a torque ripple of {} at {} waves per joint turn, that is {} per motor turn",
            q.text("amplitude"),
            q.text("order"),
            q.text("order_per_motor_turn")
        )
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("{}·sin({}·q + {})", q.value("amplitude"), q.value("order"), q.value("phase"))
    }
}

impl JointLaw for TorqueRipple {
    fn amplitudes(&self, shape: &[f64]) -> usize {
        2 * shape.len()
    }

    fn repeats_its_shape(&self) -> bool {
        true
    }

    fn waves(&self, shape: &[f64], amplitude: &[f64]) -> Vec<(f64, f64)> {
        shape.iter().zip(amplitude.chunks_exact(2)).map(|(order, a)| (*order, a[0].hypot(a[1]))).collect()
    }

    /// The orders of a motor turn that cogging, current offsets and wave generators have. A wave must pass four times
    /// in the travel, or it is a spring or gravity by another name.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let least = 4.0 * 2.0 * std::f64::consts::PI / scale.range.max(1e-9);
        [0.5, 1.0, 2.0, 3.0, 4.0, 6.0]
            .iter()
            .map(|k| k * scale.gear)
            .filter(|&k| k > least)
            .map(|k| vec![k])
            .collect()
    }

    fn shapes_of_orders(&self, orders: &[f64]) -> Vec<Vec<f64>> {
        orders.iter().map(|&order| vec![order]).collect()
    }

    /// Neighbouring waves are told apart by half a wave over the travel.
    fn steps(&self, scale: &Scale) -> Vec<Step> {
        vec![Step::Add(std::f64::consts::PI / scale.range)]
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn law(&self, _: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        for (order, wave) in shape.iter().zip(out.chunks_exact_mut(2)) {
            let (s, c) = (order * at.q).sin_cos();
            wave[0] = c;
            wave[1] = s;
        }
    }

    fn closed_form(&self, _: &Scale, shape: &[f64], amplitude: &[f64], j: usize) -> Option<String> {
        let wave = |(order, a): (&f64, &[f64])| {
            let [order, c, s] = [*order, a[0], a[1]].map(number);
            format!("{c}*cos({order}*q{j}) + {s}*sin({order}*q{j})")
        };
        Some(shape.iter().zip(amplitude.chunks_exact(2)).map(wave).collect::<Vec<_>>().join(" + "))
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Smooth
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let per = scale.kind.wave_unit();
        let waves = a.chunks_exact(2).zip(s.chunks_exact(2)).zip(shape).enumerate();
        waves
            .flat_map(|(k, ((a, s), order))| {
                // The first wave has the plain names.
                let name = |name: &str| if k == 0 { name.to_owned() } else { format!("{name}_{}", k + 1) };
                [
                    Parameter::new(
                        &name("amplitude"),
                        a[0].hypot(a[1]),
                        s[0].max(s[1]),
                        scale.kind.torque_unit(),
                    ),
                    Parameter::new(&name("order"), *order, 0.0, per),
                    Parameter::new(&name("order_per_motor_turn"), order / scale.gear, 0.0, "1"),
                    // c cos x + s sin x = amplitude sin(x + phase)
                    Parameter::new(&name("phase"), a[0].atan2(a[1]), 0.0, "rad"),
                ]
            })
            .collect()
    }
}
