//! A link that is driven through a spring, with or without play.
//!
//! The encoder sees the motor. With x = q_motor - q_link the link obeys M ddx = load - f(x, dx), where M is the
//! inertia of the links behind the joint, `load` the torque that they would ask for where they are, and f the torque of
//! spring and damper. Where they are is x behind the motor: to first order the load is the rigid one less G x, G its
//! derivative by the position, mostly that of gravity. The motor is then loaded by M ddx + G x less than the rigid model
//! says.

use crate::model::JointKind;

use super::shape::{ShapeSearch, Step};

/// A compliant transmission of one joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmission {
    /// N.m/rad or N/m.
    pub stiffness: f64,
    /// N.m.s/rad or N.s/m.
    pub damping: f64,
    /// Inertia on the motor's side of the spring, kg.m² or kg.
    pub rotor: f64,
    /// Whole free travel, rad or m.
    pub play: f64,
    /// Natural frequency with the median inertia of the link and the motor held, Hz.
    pub frequency: f64,
    /// Whether the joint turns or slides.
    pub kind: JointKind,
}

impl Transmission {
    /// From the scale-free shape (natural frequency in Hz, damping ratio, rotor as a fraction of the least inertia,
    /// play as a fraction of the travel) and the joint's inertia over the motion (least, median) and travel.
    pub fn from_shape(shape: &[f64], least: f64, median: f64, travel: f64, kind: JointKind) -> Self {
        let rotor = shape[2] * least;
        let link = (median - rotor).max(1e-3 * median);
        let w = 2.0 * std::f64::consts::PI * shape[0];
        let stiffness = link * w * w;
        Self {
            stiffness,
            damping: 2.0 * shape[1] * (stiffness * link).sqrt(),
            rotor,
            play: shape[PLAY] * travel,
            frequency: shape[0],
            kind,
        }
    }
}

impl Transmission {
    /// From what a model keeps of it: stiffness, damping, rotor, play; `None` where that is not what it has.
    pub fn from_amplitude(amplitude: &[f64], frequency: f64, kind: JointKind) -> Option<Self> {
        let &[stiffness, damping, rotor, play] = amplitude else { return None };
        Some(Self { stiffness, damping, rotor, play, frequency, kind })
    }

    /// What a model keeps of it: stiffness, damping, rotor, play.
    pub fn amplitude(&self) -> [f64; 4] {
        [self.stiffness, self.damping, self.rotor, self.play]
    }
}

/// Place of the play in the shape of a transmission.
pub(crate) const PLAY: usize = 3;

/// An effect of this form.
pub trait Compliance: Sync {
    /// Shapes to try: natural frequency Hz, damping ratio, rotor fraction, play as a fraction of the travel.
    fn shapes(&self) -> Vec<[f64; 4]>;

    /// Places in the shape of what rows do not show that keep nothing above `highest`, Hz: where the joint rings above it,
    /// frequency and damping of the ringing, whatever fits best. How far the link lags behind below it, or falls
    /// through its play, still shows.
    fn unseen(&self, shape: &[f64], highest: f64) -> std::ops::Range<usize> {
        if shape.first().is_some_and(|frequency| *frequency > highest) { 0..2 } else { 0..0 }
    }

    /// The quantities a person knows: name, value, unit.
    fn describe(&self, transmission: &Transmission) -> Vec<(&'static str, f64, &'static str)>;
}

/// How a shape is searched. Frequency and rotor trade against each other along the ridge of one stiffness, so they are
/// moved together, too; the rotor is a part of the inertia that the motor sees.
pub(in crate::effects) fn shape_search() -> ShapeSearch {
    let any = [f64::NEG_INFINITY, f64::INFINITY];
    ShapeSearch {
        steps: vec![Step::Times(1.12), Step::Times(1.9), Step::Add(0.15), Step::Times(1.4)],
        bounds: vec![any, [0.0, MOST_DAMPING], [0.0, LARGEST_ROTOR], any],
        together: vec![vec![(0, 0.4), (2, 1.0)], vec![(0, -0.4), (2, -1.0)]],
    }
}

/// Largest damping ratio that is tried. Transmissions of steel have a few hundredths; what does not ring is no spring that
/// shows, but a difference of filters or of noise.
const MOST_DAMPING: f64 = 0.25;

/// Largest rotor that is tried, as a fraction of the least inertia.
const LARGEST_ROTOR: f64 = 0.95;

/// Ringing is over after so many of its time constants: e^-4 is 2 %.
const RUNG_OUT: f64 = 4.0;

/// Two responses whose cosine is nearer to 1 than this tell no stretch.
const LEAST_DETERMINANT: f64 = 1e-3;

/// Steps of the integration between two samples: at least this many a second.
const STEPS_PER_SECOND: f64 = 2000.0;

/// Stretch of a transmission, motor less link, rad or m, and its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Motor less link.
    pub x: f64,
    /// Its derivative by time.
    pub dx: f64,
}

