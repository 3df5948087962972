//! Inner products of columns on white rows, unit by unit: what evidence is worked out from.
//!
//! The residual of each joint is made white by an autoregression, its columns with it, and what is free in every motion
//! (its friction level, where there is a baseline) is projected out.

use crate::diagnosis::judging::projection::{Projection, inner_products};
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::taken;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::judging::whitening::{Whitening, local_or_empty};
use crate::diagnosis::rules::FREED;
use crate::parallel;
use nalgebra::DMatrix;
use std::sync::OnceLock;

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

    /// Those of all motion, with what is known of the columns beforehand; `y` is the column of the torque. What is free in every
    /// motion is so in each whole one where there is a baseline.
    pub fn whole(&self, units: &Units, regressors: &Regressors<'_>, y: usize) -> DMatrix<f64> {
        let mut whole = sum(if units.change() { &self.files } else { &self.units }, |_| true);
        if let Some(prior) = regressors.prior {
            prior.add_to_products(&mut whole, y);
        }
        whole
    }

    /// Those of several joints together, which have the same columns.
    fn of_all<'p>(units: &Units, width: usize, parts: impl Iterator<Item = &'p Self>) -> Self {
        let places: Vec<usize> = (0..width).collect();
        parts.fold(Self::zero(units, width, 0), |mut sum, part| {
            sum.add(part, &places);
            sum
        })
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
    /// Squares of the residual of each joint.
    squares: Vec<f64>,
    /// What makes each joint white.
    whitening: Vec<Whitening>,
}

impl Background {
    /// Of a model that leaves `residual`.
    pub fn new(units: &Units, regressors: &Regressors<'_>, residual: &[f64], threads: usize) -> Self {
        let joints: Vec<usize> = (0..regressors.of_joint.len()).collect();
        let nothing = Products::zero(units, regressors.shared.len() + 1, 0);
        let whitening = whitening(units, (regressors, &[]), residual, (&joints, nothing), threads);
        let of_joint = |j: usize| of_joint(units, regressors, j, &[], &[], &whitening[j]);
        Self {
            of_joint: parallel::map(threads, joints.len(), of_joint),
            of_others: joints.iter().map(|_| OnceLock::new()).collect(),
            squares: joints.iter().map(|&j| regressors.squares_on(j, residual)).collect(),
            whitening,
        }
    }

