//! Forward dynamics: the accelerations that joint torques give.

use super::cholesky;
use super::dynamics::Model;

/// The mass matrix of these parameters is not positive definite: no robot has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the mass matrix is not positive definite: no robot has these parameters")]
pub struct MassMatrixError;

/// Accelerations of one robot with known base parameters, by its closed-form M and torques.
///
/// Friction slips: dry friction at a joint that stands still is zero. What holds a joint at rest is decided by
/// [`crate::simulation`].
///
/// ```
/// use dynid_runtime::model::{Drive, ForwardDynamics, Frame, JointKind, Limits, RecursiveModel, Robot};
///
/// let row = Frame::on_base(JointKind::Revolute);
/// let drive = Drive { gear: vec![1.0].into(), coupled_friction: vec![].into() };
/// let mut robot = Robot::with_standard_as_base("axis", [0.0, 0.0, -9.81], vec![row], drive, Limits::default());
/// robot.base = robot.base.iter().filter(|p| ["ZZ1", "Fv1"].contains(&&*p.name)).cloned().collect();
/// let model = RecursiveModel::new(robot)?;
///
/// // 2 kg.m2, 0.5 N.m.s/rad: 3 N.m at 2 rad/s leave 2 N.m.
/// let mut forward = ForwardDynamics::new(&model, &[2.0, 0.5]);
/// let mut ddq = [0.0];
/// forward.acceleration(&[0.3], &[2.0], &[3.0], &mut ddq)?;
/// assert!((ddq[0] - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ForwardDynamics<'a> {
    model: &'a dyn Model,
    chi: Vec<f64>,
    mass: Vec<f64>,
    bias: Vec<f64>,
    still: Vec<f64>,
}

impl<'a> ForwardDynamics<'a> {
    /// For base parameters `chi` in the model's order.
    ///
    /// # Panics
    /// Where `chi` does not have the model's length: a bug of the caller.
    pub fn new(model: &'a dyn Model, chi: &[f64]) -> Self {
        let n = model.robot().joints();
        assert_eq!(chi.len(), model.robot().base.len(), "one value per base parameter");
        ForwardDynamics {
            model,
            chi: chi.to_vec(),
            mass: vec![0.0; n * n],
            bias: vec![0.0; n],
            still: vec![0.0; n],
        }
    }

    /// ddq with IDM(q, dq, ddq) chi = torque; N.m or N in, rad/s2 or m/s2 out. Allocates nothing.
    ///
    /// # Errors
    /// A mass matrix that is not positive definite; `ddq` is of no meaning then.
    ///
    /// # Panics
    /// Where slices do not have one value per joint: a bug of the caller.
    pub fn acceleration(
        &mut self,
        q: &[f64],
        dq: &[f64],
        torque: &[f64],
        ddq: &mut [f64],
    ) -> Result<(), MassMatrixError> {
        let n = self.bias.len();
        assert_eq!(torque.len(), n, "one torque per joint");
        self.model.mass_and_bias(&self.chi, q, dq, &mut self.mass, &mut self.bias);
        // N leaves friction and offsets out; the torques without acceleration have them.
        self.model.torque(&self.chi, q, dq, &self.still, &mut self.bias);
        if !cholesky::factor(n, &mut self.mass) {
            return Err(MassMatrixError);
        }
        for ((ddq, torque), bias) in ddq.iter_mut().zip(torque).zip(&self.bias) {
            *ddq = torque - bias;
        }
        cholesky::solve(n, &self.mass, ddq);
        Ok(())
    }
}
