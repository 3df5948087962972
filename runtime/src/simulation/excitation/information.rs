//! What a motion tells about the parameters: the weighted information matrix of IDIM or PIM.

use nalgebra::DMatrix;

use crate::model::{Model, ParameterKind, Robot, States};
use crate::simulation::Reference;

/// Which model the motion is to identify.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Identification {
    /// The inverse dynamic model, one equation a joint (6).
    Idim,
    /// The power model, one equation in all (11).
    Pim,
}

/// Evaluates observation matrices of planned motions. Rows are weighted by the torque noise, columns scaled by a
/// priori sizes of the parameters (Gautier and Khalil 1992), so that the conditioning does not depend on units.
#[derive(Clone)]
pub struct Observer<'m> {
    model: &'m dyn Model,
    /// What the motion is for.
    pub identification: Identification,
    /// A priori size of each base parameter.
    pub scale: Vec<f64>,
    /// Place of each base parameter among the unknowns; none where its value is known beforehand.
    place: Vec<Option<usize>>,
    /// Noise of each joint's torque, 1 sigma.
    pub noise: Vec<f64>,
    chi: Option<Vec<f64>>,
    samples: usize,
    signals: [Vec<f64>; 3],
    columns: Vec<f64>,
}

impl<'m> Observer<'m> {
    /// An observer that samples `samples` instants of a motion. `chi` gives the parameters' sizes and the torques
    /// of the motion, where they are known.
    pub fn new(
        model: &'m dyn Model,
        chi: Option<&[f64]>,
        identification: Identification,
        samples: usize,
    ) -> Self {
        let robot = model.robot();
        let n = robot.joints();
        let columns = model.pattern().columns.len().max(robot.base.len());
        let noise = match &robot.nominal {
            Some(nominal) if nominal.torque_noise.len() == n => nominal.torque_noise.to_vec(),
            _ => vec![1.0; n],
        };
        Self {
            model,
            identification,
            scale: parameter_sizes(robot, chi),
            place: places(robot),
            noise,
            chi: chi.map(<[f64]>::to_vec),
            samples,
            signals: std::array::from_fn(|_| vec![0.0; n * samples]),
            columns: vec![0.0; columns * samples],
        }
    }

    /// Number of unknowns: base parameters but for those whose values are known.
    pub fn unknowns(&self) -> usize {
        self.place.iter().flatten().count()
    }

    /// Adds the information of a motion to `information` (unknowns x unknowns, lower triangle). Returns the largest share of
    /// a torque limit that the sampled torques take; 0 where the parameters or the limits are not known.
    pub fn add(&mut self, motion: &dyn Reference, information: &mut DMatrix<f64>) -> f64 {
        self.sample(motion);
        match self.identification {
            Identification::Idim => self.add_torques(Some(information)),
            Identification::Pim => {
                self.add_power(information);
                self.add_torques(None)
            }
        }
    }

    fn sample(&mut self, motion: &dyn Reference) {
        let n = motion.joints();
        let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in 0..self.samples {
            // Off the ends, where everything is at rest.
            let t = motion.duration() * (k as f64 + 0.5) / self.samples as f64;
            motion.at(t, &mut q, &mut dq, &mut ddq);
            for (signal, values) in self.signals.iter_mut().zip([&q, &dq, &ddq]) {
                for j in 0..n {
                    signal[j * self.samples + k] = values[j];
                }
            }
        }
    }

