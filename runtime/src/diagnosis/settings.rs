//! What a diagnosis can be told, and what it tells while it works.

use super::error::DiagnosisError;
use super::reference::Reference;
use super::rules;
use crate::effects::{EffectKind, Place, UserLaw};
use crate::estimation::choose_bandwidth;
use crate::recording::Trajectory;
use std::sync::Arc;

/// Settings of a diagnosis. None of them knows a robot: speeds and travels count relative to the joint's own, unless
/// absolute speeds are given.
///
/// ```
/// use dynid_runtime::diagnosis::Settings;
///
/// let mut settings = Settings::default();
/// settings.threads = 1;
/// settings.band = Some(15.0);
/// assert_eq!(settings.cutoff, None);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Half-width of the smoothing for effects that are as slow as the motion, s.
    pub slow_window: f64,
    /// Half-width of the smoothing for effects faster than the motion (ripple, elasticity, backlash), s.
    pub fast_window: f64,
    /// Rows where a joint is slower than this fraction of its top speed are left out: sign(v) is noise there.
    pub standstill: f64,
    /// Least share of a joint's unexplained held-out energy that an effect must explain to be named.
    pub least_share: f64,
    /// Least confidence that something is missing at all: one minus the probability that any of all candidates comes as far by
    /// accident. Beside a first law the probability may be twice as large.
    pub least_confidence: f64,
    /// Most effects that are named.
    pub most_effects: usize,
    /// Highest frequency of the rows, Hz: the smoothing lets half of the amplitude through there. `None`: chosen from
    /// the recording's own noise ([`choose_bandwidth`]), and never above what the two windows let through.
    ///
    /// A given band replaces the fast window by 0.5 / band and widens the slow one where it would let more through.
    /// The rows are half a window apart, so that their number a second follows from the band: there is no rate to set.
    pub band: Option<f64>,
    /// Cut-off of the filter of positions and torques, Hz. `None`: that of the band, at most 60 Hz.
    pub cutoff: Option<f64>,
    /// Speeds below which the joints count as standing still, one per joint, rad/s or m/s; used for all rows instead of
    /// `standstill`. Speed 0 keeps every row where a joint's speed does not change its sign within the window.
    pub standstill_speeds: Option<Vec<f64>>,
    /// Whether pushes that stand out of what the search leaves are looked for, on single joints or several.
    pub single_joint_contacts: bool,
    /// Laws at places that are not tried, because other evidence speaks against them.
    pub excluded: Vec<(EffectKind, Place)>,
    /// Laws at places that are not named and stay rivals of others: other evidence neither shows nor excludes them, and what
    /// could be told from them only by their absence is not told from them.
    pub only_rivals: Vec<(EffectKind, Place)>,
    /// Laws that the user wrote down: tried beside those of the catalogue.
    pub laws: Vec<UserLaw>,
    /// A model of the robot before it changed, in the place of a baseline: what it explains is not looked for.
    pub reference: Option<Arc<Reference>>,
    /// Threads; 0: as many as the machine has. The outcome does not depend on them.
    pub threads: usize,
}

/// Cut-off of the position filter, and settings whose windows let through no more than the recording's band.
pub(super) fn fitted_to(
    settings: &Settings,
    trajectories: &[Trajectory],
) -> Result<(f64, Settings), DiagnosisError> {
    let mut fitted = settings.clone();
    // A Hann window of half-width T lets half of the amplitude through at 1 / (2 T).
    let cutoff = match settings.band {
        Some(band) if band > 0.0 && band.is_finite() => {
            fitted.fast_window = 0.5 / band;
            fitted.slow_window = fitted.slow_window.max(fitted.fast_window);
            2.0 * band
        }
        Some(band) => return Err(DiagnosisError::Setting { option: "band", value: band }),
        None => {
            let chosen = choose_bandwidth(trajectories)?;
            let least = 0.5 / chosen.band.max(1e-6);
            fitted.slow_window = fitted.slow_window.max(least);
            fitted.fast_window = fitted.fast_window.max(least);
            chosen.cutoff
        }
    };
    match settings.cutoff {
        Some(cutoff) if cutoff > 0.0 && cutoff.is_finite() => Ok((cutoff, fitted)),
        Some(cutoff) => Err(DiagnosisError::Setting { option: "cutoff", value: cutoff }),
        None => Ok((cutoff.min(rules::HIGHEST_CUTOFF), fitted)),
    }
}

