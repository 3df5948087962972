//! What every law must pass before it is named: evidence against the variation that is there anyway, and a size that
//! stands above what the robot's torques repeat to.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::companions::LEVELS;
use crate::diagnosis::candidates::trial::dense_columns;
use crate::diagnosis::judging::calibration::{Calibrated, Law, calibrate};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::judging::white_products::Background;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{LINE_COVERED, MOST_COMPARED, WAVE_SEEN, WITHOUT_ANY_UNIT};
use crate::diagnosis::search::bench::Size;
use crate::diagnosis::search::round::Ranked;
use crate::diagnosis::search::small_law::SmallLaw;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::settings::Settings;
use crate::effects::{Form, SmoothingWindow};
use crate::parallel;
use std::sync::OnceLock;

/// Whether rows let a law through. What repeats itself with its shape, as waves do, may be faster than the rows are: what is
/// left of it depends on where the joint happens to be slow, and any small torque there asks for a giant wave.
fn is_seen(candidate: &Candidate, design: &Design, columns: &[Vec<f64>]) -> bool {
    let (Form::Joint(law), Some(joint)) = (candidate.effect.form(), candidate.place.joint()) else {
        return true;
    };
    let rows = design.of_joint(joint);
    let acts = rows.clone().filter(|&r| columns.iter().any(|c| c[r] != 0.0)).count();
    // Sine and cosine of each wave: at the full rate their squares are one together.
    let squares: f64 = columns.iter().flat_map(|c| &c[rows.clone()]).map(|x| x * x).sum();
    let whole = acts as f64 * columns.len() as f64 / 2.0;
    !law.repeats_its_shape() || squares >= WAVE_SEEN * WAVE_SEEN * whole
}

/// What a law's evidence and size say.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) enum Outcome {
    /// It is there and large enough to be named.
    Passes {
        /// One minus the probability that any candidate comes as far by accident.
        confidence: f64,
        /// In standard errors.
        significance: f64,
        /// Its standard deviations are this many times those of a white residual without variation between units.
        inflation: f64,
    },
    /// It is there, and no larger than what the torques repeat to.
    Small(Size),
    /// Nothing shows that it is there.
    Fails,
}

/// A law's evidence and size.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Gate {
    /// In-sample gain in units of the noise variance, as if residuals were white.
    pub gain: f64,
    pub calibrated: Calibrated,
    pub size: Size,
    /// Residual of the model with it.
    pub left: Vec<f64>,
    /// Whether it is a law of time that rests on a single unit, and so an event for all that is known: whatever else happened
    /// then is not told from it.
    pub is_event: bool,
}

impl Gate {
    /// How many times those of a white residual without variation between units its standard deviations are.
    pub(super) fn inflation(&self) -> f64 {
        let squares = self.calibrated.squares / self.calibrated.lambda;
        (self.gain / squares.max(1e-300)).max(1.0).sqrt()
    }
}

/// What a round has worked out at one level: evidence of the model as it is on the rows of each window, and of each candidate.
pub(in crate::diagnosis) struct RoundEvidence {
    slow: OnceLock<Background>,
    fast: OnceLock<Background>,
    gates: Vec<OnceLock<Option<Gate>>>,
    /// Whether each is told from the simpler laws that it must be told from.
    pub(super) told: Vec<OnceLock<bool>>,
    /// Noise of the positions on the rows of compliant transmissions.
    pub(super) noise: OnceLock<Vec<Vec<f64>>>,
}

impl RoundEvidence {
    /// Of a round of so many candidates, nothing worked out yet.
    pub fn new(candidates: usize) -> Self {
        Self {
            slow: OnceLock::new(),
            fast: OnceLock::new(),
            gates: (0..candidates).map(|_| OnceLock::new()).collect(),
            told: (0..candidates).map(|_| OnceLock::new()).collect(),
            noise: OnceLock::new(),
        }
    }

    pub(super) fn of(&self, window: SmoothingWindow) -> &OnceLock<Background> {
        match window {
            SmoothingWindow::Slow => &self.slow,
            SmoothingWindow::Fast => &self.fast,
        }
    }
}

/// What of a law the design cannot make.
pub(super) struct OwnPart {
    /// In-sample gain in units of the noise variance.
    pub gain: f64,
    /// Its torque on all rows.
    pub change: Vec<f64>,
    /// Residual of the model with it.
    pub left: Vec<f64>,
}

/// The part of a candidate with one of its shapes that a regression's design cannot make; `None` where there is none.
pub(super) fn own_part(regression: &Regression, candidate: &Candidate, trial: usize) -> Option<OwnPart> {
    let (design, trial) = (&regression.design, &candidate.trials[trial]);
    let part = regression.fit.project_out(trial)?;
    let (amplitude, gain) = part.solve(candidate)?;
    let mut change = vec![0.0; design.rows.len()];
    for (column, a) in part.columns(design, trial).iter().zip(amplitude.iter()) {
        change.iter_mut().zip(column).for_each(|(s, c)| *s += a * c);
    }
    let left = regression.residual().iter().zip(&change).map(|(r, c)| r - c).collect();
    Some(OwnPart { gain, change, left })
}

