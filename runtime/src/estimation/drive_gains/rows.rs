//! The rows of an unloaded and a loaded recording in the unknowns of drive gains, base parameters and payload.

use nalgebra::{DMatrix, DVector};

use crate::estimation::Factor;
use crate::estimation::observe::{EquationFactor, Equations, Observation, Rows};
use crate::estimation::payload::Split;
use crate::estimation::weights::{Weights, from_own_fits};

/// Gains, base parameters and free numbers of the payload.
#[derive(Debug, Clone)]
pub(super) struct Values {
    /// Of each joint: what its recorded torque is multiplied by.
    pub gains: Vec<f64>,
    pub base: DVector<f64>,
    pub free: DVector<f64>,
}

/// Both recordings.
pub(super) struct Both<'a> {
    /// Without and with the payload.
    pub observations: [&'a Observation; 2],
    /// What each number of the payload adds to each base parameter: base parameters x 10.
    pub added: DMatrix<f64>,
    /// What is known of the payload.
    pub split: Split,
    /// Base parameters whose values are known, ascending.
    pub fixed: Vec<(usize, f64)>,
}

impl<'a> Both<'a> {
    /// Groups of both, and whether they are loaded; the unloaded ones first.
    pub fn groups(&self) -> impl Iterator<Item = (bool, &'a EquationFactor)> {
        let [unloaded, loaded] = self.observations;
        unloaded.groups.iter().map(|g| (false, g)).chain(loaded.groups.iter().map(|g| (true, g)))
    }

    /// Errors of the groups in units of the recorded torques, each joint fitted alone: gains do not matter to it.
    pub fn errors(&self) -> Weights {
        let [mut all, loaded] = self.observations.map(from_own_fits);
        all.sigma.extend(loaded.sigma);
        all.freedom.extend(loaded.freedom);
        all.rows_worth_one.extend(loaded.rows_worth_one);
        all
    }

    /// Numbers of base parameters and of free numbers of the payload.
    pub fn sizes(&self) -> [usize; 2] {
        [self.added.nrows(), self.split.free.ncols()]
    }