impl Stretch {
    /// As a load that lasts holds it.
    pub fn under(load: f64, t: &Transmission) -> Self {
        let free = if t.play > 0.0 { 0.5 * t.play * load.signum() } else { 0.0 };
        Self { x: load / t.stiffness + free, dx: 0.0 }
    }
}

/// What a transmission drives in one motion.
#[derive(Debug, Clone, Copy)]
pub struct LinkSide<'a> {
    /// Torque of the links, without the rotor, as if they followed the motor rigidly.
    pub load: &'a [f64],
    /// Their inertia about the joint.
    pub inertia: &'a [f64],
    /// Derivative of their torque by the position.
    pub stiffness: &'a [f64],
    /// Samples a second.
    pub rate: f64,
}

/// The stretch of a transmission in every sample and -M ddx, from a stretch at the start. Returns the number of samples
/// before the link is first free within its play.
///
/// Semi-implicit (symplectic) steps, which neither add nor take energy; where the step is too long for the spring,
/// implicit ones, which are stable for every stiffness. Each is written as a recurrence over the last two stretches
/// (Störmer's form of the same step), whose next value waits for one product and one sum.
pub fn deflection(
    link: &LinkSide<'_>,
    t: &Transmission,
    start: Stretch,
    [stretches, out]: [&mut [f64]; 2],
) -> usize {
    let Some(&first) = link.load.first() else { return 0 };
    let steps = (STEPS_PER_SECOND / link.rate).ceil().max(1.0);
    let h = 1.0 / (link.rate * steps);
    let square = h * h;
    let half = 0.5 * t.play;
    let (mut x, mut last) = (start.x, start.x - h * start.dx);
    let mut before = first;
    let mut held = link.load.len();
    for (k, ((&now, &m), &bent)) in link.load.iter().zip(link.inertia).zip(link.stiffness).enumerate() {
        let stiff = square * t.stiffness;
        let free = square / m;
        let on_flank = 1.0 / (m + h * t.damping + if stiff > 0.3 * m { stiff } else { 0.0 });
        let (kept, driven) = (m * on_flank, square * on_flank);
        let held_slope = 1.0 + kept - driven * (t.stiffness + bent);
        let free_slope = 2.0 - free * bent;
        let slope = (now - before) / steps;
        let went = x - last;
        for step in 1..=steps as usize {
            let force = before + slope * step as f64;
            let new = if half == 0.0 {
                held_slope * x + (driven * force - kept * last)
            } else if x.abs() > half {
                held_slope * x + (driven * (force + t.stiffness * half.copysign(x)) - kept * last)
            } else {
                held = held.min(k);
                free_slope * x + (free * force - last)
            };
            (last, x) = (x, new);
        }
        stretches[k] = x;
        out[k] = -m * (x - last - went) / (square * steps);
        before = now;
    }
    held
}

