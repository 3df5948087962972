//! How each effect is hidden: where it can be, how large, and how it is put into a simulated robot or its recording.
//!
//! An effect of the catalogue that has no line in the table is not hidden, and a run says so.

use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::World;

use crate::failure::Failure;
use crate::hiding_table::TABLE;
use crate::places::Places;
use crate::put::Number;
use crate::secret::Secret;

/// How an effect is hidden.
pub struct Hiding {
    /// Which.
    pub effect: EffectKind,
    /// What its magnitude counts. The torque is about proportional to it.
    pub counts: &'static str,
    /// Where a search for the right magnitude begins.
    pub start: f64,
    /// The most that a robot may have of it.
    pub most: f64,
    /// Whether it is hidden as a change since an earlier recording.
    pub is_change: bool,
    /// Joints on which it can show at all.
    pub places: fn(&dyn Model) -> Places,
    /// Puts it into a robot; gives what a person would call it by.
    pub put: Put,
    /// What a recording says wrongly about the motion because of it.
    pub distort: fn(&mut Trajectory, &Secret, f64),
}

/// Puts an effect of a magnitude into a robot whose nominal model is given.
pub type Put = fn(&mut World<'static>, &'static dyn Model, &Secret, f64) -> Result<Vec<Number>, Failure>;

/// The line of an effect.
pub fn of(effect: EffectKind) -> Option<&'static Hiding> {
    TABLE.iter().find(|hiding| hiding.effect == effect)
}

/// The robot as its YAML has it.
pub fn plain(model: &'static dyn Model) -> Result<World<'static>, Failure> {
    let nominal = model.robot().nominal.as_ref().ok_or("the robot has no nominal values")?;
    Ok(World::from_standard(model, &nominal.standard))
}

/// Hides an effect in a robot; returns what a person would call it by.
pub fn hide(
    world: &mut World<'static>,
    model: &'static dyn Model,
    secret: &Secret,
    magnitude: f64,
) -> Result<Vec<Number>, Failure> {
    let hiding =
        of(secret.effect).ok_or_else(|| format!("nobody knows how to hide {}", secret.effect.id()))?;
    (hiding.put)(world, model, secret, magnitude)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_of_the_catalogue_can_be_hidden() {
        for effect in EffectKind::ALL {
            assert!(of(effect).is_some(), "{} has no line in the table", effect.id());
        }
    }

    #[test]
    fn a_motor_droops_alike_in_every_motion() {
        let secret = Secret {
            effect: EffectKind::TorqueSaturation,
            joint: Some(0),
            chance: [0.0; 4],
            most_torque: 4.0,
            window: [0.0; 2],
        };
        let report = |torque: [f64; 2]| {
            let mut motion = Trajectory {
                name: String::new(),
                time: vec![0.0, 1.0],
                position: vec![vec![0.0; 2]],
                velocity: None,
                torque: vec![torque.to_vec()],
                fixed: Vec::new(),
            };
            let hiding = of(secret.effect).expect("it is in the table");
            (hiding.distort)(&mut motion, &secret, 0.2);
            motion.torque[0].clone()
        };
        let (gentle, hard) = (report([1.0, -2.0]), report([1.0, -4.0]));
        assert_eq!(gentle[0], hard[0]);
        assert!((hard[1] + 4.0 * 1.2).abs() < 1e-12);
        assert!((gentle[1] + 2.0 * 1.05).abs() < 1e-12);
    }
}
