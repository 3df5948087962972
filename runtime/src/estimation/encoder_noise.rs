//! How much of the accelerations that a model is evaluated on is noise of the encoders.

use crate::recording::Trajectory;
use crate::signal::{Decimator, Preparation, SignalError, UniformGrid, smoothed, welch};
use realfft::RealFftPlanner;

/// Length of a segment of the spectrum, s.
const SEGMENT: f64 = 2.0;
/// A long motion is looked at in this many stretches of this many seconds.
const STRETCHES: usize = 6;
const STRETCH: f64 = 10.0;
/// Lowest frequency that is looked at, Hz: robots move below it.
const LOWEST: f64 = 8.0;

/// Noise of the encoders of a recording, joint by joint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EncoderNoise {
    /// Density of the positions where it is lowest over an octave, rad²/Hz or m²/Hz, one-sided; zero for a joint
    /// whose noise is not known.
    pub density: Vec<f64>,
}

impl EncoderNoise {
    /// From the positions of trajectories as they were recorded.
    ///
    /// The spectrum of a position falls with the motion and ends on the floor of its noise. The floor is taken where
    /// the mean density of an octave is lowest: noise that is white, as that of an encoder with fine steps is, has it
    /// everywhere, and of noise that is not at least as much is left within the band. A recording that has its own
    /// velocities tells nothing here: accelerations may come from them.
    ///
    /// # Errors
    /// Time stamps that do not increase, or too few of them.
    pub fn of(trajectories: &[Trajectory]) -> Result<Self, SignalError> {
        if trajectories.iter().any(|t| t.velocity.is_some()) {
            return Ok(Self::default());
        }
        let joints = trajectories.iter().map(|t| t.position.len()).max().unwrap_or(0);
        let mut octaves: Vec<Vec<[f64; 2]>> = vec![Vec::new(); joints];
        for trajectory in trajectories {
            let grid = UniformGrid::of(&trajectory.name, &trajectory.time, None)?;
            for (octaves, position) in octaves.iter_mut().zip(&trajectory.position) {
                let position = grid.resample(position);
                for stretch in stretches(&position, grid.rate) {
                    add_octaves(octaves, stretch, grid.rate)?;
                }
            }
        }
        let lowest = |octaves: Vec<[f64; 2]>| {
            let means = octaves.iter().filter(|[_, count]| *count > 0.0).map(|[sum, count]| sum / count);
            let least = means.fold(f64::INFINITY, f64::min);
            if least.is_finite() { least } else { 0.0 }
        };
        Ok(Self { density: octaves.into_iter().map(lowest).collect() })
    }

    /// Variance that this noise has in the accelerations of a row, (rad/s²)² or (m/s²)²: what the position filter, two
    /// differences and the filter of the rows leave of it, for a trajectory of `rate`, Hz.
    ///
    /// # Errors
    /// A position filter that the rate does not allow.
    pub fn in_accelerations(
        &self,
        rate: f64,
        preparation: &Preparation,
        rows: &Decimator,
    ) -> Result<Vec<f64>, SignalError> {
        if self.density.iter().all(|&d| d == 0.0) {
            return Ok(Vec::new());
        }
        // The response to a single wrong sample in the middle.
        let reach = |samples: usize| -> Trajectory {
            let mut position = vec![0.0; samples];
            position[samples / 2] = 1.0;
            let time = (0..samples).map(|k| k as f64 / rate).collect();
            Trajectory {
                name: "impulse".to_owned(),
                time,
                position: vec![position],
                velocity: None,
                torque: vec![vec![0.0; samples]],
                fixed: Vec::new(),
            }
        };
        let mut samples = 64;
        let motion = loop {
            let motion = match smoothed(&reach(samples), preparation) {
                Err(SignalError::TooShort { needed, .. }) => {
                    samples = 4 * needed;
                    continue;
                }
                other => other?,
            };
            if samples >= 4 * motion.edge_samples {
                break motion;
            }
            samples = 8 * motion.edge_samples;
        };
        let response = motion.ddq.first().map_or(&[][..], Vec::as_slice);
        // What is left of it has died out at both ends; the filter of the rows may be far longer.
        let largest = response.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let lives = |x: &f64| x.abs() > DIED_OUT * largest;
        let first = response.iter().position(lives).unwrap_or(0);
        let last = response.iter().rposition(lives).map_or(0, |last| last + 1);
        let gain = squares_of_convolution(&response[first..last.max(first)], rows.taps());
        Ok(self.density.iter().map(|d| d * 0.5 * rate * gain).collect())
    }
}

/// Sum of the squares of a convolution, by its spectrum (Parseval): narrow bands have filters of many thousand taps.
fn squares_of_convolution(a: &[f64], b: &[f64]) -> f64 {
    let n = (a.len() + b.len()).max(2).next_power_of_two();
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let spectrum_of = |signal: &[f64]| -> Vec<f64> {
        let (mut input, mut output) = (fft.make_input_vec(), fft.make_output_vec());
        input[..signal.len()].copy_from_slice(signal);
        // The lengths are those of the plan.
        if fft.process(&mut input, &mut output).is_err() {
            return Vec::new();
        }
        output.iter().map(|x| x.norm_sqr()).collect()
    };
    let (a, b) = (spectrum_of(a), spectrum_of(b));
    let both: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a * b).collect();
    // All but the first and the last line stand for a negative frequency, too.
    let ends = both.first().unwrap_or(&0.0) + both.last().unwrap_or(&0.0);
    (2.0 * both.iter().sum::<f64>() - ends) / n as f64
}