/// Speeds of standstill that were given, checked.
pub(super) fn given_speeds(settings: &Settings, joints: usize) -> Result<Option<Vec<f64>>, DiagnosisError> {
    let Some(speeds) = &settings.standstill_speeds else { return Ok(None) };
    if speeds.len() != joints {
        return Err(DiagnosisError::StandstillSpeeds { given: speeds.len(), joints });
    }
    match speeds.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        Some(&value) => Err(DiagnosisError::Setting { option: "standstill", value }),
        None => Ok(Some(speeds.clone())),
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            slow_window: rules::SLOW_WINDOW,
            fast_window: rules::FAST_WINDOW,
            standstill: rules::STANDSTILL,
            least_share: rules::LEAST_EXPLAINED_FRACTION,
            least_confidence: rules::LEAST_CONFIDENCE,
            most_effects: rules::MOST_EFFECTS,
            band: None,
            cutoff: None,
            standstill_speeds: None,
            single_joint_contacts: true,
            excluded: Vec::new(),
            only_rivals: Vec::new(),
            laws: Vec::new(),
            reference: None,
            threads: 2,
        }
    }
}

impl Settings {
    /// The same for what is looked for beside a law that is in the model: that something is missing is certain then.
    pub(super) fn beside_laws(&self) -> Self {
        Self { least_confidence: self.confidence_at(rules::LEVEL_BESIDE_LAWS), ..self.clone() }
    }

    /// Whether a law at a place may be named.
    pub(super) fn may_name(&self, effect: EffectKind, place: Place) -> bool {
        !self.excluded.contains(&(effect, place)) && !self.only_rivals.contains(&(effect, place))
    }

    /// The confidence that one law of a model needs, so that something is missing for certain.
    pub(super) fn confidence_of_first(&self, effect: EffectKind) -> f64 {
        match effect {
            EffectKind::FreeForm => self.least_confidence,
            _ => self.confidence_at(rules::LEVEL_OF_CATALOGUE),
        }
    }

    /// The confidence that a law needs to stay, less than to be taken: its variation is estimated anew in each round.
    pub(super) fn confidence_to_stay(&self) -> f64 {
        self.confidence_at(rules::LEVEL_TO_STAY)
    }

    /// The confidence that a law of the catalogue needs which a search of its own finds, of those that share the level.
    pub(super) fn confidence_of_one_search(&self) -> f64 {
        self.confidence_at(rules::LEVEL_OF_CATALOGUE / rules::SEARCHES)
    }

    /// The confidence at so many times the level.
    fn confidence_at(&self, times: f64) -> f64 {
        1.0 - (times * (1.0 - self.least_confidence)).min(0.5)
    }
}

/// Told how far a diagnosis is.
pub trait Progress: Sync {
    /// `done` in 0..=1 of the whole, and what is being done.
    fn at(&self, done: f64, what: &str);
}

/// Tells nobody.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn at(&self, _: f64, _: &str) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beside_a_law_a_higher_level_is_enough_and_to_stay_less_still() {
        let first = Settings::default();
        let next = first.beside_laws();
        let level = |settings: &Settings| 1.0 - settings.least_confidence;
        let times = rules::LEVEL_BESIDE_LAWS;
        approx::assert_relative_eq!(level(&next), times * level(&first), max_relative = 1e-9);
        assert!(times > 1.0);
        assert!(next.confidence_to_stay() < next.least_confidence);
        assert_eq!(first.confidence_of_first(EffectKind::FreeForm), first.least_confidence);
        assert!(first.confidence_of_first(EffectKind::Spring) > first.least_confidence);
        assert_eq!(
            Settings { least_confidence: 0.0, ..Settings::default() }.beside_laws().least_confidence,
            0.5
        );
    }
}
