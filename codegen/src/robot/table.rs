//! A robot as its YAML says.

use super::drive_table::DriveTable;
use super::expression::Expression;
use dynid_description::{
    Coupling, DependentFrame, Ellipsoid, Frame, JointKind, Limits, Motion, StandardParameter, motions,
};

/// A robot read from its YAML, checked: the modified-DH table in symbols, and what else the file says.
///
/// [`crate::numeric_robot`] evaluates it.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotTable {
    /// A Rust identifier in snake case.
    pub name: String,
    /// One line for a person.
    pub description: String,
    /// Gravity in frame 0, m/s2.
    pub gravity: [f64; 3],
    /// Named constants in the order of the file.
    pub constants: Vec<(String, f64)>,
    /// The rows: parents before children.
    pub frames: Vec<TableRow>,
    /// The frames that move with other variables than their own joint's alone, ascending.
    pub dependent: Vec<DependentFrame>,
    /// Motors and transmission.
    pub drive: DriveTable,
    /// Friction between links, then springs.
    pub couplings: Vec<Coupling>,
    /// Standard parameters, by index, that are known to be 0: they are no part of any base parameter.
    pub known: Vec<usize>,
    /// Standard parameters, by index, that are known to have another value: kept only where nothing else can take them.
    pub fixed: Vec<(usize, f64)>,
    /// Ellipsoids that hold the mass of links, by index of the frame, ascending.
    pub ellipsoids: Vec<(usize, Ellipsoid)>,
    /// Limits per joint.
    pub limits: Limits,
    /// Values for simulation.
    pub nominal: Option<NominalValues>,
}

/// One row of the table. Transformation from the parent: Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d)
/// Rot(z, theta) Trans(z, r).
#[derive(Debug, Clone, PartialEq)]
pub struct TableRow {
    /// Number of the frame, from 1, as in the YAML.
    pub j: usize,
    /// Number of the parent frame; 0 is the base.
    pub parent: usize,
    /// What the frame's own joint is; fixed where it has none, also where it moves with the variables of others.
    pub kind: JointKind,
    /// Branch angle, rad.
    pub gamma: Expression,
    /// Branch offset, m.
    pub b: Expression,
    /// Angle between the z axes about the parent's x, rad.
    pub alpha: Expression,
    /// Distance between the z axes along the parent's x, m.
    pub d: Expression,
    /// Constant part of theta, rad: the variables are added where it moves.
    pub theta: Expression,
    /// Constant part of r, m: the variables are added where it moves.
    pub r: Expression,
}

/// Values for simulation, as the YAML names them.
#[derive(Debug, Clone, PartialEq)]
pub struct NominalValues {
    /// Standard parameters by name (`ZZ1`, `Ia1`, `Fvm6`); a parameter that is not named is zero.
    pub standard: Vec<(String, f64)>,
    /// Proportional gains per joint; empty where not given. N.m/rad or N/m at the joint.
    pub kp: Vec<f64>,
    /// Derivative gains per joint.
    pub kd: Vec<f64>,
    /// Integral gains per joint.
    pub ki: Vec<f64>,
    /// Encoder noise at the joint, 1 sigma, rad or m.
    pub position_noise: Vec<f64>,
    /// Torque noise, 1 sigma, N.m or N.
    pub torque_noise: Vec<f64>,
}

impl RobotTable {
    /// A robot of which nothing but its frames, their drives and gravity, m/s2 in frame 0, is said.
    pub fn of_frames(name: &str, gravity: [f64; 3], frames: Vec<TableRow>, drive: DriveTable) -> Self {
        Self {
            name: name.to_owned(),
            description: String::new(),
            gravity,
            constants: Vec::new(),
            frames,
            dependent: Vec::new(),
            drive,
            couplings: Vec::new(),
            known: Vec::new(),
            fixed: Vec::new(),
            ellipsoids: Vec::new(),
            limits: Limits::default(),
            nominal: None,
        }
    }

    /// The frames that are joints, in order: index in `frames` of joint 0, 1, ...
    pub fn joint_frames(&self) -> Vec<usize> {
        (0..self.frames.len()).filter(|&k| self.frames[k].kind != JointKind::Fixed).collect()
    }

    /// How each frame moves on its parent.
    pub fn motions(&self) -> Vec<Motion> {
        motions(self.frames.iter().map(|f| f.kind), &self.dependent)
    }

    /// The standard parameters in the order of chi_st.
    pub fn standard_parameters(&self) -> Vec<StandardParameter> {
        standard_parameters(&self.frames, &self.drive, &self.couplings)
    }

    /// Whether a standard parameter is known beforehand, by index: it is regrouped after all others, or not at all.
    pub(crate) fn is_known(&self, standard: usize) -> bool {
        self.known.contains(&standard) || self.fixed.iter().any(|&(k, _)| k == standard)
    }
}

/// The standard parameters of these rows, this drive and these couplings in the order of chi_st.
pub(super) fn standard_parameters(
    rows: &[TableRow],
    drive: &DriveTable,
    couplings: &[Coupling],
) -> Vec<StandardParameter> {
    let frames: Vec<Frame> = rows.iter().map(TableRow::evaluated).collect();
    dynid_description::standard_parameters(&frames, &drive.coupled_friction, couplings)
}

impl TableRow {
    /// The row as numbers.
    pub fn evaluated(&self) -> Frame {
        Frame {
            parent: self.parent.checked_sub(1),
            kind: self.kind,
            gamma: self.gamma.value(),
            b: self.b.value(),
            alpha: self.alpha.value(),
            d: self.d.value(),
            theta: self.theta.value(),
            r: self.r.value(),
        }
    }
}
