//! Evidence that is measured by the variation that is there anyway: between units of the baseline, or between
//! stretches of the recording itself.
//!
//! A residual that is made white by an autoregression still differs from one stretch to the next by more than its own
//! memory tells: temperature, positions visited, what no column describes. How large the statistic Q of a law is where
//! nothing has changed is therefore measured: Q/k of the same law in every unit, each predicted from other motion,
//! has mean lambda; F = (Q/k) / lambda follows Fisher's distribution with (k, units - 1) degrees of freedom, as a
//! random effect of the units would have it (Laird and Ware 1982).

use crate::diagnosis::judging::ar::Autoregression;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rules::{CALIBRATION_RIDGE, HIGHEST_AR_ORDER, LEAST_EIGENVALUE, OWN_FRACTION};
use crate::parallel;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, Normal};
use std::ops::Range;

/// What a law is judged against: everything by row, over all rows of all joints.
pub(in crate::diagnosis) struct Regressors<'a> {
    /// Columns of the model and its nuisances.
    pub shared: &'a [Vec<f64>],
    pub y: &'a [f64],
    /// Columns of each joint that are free in every motion, values on the joint's rows.
    pub free: &'a [Vec<Vec<f64>>],
    /// Rows of each joint.
    pub of_joint: &'a [Range<usize>],
}

/// A law's statistic in the recording and its variation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Calibrated {
    /// Wald's statistic in a residual made white.
    pub squares: f64,
    /// Numbers of the law that the motion determines.
    pub numbers: usize,
    /// Mean of the statistic for each number where nothing has changed, at least 1.
    pub lambda: f64,
    /// Units that this mean is of.
    pub units: usize,
}

impl Calibrated {
    /// With this lambda.
    pub fn evidence(&self, lambda: f64) -> Evidence {
        let freedom = self.units.saturating_sub(1).max(1) as f64;
        Evidence::fisher(self.squares / lambda.max(1.0), self.numbers, freedom)
    }
}

/// Inner products of `[columns, law, y]` in each unit and each motion, all joints together.
struct Blocks {
    units: Vec<DMatrix<f64>>,
    files: Vec<DMatrix<f64>>,
}

/// Judges a law, given as columns over all rows; `residual` is what the model with the law leaves. Where `common`,
/// the law may be there in all motions, and only what differs in the recording counts.
pub(in crate::diagnosis) fn calibrate(
    units: &Units,
    regressors: &Regressors<'_>,
    background: &Background,
    law: &[Vec<f64>],
    residual: &[f64],
    common: bool,
) -> Option<Calibrated> {
    let blocks = blocks(units, regressors, background, law, residual);
    let (p, k) = (regressors.shared.len(), law.len());
    let sum = |list: &mut dyn Iterator<Item = &DMatrix<f64>>| {
        list.fold(DMatrix::zeros(p + k + 1, p + k + 1), |sum, m| sum + m)
    };
    let files = blocks.files.len();
    let is_target = |f: usize| units.units.iter().any(|u| u.file == f && u.target);
    let (found, nulls) = if units.change() {
        let old: Vec<usize> = (0..files).filter(|&f| !is_target(f)).collect();
        let baseline = sum(&mut old.iter().map(|&f| &blocks.files[f]));
        let fresh = sum(&mut (0..files).filter(|&f| is_target(f)).map(|f| &blocks.files[f]));
        let found = gain(&baseline, &fresh, p, k, common)?;
        let others = |u: usize| {
            let file = units.units[u].file;
            if old.len() > 1 {
                sum(&mut old.iter().filter(|f| **f != file).map(|&f| &blocks.files[f]))
            } else {
                let rest = |v: &usize| *v != u && !units.units[*v].target;
                sum(&mut (0..units.units.len()).filter(rest).map(|v| &blocks.units[v]))
            }
        };
        let baseline = (0..units.units.len()).filter(|&u| !units.units[u].target);
        let nulls: Vec<f64> = baseline
            .filter_map(|u| gain(&others(u), &blocks.units[u], p, k, common))
            .map(|(squares, numbers)| squares / numbers as f64)
            .collect();
        (found, nulls)
    } else {
        let whole = sum(&mut blocks.units.iter());
        let nothing = DMatrix::zeros(p + k + 1, p + k + 1);
        let found = gain(&nothing, &whole, p, k, false)?;
        let nulls: Vec<f64> = (0..units.units.len())
            .filter_map(|u| gain(&(&whole - &blocks.units[u]), &blocks.units[u], p, k, true))
            .map(|(squares, numbers)| squares / numbers as f64)
            .collect();
        (found, nulls)
    };
    let count = nulls.len();
    let mean = nulls.iter().sum::<f64>() / count.max(1) as f64;
    // What differs between units is constant within one: it grows with the motion that is looked at.
    let longer =
        if units.change() { (units.target_duration / units.duration.max(1e-9)).max(1.0) } else { 1.0 };
    let lambda = 1.0 + (mean - 1.0).max(0.0) * longer;
    Some(Calibrated { squares: found.0, numbers: found.1, lambda, units: count })
}

