//! From a trajectory as measured to a motion that a model can be evaluated on.

use super::{Butterworth, Motion, SignalError, Stencil, UniformGrid, central_difference};
use crate::parallel;
use crate::recording::Trajectory;

/// How positions are filtered and differentiated.
///
/// The paper's band-pass filter is a zero-phase Butterworth low-pass followed by central differences. The cut-off
/// must lie well above the motion's band, or it distorts accelerations that the torques are not distorted by,
/// and no higher than needed, because differentiating twice multiplies noise by the square of the frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Preparation {
    /// Cut-off of the position filter, Hz; `None`: `Preparation::default_cutoff`.
    pub cutoff: Option<f64>,
    /// Order of one pass of the Butterworth filter.
    pub order: usize,
    /// Rate of the uniform grid, Hz; `None`: the recording's own.
    pub rate: Option<f64>,
    /// Where dq comes from.
    pub velocity: VelocitySource,
    /// Stencil of the differences; `None`: the narrowest that is exact to 0.5 % at a quarter of the cut-off.
    pub stencil: Option<Stencil>,
    /// Threads over the joints; 0: as many as the machine has. The result is the same, to the last digit.
    pub threads: usize,
}

/// Where dq comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum VelocitySource {
    /// For each joint the recorded velocity if there is one that agrees with the positions (scale within 2 %, no
    /// lag beyond a fifth of a sample or 0.5 ms) and is less noisy than their differences; else the positions.
    #[default]
    Automatic,
    /// Central differences of the filtered positions, as in the paper.
    Positions,
    /// The recorded velocity, filtered with the same filter, where there is one; else the positions.
    Recorded,
}

impl Default for Preparation {
    fn default() -> Self {
        Self {
            cutoff: None,
            order: 4,
            rate: None,
            velocity: VelocitySource::Automatic,
            stencil: None,
            threads: 1,
        }
    }
}

impl Preparation {
    /// 100 Hz, or a fifth of the rate where that is less: twice the widest band (50 Hz) that an observation is
    /// usually decimated to, and for slow recordings as high as double differences of them still make sense.
    pub fn default_cutoff(rate: f64) -> f64 {
        (rate / 5.0).min(100.0)
    }
}

/// A mode of the filter counts as decayed when it is down to this.
const DECAYED: f64 = 1e-4;

/// Lays a trajectory on a uniform grid, filters its positions without phase shift, and differentiates them twice.
///
/// Torques are put on the same grid and not filtered: the parallel decimation filters them together with the
/// columns of W. The samples at each end that the edge effects of the filter and of the differences
/// reach are counted in `Motion::edge_samples`. Joints that stand still are held ([`Motion::hold`]).
///
/// # Errors
/// Channels of unequal length, stamps that do not increase, values that are not finite, a motion too
/// short for the filter, a cut-off outside of (0, rate / 2).
pub fn prepare(trajectory: &Trajectory, settings: &Preparation) -> Result<Motion, SignalError> {
    let mut motion = smoothed(trajectory, settings)?;
    motion.hold();
    Ok(motion)
}

/// The same with whatever joints do that stand still.
///
/// # Errors
/// As [`prepare`].
pub(crate) fn smoothed(trajectory: &Trajectory, settings: &Preparation) -> Result<Motion, SignalError> {
    let name = &trajectory.name;
    check(trajectory)?;
    let grid = UniformGrid::of(name, &trajectory.time, settings.rate)?;
    let rate = grid.rate;
    let cutoff = settings.cutoff.unwrap_or_else(|| Preparation::default_cutoff(rate));
    let filters = Filters::new(settings, cutoff, rate)?;
    let edge_samples = filters.edge_samples();
    let needed = 2 * edge_samples + 1;
    if grid.len < needed {
        return Err(SignalError::TooShort {
            name: name.clone(),
            samples: grid.len,
            needed,
            purpose: "filter and differentiate the positions",
        });
    }
    let joints = parallel::map(settings.threads, trajectory.position.len(), |j| {
        let position = grid.resample(&trajectory.position[j]);
        let q = filters.filtered(&position)?;
        let recorded = match trajectory.velocity.as_ref().and_then(|velocity| velocity.get(j)) {
            Some(velocity) if settings.velocity != VelocitySource::Positions => Some(grid.resample(velocity)),
            _ => None,
        };
        let dq = match recorded {
            Some(recorded) => filters.speed(settings.velocity, &recorded, &position, &q)?,
            None => filters.derivative(&q),
        };
        let ddq = filters.derivative(&dq);
        Ok::<_, SignalError>([q, dq, ddq])
    });
    let [mut q, mut dq, mut ddq] = [Vec::new(), Vec::new(), Vec::new()];
    for joint in joints {
        let [position, velocity, acceleration] = joint?;
        q.push(position);
        dq.push(velocity);
        ddq.push(acceleration);
    }
    Ok(Motion {
        name: name.clone(),
        rate,
        start: grid.start,
        q,
        dq,
        ddq,
        torque: trajectory.torque.iter().map(|t| grid.resample(t)).collect(),
        fixed: trajectory.fixed.clone(),
        edge_samples,
    })
}

