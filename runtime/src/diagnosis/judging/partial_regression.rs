//! Partial regression (Frisch and Waugh 1933, Lovell 1963): what a trial's columns add to the columns of a design.
//!
//! The amplitudes of a trial Z beside the columns W are those of a regression on M Z, M = I - W (Wᵀ W)⁻¹ Wᵀ: Z without
//! what W makes of it. M Z itself is never formed; Gram matrices are enough.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::{Products, Trial};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rules::{AMPLITUDE_RIDGE, CURVE_RIDGE, KEPT_BESIDE};
use nalgebra::{DMatrix, DMatrixView, DVector};

/// A trial with the columns of a design projected out.
pub(in crate::diagnosis) struct Residualised {
    /// (Wᵀ W)⁻¹ Wᵀ Z: what the design's columns make of each of the trial's.
    pub coefficients: DMatrix<f64>,
    /// Zᵀ M Z; zero rows and columns where the design makes a column itself.
    squares: DMatrix<f64>,
    /// Zᵀ M y.
    with_residual: DVector<f64>,
}

impl Fit {
    /// Projects the columns of the design out of a trial, on the segments of this fit with its weights. `None` where
    /// the design makes the trial's columns itself.
    pub fn project_out(&self, trial: &Trial) -> Option<Residualised> {
        let (p, k) = (self.chi.len(), trial.columns.len());
        let (mut z, mut c, mut y) = (DMatrix::zeros(p, k), DMatrix::zeros(k, k), DVector::zeros(k));
        for (products, s) in trial.products.iter().zip(&self.sigma) {
            let w = 1.0 / (s * s);
            for (g, product) in products.iter().enumerate() {
                if self.train[g] {
                    z += w * &product.with;
                    c += w * &product.own;
                    for a in 0..k {
                        y[a] += w * product.y[a];
                    }
                }
            }
        }
        let mut x = DMatrix::zeros(p, k);
        for a in 0..k {
            x.set_column(a, &self.solve(&z.column(a).into_owned()));
        }
        let mut s = &c - z.transpose() * &x;
        let mut b = y - z.transpose() * &self.chi;
        let alive = (0..k).filter(|&a| c[(a, a)] > 0.0).count();
        let own: Vec<bool> =
            (0..k).map(|a| c[(a, a)] > 0.0 && s[(a, a)] > trial.own_fraction * c[(a, a)]).collect();
        for a in (0..k).filter(|&a| !own[a]) {
            s.row_mut(a).fill(0.0);
            s.column_mut(a).fill(0.0);
            b[a] = 0.0;
        }
        let determined = own.iter().filter(|own| **own).count();
        (alive > 0 && determined >= trial.needed).then_some(Residualised {
            coefficients: x,
            squares: s,
            with_residual: b,
        })
    }
}

impl Residualised {
    /// Per joint Zᵀ M Z_j a: what a part of the trial's torque, that with these amplitudes on this joint alone, says of the
    /// amplitudes; by the weights of the fit that it was residualised in.
    pub fn of_each_joint(&self, fit: &Fit, trial: &Trial, amplitude: &DVector<f64>) -> Vec<DVector<f64>> {
        let k = amplitude.len();
        let of_joint = |(products, s): (&Vec<Products>, &f64)| {
            let (mut with, mut own) = (DMatrix::zeros(fit.chi.len(), k), DMatrix::zeros(k, k));
            for product in products.iter().zip(&fit.train).filter_map(|(p, train)| train.then_some(p)) {
                with += &product.with;
                own += &product.own;
            }
            let mut said = (own - self.coefficients.transpose() * with) * amplitude / (s * s);
            (0..k).filter(|&a| self.squares[(a, a)] == 0.0).for_each(|a| said[a] = 0.0);
            said
        };
        trial.products.iter().zip(&fit.sigma).map(of_joint).collect()
    }

    /// M Z on all rows.
    pub fn columns(&self, design: &Design, trial: &Trial) -> Vec<Vec<f64>> {
        let mut columns = trial.dense(design);
        for (k, column) in columns.iter_mut().enumerate() {
            let coefficients = self.coefficients.column(k);
            for (made, &x) in design.columns.iter().zip(coefficients.iter()).filter(|(_, x)| **x != 0.0) {
                column.iter_mut().zip(made).for_each(|(c, m)| *c -= x * m);
            }
        }
        columns
    }

    /// Amplitudes and in-sample gain. Those of a law that has one sign are not negative: one of several that noise alone makes
    /// negative is 0; `None` where they then explain much less, or nothing.
    pub fn solve(&self, candidate: &Candidate) -> Option<(DVector<f64>, f64)> {
        let (s, b) = (&self.squares, &self.with_residual);
        if let Some(value) = candidate.fixed {
            let a = DVector::from_element(b.len(), value);
            let gain = self.gain(&a);
            return Some((a, gain));
        }
        // As [`Design::ridge`].
        let largest = s.diagonal().iter().copied().fold(0.0, f64::max);
        let curve = if candidate.effect.form().is_curve() { CURVE_RIDGE * largest } else { 0.0 };
        let (m, scale) = scaled(s.as_view(), curve);
        let right = b.component_mul(&scale);
        let for_one_sign = candidate.only_positive.then(|| m.clone());
        let of_any_sign = m.cholesky()?.solve(&right);
        let a = match for_one_sign {
            Some(m) => of_one_sign(m, right, of_any_sign)?,
            None => of_any_sign,
        }
        .component_mul(&scale);
        let gain = self.gain(&a);
        Some((a, gain))
    }

