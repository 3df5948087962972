//! The stages of a diagnosis, one after the other: signals, contacts, candidates and search, explanations.

use super::contact::search::Contacts;
use super::contact::standing;
use super::error::{DiagnosisError, SingularDesign};
use super::explanation::explain::{Ended, explain, small};
use super::explanation::standard_model::StandardModelFit;
use super::explanation::standstill;
use super::judging::passage::Elsewhere;
use super::large_error::LargeError;
use super::objection::{Objection, harmful, no_larger_than_accidents};
use super::outcome::{Diagnosis, Sampling};
use super::preparation::{Prepared, nothing_moves};
use super::pushes::Pushes;
use super::rate::LAW;
use super::reference::Reference;
use super::rows::fit::Fit;
use super::rules::RECURRING;
use super::search::extended_model::ExtendedModel;
use super::search::report::SearchReport;
use super::search::state::Search;
use super::settings::{Progress, Settings};
use crate::effects::{EffectKind, Place};
use crate::far_off::Number;
use crate::model::Model;
use crate::recording::Trajectory;
use std::sync::Arc;

/// What is diagnosed, and the same robot before it changed.
pub(super) struct Recordings<'a> {
    pub trajectories: &'a [Trajectory],
    pub baseline: &'a [Trajectory],
}

/// What is not to be named, given a diagnosis, because other evidence speaks against it; that may write down what it saw. Nothing
/// where it has no objection.
pub(crate) type Objections<'o> = dyn FnMut(&mut Diagnosis) -> Vec<Objection> + 'o;

/// Prepares, sets pushes aside, searches, explains; where `known` effects are given, fits them and searches nothing.
/// What there are `objections` to is searched for no more, until there are none.
pub(super) fn run(
    model: &dyn Model,
    recordings: Recordings<'_>,
    known: Option<&[(EffectKind, Option<usize>)]>,
    mut objections: Option<&mut Objections<'_>>,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Diagnosis, DiagnosisError> {
    // 0. What was missing before already is no change.
    let before =
        known.is_none().then(|| known_before(model, recordings.baseline, settings, progress)).flatten();
    let with_reference = before.map(|reference| Settings { reference: Some(reference), ..settings.clone() });
    let settings = with_reference.as_ref().unwrap_or(settings);
    let progress =
        &Part { of: progress, from: if with_reference.is_some() { BASELINE } else { 0.0 }, to: 1.0 };

    // 1. Band, motions, checks, skew.
    progress.at(0.0, "signals");
    let prepared = Prepared::new(model, recordings.trajectories, recordings.baseline, settings)?;
    let change = !recordings.baseline.is_empty() || settings.reference.is_some();
    if !prepared.moving.judged.contains(&true) {
        return at_rest(model, &prepared);
    }

    // 2. Windows in which something outside pushed the robot.
    progress.at(0.05, "contacts");
    let mut pushes = Pushes::found(model, &prepared, change)?;

    let mut settings = prepared.motions.settings().clone();
    settings.excluded.extend(prepared.rate.iter().map(|_| LAW));
    let course = Course { model, prepared: &prepared, change, known, progress };
    loop {
        // Neither a law nor a push is named for what shows once and may be an accident.
        settings.excluded.extend(pushes.take_accidents().iter().map(|o| (o.effect, o.place)));
        let objections = objections.as_mut().map(|o| &mut **o as &mut Objections<'_>);
        if let Some(diagnosis) = course.on_rows_outside(&mut pushes, objections, &mut settings)? {
            progress.at(1.0, "done");
            return Ok(diagnosis);
        }
    }
}

/// Share of a diagnosis that its baseline takes.
const BASELINE: f64 = 0.4;

/// A part of what is told of the progress of the whole.
struct Part<'p> {
    of: &'p dyn Progress,
    from: f64,
    to: f64,
}

impl Progress for Part<'_> {
    fn at(&self, done: f64, what: &str) {
        self.of.at(self.from + (self.to - self.from) * done, what);
    }
}

/// The model that a diagnosis of the baseline ends with, laws that are missing there too; `None` without a baseline, where a
/// model is known already, and where the baseline alone supports no diagnosis.
fn known_before(
    model: &dyn Model,
    baseline: &[Trajectory],
    settings: &Settings,
    progress: &dyn Progress,
) -> Option<Arc<Reference>> {
    if baseline.is_empty() || settings.reference.is_some() {
        return None;
    }
    let progress = Part { of: progress, from: 0.0, to: BASELINE };
    let recordings = Recordings { trajectories: baseline, baseline: &[] };
    let before = run(model, recordings, None, None, settings, &progress).ok()?;
    Reference::of(&before).map(Arc::new)
}

/// What does not change in the course of a diagnosis.
struct Course<'a> {
    model: &'a dyn Model,
    prepared: &'a Prepared,
    /// Whether only what changed is looked for.
    change: bool,
    known: Option<&'a [(EffectKind, Option<usize>)]>,
    progress: &'a dyn Progress,
}

