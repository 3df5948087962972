//! Inner products of columns on white rows, unit by unit: what evidence is worked out from.
//!
//! The residual of each joint is made white by an autoregression, its columns with it, and what is free in every motion
//! (its friction level, where there is a baseline) is projected out.

use crate::diagnosis::judging::ar::Autoregression;
use crate::diagnosis::judging::projection::{Projection, factored};
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rows::prior::Prior;
use crate::diagnosis::rules::{FREED, HIGHEST_AR_ORDER};
use crate::parallel;
use crate::statistics::moderation::Variance;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;
use std::sync::OnceLock;

/// What a law is judged against: everything by row, over all rows of all joints.
pub(in crate::diagnosis) struct Regressors<'a> {
    /// Columns of the model and its nuisances.
    pub shared: &'a [Vec<f64>],
    pub y: &'a [f64],
    /// Columns of each joint that are free in every motion, values on the joint's rows.
    pub free: &'a [Vec<Vec<f64>>],
    /// Other laws of each joint, values on the joint's rows: how much they vary from unit to unit tells how much laws
    /// of this joint do.
    pub companions: &'a [Vec<Vec<f64>>],
    /// What is known of the shared columns beforehand.
    pub prior: Option<&'a Prior>,
    /// Per joint the mean statistic of a law in a motion as long as the recording's, where nothing has changed, as a model of
    /// the robot before knows it; empty where there is none.
    pub between_motions: &'a [Option<Variance>],
    /// Rows of each joint.
    pub of_joint: &'a [Range<usize>],
}

impl Regressors<'_> {
    /// Whether a law, given as columns over all rows, acts on a joint.
    pub fn acts_on(&self, law: &[Vec<f64>], joint: usize) -> bool {
        let range = self.of_joint[joint].clone();
        law.iter().any(|c| c[range.clone()].iter().any(|x| *x != 0.0))
    }

    /// A column of a joint, given as values on its rows, over all rows.
    pub fn on_all_rows(&self, joint: usize, on_joint: &[f64]) -> Vec<f64> {
        let mut column = vec![0.0; self.y.len()];
        column[self.of_joint[joint].clone()].copy_from_slice(on_joint);
        column
    }
}

/// Inner products of `[columns, law, y, companions]` in each unit and each motion.
pub(in crate::diagnosis) struct Products {
    pub units: Vec<DMatrix<f64>>,
    pub files: Vec<DMatrix<f64>>,
    /// Companions that are the last of the columns.
    pub companions: usize,
}

impl Products {
    fn zero(units: &Units, width: usize, companions: usize) -> Self {
        let zero = DMatrix::zeros(width, width);
        Self { units: vec![zero.clone(); units.units.len()], files: vec![zero; units.files()], companions }
    }

    /// Adds those of one joint, whose columns stand at `places` here.
    fn add(&mut self, part: &Self, places: &[usize]) {
        for (sum, part) in self.units.iter_mut().zip(&part.units) {
            add(sum, part, places);
        }
        for (sum, part) in self.files.iter_mut().zip(&part.files) {
            add(sum, part, places);
        }
    }
}

/// Inner products without any law, joint by joint: the same for all laws of a round.
pub(in crate::diagnosis) struct Background {
    of_joint: Vec<Products>,
    /// Of all joints but one, each when it is first asked for.
    of_others: Vec<OnceLock<Products>>,
    residual: Vec<f64>,
}

impl Background {
    /// Of a model that leaves `residual`.
    pub fn new(units: &Units, regressors: &Regressors<'_>, residual: &[f64], threads: usize) -> Self {
        let of_joint = |j| of_joint(units, regressors, j, &[], &[], residual);
        Self {
            of_joint: parallel::map(threads, regressors.of_joint.len(), of_joint),
            of_others: regressors.of_joint.iter().map(|_| OnceLock::new()).collect(),
            residual: residual.to_vec(),
        }
    }

    /// Of all joints but one.
    fn of_others(&self, units: &Units, joint: usize) -> &Products {
        self.of_others[joint].get_or_init(|| {
            let width = self.of_joint[joint].units.first().map_or(0, DMatrix::nrows);
            let mut sum = Products::zero(units, width, 0);
            let places: Vec<usize> = (0..width).collect();
            for (_, part) in self.of_joint.iter().enumerate().filter(|(j, _)| *j != joint) {
                sum.add(part, &places);
            }
            sum
        })
    }

