//! Motions from point to point, at rest at every point.

use crate::simulation::Reference;

/// How a joint goes from one point to the next, as a function of the share of time s in [0, 1].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// Fifth-order polynomial with zero velocity and acceleration at both ends.
    Quintic,
    /// Trapezoidal acceleration: 40 % of the time speeding up, 20 % at constant speed, 40 % slowing down, each
    /// change of acceleration a ramp over a quarter of its phase.
    TrapezoidalAcceleration,
}

/// Share of the time that each acceleration phase takes.
const PHASE: f64 = 0.4;
/// Share of an acceleration phase that each of its two ramps takes.
const RAMP: f64 = 0.25;

impl Profile {
    /// Share of the way, and its first and second derivatives with respect to s.
    pub fn at(self, s: f64) -> [f64; 3] {
        match self {
            Profile::Quintic => [
                s * s * s * (10.0 + s * (-15.0 + s * 6.0)),
                30.0 * s * s * (1.0 - s) * (1.0 - s),
                60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
            ],
            Profile::TrapezoidalAcceleration if s > 0.5 => {
                let [way, speed, acceleration] = self.at(1.0 - s);
                [1.0 - way, speed, -acceleration]
            }
            Profile::TrapezoidalAcceleration => trapezoid(s),
        }
    }

    /// Largest first and second derivative.
    pub fn peaks(self) -> [f64; 2] {
        match self {
            Profile::Quintic => [1.875, 10.0 / 3.0_f64.sqrt()],
            Profile::TrapezoidalAcceleration => {
                let speed = 1.0 / (1.0 - PHASE);
                [speed, speed / (PHASE * (1.0 - RAMP))]
            }
        }
    }
}

/// First half of the trapezoidal-acceleration profile.
fn trapezoid(s: f64) -> [f64; 3] {
    let [speed, peak] = Profile::TrapezoidalAcceleration.peaks();
    let ramp = RAMP * PHASE;
    if s <= ramp {
        let jerk = peak / ramp;
        return [jerk * s * s * s / 6.0, jerk * s * s / 2.0, jerk * s];
    }
    let (way_ramp, speed_ramp) = (peak * ramp * ramp / 6.0, peak * ramp / 2.0);
    if s <= PHASE - ramp {
        let u = s - ramp;
        return [way_ramp + u * (speed_ramp + 0.5 * peak * u), speed_ramp + peak * u, peak];
    }
    if s <= PHASE {
        // Seen from the end of the phase: the speed is approached as it was left.
        let u = PHASE - s;
        let jerk = peak / ramp;
        let way_end = 0.5 * speed * PHASE;
        return [way_end - speed * u + jerk * u * u * u / 6.0, speed - jerk * u * u / 2.0, jerk * u];
    }
    [0.5 * speed * PHASE + speed * (s - PHASE), speed, 0.0]
}

/// All joints go from point to point together; each leg takes as long as its slowest joint needs.
#[derive(Debug, Clone, PartialEq)]
pub struct PointToPointMotion {
    /// `points[k][j]`, rad or m.
    pub points: Vec<Vec<f64>>,
    /// How they are joined.
    pub profile: Profile,
    /// Start time of each leg, then the end of the motion, s.
    pub times: Vec<f64>,
    /// Stop at each point, s.
    pub pause: f64,
}

impl PointToPointMotion {
    /// The fastest motion through the points within speed and acceleration limits. The peaks of a leg are known
    /// in closed form, so the limits hold at every instant.
    pub fn within(
        points: Vec<Vec<f64>>,
        profile: Profile,
        pause: f64,
        velocity: &[f64],
        acceleration: &[f64],
    ) -> Self {
        let [speed, peak] = profile.peaks();
        let mut times = vec![0.0];
        let mut now = 0.0;
        for leg in points.windows(2) {
            let mut needed = 1e-3_f64;
            for j in 0..velocity.len() {
                let way = (leg[1][j] - leg[0][j]).abs();
                needed = needed.max(way * speed / velocity[j]).max((way * peak / acceleration[j]).sqrt());
            }
            now += needed + pause;
            times.push(now);
        }
        Self { points, profile, times, pause }
    }

    /// Makes every leg slower by a factor.
    pub fn stretch(&mut self, factor: f64) {
        self.times.iter_mut().for_each(|t| *t *= factor);
        self.pause *= factor;
    }
}

impl Reference for PointToPointMotion {
    fn joints(&self) -> usize {
        self.points.first().map_or(0, Vec::len)
    }

    fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    fn at(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        let leg = self.times.partition_point(|&start| start <= t).clamp(1, self.times.len().max(2) - 1);
        let (Some(from), Some(to)) = (self.points.get(leg - 1), self.points.get(leg)) else { return };
        let moving = self.times[leg] - self.times[leg - 1] - self.pause;
        let s = ((t - self.times[leg - 1]) / moving).clamp(0.0, 1.0);
        let [way, speed, acceleration] = self.profile.at(s);
        for j in 0..from.len() {
            let whole = to[j] - from[j];
            q[j] = from[j] + whole * way;
            dq[j] = whole * speed / moving;
            ddq[j] = whole * acceleration / (moving * moving);
        }
    }

    fn fixed(&self) -> Vec<usize> {
        (0..self.joints()).filter(|&j| self.points.iter().all(|p| p[j] == self.points[0][j])).collect()
    }
}
