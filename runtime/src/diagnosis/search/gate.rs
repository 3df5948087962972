//! What every law must pass before it is named: evidence against the variation that is there anyway, and a size that
//! stands above what the robot's torques repeat to.

use crate::diagnosis::candidates::trial::dense_columns;
use crate::diagnosis::judging::calibration::{Background, Calibrated, Regressors, calibrate, rival_p_value};
use crate::diagnosis::rules::{COMPARABLE, MOST_COMPARED, TOLD_APART};
use crate::diagnosis::search::bench::Size;
use crate::diagnosis::search::round::Ranked;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, Place, SmoothingWindow};
use crate::parallel;
use std::sync::OnceLock;

/// What a number must gain where the best of so many candidates is taken (Foster and George 1994).
fn penalty(candidates: usize) -> f64 {
    2.0 * (candidates.max(2) as f64).ln()
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

/// A law that is there and too small to be named.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct SmallLaw {
    pub effect: EffectKind,
    pub place: Place,
    pub own: Vec<usize>,
    pub size: Size,
}

/// How a candidate stands against rivals on other joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::diagnosis) enum Standing {
    /// It explains more than each of them, and not by accident.
    Ahead,
    /// It cannot be told from this one of the round.
    Tied(usize),
    /// One of them explains more.
    Beaten,
}

/// A law's evidence and size.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Gate {
    /// In-sample gain in units of the noise variance, as if residuals were white.
    pub gain: f64,
    pub calibrated: Calibrated,
    pub size: Size,
}

/// What a round's evidence is worked out beside, on the rows of each window.
#[derive(Default)]
pub(in crate::diagnosis) struct Backgrounds {
    slow: OnceLock<Background>,
    fast: OnceLock<Background>,
}

impl Backgrounds {
    fn of(&self, window: SmoothingWindow) -> &OnceLock<Background> {
        match window {
            SmoothingWindow::Slow => &self.slow,
            SmoothingWindow::Fast => &self.fast,
        }
    }
}

impl Search<'_> {
    /// Evidence and size of a candidate of a round beside the model as it is.
    fn gate(&self, against: &Backgrounds, ranked: &Ranked) -> Option<Gate> {
        let (regression, candidate) = self.of(ranked);
        let (model, bench) = (&self.model, self.model.bench(ranked.window));
        let design = &regression.design;
        let trial = &candidate.trials[ranked.verdict.trial];
        let part = regression.fit.project_out(trial)?;
        let (amplitude, gain) = part.solve(candidate)?;
        let before = regression.residual();
        let mut change = vec![0.0; design.rows.len()];
        for (column, a) in part.columns(design, trial).iter().zip(amplitude.iter()) {
            change.iter_mut().zip(column).for_each(|(s, c)| *s += a * c);
        }
        let left: Vec<f64> = before.iter().zip(&change).map(|(r, c)| r - c).collect();
        let law =
            dense_columns(&model.context, design, candidate.effect, candidate.place, &trial.shape, false);
        let regressors = Regressors {
            shared: &design.columns,
            y: &design.y,
            free: &bench.free,
            of_joint: &bench.of_joint,
        };
        let common = model.change && candidate.effect.properties().standing_friction;
        let background = against
            .of(ranked.window)
            .get_or_init(|| Background::new(&bench.units, &regressors, &before, self.threads));
        let calibrated = calibrate(&bench.units, &regressors, background, &law, &left, common)?;
        let sizes = candidate.own.iter().map(|&j| bench.size(design, j, &change, &left));
        let size = sizes.max_by(|a, b| (a.law / a.repeats).total_cmp(&(b.law / b.repeats)))?;
        Some(Gate { gain, calibrated, size })
    }

    /// How a candidate of a round stands against rivals on other joints, which reach it through the parameters that
    /// joints share: by what they explain of all joints in a residual made white.
    pub(in crate::diagnosis) fn standing(
        &self,
        against: &Backgrounds,
        ranked: &[Ranked],
        candidate: usize,
    ) -> Standing {
        let law = self.of(&ranked[candidate]).1;
        let Some(own) = self.gate(against, &ranked[candidate]) else { return Standing::Beaten };
        let (gain, window) = (ranked[candidate].verdict.gain, ranked[candidate].window);
        let mut rivals: Vec<usize> = (0..ranked.len())
            .filter(|&k| ranked[k].window == window && ranked[k].verdict.gain > COMPARABLE * gain)
            .filter(|&k| self.of(&ranked[k]).1.own.iter().all(|j| !law.own.contains(j)))
            .collect();
        rivals.sort_by(|&a, &b| ranked[b].verdict.gain.total_cmp(&ranked[a].verdict.gain));
        rivals.truncate(MOST_COMPARED);
        let gates = parallel::map(self.threads, rivals.len(), |k| self.gate(against, &ranked[rivals[k]]));
        let penalty = penalty(self.tries());
        let worth = |c: &Calibrated| c.squares - penalty * c.numbers as f64;
        let mut standing = Standing::Ahead;
        for (&k, other) in rivals.iter().zip(&gates) {
            let Some(other) = other else { continue };
            let ahead = worth(&own.calibrated) - worth(&other.calibrated);
            if ahead < -penalty {
                return Standing::Beaten;
            }
            if rival_p_value(&own.calibrated, ahead) > TOLD_APART {
                standing = Standing::Tied(k);
            }
        }
        standing
    }

    /// What the gate makes of a candidate at a level over `tries` candidates.
    pub(in crate::diagnosis) fn judged_by_gate(
        &self,
        against: &Backgrounds,
        ranked: &Ranked,
        tries: usize,
        least_confidence: f64,
    ) -> Outcome {
        let Some(gate) = self.gate(against, ranked) else { return Outcome::Fails };
        let calibrated = &gate.calibrated;
        let evidence = calibrated.evidence(calibrated.lambda);
        let confidence = evidence.confidence(tries);
        if confidence < least_confidence {
            return Outcome::Fails;
        }
        if gate.size.law < gate.size.repeats {
            return Outcome::Small(gate.size);
        }
        let squares = calibrated.squares / calibrated.lambda;
        Outcome::Passes {
            confidence,
            significance: evidence.significance,
            inflation: (gate.gain / squares.max(1e-300)).max(1.0).sqrt(),
        }
    }

    /// Laws that are certainly there beside the model as it is, and too small to be named.
    pub(in crate::diagnosis) fn small(&self, settings: &Settings) -> Vec<SmallLaw> {
        if !self.model.calibrated {
            return Vec::new();
        }
        let mut ranked = self.ranked(None);
        ranked.retain(|r| r.verdict.total() > 0.0 && r.verdict.fitted_fraction > 0.0);
        ranked.truncate(MOST_COMPARED);
        let against = Backgrounds::default();
        let outcomes = parallel::map(self.threads, ranked.len(), |k| {
            self.judged_by_gate(&against, &ranked[k], self.tries(), settings.least_confidence)
        });
        let mut small: Vec<SmallLaw> = Vec::new();
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