    /// With a law, given as columns over all rows, that leaves `residual`, and the companions of its joints, all joints
    /// together. Those of joints whose residual the law leaves as it was are the background's.
    pub fn with(
        &self,
        units: &Units,
        regressors: &Regressors<'_>,
        law: &[Vec<f64>],
        residual: &[f64],
    ) -> Products {
        let (p, k) = (regressors.shared.len(), law.len());
        // Through the parameters that joints share, a law on one joint frees others of what it had left there.
        let frees = |j: usize| {
            let range = regressors.of_joint[j].clone();
            let squares = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
            let [before, after] = [&self.residual[..], residual].map(|r| squares(&r[range.clone()]));
            after < (1.0 - FREED) * before
        };
        let own: Vec<bool> = (0..regressors.of_joint.len()).map(|j| regressors.acts_on(law, j)).collect();
        let companions = (0..own.len()).filter(|&j| own[j]).map(|j| regressors.companions[j].len()).sum();
        let mut out = Products::zero(units, p + k + 1 + companions, companions);
        let mut first = p + k + 1;
        // Without the law, y is the column after the p of the model.
        let without_law: Vec<usize> = (0..p).chain([p + k]).collect();
        let mut rest: Vec<usize> = (0..own.len()).collect();
        if let [joint] = (0..own.len()).filter(|&j| own[j] || frees(j)).collect::<Vec<_>>()[..] {
            out.add(self.of_others(units, joint), &without_law);
            rest = vec![joint];
        }
        for j in rest {
            if own[j] {
                let companions = &regressors.companions[j];
                let part = of_joint(units, regressors, j, law, companions, residual);
                let places: Vec<usize> = (0..p + k + 1).chain(first..first + companions.len()).collect();
                first += companions.len();
                out.add(&part, &places);
            } else if frees(j) {
                let part = of_joint(units, regressors, j, &[], &[], residual);
                out.add(&part, &without_law);
            } else {
                out.add(&self.of_joint[j], &without_law);
            }
        }
        out
    }

    /// Without a law, and with companions of one joint.
    pub fn with_companions(
        &self,
        units: &Units,
        regressors: &Regressors<'_>,
        joint: usize,
        companions: &[Vec<f64>],
    ) -> Products {
        let width = regressors.shared.len() + 1;
        let mut out = Products::zero(units, width + companions.len(), companions.len());
        out.add(self.of_others(units, joint), &(0..width).collect::<Vec<usize>>());
        let own = of_joint(units, regressors, joint, &[], companions, &self.residual);
        out.add(&own, &(0..width + companions.len()).collect::<Vec<usize>>());
        out
    }
}

/// Inner products of `[columns, law, y, companions]` on one joint, made white, without what the free columns make.
fn of_joint(
    units: &Units,
    regressors: &Regressors<'_>,
    j: usize,
    law: &[Vec<f64>],
    companions: &[Vec<f64>],
    residual: &[f64],
) -> Products {
    let range = &regressors.of_joint[j];
    let width = regressors.shared.len() + law.len() + 1 + companions.len();
    let mut out = Products::zero(units, width, companions.len());
    if range.is_empty() {
        return out;
    }
    let Whitening { stretches, ar, free } = Whitening::of(units, regressors, j, residual);
    let on_joint = regressors.shared.iter().chain(law).map(|c| &c[range.clone()]);
    let all: Vec<Option<Vec<f64>>> = on_joint
        .chain([&regressors.y[range.clone()]])
        .chain(companions.iter().map(Vec::as_slice))
        .map(|c| c.iter().any(|x| *x != 0.0).then(|| ar.whitened(&stretches, c)))
        .collect();
    let live: Vec<usize> = (0..width).filter(|&i| all[i].is_some()).collect();
    let columns: Vec<&[f64]> =
        free.iter().map(Vec::as_slice).chain(live.iter().filter_map(|&i| all[i].as_deref())).collect();
    let mut of_file = vec![DMatrix::zeros(columns.len(), columns.len()); out.files.len()];
    for (u, unit) in units.units.iter().enumerate() {
        let rows = local_or_empty(&units.rows[j][u], range);
        if rows.is_empty() {
            continue;
        }
        let gram = gram(&columns, rows);
        of_file[unit.file] += &gram;
        add(&mut out.units[u], &project(&gram, free.len()), &live);
    }
    for (file, gram) in of_file.iter().enumerate() {
        add(&mut out.files[file], &project(gram, free.len()), &live);
    }
    out
}

