//! What some instants of a recording leave of the torques where numbers of joints are far off.

use crate::model::{Model, States};
use nalgebra::{DMatrix, DVector};

/// Ridge on each parameter, as a part of its own squares: what no motion tells stays bounded. Numerics.
const RIDGE: f64 = 1e-10;

/// Which number of a joint is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wrong {
    /// The joint is beyond where its encoder sees it, rad.
    Zero,
    /// Its torques are recorded larger than they are: the logarithm of the factor.
    #[cfg_attr(not(feature = "diagnosis"), expect(dead_code, reason = "the diagnosis alone looks for these"))]
    Gain,
}

/// A number of a joint (0-based).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Number {
    pub joint: usize,
    pub wrong: Wrong,
}

/// Some instants of a recording.
pub(crate) struct Instants {
    /// q, dq and ddq, `[j][instant]`.
    pub states: [Vec<Vec<f64>>; 3],
    /// For each instant the joints that have a row there, with their torques.
    pub torques: Vec<Vec<(usize, f64)>>,
    /// What rows of each joint are divided by.
    pub sigma: Vec<f64>,
    /// Base parameters of the robot.
    pub parameters: usize,
    /// Those whose values are known, all of them where the robot is.
    pub known: Vec<(usize, f64)>,
}

impl Instants {
    /// Whether every value would leave next to nothing.
    pub fn are_few(&self) -> bool {
        let rows: usize = self.torques.iter().map(Vec::len).sum();
        rows < 2 * (self.parameters - self.known.len())
    }

    /// How many joints the robot has.
    pub fn joints(&self) -> usize {
        self.sigma.len()
    }

    /// The mean squares of each joint's rows in a residual; 0 for a joint without rows.
    pub fn mean_squares(&self, residual: &DVector<f64>) -> Vec<f64> {
        let mut left = vec![(0.0, 0.0); self.joints()];
        for (e, j) in residual.iter().zip(self.joint_of_rows()) {
            left[j] = (left[j].0 + e * e, left[j].1 + 1.0);
        }
        left.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 0.0 }).collect()
    }

    /// The joint of each row.
    pub fn joint_of_rows(&self) -> impl Iterator<Item = usize> {
        self.torques.iter().flatten().map(|&(joint, _)| joint)
    }

    /// What is left of the rows, in units of the joints' sigma, where numbers are so far off and all parameters that are not known
    /// are fitted; `None` where there is no fit.
    pub fn residual(&self, model: &dyn Model, errors: &[(Number, f64)]) -> Option<DVector<f64>> {
        let (x, mut y) = self.rows(model, errors);
        let mut chi = DVector::zeros(self.parameters);
        self.known.iter().for_each(|&(k, value)| chi[k] = value);
        y -= &x * &chi;
        let free: Vec<usize> =
            (0..self.parameters).filter(|k| !self.known.iter().any(|(known, _)| known == k)).collect();
        if !free.is_empty() {
            let x = x.select_columns(&free);
            let mut squares = x.tr_mul(&x);
            for i in 0..free.len() {
                squares[(i, i)] += RIDGE * squares[(i, i)] + f64::MIN_POSITIVE;
            }
            y -= &x * squares.cholesky()?.solve(&x.tr_mul(&y));
        }
        Some(y)
    }

    /// Columns and torques in units of the joints' sigma.
    fn rows(&self, model: &dyn Model, errors: &[(Number, f64)]) -> (DMatrix<f64>, DVector<f64>) {
        let pattern = model.pattern();
        let count = self.torques.len();
        let [mut q, dq, ddq] =
            [0, 1, 2].map(|k| self.states[k].iter().map(Vec::as_slice).collect::<Vec<_>>());
        let mut factor = vec![1.0; self.joints()];
        let mut moved = Vec::new();
        for &(Number { joint, wrong }, by) in errors {
            match wrong {
                Wrong::Zero => moved.push((joint, q[joint].iter().map(|q| q + by).collect::<Vec<_>>())),
                Wrong::Gain => factor[joint] *= by.exp(),
            }
        }
        moved.iter().for_each(|(joint, moved)| q[*joint] = moved.as_slice());
        let mut entries = vec![0.0; pattern.columns.len() * count];
        model.idm_block(States { q: &q, dq: &dq, ddq: &ddq }, count, &mut entries);
        let rows = self.torques.iter().map(Vec::len).sum();
        let (mut x, mut y) = (DMatrix::zeros(rows, self.parameters), DVector::zeros(rows));
        let at =
            self.torques.iter().enumerate().flat_map(|(t, torques)| torques.iter().map(move |own| (t, own)));
        for (r, (t, &(j, torque))) in at.enumerate() {
            let weight = 1.0 / self.sigma[j].max(f64::MIN_POSITIVE);
            y[r] = weight * torque;
            for e in pattern.rows[j]..pattern.rows[j + 1] {
                x[(r, pattern.columns[e])] = weight * factor[j] * entries[e * count + t];
            }
        }
        (x, y)
    }
}
