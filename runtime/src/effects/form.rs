//! The ways in which the torque of an effect is made, and what follows from them.

use super::compliance::{self, Compliance};
use super::coupled::CoupledRotor;
use super::free_law::FreeLaw;
use super::joint_law::{JointLaw, Scale};
use super::place::Place;
use super::rigid_body::BodyOnLink;
use super::sensitivity::Sensitivity;
use super::shape::ShapeSearch;
use super::user_law::UserLaw;
use crate::model::Robot;

/// How an effect's torque is made.
#[derive(Clone, Copy)]
pub enum Form {
    /// A law of one joint.
    Joint(&'static dyn JointLaw),
    /// A law of one joint that its neighbour feels.
    Heard(&'static dyn JointLaw),
    /// A derivative of the model with respect to one of its own numbers.
    Sensitivity(&'static dyn Sensitivity),
    /// A compliant or loose transmission.
    Compliance(&'static dyn Compliance),
    /// A rigid body added to a link.
    Body(&'static dyn BodyOnLink),
    /// A motor driven by two joints.
    Coupled,
    /// An outside force in time windows.
    Window,
    /// Curves of a joint's torque over any variables.
    Free,
    /// A law that the user wrote down.
    User,
}

impl Form {
    /// How the torque is made, in one sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Joint(_) => "a torque on the joint, from its own motion and load",
            Self::Heard(_) => "a torque on the joint, from that of another one",
            Self::Sensitivity(_) => {
                "what the torques of the model change by when one of its numbers, or of the recording's, is another one"
            }
            Self::Compliance(_) => {
                "what a link that lags behind its motor takes less or more than a rigid one"
            }
            Self::Body(_) => "the torques of inertia and gravity of a rigid body on the link",
            Self::Coupled => "a torque on both joints that turn the motor",
            Self::Window => "an outside force on a link, in windows of time",
            Self::Free => "curves over one or two variables, as splines",
            Self::User => "a torque on the joint, from the user's formula",
        }
    }

    /// Everywhere in a robot that such an effect can be.
    pub fn places(self, robot: &Robot) -> Vec<Place> {
        let n = robot.joints();
        match self {
            Self::Joint(law) => {
                let common = (law.may_be_common() && n > 1).then_some(Place::Robot);
                (0..n).map(Place::Joint).chain(common).collect()
            }
            Self::Heard(_) => (1..n).flat_map(|j| [Place::Hears(j, j - 1), Place::Hears(j - 1, j)]).collect(),
            Self::Compliance(_) => (0..n).map(Place::Joint).collect(),
            Self::Sensitivity(law) => {
                let count = if law.together() { 1 } else { law.variants(robot).len() };
                (0..count).map(Place::Variant).collect()
            }
            Self::Body(law) => law.links(robot).into_iter().map(Place::Link).collect(),
            Self::Coupled => CoupledRotor::places(robot),
            Self::Window | Self::Free | Self::User => Vec::new(),
        }
    }

    /// Shapes to try at a place; `scales` are those of the joints.
    pub fn shapes(self, place: Place, scales: &[Scale]) -> Vec<Vec<f64>> {
        match self {
            Self::Joint(law) | Self::Heard(law) => {
                place.law_of().and_then(|j| scales.get(j)).map_or_else(Vec::new, |scale| law.shapes(scale))
            }
            Self::Compliance(law) => law.shapes().iter().map(|s| s.to_vec()).collect(),
            Self::Coupled => CoupledRotor::RATIOS.iter().map(|&ratio| vec![ratio]).collect(),
            Self::Sensitivity(_) | Self::Body(_) => vec![Vec::new()],
            Self::User => place.law().map_or_else(Vec::new, UserLaw::grid),
            Self::Window | Self::Free => Vec::new(),
        }
    }

    /// Shapes that a model may have at a place: beside those to try, those that a search makes of them.
    pub fn all_shapes(self, place: Place, scales: &[Scale]) -> Vec<Vec<f64>> {
        match (self, place.law_of().and_then(|j| scales.get(j))) {
            (Self::Joint(law) | Self::Heard(law), Some(scale)) => law.all_shapes(scale),
            (form, _) => form.shapes(place, scales),
        }
    }

    /// Shapes to try besides where the residual of a joint has waves of these orders.
    pub fn shapes_of_orders(self, orders: &[f64]) -> Vec<Vec<f64>> {
        match self {
            Self::Joint(law) => law.shapes_of_orders(orders),
            Self::Heard(_)
            | Self::Sensitivity(_)
            | Self::Compliance(_)
            | Self::Body(_)
            | Self::Coupled
            | Self::Window
            | Self::Free
            | Self::User => Vec::new(),
        }
    }

    /// As [`Self::shape_search`], of a shape within the grid of its own form of the law.
    pub fn shape_search_of(
        self,
        place: Place,
        scales: &[Scale],
        grid: &[&[f64]],
        shape: &[f64],
    ) -> ShapeSearch {
        let all = self.shape_search(place, scales, grid);
        let of_form: Vec<&[f64]> =
            grid.iter().copied().filter(|other| all.is_same_form(other, shape)).collect();
        self.shape_search(place, scales, &of_form)
    }

    /// How shapes between those of a grid are searched at a place.
    pub fn shape_search(self, place: Place, scales: &[Scale], grid: &[&[f64]]) -> ShapeSearch {
        match self {
            Self::Joint(law) | Self::Heard(law) => match place.law_of().and_then(|j| scales.get(j)) {
                Some(scale) => ShapeSearch::within_a_step_of(grid, law.steps(scale)),
                None => ShapeSearch::none(),
            },
            Self::Compliance(_) => compliance::shape_search(),
            Self::Coupled => CoupledRotor::shape_search(),
            Self::User => place.law().map_or_else(ShapeSearch::none, UserLaw::shape_search),
            Self::Sensitivity(_) | Self::Body(_) | Self::Window | Self::Free => ShapeSearch::none(),
        }
    }

    /// Whether a law of a shape, in a robot of so many joints, looks at the torque of a drive: it follows what the other laws
    /// of that drive are.
    pub fn looks_at_torque(self, shape: &[f64], joints: usize) -> bool {
        match self {
            Self::Joint(law) | Self::Heard(law) => law.looks_at_torque(),
            Self::Free => FreeLaw::from_shape(shape, joints).is_some_and(|law| law.looks_at_torque()),
            Self::Sensitivity(_)
            | Self::Compliance(_)
            | Self::Body(_)
            | Self::Coupled
            | Self::Window
            | Self::User => false,
        }
    }

    /// Whether it has an inner state, which a recording does not tell where a motion begins.
    pub fn has_memory(self) -> bool {
        self.joint_law().is_some_and(JointLaw::has_memory)
    }

    /// The law of one joint, felt by itself or heard by its neighbour.
    fn joint_law(self) -> Option<&'static dyn JointLaw> {
        match self {
            Self::Joint(law) | Self::Heard(law) => Some(law),
            Self::Sensitivity(_)
            | Self::Compliance(_)
            | Self::Body(_)
            | Self::Coupled
            | Self::Window
            | Self::Free
            | Self::User => None,
        }
    }

    /// What is wrong with the model's own numbers or with the recording's.
    pub fn sensitivity(self) -> Option<&'static dyn Sensitivity> {
        match self {
            Self::Sensitivity(law) => Some(law),
            Self::Joint(_)
            | Self::Heard(_)
            | Self::Compliance(_)
            | Self::Body(_)
            | Self::Coupled
            | Self::Window
            | Self::Free
            | Self::User => None,
        }
    }

    /// The amplitude, where the law leaves none free.
    pub fn fixed_amplitude(self) -> Option<f64> {
        match self {
            Self::Compliance(_) => Some(1.0),
            Self::Joint(_)
            | Self::Heard(_)
            | Self::Sensitivity(_)
            | Self::Body(_)
            | Self::Coupled
            | Self::Window
            | Self::Free
            | Self::User => None,
        }
    }

    /// Whether a negative amplitude is something else.
    pub fn only_positive(self) -> bool {
        self.joint_law().is_some_and(JointLaw::only_positive)
    }

    /// Whether its shape is its amplitude once more: an error that is not small bends its own column, so that the
    /// derivative is taken along the way to it.
    pub fn shape_is_amplitude(self) -> bool {
        self.sensitivity().is_some()
    }

    /// Whether it is a curve of many numbers, of which a motion may determine few.
    pub fn is_curve(self) -> bool {
        matches!(self, Self::Free)
    }

    /// Whether it says nothing of values of its variables that no motion has passed.
    pub fn holds_only_where_seen(self) -> bool {
        match self {
            Self::Joint(law) | Self::Heard(law) => law.holds_only_where_seen(),
            Self::Free => true,
            Self::Sensitivity(_)
            | Self::Compliance(_)
            | Self::Body(_)
            | Self::Coupled
            | Self::Window
            | Self::User => false,
        }
    }

    /// Whether it rings or bursts faster than any motion, so that only rows that hold such frequencies show it.
    pub fn is_fast_only(self) -> bool {
        match self {
            Self::Compliance(_) => true,
            Self::Joint(_)
            | Self::Heard(_)
            | Self::Sensitivity(_)
            | Self::Body(_)
            | Self::Coupled
            | Self::Window
            | Self::Free
            | Self::User => false,
        }
    }

    /// Joints (0-based) that such an effect at a place is named on; empty for the whole robot.
    pub fn named_joints(self, robot: &Robot, place: Place) -> Vec<usize> {
        match self {
            Self::Joint(_) | Self::Compliance(_) | Self::Free | Self::Window => {
                place.joint().into_iter().collect()
            }
            Self::Heard(_) => place.hears().map(|[own, _]| own).into_iter().collect(),
            Self::Coupled => place.pair().into_iter().flatten().collect(),
            Self::Sensitivity(law) if law.together() => Vec::new(),
            Self::Sensitivity(law) => {
                let variants = law.variants(robot);
                let variant = place.variant().and_then(|v| variants.get(v));
                variant.and_then(|x| x.joint).into_iter().collect()
            }
            Self::Body(law) => {
                place.link().and_then(|frame| law.named_joint(robot, frame)).into_iter().collect()
            }
            Self::User => place.law().map(UserLaw::joint).into_iter().collect(),
        }
    }
}
