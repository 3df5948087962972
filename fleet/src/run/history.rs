//! How much the errors of each robot had risen on earlier days, and what that predicts of the next one.
//!
//! A reference is one day, and a robot differs from day to day: friction follows temperature. Errors with the parameters of
//! another day are larger by this alone, by as much as the robot's own earlier days show.

use std::collections::BTreeMap;

use datafusion::arrow::array::RecordBatch;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::folder::OutFolder;
use super::rows::{number, screening_schema, text};
use super::tables;
use crate::day::Day;
use crate::error::Result;

/// Days that are needed before one can be news: of fewer nobody knows how much they vary.
const LEAST_DAYS: usize = 3;

/// Chance that a day of a robot that only varies as before is beyond what its earlier days predict. One diagnosis in vain in a
/// hundred days is cheap, and has gates of its own against naming anything.
const LEVEL: f64 = 0.01;

/// A ratio nearer to 1 than this is of the reference's own recordings, whose errors are what they are compared with.
const OWN: f64 = 1e-6;

/// For each day and robot the largest ratio of errors.
#[derive(Debug, Default)]
pub struct History(BTreeMap<Day, BTreeMap<String, f64>>);

impl History {
    /// That of the days that are done.
    ///
    /// # Errors
    /// A table that is none.
    pub fn read(out: &OutFolder) -> Result<Self> {
        let mut history = Self::default();
        for day in out.days("screening") {
            if let Some(screening) = tables::read(&out.of_day("screening", day), &screening_schema())? {
                history.add(day, &screening);
            }
        }
        Ok(history)
    }

    /// Takes in a day.
    pub fn add(&mut self, day: Day, screening: &RecordBatch) {
        let mut largest = BTreeMap::new();
        for k in 0..screening.num_rows() {
            if let (Some(robot), Some(rise)) = (text(screening, "robot", k), number(screening, "rise", k)) {
                let own = largest.entry(robot.to_owned()).or_insert(rise);
                *own = rise.max(*own);
            }
        }
        self.0.insert(day, largest);
    }

    /// The ratio up to which a day of a robot is as its earlier days predict; `None` where they are too few.
    ///
    /// The upper limit of a prediction interval for one more of k logarithms, mean + t s sqrt(1 + 1/k). Their variance is that of
    /// successive differences (von Neumann 1941), which a slow drift does not inflate, worth two thirds of the degrees of
    /// freedom.
    pub fn predicted(&self, robot: &str, day: Day) -> Option<f64> {
        let before = self.0.range(..day).filter_map(|(_, robots)| robots.get(robot));
        let logs: Vec<f64> = before.filter(|rise| **rise > 1.0 + OWN).map(|rise| rise.ln()).collect();
        if logs.len() < LEAST_DAYS {
            return None;
        }
        let count = logs.len() as f64;
        let mean = logs.iter().sum::<f64>() / count;
        let squares: f64 = logs.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
        let variance = squares / (2.0 * (count - 1.0));
        let t = StudentsT::new(0.0, 1.0, 2.0 / 3.0 * (count - 1.0)).ok()?.inverse_cdf(1.0 - LEVEL);
        Some((mean + t * (variance * (1.0 + 1.0 / count)).sqrt()).exp())
    }

    /// The largest ratio of a robot before a day, at least 1.
    pub fn before(&self, robot: &str, day: Day) -> f64 {
        self.0
            .range(..day)
            .filter_map(|(_, robots)| robots.get(robot))
            .fold(1.0, |largest, rise| rise.max(largest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    fn history(ratios: impl IntoIterator<Item = f64>) -> History {
        let day = |(day, ratio)| (day, BTreeMap::from([("r".to_owned(), ratio)]));
        History((0..).zip(ratios).map(day).collect())
    }

    #[test]
    fn a_day_like_those_before_is_rarely_beyond_what_they_predict() {
        let mut random = Pcg64::seed_from_u64(5);
        for days in [3, 6, 20] {
            let mut beyond = 0;
            for _ in 0..4000 {
                let mut draw = || {
                    let z: f64 = StandardNormal.sample(&mut random);
                    (0.4 + 0.1 * z).exp()
                };
                let past = history((0..days).map(|_| draw()));
                beyond += i32::from(past.predicted("r", days).is_some_and(|limit| draw() > limit));
            }
            assert!((10..=80).contains(&beyond), "{beyond} of 4000 after {days} days");
        }
    }

    #[test]
    fn nothing_is_predicted_from_the_reference_itself_and_from_few_days() {
        assert_eq!(history([1.0, 1.2, 1.3]).predicted("r", 9), None);
        assert!(history([1.0, 1.2, 1.3, 1.25]).predicted("r", 9).is_some_and(|limit| limit > 1.3));
        assert_eq!(history([1.0, 1.2, 1.3, 1.25]).predicted("r", 3), None);
    }

    #[test]
    fn what_goes_on_rising_is_beyond_what_was() {
        let past = history((0..20).map(|k| 1.1 + 0.1 * f64::from(k)));
        assert!(past.predicted("r", 20).is_some_and(|limit| limit < 3.1), "{:?}", past.predicted("r", 20));
    }
}
