//! What is simulated and diagnosed.

use clap::ValueEnum;
use dynid_runtime::effects::EffectKind;

use crate::options::Pushed;
use crate::recorder::Recorder;
use crate::size::SIZES;

/// How long a contact lasts where nothing else is asked for, s.
pub const USUAL_PUSH: [f64; 2] = [0.4, 0.7];

/// One simulation and one diagnosis.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name of the robot.
    pub robot: String,
    /// What is hidden; empty for nothing.
    pub effects: Vec<EffectKind>,
    /// Index in [`SIZES`].
    pub size: usize,
    /// Seed.
    pub seed: u64,
    /// Duration of its one motion, s; `None` for one to three of the usual length.
    pub seconds: Option<f64>,
    /// Whether there is a baseline where no effect asks for one.
    pub baseline: bool,
    /// What is known of the robot from before, where a model is the reference: it has laws then already.
    pub reference: Option<Before>,
    /// How it is recorded.
    pub recorder: Recorder,
    /// What a contact pushes, and how long, s.
    pub push: (Pushed, [f64; 2]),
}

/// What is there beside a recording of the same robot from before it changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Before {
    /// The model alone
    Model,
    /// The model and the motions that it is from
    Motions,
}

impl Case {
    /// What its folder is called.
    pub fn name(&self) -> String {
        let hidden: Vec<&str> = self.effects.iter().map(|e| e.id()).collect();
        let hidden = if hidden.is_empty() { "none".to_owned() } else { hidden.join("+") };
        let length = self.seconds.map_or_else(String::new, |s| format!("_{s}s"));
        let push = match self.push {
            _ if !self.effects.contains(&EffectKind::Contact) => String::new(),
            (Pushed::Link, USUAL_PUSH) => String::new(),
            (pushed, [least, most]) => format!("_{pushed:?}_{least}_{most}").to_lowercase(),
        };
        let recorder = match self.recorder {
            Recorder::White => String::new(),
            other => format!("_{}", other.name()),
        };
        let baseline = match (self.baseline, self.reference) {
            (true, _) => "_baseline",
            (_, Some(Before::Model)) => "_reference",
            (_, Some(Before::Motions)) => "_reference_motions",
            _ => "",
        };
        format!(
            "{}_{hidden}_{}_{}{length}{recorder}{baseline}{push}",
            self.robot,
            self.size_name(),
            self.seed
        )
    }

    pub fn size_name(&self) -> &'static str {
        SIZES[self.size]
    }
}
