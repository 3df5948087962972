//! A robot's dynamics as linear forms in its parameters: the trait that generated and recursive models share.
//!
//! A [`Model`] computes the inverse dynamic regressor IDM(q, dq, ddq), with tau = IDM chi, the energy and power rows of
//! the power model, and the mass matrix. Generated code implements it for the robots of `robots/`; [`RecursiveModel`]
//! implements it for any table at run time.
//!
//! ```
//! use dynid_runtime::model::{Drive, Frame, JointKind, Limits, RecursiveModel, Robot, StateSlices, torques};
//!
//! // One axis along gravity.
//! let row = Frame::on_base(JointKind::Revolute);
//! let drive = Drive { gear: vec![1.0].into(), coupled_friction: vec![].into() };
//! let mut robot = Robot::with_standard_as_base("axis", [0.0, 0.0, -9.81], vec![row], drive, Limits::default());
//! // Of its parameters: inertia, viscous and Coulomb friction.
//! robot.base = robot.base.iter().filter(|p| ["ZZ1", "Fv1", "Fc1"].contains(&&*p.name)).cloned().collect();
//! let model = RecursiveModel::new(robot)?;
//!
//! // 2 kg.m2, 0.5 N.m.s/rad, 1 N.m; two samples of one joint.
//! let (q, dq, ddq) = (vec![vec![0.0, 0.1]], vec![vec![1.0, -2.0]], vec![vec![3.0, 4.0]]);
//! let tau = torques(&model, &[2.0, 0.5, 1.0], StateSlices::new(&q, &dq, &ddq).states());
//! assert_eq!(tau, [[7.5, 6.0]]);
//! # Ok::<(), dynid_runtime::model::RecursiveModelError>(())
//! ```

mod acceleration;
mod block;
pub(crate) mod cholesky;
mod dual;
mod dynamics;
mod energy;
mod lanes;
mod number;
mod recursive;
mod scalar;
mod sines;
mod states;
mod torques;

pub use acceleration::{ForwardDynamics, MassMatrixError};
pub use block::{
    InLines, LINE, Line, LineStates, array, array_mut, evaluate_block, evaluate_line, evaluate_lines,
};
pub use dual::Dual;
pub use dynamics::{Model, Operations, Pattern};
pub use dynid_description::{
    BaseParameter, Between, Coupling, CouplingLaw, DependentFrame, Drive, Ellipsoid, Frame, JointIndex,
    JointKind, JointNumber, Limits, Motion, Nominal, ParameterKind, Robot, StandardParameter,
    standard_parameters,
};
pub use energy::{energies, energy_at};
pub use lanes::{LANES, Lanes};
pub use number::Number;
pub use recursive::{
    Link, MAX_FRAMES, RecursiveModel, RecursiveModelError, Row, standard_energy, standard_idm, standard_power,
};
pub use states::{StateSlices, States};
pub use torques::{torques, torques_at};