    /// Of all joints but one.
    fn of_others(&self, units: &Units, joint: usize) -> &Products {
        self.of_others[joint].get_or_init(|| {
            let width = self.of_joint[joint].units.first().map_or(0, DMatrix::nrows);
            let others = self.of_joint.iter().enumerate().filter(|(j, _)| *j != joint);
            Products::of_all(units, width, others.map(|(_, part)| part))
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
    ) -> WithLaw {
        let (p, k, joints) = (regressors.shared.len(), law.len(), regressors.of_joint.len());
        let acts_on: Vec<bool> = (0..joints).map(|j| regressors.acts_on(law, j)).collect();
        // Through the parameters that joints share, a law on one joint frees others of what it had left there.
        let is_freed = |j: usize| regressors.squares_on(j, residual) < (1.0 - FREED) * self.squares[j];
        let (of_law, rest): (Vec<usize>, Vec<usize>) = (0..joints).partition(|&j| acts_on[j] || is_freed(j));
        // Without the law, y is the column after the p of the model.
        let without_law: Vec<usize> = (0..p).chain([p + k]).collect();
        let mut others = Products::zero(units, p + k + 1, 0);
        if let [joint] = of_law[..] {
            others.add(self.of_others(units, joint), &without_law);
        } else {
            rest.iter().for_each(|&j| others.add(&self.of_joint[j], &without_law));
        }
        let companions =
            |j: usize| if acts_on[j] { regressors.companions[j].as_slice() } else { Default::default() };
        let number = of_law.iter().map(|&j| companions(j).len()).sum();
        let mut products = Products::zero(units, p + k + 1 + number, number);
        products.add(&others, &(0..p + k + 1).collect::<Vec<usize>>());
        let whitening = whitening(units, (regressors, law), residual, (&of_law, others), 1);
        let mut first = p + k + 1;
        for (&j, whitening) in of_law.iter().zip(&whitening) {
            let part = of_joint(units, regressors, j, law, companions(j), whitening);
            let places: Vec<usize> = (0..p + k + 1).chain(first..first + companions(j).len()).collect();
            first += companions(j).len();
            products.add(&part, &places);
        }
        WithLaw { products, whitening: of_law.into_iter().zip(whitening).collect() }
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
        let own = of_joint(units, regressors, joint, &[], companions, &self.whitening[joint]);
        out.add(&own, &(0..width + companions.len()).collect::<Vec<usize>>());
        out
    }
}

/// Inner products with a law.
pub(in crate::diagnosis) struct WithLaw {
    pub products: Products,
    /// What makes each joint white that the law acts on or frees.
    pub(super) whitening: Vec<(usize, Whitening)>,
}

/// What makes joints white on which a model with a law leaves `residual`: an autoregression of that and of what the model took of
/// the noise, given the inner products `[columns, law, y]` of all other joints. What was taken is that of generalised least
/// squares with an autoregression of the residual alone.
fn whitening(
    units: &Units,
    (regressors, law): (&Regressors<'_>, &[Vec<f64>]),
    residual: &[f64],
    (joints, others): (&[usize], Products),
    threads: usize,
) -> Vec<Whitening> {
    let (mut all, m) = (others, regressors.shared.len() + law.len());
    let as_left = parallel::map(threads, joints.len(), |i| {
        let whitening = Whitening::of(units, regressors, joints[i], (residual, None));
        (of_joint(units, regressors, joints[i], law, &[], &whitening), whitening)
    });
    let places: Vec<usize> = (0..=m).collect();
    as_left.iter().for_each(|(part, _)| all.add(part, &places));
    let model = Projection::of(&all.whole(units, regressors, m), m);
    parallel::map(threads, joints.len(), |i| {
        let of_model = |model| taken::by_fit(units, (regressors, law), joints[i], (model, &as_left[i].1));
        let taken = model.as_ref().map(of_model);
        Whitening::of(units, regressors, joints[i], (residual, taken.as_ref()))
    })
}

/// Inner products of `[columns, law, y, companions]` on one joint, made white, without what the free columns make.
pub(super) fn of_joint(
    units: &Units,
    regressors: &Regressors<'_>,
    j: usize,
    law: &[Vec<f64>],
    companions: &[Vec<f64>],
    whitening: &Whitening,
) -> Products {
    let range = &regressors.of_joint[j];
    let width = regressors.shared.len() + law.len() + 1 + companions.len();
    let mut out = Products::zero(units, width, companions.len());
    if range.is_empty() {
        return out;
    }
    let Whitening { stretches, ar, free } = whitening;
    let on_joint = regressors.shared.iter().chain(law).map(|c| &c[range.clone()]);
    let all: Vec<Option<Vec<f64>>> = on_joint
        .chain([&regressors.y[range.clone()]])
        .chain(companions.iter().map(Vec::as_slice))
        .map(|c| c.iter().any(|x| *x != 0.0).then(|| ar.whitened(stretches, c)))
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
        let gram = inner_products(&columns, rows);
        of_file[unit.file] += &gram;
        add(&mut out.units[u], &project(&gram, free.len()), &live);
    }
    for (file, gram) in of_file.iter().enumerate() {
        add(&mut out.files[file], &project(gram, free.len()), &live);
    }
    out
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

/// The sum of those matrices of a list that are taken.
pub(super) fn sum(list: &[DMatrix<f64>], taken: impl Fn(usize) -> bool) -> DMatrix<f64> {
    let width = list.first().map_or(0, DMatrix::nrows);
    let taken = list.iter().enumerate().filter(|(i, _)| taken(*i)).map(|(_, m)| m);
    taken.fold(DMatrix::zeros(width, width), |sum, m| sum + m)
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