    fn add_torques(&mut self, information: Option<&mut DMatrix<f64>>) -> f64 {
        let (samples, robot) = (self.samples, self.model.robot());
        if information.is_none() && (self.chi.is_none() || robot.limits.torque.is_empty()) {
            return 0.0;
        }
        let slices = self.signals.each_ref().map(|s| s.chunks_exact(samples).collect::<Vec<_>>());
        let states = States { q: &slices[0], dq: &slices[1], ddq: &slices[2] };
        self.model.idm_block(states, samples, &mut self.columns);
        let pattern = self.model.pattern();
        let mut share = 0.0_f64;
        if let (Some(chi), limits) = (&self.chi, &robot.limits.torque) {
            for (j, limit) in limits.iter().enumerate() {
                for t in 0..samples {
                    let entries = pattern.rows[j]..pattern.rows[j + 1];
                    let torque: f64 =
                        entries.map(|e| self.columns[e * samples + t] * chi[pattern.columns[e]]).sum();
                    share = share.max(torque / if torque > 0.0 { limit[1] } else { limit[0] });
                }
            }
        }
        let Some(information) = information else { return share };
        for j in 0..pattern.rows.len() - 1 {
            let weight = 1.0 / (self.noise[j] * self.noise[j]);
            let entries = pattern.rows[j]..pattern.rows[j + 1];
            for a in entries.clone() {
                let column_a = &self.columns[a * samples..][..samples];
                let ca = pattern.columns[a];
                let Some(row) = self.place[ca] else { continue };
                for b in entries.start..=a {
                    let cb = pattern.columns[b];
                    let Some(column) = self.place[cb] else { continue };
                    let product = dot(column_a, &self.columns[b * samples..][..samples]);
                    information[(row, column)] += weight * self.scale[ca] * self.scale[cb] * product;
                }
            }
        }
        share
    }

    fn add_power(&mut self, information: &mut DMatrix<f64>) {
        let samples = self.samples;
        let slices = self.signals.each_ref().map(|s| s.chunks_exact(samples).collect::<Vec<_>>());
        let states = States { q: &slices[0], dq: &slices[1], ddq: &slices[2] };
        self.model.power_block(states, samples, &mut self.columns);
        // Variance of the measured power dqᵀ·tau, over the motion: one weight a motion as in WLS.
        let variance: f64 = slices[1]
            .iter()
            .zip(&self.noise)
            .map(|(dq, noise)| noise * noise * dot(dq, dq) / samples as f64)
            .sum();
        if variance <= 0.0 {
            return;
        }
        for a in 0..self.scale.len() {
            let column_a = &self.columns[a * samples..][..samples];
            let Some(row) = self.place[a] else { continue };
            for b in 0..=a {
                let Some(column) = self.place[b] else { continue };
                let product = dot(column_a, &self.columns[b * samples..][..samples]);
                information[(row, column)] += self.scale[a] * self.scale[b] * product / variance;
            }
        }
    }

    /// Which parameter blocks of (21) the motion reaches: `true` for joint j where any column of its unknown parameters
    /// is not zero. Fixed frames count to the joint that carries them.
    pub fn blocks(&mut self, motion: &dyn Reference) -> Vec<bool> {
        self.sample(motion);
        let samples = self.samples;
        let slices = self.signals.each_ref().map(|s| s.chunks_exact(samples).collect::<Vec<_>>());
        let states = States { q: &slices[0], dq: &slices[1], ddq: &slices[2] };
        self.model.power_block(states, samples, &mut self.columns);
        let robot = self.model.robot();
        let carriers = carriers(robot);
        let size = |k: usize| {
            let column = &self.columns[k * samples..][..samples];
            column.iter().fold(0.0_f64, |m, x| m.max(x.abs())) * self.scale[k]
        };
        let largest = (0..robot.base.len()).map(size).fold(0.0, f64::max);
        let mut blocks = vec![false; robot.joints()];
        for (k, parameter) in robot.base.iter().enumerate().filter(|(k, _)| self.place[*k].is_some()) {
            if let Some(j) = carriers[robot.standard[parameter.standard].frame] {
                blocks[j] |= size(k) > 1e-12 * largest;
            }
        }
        blocks
    }
}

/// log det (I + information): what the motion adds to a priori knowledge of the parameters' sizes, in nats times
/// two (Bayesian D-optimality).
pub fn log_determinant(information: &DMatrix<f64>) -> f64 {
    let n = information.nrows();
    let posterior = DMatrix::from_fn(n, n, |i, j| {
        let entry = if i >= j { information[(i, j)] } else { information[(j, i)] };
        entry + if i == j { 1.0 } else { 0.0 }
    });
    match posterior.cholesky() {
        Some(factor) => 2.0 * (0..n).map(|k| factor.l_dirty()[(k, k)].ln()).sum::<f64>(),
        None => f64::NEG_INFINITY,
    }
}

