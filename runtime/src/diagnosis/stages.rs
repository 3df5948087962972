//! The stages of a diagnosis, one after the other: signals, contacts, candidates and search, explanations.

use super::contact::felt::Around;
use super::contact::search::{self as contact_search, Contacts};
use super::contact::{moving, standing};
use super::error::DiagnosisError;
use super::explanation::explain::{Ended, explain, small};
use super::explanation::standard_model::StandardModelFit;
use super::explanation::standstill;
use super::outcome::{Diagnosis, Finding, Sampling};
use super::preparation::{Prepared, nothing_moves};
use super::rate::LAW;
use super::rows::fit::Fit;
use super::rules::{SCAN_LEVEL, SCAN_LEVEL_BESIDE_LAWS};
use super::search::extended_model::ExtendedModel;
use super::search::state::Search;
use super::settings::{Progress, Settings};
use crate::effects::{EffectKind, Place};
use crate::model::Model;
use crate::recording::Trajectory;

/// What is diagnosed, and the same robot before it changed.
pub(super) struct Recordings<'a> {
    pub trajectories: &'a [Trajectory],
    pub baseline: &'a [Trajectory],
}

/// Laws at places that other evidence speaks against, given a diagnosis; it may write down what it saw. Nothing where it
/// has no objection.
pub(crate) type Objections<'o> = dyn FnMut(&mut Diagnosis) -> Vec<(EffectKind, Place)> + 'o;

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
    'rows: loop {
        // 3. Rows outside of these windows; all candidates on them; effects join the model while one holds.
        progress.at(0.1, "candidates");
        let Begun { mut search, standard, sampling } =
            begin(model, &prepared, pushes.set_aside().as_ref(), change, (&settings, progress))?;
        // Where something is said against what was found, the search goes on from here.
        let without_effects = known.is_none().then(|| search.model.copy()).transpose()?;
        loop {
            let mut report = match known {
                Some(known) => search.force(known)?,
                None => search.run(&settings, progress)?,
            };

            // 4. What looked like pushes from outside may be explained by what is now in the model: then once more.
            if pushes.differ_beside(model, &prepared, &search, &settings) {
                continue 'rows;
            }
            // What something outside did is no law over some variable: those are looked for without it.
            if known.is_none() && !search.beyond_catalogue {
                search.beyond_catalogue = true;
                let found = search.model.terms.len();
                report = search.run(&settings, progress)?;
                if search.model.terms.len() > found
                    && pushes.differ_beside(model, &prepared, &search, &settings)
                {
                    continue 'rows;
                }
            }

            // 5. Numbers, errors, curves, sentences.
            progress.at(0.92, "explanations");
            let contacts = pushes.with_those_at_rest(&prepared, &search);
            let ended = Ended {
                standard: &standard,
                contacts: contacts.as_ref(),
                report,
                delay: prepared.delay,
                rate: prepared.rate.as_ref(),
                sampling: sampling.clone(),
            };
            let small = small(&search, &settings);
            search.model = search.model.without_nuisances()?;
            let mut diagnosis = Diagnosis { small, ..explain(&search, ended, &settings)? };
            standstill::name_not_judged(&mut diagnosis, model, &prepared.moving);

            // 6. What harms, or other evidence speaks against, is left out, and the search goes on.
            let mut objected = harmful(&diagnosis);
            if objected.is_empty() {
                objected = objections.as_mut().map_or_else(Vec::new, |object| object(&mut diagnosis));
            }
            match &without_effects {
                Some(model) if !objected.is_empty() => search.go_on_without(&objected, model.copy()?)?,
                _ => {
                    progress.at(1.0, "done");
                    return Ok(diagnosis);
                }
            }
            settings.excluded.extend(objected);
        }
    }
}

/// Laws that make motion which was held out worse, once nothing is fitted beside them that is never named.
fn harmful(diagnosis: &Diagnosis) -> Vec<(EffectKind, Place)> {
    let harms = |f: &&Finding| f.without.is_some() && f.held_out_after > f.held_out_before;
    diagnosis.findings.iter().filter(harms).map(|f| (f.term.effect, f.term.place)).collect()
}

/// Windows in which something outside seems to have pushed the robot.
struct Pushes {
    /// Seen by several joints.
    contacts: Option<Contacts>,
    /// Whether their rows are set aside. A body that is carried all the time pushes like a hand: against a baseline, laws
    /// are tried first on all of the motion, and only what still stands out then is set aside.
    set_aside: bool,
    /// Seen by single joints, in what is left when the search is done.
    of_single_joints: Option<Contacts>,
    /// Whether those have been looked for.
    scanned: bool,
}

impl Pushes {
    /// What the standard model alone leaves.
    fn found(model: &dyn Model, prepared: &Prepared, change: bool) -> Result<Self, DiagnosisError> {
        let signals = &prepared.motions.signals;
        let contacts = contact_search::find(&prepared.context(model)?, &prepared.aligned, signals);
        Ok(Self { contacts, set_aside: !change, of_single_joints: None, scanned: false })
    }

    /// Those whose rows are not used.
    fn set_aside(&self) -> Option<Contacts> {
        Contacts::joined(self.contacts.clone().filter(|_| self.set_aside), self.of_single_joints.clone())
    }

