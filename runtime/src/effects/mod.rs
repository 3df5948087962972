//! The catalogue of physics that the standard model leaves out.
//!
//! An effect is one file in `catalogue/` and one line in `catalogue.rs`. The file implements [`Effect`], which is
//! everything that is known of it apart from its torque, and one of the forms in which a torque is made ([`Form`]), so
//! that it is written once for identification, simulation and diagnosis. Laws of a single joint are a [`JointLaw`]:
//! evaluated sample by sample they are columns of an identification, evaluated inside an integrator they are a torque
//! of a simulation. Errors of the model's own numbers are a [`Sensitivity`]: their columns are exact derivatives of the
//! model. Compliant transmissions are a [`Compliance`]: their torque is the response of the link that is driven through
//! them. Bodies on links are a [`BodyOnLink`]. What no law describes is a [`FreeLaw`]: curves over any variables. A law that the user
//! wrote down is a [`UserLaw`], which its place holds.
//!
//! ```
//! use dynid_runtime::effects::EffectKind;
//!
//! let stribeck = EffectKind::from_id("stribeck").expect("the catalogue has it");
//! assert_eq!(stribeck.words().name, "Stribeck friction");
//! assert!(!stribeck.needs_baseline());
//! ```

mod axis;
mod catalogue;
mod check;
mod closed_form;
mod compliance;
mod contact;
mod coupled;
mod effect;
mod form;
mod free_law;
mod gear_load;
mod joint_law;
mod named_law;
mod place;
mod quantity;
mod rigid_body;
mod sensitivity;
mod shape;
mod spline;
mod term;
mod together;
mod user_law;
mod variable;

pub use axis::{Axis, Seen, Sum};
pub use catalogue::EffectKind;
pub use check::TermError;
pub use closed_form::ClosedForm;
#[cfg(feature = "diagnosis")]
pub(crate) use compliance::PLAY;
pub use compliance::{Compliance, LinkSide, Stretch, Transmission, deflection, stretch_at_start};
pub use contact::{ContactForce, JointTorque, unit_force_torques};
pub use coupled::CoupledRotor;
pub use effect::{Abscissa, Effect, Properties, SmoothingWindow, Sought, SpecialCase, ToldBy, Words};
pub use form::Form;
pub use free_law::FreeLaw;
pub use joint_law::{At, AtRest, HEARD_JOINT, JointLaw, Moved, Scale};
pub use place::Place;
pub use quantity::{Parameter, Quantities, unit_behind};
pub use rigid_body::{BODY_SYMBOLS, BodyEstimate, BodyOnLink, body_columns, body_detail};
pub use sensitivity::{
    Corrected, Direction, Distortion, Seeds, Sensitivity, Variant, corrected, corrected_at, derivable,
    derivative, numbers_at,
};
pub use shape::{Move, ShapeSearch, Step};
#[cfg(feature = "diagnosis")]
pub(crate) use term::named;
pub use term::{EffectTerm, TermScale, intervals_by_joint, times_faster};
pub use together::Together;
pub use user_law::{LawError, UserLaw};
#[cfg(feature = "diagnosis")]
pub(crate) use variable::STANDSTILL;
pub use variable::{SinceReversal, Variable};

#[cfg(test)]
mod catalogue_tests;
#[cfg(test)]
mod sensitivity_tests;
