//! Everything that columns are made from: the model, the motions, and the current standard parameters.

use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::reference::Reference;
use crate::diagnosis::rows::additions::{Additions, Carried, DriveLaw, NumberError};
use crate::diagnosis::rows::links::Links;
use crate::diagnosis::rows::series::add_to;
use crate::diagnosis::rows::signals::{ModelTorques, Signals};
use crate::effects::{Corrected, Scale, Transmission, derivable};
use crate::model::{Link, Model, RecursiveModel};
use std::borrow::Cow;
use std::sync::{Arc, OnceLock, Weak};

/// What is made of the motions with the base parameters and additions as they are, each when it is first asked for.
pub(super) struct Made {
    /// Of each motion.
    torques: Vec<OnceLock<ModelTorques>>,
    /// Torques of the drives, `[j][t]` of each motion.
    drives: Vec<OnceLock<Vec<Vec<f64>>>>,
    pub(super) links: Vec<OnceLock<Links>>,
    /// Torques of gravity, `[j][t]` of each motion.
    pub(super) gravity: Vec<OnceLock<Vec<Vec<f64>>>>,
    /// Least and median inertia that each joint moves.
    pub(super) inertias: Vec<OnceLock<[f64; 2]>>,
    /// The robot with the errors that are far off: in the baseline, and in the recording.
    there: [OnceLock<Option<There>>; 2],
}

/// The parameters and additions that something was made of.
#[derive(Clone)]
pub(in crate::diagnosis) struct MadeOf(Weak<Made>);

impl MadeOf {
    /// Whether those of a context are the same.
    pub fn is_still(&self, context: &Context<'_>) -> bool {
        self.0.ptr_eq(&Arc::downgrade(&context.made))
    }
}

/// A robot whose numbers are not those of its table.
struct There {
    corrected: Corrected,
    model: RecursiveModel,
}

impl Made {
    /// Nothing yet.
    fn nothing(motions: usize, joints: usize) -> Self {
        fn unasked<T>(count: usize) -> Vec<OnceLock<T>> {
            (0..count).map(|_| OnceLock::new()).collect()
        }
        Self {
            torques: unasked(motions),
            drives: unasked(motions),
            links: unasked(motions),
            gravity: unasked(motions),
            inertias: unasked(joints),
            there: [OnceLock::new(), OnceLock::new()],
        }
    }
}

#[derive(Clone)]
pub(in crate::diagnosis) struct Context<'a> {
    pub model: &'a dyn Model,
    pub(super) engine: Arc<RecursiveModel>,
    pub(super) tables: Vec<Link<f64>>,
    pub signals: &'a [Signals],
    pub scales: Vec<Scale>,
    /// Base parameters, without the bodies that were found.
    pub chi: Vec<f64>,
    pub(super) additions: Additions,
    /// What follows from these; copies share it until they take others.
    pub(super) made: Arc<Made>,
    /// How far the inner state of every law that has one is off where a motion begins.
    pub off_at_start: f64,
    /// Transmissions that are known in physical units, per joint.
    pub transmissions: Vec<(usize, Transmission)>,
    /// The robot before it changed, as a model.
    pub reference: Option<Arc<Reference>>,
    /// Threads for what is made of it; 0: as many as the machine has.
    pub threads: usize,
}

impl<'a> Context<'a> {
    pub fn new(
        model: &'a dyn Model,
        signals: &'a [Signals],
        scales: Vec<Scale>,
        chi: Vec<f64>,
    ) -> Result<Self, DiagnosisError> {
        let robot = model.robot();
        Ok(Self {
            model,
            engine: Arc::new(derivable(robot)?),
            tables: Link::of(robot),
            signals,
            scales,
            chi,
            additions: Additions::default(),
            made: Arc::new(Made::nothing(signals.len(), robot.joints())),
            off_at_start: 0.0,
            transmissions: Vec::new(),
            reference: None,
            threads: 1,
        })
    }

    /// The same on so many threads.
    pub fn on(self, threads: usize) -> Self {
        Self { threads, ..self }
    }

    /// The same beside a model of the robot before it changed, and with the bodies and laws that it has.
    pub fn beside(self, reference: Option<Arc<Reference>>) -> Self {
        let mut context = Self { reference, ..self };
        context.additions = context.additions_before();
        context.forget();
        context
    }

    /// Takes other base parameters: loads and model torques follow.
    pub fn update(&mut self, chi: Vec<f64>) {
        self.chi = chi;
        self.forget();
    }

    /// Takes other bodies and laws beside these.
    pub fn take(&mut self, additions: Additions) {
        self.additions = additions;
        self.forget();
    }

