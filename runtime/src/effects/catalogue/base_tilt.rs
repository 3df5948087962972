//! Gravity direction that differs from the model: the derivative with respect to a turn of gravity.

use crate::effects::{
    Abscissa, Effect, Form, Properties, Quantities, Seeds, Sensitivity, SmoothingWindow, Sought, Variant,
    Words,
};
use crate::model::{JointKind, Robot};

/// What a person is told.
const WORDS: Words = Words {
    id: "base_tilt",
    name: "base tilt",
    what: "The base does not stand as the model says: gravity acts from another direction.",
    looks_like: "gravity torques of all joints, also of joints with a vertical axis",
    revealed_by: "joint position",
    experiment: "slow motions of the first joint over its full travel with the arm stretched out",
    source: "Khalil and Dombre 2002",
    symbols: &[
        ("tilt_1", "turn of gravity about the first axis across it"),
        ("tilt_2", "the same about the second axis"),
    ],
    put_in: "another direction of `gravity` in the robot's YAML than in the one that the recording names",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: false,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::Position,
    along_motion: false,
    may_stand: false,
    is_factor: false,
};

/// The effect.
pub(super) struct BaseTilt;

impl Effect for BaseTilt {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Sensitivity(&BaseTilt)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("the base is tilted by {} and {}", q.text("tilt_1"), q.text("tilt_2"))
    }

    fn formula(&self, _: &Quantities) -> String {
        String::new()
    }
}

impl Sensitivity for BaseTilt {
    /// Two turns of gravity about axes of frame 0 that are square to it.
    fn variants(&self, _: &Robot) -> Vec<Variant> {
        (0..2)
            .map(|index| Variant { joint: None, index, name: ["tilt_1", "tilt_2"][index], unit: "rad" })
            .collect()
    }

    fn together(&self) -> bool {
        true
    }

    fn seed(&self, variant: &Variant, seeds: &mut Seeds<'_>) {
        let g = seeds.gravity.map(|x| x.value);
        let axes = across(g);
        let a = axes[variant.index];
        let turned = [a[1] * g[2] - a[2] * g[1], a[2] * g[0] - a[0] * g[2], a[0] * g[1] - a[1] * g[0]];
        for (gravity, slope) in seeds.gravity.iter_mut().zip(turned) {
            gravity.slope = slope;
        }
    }

    /// Gravity that has left the direction of a first axis pulls at first moments that upright gravity never showed:
    /// a sine and a cosine of that joint's angle.
    fn uncovered(&self, robot: &Robot, q: &[Vec<f64>]) -> Vec<(usize, Vec<f64>)> {
        let g = robot.gravity;
        let size = g.iter().map(|x| x * x).sum::<f64>().sqrt();
        let joint_of = robot.joint_of_frame();
        let mut columns = Vec::new();
        for ((frame, joint), motion) in robot.frames.iter().zip(joint_of).zip(robot.motions()) {
            let (Some(j), None, JointKind::Revolute) = (joint, frame.parent, frame.kind) else { continue };
            // Of a frame that moves with several joints it would not be a column of one joint alone.
            let [(_, times)] = motion.terms[..] else { continue };
            // Its axis is z of the frame: turned by gamma about z, then by alpha about x.
            let (sine, cosine) = frame.alpha.sin_cos();
            let axis = [frame.gamma.sin() * sine, -frame.gamma.cos() * sine, cosine];
            let along = axis.iter().zip(g).map(|(a, g)| a * g).sum::<f64>().abs();
            if along > 0.999 * size {
                columns.push((j, q[j].iter().map(|q| (times * q).sin()).collect()));
                columns.push((j, q[j].iter().map(|q| (times * q).cos()).collect()));
            }
        }
        columns
    }
}

/// Two unit vectors square to gravity: x and y of frame 0 for gravity along z.
fn across(g: [f64; 3]) -> [[f64; 3]; 2] {
    let down = (0..3).max_by(|&i, &k| g[i].abs().total_cmp(&g[k].abs())).unwrap_or(2);
    let mut axes = [[0.0; 3]; 2];
    axes[0][(down + 1) % 3] = 1.0;
    axes[1][(down + 2) % 3] = 1.0;
    axes
}
