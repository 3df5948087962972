//! What a standard deviation that is known from little is worth.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// The normal deviate that one of forty exceeds: half an interval of 95 %, in standard deviations.
const NORMAL: f64 = 1.959_963_984_540_054;
/// Probability below that deviate.
const BELOW: f64 = 0.975;
/// Fewest degrees of freedom that are told apart: below, an interval says nothing.
const FEWEST: f64 = 2.0;

/// The factor, 1 at least, that makes of a standard deviation with so many degrees of freedom one whose 1.96-fold is half an
/// interval of 95 %: Student's deviate over the normal one.
pub(crate) fn student_factor(freedom: f64) -> f64 {
    if !freedom.is_finite() {
        return 1.0;
    }
    let student = StudentsT::new(0.0, 1.0, freedom.max(FEWEST));
    student.map_or(1.0, |t| (t.inverse_cdf(BELOW) / NORMAL).max(1.0))
}

/// The normal deviate that is passed as often as a deviate whose standard deviation is known with so many degrees of freedom, to
/// a hundredth from three of them on (Wallace 1959).
pub(crate) fn as_normal(deviate: f64, freedom: f64) -> f64 {
    let factor = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    deviate.signum() * factor * (freedom * (deviate * deviate / freedom).ln_1p()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn few_degrees_of_freedom_make_a_deviate_larger_and_many_do_not() {
        // scipy.stats.t.ppf(0.975, n)
        assert_relative_eq!(student_factor(5.0) * NORMAL, 2.570581835636314, max_relative = 1e-8);
        assert_relative_eq!(student_factor(30.0) * NORMAL, 2.0422724563012373, max_relative = 1e-8);
        assert!(student_factor(1e7) < 1.0001);
        assert_eq!(student_factor(f64::INFINITY), 1.0);
        assert_eq!(student_factor(0.1), student_factor(2.0));
    }

    #[test]
    fn a_deviate_is_worth_the_normal_one_that_is_as_rare() {
        // scipy.stats.norm.isf(scipy.stats.t.sf(t, n))
        for (deviate, freedom, normal) in
            [(2.0, 5.0, 1.635522896700), (6.9, 40.0, 5.567454144200), (8.0, 100.0, 7.016628125725)]
        {
            assert_relative_eq!(as_normal(deviate, freedom), normal, max_relative = 0.01);
            assert_relative_eq!(as_normal(-deviate, freedom), -normal, max_relative = 0.01);
        }
        assert_eq!(as_normal(0.0, 5.0), 0.0);
        assert_relative_eq!(as_normal(3.0, 1e9), 3.0, max_relative = 1e-6);
    }
}
