//! What the residuals of a fit say about the noise of the rows: how it depends on its past, joint by joint.

use super::autoregression::Autoregression;
use super::series::Series;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Longest memory that is modelled, in rows, and fewest rows for each of its lags.
const LAGS: usize = 16;
const ROWS_A_LAG: usize = 10;
/// Largest change of an autocorrelation at which the iteration has converged.
const CONVERGED: f64 = 0.01;
/// Most iterations.
const ITERATIONS: usize = 12;

/// The noise of the rows in units of the errors of their groups: stationary in each equation.
#[derive(Debug)]
pub(super) struct Noise {
    /// One autoregression per equation.
    pub equations: Vec<Autoregression>,
    /// Correlation of the innovations of the equations at the same time.
    pub correlation: DMatrix<f64>,
    /// For each equation the degrees of freedom that the fit leaves in its rows.
    pub freedom: Vec<f64>,
    fit: Fit,
}

impl Noise {
    /// Restricted maximum likelihood by expectation and maximisation (Dempster, Laird and Rubin 1977; Patterson and
    /// Thompson 1971).
    ///
    /// What a fit leaves is less than the noise: the parameters take over what looks like their columns, most at the
    /// low frequencies of the motion. Given the rows, the product of the noise at two of them is expected to be that of
    /// the residuals plus w A^-1 wT, with the rows w and the information A of the fit that is best for this noise. Their
    /// means at each lag give an autoregression, which gives the fit and A, until both agree.
    ///
    /// `None` where the columns do not determine the `unknowns`.
    pub fn of(all: &[Series], unknowns: usize) -> Option<Noise> {
        let count = all.iter().map(|s| s.equation + 1).max()?;
        let mut equations = vec![Autoregression::white(1.0); count];
        let mut before: Vec<Vec<f64>> = vec![vec![1.0]; count];
        let mut fit = Fit::of(all, &equations, unknowns)?;
        for _ in 0..ITERATIONS {
            let mut change = 0.0_f64;
            for (equation, (model, before)) in equations.iter_mut().zip(&mut before).enumerate() {
                let own = all.iter().filter(|s| s.equation == equation);
                let (autocovariance, rows) = expected_products(own, &fit);
                if autocovariance.first().is_none_or(|&variance| variance <= 0.0) {
                    continue;
                }
                let correlation: Vec<f64> = autocovariance.iter().map(|c| c / autocovariance[0]).collect();
                let changes = correlation.iter().enumerate().map(|(l, c)| c - before.get(l).unwrap_or(&0.0));
                change = changes.fold(change, |m, c| m.max(c.abs()));
                *before = correlation;
                *model = Autoregression::of(&autocovariance, rows);
            }
            fit = Fit::of(all, &equations, unknowns)?;
            if change < CONVERGED {
                break;
            }
        }
        let correlation = innovations_in_common(all, &equations, &fit);
        let mut freedom = vec![0.0; count];
        for series in all {
            let model = &equations[series.equation];
            let leverages = fit.leverages(series, &whitened(series, model));
            freedom[series.equation] += leverages.iter().map(|h| 1.0 - h).sum::<f64>();
        }
        Some(Noise { equations, correlation, freedom, fit })
    }

    /// For each row of a series the square of its own innovation in units of its variance (1 where a row is not used): what
    /// stands for the variance where that differs from row to row (White 1980). The innovation is that of a fit without the
    /// row: the jackknife, HC3 of MacKinnon and White 1985. With a few rows for each parameter the squares that only give
    /// back what the fit takes (HC2) are too small by experience (Long and Ervin 2000).
    pub fn own_squares(&self, series: &Series) -> Vec<f64> {
        let model = &self.equations[series.equation];
        let white = whitened(series, model);
        let last = series.places.len();
        let leverages = self.fit.leverages(series, &white);
        let mut squares = vec![1.0; series.y.len()];
        let rows = series.segments.iter().flat_map(|s| s.clone());
        for ((row, t), leverage) in rows.enumerate().zip(leverages) {
            let columns = white.row(row);
            let predicted: f64 = (0..last).map(|c| columns[c] * self.fit.chi[series.places[c]]).sum();
            squares[t] = ((columns[last] - predicted) / (1.0 - leverage).max(f64::EPSILON)).powi(2);
        }
        squares
    }
}

