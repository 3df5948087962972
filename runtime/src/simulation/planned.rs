//! Recorded motions beside the plan that they were made from, for estimators that simulate it.

use super::closed_loop::LoopSettings;
use super::didim::Experiment;
use super::reference::Reference;
use crate::model::Model;
use crate::recording::Trajectory;
use crate::signal::Motion;

/// Why a plan cannot be that of a recording.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Another number of motions.
    #[error(
        "the recording has {recorded} motions and the plan has {planned}: there must be one planned motion for each, in \
         the same order (a gap in the recording makes two motions of one; `from` and `to` choose a part)"
    )]
    Count {
        /// Motions of the recording.
        recorded: usize,
        /// Motions of the plan.
        planned: usize,
    },
    /// A motion of another robot.
    #[error("planned motion {motion} has {found} joints, and the robot has {expected}")]
    Joints {
        /// Which, from 1.
        motion: usize,
        /// Joints of the robot.
        expected: usize,
        /// Joints of the planned motion.
        found: usize,
    },
    /// Recorded when nothing was planned.
    #[error(
        "{name} was recorded from {from:.3} s to {to:.3} s, and its planned motion lasts from 0 to {lasts:.3} s: the plan \
         must begin at time 0 of the recording and last as long"
    )]
    Outside {
        /// The recorded motion.
        name: String,
        /// Its first instant, s.
        from: f64,
        /// Its last.
        to: f64,
        /// Length of the plan, s.
        lasts: f64,
    },
}

/// Motions of a recording, each with the stretch of the plan that it follows and the robot's nominal controller.
pub struct Planned<'a> {
    stretches: Vec<Stretch<'a>>,
    settings: Vec<LoopSettings>,
    recorded: Vec<Trajectory>,
}

impl<'a> Planned<'a> {
    /// `plan` has one motion for each of `motions`, whose time 0 is its beginning. The controller is the nominal one of
    /// the robot with base parameters `chi` ([`LoopSettings::nominal`]); it runs at the lowest multiple of the
    /// recording's rate that is not below `control`, Hz.
    ///
    /// # Errors
    /// A plan of other motions than these.
    pub fn new(
        model: &dyn Model,
        chi: &[f64],
        plan: &[&'a dyn Reference],
        motions: &[Motion],
        control: f64,
    ) -> Result<Self, PlanError> {
        if plan.len() != motions.len() {
            return Err(PlanError::Count { recorded: motions.len(), planned: plan.len() });
        }
        let mut planned = Planned { stretches: Vec::new(), settings: Vec::new(), recorded: Vec::new() };
        for (k, (&of, motion)) in plan.iter().zip(motions).enumerate() {
            let (expected, found) = (model.robot().joints(), of.joints());
            if expected != found {
                return Err(PlanError::Joints { motion: k + 1, expected, found });
            }
            let stretch = Stretch::of(of, motion)?;
            let every = (control / motion.rate).ceil().max(1.0);
            let mut settings = LoopSettings::nominal(model, chi, &stretch, every * motion.rate, 0);
            settings.record_every = every as usize;
            settings.name.clone_from(&motion.name);
            planned.settings.push(settings);
            planned.recorded.push(measured(motion));
            planned.stretches.push(stretch);
        }
        Ok(planned)
    }

    /// The motions as experiments.
    pub fn experiments(&self) -> Vec<Experiment<'_>> {
        let all = self.stretches.iter().zip(&self.settings).zip(&self.recorded);
        all.map(|((reference, settings), recorded)| Experiment { reference, settings, recorded }).collect()
    }
}

/// What was measured of a motion, on its own grid.
fn measured(motion: &Motion) -> Trajectory {
    let samples = motion.q.first().map_or(0, Vec::len);
    Trajectory {
        name: motion.name.clone(),
        time: (0..samples).map(|k| motion.start + k as f64 / motion.rate).collect(),
        position: motion.q.clone(),
        velocity: None,
        torque: motion.torque.clone(),
        fixed: motion.fixed.clone(),
    }
}

/// How far each joint is from where it was simulated to be: the root mean square of the difference of its positions over
/// that of the measured ones about their mean, over all motions; 0 for a joint that does not move.
pub fn apart(simulated: &[Motion], measured: &[Motion]) -> Vec<f64> {
    let joints = measured.first().map_or(0, |m| m.q.len());
    let of = |joint: usize| {
        let (mut difference, mut size) = (0.0, 0.0);
        for (a, b) in simulated.iter().zip(measured) {
            let (Some(a), Some(b)) = (a.q.get(joint), b.q.get(joint)) else { continue };
            let mean = b.iter().sum::<f64>() / b.len().max(1) as f64;
            difference += a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            size += b.iter().map(|b| (b - mean).powi(2)).sum::<f64>();
        }
        if size > 0.0 { (difference / size).sqrt() } else { 0.0 }
    };
    (0..joints).map(of).collect()
}

