//! What links ask for through compliant transmissions, and what a link behind one adds to the torques.

use crate::diagnosis::rows::series::Series;
use crate::diagnosis::rows::signals::{ModelTorques, Signals};
use crate::diagnosis::rules::{LEAST_LINK_INERTIA, POSITION_STEP};
use crate::effects::{LinkSide, Stretch, Transmission, deflection, stretch_at_start};
use crate::model::Model;
use std::sync::OnceLock;

/// A model and its base parameters.
type Parametrised<'a> = (&'a dyn Model, &'a [f64]);

/// The rigid robot in one motion.
#[derive(Clone)]
pub(in crate::diagnosis) struct Links {
    joints: usize,
    /// Rigid torque, `[j][t]`.
    load: Vec<Vec<f64>>,
    /// Mass matrix, `[i * n + j][t]`.
    mass: Vec<Vec<f64>>,
    /// Derivatives of the rigid torques by the position of each joint, `[j][i][t]`.
    bent: Vec<OnceLock<Vec<Vec<f64>>>>,
}

impl Links {
    /// Of one motion.
    pub fn new(model: &dyn Model, chi: &[f64], s: &Signals) -> Self {
        let n = s.q.len();
        let mut links = Self {
            joints: n,
            load: vec![vec![0.0; s.len()]; n],
            mass: vec![vec![0.0; s.len()]; n * n],
            bent: (0..n).map(|_| OnceLock::new()).collect(),
        };
        let mut rigid = Rigid::new((model, chi), n);
        for t in 0..s.len() {
            rigid.at(s, t, None);
            for i in 0..n {
                links.load[i][t] = rigid.torque[i];
                for k in 0..n {
                    links.mass[i * n + k][t] = rigid.mass[i * n + k];
                }
            }
        }
        links
    }

    /// Inertia about a joint, rotor included.
    pub fn inertia(&self, j: usize) -> &[f64] {
        self.coupling(j, j)
    }

    /// The torque on joint `on` for one unit of acceleration of joint `of`.
    pub fn coupling(&self, on: usize, of: usize) -> &[f64] {
        &self.mass[on * self.joints + of]
    }

    /// The torques on all joints that an acceleration of joint j asks for.
    pub fn inertial(&self, j: usize, acceleration: &[f64]) -> Series {
        let n = self.joints;
        let on = |i: usize| acceleration.iter().zip(self.coupling(i, j)).map(|(a, m)| m * a).collect();
        (0..n).map(|i| (i, on(i))).collect()
    }

    /// The torques on all joints beyond those of the rigid model where joint j has this transmission.
    pub fn compliant(
        &self,
        robot: Parametrised<'_>,
        (signals, torques): (&Signals, &ModelTorques),
        j: usize,
        t: &Transmission,
    ) -> Series {
        let side = self.driven(robot, signals, j, t);
        let link = side.link(signals.rate);
        let measured = &signals.torque[j];
        let start = if measured.iter().any(|x| *x != 0.0) {
            let rigid = &torques.total[j];
            let missing: Vec<f64> = measured.iter().zip(rigid).map(|(tau, model)| tau - model).collect();
            stretch_at_start(&link, &missing, t, signals.edge_samples)
        } else {
            // A motion that nobody has measured.
            Stretch::under(side.load.first().copied().unwrap_or(0.0), t)
        };
        self.swung(&side, &link, t, start)
    }

    /// The torques of a transmission that rings without a load, from one unit of stretch at the start and from one of its
    /// rate, such that both are torques of one size.
    pub fn ringing(&self, robot: Parametrised<'_>, s: &Signals, j: usize, t: &Transmission) -> Vec<Series> {
        let side = self.driven(robot, s, j, t);
        let unloaded = vec![0.0; side.load.len()];
        let link = LinkSide { load: &unloaded, ..side.link(s.rate) };
        let spring = Transmission { play: 0.0, ..*t };
        let angular = 2.0 * std::f64::consts::PI * t.frequency;
        let starts =
            [Stretch { x: 1.0 / t.stiffness, dx: 0.0 }, Stretch { x: 0.0, dx: angular / t.stiffness }];
        starts.map(|start| self.swung(&side, &link, &spring, start)).into()
    }