    /// Looks at what a model with effects leaves; whether other rows are to be set aside than were.
    fn differ_beside(
        &mut self,
        model: &dyn Model,
        prepared: &Prepared,
        search: &Search<'_>,
        settings: &Settings,
    ) -> bool {
        if let Some(found) = &self.contacts {
            let remain = remain(found, prepared, search);
            if !remain {
                self.contacts = None;
            }
            if remain != self.set_aside {
                self.set_aside = true;
                return true;
            }
        }
        if self.scanned && self.of_single_joints.is_none() && self.contacts.is_none() {
            return false;
        }
        let (confirmed, found) = pushed_in_motion(model, prepared, self.contacts.as_ref(), search);
        let refuted = self.contacts.is_some() && confirmed.is_none();
        self.contacts = confirmed;
        if self.scanned || !settings.single_joint_contacts {
            let before = self.of_single_joints.take();
            self.of_single_joints = before.and_then(|p| moving::still_there(p, found));
            return refuted;
        }
        // What was found with the pushes among the rows is looked for again without them.
        (self.of_single_joints, self.scanned) = (found, true);
        refuted || self.of_single_joints.is_some()
    }

    /// All of them, and those at rest.
    fn with_those_at_rest(&self, prepared: &Prepared, search: &Search<'_>) -> Option<Contacts> {
        let motions = &prepared.motions;
        let rest = standing::at_rest(&search.model.context, &prepared.moving.fitted, &motions.slowest);
        Contacts::joined(
            Contacts::joined(self.contacts.clone(), self.of_single_joints.clone()),
            rest.contacts(motions.signals.len()),
        )
    }
}

/// What can be said of a robot that holds still, beside a baseline in which it moves.
fn at_rest(model: &dyn Model, prepared: &Prepared) -> Result<Diagnosis, DiagnosisError> {
    let motions = &prepared.motions;
    let context = prepared.context(model)?;
    let rest = standing::at_rest(&context, &prepared.moving.fitted, &motions.slowest);
    let sampling = motions.sampling(&motions.rows(model, None));
    let mut diagnosis = standstill::explain(&context, &rest, &prepared.chi_sigma, sampling)
        .ok_or_else(|| nothing_moves(model, &prepared.moving))?;
    standstill::name_not_judged(&mut diagnosis, model, &prepared.moving);
    Ok(diagnosis)
}

/// Of the contacts that are known, those that what the model with its effects leaves confirms; and the pushes that stand out
/// of it besides, on single joints or several.
fn pushed_in_motion(
    model: &dyn Model,
    prepared: &Prepared,
    contacts: Option<&Contacts>,
    search: &Search<'_>,
) -> (Option<Contacts>, Option<Contacts>) {
    let outside = prepared.motions.rows(model, contacts.map(|c| c.windows.as_slice())).fast;
    let context = &search.model.context;
    let level = if search.model.terms.is_empty() { SCAN_LEVEL } else { SCAN_LEVEL_BESIDE_LAWS };
    let look = moving::look(context, &outside, &search.model.residual_on(&outside), level);
    let all = contacts.map(|_| prepared.motions.rows(model, None).fast);
    let design = all.as_ref().unwrap_or(&outside);
    let residual = search.model.residual_on(design);
    let around = Around { context, design, residual: &residual, sigma: &search.model.fast.sigma };
    let confirmed = contacts.and_then(|c| moving::confirmed(c, &around, &look));
    (confirmed, moving::seen(&around, &look))
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

/// The standard model on the rows outside of contacts, and all candidates.
fn begin<'a>(
    model: &'a dyn Model,
    prepared: &'a Prepared,
    contacts: Option<&Contacts>,
    change: bool,
    (settings, progress): (&Settings, &dyn Progress),
) -> Result<Begun<'a>, DiagnosisError> {
    let motions = &prepared.motions;
    let rows = motions.rows(model, contacts.map(|c| c.windows.as_slice()));
    let sampling = motions.sampling(&rows);
    let mut context = prepared.context(model)?;
    if contacts.is_some() {
        let fit = Fit::weighted(&rows.slow, &prepared.sigma)?;
        context.update(fit.chi.iter().take(rows.slow.parameters).copied().collect());
    }
    let extended = ExtendedModel::new(context, rows.slow, rows.fast, change)?;
    let mut search = Search::new(extended, &motions.slowest, settings, progress);
    // No law is tried where only joints that hardly move would show it.
    let judged = &prepared.moving.judged;
    for candidates in [&mut search.slow, &mut search.fast] {
        candidates.retain(|c| c.own.iter().any(|&j| judged[j]));
    }
    let standard = StandardModelFit::new(&search.model.without_nuisances()?, &prepared.aligned)?;
    Ok(Begun { search, standard, sampling })
}

/// Whether contacts still stand out of what the model with its effects leaves.
fn remain(contacts: &Contacts, prepared: &Prepared, search: &Search<'_>) -> bool {
    let aligned = &prepared.aligned;
    let residual = search.model.residual_on(aligned);
    let sigma = &search.model.slow.sigma;
    contact_search::remain(contacts, aligned, &residual, sigma, &prepared.motions.signals)
}