/// Condition number of the weighted, scaled observation matrix: the root of that of the information matrix.
/// Infinite where a parameter is not observed.
pub fn condition(information: &DMatrix<f64>) -> f64 {
    let [low, high] = extreme_eigenvalues(information);
    if low > 1e-15 * high { (high / low).sqrt() } else { f64::INFINITY }
}

/// Smallest and largest eigenvalue of a matrix of which the lower triangle is given; NaN where it is not finite.
fn extreme_eigenvalues(information: &DMatrix<f64>) -> [f64; 2] {
    if !information.iter().all(|x| x.is_finite()) {
        return [f64::NAN; 2];
    }
    let n = information.nrows();
    let full = DMatrix::from_fn(n, n, |i, j| information[(i.max(j), i.min(j))]);
    let eigenvalues = full.symmetric_eigenvalues();
    [eigenvalues.min(), eigenvalues.max()]
}

/// What makes one set of motions better than another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// A large determinant of the information matrix, a priori knowledge of the parameters' sizes included: all
    /// parameters together are known well. [`log_determinant`]
    Determinant,
    /// A small condition number of the weighted, scaled observation matrix: no combination of parameters is known
    /// much worse than another. [`condition`]
    Condition,
}

impl Criterion {
    /// The larger the better; information that is not finite is the worst.
    pub fn merit(self, information: &DMatrix<f64>) -> f64 {
        match self {
            Criterion::Determinant => log_determinant(information),
            Criterion::Condition => {
                // Where a parameter is not observed at all, the search is still told which way is down.
                let [low, high] = extreme_eigenvalues(information);
                if high > 0.0 { 0.5 * (low.max(1e-16 * high) / high).ln() } else { f64::NEG_INFINITY }
            }
        }
    }
}

/// The joint that carries each frame: its own, the last that moves it, or that of the nearest ancestor that moves.
fn carriers(robot: &Robot) -> Vec<Option<usize>> {
    let (joints, motions) = (robot.joint_of_frame(), robot.motions());
    let mut carriers: Vec<Option<usize>> = Vec::with_capacity(joints.len());
    for (frame, row) in robot.frames.iter().enumerate() {
        let moved = motions[frame].terms.last().map(|term| term.0);
        let carrier = joints[frame].or(moved).or_else(|| row.parent.and_then(|p| carriers[p]));
        carriers.push(carrier);
    }
    carriers
}

/// Place of each base parameter among those whose values are not known.
fn places(robot: &Robot) -> Vec<Option<usize>> {
    let known = robot.fixed_base();
    let mut next = 0..;
    let is_free = |k: usize| known.iter().all(|(known, _)| *known != k);
    (0..robot.base.len()).map(|k| if is_free(k) { next.next() } else { None }).collect()
}

/// A priori size of each base parameter: its own value, but not less than 0.3 of the largest of its kind on the
/// same frame; 1 where nothing is known.
fn parameter_sizes(robot: &Robot, chi: Option<&[f64]>) -> Vec<f64> {
    let Some(chi) = chi else { return vec![1.0; robot.base.len()] };
    let group = |k: usize| {
        let standard = &robot.standard[robot.base[k].standard];
        let family = match standard.kind {
            ParameterKind::MX | ParameterKind::MY | ParameterKind::MZ => 1,
            ParameterKind::M => 2,
            ParameterKind::Off | ParameterKind::KR => 4,
            ParameterKind::K => 5,
            kind if kind.is_viscous() => 3,
            kind if kind.is_coulomb() => 4,
            _ => 0,
        };
        (standard.frame, family)
    };
    (0..chi.len())
        .map(|k| {
            let peers = (0..chi.len()).filter(|&l| group(l) == group(k));
            let largest = peers.map(|l| chi[l].abs()).fold(0.0, f64::max);
            let size = chi[k].abs().max(0.3 * largest);
            if size > 0.0 { size } else { 0.01 }
        })
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 4];
    let (ca, ra) = a.as_chunks::<4>();
    let (cb, rb) = b.as_chunks::<4>();
    for (x, y) in ca.iter().zip(cb) {
        for k in 0..4 {
            lanes[k] += x[k] * y[k];
        }
    }
    lanes.iter().sum::<f64>() + ra.iter().zip(rb).map(|(x, y)| x * y).sum::<f64>()
}
