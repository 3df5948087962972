//! The mean course of a cloud of points.

use crate::statistics::bins::Bins;

/// Means of points over bins of equally many, from the least x to the largest: x and y of each. Points that are not finite
/// have no part.
pub fn binned_means(points: &[(f64, f64)], bins: usize) -> Vec<(f64, f64)> {
    let finite = points.iter().copied().filter(|p| p.0.is_finite() && p.1.is_finite());
    let mean = |bin: &[(f64, f64)]| {
        let n = bin.len() as f64;
        (bin.iter().map(|p| p.0).sum::<f64>() / n, bin.iter().map(|p| p.1).sum::<f64>() / n)
    };
    Bins::over(finite.collect(), bins, |p| p.0).iter().map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_is_that_of_the_cloud_and_has_no_more_points_than_bins() {
        let points: Vec<(f64, f64)> = (0..1003)
            .map(|k| (f64::from(k * 7 % 1003), f64::from(k * 7 % 1003) + if k % 2 == 0 { 5.0 } else { -5.0 }))
            .chain([(f64::NAN, 1e9), (3.0, f64::NAN)])
            .collect();
        let means = binned_means(&points, 40);
        assert!(means.len() <= 40 && means.windows(2).all(|w| w[0].0 < w[1].0));
        assert!(means.iter().all(|(x, y)| (x - y).abs() < 1.5), "{means:?}");
        assert!(binned_means(&[], 40).is_empty());
    }
}