    /// Amplitudes of the columns after the first ones, which have these values; and the squares of the residual that all of them
    /// take away.
    pub fn solve_beside(&self, known: &[f64]) -> Option<(DVector<f64>, f64)> {
        let (k, first) = (self.with_residual.len(), known.len());
        let s = self.squares.view((first, first), (k - first, k - first));
        let given = DVector::from_column_slice(known);
        let b = self.with_residual.rows(first, k - first)
            - self.squares.view((first, 0), (k - first, first)) * &given;
        let (m, scale) = scaled(s.as_view(), 0.0);
        let x = m.cholesky()?.solve(&b.component_mul(&scale)).component_mul(&scale);
        let all = DVector::from_iterator(k, given.iter().chain(&x).copied());
        let gain = self.gain(&all);
        Some((x, gain))
    }

    /// Information on the amplitudes, in units of the residual variance; zero where the design makes a column itself.
    pub fn information(&self) -> &DMatrix<f64> {
        &self.squares
    }

    /// Squares of the residual that the columns take away with the best factor on all of them, if it is positive.
    fn alike(&self) -> f64 {
        let with_residual = self.with_residual.sum().max(0.0);
        with_residual * with_residual / self.squares.sum().max(f64::MIN_POSITIVE)
    }

    /// Squares of the residual that amplitudes take away.
    fn gain(&self, a: &DVector<f64>) -> f64 {
        2.0 * a.dot(&self.with_residual) - a.dot(&(&self.squares * a))
    }
}

/// Normal equations with a unit diagonal and a ridge, to which `curve` adds in units of the squares; and the scale of each
/// number, 0 where nothing is known of it.
fn scaled(s: DMatrixView<'_, f64>, curve: f64) -> (DMatrix<f64>, DVector<f64>) {
    let scale = s.diagonal().map(|x| if x > 0.0 { 1.0 / x.sqrt() } else { 0.0 });
    let ridge = |i: usize| AMPLITUDE_RIDGE + curve * scale[i] * scale[i];
    let m = DMatrix::from_fn(s.nrows(), s.ncols(), |i, j| {
        s[(i, j)] * scale[i] * scale[j] + if i == j { ridge(i) } else { 0.0 }
    });
    (m, scale)
}

impl Regression {
    /// In-sample gain of a trial of a candidate over all motion; negative infinity where it has none.
    pub fn gain_of(&self, candidate: &Candidate, trial: &Trial) -> f64 {
        self.fit
            .project_out(trial)
            .and_then(|part| part.solve(candidate))
            .map_or(f64::NEG_INFINITY, |(_, gain)| gain)
    }

    /// In-sample gain of a candidate's first shape over all motion; negative infinity where it has none.
    pub fn whole_gain(&self, candidate: &Candidate) -> f64 {
        candidate.trials.first().map_or(f64::NEG_INFINITY, |trial| self.gain_of(candidate, trial))
    }

    /// Whether the motion determines a candidate beside the design's columns.
    pub fn is_identifiable(&self, candidate: &Candidate) -> bool {
        candidate.trials.iter().any(|trial| self.fit.project_out(trial).is_some())
    }