    /// What a transmission of joint j drives.
    fn driven(&self, robot: Parametrised<'_>, s: &Signals, j: usize, t: &Transmission) -> Driven<'_> {
        let bent = self.bent[j].get_or_init(|| bent(robot, s, j));
        let of_link = |m: &f64| (m - t.rotor).max(LEAST_LINK_INERTIA * m.abs()).max(1e-9);
        Driven {
            joint: j,
            load: self.load[j].iter().zip(&s.ddq[j]).map(|(l, a)| l - t.rotor * a).collect(),
            inertia: self.inertia(j).iter().map(of_link).collect(),
            bent,
        }
    }

    /// What a link that swings behind its joint adds to the torques of all joints.
    fn swung(&self, side: &Driven<'_>, link: &LinkSide<'_>, t: &Transmission, start: Stretch) -> Series {
        let j = side.joint;
        let (mut x, mut swung) = (vec![0.0; link.load.len()], vec![0.0; link.load.len()]);
        deflection(link, t, start, [&mut x, &mut swung]);
        let n = self.joints;
        // Of joint j, N.m or N, and as an acceleration of the links, whose inertia loads the other joints.
        let accelerated: Vec<f64> = swung.iter().zip(&side.inertia).map(|(torque, m)| torque / m).collect();
        let on = |i: usize| {
            let bent = side.bent[i].iter().zip(&x).map(|(bent, x)| bent * x);
            let torque: Vec<f64> = if i == j {
                swung.iter().zip(bent).map(|(swung, bent)| swung - bent).collect()
            } else {
                let coupled = accelerated.iter().zip(&self.mass[i * n + j]).map(|(a, m)| a * m);
                coupled.zip(bent).map(|(coupled, bent)| coupled - bent).collect()
            };
            (i, torque)
        };
        (0..n).map(on).collect()
    }
}

/// The links behind a transmission.
struct Driven<'a> {
    joint: usize,
    load: Vec<f64>,
    inertia: Vec<f64>,
    /// How the torques of all joints change with the position of this one.
    bent: &'a [Vec<f64>],
}

impl Driven<'_> {
    fn link(&self, rate: f64) -> LinkSide<'_> {
        LinkSide { load: &self.load, inertia: &self.inertia, stiffness: &self.bent[self.joint], rate }
    }
}

/// How the rigid torques of all joints change with the position of one, `[i][t]`, by central differences.
fn bent(robot: Parametrised<'_>, s: &Signals, j: usize) -> Vec<Vec<f64>> {
    let n = s.q.len();
    let mut bent = vec![vec![0.0; s.len()]; n];
    let mut rigid = Rigid::new(robot, n);
    for t in 0..s.len() {
        for step in [POSITION_STEP, -POSITION_STEP] {
            rigid.at(s, t, Some((j, step)));
            for (bent, torque) in bent.iter_mut().zip(&rigid.torque) {
                bent[t] += torque / (2.0 * step);
            }
        }
    }
    bent
}

/// The rigid model at an instant.
struct Rigid<'a> {
    robot: Parametrised<'a>,
    q: Vec<f64>,
    dq: Vec<f64>,
    mass: Vec<f64>,
    bias: Vec<f64>,
    torque: Vec<f64>,
}

impl<'a> Rigid<'a> {
    fn new(robot: Parametrised<'a>, n: usize) -> Self {
        let zero = vec![0.0; n];
        let mass = vec![0.0; n * n];
        Self { robot, q: zero.clone(), dq: zero.clone(), mass, bias: zero.clone(), torque: zero }
    }

    /// At a sample, with one joint moved from where it is.
    fn at(&mut self, s: &Signals, t: usize, moved: Option<(usize, f64)>) {
        let n = self.q.len();
        for j in 0..n {
            (self.q[j], self.dq[j]) = (s.q[j][t], s.dq[j][t]);
        }
        if let Some((j, step)) = moved {
            self.q[j] += step;
        }
        let (model, chi) = self.robot;
        model.mass_and_bias(chi, &self.q, &self.dq, &mut self.mass, &mut self.bias);
        for i in 0..n {
            self.torque[i] = self.bias[i] + (0..n).map(|k| self.mass[i * n + k] * s.ddq[k][t]).sum::<f64>();
        }
    }
}