/// Probability that a law is ahead of a rival by `ahead` squares only by accident.
///
/// Where one of two laws that are not nested is true, the difference of what they explain has a standard deviation of
/// at most twice the root of what the true one explains (Cox 1961; the two have nothing in common at worst), all in
/// units of the variation that is there anyway.
pub(in crate::diagnosis) fn rival_p_value(law: &Calibrated, ahead: f64) -> f64 {
    let deviation = 2.0 * (law.lambda * law.squares).max(f64::MIN_POSITIVE).sqrt();
    Normal::standard().sf(ahead / deviation)
}

/// Inner products without any law, joint by joint: the same for all laws of a round.
pub(in crate::diagnosis) struct Background {
    of_joint: Vec<Blocks>,
}

impl Background {
    /// Of a model that leaves `residual`.
    pub fn new(units: &Units, regressors: &Regressors<'_>, residual: &[f64], threads: usize) -> Self {
        let of_joint = |j| of_joint(units, regressors, j, &[], residual);
        Self { of_joint: parallel::map(threads, regressors.of_joint.len(), of_joint) }
    }
}

/// Inner products of everything, all joints together; those of joints on which the law is zero are the background's.
fn blocks(
    units: &Units,
    regressors: &Regressors<'_>,
    background: &Background,
    law: &[Vec<f64>],
    residual: &[f64],
) -> Blocks {
    let (p, k) = (regressors.shared.len(), law.len());
    let zero = DMatrix::zeros(p + k + 1, p + k + 1);
    let files = units.units.iter().map(|u| u.file + 1).max().unwrap_or(0);
    let mut out = Blocks { units: vec![zero.clone(); units.units.len()], files: vec![zero; files] };
    for (j, range) in regressors.of_joint.iter().enumerate() {
        let acts = law.iter().any(|c| c[range.clone()].iter().any(|x| *x != 0.0));
        let own = acts.then(|| of_joint(units, regressors, j, law, residual));
        let (part, numbers) = own.as_ref().map_or((&background.of_joint[j], 0), |own| (own, k));
        // Without the law, y is the column after the p of the model.
        let places: Vec<usize> = (0..p + numbers).chain([p + k]).collect();
        for (sum, part) in out.units.iter_mut().zip(&part.units) {
            add(sum, part, &places);
        }
        for (sum, part) in out.files.iter_mut().zip(&part.files) {
            add(sum, part, &places);
        }
    }
    out
}

