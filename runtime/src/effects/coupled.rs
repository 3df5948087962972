//! A rotor that two joints drive: its speed is dq_b + ratio·dq_a.

use super::place::Place;
use super::quantity::Parameter;
use super::shape::{ShapeSearch, Step};
use crate::model::Robot;

/// The coupling of joint b's motor to joint a.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoupledRotor {
    /// Ratio of the motor's speed to dq_a, in units of its ratio to dq_b.
    pub ratio: f64,
}

impl CoupledRotor {
    /// Ratios to try.
    pub const RATIOS: [f64; 6] = [-1.0, -0.5, -0.25, 0.25, 0.5, 1.0];

    /// Neighbouring joints whose coupling the model does not have.
    pub fn places(robot: &Robot) -> Vec<Place> {
        let n = robot.joints();
        let mut places = Vec::new();
        for j in 1..n {
            for (a, b) in [(j - 1, j), (j, j - 1)] {
                let known = robot.drive.gear.get(b * n + a).is_some_and(|g| *g != 0.0);
                if !known {
                    places.push(Place::Pair(a, b));
                }
            }
        }
        places
    }

    /// How the ratio is searched: beyond 1 it is the law of the two joints in the other order.
    pub fn shape_search() -> ShapeSearch {
        ShapeSearch { steps: vec![Step::Times(1.4)], bounds: vec![[-1.0, 1.0]], together: Vec::new() }
    }

    /// Columns for viscous friction, Coulomb friction and inertia of the rotor: `[on a, on b]` each.
    pub fn columns(&self, dq: [f64; 2], ddq: [f64; 2]) -> [[f64; 2]; 3] {
        let v = self.ratio * dq[0] + dq[1];
        let dv = self.ratio * ddq[0] + ddq[1];
        let sign = if v == 0.0 { 0.0 } else { v.signum() };
        [v, sign, dv].map(|x| [self.ratio * x, x])
    }

    /// Amplitudes and ratio as the quantities a person knows, with their standard deviations.
    pub fn parameters(&self, amplitude: &[f64], sigma: &[f64], ratio_sigma: f64) -> Vec<Parameter> {
        let names = [("viscous", "N.m.s/rad"), ("coulomb", "N.m"), ("inertia", "kg.m2")];
        let mut list: Vec<Parameter> = names
            .iter()
            .zip(amplitude.iter().zip(sigma))
            .map(|((name, unit), (a, s))| Parameter::new(name, *a, *s, unit))
            .collect();
        list.push(Parameter::new("ratio", self.ratio, ratio_sigma, "1"));
        list
    }
}
