//! Bins of equally many points, so that the mean of each is known as well as that of any other.

/// Points in the order of a variable, cut into bins; the last may have fewer.
#[derive(Debug)]
pub(crate) struct Bins<P> {
    sorted: Vec<P>,
    size: usize,
}

impl<P> Bins<P> {
    /// At most `most` bins of the points over a variable.
    pub fn over(mut points: Vec<P>, most: usize, variable: impl Fn(&P) -> f64) -> Self {
        points.sort_by(|a, b| variable(a).total_cmp(&variable(b)));
        let size = points.len().div_ceil(most.max(1)).max(1);
        Self { sorted: points, size }
    }

    /// The bins, from the least value to the largest.
    pub fn iter(&self) -> impl Iterator<Item = &[P]> {
        self.sorted.chunks(self.size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_hold_all_points_in_order_and_equally_many() {
        let bins = Bins::over(vec![3.0, -1.0, 7.0, 2.0, 5.0], 2, |x| *x);
        assert_eq!(bins.iter().collect::<Vec<_>>(), [&[-1.0, 2.0, 3.0][..], &[5.0, 7.0]]);
        assert_eq!(Bins::over(Vec::<f64>::new(), 0, |x| *x).iter().count(), 0);
    }
}