impl Search<'_> {
    /// Evidence and size of a candidate of a round beside the model as it is, worked out once; `None` where it is no law.
    pub(super) fn gate<'b>(&self, round: &'b RoundEvidence, ranked: &[Ranked], k: usize) -> Option<&'b Gate> {
        self.gate_of_any(round, ranked, k).filter(|gate| !gate.is_event)
    }

    /// As [`Self::gate`], of events too.
    pub(super) fn gate_of_any<'b>(
        &self,
        round: &'b RoundEvidence,
        ranked: &[Ranked],
        k: usize,
    ) -> Option<&'b Gate> {
        round.gates[k].get_or_init(|| self.work_out(round, &ranked[k])).as_ref()
    }

    fn work_out(&self, against: &RoundEvidence, ranked: &Ranked) -> Option<Gate> {
        let (regression, candidate) = self.of(ranked);
        let (bench, design) = (self.model.bench(ranked.window), &regression.design);
        if self.stands_already(regression, candidate, ranked.verdict.trial) {
            return None;
        }
        let OwnPart { gain, change, left } = own_part(regression, candidate, ranked.verdict.trial)?;
        let columns = self.columns(ranked);
        if !is_seen(candidate, design, &columns) {
            return None;
        }
        let regressors = bench.regressors(design);
        let background = against.of(ranked.window).get_or_init(|| {
            Background::new(&bench.units, &regressors, &regression.residual(), self.threads())
        });
        let law = self.law(ranked, &columns, &left);
        let calibrated = calibrate(&bench.units, &regressors, background, &law)?;
        let is_event = candidate.is_trend()
            && !self.model.change
            && calibrated.evidence_without_any().confidence(1) < WITHOUT_ANY_UNIT;
        let size = bench.largest_size(design, &ranked.verdict.shows_on, &change, &left)?;
        Some(Gate { gain, calibrated, size, left, is_event })
    }

    /// Whether a law has waves that are no more than those of the reference with other phases. The phase of a wave of a motor
    /// may be another one after each start: the wave before and the wave now differ by up to twice its amplitude.
    fn stands_already(&self, regression: &Regression, candidate: &Candidate, trial: usize) -> bool {
        let (Form::Joint(law), Some(joint)) = (candidate.effect.form(), candidate.place.joint()) else {
            return false;
        };
        let standing: Vec<(f64, f64)> = (self.model.context.reference.iter())
            .flat_map(|reference| reference.effects())
            .filter(|term| term.effect == candidate.effect && term.place == candidate.place)
            .flat_map(|term| law.waves(&term.shape, &term.amplitude))
            .collect();
        if standing.is_empty() {
            return false;
        }
        let columns = &candidate.trials[trial];
        let part = regression.fit.project_out(columns);
        let Some((now, _)) = part.and_then(|part| part.solve(candidate)) else { return false };
        let near = LINE_COVERED as f64 * self.lines[joint].resolution;
        law.waves(&columns.shape, now.as_slice()).into_iter().any(|(order, size)| {
            let same = standing.iter().filter(|(own, _)| (order - own).abs() <= near);
            let before: f64 = same.map(|(_, size)| size).sum();
            before > 0.0 && size <= 2.0 * before
        })
    }

    /// A candidate of a round as columns over all rows, those of a baseline too.
    pub(super) fn columns(&self, ranked: &Ranked) -> Vec<Vec<f64>> {
        let (regression, candidate) = self.of(ranked);
        let shape = &candidate.trials[ranked.verdict.trial].shape;
        let context = &self.model.context;
        dense_columns(context, &regression.design, candidate.effect, candidate.place, shape, false)
    }

    /// The law of a candidate of a round, given its columns and what the model with it leaves.
    pub(super) fn law<'b>(&self, ranked: &Ranked, columns: &'b [Vec<f64>], residual: &'b [f64]) -> Law<'b> {
        let candidate = self.of(ranked).1;
        let properties = candidate.effect.properties();
        Law {
            columns,
            residual,
            common: self.model.change && properties.may_stand,
            is_trend: candidate.is_trend(),
            trend_of: if candidate.is_trend() && candidate.own.len() == 1 { LEVELS } else { 0 },
        }
    }

    /// What the gate makes of a candidate of a round at a level over all candidates.
    pub(in crate::diagnosis) fn judged_by_gate(
        &self,
        round: &RoundEvidence,
        ranked: &[Ranked],
        k: usize,
        least_confidence: f64,
    ) -> Outcome {
        let Some(gate) = self.gate(round, ranked, k) else { return Outcome::Fails };
        let calibrated = &gate.calibrated;
        let evidence = calibrated.evidence();
        let confidence = evidence.confidence(self.tries());
        if confidence < least_confidence || !self.is_new_bend(&ranked[k], gate, least_confidence) {
            return Outcome::Fails;
        }
        // Without a baseline that is judged beside all laws that were found (`prominence`).
        if self.model.change && gate.size.law < gate.size.needed {
            return Outcome::Small(gate.size);
        }
        Outcome::Passes { confidence, significance: evidence.significance, inflation: gate.inflation() }
    }

    /// Laws that are certainly there beside the model as it is, and too small to be named.
    pub(in crate::diagnosis) fn small(&self, settings: &Settings) -> Vec<SmallLaw> {
        if !self.model.change {
            return self.small.clone();
        }
        let mut ranked = self.ranked(None);
        ranked.retain(|r| r.verdict.total() > 0.0 && r.verdict.fitted_fraction > 0.0);
        ranked.truncate(MOST_COMPARED);
        let round = RoundEvidence::new(ranked.len());
        let outcomes = parallel::map(self.threads(), ranked.len(), |k| {
            self.judged_by_gate(&round, &ranked, k, settings.least_confidence)
        });
        let mut small = self.small.clone();
        for (r, outcome) in ranked.iter().zip(outcomes) {
            let Outcome::Small(size) = outcome else { continue };
            let candidate = self.of(r).1;
            // The first for a joint is the one that explains most of it.
            if small.iter().all(|s| s.own != candidate.own) {
                small.push(SmallLaw {
                    effect: candidate.effect,
                    place: candidate.place,
                    own: candidate.own.clone(),
                    size,
                });
            }
        }
        small
    }
}
