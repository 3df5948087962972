//! One signal, watched as it passes.

use serde::Serialize;

use super::roles::Role;

/// What is known of a signal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// Its name.
    pub name: String,
    /// Values that are numbers, and rows without one.
    pub count: u64,
    /// Rows in which there is none.
    pub missing: u64,
    /// Range of the values.
    pub low: f64,
    /// Range of the values.
    pub high: f64,
    /// From the first to the last value, s; rows where there is no time.
    pub duration: f64,
    /// Values a second, by the median step; `None` where there is no time.
    pub rate: Option<f64>,
    /// Steps of more than five times the median, and the largest of them, s, with the time before it.
    pub gaps: u64,
    /// The largest step, s, and the time before it.
    pub largest_gap: Option<[f64; 2]>,
    /// Values at the time of the one before them, and before it.
    pub repeated: u64,
    /// Values whose time is before that of the one before them.
    pub backwards: u64,
    /// Share of the time in which its joint moves with less than 2 % of its fastest speed; `None` for a signal that does not
    /// tell, as a torque.
    pub standstill: Option<f64>,
}

/// Steps of which the median is taken.
const STEPS: usize = 4096;
/// Values that are kept to see how fast it moves.
const KEPT: usize = 8192;
/// Median steps from which one is a gap.
const GAP: f64 = 5.0;
/// Share of the fastest speed below which a signal stands still.
const STILL: f64 = 0.02;

/// A signal that is being watched.
pub(super) struct Watched {
    series: Series,
    first: f64,
    last: f64,
    steps: Vec<f64>,
    median: Option<f64>,
    kept: Vec<[f64; 2]>,
    /// Every so manieth value is kept.
    stride: u64,
}

impl Watched {
    pub fn new(name: &str) -> Self {
        let series = Series {
            name: name.into(),
            count: 0,
            missing: 0,
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
            duration: 0.0,
            rate: None,
            gaps: 0,
            largest_gap: None,
            repeated: 0,
            backwards: 0,
            standstill: None,
        };
        let (first, last) = (f64::NAN, f64::NAN);
        Self { series, first, last, steps: Vec::new(), median: None, kept: Vec::new(), stride: 1 }
    }

    pub fn take(&mut self, time: f64, value: f64) {
        let series = &mut self.series;
        if !value.is_finite() || !time.is_finite() {
            series.missing += 1;
            return;
        }
        series.low = series.low.min(value);
        series.high = series.high.max(value);
        if series.count.is_multiple_of(self.stride) {
            if self.kept.len() == KEPT {
                let mut k = 0;
                self.kept.retain(|_| (k += 1, k % 2 == 1).1);
                self.stride *= 2;
            }
            self.kept.push([time, value]);
        }
        series.count += 1;
        if series.count == 1 {
            self.first = time;
        } else {
            self.step(time - self.last);
        }
        self.last = time;
    }

    fn step(&mut self, step: f64) {
        if step <= 0.0 {
            *(if step == 0.0 { &mut self.series.repeated } else { &mut self.series.backwards }) += 1;
            return;
        }
        if self.series.largest_gap.is_none_or(|[largest, _]| step > largest) {
            self.series.largest_gap = Some([step, self.last]);
        }
        if self.steps.len() < STEPS {
            self.steps.push(step);
            if self.steps.len() == STEPS {
                self.count_gaps();
            }
        } else if self.median.is_some_and(|median| step > GAP * median) {
            self.series.gaps += 1;
        }
    }

    /// The median of the first steps, and the gaps among them.
    fn count_gaps(&mut self) {
        self.steps.sort_unstable_by(f64::total_cmp);
        let Some(&median) = self.steps.get(self.steps.len() / 2) else { return };
        self.series.gaps = self.steps.iter().filter(|step| **step > GAP * median).count() as u64;
        self.median = Some(median);
    }

    /// What is known at the end; without a time there is no rate. `role` is what the signal measures, as far as its name
    /// says it.
    pub fn finish(mut self, timed: bool, role: Option<Role>) -> Series {
        if self.median.is_none() {
            self.count_gaps();
        }
        let mut series = self.series;
        if series.count == 0 {
            (series.low, series.high) = (0.0, 0.0);
            return series;
        }
        series.duration = self.last - self.first;
        if timed {
            series.rate = self.median.map(|median| 1.0 / median);
        } else {
            (series.gaps, series.largest_gap) = (0, None);
        }
        let speed = |pair: &[[f64; 2]]| ((pair[1][1] - pair[0][1]) / (pair[1][0] - pair[0][0])).abs();
        let speeds: Vec<f64> = match role {
            // A joint that stands needs a constant torque, and a constant torque may move it.
            Some(Role::Torque | Role::Current) => Vec::new(),
            Some(Role::Velocity) => self.kept.iter().map(|[_, value]| value.abs()).collect(),
            _ => self.kept.windows(2).map(speed).filter(|v| v.is_finite()).collect(),
        };
        let fastest = speeds.iter().copied().fold(0.0, f64::max);
        if fastest > 0.0 {
            let still = speeds.iter().filter(|v| **v < STILL * fastest).count();
            series.standstill = Some(still as f64 / speeds.len() as f64);
        }
        series
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_gaps_and_standstill_are_those_of_the_signal() {
        let mut watched = Watched::new("q1");
        for k in 0..20_000 {
            let gap = if k >= 15_000 { 0.3 } else { 0.0 };
            let t = 0.002 * f64::from(k) + gap;
            watched.take(t, if k < 10_000 { 0.5 } else { 0.5 + (t - 20.0) });
        }
        watched.take(39.0, f64::NAN);
        watched.take(39.0, 20.0);
        let series = watched.finish(true, Some(Role::Position));
        assert!((series.rate.unwrap_or(0.0) - 500.0).abs() < 1e-6);
        assert_eq!((series.count, series.missing, series.gaps, series.backwards), (20_001, 1, 1, 1));
        assert!(series.largest_gap.is_some_and(|[gap, after]| (gap - 0.302).abs() < 1e-9 && after < 30.0));
        assert!(series.standstill.is_some_and(|share| (0.4..0.6).contains(&share)), "{series:?}");
        assert_eq!((series.low, series.high > 20.0), (0.5, true));
    }

    #[test]
    fn speeds_and_positions_tell_of_a_standstill_and_torques_do_not() {
        let share = |role: Role, value: fn(u32) -> f64| {
            let mut watched = Watched::new("x");
            (0..1000).for_each(|k| watched.take(0.01 * f64::from(k), value(k)));
            watched.finish(true, Some(role)).standstill
        };
        let moves_late = |k: u32| if k < 500 { 0.0 } else { 1.0 + f64::from(k % 7) };
        assert!(share(Role::Velocity, moves_late).is_some_and(|share| (share - 0.5).abs() < 0.01));
        assert_eq!(share(Role::Velocity, |_| 1.0), Some(0.0), "a constant speed is no standstill");
        assert!(share(Role::Position, |_| 1.0).is_none_or(|share| share == 1.0));
        assert_eq!(share(Role::Torque, moves_late), None);
        assert_eq!(share(Role::Current, moves_late), None);
    }
}
