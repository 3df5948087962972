//! Memory of a simulated robot, allocated once.

use super::drive::DryElement;
use super::extra::Instant;
use super::stiction::{Decision, StictionScratch};
use super::stiff::Stiff;

/// Memory of one evaluation, allocated once.
#[derive(Debug, Clone)]
pub(super) struct Work {
    pub(super) link_mass: Vec<f64>,
    pub(super) link_bias: Vec<f64>,
    pub(super) mass: Vec<f64>,
    /// M⁻¹·Gᵀ, one row per friction element.
    pub(super) response: Vec<f64>,
    pub(super) a: Vec<f64>,
    pub(super) b: Vec<f64>,
    pub(super) limits: Vec<[f64; 2]>,
    pub(super) chosen: Vec<usize>,
    pub(super) decisions: Vec<Decision>,
    pub(super) stiction: StictionScratch,
    pub(super) extra: Vec<f64>,
    pub(super) joint_levels: Vec<[f64; 2]>,
    pub(super) levels: Vec<[f64; 2]>,
    pub(super) seen: Seen,
    pub(super) stages: Stages,
    pub(super) stiff: Stiff,
    pub(super) next_q: Vec<f64>,
    pub(super) next_dq: Vec<f64>,
}

/// What effects see, see [`Instant`].
#[derive(Debug, Clone)]
pub(super) struct Seen {
    pub(super) q: Vec<f64>,
    pub(super) dq: Vec<f64>,
    pub(super) ddq: Vec<f64>,
    pub(super) load: Vec<f64>,
    pub(super) link: Vec<f64>,
    pub(super) gravity: Vec<f64>,
    pub(super) effects: Vec<f64>,
}

impl Work {
    /// Memory for a robot of `n` joints with `freedom` coordinates and these places of dry friction.
    pub(super) fn new(n: usize, freedom: usize, friction: &[DryElement]) -> Self {
        let elements = friction.len();
        Self {
            link_mass: vec![0.0; n * n],
            link_bias: vec![0.0; n],
            mass: vec![0.0; freedom * freedom],
            response: vec![0.0; elements * freedom],
            a: vec![0.0; elements * elements],
            b: vec![0.0; elements],
            limits: vec![[0.0; 2]; elements],
            chosen: Vec::with_capacity(elements),
            decisions: vec![Decision::Stick; elements],
            stiction: StictionScratch::new(elements),
            extra: vec![0.0; n],
            joint_levels: vec![[0.0; 2]; n],
            levels: friction.iter().map(|e| [e.level; 2]).collect(),
            seen: Seen {
                q: vec![0.0; n],
                dq: vec![0.0; n],
                ddq: vec![0.0; n],
                load: vec![0.0; n],
                link: vec![0.0; n],
                gravity: vec![0.0; n],
                effects: vec![0.0; n],
            },
            stages: Stages::new(freedom),
            stiff: Stiff::new(freedom),
            next_q: vec![0.0; freedom],
            next_dq: vec![0.0; freedom],
        }
    }
}

impl Seen {
    /// At a time.
    pub(super) fn at(&self, time: f64) -> Instant<'_> {
        let Self { q, dq, ddq, load, link, gravity, effects } = self;
        Instant { time, q, dq, ddq, load, link, gravity, effects }
    }
}

/// Memory of the stages of one step.
#[derive(Debug, Clone, Default)]
pub(super) struct Stages {
    /// Accelerations: the first at the start of the step, the last nearest its end.
    pub(super) slopes: [Vec<f64>; 4],
    /// Coordinates in between.
    pub(super) q: Vec<f64>,
    /// Their velocities.
    pub(super) dq: Vec<f64>,
}

impl Stages {
    fn new(freedom: usize) -> Self {
        let zero = || vec![0.0; freedom];
        Self { slopes: std::array::from_fn(|_| zero()), q: zero(), dq: zero() }
    }
}
