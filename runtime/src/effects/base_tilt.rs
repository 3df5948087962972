//! Gravity direction that differs from the model: the derivative with respect to a turn of gravity.

use super::{Seeds, Sensitivity, Variant, Words};
use crate::model::Robot;

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "base_tilt",
    title: "Base tilt",
    what: "The base does not stand as the model says: gravity acts from another direction.",
    looks_like: "gravity torques of all joints, also of joints with a vertical axis",
    revealed_by: "joint position",
    experiment: "slow motions of the first joint over its full travel with the arm stretched out",
    source: "Khalil and Dombre 2002",
};

/// The law.
pub(super) struct BaseTilt;

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
}

/// Two unit vectors square to gravity: x and y of frame 0 for gravity along z.
fn across(g: [f64; 3]) -> [[f64; 3]; 2] {
    let down = (0..3).max_by(|&i, &k| g[i].abs().total_cmp(&g[k].abs())).unwrap_or(2);
    let mut axes = [[0.0; 3]; 2];
    axes[0][(down + 1) % 3] = 1.0;
    axes[1][(down + 2) % 3] = 1.0;
    axes
}
