//! The recursive reference model: numeric Newton-Euler over the table, for a robot that has no generated code.

mod columns;
mod composite;
mod drive;
mod kinematics;
#[cfg(test)]
mod tests;
mod vector;

pub use columns::{standard_energy, standard_idm, standard_power};
pub use kinematics::{Link, Row};

use super::{LANES, LINE, Lanes, Line, Model, Number, Pattern, Robot, States};
use composite::Inertia;
use drive::DriveEntry;
use std::borrow::Cow;

/// Most frames, fixed ones included, that a table may have: scratch lives on the stack.
pub const MAX_FRAMES: usize = 16;

/// Why a robot has no recursive model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RecursiveModelError {
    /// The table is too long.
    #[error("{found} frames: at most {MAX_FRAMES} are supported")]
    TooManyFrames {
        /// Frames in the table.
        found: usize,
    },
    /// A parent that is not an earlier row.
    #[error("frame {frame}: its parent must be an earlier row of the table")]
    ParentOrder {
        /// 1-based row.
        frame: usize,
    },
    /// The gear matrix does not fit the joints.
    #[error("the gear matrix has {found} entries: {joints} joints need {}", joints * joints)]
    GearShape {
        /// Entries found.
        found: usize,
        /// Joints n.
        joints: usize,
    },
    /// A motor that does not turn with its own joint.
    #[error("gear row {motor}: its diagonal entry must not be zero and all entries must be finite")]
    GearDiagonal {
        /// 1-based motor.
        motor: usize,
    },
    /// A base or standard parameter that points outside its table.
    #[error("base parameter {name}: it refers to a standard parameter or a frame that does not exist")]
    Parameter {
        /// Its name.
        name: String,
    },
}

/// Entries of one (joint, frame) block that are wanted: (place among the ten columns, entry of the pattern).
type Wanted = Vec<(usize, usize)>;

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
    pub fn new(robot: Robot) -> Result<RecursiveModel, RecursiveModelError> {
        check(&robot)?;
        let links: Vec<Link<f64>> = robot.frames.iter().map(Link::constant).collect();
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
            emit(place, entry.value(dq, ddq));
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
            emit(entry.column, dq[entry.row] * entry.value(dq, ddq));
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
            emit(entry.column, T::constant(0.5) * entry.twice_energy(dq));
        }
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
        self.each_group(states, |links, group, q, dq, ddq| {
            self.each_entry(links, gravity, q, dq, ddq, |entry, value| {
                group.write(&mut out[entry * stride..], value);
            });
        });
    }

    fn idm_lines(&self, states: States<'_>, width: usize, out: &mut [Line]) {
        let gravity = self.robot.gravity.map(Lanes::constant);
        self.each_group(states, |links, group, q, dq, ddq| {
            let (line, part) = (group.first / LINE, group.first % LINE / LANES);
            self.each_entry(links, gravity, q, dq, ddq, |entry, value| {
                out[line * width + entry][part] = value;
            });
        });
    }

    fn power_block(&self, states: States<'_>, stride: usize, out: &mut [f64]) {
        clear(out, stride, self.robot.base.len(), &states);
        self.each_group(states, |links, group, q, dq, ddq| {
            self.each_power(links, q, dq, ddq, |column, value| group.add(&mut out[column * stride..], value));
        });
    }

    fn energy_block(&self, states: States<'_>, stride: usize, out: &mut [f64]) {
        clear(out, stride, self.robot.base.len(), &states);
        self.each_group(States { ddq: states.dq, ..states }, |links, group, q, dq, _| {
            self.each_energy(links, q, dq, |column, value| group.add(&mut out[column * stride..], value));
        });
    }

    fn mass_and_bias(&self, chi: &[f64], q: &[f64], dq: &[f64], mass: &mut [f64], bias: &mut [f64]) {
        let n = self.robot.joints();
        mass.fill(0.0);
        bias.fill(0.0);
        let mut bodies = [Inertia::default(); MAX_FRAMES];
        for (body, wanted) in bodies.iter_mut().zip(&self.columns) {
            for &(kind, column) in wanted {
                body.add_parameter(kind, chi[column]);
            }
        }
        composite::add_mass_and_bias(&self.links, self.robot.gravity, &bodies, q, dq, mass, bias);
        for entry in &self.drive {
            for (s, inertia) in entry.inertia() {
                mass[entry.row * n + s] += chi[entry.column] * inertia;
            }
        }
    }
}

