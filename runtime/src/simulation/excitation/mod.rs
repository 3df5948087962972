//! Exciting motions: periodic and point-to-point, searched for what they tell about the parameters.

mod design;
mod evolution;
mod family;
mod fourier;
mod information;
mod limits;
mod motion;
mod point_to_point;
mod settings;
#[cfg(feature = "diagnosis")]
mod strokes;
#[cfg(feature = "diagnosis")]
mod tell;
#[cfg(test)]
mod tests;

pub use design::{ExcitationPlan, excite};
pub use fourier::{Bounds, FourierJoint, FourierMotion};
pub use information::{Criterion, Identification, Observer, condition, log_determinant};
pub use limits::peak_torque_share;
pub use motion::ExcitingMotion;
pub use point_to_point::{PointToPointMotion, Profile};
pub use settings::{ExcitationSettings, MotionKind};
#[cfg(feature = "diagnosis")]
pub use tell::{TellError, TellPlan, TellSettings, Told, tell, typical_law};
