//! The functions of a robot, whatever language they are written in.

use super::function::{Output, Part, Signature, parts};
use super::program::InputNames;
use crate::base::BaseSet;
use crate::mechanics::Equations;
use crate::robot::RobotTable;
use crate::symbolic::{Expr, Graph};
use dynid_description::ParameterKind;

/// Statements that one Rust function may hold; rustc overflows its stack on a few thousand.
pub const MOST_STATEMENTS: usize = 900;

const ENERGY: Signature<'static> = Signature {
    name: "energy",
    doc: "Energy row h(q, dq): NB values, J per unit parameter.",
    arguments: &[("q", "N"), ("dq", "N")],
    foreign: &["dw", "a", "b", "u", "j", "ms", "f", "m"],
    results: &[("h", None)],
};

const POWER: Signature<'static> = Signature {
    name: "power",
    doc: "Power row dh(q, dq, ddq): NB values, W per unit parameter.",
    arguments: &[("q", "N"), ("dq", "N"), ("ddq", "N")],
    foreign: &["u", "j", "ms", "f", "m"],
    results: &[("dh", None)],
};

const IDM: Signature<'static> = Signature {
    name: "idm",
    doc: "The ENTRIES of the inverse dynamic regressor IDM(q, dq, ddq), N.m or N per unit parameter.",
    arguments: &[("q", "N"), ("dq", "N"), ("ddq", "N")],
    foreign: &["b", "g", "j", "ms", "f", "m"],
    results: &[("idm", None)],
};

const FORWARD: Signature<'static> = Signature {
    name: "mass_and_bias",
    doc: "Mass matrix M(q), row by row, and centrifugal, Coriolis and gravity torques N(q, dq).",
    arguments: &[("chi", "NB"), ("q", "N"), ("dq", "N")],
    foreign: &["b", "g"],
    results: &[("mass", Some("N * N")), ("bias", Some("N"))],
};

const TORQUE: Signature<'static> = Signature {
    name: "tau",
    doc: "Torques tau(chi, q, dq, ddq) = IDM chi of all joints, N.m or N, friction and offsets included.",
    arguments: &[("chi", "NB"), ("q", "N"), ("dq", "N"), ("ddq", "N")],
    foreign: &[],
    results: &[("tau", None)],
};

/// A function with what it does.
pub struct Function {
    /// Name, arguments and results.
    pub signature: Signature<'static>,
    /// In parts of no more statements than were asked for.
    pub parts: Vec<Part>,
}

/// h, dh, IDM, M and N, tau.
pub fn functions(robot: &RobotTable, set: &BaseSet, equations: &Equations, most: usize) -> Vec<Function> {
    let joints = robot.joint_frames().iter().map(|&f| robot.frames[f].j).collect();
    let inputs = InputNames { joints, parameters: set.base.iter().map(|p| p.name.to_string()).collect() };
    let function = |graph: &Graph, signature: Signature<'static>, outputs: &[Output]| {
        let parts = parts(graph, &inputs, &signature, outputs, most);
        Function { signature, parts }
    };
    let g = &equations.graph;
    vec![
        function(g, ENERGY, &row(robot, set, &equations.energy)),
        function(g, POWER, &row(robot, set, &equations.power)),
        function(g, IDM, &regressor(robot, set, equations)),
        function(g, FORWARD, &forward(equations)),
        function(&equations.torque.graph, TORQUE, &torque(robot, &equations.torque.torques)),
    ]
}

/// One value per base parameter; what is zero is written too.
fn row(robot: &RobotTable, set: &BaseSet, values: &[Expr]) -> Vec<Output> {
    let output = |(index, &value): (usize, &Expr)| {
        let j = robot.frames[set.standard[set.base[index].standard].frame].j;
        Output { index, result: 0, value, group: format!("Link {j}.") }
    };
    values.iter().enumerate().map(output).collect()
}

/// Link by link, and for each link from its own joint inwards, so that the wrenches of its columns stay at hand.
fn regressor(robot: &RobotTable, set: &BaseSet, equations: &Equations) -> Vec<Output> {
    let pattern = equations.pattern();
    let joint_frames = robot.joint_frames();
    let place = |&(i, k): &(usize, usize)| {
        let standard = &set.standard[set.base[k].standard];
        (standard.frame, standard.kind >= ParameterKind::Ia, std::cmp::Reverse(i), k)
    };
    let mut order: Vec<usize> = (0..pattern.len()).collect();
    order.sort_by_key(|&e| place(&pattern[e]));
    order
        .into_iter()
        .map(|index| {
            let (i, k) = pattern[index];
            let frame = set.standard[set.base[k].standard].frame;
            let (row, link) = (robot.frames[joint_frames[i]].j, robot.frames[frame].j);
            let group = format!("Row {row}, link {link}.");
            Output { index, result: 0, value: equations.idm[i][k], group }
        })
        .collect()
}

fn forward(equations: &Equations) -> Vec<Output> {
    let n = equations.bias.len();
    let mut outputs = Vec::new();
    for i in (0..n).rev() {
        for k in 0..=i {
            let value = equations.mass[i * (i + 1) / 2 + k];
            let mut push = |index| {
                let group = "Mass matrix.".to_owned();
                outputs.push(Output { index, result: 0, value, group });
            };
            push(i * n + k);
            if i != k {
                push(k * n + i);
            }
        }
    }
    for (index, &value) in equations.bias.iter().enumerate().rev() {
        outputs.push(Output { index, result: 1, value, group: "Bias.".to_owned() });
    }
    outputs
}

/// From the last joint inwards, as the wrenches come.
fn torque(robot: &RobotTable, torques: &[Expr]) -> Vec<Output> {
    let joint_frames = robot.joint_frames();
    let output = |(index, &value): (usize, &Expr)| {
        let group = format!("Joint {}.", robot.frames[joint_frames[index]].j);
        Output { index, result: 0, value, group }
    };
    torques.iter().enumerate().rev().map(output).collect()
}