/// What makes the rows of a joint white.
struct Whitening {
    /// Neighbouring rows, as places among the joint's.
    stretches: Vec<Range<usize>>,
    ar: Autoregression,
    /// What is free in every motion, white.
    free: Vec<Vec<f64>>,
}

impl Whitening {
    /// Of a model that leaves `residual`, beside what is free in every motion.
    fn of(units: &Units, regressors: &Regressors<'_>, j: usize, residual: &[f64]) -> Self {
        let range = &regressors.of_joint[j];
        let local = |r: &Range<usize>| r.start - range.start..r.end - range.start;
        let stretches: Vec<Range<usize>> = units.stretches[j].iter().map(local).collect();
        let left = without_free(units, j, range, &residual[range.clone()], &regressors.free[j]);
        let ar = Autoregression::fit(&stretches, &left, HIGHEST_AR_ORDER);
        let free = regressors.free[j].iter().map(|c| ar.whitened(&stretches, c)).collect();
        Self { stretches, ar, free }
    }
}

/// A column over all rows and the residual of a model on one joint, both made white, without what is free in every motion.
pub(super) fn white_with_residual(
    units: &Units,
    regressors: &Regressors<'_>,
    j: usize,
    column: &[f64],
    residual: &[f64],
) -> [Vec<f64>; 2] {
    let range = &regressors.of_joint[j];
    let Whitening { stretches, ar, free } = Whitening::of(units, regressors, j, residual);
    let white = |c: &[f64]| without_free(units, j, range, &ar.whitened(&stretches, &c[range.clone()]), &free);
    [white(column), white(residual)]
}

fn local_or_empty(rows: &Range<usize>, of: &Range<usize>) -> Range<usize> {
    if rows.is_empty() { 0..0 } else { rows.start - of.start..rows.end - of.start }
}

/// The residual of a joint without what its free columns make of it in each motion.
fn without_free(
    units: &Units,
    j: usize,
    range: &Range<usize>,
    residual: &[f64],
    free: &[Vec<f64>],
) -> Vec<f64> {
    let mut left = residual.to_vec();
    if free.is_empty() {
        return left;
    }
    for file in 0..units.files() {
        let rows: Vec<usize> = (0..units.units.len())
            .filter(|&u| units.units[u].file == file)
            .flat_map(|u| local_or_empty(&units.rows[j][u], range))
            .collect();
        let f = free.len();
        let g = DMatrix::from_fn(f, f, |a, b| rows.iter().map(|&r| free[a][r] * free[b][r]).sum::<f64>());
        let b = DVector::from_fn(f, |a, _| rows.iter().map(|&r| free[a][r] * residual[r]).sum::<f64>());
        if let Some((factor, scale)) = factored(&g) {
            let x = factor.solve(&b.component_mul(&scale)).component_mul(&scale);
            for &r in &rows {
                left[r] -= (0..f).map(|a| x[a] * free[a][r]).sum::<f64>();
            }
        }
    }
    left
}

fn gram(columns: &[&[f64]], rows: Range<usize>) -> DMatrix<f64> {
    let n = columns.len();
    let mut g = DMatrix::zeros(n, n);
    for i in 0..n {
        for k in 0..=i {
            let value = dot(&columns[i][rows.clone()], &columns[k][rows.clone()]);
            g[(i, k)] = value;
            g[(k, i)] = value;
        }
    }
    g
}

/// Inner products of the columns after the first `f` without what those first make of them.
fn project(g: &DMatrix<f64>, f: usize) -> DMatrix<f64> {
    let n = g.nrows() - f;
    let rest = g.view((f, f), (n, n)).into_owned();
    if f == 0 {
        return rest;
    }
    let Some(free) = Projection::of(g, f) else { return rest };
    let white = free.white(g, f, n);
    rest - white.tr_mul(&white)
}

fn add(sum: &mut DMatrix<f64>, part: &DMatrix<f64>, places: &[usize]) {
    // Places that are counted from the first on are added a column at a time.
    let same = places.iter().enumerate().take_while(|&(a, &i)| a == i).count();
    let (width, rows) = (sum.nrows(), part.nrows());
    for (b, &k) in places.iter().enumerate() {
        let to = &mut sum.as_mut_slice()[k * width..][..width];
        let from = &part.as_slice()[b * rows..][..rows];
        to.iter_mut().zip(&from[..same]).for_each(|(sum, x)| *sum += x);
        for (&i, x) in places.iter().zip(from).skip(same) {
            to[i] += x;
        }
    }
}
