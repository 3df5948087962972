//! The part of a recording that the diagnosis never sees.

use dynid_runtime::diagnosis::{
    Diagnosis, Errors, Estimated, Settings, predict_errors, slowest_speeds, term_torques,
};
use dynid_runtime::effects::EffectTerm;
use dynid_runtime::estimation::choose_bandwidth;
use dynid_runtime::model::{Model, torques};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::{Butterworth, Preparation, prepare};

use crate::Failure;

/// Errors before and after, under one way of counting.
pub struct Counted {
    /// Which rows, in which band.
    pub how: String,
    /// Standard model.
    pub before: Errors,
    /// With the findings.
    pub after: Errors,
}

impl Counted {
    /// Error with the findings over that of the standard model.
    pub fn ratio(&self) -> f64 {
        self.after.relative_error / self.before.relative_error
    }
}

/// Errors on rows where joints move and on all rows, at 25 Hz and at 50 Hz, as far as the recording holds them.
pub fn errors(
    model: &dyn Model,
    found: &Diagnosis,
    fitted: &[Trajectory],
    test: &[Trajectory],
) -> Result<Vec<Counted>, Failure> {
    let settings = Settings::default();
    let slowest = slowest_speeds(model, fitted, &settings)?;
    let none = vec![0.0; slowest.len()];
    let held = choose_bandwidth(test)?.band;
    let mut bands: Vec<f64> = [25.0, 50.0].iter().map(|band: &f64| band.min(held)).collect();
    bands.dedup();
    let mut counted = Vec::new();
    for band in bands {
        // A Hann window of half-width T lets half of the amplitude through at 1 / (2 T).
        let mut settings = settings.clone();
        settings.fast_window = 0.5 / band;
        for (rows, slowest) in [("rows where the joint moves", &slowest), ("all rows", &none)] {
            let of = |parameters: &Estimated, terms: &[EffectTerm]| {
                predict_errors(model, parameters, terms, found.delay, test, slowest, &settings)
            };
            counted.push(Counted {
                how: format!("{rows}, {band} Hz"),
                before: of(&found.standard, &[])?,
                after: of(&found.model, &found.terms())?,
            });
        }
    }
    Ok(counted)
}

/// Torques of a motion, measured and predicted, below 25 Hz. `[joint][row]`.
pub struct Seen {
    /// Its name.
    pub motion: String,
    /// s.
    pub time: Vec<f64>,
    /// As recorded.
    pub measured: Vec<Vec<f64>>,
    /// Standard model.
    pub before: Vec<Vec<f64>>,
    /// With the findings.
    pub after: Vec<Vec<f64>>,
}

/// Band of the figures, Hz.
const BAND: f64 = 25.0;
/// Points a second of the figures.
const POINTS: f64 = 100.0;

/// The torques of a motion as both models predict them.
pub fn seen(model: &dyn Model, found: &Diagnosis, motion: &Trajectory) -> Result<Seen, Failure> {
    let rate = (motion.time.len() - 1) as f64 / (motion.time[motion.time.len() - 1] - motion.time[0]);
    let band = BAND.min(rate / 5.0);
    let prepared = prepare(motion, &Preparation { cutoff: Some(2.0 * band), ..Preparation::default() })?;
    let filter = Butterworth::low_pass(4, band, prepared.rate)?;
    let step = (prepared.rate / POINTS).floor().max(1.0) as usize;
    let samples = prepared.q[0].len();
    let rows: Vec<usize> = (prepared.spoiled..samples - prepared.spoiled).step_by(step).collect();
    let thin = |torques: &[Vec<f64>]| -> Result<Vec<Vec<f64>>, Failure> {
        torques
            .iter()
            .map(|x| {
                let smooth = filter.zero_phase(x)?;
                Ok(rows.iter().map(|&t| smooth[t]).collect())
            })
            .collect()
    };
    let mut after = torques(model, &found.model.chi, prepared.state_slices().states());
    let effects = term_torques(model, &found.model.chi, &found.terms(), &prepared)?;
    for (torque, effect) in after.iter_mut().flatten().zip(effects.iter().flatten()) {
        *torque += effect;
    }
    Ok(Seen {
        motion: motion.name.clone(),
        time: rows.iter().map(|&t| prepared.start + t as f64 / prepared.rate).collect(),
        measured: thin(&prepared.torque)?,
        before: thin(&torques(model, &found.standard.chi, prepared.state_slices().states()))?,
        after: thin(&after)?,
    })
}
