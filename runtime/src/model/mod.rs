//! A robot's dynamics as linear forms in its parameters: the trait that generated and recursive models share.

mod block;
mod dual;
mod dynamics;
mod lanes;
mod number;
mod recursive;
mod scalar;
mod states;
mod torques;

pub use block::{
    InLines, LINE, Line, LineStates, array, array_mut, evaluate_block, evaluate_line, evaluate_lines,
};
pub use dual::Dual;
pub use dynamics::{Model, Operations, Pattern};
pub use dynid_description::{
    BaseParameter, Drive, Frame, JointIndex, JointKind, JointNumber, Limits, Nominal, ParameterKind, Robot,
    StandardParameter, standard_parameters,
};
pub use lanes::{LANES, Lanes};
pub use number::Number;
pub use recursive::{
    Link, MAX_FRAMES, RecursiveModel, RecursiveModelError, Row, standard_energy, standard_idm, standard_power,
};
pub use states::{StateSlices, States};
pub use torques::{torques, torques_at};