/// Inner products of `[columns, law, y]` on one joint, made white, without what the free columns make.
fn of_joint(
    units: &Units,
    regressors: &Regressors<'_>,
    j: usize,
    law: &[Vec<f64>],
    residual: &[f64],
) -> Blocks {
    let range = &regressors.of_joint[j];
    let width = regressors.shared.len() + law.len() + 1;
    let files = units.units.iter().map(|u| u.file + 1).max().unwrap_or(0);
    let zero = DMatrix::zeros(width, width);
    let mut out = Blocks { units: vec![zero.clone(); units.units.len()], files: vec![zero; files] };
    if range.is_empty() {
        return out;
    }
    let local = |r: &Range<usize>| r.start - range.start..r.end - range.start;
    let stretches: Vec<Range<usize>> = units.stretches[j].iter().map(local).collect();
    let free: &[Vec<f64>] = &regressors.free[j];
    let left = without_free(units, j, range, &residual[range.clone()], free);
    let ar = Autoregression::fit(&stretches, &left, HIGHEST_AR_ORDER);
    let columns = regressors.shared.iter().chain(law).map(|c| &c[range.clone()]);
    let all: Vec<Option<Vec<f64>>> = columns
        .chain([&regressors.y[range.clone()]])
        .map(|c| c.iter().any(|x| *x != 0.0).then(|| ar.whitened(&stretches, c)))
        .collect();
    let free: Vec<Vec<f64>> = free.iter().map(|c| ar.whitened(&stretches, c)).collect();
    let live: Vec<usize> = (0..width).filter(|&i| all[i].is_some()).collect();
    let columns: Vec<&[f64]> =
        free.iter().map(Vec::as_slice).chain(live.iter().filter_map(|&i| all[i].as_deref())).collect();
    let mut of_file = vec![DMatrix::zeros(columns.len(), columns.len()); files];
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
    let files = units.units.iter().map(|u| u.file + 1).max().unwrap_or(0);
    for file in 0..files {
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
    let Some((factor, scale)) = factored(&g.view((0, 0), (f, f)).into_owned()) else { return rest };
    let scale = DMatrix::from_diagonal(&scale);
    let cross = scale * g.view((0, f), (f, n));
    rest - cross.transpose() * factor.solve(&cross)
}

fn add(sum: &mut DMatrix<f64>, part: &DMatrix<f64>, live: &[usize]) {
    for (a, &i) in live.iter().enumerate() {
        for (b, &k) in live.iter().enumerate() {
            sum[(i, k)] += part[(a, b)];
        }
    }
}

/// Cholesky factor with a unit diagonal and a ridge, and the scale of each column (0 where it is zero).
fn factored(g: &DMatrix<f64>) -> Option<(nalgebra::Cholesky<f64, nalgebra::Dyn>, DVector<f64>)> {
    let n = g.nrows();
    let scale = DVector::from_fn(n, |k, _| if g[(k, k)] > 0.0 { 1.0 / g[(k, k)].sqrt() } else { 0.0 });
    let scaled = DMatrix::from_fn(n, n, |i, k| {
        let diagonal = if i != k {
            0.0
        } else if scale[k] == 0.0 {
            1.0
        } else {
            CALIBRATION_RIDGE
        };
        g[(i, k)] * scale[i] * scale[k] + diagonal
    });
    Some((scaled.cholesky()?, scale))
}

/// Squares that `k` columns take away in one part of the motion, all other columns fitted to it and to the rest of
/// the motion, and how many of them are determined. The products are ordered `[p columns, law, y]`. Where `common`,
/// the law may be there in all motion, and its change in the part is judged.
fn gain(rest: &DMatrix<f64>, part: &DMatrix<f64>, p: usize, k: usize, common: bool) -> Option<(f64, usize)> {
    let m = if common { p + k } else { p };
    let mut g = DMatrix::zeros(m, m);
    let mut z = DMatrix::zeros(m, k);
    let (mut v, mut b) = (DVector::zeros(m), DVector::zeros(k));
    let (law, y) = (p, p + k);
    for i in 0..m {
        for c in 0..m {
            g[(i, c)] = rest[(i, c)] + part[(i, c)];
        }
        for a in 0..k {
            z[(i, a)] = part[(i, law + a)];
        }
        v[i] = rest[(i, y)] + part[(i, y)];
    }
    let own = part.view((law, law), (k, k)).into_owned();
    for a in 0..k {
        b[a] = part[(law + a, y)];
    }
    let (factor, scale) = factored(&g)?;
    let scale = DMatrix::from_diagonal(&scale);
    let scaled = &scale * &z;
    let made = factor.solve(&scaled);
    let mut s = &own - scaled.transpose() * &made;
    b -= made.transpose() * (&scale * &v);
    let alive: Vec<usize> =
        (0..k).filter(|&a| own[(a, a)] > 0.0 && s[(a, a)] > OWN_FRACTION * own[(a, a)]).collect();
    if alive.is_empty() {
        return None;
    }
    s = s.select_rows(&alive).select_columns(&alive);
    let b = b.select_rows(&alive);
    let width = DVector::from_fn(alive.len(), |a, _| 1.0 / s[(a, a)].sqrt());
    let correlation = DMatrix::from_fn(alive.len(), alive.len(), |i, c| s[(i, c)] * width[i] * width[c]);
    // Directions that the columns have only together by rounding carry no evidence.
    let eigen = correlation.symmetric_eigen();
    let projected = eigen.eigenvectors.transpose() * b.component_mul(&width);
    let (mut squares, mut numbers) = (0.0, 0);
    for (value, x) in eigen.eigenvalues.iter().zip(projected.iter()) {
        if *value > LEAST_EIGENVALUE {
            squares += x * x / value;
            numbers += 1;
        }
    }
    (numbers > 0).then_some((squares, numbers))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::units::Unit;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    const ROWS: usize = 150;

    fn normal(rng: &mut Pcg64) -> f64 {
        (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()
    }

    /// One joint, `files` motions of one unit each of which the last is the target where there is a baseline.
    fn units(files: usize, baseline: bool) -> Units {
        Units {
            units: (0..files).map(|f| Unit { file: f, target: !baseline || f + 1 == files }).collect(),
            rows: vec![(0..files).map(|f| f * ROWS..(f + 1) * ROWS).collect()],
            stretches: vec![(0..files).map(|f| f * ROWS..(f + 1) * ROWS).collect()],
            duration: 1.0,
            target_duration: 1.0,
        }
    }

    fn alone(
        units: &Units,
        regressors: &Regressors<'_>,
        law: &[Vec<f64>],
        residual: &[f64],
        common: bool,
    ) -> Option<Calibrated> {
        let background = Background::new(units, regressors, residual, 1);
        calibrate(units, regressors, &background, law, residual, common)
    }

    fn wave(rng: &mut Pcg64, rows: usize) -> Vec<f64> {
        let waves: Vec<[f64; 3]> =
            (0..4).map(|k| [normal(rng), rng.random_range(0.0..6.3), 0.03 * f64::from(k + 1)]).collect();
        (0..rows).map(|t| waves.iter().map(|[a, phase, w]| a * (w * t as f64 + phase).sin()).sum()).collect()
    }

    /// Noise that remembers, quantised, twice as loud in every other stretch of time.
    fn noise(rng: &mut Pcg64, rows: usize) -> Vec<f64> {
        let mut x = 0.0;
        (0..rows)
            .map(|t| {
                x = 0.8 * x + 0.6 * normal(rng);
                let loud = if t / 40 % 2 == 0 { 1.0 } else { 2.0 };
                (loud * x / 0.2).round() * 0.2
            })
            .collect()
    }

    /// Evidence with the measured variation and without it, for a law whose amplitude is `amplitude` in the target (or
    /// everywhere, without a baseline) and differs by `spread` from one motion to the next.
    fn judged(rng: &mut Pcg64, files: usize, baseline: bool, amplitude: f64, spread: f64) -> [Evidence; 2] {
        let rows = files * ROWS;
        let shared = vec![wave(rng, rows), wave(rng, rows)];
        let law = wave(rng, rows);
        let mut y = noise(rng, rows);
        let free = if baseline { vec![vec![1.0; rows], wave(rng, rows)] } else { vec![] };
        for f in 0..files {
            let level = if !baseline || f + 1 == files { amplitude } else { 0.0 } + spread * normal(rng);
            let friction = 3.0 * normal(rng);
            for t in f * ROWS..(f + 1) * ROWS {
                y[t] += 2.0 * shared[0][t] - shared[1][t] + level * law[t];
                y[t] += free.iter().map(|c| friction * c[t]).sum::<f64>();
            }
        }
        let residual: Vec<f64> = (0..rows)
            .map(|t| {
                let there = if !baseline || t / ROWS + 1 == files { amplitude } else { 0.0 };
                y[t] - 2.0 * shared[0][t] + shared[1][t] - there * law[t]
            })
            .collect();
        let all = 0..rows;
        let regressors =
            Regressors { shared: &shared, y: &y, free: &[free], of_joint: std::slice::from_ref(&all) };
        let found =
            alone(&units(files, baseline), &regressors, &[law], &residual, false).expect("determined");
        [found.evidence(found.lambda), found.evidence(1.0)]
    }

    fn rates(seed: u64, files: usize, baseline: bool, amplitude: f64, spread: f64, level: f64) -> [f64; 2] {
        let mut rng = Pcg64::seed_from_u64(seed);
        let runs = 1000;
        let mut below = [0; 2];
        for _ in 0..runs {
            let evidence = judged(&mut rng, files, baseline, amplitude, spread);
            below.iter_mut().zip(evidence).for_each(|(b, e)| *b += usize::from(e.p_value < level));
        }
        below.map(|b| b as f64 / f64::from(runs))
    }

    #[test]
    fn a_law_that_varies_anyway_is_no_change_however_well_its_noise_is_known() {
        let [calibrated, naive] = rates(5, 12, true, 0.0, 1.0, 0.01);
        println!("calibrated {calibrated}, without {naive}");
        assert!(calibrated < 0.025, "{calibrated}");
        assert!(naive > 0.2, "{naive}");
    }

    #[test]
    fn coloured_quantised_noise_that_is_louder_at_times_is_no_change() {
        let [calibrated, _] = rates(6, 12, true, 0.0, 0.0, 0.01);
        assert!(calibrated < 0.02, "{calibrated}");
        let [alone, _] = rates(7, 10, false, 0.0, 0.0, 0.01);
        assert!(alone < 0.02, "{alone}");
    }

    #[test]
    fn a_change_that_stands_out_of_the_variation_is_found_at_a_level_over_many_candidates() {
        let [changed, _] = rates(8, 12, true, 5.0, 0.3, 1e-4);
        assert!(changed > 0.7, "{changed}");
        let [alone, _] = rates(9, 10, false, 1.6, 0.05, 1e-4);
        assert!(alone > 0.9, "{alone}");
    }

    #[test]
    fn a_law_that_is_in_both_recordings_is_no_change() {
        let mut rng = Pcg64::seed_from_u64(10);
        let (files, rows) = (12, 12 * ROWS);
        let law = wave(&mut rng, rows);
        let y: Vec<f64> = noise(&mut rng, rows).iter().zip(&law).map(|(n, l)| n + 5.0 * l).collect();
        let residual: Vec<f64> = y.iter().zip(&law).map(|(y, l)| y - 5.0 * l).collect();
        let all = 0..rows;
        let regressors =
            Regressors { shared: &[], y: &y, free: &[vec![]], of_joint: std::slice::from_ref(&all) };
        let tail = |common| {
            let law = std::slice::from_ref(&law);
            let found = alone(&units(files, true), &regressors, law, &residual, common).expect("determined");
            found.evidence(found.lambda).p_value
        };
        assert!(tail(true) > 1e-3, "{}", tail(true));
    }

    #[test]
    fn a_column_that_the_model_makes_itself_has_no_evidence() {
        let mut rng = Pcg64::seed_from_u64(11);
        let rows = 10 * ROWS;
        let (y, column) = (noise(&mut rng, rows), wave(&mut rng, rows));
        let all = 0..rows;
        let shared = [column.clone()];
        let regressors =
            Regressors { shared: &shared, y: &y, free: &[vec![]], of_joint: std::slice::from_ref(&all) };
        assert_eq!(alone(&units(10, false), &regressors, &[column], &y, false), None);
    }

    #[test]
    fn of_two_laws_the_true_one_is_told_apart_only_where_it_is_well_ahead() {
        let mut rng = Pcg64::seed_from_u64(12);
        let rows = 10 * ROWS;
        let units = units(10, false);
        let all = 0..rows;
        // A rival that has half of its squares in common with the law is behind by half of what the law explains, S,
        // with a deviation of 2 sqrt(lambda S): told apart at 5 % from S = 43 lambda on. Waves drawn at random may have more in
        // common, and then stay tied however strong they are.
        let mut told = |amplitude: f64| -> [usize; 2] {
            let (mut right, mut wrong) = (0, 0);
            for _ in 0..200 {
                let law = wave(&mut rng, rows);
                let other = wave(&mut rng, rows);
                let rival: Vec<f64> = law.iter().zip(&other).map(|(a, b)| a + b).collect();
                let noise = noise(&mut rng, rows);
                let y: Vec<f64> = noise.iter().zip(&law).map(|(n, l)| n + amplitude * l).collect();
                let regressors =
                    Regressors { shared: &[], y: &y, free: &[vec![]], of_joint: std::slice::from_ref(&all) };
                let judged = |law: &[f64]| alone(&units, &regressors, &[law.to_vec()], &y, false);
                let (Some(a), Some(b)) = (judged(&law), judged(&rival)) else { continue };
                right += usize::from(rival_p_value(&a, a.squares - b.squares) < 0.05);
                wrong += usize::from(rival_p_value(&b, b.squares - a.squares) < 0.05);
            }
            [right, wrong]
        };
        let (weak, strong) = (told(0.4), told(3.0));
        println!("[right, wrong] of 200: weak {weak:?}, strong {strong:?}");
        assert!(weak[1] <= 4 && strong[1] <= 4, "{weak:?} {strong:?}");
        assert!(weak[0] < 50 && strong[0] > 100, "{weak:?} {strong:?}");
    }
}
