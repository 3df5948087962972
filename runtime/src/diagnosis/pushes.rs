//! Pushes from outside in the course of a diagnosis: found beside the standard model, set aside, looked at again beside the
//! laws that were found.

use super::candidates::trial::dense_columns;
use super::contact::felt::Around;
use super::contact::in_place::half_wave_in_place;
use super::contact::moving;
use super::contact::pushed::Pushed;
use super::contact::search::{self as contact_search, Contacts};
use super::contact::silent::Silent;
use super::contact::standing;
use super::contact::track::Left;
use super::error::{DiagnosisError, SingularDesign};
use super::explanation::finding::terms;
use super::judging::passage::{Elsewhere, Passage};
use super::judging::regression::Regression;
use super::objection::Objection;
use super::preparation::Prepared;
use super::rows::design::Design;
use super::rules::{MOSTLY_UNEXPLAINED, SCAN_LEVEL, SCAN_LEVEL_BESIDE_LAWS};
use super::search::extended_model::ExtendedModel;
use super::search::free_form::slow_part;
use super::search::round::Tie;
use super::search::state::Search;
use super::search::tangents::{along_starts, tangents};
use super::settings::Settings;
use crate::effects::{EffectKind, EffectTerm, Place, SmoothingWindow};
use crate::model::Model;

/// Windows in which something outside seems to have pushed the robot.
#[derive(Clone)]
pub(super) struct Pushes {
    /// Seen by several joints.
    contacts: Option<Contacts>,
    /// Whether their rows are set aside. A body that is carried all the time pushes like a hand: against a baseline, laws
    /// are tried first on all of the motion, and only what still stands out then is set aside.
    set_aside: bool,
    /// Seen by single joints, in what is left when the search is done.
    of_single_joints: Option<Contacts>,
    /// Windows that the last look for them found.
    seen: Vec<Pushed>,
    /// Whether those have been looked for.
    scanned: bool,
    /// What they were before a law took the place of some.
    explained: Option<Box<Pushes>>,
    /// Those that have taken the place of laws which show in one passage only, by the fast rows.
    in_place_of_laws: Vec<InPlace>,
    /// The same with what the last look says of them.
    of_passages: Option<Contacts>,
    /// Laws of which the rest of the motion does not tell whether they are there instead.
    not_told: Vec<Tie>,
    /// Laws of one passage that a push would explain, had it not been an accident.
    accidents: Vec<Objection>,
}

/// A push in the place of laws.
#[derive(Clone)]
struct InPlace {
    push: Pushed,
    laws: Vec<Objection>,
}

impl Pushes {
    /// What the standard model alone leaves.
    pub fn found(model: &dyn Model, prepared: &Prepared, change: bool) -> Result<Self, DiagnosisError> {
        let signals = &prepared.motions.signals;
        let contacts = contact_search::find(&prepared.context(model)?, &prepared.aligned, signals);
        Ok(Self {
            contacts,
            set_aside: !change,
            of_single_joints: None,
            seen: Vec::new(),
            scanned: false,
            explained: None,
            in_place_of_laws: Vec::new(),
            of_passages: None,
            not_told: Vec::new(),
            accidents: Vec::new(),
        })
    }

    /// Those whose rows are not used.
    pub fn set_aside(&self) -> Option<Contacts> {
        let contacts = self.contacts.clone().filter(|_| self.set_aside);
        Contacts::joined(contacts, Contacts::joined(self.of_single_joints.clone(), self.of_passages.clone()))
    }

    /// How many were seen by single joints.
    pub fn of_single_joints(&self) -> usize {
        self.of_single_joints.as_ref().map_or(0, |contacts| contacts.wrenches.len())
    }

    /// A law takes the place of some of them: these are left beside it.
    pub fn give_way(&mut self, left: Self) {
        let found = std::mem::replace(self, left);
        self.explained = Some(Box::new(found));
    }

    /// What they were before a law took the place of some, now that it has proved to be none; whether one had.
    pub fn come_back(&mut self) -> bool {
        let Some(found) = self.explained.take() else { return false };
        *self = *found;
        true
    }

