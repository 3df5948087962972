//! Everything that columns are made from: the model, the motions, and the current standard parameters.

use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::reference::Reference;
use crate::diagnosis::rows::links::Links;
use crate::diagnosis::rows::signals::{ModelTorques, Signals};
use crate::effects::{EffectKind, EffectTerm, Form, Place, Scale, Transmission, derivable};
use crate::model::{Link, Model, RecursiveModel, Robot};
use std::sync::{Arc, OnceLock};

/// A body that was found on the robot. It is not among the parameters `chi`, but the joints carry it: laws that follow the
/// load feel it.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Carried {
    /// What it adds to each base parameter.
    pub chi: Vec<f64>,
    /// Whether the robot carried it in the baseline too.
    pub in_baseline: bool,
}

impl Carried {
    /// The bodies among terms, by their amplitudes; a body on a link of which the table says that it is none adds nothing.
    pub fn among<'t>(robot: &Robot, terms: impl IntoIterator<Item = &'t EffectTerm>) -> Vec<Self> {
        let of = |term: &EffectTerm| Self::of(robot, (term.effect, term.place), &term.amplitude, true);
        terms.into_iter().filter_map(of).collect()
    }

    /// The body that a law at a place is; `None` for a law that is none.
    pub fn of(
        robot: &Robot,
        (effect, place): (EffectKind, Place),
        amplitude: &[f64],
        in_baseline: bool,
    ) -> Option<Self> {
        let Form::Body(_) = effect.form() else { return None };
        Some(Self { chi: robot.base_of_body(place.link()?, amplitude)?, in_baseline })
    }
}

/// What is made of the motions with the base parameters and bodies as they are, each when it is first asked for.
pub(super) struct Made {
    /// Of each motion.
    torques: Vec<OnceLock<ModelTorques>>,
    pub(super) links: Vec<OnceLock<Links>>,
    /// Torques of gravity, `[j][t]` of each motion.
    pub(super) gravity: Vec<OnceLock<Vec<Vec<f64>>>>,
    /// Least and median inertia that each joint moves.
    pub(super) inertias: Vec<OnceLock<[f64; 2]>>,
}

impl Made {
    /// Nothing yet.
    fn nothing(motions: usize, joints: usize) -> Self {
        fn unasked<T>(count: usize) -> Vec<OnceLock<T>> {
            (0..count).map(|_| OnceLock::new()).collect()
        }
        Self {
            torques: unasked(motions),
            links: unasked(motions),
            gravity: unasked(motions),
            inertias: unasked(joints),
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
    pub(super) carried: Vec<Carried>,
    /// What follows from these; copies share it until they take others.
    pub(super) made: Arc<Made>,
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
            carried: Vec::new(),
            made: Arc::new(Made::nothing(signals.len(), robot.joints())),
            transmissions: Vec::new(),
            reference: None,
            threads: 1,
        })
    }

    /// The same on so many threads.
    pub fn on(self, threads: usize) -> Self {
        Self { threads, ..self }
    }

    /// The same beside a model of the robot before it changed, and with the bodies that it has.
    pub fn beside(self, reference: Option<Arc<Reference>>) -> Self {
        let mut context = Self { reference, ..self };
        let carried = context.carried_before();
        if !carried.is_empty() {
            context.update(context.chi.clone(), carried);
        }
        context
    }

    /// Takes other base parameters and bodies: loads and model torques follow.
    pub fn update(&mut self, chi: Vec<f64>, carried: Vec<Carried>) {
        (self.chi, self.carried) = (chi, carried);
        self.made = Arc::new(Made::nothing(self.signals.len(), self.model.robot().joints()));
    }

    /// What the model makes of a motion; worked out when it is first asked for.
    pub fn torques(&self, signal: usize) -> &ModelTorques {
        self.made.torques[signal]
            .get_or_init(|| ModelTorques::new(self.model, &self.chi_in(signal), &self.signals[signal]))
    }

    /// A copy that carries these bodies.
    pub fn carrying(&self, carried: Vec<Carried>) -> Self {
        let mut copy = self.clone();
        if copy.carried != carried {
            copy.update(self.chi.clone(), carried);
        }
        copy
    }

    /// Lowest rate of the motions, Hz.
    pub fn rate(&self) -> f64 {
        self.signals.iter().map(|s| s.rate).fold(f64::INFINITY, f64::min)
    }

    /// Bodies that the reference has.
    pub fn carried_before(&self) -> Vec<Carried> {
        let effects = self.reference.iter().flat_map(|reference| reference.effects());
        Carried::among(self.model.robot(), effects)
    }

    /// Whether there are no motions of a baseline.
    pub fn is_alone(&self) -> bool {
        self.signals.iter().all(|s| s.is_target)
    }

    /// Bodies that were found.
    pub fn carried(&self) -> &[Carried] {
        &self.carried
    }

    /// Base parameters of the robot in a motion with what it carries there.
    pub fn chi_in(&self, signal: usize) -> Vec<f64> {
        let mut chi = self.chi.clone();
        let is_there = |body: &&Carried| body.in_baseline || self.signals[signal].is_target;
        for body in self.carried.iter().filter(is_there) {
            chi.iter_mut().zip(&body.chi).for_each(|(x, more)| *x += more);
        }
        chi
    }

    /// Torques, `[j][t]`, of the bodies that were not there in the baseline.
    pub fn of_new_bodies(&self, signal: usize) -> Vec<Vec<f64>> {
        let mut chi = vec![0.0; self.chi.len()];
        for body in self.carried.iter().filter(|body| !body.in_baseline) {
            chi.iter_mut().zip(&body.chi).for_each(|(x, more)| *x += more);
        }
        ModelTorques::new(self.model, &chi, &self.signals[signal]).rigid
    }

    pub fn tables(&self) -> &[Link<f64>] {
        &self.tables
    }
}