    /// The shapes with the largest in-sample gain over all motion, however small, and whose course over time is nearest to
    /// what is left, however large. `None` where there are no shapes.
    pub fn best_and_nearest<'c>(&self, candidate: &'c Candidate) -> Option<[&'c [f64]; 2]> {
        let of = |trial: &'c Trial| {
            let part = self.fit.project_out(trial);
            let gain = part.as_ref().and_then(|part| part.solve(candidate)).map(|(_, gain)| gain);
            let alike = part.map_or(0.0, |part| part.alike());
            ([gain.unwrap_or(f64::NEG_INFINITY), alike], trial.shape.as_slice())
        };
        let judged: Vec<([f64; 2], &[f64])> = candidate.trials.iter().map(of).collect();
        let most = |k: usize| judged.iter().max_by(|a, b| a.0[k].total_cmp(&b.0[k])).map(|(_, shape)| *shape);
        Some([most(0)?, most(1)?])
    }

    /// For each value of the first number of a candidate's shapes the shape with the largest in-sample gain over all
    /// motion; of those the best.
    pub fn best_of_each(&self, candidate: &Candidate, most: usize) -> Vec<Vec<f64>> {
        let gains = candidate.trials.iter().map(|trial| (self.gain_of(candidate, trial), &trial.shape));
        let mut ranked: Vec<(f64, &Vec<f64>)> = gains.filter(|(gain, _)| gain.is_finite()).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut best: Vec<Vec<f64>> = Vec::new();
        for (_, shape) in ranked {
            if best.len() < most && !best.iter().any(|other| other.first() == shape.first()) {
                best.push(shape.clone());
            }
        }
        best
    }

    /// The inner products of a trial that was residualised over all motion, on each segment alone.
    pub fn by_segment(&self, whole: &Residualised, trial: &Trial) -> BySegment {
        let (joints, segments) = (self.sigma.len(), self.design.segments.len());
        let places = (0..joints).flat_map(|j| (0..segments).map(move |g| (j, g)));
        let products = places.map(|(j, g)| self.on_segment(whole, trial, j, g)).collect();
        BySegment { products, segments }
    }

    /// Zᵀ M M Z and Zᵀ M e on the rows of one joint in one segment, e the residual, unweighted.
    fn on_segment(
        &self,
        whole: &Residualised,
        trial: &Trial,
        j: usize,
        g: usize,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (x, chi) = (&whole.coefficients, &self.fit.chi);
        let (p, k) = (self.design.columns.len(), trial.columns.len());
        let (mut s, mut b) = (DMatrix::zeros(k, k), DVector::zeros(k));
        let gram = self.design.gram(j, g);
        let residual = &self.residual_products[j][g];
        for i in (0..p).filter(|&i| gram.squares(i) > 0.0) {
            let row = gram.row(i);
            for c in 0..k {
                let made = dot(row, &x.as_slice()[c * p..(c + 1) * p]);
                for a in 0..k {
                    s[(a, c)] += x[(i, a)] * made;
                }
                b[c] -= x[(i, c)] * residual[i];
            }
        }
        if let Some(product) = trial.products.get(j).and_then(|of_joint| of_joint.get(g)) {
            let cross = product.with.transpose() * x;
            s += &product.own - &cross - cross.transpose();
            b += DVector::from_column_slice(&product.y) - product.with.transpose() * chi;
        }
        (s, b)
    }
}

/// The amplitudes that are not negative of the normal equations M a = b, from their solution of any sign: each that comes out
/// negative is 0, and the others are found anew. `None` where none is left.
fn non_negative(mut m: DMatrix<f64>, mut b: DVector<f64>, of_any_sign: DVector<f64>) -> Option<DVector<f64>> {
    let mut a = of_any_sign;
    while let Some(negative) = (0..a.len()).find(|&i| a[i] < 0.0) {
        m.row_mut(negative).fill(0.0);
        m.column_mut(negative).fill(0.0);
        m[(negative, negative)] = 1.0;
        b[negative] = 0.0;
        a = m.clone().cholesky()?.solve(&b);
    }
    a.iter().any(|x| *x > 0.0).then_some(a)
}

/// The amplitudes of one sign in place of `of_any_sign`, the solution of M a = b: itself where none is negative, else those
/// that are not negative. Of several one may be zero, and then noise makes it negative in half of all cases; `None` where
/// these explain much less, or nothing.
pub(in crate::diagnosis) fn of_one_sign(
    m: DMatrix<f64>,
    b: DVector<f64>,
    of_any_sign: DVector<f64>,
) -> Option<DVector<f64>> {
    if of_any_sign.iter().all(|a| *a >= 0.0) {
        return Some(of_any_sign);
    }
    let gain = |a: &DVector<f64>| 2.0 * a.dot(&b) - a.dot(&(&m * a));
    let least = KEPT_BESIDE * gain(&of_any_sign);
    non_negative(m.clone(), b.clone(), of_any_sign).filter(|a| gain(a) >= least)
}

/// Inner products of a residualised trial on the rows of each joint in each segment, unweighted.
pub(in crate::diagnosis) struct BySegment {
    /// Zᵀ M M Z and Zᵀ M e, the segments of the first joint first.
    products: Vec<(DMatrix<f64>, DVector<f64>)>,
    segments: usize,
}

impl BySegment {
    /// The trial on some segments only, weighted by the standard deviations of the joints.
    pub fn on(&self, segments: &[bool], sigma: &[f64], whole: &Residualised) -> Residualised {
        let k = whole.coefficients.ncols();
        let (mut squares, mut with_residual) = (DMatrix::zeros(k, k), DVector::zeros(k));
        for (products, s) in self.products.chunks(self.segments.max(1)).zip(sigma) {
            let w = 1.0 / (s * s);
            for ((square, with), _) in products.iter().zip(segments).filter(|(_, used)| **used) {
                squares += w * square;
                with_residual += w * with;
            }
        }
        Residualised { coefficients: whole.coefficients.clone(), squares, with_residual }
    }

    /// Squares of the residual that amplitudes take away on the rows of one joint in one segment.
    pub fn gain(&self, amplitude: &DVector<f64>, joint: usize, segment: usize) -> f64 {
        let (squares, with_residual) = &self.products[joint * self.segments + segment];
        2.0 * amplitude.dot(with_residual) - amplitude.dot(&(squares * amplitude))
    }
}