/// A part of a planned motion.
struct Stretch<'a> {
    of: &'a dyn Reference,
    /// Where it begins in the motion, s.
    from: f64,
    duration: f64,
}

impl<'a> Stretch<'a> {
    /// The part that `motion` was recorded in; a sample of it may lie outside at each end.
    fn of(of: &'a dyn Reference, motion: &Motion) -> Result<Self, PlanError> {
        let samples = motion.q.first().map_or(0, Vec::len);
        let (step, lasts) = (1.0 / motion.rate, of.duration());
        let (from, duration) = (motion.start, samples.saturating_sub(1) as f64 * step);
        let to = from + duration;
        if from < -1.5 * step || to > lasts + 1.5 * step {
            return Err(PlanError::Outside { name: motion.name.clone(), from, to, lasts });
        }
        Ok(Stretch { of, from, duration })
    }
}

impl Reference for Stretch<'_> {
    fn joints(&self) -> usize {
        self.of.joints()
    }

    fn duration(&self) -> f64 {
        self.duration
    }

    fn at(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        self.of.at((self.from + t).clamp(0.0, self.of.duration()), q, dq, ddq);
    }

    fn fixed(&self) -> Vec<usize> {
        self.of.fixed()
    }
}

#[cfg(test)]
mod tests {
    use super::super::didim::simulated_motions;
    use super::super::reference::SampledReference;
    use super::super::testing::pendulum;
    use super::*;

    /// Two seconds of a swing, planned every 10 ms.
    fn plan() -> SampledReference {
        let wave = |order: i32| -> Vec<f64> {
            let phase = f64::from(order) * std::f64::consts::FRAC_PI_2;
            (0..=200).map(|k| 3f64.powi(order) * (0.03 * f64::from(k) + phase).sin()).collect()
        };
        SampledReference {
            step: 0.01,
            q: vec![wave(0)],
            dq: vec![wave(1)],
            ddq: vec![wave(2)],
            fixed: vec![],
        }
    }

    /// What was recorded of it at 200 Hz between two times.
    fn motion(from: f64, to: f64) -> Motion {
        let samples = ((to - from) * 200.0).round() as usize + 1;
        let q = (0..samples).map(|k| (3.0 * (from + k as f64 / 200.0)).sin()).collect();
        Motion {
            name: "swing".into(),
            rate: 200.0,
            start: from,
            q: vec![q],
            dq: vec![vec![0.0; samples]],
            ddq: vec![vec![0.0; samples]],
            torque: vec![vec![1.0; samples]],
            fixed: vec![],
            edge_samples: 0,
        }
    }

    #[test]
    fn a_part_of_a_recording_is_simulated_along_its_part_of_the_plan() {
        let (model, chi) = pendulum(0.2, 1.0, 0.1, 0.3);
        let (plan, recorded) = (plan(), [motion(0.5, 1.75)]);
        let planned = Planned::new(&model, &chi, &[&plan], &recorded, 2000.0).expect("a plan of this motion");
        let simulated = simulated_motions(&model, &planned.experiments(), &chi).expect("a robot");
        assert_eq!(simulated[0].q[0].len(), recorded[0].q[0].len());
        assert!(apart(&simulated, &recorded)[0] < 0.02, "{:?}", apart(&simulated, &recorded));
        assert_eq!(simulated[0].torque, recorded[0].torque);
        let late = [motion(0.4, 1.65)];
        assert!(apart(&simulated, &late)[0] > 0.2);
    }

    #[test]
    fn a_plan_of_something_else_is_refused() {
        let (model, chi) = pendulum(0.2, 1.0, 0.1, 0.3);
        let plan = plan();
        let refused = |plan: &[&dyn Reference], motions: &[Motion]| {
            Planned::new(&model, &chi, plan, motions, 1000.0).err().expect("refused")
        };
        let two = [motion(0.0, 1.0), motion(0.0, 1.0)];
        assert_eq!(refused(&[&plan], &two), PlanError::Count { recorded: 2, planned: 1 });
        assert!(matches!(refused(&[&plan], &[motion(1.0, 2.5)]), PlanError::Outside { .. }));
        assert!(matches!(refused(&[&plan], &[motion(100.0, 101.0)]), PlanError::Outside { .. }));
        let other = SampledReference { q: vec![], dq: vec![], ddq: vec![], ..plan };
        assert!(matches!(refused(&[&other], &two[..1]), PlanError::Joints { found: 0, .. }));
    }
}
