//! From motions to parameters: observation rows, orthogonal factors, estimators, statistics.
//!
//! [`observe::observe`] evaluates a model along motions and reduces its decimated equations to orthogonal factors;
//! [`estimate()`] solves them, with standard deviations, warnings and the essential parameters. All from arrays in
//! memory:
//!
//! ```
//! use dynid_runtime::estimation::observe::{Equations, ObserveSettings, observe};
//! use dynid_runtime::estimation::{EstimateSettings, estimate};
//! use dynid_runtime::recording::Trajectory;
//! use dynid_runtime::signal::{Preparation, prepare};
//! # use dynid_runtime::model::{Drive, Frame, JointKind, Limits, RecursiveModel, Robot};
//! # let row = Frame::on_base(JointKind::Revolute);
//! # let drive = Drive { gear: vec![1.0].into(), coupled_friction: vec![].into() };
//! # let mut robot = Robot::with_standard_as_base("axis", [0.0, 0.0, -9.81], vec![row], drive, Limits::default());
//! # robot.base = robot.base.iter().filter(|p| ["ZZ1", "Fv1", "Fc1"].contains(&&*p.name)).cloned().collect();
//! # let model = RecursiveModel::new(robot)?;
//!
//! // Twenty seconds at 200 Hz of one axis with an inertia of 2, viscous friction 0.7 and Coulomb friction 1.5.
//! let time: Vec<f64> = (0..4000).map(|k| k as f64 / 200.0).collect();
//! let position = time.iter().map(|t| (2.0 * t).sin() + 0.3 * (5.1 * t).sin()).collect();
//! let torque = time.iter().map(|t| {
//!     let speed: f64 = 2.0 * (2.0 * t).cos() + 1.53 * (5.1 * t).cos();
//!     let acceleration = -4.0 * (2.0 * t).sin() - 7.803 * (5.1 * t).sin();
//!     2.0 * acceleration + 0.7 * speed + 1.5 * speed.signum()
//! }).collect();
//! let trajectory = Trajectory {
//!     name: "run".into(), time, position: vec![position], velocity: None, torque: vec![torque], fixed: vec![],
//! };
//!
//! let motion = prepare(&trajectory, &Preparation::default())?;
//! let settings = ObserveSettings { band: 10.0, ..ObserveSettings::default() };
//! let observation = observe(&model, &[motion], Equations::Torque, None, &settings, None)?;
//! let found = estimate(&observation, &EstimateSettings::default());
//! for (value, expected) in found.chi().iter().zip([2.0, 0.7, 1.5]) {
//!     assert!((value - expected).abs() < 0.01 * expected);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod attenuation;
mod bandwidth;
mod blocks;
mod cautions;
mod deviations;
mod drive_gains;
mod encoder_noise;
mod essential;
mod estimate;
mod factor;
mod householder;
mod instrumental;
mod memory;
mod method;
pub mod observe;
mod outcome;
mod payload;
mod physical;
mod piecewise;
mod recorded;
#[cfg(feature = "diagnosis")]
mod reduced;
mod residuals;
mod robust;
mod settings;
mod solve;
mod total;
mod uncertainty;
mod warning;
mod weights;

pub use bandwidth::{Bandwidth, choose_bandwidth};
pub use drive_gains::{DriveGain, DriveGains, DriveGainsError, drive_gains};
pub use encoder_noise::EncoderNoise;
pub use estimate::estimate;
pub use factor::{BLOCK_ROWS, Factor};
pub use instrumental::{InstrumentalError, InstrumentalEstimate, Instruments, instrumental_variables};
pub use method::{Method, Solver};
pub use outcome::{BlockWeight, EquationError, Essential, Estimate, ParameterEstimate};
pub use payload::{
    KnownPayload, KnownPayloadError, PayloadBody, PayloadError, PayloadFit, Quantity, ReferenceModel,
    payload_of,
};
pub use physical::{
    Constraint, EllipsoidBound, NearPrior, NearPriorError, NearestBody, PhysicalFit, Prior, Released,
    ellipsoid_margin, near_prior, nearest_body, physical_fit, released, uniform_body,
};
pub use piecewise::Piecewise;
pub use recorded::{
    ObserveRecordingError, ObservedRecording, PIECE, RecordedSettings, Take, observe_in_pieces,
    observe_recording, observe_trajectories,
};
#[cfg(feature = "diagnosis")]
pub use reduced::{Reduced, ReducedError, ReducedEstimate};
pub use residuals::{per_equation, relative_error};
pub use settings::EstimateSettings;
#[cfg(feature = "diagnosis")]
pub(crate) use solve::ROUNDING;
pub use solve::{RANK_TOLERANCE, Solution};
pub use warning::Warning;
pub(crate) use weights::residual_norm;
