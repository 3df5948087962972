//! What drifts, jumps or differs in a fleet of robots.
//!
//! Daily estimates of each robot's parameters go in; trends and alarms come out. No file is read or written, nothing is
//! drawn at random: the same input gives the same output, in whatever order the series are given, and the alarms of a day
//! are those that would have been raised on it, whatever came later.
//!
//! ```text
//! Series -> clean -> days, one after the other (fleet)
//!    calibration   temperature, load, what siblings share on a day (covariates); variation and its memory (dispersion)
//!    every day     prediction (filter) -> evidence of a change (evidence); level against siblings (siblings)
//!                  -> which series are alarmed (discoveries) -> Alarm
//! whole series  -> monotone trend (trend), change of level (change) -> Trend
//! Trends, alarms -> fleet.html, a page for each robot (page)
//! ```
//!
//! ```
//! use dynid_fleet_watch::{Observation, Series, Settings, watch};
//!
//! // Thirty quiet days, then a jump by twenty times what the estimates vary.
//! let value = |day: i64| 5.0 + 0.1 * ((day * 7) % 5) as f64 + if day >= 30 { 3.0 } else { 0.0 };
//! let observations = (0..60)
//!     .map(|day| Observation { day, value: value(day), sigma: 0.1, temperature: None, load: None })
//!     .collect();
//! let name = |text: &str| text.to_owned();
//! let series = Series { robot: name("7"), table: name("arm"), parameter: name("Fc2"), unit: name("N.m"), observations };
//! let watched = watch(&[series], &Settings::default());
//! assert_eq!(watched.alarms.len(), 1);
//! assert_eq!(watched.alarms[0].began, 30);
//! ```

mod alarm;
mod calendar;
mod change;
mod clean;
mod covariates;
mod discoveries;
mod dispersion;
mod evidence;
mod filter;
mod fleet;
mod meanwhile;
mod member;
mod memory;
mod page;
mod robust;
mod settings;
mod siblings;
mod summary;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod trend;
mod types;
mod words;

pub use page::{FindingFact, Labels, Pages, RecordingFact, RobotFacts};
pub use settings::Settings;
pub use types::{Alarm, Kind, Observation, Series, SiblingComparison, Trend, Watched};
pub use words::{plus_minus, signed, significant};

/// Trends and alarms of a fleet.
///
/// Series with fewer days than [`Settings::calibration_days`] give neither. Settings outside of their range count as the
/// nearest inside it.
pub fn watch(series: &[Series], settings: &Settings) -> Watched {
    let mut fleet = fleet::Fleet::new(series, settings);
    fleet.run();
    let trends = summary::trends(&fleet);
    Watched { trends, alarms: fleet.alarms }
}