impl<'a> Course<'a> {
    /// Searches and explains on the rows outside of pushes; `None` where what was found shows that other rows are outside.
    fn on_rows_outside(
        &self,
        pushes: &mut Pushes,
        mut objections: Option<&mut Objections<'_>>,
        settings: &mut Settings,
    ) -> Result<Option<Diagnosis>, DiagnosisError> {
        // 3. Rows outside of these windows; all candidates on them; effects join the model while one holds.
        self.progress.at(0.1, "candidates");
        let mut begun = self.begin(pushes.set_aside().as_ref(), settings)?;
        // Where something is said against what was found, the search goes on from here.
        let without_effects = self.known.is_none().then(|| begun.search.model.clone());
        let may_be = |error: &&LargeError| {
            let is_excluded = |(number, ..): &(Number, _, _)| settings.excluded.contains(&number.law());
            self.known.is_none() && !error.numbers.iter().any(is_excluded)
        };
        if let Some(error) = self.prepared.large_error.as_ref().filter(may_be) {
            begun.search.take_large_error(error)?;
        }
        loop {
            // 4. What looked like pushes from outside may be explained by what is now in the model: then once more.
            let Some(report) = self.searched(&mut begun.search, pushes, settings)? else { return Ok(None) };

            // 5. What shows in one passage only may be a push, if nothing else speaks against it.
            let mut in_their_place = pushes.clone();
            let refuted = self.refuted(&begun.search, &mut in_their_place, settings)?;

            // 6. Numbers, errors, curves, sentences.
            self.progress.at(0.92, "explanations");
            let mut diagnosis = self.explained(&mut begun, report, pushes, settings)?;

            // 7. What harms, or other evidence speaks against, is left out, and the search goes on.
            let mut objected = harmful(&diagnosis);
            objected.extend(no_larger_than_accidents(&diagnosis));
            if objected.is_empty() {
                objected = objections.as_mut().map_or_else(Vec::new, |object| object(&mut diagnosis));
            }
            if objected.is_empty() {
                let Some(refuted) = refuted else {
                    *pushes = in_their_place;
                    return Ok(None);
                };
                objected = refuted;
            }
            let Some(model) = without_effects.as_ref().filter(|_| !objected.is_empty()) else {
                return Ok(Some(diagnosis));
            };
            for objection in &objected {
                let Objection { effect, place, still_possible } = *objection;
                let list = if still_possible { &mut settings.only_rivals } else { &mut settings.excluded };
                list.push((effect, place));
            }
            // What such a law explained instead of pushes is pushes again.
            if objected.iter().any(|o| o.effect.form().is_curve()) && pushes.come_back() {
                return Ok(None);
            }
            begun.search.go_on_without(&objected, model.clone())?;
        }
    }

