//! Location and scale that a few bad values do not move.

/// Median; `None` of nothing. The order of the values does not matter; they must be finite.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    match n {
        0 => None,
        _ if n % 2 == 1 => Some(sorted[n / 2]),
        // Halved first: two huge values have a finite mean.
        _ => Some(0.5 * sorted[n / 2 - 1] + 0.5 * sorted[n / 2]),
    }
}

/// Qn of Rousseeuw and Croux (1993): a quarter-quantile of the distances between all pairs, which needs no centre,
/// withstands half of the values and has 82 % efficiency for Gaussian ones. `None` of fewer than two. At most the first
/// 300 values after sorting and even thinning are paired.
pub(crate) fn qn(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let step = sorted.len().div_ceil(300).max(1);
    let sorted: Vec<f64> = sorted.into_iter().step_by(step).collect();
    let n = sorted.len();
    if n < 2 {
        return None;
    }
    let mut distances: Vec<f64> =
        (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| sorted[i] - sorted[j]).collect();
    distances.sort_by(f64::total_cmp);
    let h = n / 2 + 1;
    let rank = h * (h - 1) / 2;
    let quantile = distances[(rank - 1).min(distances.len() - 1)];
    Some(2.2219 * small_sample(n) * quantile)
}

/// Factors that make Qn unbiased for few Gaussian values (Croux and Rousseeuw 1992).
fn small_sample(n: usize) -> f64 {
    match n {
        2 => 0.399,
        3 => 0.994,
        4 => 0.512,
        5 => 0.844,
        6 => 0.611,
        7 => 0.857,
        8 => 0.669,
        9 => 0.872,
        _ if n % 2 == 1 => n as f64 / (n as f64 + 1.4),
        _ => n as f64 / (n as f64 + 3.8),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    #[test]
    fn a_third_of_nonsense_does_not_move_the_median_much_nor_the_scale() {
        let mut noise = Noise::new(1);
        let mut values: Vec<f64> = (0..200).map(|_| 5.0 + 2.0 * noise.normal()).collect();
        let clean = qn(&values).expect("many");
        assert!((clean - 2.0).abs() < 0.25, "{clean}");
        values.extend((0..60).map(|k| 1e9 + f64::from(k) * 1e7));
        assert!((median(&values).expect("many") - 5.0).abs() < 1.5);
        assert!(qn(&values).expect("many") < 2.0 * clean);
    }

    #[test]
    fn the_scale_of_few_values_is_right_on_average() {
        let mut noise = Noise::new(2);
        for n in [5_usize, 8, 13, 30] {
            let mean = (0..2000)
                .map(|_| qn(&(0..n).map(|_| noise.normal()).collect::<Vec<_>>()).expect("two or more"))
                .sum::<f64>()
                / 2000.0;
            assert!((mean - 1.0).abs() < 0.06, "{n}: {mean}");
        }
    }

    #[test]
    fn nothing_and_one_value_have_no_scale() {
        assert_eq!((median(&[]), qn(&[]), qn(&[1.0])), (None, None, None));
    }
}
