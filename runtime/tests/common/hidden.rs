//! What a recording hides.

use dynid_runtime::effects::{EffectKind, EffectTerm, Place, TermScale};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::World;

/// Physics that is in the robot or in its recording, but not in the standard model.
pub struct Hidden {
    /// Puts it into the robot.
    pub put: Box<dyn Fn(&mut World<'_>)>,
    /// What the recording then says wrongly.
    pub distort: fn(&mut Trajectory),
}

impl Hidden {
    /// Nothing.
    pub fn nothing() -> Self {
        Self::in_robot(|_| ())
    }

    /// Something in the robot itself.
    pub fn in_robot(put: impl Fn(&mut World<'_>) + 'static) -> Self {
        Self { put: Box::new(put), distort: |_| () }
    }

    /// Something in the recording of a robot that is as its model.
    pub fn in_recording(distort: fn(&mut Trajectory)) -> Self {
        Self { distort, ..Self::nothing() }
    }

    /// An effect with its shape and amplitudes in SI, as its law defines them.
    pub fn effect(effect: EffectKind, place: Place, shape: &[f64], amplitude: &[f64]) -> Self {
        let term = term(effect, place, shape, amplitude);
        Self::in_robot(move |world| world.put(&term))
    }
}

/// An effect with its shape and amplitudes in SI, as its law defines them, as part of a model.
pub fn term(effect: EffectKind, place: Place, shape: &[f64], amplitude: &[f64]) -> EffectTerm {
    EffectTerm {
        effect,
        place,
        joints: Vec::new(),
        shape: shape.to_vec(),
        amplitude: amplitude.to_vec(),
        sigma: vec![0.0; amplitude.len()],
        scale: Some(TermScale::UNIT),
        wrenches: Vec::new(),
    }
}
