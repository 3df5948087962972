//! The band in which a recording's accelerations are known: one rule for every robot and every recording.

use crate::recording::Trajectory;
use crate::signal::{Preparation, SignalError, UniformGrid, welch};
use serde::{Deserialize, Serialize};

/// Bands that are chosen from, Hz, the widest first.
const BANDS: [f64; 13] = [50.0, 40.0, 30.0, 25.0, 20.0, 15.0, 10.0, 8.0, 6.0, 5.0, 4.0, 3.0, 2.0];
/// Noise may make up this share of the power of the accelerations: the share by which noise in a column pulls its
/// parameter, an inertia, towards zero.
const NOISE: f64 = 0.01;
/// Length of a segment of the spectrum, s.
const SEGMENT: f64 = 2.0;
/// Noise of a position that was filtered once falls with the square of the frequency, and so grows with it once it is differenced
/// twice: by this factor from one third of an octave to the next.
const FALL: f64 = 1.587_401_051_968_199_4;
/// A long motion is looked at in this many stretches of this many seconds.
const STRETCHES: usize = 6;
const STRETCH: f64 = 10.0;

/// A band, and what it rests on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bandwidth {
    /// Band of the observation's rows, Hz.
    pub band: f64,
    /// Cut-off of the position filter that goes with it, Hz: twice the band, where the filter's loss at the edge of
    /// the band is 0.4 %, at most a fifth of the recording's rate.
    pub cutoff: f64,
    /// Share of noise in the power of the accelerations within the band.
    pub noise: f64,
}

impl Bandwidth {
    /// The position filter for a given band.
    pub fn cutoff_for(band: f64, rate: f64) -> f64 {
        (2.0 * band).min(Preparation::default_cutoff(rate))
    }

    /// The widest of the bands that are chosen from up to a frequency, Hz; the narrowest where none is.
    pub(crate) fn up_to(frequency: f64) -> f64 {
        BANDS.into_iter().find(|&band| band <= frequency).unwrap_or(BANDS[BANDS.len() - 1])
    }

    /// The position filter for a given band at the rate of the slowest trajectory; `None` where no rate is known.
    pub fn cutoff_of(band: f64, trajectories: &[Trajectory]) -> Option<f64> {
        Self::rate_of(trajectories).map(|rate| Self::cutoff_for(band, rate))
    }

    /// The rate of the slowest trajectory, Hz; `None` where no rate is known.
    pub(crate) fn rate_of(trajectories: &[Trajectory]) -> Option<f64> {
        let rate = |t: &Trajectory| match (t.time.first(), t.time.last()) {
            (Some(first), Some(last)) if last > first => Some((t.time.len() - 1) as f64 / (last - first)),
            _ => None,
        };
        trajectories.iter().filter_map(rate).min_by(f64::total_cmp)
    }
}

/// Chooses the widest band, up to 50 Hz, in which noise makes up at most 1 % of the power of the accelerations.
///
/// Differentiating a position twice multiplies its noise by the square of the frequency, while the motion of a
/// robot fades above a few hertz. The spectrum of the raw second differences therefore falls, passes a valley, and
/// rises: what is below the valley counts as motion, what is above as noise, as far as it rises. What does not, as where
/// cogging shakes the robot, is motion too. Joints count by the share that they have in the variance of the torques. Without
/// torque variance the band is the widest that the rate allows.
///
/// # Errors
/// Time stamps that do not increase, or too few of them.
pub fn choose_bandwidth(trajectories: &[Trajectory]) -> Result<Bandwidth, SignalError> {
    let joints = trajectories.iter().map(|t| t.position.len()).max().unwrap_or(0);
    let mut spectra: Vec<Joint> = vec![Joint::default(); joints];
    let mut rate = f64::INFINITY;
    for trajectory in trajectories {
        let grid = UniformGrid::of(&trajectory.name, &trajectory.time, None)?;
        rate = rate.min(grid.rate);
        for (joint, position) in spectra.iter_mut().zip(&trajectory.position) {
            joint.add(&grid.resample(position), grid.rate)?;
        }
        for (joint, torque) in spectra.iter_mut().zip(&trajectory.torque) {
            joint.torque += variance(torque) * torque.len() as f64;
        }
    }
    if !rate.is_finite() {
        rate = 10.0 * BANDS[0];
    }
    let all: f64 = spectra.iter().map(|j| j.torque).sum();
    let noise_in = |band: f64| -> f64 {
        let share = |j: &Joint| if all > 0.0 { j.torque / all } else { 0.0 };
        spectra.iter().map(|j| share(j) * j.noise(band)).sum()
    };
    let limit = Preparation::default_cutoff(rate) / 2.0;
    let possible = |band: &f64| *band <= limit + 1e-9;
    let band = BANDS
        .into_iter()
        .filter(possible)
        .find(|&band| noise_in(band) <= NOISE)
        .unwrap_or_else(|| limit.min(BANDS[BANDS.len() - 1]));
    Ok(Bandwidth { band, cutoff: Bandwidth::cutoff_for(band, rate), noise: noise_in(band) })
}

/// The spectrum of one joint's raw accelerations, in thirds of an octave from 1 Hz on, and its torque.
#[derive(Debug, Clone, Default)]
struct Joint {
    /// Power in each third of an octave; the first holds all below 1 Hz.
    power: Vec<f64>,
    /// Frequencies that fell into it.
    count: Vec<usize>,
    /// Sum of squares of the torque around its mean.
    torque: f64,
}

/// Upper edge of a third of an octave, Hz.
fn edge(k: usize) -> f64 {
    2f64.powf(k as f64 / 3.0)
}

