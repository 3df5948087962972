//! All equations of one robot in one graph.

use super::drive::DriveColumns;
use super::energy::{energy, frame_energies, power};
use super::error::ModelError;
use super::forward::{bias, mass_matrix};
use super::geometry::Geometry;
use super::inverse::{Derivation, inertial_column};
use super::motion::{frame_motions, screws};
use super::torque::TorqueEquations;
use crate::base::BaseSet;
use crate::robot::RobotTable;
use crate::symbolic::{Expr, Graph, OperationCounts, Point, Symbol};
use dynid_description::ParameterKind;

/// One way to derive the equations.
#[derive(Debug, Clone, Copy)]
pub(super) struct Variant {
    /// Consecutive parallel axes are turned together.
    pub merge: bool,
    /// Sines and cosines of sums and differences are composed.
    pub compose: bool,
    /// How the regressor rows come about.
    pub derivation: Derivation,
}

/// Operations of the functions of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct ModelCounts {
    /// Energy row h.
    pub energy: OperationCounts,
    /// Power row dh.
    pub power: OperationCounts,
    /// Inverse dynamic regressor IDM.
    pub idm: OperationCounts,
    /// Mass matrix and bias together.
    pub forward: OperationCounts,
    /// Torques tau(chi, q, dq, ddq).
    pub torque: OperationCounts,
}

impl ModelCounts {
    /// What identification evaluates at every sample: h, dh and IDM.
    fn weighted(self) -> usize {
        self.energy.weighted() + self.power.weighted() + self.idm.weighted()
    }
}

/// The equations of a robot in its base parameters.
#[derive(Debug, Clone)]
pub struct Equations {
    /// Every expression.
    pub graph: Graph,
    /// Energy row, one per base parameter.
    pub energy: Vec<Expr>,
    /// Power row, one per base parameter.
    pub power: Vec<Expr>,
    /// Inverse dynamic regressor: `idm[i][k]`, joint i, base parameter k.
    pub idm: Vec<Vec<Expr>>,
    /// Lower triangle of the mass matrix: entry (i, k), k <= i, at i (i + 1) / 2 + k.
    pub mass: Vec<Expr>,
    /// Centrifugal, Coriolis and gravity torques.
    pub bias: Vec<Expr>,
    /// The torques, in a graph of their own: which treatment of parallel axes is cheapest differs.
    pub torque: TorqueEquations,
}

impl Equations {
    /// Derives everything from the table; of the possible derivations the one with fewer operations is taken.
    ///
    /// # Errors
    /// A drive without a model.
    pub fn derive(robot: &RobotTable, set: &BaseSet) -> Result<Self, ModelError> {
        let first = Variant { merge: true, compose: true, derivation: Derivation::ScrewsOutward };
        let others = [
            Variant { compose: false, ..first },
            Variant { merge: false, ..first },
            Variant { derivation: Derivation::WrenchesInward, ..first },
        ];
        let mut best = Equations::derive_as(robot, set, first)?;
        for variant in others {
            let equations = Equations::derive_as(robot, set, variant)?;
            if equations.counts().weighted() < best.counts().weighted() {
                best = equations;
            }
        }
        best.torque = TorqueEquations::derive(robot, set)?;
        best.factor();
        Ok(best)
    }

    /// Takes common factors out of the sums of each function, where that saves operations of it.
    fn factor(&mut self) {
        let g = &mut self.graph;
        self.energy = g.factored(&self.energy);
        self.power = g.factored(&self.power);
        let rows = g.factored(&self.idm.concat());
        for (row, factored) in self.idm.iter_mut().zip(rows.chunks(self.power.len())) {
            row.copy_from_slice(factored);
        }
        let forward = g.factored(&[self.mass.as_slice(), &self.bias].concat());
        let (mass, bias) = forward.split_at(self.mass.len());
        (self.mass, self.bias) = (mass.to_vec(), bias.to_vec());
        self.torque.torques = self.torque.graph.factored(&self.torque.torques);
    }