    /// All that holds; `None` where pushes differ beside it.
    fn searched(
        &self,
        search: &mut Search<'_>,
        pushes: &mut Pushes,
        settings: &Settings,
    ) -> Result<Option<SearchReport>, DiagnosisError> {
        let mut report = match self.known {
            Some(known) => search.force(known)?,
            None => search.run(settings, self.progress)?,
        };
        let before = pushes.clone();
        if pushes.differ_beside(self.model, self.prepared, search, settings) {
            let Some(of_law) = self.law_in_their_place(search, pushes, before, settings)? else {
                return Ok(None);
            };
            report = of_law;
        }
        // What something outside did is no law over some variable: those are looked for without it.
        if self.known.is_none() && !search.beyond_catalogue {
            search.beyond_catalogue = true;
            let laws = |search: &Search<'_>| -> Vec<(EffectKind, Place)> {
                search.model.terms.iter().map(|t| (t.effect, t.place)).collect()
            };
            let found = laws(search);
            report = search.run(settings, self.progress)?;
            if laws(search) != found && pushes.differ_beside(self.model, self.prepared, search, settings) {
                return Ok(None);
            }
        }
        if self.known.is_none() {
            search.keep_transients(settings)?;
        }
        Ok(Some(report))
    }

    /// A law over any variables that leaves few of the pushes on single joints which were found, looked for with their rows:
    /// what comes back with the state of the robot is no push. `before` is what was known of pushes before they were found;
    /// `None` where there is no such law, or other rows are set aside beside it.
    fn law_in_their_place(
        &self,
        search: &mut Search<'_>,
        pushes: &mut Pushes,
        before: Pushes,
        settings: &Settings,
    ) -> Result<Option<SearchReport>, DiagnosisError> {
        if self.known.is_some() || search.beyond_catalogue || pushes.of_single_joints() < RECURRING {
            return Ok(None);
        }
        search.beyond_catalogue = true;
        let report = search.run(settings, self.progress)?;
        let mut left = before;
        let differ = left.differ_beside(self.model, self.prepared, search, settings);
        if left.of_single_joints() > pushes.of_single_joints() / RECURRING {
            return Ok(None);
        }
        pushes.give_way(left);
        Ok((!differ).then_some(report))
    }

    /// Laws that show in one passage only, and that the rest of the motion refutes; `None` where a push explains one of those that
    /// show in one passage nearly as well. A push is the last explanation: before it come all laws that the rest does not refute.
    fn refuted(
        &self,
        search: &Search<'_>,
        pushes: &mut Pushes,
        settings: &Settings,
    ) -> Result<Option<Vec<Objection>>, SingularDesign> {
        if self.known.is_some() {
            return Ok(Some(Vec::new()));
        }
        let laws = search.of_single_passages()?;
        let refuted = |in_catalogue: bool| -> Vec<Objection> {
            let terms = laws.iter().filter(|(_, passage)| passage.elsewhere == Elsewhere::Refutes);
            let terms = terms.map(|(k, _)| &search.model.terms[*k]);
            let wanted = terms.filter(|term| (term.effect != EffectKind::FreeForm) == in_catalogue);
            wanted.map(Objection::to_term).collect()
        };
        let of_catalogue = refuted(true);
        if !of_catalogue.is_empty() {
            return Ok(Some(of_catalogue));
        }
        if settings.single_joint_contacts && pushes.take_the_place_of(&laws, search)? {
            return Ok(None);
        }
        Ok(Some(refuted(false)))
    }

    fn explained(
        &self,
        begun: &mut Begun<'_>,
        report: SearchReport,
        pushes: &Pushes,
        settings: &Settings,
    ) -> Result<Diagnosis, DiagnosisError> {
        let (search, prepared) = (&mut begun.search, self.prepared);
        let contacts = pushes.with_those_at_rest(prepared, search);
        let rows_with_pushes = contacts.as_ref().map(|_| prepared.motions.rows(self.model, None).slow);
        let ended = Ended {
            standard: &begun.standard,
            contacts: contacts.as_ref().zip(rows_with_pushes.as_ref()),
            report,
            delay: prepared.delay,
            rate: prepared.rate.as_ref(),
            sampling: begun.sampling.clone(),
        };
        search.ties.extend(pushes.not_told());
        let small = small(search, settings);
        search.model = search.model.without_nuisances()?;
        let mut diagnosis = Diagnosis { small, ..explain(search, ended, settings)? };
        standstill::name_not_judged(&mut diagnosis, self.model, &prepared.moving);
        Ok(diagnosis)
    }

    /// The standard model on the rows outside of contacts, and all candidates.
    fn begin(&self, contacts: Option<&Contacts>, settings: &Settings) -> Result<Begun<'a>, DiagnosisError> {
        let (model, prepared) = (self.model, self.prepared);
        let motions = &prepared.motions;
        let rows = motions.rows(model, contacts.map(|c| c.windows.as_slice()));
        let sampling = motions.sampling(&rows);
        let mut context = prepared.context(model)?;
        if contacts.is_some() {
            let fit = Fit::weighted(&rows.slow, &prepared.sigma)?;
            let chi = fit.chi.iter().take(rows.slow.parameters).copied().collect();
            context.update(chi);
        }
        let extended = ExtendedModel::new(context, rows.slow, rows.fast, self.change)?;
        let mut search = Search::new(extended, &motions.slowest, settings, self.progress);
        // No law is tried where only joints that hardly move would show it.
        let judged = &prepared.moving.judged;
        for candidates in [&mut search.slow, &mut search.fast] {
            candidates.retain(|c| c.own.iter().any(|&j| judged[j]));
        }
        let standard = StandardModelFit::new(&search.model.without_nuisances()?)?;
        Ok(Begun { search, standard, sampling })
    }
}

fn at_rest(model: &dyn Model, prepared: &Prepared) -> Result<Diagnosis, DiagnosisError> {
    let motions = &prepared.motions;
    let context = prepared.context(model)?;
    let laws = context.reference.as_ref().map_or(&[][..], |reference| reference.effects());
    let rest = standing::at_rest(&context, laws, &prepared.moving.friction_known, &motions.slowest);
    let sampling = motions.sampling(&motions.rows(model, None));
    let mut diagnosis = standstill::explain(&context, &rest, &prepared.chi_sigma, sampling)
        .ok_or_else(|| nothing_moves(model, &prepared.moving))?;
    standstill::name_not_judged(&mut diagnosis, model, &prepared.moving);
    Ok(diagnosis)
}

/// What a search begins with.
struct Begun<'a> {
    /// All candidates, none of them in the model yet.
    search: Search<'a>,
    /// The standard model fitted alone.
    standard: StandardModelFit,
    /// How the rows were sampled.
    sampling: Sampling,
}