impl Joint {
    fn add(&mut self, position: &[f64], rate: f64) -> Result<(), SignalError> {
        let length = (STRETCH * rate) as usize;
        let starts: Vec<usize> = if position.len() > STRETCHES * length {
            let step = (position.len() - length) / (STRETCHES - 1);
            (0..STRETCHES).map(|k| k * step).collect()
        } else {
            vec![0]
        };
        for &start in &starts {
            let stretch = if starts.len() == 1 { position } else { &position[start..start + length] };
            let square = rate * rate;
            let acceleration: Vec<f64> =
                stretch.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]) * square).collect();
            let segment = ((SEGMENT * rate) as usize).max(16);
            if acceleration.len() < 16 {
                continue;
            }
            let spectrum = welch(&acceleration, rate, segment)?;
            let step = spectrum.frequency.get(1).copied().unwrap_or(0.0);
            let seconds = stretch.len() as f64 / rate;
            // The differences of the highest frequencies are not those of a derivative.
            for (f, density) in
                spectrum.frequency.iter().zip(&spectrum.density).filter(|(f, _)| **f < 0.25 * rate)
            {
                let k = (0..).find(|&k| *f <= edge(k)).unwrap_or(0);
                if self.power.len() <= k {
                    self.power.resize(k + 1, 0.0);
                    self.count.resize(k + 1, 0);
                }
                self.power[k] += density * step * seconds;
                self.count[k] += 1;
            }
        }
        Ok(())
    }

    /// Noise below `band` in units of the motion's power.
    fn noise(&self, band: f64) -> f64 {
        let density = |k: usize| self.power[k] / self.count[k] as f64;
        let upper = (1..self.power.len()).filter(|&k| self.count[k] > 0 && edge(k) <= 2.0 * BANDS[0]);
        let Some(valley) = upper.min_by(|&a, &b| density(a).total_cmp(&density(b))) else { return 0.0 };
        let motion: f64 = self.power[..=valley].iter().sum();
        // From the highest third down, what noise can be at most.
        let (mut noise, mut most) = (0.0, f64::INFINITY);
        for k in (valley + 1..self.power.len()).rev() {
            let inside = (band.min(edge(k)) - edge(k - 1)).max(0.0) / (edge(k) - edge(k - 1));
            if self.count[k] > 0 {
                most = density(k).min(most / FALL);
                noise += most * self.count[k] as f64 * inside;
            }
        }
        if motion > 0.0 { noise / motion } else { 0.0 }
    }
}

fn variance(x: &[f64]) -> f64 {
    let n = x.len().max(1) as f64;
    let mean = x.iter().sum::<f64>() / n;
    x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    /// One joint that swings at 1 Hz, with position noise of the given size.
    fn swinging(noise: f64, rate: f64, seconds: f64) -> Trajectory {
        let n = (rate * seconds) as usize;
        let w = std::f64::consts::TAU;
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        let time: Vec<f64> = (0..n).map(|k| k as f64 / rate).collect();
        let position = time.iter().map(|t| (w * t).sin() + noise * random.random_range(-1.0..1.0)).collect();
        let torque = time.iter().map(|t| (w * t).cos()).collect();
        Trajectory {
            name: "swing".into(),
            time,
            position: vec![position],
            velocity: None,
            torque: vec![torque],
            fixed: vec![],
        }
    }

    #[test]
    fn a_clean_recording_gets_the_widest_band() {
        let chosen = choose_bandwidth(&[swinging(1e-8, 1000.0, 20.0)]).expect("uniform time");
        assert_eq!((chosen.band, chosen.cutoff), (50.0, 100.0));
        assert!(chosen.noise < 0.01);
    }

    #[test]
    fn noise_narrows_the_band_to_where_it_is_a_hundredth_of_the_motion() {
        // White noise of variance v in the position has the density 2 v / rate (2 pi f)^4 as acceleration:
        // up to f its power is 2 v / rate (2 pi)^4 f^5 / 5; the motion's is (2 pi)^4 / 2.
        let (noise, rate) = (1e-3_f64, 1000.0);
        let variance = noise * noise / 3.0;
        let expected = (0.01 * 0.5 * 5.0 * rate / (2.0 * variance)).powf(0.2);
        let chosen = choose_bandwidth(&[swinging(noise, rate, 60.0)]).expect("uniform time");
        let widest = BANDS.into_iter().find(|b| *b <= expected).expect("within the list");
        assert!((10.0..50.0).contains(&expected));
        assert_eq!(chosen.band, widest, "{expected}");
    }

    #[test]
    fn a_robot_that_is_shaken_moves() {
        let mut shaken = swinging(1e-8, 1000.0, 20.0);
        for (t, q) in shaken.time.iter().zip(&mut shaken.position[0]) {
            // Cogging at a changing speed: a tenth of the accelerations, from 10 Hz to 30 Hz.
            let phase = std::f64::consts::TAU * (10.0 * t + 0.5 * t * t);
            let frequency = std::f64::consts::TAU * (10.0 + t);
            *q += 0.1 * (std::f64::consts::TAU / frequency).powi(2) * phase.sin();
        }
        assert_eq!(choose_bandwidth(&[shaken]).expect("uniform time").band, 50.0);
    }

    #[test]
    fn the_rate_limits_the_band() {
        let chosen = choose_bandwidth(&[swinging(1e-9, 100.0, 20.0)]).expect("uniform time");
        assert_eq!((chosen.band, chosen.cutoff), (10.0, 20.0));
    }

    #[test]
    fn a_joint_without_torque_does_not_count() {
        let mut two = swinging(1e-8, 1000.0, 20.0);
        let noisy = swinging(0.1, 1000.0, 20.0);
        two.position.push(noisy.position[0].clone());
        two.torque.push(vec![0.0; two.time.len()]);
        assert_eq!(choose_bandwidth(&[two]).expect("uniform time").band, 50.0);
    }
}
