//! A simulated robot on a recorded motion.

use crate::effects::{EffectTerm, times_faster};
use crate::model::Model;
use crate::signal::Motion;
use crate::simulation::closed_loop::{LoopSettings, simulate};
use crate::simulation::error::SimulationError;
use crate::simulation::less_friction::LessFriction;
use crate::simulation::reference::SampledReference;
use crate::simulation::sensors::SensorSettings;
use crate::simulation::world::World;

/// Control rate of the simulation at least, Hz; and with compliant joints, whose resonance a slower loop would excite.
const RATE: f64 = 1000.0;
const FAST_RATE: f64 = 4000.0;

/// How a simulated robot followed a motion.
pub(super) struct Followed {
    /// Torques at the samples of the motion as drives without noise record them, `[j][t]`.
    pub(super) torque: Vec<Vec<f64>>,
    /// How far each joint was from the motion at most, rad or m.
    pub(super) tracking_error: Vec<f64>,
}

/// Lets the robot with base parameters `chi` and `terms` follow a motion; the controller knows `known`. Where the times are
/// wrong, it is as much faster, sample for sample.
///
/// # Errors
/// Parameters that are no robot.
pub(super) fn follow(
    model: &dyn Model,
    motion: &Motion,
    known: &[f64],
    chi: &[f64],
    terms: &[EffectTerm],
) -> Result<Followed, SimulationError> {
    let factor = times_faster(terms);
    let faster = (factor != 1.0).then(|| motion.faster(factor));
    let motion = faster.as_ref().unwrap_or(motion);
    let reference = SampledReference {
        step: 1.0 / motion.rate,
        q: motion.q.clone(),
        dq: motion.dq.clone(),
        ddq: motion.ddq.clone(),
        fixed: motion.fixed.clone(),
    };
    let world = World::from_base(model, chi).with_friction_as_identified().with(terms);
    let rate = if world.has_elastic_joints() { FAST_RATE } else { RATE };
    let every = (rate / motion.rate).ceil().max(1.0);
    let mut known = known.to_vec();
    // What a drive feeds forward does not push.
    let _ = LessFriction::taken_from(model.robot(), &mut known);
    let mut settings = LoopSettings::nominal(model, &known, &reference, every * motion.rate, 0);
    settings.record_every = every as usize;
    settings.sensors = SensorSettings::default();
    // Where the recording is, the drives could do it.
    settings.controller.torque_limits = Vec::new();
    let mut plant = world.plant(&motion.name)?;
    let run = simulate(&mut plant, &reference, &settings, &mut |_| {})?;
    let samples = motion.q.first().map_or(0, Vec::len);
    let mut torque = run.recorded.torque;
    torque.iter_mut().for_each(|x| x.resize(samples, 0.0));
    Ok(Followed { torque, tracking_error: run.tracking_error })
}

/// Names of the effects that such a simulation does not have. Skews and rates are no part of the robot, and the comparison has
/// them.
pub(super) fn left_out(model: &dyn Model, chi: &[f64], terms: &[EffectTerm]) -> Vec<String> {
    let mut world = World::from_base(model, chi);
    terms.iter().filter(|term| term.distortion().is_none()).for_each(|term| world.put(term));
    world.left_out_ids().iter().map(|id| (*id).to_owned()).collect()
}
