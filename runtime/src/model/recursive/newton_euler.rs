//! The model: base columns from the columns of the bodies and of the drive.

use super::columns::{standard_energy, standard_idm, standard_power};
use super::composite::{self, Inertia, RigidBodies};
use super::drive::{self, DriveEntry};
use super::error::{MAX_FRAMES, RecursiveModelError};
use super::group::{clear, each_group};
use super::kinematics::Link;
use super::pattern::{Wanted, check, generic_entries};
use super::torque::rigid_torques;
use crate::model::{LANES, LINE, Lanes, Line, Model, Number, Pattern, Robot, States};
use std::borrow::Cow;

/// Inverse dynamics by recursion over the table: any mix of revolute, prismatic and fixed frames, trees, and any
/// transmission. The same numbers as generated code, slower.
#[derive(Debug, Clone)]
pub struct RecursiveModel {
    robot: Robot,
    links: Vec<Link<f64>>,
    pattern: Pattern,
    /// For each block in the order in which [`standard_idm`] visits them.
    blocks: Vec<Wanted>,
    /// For each frame: (place among the ten columns, base parameter).
    columns: Vec<Wanted>,
    drive: Vec<DriveEntry>,
    /// Entry of the pattern of each of `drive`.
    drive_places: Vec<usize>,
}

impl RecursiveModel {
    /// Prepares the table. Entries of IDM that vanish in every one of a set of generic states are taken as zero
    /// for every state and are not in the pattern.
    ///
    /// # Errors
    /// More than [`MAX_FRAMES`] frames, a parent behind its child, a gear matrix that does not fit the joints or with
    /// a zero on its diagonal, a base parameter that refers to nothing.
    pub fn new(robot: Robot) -> Result<RecursiveModel, RecursiveModelError> {
        check(&robot)?;
        let links: Vec<Link<f64>> = Link::of(&robot);
        let n = robot.joints();
        let mut columns = vec![Wanted::new(); links.len()];
        for (column, base) in robot.base.iter().enumerate() {
            let standard = &robot.standard[base.standard];
            if (standard.kind as usize) < 10 {
                columns[standard.frame].push((standard.kind as usize, column));
            }
        }
        let drive = drive::drive_entries(&robot)?;
        let rigid = generic_entries(&robot, &links, &columns);

        let mut places: Vec<(usize, usize)> = rigid.iter().flatten().map(|&(_, place)| place).collect();
        places.extend(drive.iter().map(|entry| (entry.row, entry.column)));
        places.sort_unstable();
        places.dedup();
        // Every place looked up below was collected above.
        let entry_of = |place: (usize, usize)| places.partition_point(|&p| p < place);
        let blocks = rigid
            .iter()
            .map(|block| block.iter().map(|&(kind, place)| (kind, entry_of(place))).collect())
            .collect();
        let drive_places = drive.iter().map(|e| entry_of((e.row, e.column))).collect();
        let pattern = Pattern {
            rows: Cow::Owned((0..=n).map(|i| entry_of((i, 0))).collect()),
            columns: Cow::Owned(places.iter().map(|&(_, column)| column).collect()),
            same_as: Cow::Owned((0..places.len()).collect()),
        };
        Ok(RecursiveModel { links, pattern, blocks, columns, drive, drive_places, robot })
    }

    /// The regressor's pattern entries in any number type, for a table and a gravity that may carry derivatives.
    ///
    /// `links` is one [`Link`] per frame of the robot; `entries` is as long as the pattern.
    pub fn idm_with<T: Number>(
        &self,
        links: &[Link<T>],
        gravity: [T; 3],
        q: &[T],
        dq: &[T],
        ddq: &[T],
        entries: &mut [T],
    ) {
        self.each_entry(links, gravity, q, dq, ddq, |entry, value| entries[entry] = value);
    }

    /// Every entry of the pattern once: a base column is either inertial or of the drive.
    #[inline(always)]
    fn each_entry<T: Number>(
        &self,
        links: &[Link<T>],
        gravity: [T; 3],
        q: &[T],
        dq: &[T],
        ddq: &[T],
        mut emit: impl FnMut(usize, T),
    ) {
        let mut blocks = self.blocks.iter();
        standard_idm(links, gravity, q, dq, ddq, |_, _, row| {
            for &(kind, entry) in blocks.next().map_or(&[][..], |wanted| wanted) {
                emit(entry, row[kind]);
            }
        });
        for (entry, &place) in self.drive.iter().zip(&self.drive_places) {
            emit(place, entry.value(q, dq, ddq));
        }
    }

    /// Terms of the power row, several for one column where several joints drive it.
    #[inline(always)]
    fn each_power<T: Number>(
        &self,
        links: &[Link<T>],
        q: &[T],
        dq: &[T],
        ddq: &[T],
        mut emit: impl FnMut(usize, T),
    ) {
        standard_power(links, self.robot.gravity.map(T::constant), q, dq, ddq, |frame, row| {
            for &(kind, column) in &self.columns[frame] {
                emit(column, row[kind]);
            }
        });
        for entry in &self.drive {
            emit(entry.column, dq[entry.row] * entry.value(q, dq, ddq));
        }
    }

