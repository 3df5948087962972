//! The columns of effects in the motions, by the form of each.

use crate::diagnosis::rows::additions::NumberError;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::free::free_columns;
use crate::diagnosis::rows::links::Links;
use crate::diagnosis::rows::series::Series;
use crate::diagnosis::rows::signals::ModelTorques;
use crate::diagnosis::rows::user::user_columns;
use crate::effects::{
    At, CoupledRotor, Direction, EffectKind, EffectTerm, Form, JointLaw, Moved, Place, Scale, Sensitivity,
    TermScale, Transmission, body_columns, derivable, derivative, numbers_at,
};
use std::borrow::Cow;

impl Context<'_> {
    /// The columns of an effect in one motion, one per amplitude; none where the effect cannot be at the place.
    pub fn series(&self, signal: usize, effect: EffectKind, place: Place, shape: &[f64]) -> Vec<Series> {
        let columns = match effect.form() {
            Form::Joint(law) if place == Place::Robot => Some(self.of_all_joints(signal, law, shape)),
            Form::Joint(law) => {
                place.joint().map(|j| self.of_joint(signal, law, ([j, j], &self.scales[j]), shape))
            }
            Form::Heard(law) => {
                place.hears().map(|[on, j]| self.of_joint(signal, law, ([on, j], &self.scales[j]), shape))
            }
            Form::Sensitivity(law) => {
                place.variant().map(|v| self.derivatives(signal, (effect, law), v, shape))
            }
            Form::Compliance(_) => place.joint().map(|j| vec![self.compliant(signal, j, shape)]),
            Form::Body(_) => place.link().map(|frame| self.body(signal, frame)),
            Form::Coupled => place.pair().map(|joints| self.coupled(signal, joints, shape)),
            Form::Free => place.joint().and_then(|j| free_columns(self, signal, j, shape)),
            Form::User => place.law().and_then(|law| user_columns(self, signal, law, shape)),
            Form::Window => None,
        };
        columns.unwrap_or_default()
    }

    /// The same of a law that is part of a model, with the scales that it was made with.
    pub fn series_of_term(&self, signal: usize, term: &EffectTerm) -> Vec<Series> {
        self.series_made_with(signal, (term.effect, term.place, &term.shape, term.scale))
    }

    /// The same of a law with a shape and the scales that it was made with, where they are not those of the motions.
    pub(super) fn series_made_with(
        &self,
        signal: usize,
        (effect, place, shape, scale): (EffectKind, Place, &[f64], Option<TermScale>),
    ) -> Vec<Series> {
        match (effect.form(), place, scale) {
            (Form::Joint(law), Place::Joint(j), Some(scale)) => {
                self.of_joint(signal, law, ([j, j], &scale.into()), shape)
            }
            (Form::Heard(law), place, Some(scale)) => place
                .hears()
                .map_or_else(Vec::new, |joints| self.of_joint(signal, law, (joints, &scale.into()), shape)),
            _ => self.series(signal, effect, place, shape),
        }
    }

    /// A law that all joints have together.
    fn of_all_joints(&self, signal: usize, law: &dyn JointLaw, shape: &[f64]) -> Vec<Series> {
        let mut columns: Vec<Series> = vec![Series::new(); law.amplitudes(shape)];
        for (j, scale) in self.scales.iter().enumerate() {
            for (all, own) in columns.iter_mut().zip(self.of_joint(signal, law, ([j, j], scale), shape)) {
                all.extend(own);
            }
        }
        columns
    }

    /// What gravity asks for in a motion, `[j][t]`.
    fn gravity(&self, signal: usize) -> &[Vec<f64>] {
        self.made.gravity[signal].get_or_init(|| {
            let (model, signals) = self.as_it_is(signal);
            ModelTorques::new(model, &self.chi_in(signal), &signals.at_rest()).link
        })
    }

    /// The law of joint `j` as a torque on joint `on`.
    fn of_joint(
        &self,
        signal: usize,
        law: &dyn JointLaw,
        ([on, j], scale): ([usize; 2], &Scale),
        shape: &[f64],
    ) -> Vec<Series> {
        let s = &self.signals[signal];
        let torques = self.torques(signal);
        let gravity = law.needs_gravity(shape).then(|| &self.gravity(signal)[j]);
        let drive = law.looks_at_torque().then(|| &self.drives(signal)[j]);
        let mut columns = vec![vec![0.0; s.len()]; law.amplitudes(shape)];
        let mut out = vec![0.0; columns.len()];
        let first = |series: &[f64]| series.first().copied().unwrap_or(0.0);
        let mut memory = law.memory_at_start(scale, first(&s.dq[j])) + self.off_at_start;
        let mut before = first(&s.q[j]);
        for t in 0..s.len() {
            let step = if t == 0 { 0.0 } else { 1.0 / s.rate };
            memory = law.advance(scale, shape, memory, Moved { travel: s.q[j][t] - before, step });
            before = s.q[j][t];
            let dq = s.dq[j][t];
            let at = At {
                time: s.time(t),
                q: s.q[j][t],
                dq,
                ddq: s.ddq[j][t],
                sign: if dq > 0.0 { 1.0 } else { -1.0 },
                load: torques.rigid[j][t],
                link: torques.link[j][t],
                gravity: gravity.map_or(0.0, |g| g[t]),
                torque: drive.map_or(0.0, |d| d[t]),
                friction: torques.friction[j][t],
            };
            law.law(scale, shape, &at, memory, &mut out);
            for (column, &value) in columns.iter_mut().zip(&out) {
                column[t] = value;
            }
        }
        columns.into_iter().map(|c| vec![(on, c)]).collect()
    }

    /// Derivatives with respect to the variant `v`, or to all together, on the way to the error `at` from the robot with the
    /// numbers that were found to be far off before it.
    fn derivatives(
        &self,
        signal: usize,
        (effect, law): (EffectKind, &dyn Sensitivity),
        v: usize,
        at: &[f64],
    ) -> Vec<Series> {
        let errors = &self.additions().errors;
        let own = errors.iter().position(|e| (e.effect, e.place) == (effect, Place::Variant(v)));
        let before = &errors[..own.unwrap_or(errors.len())];
        self.derivatives_from((signal, before), (law, v), at, at)
    }

    /// The columns of an error of the robot's numbers where these are far off: the derivatives of the robot with all of them.
    pub fn derivatives_there(
        &self,
        signal: usize,
        law: &dyn Sensitivity,
        v: usize,
        at: &[f64],
    ) -> Vec<Series> {
        self.derivatives_from((signal, &self.additions().errors), (law, v), &[], at)
    }

    /// Derivatives along a way that begins at the robot with these errors, beside what an error `at` uncovers.
    fn derivatives_from(
        &self,
        (signal, errors): (usize, &[NumberError]),
        (law, v): (&dyn Sensitivity, usize),
        way: &[f64],
        at: &[f64],
    ) -> Vec<Series> {
        let robot = self.model.robot();
        let from = self.robot_with(errors, signal).and_then(|there| {
            let engine = derivable(&there.robot).ok()?;
            Some((there, engine))
        });
        let (s, chi) = (&self.signals[signal], self.chi_in(signal));
        let (engine, gravity, q) = match &from {
            Some((there, engine)) => (engine, there.robot.gravity, Cow::Owned(there.real_positions(&s.q))),
            None => (&*self.engine, robot.gravity, Cow::Borrowed(&s.q)),
        };
        let wanted = numbers_at(law, robot, v);
        let mut columns: Vec<Series> = (0..wanted.len())
            .map(|which| {
                let mut out = vec![Vec::new(); s.q.len()];
                derivative(
                    engine,
                    gravity,
                    &chi,
                    &Direction { effect: law, variants: &wanted, which, at: way },
                    [&*q, &s.dq, &s.ddq, &s.jerk],
                    &mut out,
                );
                out.into_iter().enumerate().collect()
            })
            .collect();
        if !at.is_empty() {
            columns.extend(law.uncovered(robot, &s.q).into_iter().map(|column| vec![column]));
        }
        columns
    }

    fn coupled(&self, signal: usize, [a, b]: [usize; 2], shape: &[f64]) -> Vec<Series> {
        let s = &self.signals[signal];
        let Some(&ratio) = shape.first() else { return Vec::new() };
        let law = CoupledRotor { ratio };
        let mut columns = vec![[vec![0.0; s.len()], vec![0.0; s.len()]]; 3];
        for t in 0..s.len() {
            let values = law.columns([s.dq[a][t], s.dq[b][t]], [s.ddq[a][t], s.ddq[b][t]]);
            for (column, value) in columns.iter_mut().zip(values) {
                column[0][t] = value[0];
                column[1][t] = value[1];
            }
        }
        columns.into_iter().map(|[x, y]| vec![(a, x), (b, y)]).collect()
    }

    fn body(&self, signal: usize, frame: usize) -> Vec<Series> {
        let s = &self.signals[signal];
        let n = s.q.len();
        let mut full = vec![vec![vec![0.0; s.len()]; n]; 10];
        let mut at: [Vec<f64>; 10] = std::array::from_fn(|_| vec![0.0; n]);
        let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for t in 0..s.len() {
            for j in 0..n {
                (q[j], dq[j], ddq[j]) = (s.q[j][t], s.dq[j][t], s.ddq[j][t]);
            }
            body_columns(self.model.robot(), &self.tables, frame, [&q, &dq, &ddq], &mut at);
            for (column, values) in full.iter_mut().zip(&at) {
                for j in 0..n {
                    column[j][t] = values[j];
                }
            }
        }
        full.into_iter().map(|column| column.into_iter().enumerate().collect()).collect()
    }

    /// The transmission that a scale-free shape means on a joint in these motions.
    pub fn transmission(&self, j: usize, shape: &[f64]) -> Transmission {
        if let Some((_, known)) = self.transmissions.iter().find(|(k, _)| *k == j) {
            return *known;
        }
        let [least, median] = self.inertias(j);
        Transmission::from_shape(shape, least, median, self.scales[j].range, self.scales[j].kind)
    }

    /// Least and median inertia that a joint moves in these motions.
    pub(super) fn inertias(&self, j: usize) -> [f64; 2] {
        *self.made.inertias[j].get_or_init(|| self.inertia(j))
    }

    fn inertia(&self, j: usize) -> [f64; 2] {
        let mut inertia: Vec<f64> = (0..self.signals.len())
            .flat_map(|k| self.links(k).inertia(j).iter().step_by(7).copied().collect::<Vec<_>>())
            .collect();
        inertia.sort_by(f64::total_cmp);
        let least = inertia.first().copied().unwrap_or(1.0).max(1e-6);
        [least, inertia.get(inertia.len() / 2).copied().unwrap_or(1.0).max(least)]
    }

    fn compliant(&self, signal: usize, j: usize, shape: &[f64]) -> Series {
        let t = self.transmission(j, shape);
        let motion = (&self.signals[signal], self.torques(signal));
        self.links(signal).compliant((self.model, &self.chi_in(signal)), motion, j, &t)
    }

    /// How a joint with a transmission of this shape rings in a motion, from a stretch and from a rate at its start.
    pub fn ringing(&self, signal: usize, j: usize, shape: &[f64]) -> Vec<Series> {
        let t = self.transmission(j, shape);
        self.links(signal).ringing((self.model, &self.chi_in(signal)), &self.signals[signal], j, &t)
    }

    /// The torques on all joints that an acceleration of joint j asks for in a motion.
    pub fn inertial(&self, signal: usize, j: usize, acceleration: &[f64]) -> Series {
        self.links(signal).inertial(j, acceleration)
    }

    /// The torque on joint `on` for one unit of acceleration of joint `of`, in a motion.
    pub fn coupling(&self, signal: usize, on: usize, of: usize) -> &[f64] {
        self.links(signal).coupling(on, of)
    }

    fn links(&self, signal: usize) -> &Links {
        self.made.links[signal]
            .get_or_init(|| Links::new(self.model, &self.chi_in(signal), &self.signals[signal]))
    }
}