    pub(super) fn derive_as(robot: &RobotTable, set: &BaseSet, variant: Variant) -> Result<Self, ModelError> {
        let Variant { merge, compose, derivation } = variant;
        let drive = DriveColumns::new(robot)?;
        let mut graph = if compose { Graph::composing_angles() } else { Graph::new() };
        let g = &mut graph;
        let geometry = Geometry::new(g, robot, merge);
        let n = geometry.joint_frames.len();
        let motions = frame_motions(g, &geometry, true);
        let screws = screws(g, &geometry);
        let energies = frame_energies(g, &geometry, &motions);
        let mut idm = vec![Vec::with_capacity(set.base.len()); n];
        let (mut h, mut dh) = (Vec::new(), Vec::new());
        for base in &set.base {
            let parameter = &set.standard[base.standard];
            let frame = parameter.frame;
            let column = match geometry.links[frame].joint {
                Some(joint) if parameter.kind >= ParameterKind::Ia => {
                    h.push(drive.energy(g, &geometry, parameter, joint));
                    dh.push(drive.power(g, &geometry, parameter, joint));
                    drive.column(g, &geometry, parameter, joint)
                }
                _ => {
                    h.push(energy(g, &motions[frame], &energies[frame], parameter));
                    dh.push(power(g, &motions[frame], &energies[frame], parameter));
                    inertial_column(g, &geometry, &motions, &screws, parameter, derivation)
                }
            };
            for (row, entry) in idm.iter_mut().zip(column) {
                row.push(entry);
            }
        }
        let mut mass = mass_matrix(g, &geometry, set, &screws);
        for (k, base) in set.base.iter().enumerate() {
            let parameter = &set.standard[base.standard];
            if let (ParameterKind::Ia, Some(joint)) = (parameter.kind, geometry.links[parameter.frame].joint)
            {
                let chi = g.symbol(Symbol::Parameter(k));
                for (i, row) in drive.rotor_form(joint).iter().enumerate() {
                    for (l, &weight) in row[..=i].iter().enumerate() {
                        let rotor = g.scale(weight, chi);
                        let entry = &mut mass[i * (i + 1) / 2 + l];
                        *entry = g.add(*entry, rotor);
                    }
                }
            }
        }
        let mut bias = bias(g, &geometry, set);
        for (k, base) in set.base.iter().enumerate() {
            let parameter = &set.standard[base.standard];
            if let (true, Some(joint)) = (parameter.kind.is_spring(), geometry.links[parameter.frame].joint) {
                let chi = g.symbol(Symbol::Parameter(k));
                for (torque, entry) in bias.iter_mut().zip(drive.column(g, &geometry, parameter, joint)) {
                    let term = g.mul(chi, entry);
                    *torque = g.add(*torque, term);
                }
            }
        }
        let torque = TorqueEquations::derive_as(robot, set, &drive, (merge, compose));
        let mut equations = Equations { graph, energy: h, power: dh, idm, mass, bias, torque };
        equations.drop_vanishing_entries();
        Ok(equations)
    }

    /// Entries of the regressor whose terms cancel for every state become zero.
    ///
    /// Such an entry is an analytic function; one that is zero to rounding at several states drawn at random is zero
    /// with probability one.
    fn drop_vanishing_entries(&mut self) {
        let n = self.idm.len();
        let outputs = self.idm.concat();
        let mut largest = vec![0.0_f64; outputs.len()];
        let mut seed = 1_u64;
        let mut uniform = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        for _ in 0..8 {
            let mut signals = || (0..n).map(|_| 2.0 * uniform()).collect();
            let point = Point { q: signals(), dq: signals(), ddq: signals(), chi: Vec::new() };
            for (most, value) in largest.iter_mut().zip(self.graph.evaluate(&outputs, &point)) {
                *most = most.max(value.abs());
            }
        }
        for (entry, most) in self.idm.iter_mut().flatten().zip(largest) {
            if most < 1e-13 {
                *entry = Graph::ZERO;
            }
        }
    }

    /// The entries of the regressor that are not identically zero: (joint, base parameter), row by row.
    pub fn pattern(&self) -> Vec<(usize, usize)> {
        let mut entries = Vec::new();
        for (i, row) in self.idm.iter().enumerate() {
            entries.extend((0..row.len()).filter(|&k| row[k] != Graph::ZERO).map(|k| (i, k)));
        }
        entries
    }

    /// What evaluating each of the generated functions costs.
    pub fn counts(&self) -> ModelCounts {
        let count = |outputs: &[Expr]| self.graph.operation_counts(outputs);
        ModelCounts {
            energy: count(&self.energy),
            power: count(&self.power),
            idm: count(&self.idm.concat()),
            forward: count(&[self.mass.as_slice(), &self.bias].concat()),
            torque: self.torque.counts(),
        }
    }
}
