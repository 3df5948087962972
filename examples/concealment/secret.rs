//! What a case hides: which effect, where, and its drawn shape.

use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::Model;

use crate::options::Pushed;
use crate::places::Places;
use crate::random::Random;

/// An effect that is hidden.
#[derive(Debug, Clone)]
pub struct Secret {
    /// Which.
    pub effect: EffectKind,
    /// 0-based joint that it must be named on; `None` where it is the whole robot's.
    pub joint: Option<usize>,
    /// What its law needs of chance, each uniform in 0..1.
    pub chance: [f64; 4],
    /// Largest torque of its joint in what is diagnosed, N.m or N; 0 where its law does not count against it.
    pub most_torque: f64,
    /// When it pushes, s, where it is a contact.
    pub window: [f64; 2],
}

impl Secret {
    /// Draws a place and a shape. Joints that are `taken` are used only where there is no other.
    pub fn draw(effect: EffectKind, model: &dyn Model, taken: &[usize], random: &mut Random) -> Option<Self> {
        let places = crate::hiding::of(effect)?.places;
        let joint = match places(model) {
            Places::Robot => None,
            Places::Joints(mut joints) => {
                if joints.iter().any(|j| !taken.contains(j)) {
                    joints.retain(|j| !taken.contains(j));
                }
                Some(*joints.get(random.below(joints.len()))?)
            }
        };
        let chance = std::array::from_fn(|_| random.share());
        Some(Self { effect, joint, chance, most_torque: 0.0, window: [0.0; 2] })
    }

    /// Draws a contact: when in a motion of this duration, s, and which joint it pushes where it pushes one.
    pub fn push(&mut self, model: &dyn Model, (pushed, [least, most]): (Pushed, [f64; 2]), duration: f64) {
        let lasts = self.between(3, least, most);
        let mut from = self.between(2, 1.5, 5.0);
        if from + lasts > duration - 1.0 {
            from = self.between(2, 0.2, 0.8) * (duration - lasts);
        }
        self.window = [from, from + lasts];
        if pushed == Pushed::Joint {
            let joints = model.robot().joints();
            self.joint = Some(((self.chance[0] * joints as f64) as usize).min(joints.saturating_sub(1)));
        }
    }

    /// The k-th number of chance, uniform in `low..high`.
    pub fn between(&self, k: usize, low: f64, high: f64) -> f64 {
        low + (high - low) * self.chance[k]
    }
}

/// Whether the effect is a change since an earlier recording.
pub fn is_change(effect: EffectKind) -> bool {
    crate::hiding::of(effect).is_some_and(|hiding| hiding.is_change)
}
