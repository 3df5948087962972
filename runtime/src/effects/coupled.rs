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

    /// Speed over which dry friction of the rotor turns its sign, rad/s or m/s of joint b.
    const ROUNDING: f64 = 0.01;

    /// Neighbouring joints, and those with one between them, whose coupling the model does not have: belts and shafts run through a
    /// joint, as those of the last two axes do through the fourth in a hollow wrist.
    pub fn places(robot: &Robot) -> Vec<Place> {
        let n = robot.joints();
        let mut places = Vec::new();
        let beyond = |between: usize| (between..n).map(move |j| (j - between, j));
        for (low, high) in beyond(1).chain(beyond(2)) {
            for (a, b) in [(low, high), (high, low)] {
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
        [v, Self::direction(v), dv].map(|x| [self.ratio * x, x])
    }

    /// The sign of the rotor's speed, which does not turn in an instant. The rotor passes zero while both joints move, and may
    /// stay near it for long: a sign that jumps there would say of the ratio what nobody knows of the speed.
    pub fn direction(speed: f64) -> f64 {
        (speed / Self::ROUNDING).tanh()
    }

    /// The most that dry friction of the rotor holds against, `[on a, on b]`, N.m or N: at rest its sign is any.
    pub fn dry_friction(&self, amplitude: &[f64]) -> [f64; 2] {
        let coulomb = amplitude.get(1).map_or(0.0, |coulomb| coulomb.abs());
        [self.ratio.abs() * coulomb, coulomb]
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dry_friction_of_a_rotor_that_hardly_turns_has_no_full_sign_and_of_one_that_turns_it_has() {
        let of = |dq: [f64; 2]| CoupledRotor { ratio: -0.5 }.columns(dq, [0.0, 0.0])[1];
        assert_eq!(of([2.0, 1.0]), [0.0, 0.0]);
        let [on_a, on_b] = of([2.0, 1.001]);
        assert!((0.05..0.2).contains(&on_b) && on_a == -0.5 * on_b, "{on_a} {on_b}");
        assert!(of([2.0, 1.1])[1] > 0.999 && of([2.0, 0.9])[1] < -0.999);
    }

    #[test]
    fn a_rotor_at_rest_holds_each_joint_by_what_it_turns_with_it() {
        assert_eq!(CoupledRotor { ratio: -0.5 }.dry_friction(&[3.0, -0.2, 1.0]), [0.1, 0.2]);
        assert_eq!(CoupledRotor { ratio: 0.5 }.dry_friction(&[]), [0.0, 0.0]);
    }

    #[test]
    fn a_rotor_may_turn_with_neighbours_and_with_joints_that_have_one_between_them() {
        use crate::model::Model;
        let mut robot = crate::simulation::testing::arm().0.robot().clone();
        let n = robot.joints();
        // No motor of this one turns with another joint.
        robot.drive.gear = (0..n * n).map(|k| f64::from(u8::from(k % (n + 1) == 0))).collect();
        let pairs = |apart: usize| (apart..n).flat_map(move |j| [(j - apart, j), (j, j - apart)]);
        let expected: Vec<Place> = (1..=2).flat_map(pairs).map(|(a, b)| Place::Pair(a, b)).collect();
        assert_eq!(CoupledRotor::places(&robot), expected);
        // Where joint 2's motor does already it is in the model.
        let mut gear = robot.drive.gear.to_vec();
        gear[n] = 0.5;
        robot.drive.gear = gear.into();
        assert!(!CoupledRotor::places(&robot).contains(&Place::Pair(0, 1)));
    }
}