    #[inline(always)]
    fn each_energy<T: Number>(&self, links: &[Link<T>], q: &[T], dq: &[T], mut emit: impl FnMut(usize, T)) {
        standard_energy(links, self.robot.gravity.map(T::constant), q, dq, |frame, row| {
            for &(kind, column) in &self.columns[frame] {
                emit(column, row[kind]);
            }
        });
        for entry in &self.drive {
            emit(entry.column, T::constant(0.5) * entry.twice_energy(q, dq));
        }
    }
}

impl RecursiveModel {
    /// The bodies that move as the base parameters say: what was regrouped away is zero.
    fn bodies(&self, chi: &[f64]) -> [Inertia; MAX_FRAMES] {
        let mut bodies = [Inertia::default(); MAX_FRAMES];
        for (body, wanted) in bodies.iter_mut().zip(&self.columns) {
            for &(kind, column) in wanted {
                body.add_parameter(kind, chi[column]);
            }
        }
        bodies
    }
}

impl Model for RecursiveModel {
    fn robot(&self) -> &Robot {
        &self.robot
    }

    fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    fn energy(&self, q: &[f64], dq: &[f64], h: &mut [f64]) {
        h.fill(0.0);
        self.each_energy(&self.links, q, dq, |column, value| h[column] += value);
    }

    fn power(&self, q: &[f64], dq: &[f64], ddq: &[f64], dh: &mut [f64]) {
        dh.fill(0.0);
        self.each_power(&self.links, q, dq, ddq, |column, value| dh[column] += value);
    }

    fn idm(&self, q: &[f64], dq: &[f64], ddq: &[f64], entries: &mut [f64]) {
        self.idm_with(&self.links, self.robot.gravity, q, dq, ddq, entries);
    }

    fn idm_block(&self, states: States<'_>, stride: usize, out: &mut [f64]) {
        let gravity = self.robot.gravity.map(Lanes::constant);
        each_group(&self.links, states, |links, group, q, dq, ddq| {
            self.each_entry(links, gravity, q, dq, ddq, |entry, value| {
                group.write(&mut out[entry * stride..], value);
            });
        });
    }

    fn idm_lines(&self, states: States<'_>, width: usize, out: &mut [Line]) {
        let gravity = self.robot.gravity.map(Lanes::constant);
        each_group(&self.links, states, |links, group, q, dq, ddq| {
            let (line, part) = (group.first / LINE, group.first % LINE / LANES);
            self.each_entry(links, gravity, q, dq, ddq, |entry, value| {
                out[line * width + entry][part] = value;
            });
        });
    }

    fn power_block(&self, states: States<'_>, stride: usize, out: &mut [f64]) {
        clear(out, stride, self.robot.base.len(), &states);
        each_group(&self.links, states, |links, group, q, dq, ddq| {
            self.each_power(links, q, dq, ddq, |column, value| group.add(&mut out[column * stride..], value));
        });
    }

    fn energy_block(&self, states: States<'_>, stride: usize, out: &mut [f64]) {
        clear(out, stride, self.robot.base.len(), &states);
        each_group(&self.links, States { ddq: states.dq, ..states }, |links, group, q, dq, _| {
            self.each_energy(links, q, dq, |column, value| group.add(&mut out[column * stride..], value));
        });
    }

    fn mass_and_bias(&self, chi: &[f64], q: &[f64], dq: &[f64], mass: &mut [f64], bias: &mut [f64]) {
        let n = self.robot.joints();
        mass.fill(0.0);
        bias.fill(0.0);
        let bodies = self.bodies(chi);
        let bodies = RigidBodies { links: &self.links, gravity: self.robot.gravity, inertia: &bodies };
        composite::add_mass_and_bias(&bodies, q, dq, mass, bias);
        for entry in &self.drive {
            for (s, inertia) in entry.inertia() {
                mass[entry.row * n + s] += chi[entry.column] * inertia;
            }
            if entry.is_spring {
                bias[entry.row] += chi[entry.column] * entry.value(q, dq, dq);
            }
        }
    }

    fn torque(&self, chi: &[f64], q: &[f64], dq: &[f64], ddq: &[f64], torque: &mut [f64]) {
        let (bodies, gravity) = (self.bodies(chi), self.robot.gravity);
        rigid_torques((&self.links, &bodies), gravity, [q, dq, ddq], |joint, value| torque[joint] = value);
        for entry in &self.drive {
            torque[entry.row] += chi[entry.column] * entry.value(q, dq, ddq);
        }
    }

    fn torque_block(&self, chi: &[f64], states: States<'_>, stride: usize, out: &mut [f64]) {
        let (bodies, gravity) = (self.bodies(chi), self.robot.gravity.map(Lanes::constant));
        each_group(&self.links, states, |links, group, q, dq, ddq| {
            rigid_torques((links, &bodies), gravity, [q, dq, ddq], |joint, value| {
                group.write(&mut out[joint * stride..], value);
            });
            for entry in &self.drive {
                let value = Lanes::splat(chi[entry.column]) * entry.value(q, dq, ddq);
                group.add(&mut out[entry.row * stride..], value);
            }
        });
    }
}