    /// Looks at what a model with effects leaves; whether other rows are to be set aside than were.
    pub fn differ_beside(
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
        let all = [&self.of_single_joints, &self.contacts, &self.of_passages];
        if self.scanned && all.into_iter().all(Option::is_none) {
            return false;
        }
        // Once what was found is no longer among the rows, they show what else remains on a joint.
        let beside_laws = !is_alone(search) || self.scanned && is_unexplained(&search.model.slow);
        let level = if beside_laws { SCAN_LEVEL_BESIDE_LAWS } else { SCAN_LEVEL };
        let (confirmed, found) = self.in_motion((model, prepared), (search, level), settings);
        if !self.accidents.is_empty() {
            // Their rows belong to the motion that laws are fitted to.
            return true;
        }
        let refuted = self.contacts.is_some() && confirmed.is_none();
        self.contacts = confirmed;
        if self.scanned || !settings.single_joint_contacts {
            let before = self.of_single_joints.take();
            let were_some = before.is_some();
            self.of_single_joints = before.and_then(|p| moving::still_there(p, found));
            // What is no push belongs to the motion that laws are fitted to.
            return refuted || were_some && self.of_single_joints.is_none();
        }
        // What was found with the pushes among the rows is looked for again without them.
        (self.of_single_joints, self.scanned) = (found, true);
        refuted || self.of_single_joints.is_some()
    }

    /// All of them, and those at rest.
    pub fn with_those_at_rest(&self, prepared: &Prepared, search: &Search<'_>) -> Option<Contacts> {
        let motions = &prepared.motions;
        let (context, laws) = (&search.model.context, laws(&search.model));
        let rest = standing::at_rest(context, &laws, &prepared.moving.friction_known, &motions.slowest);
        Contacts::joined(
            Contacts::joined(self.contacts.clone(), self.of_single_joints.clone()),
            Contacts::joined(self.of_passages.clone(), rest.contacts(motions.signals.len())),
        )
    }

