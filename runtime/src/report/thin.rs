//! Fewer points that make the same picture.

/// More points than this in a line are thinned to their extremes per pixel: the picture stays the same.
pub(super) const MOST_POINTS: usize = 1400;

/// Where a line has more points than pixels: the lowest and the highest point of each run, in their order.
pub(super) fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MOST_POINTS {
        return points.to_vec();
    }
    let run = points.len().div_ceil(MOST_POINTS / 2);
    let mut kept = Vec::with_capacity(MOST_POINTS + 2);
    for chunk in points.chunks(run) {
        let by_y = |a: &usize, b: &usize| chunk[*a].1.total_cmp(&chunk[*b].1);
        let low = (0..chunk.len()).min_by(by_y);
        let high = (0..chunk.len()).max_by(by_y);
        if let (Some(low), Some(high)) = (low, high) {
            kept.push(chunk[low.min(high)]);
            if low != high {
                kept.push(chunk[low.max(high)]);
            }
        }
    }
    kept
}

/// About `most` of `count` rows for columns that belong together, in their order: of each run of rows the first, one in
/// the middle, the first gap (a value that is not finite) and the extremes of every column of `y`; of all rows the
/// extremes of every column of `x`. Every row where there are no more.
pub(super) fn kept_rows(count: usize, x: &[&[f64]], y: &[&[f64]], most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let runs = (most / (2 * y.len() + 2)).max(1);
    let mut kept = Vec::with_capacity(most + 2 * x.len());
    let mut keep_extremes = |column: &[f64], from: usize, to: usize| {
        let finite = || (from..to).filter(|&k| column[k].is_finite());
        kept.extend(finite().min_by(|&a, &b| column[a].total_cmp(&column[b])));
        kept.extend(finite().max_by(|&a, &b| column[a].total_cmp(&column[b])));
        kept.extend((from..to).find(|&k| !column[k].is_finite()));
    };
    x.iter().for_each(|column| keep_extremes(column, 0, count));
    let run = count.div_ceil(runs);
    for from in (0..count).step_by(run) {
        let to = (from + run).min(count);
        y.iter().for_each(|column| keep_extremes(column, from, to));
    }
    kept.extend((0..count).step_by(run).flat_map(|from| [from, (from + run / 2).min(count - 1)]));
    kept.push(count - 1);
    kept.sort_unstable();
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_line_keeps_its_extremes() {
        let mut points: Vec<(f64, f64)> = (0..100_000).map(|k| (k as f64, (k as f64 * 0.01).sin())).collect();
        points[54_321].1 = 7.0;
        let thin = thinned(&points);
        assert!(thin.len() <= MOST_POINTS + 2);
        assert!(thin.contains(&(54_321.0, 7.0)));
        assert!(thin.windows(2).all(|w| w[0].0 < w[1].0));
    }

    #[test]
    fn rows_of_several_columns_keep_the_extremes_and_the_gaps_of_each() {
        let x: Vec<f64> = (0..50_000).map(|k| (k as f64 * 0.37).cos()).collect();
        let mut y = [x.clone(), x.iter().map(|v| -v).collect::<Vec<f64>>()];
        (y[0][777], y[1][33_333], y[1][40_000]) = (9.0, -9.0, f64::NAN);
        let rows = kept_rows(x.len(), &[&x], &[&y[0], &y[1]], 3000);
        assert!(rows.len() < 4000, "{}", rows.len());
        assert!(rows.windows(2).all(|w| w[0] < w[1]));
        for k in [0, 777, 33_333, 40_000, 49_999] {
            assert!(rows.contains(&k), "{k}");
        }
        assert_eq!(kept_rows(10, &[], &[], 3000).len(), 10);
    }
}
