//! What is fitted, and what must hold of it. Equation numbers are those of Gautier and Briot.

use nalgebra::{DMatrix, DVector};

use crate::estimation::Factor;
use crate::model::{ParameterKind, Robot};

/// A linear combination of standard parameters.
pub(super) type Combination = Vec<(usize, f64)>;

/// min ||G x - y||^2 over standard parameters x that are possible.
pub(super) struct Problem {
    pub g: DMatrix<f64>,
    pub y: DVector<f64>,
    /// GT G
    pub normal: DMatrix<f64>,
    /// The ten inertial parameters of each link.
    pub links: Vec<[usize; 10]>,
    /// Combinations that must be positive.
    pub positive: Vec<Combination>,
    pub start: DVector<f64>,
    pub free: f64,
}

const INERTIAL: [ParameterKind; 10] = {
    use ParameterKind::{M, MX, MY, MZ, XX, XY, XZ, YY, YZ, ZZ};
    [XX, XY, XZ, YY, YZ, ZZ, MX, MY, MZ, M]
};

impl Problem {
    /// The equations of `stacked` for standard parameters; `unweighted` has the speeds, `free` is the squared error
    /// without constraints.
    pub fn new(robot: &Robot, stacked: &Factor, unweighted: &Factor, free: f64) -> Problem {
        let (base, standard) = (robot.base.len(), robot.standard.len());
        let mut g = DMatrix::<f64>::zeros(base + 1, standard);
        for (b, parameter) in robot.base.iter().enumerate() {
            for &(k, coefficient) in parameter.combination.iter() {
                (0..=b).for_each(|i| g[(i, k)] += coefficient * stacked.r(i, b));
            }
        }
        let y = DVector::from_fn(base + 1, |i, _| stacked.r(i, base));
        let normal = g.tr_mul(&g);
        let mut problem = Problem {
            normal,
            g,
            y,
            links: Vec::new(),
            positive: Vec::new(),
            start: DVector::zeros(standard),
            free,
        };
        problem.bodies(robot);
        problem.friction(robot, unweighted);
        problem.rotors(robot);
        problem
    }

    fn bodies(&mut self, robot: &Robot) {
        for frame in 0..robot.frames.len() {
            let own = INERTIAL.map(|kind| parameter(robot, frame, kind));
            let known: Vec<usize> = own.into_iter().flatten().collect();
            let Ok(link) = <[usize; 10]>::try_from(known) else { continue };
            for (place, value) in [(0, 0.1), (3, 0.1), (5, 0.1), (9, 1.0)] {
                self.start[link[place]] = value;
            }
            self.links.push(link);
        }
    }

    /// The speeds come from the columns of Fv and Fc, which are v and sign(v) of each row.
    fn friction(&mut self, robot: &Robot, unweighted: &Factor) {
        use ParameterKind::{Fc, Fcc, Fcm, Fv, Fvc, Fvm};
        let column = |standard: usize| robot.base.iter().position(|b| b.standard == standard);
        let product = |a: usize, b: usize| -> f64 {
            (0..=a.min(b)).map(|i| unweighted.r(i, a) * unweighted.r(i, b)).sum()
        };
        let of_frame = |frame: usize| {
            [(Fv, Fc), (Fvm, Fcm)].map(|(v, c)| [v, c].map(|kind| parameter(robot, frame, kind)))
        };
        let of_coupling = |k: usize| {
            let position = |kind| robot.standard.iter().position(|p| p.coupling == Some(k) && p.kind == kind);
            [Fvc, Fcc].map(position)
        };
        let joints = (0..robot.frames.len()).flat_map(of_frame);
        for pair in joints.chain((0..robot.couplings.len()).map(of_coupling)) {
            let known: Vec<usize> = pair.into_iter().flatten().collect();
            known.iter().for_each(|&k| self.start[k] = 1.0);
            let speeds = match known.as_slice() {
                &[v, c] => column(v).zip(column(c)).and_then(|(v, c)| {
                    let (vv, vc, cc) = (product(v, v), product(v, c), product(c, c));
                    (cc > 0.0 && vc > 0.0).then(|| [vc / cc, vv / vc])
                }),
                _ => None,
            };
            match (speeds, known.as_slice()) {
                (Some(speeds), &[v, c]) => {
                    self.positive.extend(speeds.map(|speed| vec![(c, 1.0), (v, speed)]));
                }
                _ => self.positive.extend(known.iter().map(|&k| vec![(k, 1.0)])),
            }
        }
    }

    fn rotors(&mut self, robot: &Robot) {
        let (positive, start) = rotors(robot, |_| 0.1);
        self.positive.extend(positive);
        start.into_iter().for_each(|(k, value)| self.start[k] = value);
    }
}

/// The rotor inertias at the motors as combinations of the standard parameters Ia, and the Ia that have them start at
/// `inertia`, motor by motor and in units of the joint.
///
/// Ja = ((N∘N)ᵀ)⁻¹ Ia by (26), rows scaled by N_mm²; where there is no inverse, Ia stands for Ja.
pub(super) fn rotors(robot: &Robot, inertia: impl Fn(usize) -> f64) -> (Vec<Combination>, Vec<(usize, f64)>) {
    let n = robot.joints();
    let frames = robot.joint_of_frame();
    let mut own = vec![None; n];
    for (frame, joint) in frames.iter().enumerate() {
        if let Some(j) = joint {
            own[*j] = parameter(robot, frame, ParameterKind::Ia);
        }
    }
    let Some(own) = own.into_iter().collect::<Option<Vec<usize>>>() else { return Default::default() };
    let gear = &robot.drive.gear;
    let squared = DMatrix::from_fn(n, n, |m, j| (gear[m * n + j] / gear[m * n + m]).powi(2)).transpose();
    let at_motor = DVector::from_fn(n, |m, _| inertia(m));
    let start = &squared * &at_motor;
    match squared.try_inverse() {
        Some(inverse) => {
            let row = |m: usize| {
                (0..n).filter(|&j| inverse[(m, j)] != 0.0).map(|j| (own[j], inverse[(m, j)])).collect()
            };
            ((0..n).map(row).collect(), (0..n).map(|j| (own[j], start[j])).collect())
        }
        None => {
            let alone = own.iter().map(|&k| vec![(k, 1.0)]).collect();
            (alone, (0..n).map(|j| (own[j], at_motor[j])).collect())
        }
    }
}

pub(super) fn parameter(robot: &Robot, frame: usize, kind: ParameterKind) -> Option<usize> {
    robot.standard.iter().position(|p| p.frame == frame && p.kind == kind)
}