    /// Of the contacts that are known, those that what the model with its effects leaves confirms; and the pushes that stand out
    /// of it besides, on single joints or several.
    fn in_motion(
        &mut self,
        (model, prepared): (&dyn Model, &Prepared),
        (search, level): (&Search<'_>, f64),
        settings: &Settings,
    ) -> (Option<Contacts>, Option<Contacts>) {
        let contacts = self.contacts.as_ref();
        let outside = prepared.motions.rows(model, contacts.map(|c| c.windows.as_slice())).fast;
        let context = &search.model.context;
        let mut beside = uncertain(&search.model, &outside);
        // A wave over the angle of a joint that creeps comes and goes as slowly as a push.
        let ripple = EffectKind::TorqueRipple;
        for (joint, lines) in search.lines_beside_model(settings) {
            let orders: Vec<f64> = lines.iter().map(|line| line.order).collect();
            beside.extend(dense_columns(context, &outside, ripple, Place::Joint(joint), &orders, false));
        }
        let left = Left {
            residual: &search.model.residual_on(&outside, SmoothingWindow::Fast),
            beside: &beside,
            fitted: &search.model.fitted_on(&outside),
            silent: &Silent::of(model.robot(), &laws(&search.model)),
        };
        let certain = self.certain();
        let look = moving::look(context, &outside, &left, (&self.seen, &certain), level);
        let is_accident = |own: &InPlace| look.accidents.iter().any(|push| push.overlaps(&own.push));
        let accidents = self.in_place_of_laws.extract_if(.., |own| is_accident(own));
        self.accidents.extend(accidents.flat_map(|own| own.laws));
        let all = contacts.map(|_| prepared.motions.rows(model, None).fast);
        let design = all.as_ref().unwrap_or(&outside);
        let residual = search.model.residual_on(design, SmoothingWindow::Fast);
        let around = Around { context, design, residual: &residual, sigma: &search.model.fast.sigma };
        let confirmed = contacts.and_then(|c| moving::confirmed(c, &around, &look));
        self.of_passages = moving::certain(&around, &look, &self.certain());
        let found = moving::seen(&around, &look);
        self.seen = look.pushes;
        (confirmed, found)
    }

    /// Puts pushes in the place of laws that show in one passage only, where half a wave explains nearly as much; whether there are
    /// any more than there were.
    ///
    /// # Errors
    /// [`SingularDesign`] where the model without a law has no fit.
    pub fn take_the_place_of(
        &mut self,
        laws: &[(usize, Passage)],
        search: &Search<'_>,
    ) -> Result<bool, SingularDesign> {
        let before = self.in_place_of_laws.len();
        let (model, slow, fast) = (&search.model, &search.model.slow, &search.model.fast.design);
        for (k, passage) in laws {
            let term = &model.terms[*k];
            let places = self.in_place_of_laws.iter().map(|own| own.push.places[1] - own.push.places[0]);
            let longest = search.longest_push(places.sum::<usize>() as f64 * fast.step);
            let wave = half_wave_in_place(slow, slow.term_columns[*k].clone(), &term.shows_on, longest)?;
            let Some(wave) = wave else { continue };
            let spacings = [&slow.design, fast].map(|design| design.spacing(wave.motion));
            let push = wave.as_push(spacings, 1.0 - term.confidence);
            let law = Objection::to_term(term);
            // Laws of several joints may have followed one push.
            match self.in_place_of_laws.iter_mut().find(|other| other.push.overlaps(&push)) {
                Some(other) => other.laws.push(law),
                None => self.in_place_of_laws.push(InPlace { push, laws: vec![law] }),
            }
            if passage.elsewhere == Elsewhere::Untold {
                self.not_told.push(Tie {
                    effects: [EffectKind::Contact, term.effect],
                    places: [Place::Joint(wave.joint), term.place],
                });
            }
        }
        if self.in_place_of_laws.len() == before {
            return Ok(false);
        }
        self.of_passages = Some(moving::set_aside(model.context.signals, fast, &self.certain()));
        Ok(true)
    }

    /// Pushes in the place of laws.
    fn certain(&self) -> Vec<Pushed> {
        self.in_place_of_laws.iter().map(|own| own.push.clone()).collect()
    }

    /// Laws of one passage in whose place no push is certain, each once.
    pub fn take_accidents(&mut self) -> Vec<Objection> {
        std::mem::take(&mut self.accidents)
    }

    /// Laws that the motion does not tell from pushes.
    pub fn not_told(&self) -> &[Tie] {
        &self.not_told
    }
}

/// Whether there are no laws beside pushes, found or not told apart or kept.
fn is_alone(search: &Search<'_>) -> bool {
    search.model.terms.is_empty() && search.ties.is_empty() && search.rejected.is_empty()
}

/// Whether most of what remains on a joint is no noise.
fn is_unexplained(regression: &Regression) -> bool {
    let residual = regression.residual();
    let slow = |j| slow_part(regression, &residual, j);
    (0..regression.design.joints).any(|j| slow(j) >= MOSTLY_UNEXPLAINED)
}

/// The laws of a model and those of its reference.
fn laws(model: &ExtendedModel<'_>) -> Vec<EffectTerm> {
    let standing = model.context.reference.iter().flat_map(|reference| reference.effects().iter().cloned());
    terms(model).into_iter().chain(standing).collect()
}

/// What transmissions with spring or play do on the rows of a design, and what an error of their numbers would: they ring
/// in bursts that all joints feel through the inertia of the links, and no number of them is known so well that nothing
/// of that is left; and what laws with an inner state do until they have forgotten the one that a motion began with.
fn uncertain(model: &ExtendedModel<'_>, design: &Design) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for term in model.terms.iter().filter(|t| t.effect.form().is_fast_only()) {
        columns.extend(model.columns_of(design, term));
        columns.extend(tangents(model, design, term, &[]).into_iter().map(|(_, slope)| slope));
    }
    columns.extend(model.terms.iter().flat_map(|term| along_starts(model, design, term)));
    columns
}

/// Whether contacts still stand out of what the model with its effects leaves.
fn remain(contacts: &Contacts, prepared: &Prepared, search: &Search<'_>) -> bool {
    let aligned = &prepared.aligned;
    let residual = search.model.residual_on(aligned, SmoothingWindow::Slow);
    let sigma = &search.model.slow.sigma;
    contact_search::remain(contacts, aligned, &residual, sigma, &prepared.motions.signals)
}