/// The stretch at the start of a motion, which may ring from before: that with which the torques at the start are explained
/// best. `missing[t]` is what the rigid model lacks there; the first `edge` samples of it are not looked at.
///
/// As long as the link does not come free of its flank the ringing is linear in the stretch, so that two responses without
/// a load tell it. Where the motion shows less than a period of it the link starts as its load holds it.
pub fn stretch_at_start(link: &LinkSide<'_>, missing: &[f64], t: &Transmission, edge: usize) -> Stretch {
    let rest = Stretch::under(link.load.first().copied().unwrap_or(0.0), t);
    let median = link.inertia.get(link.inertia.len() / 2).copied().unwrap_or(1.0);
    let angular = (t.stiffness / median).sqrt();
    let decay = 0.5 * t.damping / median;
    let horizon = (RUNG_OUT / decay * link.rate).min(link.load.len() as f64) as usize;
    let respond = |load: &[f64], t: &Transmission, start: Stretch| {
        let (mut x, mut out) = (vec![0.0; load.len()], vec![0.0; load.len()]);
        let held = deflection(&LinkSide { load, ..*link }, t, start, [&mut x, &mut out]);
        out.iter_mut().zip(x.iter().zip(link.stiffness)).for_each(|(out, (x, g))| *out -= g * x);
        (held, out)
    };
    let (held, driven) = respond(&link.load[..horizon], t, rest);
    let period = 2.0 * std::f64::consts::PI / angular * link.rate;
    if (held.saturating_sub(edge) as f64) < period {
        return rest;
    }
    let spring = Transmission { play: 0.0, ..*t };
    // Both of the same size as torques.
    let units = [1.0 / t.stiffness, angular / t.stiffness];
    let starts = [Stretch { x: units[0], dx: 0.0 }, Stretch { x: 0.0, dx: units[1] }];
    let responses = starts.map(|start| respond(&vec![0.0; held], &spring, start).1);
    let (mut a, mut b) = ([[0.0; 2]; 2], [0.0; 2]);
    for k in edge..held {
        let left = missing[k] - driven[k];
        for i in 0..2 {
            b[i] += responses[i][k] * left;
            for (j, response) in responses.iter().enumerate() {
                a[i][j] += responses[i][k] * response[k];
            }
        }
    }
    let determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    let are_apart = determinant > LEAST_DETERMINANT * a[0][0] * a[1][1];
    if !are_apart {
        return rest;
    }
    let x = (a[1][1] * b[0] - a[0][1] * b[1]) / determinant;
    let dx = (a[0][0] * b[1] - a[1][0] * b[0]) / determinant;
    Stretch { x: rest.x + x * units[0], dx: dx * units[1] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn driven(load: &[f64], m: f64, t: &Transmission, start: Stretch) -> Vec<f64> {
        let (inertia, stiffness) = (vec![m; load.len()], vec![0.0; load.len()]);
        let (mut x, mut out) = (vec![0.0; load.len()], vec![0.0; load.len()]);
        let link = LinkSide { load, inertia: &inertia, stiffness: &stiffness, rate: 500.0 };
        deflection(&link, t, start, [&mut x, &mut out]);
        out
    }

    #[test]
    fn a_constant_load_leaves_nothing_and_a_step_rings_at_the_natural_frequency() {
        let t = Transmission::from_shape(&[10.0, 0.01, 0.0, 0.0], 2.0, 2.0, 1.0, JointKind::Revolute);
        let out = driven(&[5.0; 1000], 2.0, &t, Stretch::under(5.0, &t));
        assert!(out.iter().all(|x| x.abs() < 1e-9));
        let load: Vec<f64> = (0..1000).map(|k| if k < 100 { 0.0 } else { 5.0 }).collect();
        let out = driven(&load, 2.0, &t, Stretch::under(0.0, &t));
        let crossings = out[200..950].windows(2).filter(|w| w[0] < 0.0 && w[1] >= 0.0).count();
        assert!((crossings as f64 / 1.5 - 10.0).abs() < 0.7, "{crossings} periods in 1.5 s");
    }

    #[test]
    fn play_is_felt_only_where_the_load_changes_its_sign() {
        let t = Transmission::from_shape(&[40.0, 0.3, 0.0, 0.002], 1.0, 1.0, 1.0, JointKind::Revolute);
        let load: Vec<f64> = (0..2000).map(|k| 10.0 * (k as f64 * 0.01 * 0.63).cos()).collect();
        let out = driven(&load, 1.0, &t, Stretch::under(load[0], &t));
        let near: f64 = (0..2000).filter(|&k| load[k].abs() < 5.0).map(|k| out[k] * out[k]).sum();
        let far: f64 = (200..2000).filter(|&k| load[k].abs() > 9.0).map(|k| out[k] * out[k]).sum();
        assert!(near > 20.0 * far, "{near} {far}");
    }

    #[test]
    fn a_link_that_hangs_deflects_as_spring_and_gravity_together_hold_it() {
        let t = Transmission::from_shape(&[6.0, 0.2, 0.0, 0.0], 2.0, 2.0, 1.0, JointKind::Revolute);
        let (load, inertia, stiffness) = (vec![40.0; 3000], vec![2.0; 3000], vec![0.05 * t.stiffness; 3000]);
        let (mut x, mut out) = (vec![0.0; 3000], vec![0.0; 3000]);
        let link = LinkSide { load: &load, inertia: &inertia, stiffness: &stiffness, rate: 500.0 };
        deflection(&link, &t, Stretch::under(40.0, &t), [&mut x, &mut out]);
        assert!((x[2999] * 1.05 * t.stiffness / 40.0 - 1.0).abs() < 1e-6, "{}", x[2999]);
    }

    #[test]
    fn ringing_from_before_the_start_is_told_with_and_without_play() {
        for play in [0.0, 0.01] {
            let t = Transmission {
                play,
                ..Transmission::from_shape(&[6.0, 0.05, 0.0, 0.0], 2.0, 2.0, 1.0, JointKind::Revolute)
            };
            let load: Vec<f64> = (0..2000).map(|k| 40.0 + 10.0 * (k as f64 * 0.01).sin()).collect();
            let (inertia, stiffness) = (vec![2.0; 2000], vec![0.0; 2000]);
            let truth = Stretch { x: Stretch::under(40.0, &t).x + 0.003, dx: -0.2 };
            let missing = driven(&load, 2.0, &t, truth);
            let told = |samples: usize| {
                let (load, inertia) = (&load[..samples], &inertia[..samples]);
                let link = LinkSide { load, inertia, stiffness: &stiffness[..samples], rate: 500.0 };
                stretch_at_start(&link, &missing[..samples], &t, 20)
            };
            let found = told(2000);
            assert!((found.x - truth.x).abs() < 1e-6, "{found:?} {truth:?}");
            assert!((found.dx - truth.dx).abs() < 1e-4, "{found:?} {truth:?}");
            assert_eq!(told(40), Stretch::under(40.0, &t), "less than a period");
        }
    }
}
