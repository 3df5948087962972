//! What a robot has beyond its base parameters and other laws feel: bodies that its joints carry, and torques of its drives.

use crate::diagnosis::rules::LARGE_ERROR;
use crate::effects::{Corrected, EffectKind, EffectTerm, Form, Place, TermScale, corrected_at, numbers_at};
use crate::model::Robot;

/// Bodies and laws that are known of a robot beside its parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub(in crate::diagnosis) struct Additions {
    /// Laws that follow the load feel them.
    pub bodies: Vec<Carried>,
    /// Laws that follow the torque of a drive, or hear it, feel them.
    pub laws: Vec<DriveLaw>,
    /// Numbers of the robot that are far off, in the order in which they were found: the torque of each is what it changes of
    /// the robot with those before it.
    pub errors: Vec<NumberError>,
}

impl Additions {
    /// Those among the terms of a model, which the robot had in the baseline too.
    pub fn among<'t>(robot: &Robot, terms: impl IntoIterator<Item = &'t EffectTerm>) -> Self {
        let mut out = Self::default();
        for term in terms {
            let law = (term.effect, term.place);
            out.add(robot, law, (&term.shape, term.scale), &term.amplitude, true);
        }
        out
    }

    /// Adds a law with its shape, the scales that it was made with where they are not those of the motions, and its
    /// amplitudes; one that nothing else feels adds nothing.
    pub fn add(
        &mut self,
        robot: &Robot,
        (effect, place): (EffectKind, Place),
        (shape, scale): (&[f64], Option<TermScale>),
        amplitude: &[f64],
        in_baseline: bool,
    ) {
        match effect.form() {
            Form::Body(_) => {
                let chi = place.link().and_then(|link| robot.base_of_body(link, amplitude));
                self.bodies.extend(chi.map(|chi| Carried { chi, in_baseline }));
            }
            form @ (Form::Joint(_) | Form::Free | Form::User | Form::Coupled)
                if !form.looks_at_torque(shape, robot.joints()) =>
            {
                let (shape, amplitude) = (shape.to_vec(), amplitude.to_vec());
                self.laws.push(DriveLaw { effect, place, shape, scale, amplitude, in_baseline });
            }
            Form::Sensitivity(_) => {
                self.errors.extend(NumberError::of_robot(robot, (effect, place), shape, in_baseline));
            }
            // What is heard is no torque of the drive that it is heard on; a transmission rings faster than what is heard.
            Form::Joint(_)
            | Form::Heard(_)
            | Form::Compliance(_)
            | Form::Coupled
            | Form::Window
            | Form::Free
            | Form::User => {}
        }
    }
}

/// A body on the robot. It is not among the parameters `chi`, but the joints carry it.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Carried {
    /// What it adds to each base parameter.
    pub chi: Vec<f64>,
    /// Whether the robot carried it in the baseline too.
    pub in_baseline: bool,
}

/// A torque of a drive that the standard model has not.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct DriveLaw {
    pub effect: EffectKind,
    pub place: Place,
    pub shape: Vec<f64>,
    /// Scales it was made with, where they are not those of the motions.
    pub scale: Option<TermScale>,
    /// Amplitude of each column.
    pub amplitude: Vec<f64>,
    /// Whether the robot had it in the baseline too.
    pub in_baseline: bool,
}

/// Numbers of the robot that are far off.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct NumberError {
    pub effect: EffectKind,
    pub place: Place,
    /// How far each number of the effect is off, in its unit.
    pub errors: Vec<f64>,
    /// Whether it was so in the baseline too.
    pub in_baseline: bool,
}

impl NumberError {
    /// Of a law with this shape; `None` where it is none of the robot's numbers, or a small one.
    pub fn of_robot(
        robot: &Robot,
        (effect, place): (EffectKind, Place),
        shape: &[f64],
        in_baseline: bool,
    ) -> Option<Self> {
        let law = effect.form().sensitivity().filter(|law| law.in_recording(shape).is_none())?;
        let numbers = numbers_at(law, robot, place.variant()?).len();
        let errors = shape.get(..numbers).unwrap_or(shape).to_vec();
        Some(Self { effect, place, errors, in_baseline }).filter(Self::is_large)
    }

    /// Whether any of the numbers is so far off that the derivatives where it is are others.
    pub fn is_large(&self) -> bool {
        self.errors.iter().any(|e| e.abs() >= LARGE_ERROR)
    }

    /// The robot with these numbers as they are, one after the other; `None` where none of them is the robot's.
    pub fn put_in<'e>(robot: &Robot, errors: impl Iterator<Item = &'e Self>) -> Option<Corrected> {
        let of_robot = |e: &'e Self| Some((e.effect.form().sensitivity()?, e.place.variant()?, &e.errors));
        errors.filter_map(of_robot).fold(None, |before: Option<Corrected>, (law, v, errors)| match before {
            Some(before) => before.then(law, v, errors).or(Some(before)),
            None => corrected_at(robot, law, v, errors),
        })
    }
}