/// The generalised least-squares fit for a given noise.
#[derive(Debug)]
pub(super) struct Fit {
    pub chi: Vec<f64>,
    /// A^-1.
    covariance: DMatrix<f64>,
}

impl Fit {
    pub fn of(all: &[Series], noise: &[Autoregression], unknowns: usize) -> Option<Fit> {
        let mut information = DMatrix::<f64>::zeros(unknowns, unknowns);
        let mut right = DVector::<f64>::zeros(unknowns);
        for series in all {
            let white = whitened(series, &noise[series.equation]);
            let product = white.transpose() * &white;
            let last = series.places.len();
            for (a, &pa) in series.places.iter().enumerate() {
                right[pa] += product[(a, last)];
                for (b, &pb) in series.places.iter().enumerate() {
                    information[(pa, pb)] += product[(a, b)];
                }
            }
        }
        let covariance = inverse(&information)?;
        let chi = (&covariance * right).as_slice().to_vec();
        Some(Fit { chi, covariance })
    }

    /// What of each used row the fit takes: the diagonal of the hat matrix, from the innovations of [W Y].
    pub fn leverages(&self, series: &Series, white: &DMatrix<f64>) -> Vec<f64> {
        let columns = white.columns(0, series.places.len());
        let taken = columns * self.covariance.select_rows(&series.places).select_columns(&series.places);
        taken.row_iter().zip(columns.row_iter()).map(|(taken, row)| taken.dot(&row)).collect()
    }
}

/// The inverse of a positive definite matrix, by way of one with a unit diagonal.
pub(super) fn inverse(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale = matrix.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 });
    let scaled =
        DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| scale[i] * matrix[(i, j)] * scale[j]);
    let inverse = Cholesky::new(scaled)?.inverse();
    Some(DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |i, j| scale[i] * inverse[(i, j)] * scale[j]))
}

/// The used rows of [W Y] as innovations, stretch by stretch.
pub(super) fn whitened(series: &Series, noise: &Autoregression) -> DMatrix<f64> {
    let rows: usize = series.segments.iter().map(|s| s.len()).sum();
    let width = series.places.len() + 1;
    let mut white = DMatrix::zeros(rows, width);
    for c in 0..width {
        let column =
            series.w.as_slice().get(c * series.y.len()..(c + 1) * series.y.len()).unwrap_or(&series.y);
        let mut row = 0;
        for segment in &series.segments {
            for value in noise.innovations(&column[segment.clone()]) {
                white[(row, c)] = value;
                row += 1;
            }
        }
    }
    white
}

/// Mean of noise(t) noise(t + lag) over the used rows of an equation as the fit makes it expected, for lags from 0 on,
/// and how many rows there are.
fn expected_products<'a>(own: impl Iterator<Item = &'a Series>, fit: &Fit) -> (Vec<f64>, f64) {
    let own: Vec<&Series> = own.collect();
    let rows: usize = own.iter().flat_map(|s| &s.segments).map(|s| s.len()).sum();
    let most = LAGS.min(rows / ROWS_A_LAG);
    let mut sums = vec![0.0; most + 1];
    let mut counts = vec![0usize; most + 1];
    for series in own {
        let n = series.y.len();
        let width = series.places.len();
        let residual = series.residual(&fit.chi);
        let part =
            DMatrix::from_fn(width, width, |a, b| fit.covariance[(series.places[a], series.places[b])]);
        // Row by row, so that a product of two rows is one run through memory.
        let taken = (&series.w * part).transpose();
        let columns = series.w.transpose();
        for t in (0..n).filter(|&t| series.used[t]) {
            for lag in 0..=most.min(n - 1 - t) {
                if series.used[t + lag] {
                    sums[lag] +=
                        residual[t] * residual[t + lag] + taken.column(t).dot(&columns.column(t + lag));
                    counts[lag] += 1;
                }
            }
        }
    }
    let told = counts.iter().take_while(|&&count| count > 0).count();
    (sums.iter().zip(&counts).take(told).map(|(sum, &count)| sum / count as f64).collect(), rows as f64)
}