    /// The same where nothing gives a scale: no value is known then.
    pub fn of_ratios(&self) -> Both<'a> {
        Both { added: self.added.clone(), split: self.split.clone(), fixed: Vec::new(), ..*self }
    }

    /// The value of a base parameter, where it is known.
    pub fn known_value(&self, base: usize) -> Option<f64> {
        self.fixed.iter().find(|(k, _)| *k == base).map(|(_, value)| *value)
    }

    /// The homogeneous rows of these joints, `[-W -W_L -W_Lm diag(i)]`, those of a joint over its error and its gain so far.
    /// Columns: base parameters (zeros for those that are known), free numbers of the payload, what is known of both, the
    /// joints' torques.
    pub fn homogeneous(&self, joints: &[usize], sigma: &[f64], gains: &[f64]) -> Factor {
        let [base, free] = self.sizes();
        let exact = base + free + 1;
        let mut all = Factor::new(exact + joints.len());
        let columns: Vec<usize> = (0..exact + joints.len()).collect();
        for ((loaded, group), sigma) in self.groups().zip(sigma) {
            let Some(place) = joints.iter().position(|&j| j == group.equation) else { continue };
            if group.factor.rows() == 0 {
                continue;
            }
            let k = group.columns.len();
            let mut to = DMatrix::zeros(k + 1, exact + joints.len() + 1);
            for (c, &l) in group.columns.iter().enumerate() {
                match self.known_value(l) {
                    None => to[(c, l)] = -1.0,
                    Some(value) => to[(c, base + free)] = -value,
                }
                if loaded {
                    let added = self.added.row(l);
                    to.view_mut((c, base), (1, free)).copy_from(&-(added * &self.split.free));
                    to[(c, base + free)] -= (added * &self.split.known)[0];
                }
            }
            to[(k, exact + place)] = 1.0;
            let weight = 1.0 / (sigma * gains[group.equation].abs());
            all.merge_weighted(&group.factor.times(&to), &columns, weight);
        }
        all
    }

    /// The recorded torques as `W x / g` about a solution, to first order: an observation whose unknowns are the relative
    /// changes of the gains of `joints`, the base parameters and the free numbers of the payload. Its torques are those
    /// recorded, less what is known of robot and payload makes; only they have errors.
    pub fn linearised(&self, joints: &[usize], fixed: Option<usize>, values: &Values) -> Observation {
        let [base, free] = self.sizes();
        let first = joints.len();
        let [unloaded, loaded] = self.observations;
        let before = unloaded.trajectories.len();
        let mut groups = Vec::new();
        let mut rows = Vec::new();
        let kept = |o: &'a Observation| o.rows.as_deref().unwrap_or_default();
        let all_rows: Vec<&Rows> = kept(unloaded).iter().chain(kept(loaded)).collect();
        for (place, (is_loaded, group)) in self.groups().enumerate() {
            let joint = joints.iter().position(|&j| j == group.equation);
            let own = joint.filter(|_| fixed != Some(group.equation));
            let columns: Vec<usize> = own
                .into_iter()
                .chain(self.unknown_of(group).map(|(_, l)| first + l))
                .chain((0..free).filter(|_| is_loaded).map(|f| first + base + f))
                .collect();
            let change = self.change(group, is_loaded, own.is_some(), values);
            let trajectory = group.trajectory + if is_loaded { before } else { 0 };
            let factor = match joint {
                Some(_) => group.factor.times(&change),
                None => Factor::new(columns.len()),
            };
            groups.push(EquationFactor {
                trajectory,
                equation: group.equation,
                columns,
                factor,
                reversals: Vec::new(),
            });
            if let (Some(from), Some(group)) = (all_rows.get(place), groups.last()) {
                rows.push(changed_rows(from, group, &change, joint.is_some()));
            }
        }
        let unknowns = first + base + free;
        let both = |of: fn(&Observation) -> &Vec<f64>| [of(unloaded).clone(), of(loaded).clone()].concat();
        Observation {
            equations: Equations::Torque,
            unknowns: (0..unknowns).map(|k| format!("x{k}")).collect(),
            base: unknowns,
            fixed: Vec::new(),
            exact: vec![true; unknowns],
            trajectories: [unloaded.trajectories.clone(), loaded.trajectories.clone()].concat(),
            rates: both(|o| &o.rates),
            bands: both(|o| &o.bands),
            rows: (rows.len() == groups.len()).then_some(rows),
            groups,
            blocks: Vec::new(),
            left_out: Vec::new(),
            samples: unloaded.samples + loaded.samples,
            noise_of_columns: None,
        }
    }

    /// Base parameters of a group that are not known, with the places of their columns.
    fn unknown_of(&self, group: &'a EquationFactor) -> impl Iterator<Item = (usize, usize)> {
        group.columns.iter().copied().enumerate().filter(|&(_, l)| self.known_value(l).is_none())
    }

    /// From the columns of a group, the torque last, to those of its linearisation.
    fn change(&self, group: &'a EquationFactor, loaded: bool, own: bool, values: &Values) -> DMatrix<f64> {
        let k = group.columns.len();
        let free = if loaded { self.split.free.ncols() } else { 0 };
        let gain = values.gains[group.equation];
        let first = usize::from(own);
        let unknown = self.unknown_of(group).count();
        let mut to = DMatrix::zeros(k + 1, first + unknown + free + 1);
        let last = to.ncols() - 1;
        for (place, (c, _)) in self.unknown_of(group).enumerate() {
            to[(c, first + place)] = 1.0 / gain;
        }
        for (c, &l) in group.columns.iter().enumerate() {
            let mut x = values.base[l];
            to[(c, last)] = -self.known_value(l).unwrap_or(0.0) / gain;
            if loaded {
                let added = self.added.row(l);
                let of_free = added * &self.split.free;
                let of_known = (added * &self.split.known)[0];
                x += (&of_free * &values.free)[0] + of_known;
                to.view_mut((c, first + unknown), (1, free)).copy_from(&(of_free / gain));
                to[(c, last)] -= of_known / gain;
            }
            if own {
                to[(c, 0)] = -x / gain;
            }
        }
        to[(k, last)] = 1.0;
        to
    }
}

fn changed_rows(from: &Rows, group: &EquationFactor, change: &DMatrix<f64>, used: bool) -> Rows {
    let n = from.y.len();
    let k = from.columns.len();
    let mut all = DMatrix::zeros(n, k + 1);
    for c in 0..k {
        all.column_mut(c).copy_from_slice(&from.w[c * n..(c + 1) * n]);
    }
    all.column_mut(k).copy_from_slice(&from.y);
    let product = all * change;
    let last = product.ncols() - 1;
    Rows {
        trajectory: group.trajectory,
        equation: group.equation,
        sample: from.sample.clone(),
        time: from.time.clone(),
        y: product.column(last).iter().copied().collect(),
        columns: group.columns.clone(),
        w: product.columns(0, last).iter().copied().collect(),
        used: from.used.iter().map(|u| *u && used).collect(),
    }
}
