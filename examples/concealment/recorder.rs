//! How the torques and positions of a run get into its recording.

use clap::ValueEnum;
use dynid_runtime::model::{JointKind, Robot};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::Butterworth;

use crate::random::Random;

/// What records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Recorder {
    /// White noise of the robot's nominal size.
    White,
    /// Noise of the same size on top that lasts 20 to 200 ms, as of thermal and magnetic disturbances.
    Coloured,
    /// Encoders of 14 to 18 bits a turn (or a tenth of a metre), torques in steps of one to five times their noise.
    Quantised,
    /// Torques that were low-pass filtered offline, at 20 to 60 Hz.
    Filtered,
    /// Torques from motor currents: noise in proportion to the torque, 0.5 to 2 %, that lasts some 20 ms, and steps.
    Current,
}

impl Recorder {
    /// Its name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned())
    }

    /// Makes of a recording with white noise what this one would have made. The recorder is that of the case; its noise
    /// is another in each part (recording, baseline, test) and motion.
    pub fn alter(self, robot: &Robot, motion: &mut Trajectory, (case, part): (u64, u64)) {
        let mut device = Random::of(&["recorder", &self.name()], case);
        let mut random = Random::of(&["recorded", &self.name(), &motion.name], case.wrapping_add(part << 32));
        let rate = match (motion.time.first(), motion.time.last()) {
            (Some(from), Some(to)) if to > from => (motion.time.len() - 1) as f64 / (to - from),
            _ => return,
        };
        let nominal = |j: usize| robot.nominal.as_ref().map_or(0.0, |n| n.torque_noise[j]);
        match self {
            Self::White => {}
            Self::Coloured => {
                let lasting = device.within(0.02, 0.2) * rate;
                for (j, torque) in motion.torque.iter_mut().enumerate() {
                    let noise = autoregressive(lasting, torque.len(), &mut random);
                    torque.iter_mut().zip(noise).for_each(|(y, e)| *y += nominal(j) * e);
                }
            }
            Self::Quantised => {
                let (bits, steps) = (14.0 + device.below(5) as f64, device.within(1.0, 5.0));
                let of_joint = robot.frames.iter().filter(|f| f.kind != JointKind::Fixed);
                for (position, frame) in motion.position.iter_mut().zip(of_joint) {
                    let whole = if frame.kind == JointKind::Prismatic { 0.1 } else { std::f64::consts::TAU };
                    round(position, whole / bits.exp2());
                }
                for (j, torque) in motion.torque.iter_mut().enumerate() {
                    round(torque, steps * nominal(j));
                }
            }
            Self::Filtered => {
                let cutoff = device.within(20.0, 60.0);
                let Ok(filter) = Butterworth::low_pass(2, cutoff, rate) else { return };
                for torque in &mut motion.torque {
                    if let Ok(smooth) = filter.zero_phase(torque) {
                        *torque = smooth;
                    }
                }
            }
            Self::Current => {
                let share = device.within(0.005, 0.02);
                for (j, torque) in motion.torque.iter_mut().enumerate() {
                    let noise = autoregressive(0.02 * rate, torque.len(), &mut random);
                    torque.iter_mut().zip(noise).for_each(|(y, e)| *y += share * *y * e);
                    round(torque, nominal(j));
                }
            }
        }
    }
}

fn round(values: &mut [f64], step: f64) {
    if step > 0.0 {
        values.iter_mut().for_each(|x| *x = (*x / step).round() * step);
    }
}

/// A normal number with variance one (Box and Muller 1958).
fn normal(random: &mut Random) -> f64 {
    let (radius, angle) = (1.0 - random.share(), std::f64::consts::TAU * random.share());
    (-2.0 * radius.ln()).sqrt() * angle.cos()
}

/// AR(1) of variance one whose correlation falls to 1/e in so many samples.
fn autoregressive(lasting: f64, count: usize, random: &mut Random) -> Vec<f64> {
    let keeps = (-1.0 / lasting.max(1e-3)).exp();
    let fresh = (1.0 - keeps * keeps).sqrt();
    let mut state = normal(random);
    (0..count)
        .map(|_| {
            state = keeps * state + fresh * normal(random);
            state
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_that_lasts_has_variance_one_and_the_correlation_that_was_asked_for() {
        let noise = autoregressive(10.0, 200_000, &mut Random::of(&["noise"], 1));
        let mean = |x: &mut dyn Iterator<Item = f64>| x.sum::<f64>() / noise.len() as f64;
        let variance = mean(&mut noise.iter().map(|e| e * e));
        let lagged = mean(&mut noise.iter().zip(&noise[10..]).map(|(a, b)| a * b));
        assert!((variance - 1.0).abs() < 0.05, "{variance}");
        assert!((lagged - (-1.0_f64).exp()).abs() < 0.05, "{lagged}");
    }
}