/// Correlation of the innovations of each pair of equations at the rows that both use.
fn innovations_in_common(all: &[Series], noise: &[Autoregression], fit: &Fit) -> DMatrix<f64> {
    let count = noise.len();
    let innovations: Vec<Vec<f64>> = all
        .iter()
        .map(|series| {
            let residual = series.residual(&fit.chi);
            let mut white = vec![0.0; residual.len()];
            for segment in &series.segments {
                let innovations = noise[series.equation].innovations(&residual[segment.clone()]);
                white[segment.clone()].copy_from_slice(&innovations);
            }
            white
        })
        .collect();
    let mut products = DMatrix::<f64>::zeros(count, count);
    let mut squares = DMatrix::<f64>::zeros(count, count);
    for (a, x) in all.iter().zip(&innovations) {
        for (b, y) in all.iter().zip(&innovations) {
            if a.trajectory != b.trajectory || a.equation == b.equation {
                continue;
            }
            for t in (0..x.len().min(y.len())).filter(|&t| a.used[t] && b.used[t]) {
                products[(a.equation, b.equation)] += x[t] * y[t];
                squares[(a.equation, b.equation)] += x[t] * x[t];
            }
        }
    }
    DMatrix::from_fn(count, count, |i, j| {
        let scale = (squares[(i, j)] * squares[(j, i)]).sqrt();
        if i == j {
            1.0
        } else if scale > 0.0 {
            products[(i, j)] / scale
        } else {
            0.0
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    const ROWS: usize = 400;
    const RHO: f64 = 0.8;

    /// One equation with slow columns, as those of a robot that moves slowly, and AR(1) noise of variance 1.
    fn series(seed: u64) -> Series {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        let mut error = draw();
        let y = (0..ROWS)
            .map(|_| {
                let now = error;
                error = RHO * error + (1.0 - RHO * RHO).sqrt() * draw();
                now
            })
            .collect();
        let w = DMatrix::from_fn(ROWS, 12, |t, c| {
            let phase = std::f64::consts::PI * (t as f64 + 0.5) / ROWS as f64;
            (c as f64 * phase).cos()
        });
        Series {
            group: 0,
            equation: 0,
            trajectory: 0,
            places: (0..12).collect(),
            w,
            y,
            used: vec![true; ROWS],
            segments: std::iter::once(0..ROWS).collect(),
        }
    }

    #[test]
    fn noise_at_the_frequencies_of_the_columns_is_not_lost_with_them() {
        let first = series(0);
        let column: Vec<f64> = first.w.column(3).iter().copied().collect();
        let mut expected = 0.0;
        for s in 0..ROWS {
            for t in 0..ROWS {
                expected += column[s] * column[t] * RHO.powi(s.abs_diff(t) as i32);
            }
        }
        let seeds = 40;
        let (mut found, mut plain) = (0.0, 0.0);
        for seed in 0..seeds {
            let all = [series(seed)];
            let noise = Noise::of(&all, 12).expect("independent columns");
            let weights = noise.equations[0].weights_of_innovations(&column, 200);
            found += weights.iter().map(|z| z * z).sum::<f64>() / seeds as f64;
            // What the residuals show without what the fit took.
            let fit = Fit::of(&all, &[Autoregression::white(1.0)], 12).expect("independent columns");
            let left: f64 = all[0].residual(&fit.chi).iter().zip(&column).map(|(e, w)| e * w).sum();
            plain += left * left / seeds as f64;
        }
        assert!((found / expected).ln().abs() < 0.25, "{found} {expected}");
        assert!(plain < 1e-6 * expected);
    }
}