fn clear(out: &mut [f64], stride: usize, columns: usize, states: &States<'_>) {
    let samples = states.q.first().map_or(0, |q| q.len());
    for column in 0..columns {
        out[column * stride..][..samples].fill(0.0);
    }
}

/// Samples that are evaluated together.
#[derive(Clone, Copy)]
struct Group {
    first: usize,
    count: usize,
}

impl Group {
    fn write(self, column: &mut [f64], value: Lanes) {
        column[self.first..self.first + self.count].copy_from_slice(&value.to_array()[..self.count]);
    }

    fn add(self, column: &mut [f64], value: Lanes) {
        let column = &mut column[self.first..self.first + self.count];
        for (x, y) in column.iter_mut().zip(value.to_array()) {
            *x += y;
        }
    }
}

impl RecursiveModel {
    /// Evaluates all samples, four at a time; a last group that is not full repeats its last sample.
    fn each_group(
        &self,
        states: States<'_>,
        mut evaluate: impl FnMut(&[Link<Lanes>], Group, &[Lanes], &[Lanes], &[Lanes]),
    ) {
        let n = states.q.len();
        let samples = states.q.first().map_or(0, |q| q.len());
        let Some(last) = self.links.last() else { return };
        let links: [Link<Lanes>; MAX_FRAMES] =
            std::array::from_fn(|k| Link::lift(self.links.get(k).unwrap_or(last)));
        let mut state = [[Lanes::constant(0.0); MAX_FRAMES]; 3];
        for first in (0..samples).step_by(LANES) {
            let count = LANES.min(samples - first);
            for (one, all) in state.iter_mut().zip([states.q, states.dq, states.ddq]) {
                for (value, signal) in one.iter_mut().zip(all) {
                    *value = Lanes::new(std::array::from_fn(|k| signal[first + k.min(count - 1)]));
                }
            }
            let [q, dq, ddq] = &state;
            evaluate(&links[..self.links.len()], Group { first, count }, &q[..n], &dq[..n], &ddq[..n]);
        }
    }
}

fn check(robot: &Robot) -> Result<(), RecursiveModelError> {
    let found = robot.frames.len();
    if found > MAX_FRAMES {
        return Err(RecursiveModelError::TooManyFrames { found });
    }
    for (k, frame) in robot.frames.iter().enumerate() {
        if frame.parent.is_some_and(|p| p >= k) {
            return Err(RecursiveModelError::ParentOrder { frame: k + 1 });
        }
    }
    for base in robot.base.iter() {
        let exists = robot.standard.get(base.standard).is_some_and(|s| s.frame < found);
        if !exists {
            return Err(RecursiveModelError::Parameter { name: base.name.to_string() });
        }
    }
    Ok(())
}

/// For each block that [`standard_idm`] visits: which of its ten columns are base columns and do not vanish, and
/// where they go: (place among the ten, (joint, base parameter)).
fn generic_entries(
    robot: &Robot,
    links: &[Link<f64>],
    columns: &[Wanted],
) -> Vec<Vec<(usize, (usize, usize))>> {
    const STATES: usize = 8;
    let n = robot.joints();
    // Multiples of the golden ratio, modulo 1: generic, and the same on every run.
    let mut counter = 0.0;
    let mut next = || {
        counter += 1.0;
        6.0 * ((counter * 0.618_033_988_749_894_9_f64).fract() - 0.5)
    };
    let mut blocks: Vec<(usize, usize, [f64; 10])> = Vec::new();
    for state in 0..STATES {
        let mut values: [Vec<f64>; 3] = Default::default();
        for signal in &mut values {
            signal.extend((0..n).map(|_| next()));
        }
        let [q, dq, ddq] = &values;
        let mut visited = 0;
        standard_idm(links, robot.gravity, q, dq, ddq, |joint, frame, row| {
            if state == 0 {
                blocks.push((joint, frame, [0.0; 10]));
            }
            for (largest, value) in blocks[visited].2.iter_mut().zip(row) {
                *largest = largest.max(value.abs());
            }
            visited += 1;
        });
    }
    blocks
        .iter()
        .map(|&(joint, frame, largest)| {
            let scale = largest.iter().copied().fold(1.0, f64::max);
            columns[frame]
                .iter()
                .filter(|&&(kind, _)| largest[kind] > 1e-12 * scale)
                .map(|&(kind, column)| (kind, (joint, column)))
                .collect()
        })
        .collect()
}