/// Part of its largest value below which a response counts as over.
const DIED_OUT: f64 = 1e-9;

/// The parts of a position that are looked at.
fn stretches(position: &[f64], rate: f64) -> Vec<&[f64]> {
    let length = (STRETCH * rate) as usize;
    if length == 0 || position.len() <= STRETCHES * length {
        return vec![position];
    }
    let step = (position.len() - length) / (STRETCHES - 1);
    (0..STRETCHES).map(|k| &position[k * step..k * step + length]).collect()
}

/// Adds the densities of a position, and how many they are, to its octaves above the lowest frequency. Differences
/// keep the motion from leaking into the noise; they are undone.
fn add_octaves(octaves: &mut Vec<[f64; 2]>, position: &[f64], rate: f64) -> Result<(), SignalError> {
    let differences: Vec<f64> = position.windows(3).map(|w| w[0] - 2.0 * w[1] + w[2]).collect();
    let segment = ((SEGMENT * rate) as usize).max(16);
    if differences.len() < 16 {
        return Ok(());
    }
    let spectrum = welch(&differences, rate, segment)?;
    for (f, density) in spectrum.frequency.iter().zip(&spectrum.density) {
        if *f < LOWEST || *f > 0.4 * rate {
            continue;
        }
        let octave = (f / LOWEST).log2() as usize;
        if octaves.len() <= octave {
            octaves.resize(octave + 1, [0.0; 2]);
        }
        let gain = (2.0 * (std::f64::consts::PI * f / rate).sin()).powi(4);
        let [sum, count] = &mut octaves[octave];
        *sum += density / gain;
        *count += 1.0;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Motion;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    const RATE: f64 = 1000.0;

    /// A joint that swings by `swing` at 1 Hz, with white position noise of standard deviation `noise`.
    fn joint(swing: f64, noise: f64) -> Trajectory {
        let mut random = rand_pcg::Pcg64::seed_from_u64(2);
        let n = 30_000;
        let time: Vec<f64> = (0..n).map(|k| k as f64 / RATE).collect();
        let position = time
            .iter()
            .map(|t| {
                let draw: f64 = StandardNormal.sample(&mut random);
                swing * (std::f64::consts::TAU * t).sin() + noise * draw
            })
            .collect();
        Trajectory {
            name: "swing".into(),
            time,
            position: vec![position],
            velocity: None,
            torque: vec![vec![0.0; n]],
            fixed: vec![],
        }
    }

    #[test]
    fn white_noise_is_found_under_a_motion() {
        let found = EncoderNoise::of(&[joint(1.0, 1e-4)]).expect("uniform time").density[0];
        let expected = 2.0 * 1e-8 / RATE;
        assert!((found / expected - 1.0).abs() < 0.1, "{found} {expected}");
    }

    #[test]
    fn its_part_of_the_accelerations_is_what_the_filters_leave() {
        let noise = EncoderNoise { density: vec![2.0 * 1e-8 / RATE] };
        let decimator = Decimator::for_rows(RATE, 25.0, None).expect("valid");
        let preparation = Preparation { cutoff: Some(50.0), ..Preparation::default() };
        let expected = noise.in_accelerations(RATE, &preparation, &decimator).expect("filters")[0];
        let Motion { ddq, edge_samples, .. } =
            smoothed(&joint(0.0, 1e-4), &preparation).expect("long enough");
        let mut rows = vec![0.0; 2000];
        let count = decimator.decimate_run(&ddq[0][edge_samples..30_000 - edge_samples], &mut rows);
        let variance = rows[..count].iter().map(|x| x * x).sum::<f64>() / count as f64;
        assert!((variance / expected - 1.0).abs() < 0.15, "{variance} {expected}");
    }

    #[test]
    fn the_squares_of_a_convolution_are_those_of_its_samples() {
        let a: Vec<f64> = (0..37).map(|k| (0.7 * f64::from(k)).sin()).collect();
        let b: Vec<f64> = (0..12).map(|k| (0.3 * f64::from(k)).cos()).collect();
        let at = |k: usize| -> f64 {
            (0..a.len()).filter(|i| (*i..*i + b.len()).contains(&k)).map(|i| a[i] * b[k - i]).sum()
        };
        let direct: f64 = (0..a.len() + b.len()).map(|k| at(k).powi(2)).sum();
        assert!((squares_of_convolution(&a, &b) / direct - 1.0).abs() < 1e-12);
        assert_eq!(squares_of_convolution(&[], &b), 0.0);
    }

    #[test]
    fn recorded_velocities_say_nothing_of_the_noise_of_accelerations() {
        let mut trajectory = joint(1.0, 1e-4);
        trajectory.velocity = Some(trajectory.position.clone());
        assert!(EncoderNoise::of(&[trajectory]).expect("uniform time").density.is_empty());
    }
}
