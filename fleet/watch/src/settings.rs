//! What a user may set.

/// How a fleet is watched.
///
/// ```
/// let settings = dynid_fleet_watch::Settings { false_discoveries: 0.01, ..Default::default() };
/// # assert!(settings.calibration_days > 3);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Expected fraction of false alarms among all alarms raised up to any day, in (0, 1).
    pub false_discoveries: f64,
    /// Days with an estimate that a series needs before it is watched; at least 6. With 14, the level of a robot is known
    /// to a third of its day-to-day variation, and its variation to a fifth.
    pub calibration_days: usize,
    /// Fraction of days that tell nothing about the robot (a wrong payload mounted, a recording gone wrong), in (0, 0.5).
    /// It bounds what a single day can prove.
    pub outlier_days: f64,
    /// Siblings with an estimate on the same day, from which on what is common to all of them is taken out and a robot's
    /// level is compared with theirs; at least 3.
    pub least_siblings: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { false_discoveries: 0.05, calibration_days: 14, outlier_days: 0.02, least_siblings: 8 }
    }
}