/// The position filter and the differences at one rate.
struct Filters {
    filter: Butterworth,
    stencil: Stencil,
    padding: usize,
    rate: f64,
}

impl Filters {
    fn new(settings: &Preparation, cutoff: f64, rate: f64) -> Result<Self, SignalError> {
        let filter = Butterworth::low_pass(settings.order, cutoff, rate)?;
        let stencil = settings.stencil.unwrap_or_else(|| Stencil::accurate_to(0.25 * cutoff / rate, 0.005));
        // A pass starts at rest; padding until that start has died out leaves only the kink of the reflected end.
        let padding = filter.padding().max(filter.settling(DECAYED));
        Ok(Self { filter, stencil, padding, rate })
    }

    /// Samples at each end that the edge effects of the filter and of two differences reach.
    fn edge_samples(&self) -> usize {
        self.padding + 2 * self.stencil.half_width()
    }

    fn filtered(&self, values: &[f64]) -> Result<Vec<f64>, SignalError> {
        let mut out = Vec::new();
        self.filter.zero_phase_into(values, self.padding, &mut out).map(|()| out)
    }

    fn derivative(&self, values: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; values.len()];
        central_difference(values, self.rate, self.stencil, &mut out);
        out
    }

    /// The velocity where one was recorded: that, or the differences of the filtered positions `q`, whichever `source`
    /// asks for.
    fn speed(
        &self,
        source: VelocitySource,
        recorded: &[f64],
        position: &[f64],
        q: &[f64],
    ) -> Result<Vec<f64>, SignalError> {
        let smooth = self.filtered(recorded)?;
        if source == VelocitySource::Recorded {
            return Ok(smooth);
        }
        let raw = self.derivative(position);
        let ours = self.derivative(q);
        let inside = self.edge_samples()..q.len() - self.edge_samples();
        let agrees = agree(&smooth[inside.clone()], &ours[inside], self.rate);
        Ok(if agrees && roughness(recorded) < roughness(&raw) { smooth } else { ours })
    }
}

/// Prepares the trajectories of a recording. Those that are too short to be filtered, as pieces between two gaps may
/// be, are left out and named.
///
/// # Errors
/// As [`prepare`], and where every trajectory is too short.
pub fn prepare_all(
    trajectories: &[Trajectory],
    settings: &Preparation,
) -> Result<(Vec<Motion>, Vec<SignalError>), SignalError> {
    let (mut motions, mut too_short) = (Vec::new(), Vec::new());
    for trajectory in trajectories {
        match prepare(trajectory, settings) {
            Ok(motion) => motions.push(motion),
            Err(error @ SignalError::TooShort { .. }) => too_short.push(error),
            Err(error) => return Err(error),
        }
    }
    match (motions.is_empty(), too_short.first()) {
        (true, Some(first)) => Err(first.clone()),
        _ => Ok((motions, too_short)),
    }
}

/// Whether `recorded` is `ours` up to noise: least squares of recorded = scale * ours - lag * d(ours)/dt.
fn agree(recorded: &[f64], ours: &[f64], rate: f64) -> bool {
    let mut slope = vec![0.0; ours.len()];
    central_difference(ours, rate, Stencil::Three, &mut slope);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let (dd, ss, ds) = (dot(ours, ours), dot(&slope, &slope), dot(ours, &slope));
    let (rd, rs, rr) = (dot(recorded, ours), dot(recorded, &slope), dot(recorded, recorded));
    let determinant = dd * ss - ds * ds;
    if determinant <= 1e-9 * dd * ss {
        return false;
    }
    let scale = (rd * ss - rs * ds) / determinant;
    let lag = -(rs * dd - rd * ds) / determinant;
    let rest = rr - scale * rd + lag * rs;
    (scale - 1.0).abs() <= 0.02 && lag.abs() <= (0.2 / rate).max(0.5e-3) && rest <= 0.01 * rr
}

/// Mean square of the third differences: what a signal has of noise, for a motion has next to none of it.
fn roughness(signal: &[f64]) -> f64 {
    let third = |w: &[f64]| (w[3] - w[0]) - 3.0 * (w[2] - w[1]);
    signal.windows(4).map(|w| third(w).powi(2)).sum::<f64>() / signal.len().max(1) as f64
}

fn check(trajectory: &Trajectory) -> Result<(), SignalError> {
    let expected = trajectory.time.len();
    let velocity = trajectory.velocity.iter().flatten();
    for channel in trajectory.position.iter().chain(&trajectory.torque).chain(velocity) {
        if channel.len() != expected {
            return Err(SignalError::Shape { name: trajectory.name.clone(), found: channel.len(), expected });
        }
        if !channel.iter().all(|x| x.is_finite()) {
            return Err(SignalError::NotFinite { name: trajectory.name.clone() });
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "prepare_tests.rs"]
mod tests;