    /// Takes these large errors, beside those that the reference has.
    pub fn take_errors(&mut self, errors: Vec<NumberError>) {
        let mut all = self.additions_before().errors;
        all.extend(errors);
        if all != self.additions.errors {
            self.take(Additions { errors: all, ..self.additions.clone() });
        }
    }

    /// What was made with other parameters or additions is made anew where it is asked for.
    fn forget(&mut self) {
        self.made = Arc::new(Made::nothing(self.signals.len(), self.model.robot().joints()));
    }

    /// The parameters and additions as they are.
    pub fn made_of(&self) -> MadeOf {
        MadeOf(Arc::downgrade(&self.made))
    }

    /// What the model makes of a motion; worked out when it is first asked for.
    pub fn torques(&self, signal: usize) -> &ModelTorques {
        self.made.torques[signal].get_or_init(|| {
            let (model, signals) = self.as_it_is(signal);
            ModelTorques::new(model, &self.chi_in(signal), &signals)
        })
    }

    /// The model of a motion, and the motion that it is evaluated on: those of the robot with the numbers that are far off.
    pub(super) fn as_it_is(&self, signal: usize) -> (&dyn Model, Cow<'_, Signals>) {
        let signals = &self.signals[signal];
        let there = self.made.there[usize::from(signals.is_target)].get_or_init(|| {
            let corrected = self.robot_with(&self.additions.errors, signal)?;
            let model = RecursiveModel::new(corrected.robot.clone()).ok()?;
            Some(There { corrected, model })
        });
        match there {
            Some(There { corrected, model }) => (model, Cow::Owned(signals.seen_by(corrected))),
            None => (self.model, Cow::Borrowed(signals)),
        }
    }

    /// The robot with these errors as it was in a motion; `None` where it had none of them.
    pub(super) fn robot_with(&self, errors: &[NumberError], signal: usize) -> Option<Corrected> {
        let is_there = |e: &&NumberError| e.in_baseline || self.signals[signal].is_target;
        NumberError::put_in(self.model.robot(), errors.iter().filter(is_there))
    }

    /// The torque of each drive, `[j][t]`, which channels hear: that of the standard model and of the laws that the joints
    /// have beside it and that do not look at it themselves.
    pub fn drives(&self, signal: usize) -> &[Vec<f64>] {
        self.made.drives[signal].get_or_init(|| {
            let mut drives = self.torques(signal).total.clone();
            let is_there = |law: &&DriveLaw| law.in_baseline || self.signals[signal].is_target;
            for law in self.additions.laws.iter().filter(is_there) {
                let made_with = (law.effect, law.place, &law.shape[..], law.scale);
                add_to(&mut drives, &self.series_made_with(signal, made_with), &law.amplitude);
            }
            drives
        })
    }

    /// A copy with these bodies and laws.
    pub fn with(&self, additions: Additions) -> Self {
        let mut copy = self.clone();
        if copy.additions != additions {
            copy.take(additions);
        }
        copy
    }

    /// Lowest rate of the motions, Hz.
    pub fn rate(&self) -> f64 {
        self.signals.iter().map(|s| s.rate).fold(f64::INFINITY, f64::min)
    }

    /// Bodies and laws that the reference has.
    pub fn additions_before(&self) -> Additions {
        let effects = self.reference.iter().flat_map(|reference| reference.effects());
        Additions::among(self.model.robot(), effects)
    }

    /// Whether there are no motions of a baseline.
    pub fn is_alone(&self) -> bool {
        self.signals.iter().all(|s| s.is_target)
    }

    /// Bodies and laws that the robot has beside its parameters.
    pub fn additions(&self) -> &Additions {
        &self.additions
    }

    /// Base parameters of the robot in a motion with what it carries there.
    pub fn chi_in(&self, signal: usize) -> Vec<f64> {
        let mut chi = self.chi.clone();
        let is_there = |body: &&Carried| body.in_baseline || self.signals[signal].is_target;
        for body in self.additions.bodies.iter().filter(is_there) {
            chi.iter_mut().zip(&body.chi).for_each(|(x, more)| *x += more);
        }
        chi
    }

    /// Torques, `[j][t]`, of the bodies that were not there in the baseline.
    pub fn of_new_bodies(&self, signal: usize) -> Vec<Vec<f64>> {
        let mut chi = vec![0.0; self.chi.len()];
        for body in self.additions.bodies.iter().filter(|body| !body.in_baseline) {
            chi.iter_mut().zip(&body.chi).for_each(|(x, more)| *x += more);
        }
        let (model, signals) = self.as_it_is(signal);
        ModelTorques::new(model, &chi, &signals).rigid
    }

    pub fn tables(&self) -> &[Link<f64>] {
        &self.tables
    }
}
