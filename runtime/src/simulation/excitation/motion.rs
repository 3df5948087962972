//! A motion that was designed.

use super::fourier::FourierMotion;
use super::point_to_point::PointToPointMotion;
use crate::simulation::Reference;

/// A motion that was designed.
#[derive(Debug, Clone, PartialEq)]
pub enum ExcitingMotion {
    /// A Fourier series.
    Fourier(FourierMotion),
    /// Points joined by a profile.
    PointToPoint(PointToPointMotion),
}

impl ExcitingMotion {
    /// The same path, slower by a factor above 1.
    pub fn stretch(&mut self, factor: f64) {
        match self {
            Self::Fourier(motion) => {
                motion.period *= factor;
                motion.joints.iter_mut().for_each(|joint| joint.scale(1.0 / factor));
            }
            Self::PointToPoint(motion) => motion.stretch(factor),
        }
    }
}

impl Reference for ExcitingMotion {
    fn joints(&self) -> usize {
        match self {
            Self::Fourier(motion) => motion.joints(),
            Self::PointToPoint(motion) => motion.joints(),
        }
    }

    fn duration(&self) -> f64 {
        match self {
            Self::Fourier(motion) => motion.duration(),
            Self::PointToPoint(motion) => motion.duration(),
        }
    }

    fn at(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        match self {
            Self::Fourier(motion) => motion.at(t, q, dq, ddq),
            Self::PointToPoint(motion) => motion.at(t, q, dq, ddq),
        }
    }

    fn fixed(&self) -> Vec<usize> {
        match self {
            Self::Fourier(motion) => motion.fixed(),
            Self::PointToPoint(motion) => motion.fixed(),
        }
    }
}
