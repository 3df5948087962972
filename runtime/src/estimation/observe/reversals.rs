//! Changes of direction: the moments at which dry friction changes its sign are not those at which the measured speed does.
//!
//! A joint that turns round sticks first: for some milliseconds its friction goes from one limit to the other while the
//! speed is zero, and the sign of a filtered speed changes somewhere in between. What the Coulomb column is wrong by, one
//! sample times twice the friction, is as large as what tells the inertia of a small rotor, and the side lobes of the
//! decimation carry it to rows that are far from the reversal. How much later the friction changes is therefore an unknown
//! of every motion: one for each dry friction that acts on a joint, eliminated from its rows (Frisch, Waugh and Lovell).

use super::observation::{EquationFactor, TimeBlock};
use super::prepared::Prepared;
use super::rows::Rows;
use crate::model::Robot;
use crate::signal::{Decimator, KeptRows, Motion};
use nalgebra::DMatrix;

/// A column of which the ones before it leave no more than this share says nothing of its own.
const DEPENDENT: f64 = 1e-6;

/// For each joint, dry friction that acts on it, and row: what a change of that friction's sign that comes later makes of
/// the torque, up to a factor: the decimated impulses of its reversals.
pub(super) fn columns(
    robot: &Robot,
    motion: &Motion,
    decimator: &Decimator,
    grid: KeptRows,
) -> Vec<Vec<Vec<f64>>> {
    let mut columns = vec![Vec::new(); motion.dq.len()];
    for friction in robot.standard.iter().filter(|p| p.kind.is_coulomb()) {
        let form = robot.acts_on(friction);
        let reversals = reversals(&speed(motion, &form));
        if reversals.is_empty() {
            continue;
        }
        let column: Vec<f64> = grid.centres().map(|at| decimated(&reversals, decimator, at as f64)).collect();
        for (joint, _) in form {
            columns[joint].push(column.clone());
        }
    }
    columns
}

/// Speed of a combination of joints at each sample.
pub(super) fn speed(motion: &Motion, form: &[(usize, f64)]) -> Vec<f64> {
    let samples = motion.q.first().map_or(0, Vec::len);
    let mut speed = vec![0.0; samples];
    for &(joint, coefficient) in form {
        speed.iter_mut().zip(&motion.dq[joint]).for_each(|(v, dq)| *v += coefficient * dq);
    }
    speed
}

/// Where a speed changes its sign, in samples, ascending, and the sign that it has then.
fn reversals(speed: &[f64]) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    let mut before: Option<(f64, f64)> = None;
    for (t, &v) in speed.iter().enumerate().filter(|(_, v)| **v != 0.0) {
        let now = (t as f64, v);
        if let Some(before) = before.filter(|before| before.1 * v < 0.0) {
            let share = before.1.abs() / (before.1.abs() + v.abs());
            found.push((before.0 + share * (now.0 - before.0), v.signum()));
        }
        before = Some(now);
    }
    found
}

/// The row at a sample of impulses at the reversals, by linear interpolation between taps.
fn decimated(reversals: &[(f64, f64)], decimator: &Decimator, at: f64) -> f64 {
    let support = decimator.support() as f64;
    let taps = decimator.taps();
    let first = reversals.partition_point(|&(t, _)| t < at - support);
    let within = reversals[first..].iter().take_while(|&&(t, _)| t <= at + support);
    within
        .map(|&(t, sign)| {
            let place = t - at + support;
            let below = (place as usize).min(taps.len() - 1);
            let above = (below + 1).min(taps.len() - 1);
            let share = place - below as f64;
            sign * (taps[below] * (1.0 - share) + taps[above] * share)
        })
        .sum()
}

/// Eliminates the unknowns of the reversals, which are the first columns of all factors: what they take of each group
/// is kept beside it, for errors that count everything.
pub(super) fn eliminate(
    prepared: &[Prepared<'_>],
    groups: &mut [EquationFactor],
    blocks: &mut [TimeBlock],
    rows: Option<&mut Vec<Rows>>,
) {
    let taken: Vec<Taken> = groups
        .iter_mut()
        .map(|group| {
            let turns = prepared[group.trajectory].reversals[group.equation].len();
            Taken::from_group(group, turns)
        })
        .collect();
    let places: Vec<(usize, usize)> = groups.iter().map(|g| (g.trajectory, g.equation)).collect();
    let of = |trajectory: usize, equation: usize| {
        places.iter().position(|&place| place == (trajectory, equation)).map(|g| &taken[g])
    };
    for equation in blocks.iter_mut().flat_map(|b| &mut b.equations) {
        if let Some(taken) = of(equation.trajectory, equation.equation).filter(|taken| taken.turns > 0) {
            equation.factor = equation.factor.times(&taken.elimination());
        }
    }
    for rows in rows.into_iter().flatten() {
        if let Some(taken) = of(rows.trajectory, rows.equation) {
            taken.eliminate_from(rows, &prepared[rows.trajectory].reversals[rows.equation]);
        }
    }
}

/// What the unknowns of the reversals take of one group.
struct Taken {
    /// How many there are, and which of them the rows tell apart.
    turns: usize,
    told: Vec<usize>,
    /// The part of each column of [W Y] that they explain: coefficients, one row for each unknown that is told.
    part: DMatrix<f64>,
}

impl Taken {
    /// Eliminates them from the factor of a group, whose first `turns` columns are theirs.
    fn from_group(group: &mut EquationFactor, turns: usize) -> Taken {
        if turns == 0 {
            return Taken { turns, told: Vec::new(), part: DMatrix::zeros(0, group.columns.len() + 1) };
        }
        let factor = &group.factor;
        let told: Vec<usize> = (0..turns)
            .filter(|&l| {
                let norm = (0..=l).map(|i| factor.r(i, l).powi(2)).sum::<f64>().sqrt();
                norm > 0.0 && factor.r(l, l).abs() > DEPENDENT * norm
            })
            .collect();
        let order: Vec<usize> = told.iter().copied().chain(turns..factor.unknowns()).collect();
        let ordered = factor.select(&order);
        let (k, columns) = (told.len(), group.columns.len() + 1);
        let own = DMatrix::from_fn(k, k, |i, l| ordered.r(i, l));
        let rows = DMatrix::from_fn(k, columns, |i, l| ordered.r(i, k + l));
        let part = own.solve_upper_triangular(&rows);
        let Some(part) = part else {
            let everything: Vec<usize> = (turns..factor.unknowns()).collect();
            group.factor = factor.select(&everything);
            return Taken { turns, told: Vec::new(), part: DMatrix::zeros(0, columns) };
        };
        group.factor = ordered.beyond(k);
        group.reversals = rows.row_iter().map(|row| row.iter().copied().collect()).collect();
        Taken { turns, told, part }
    }

    /// What [turns W Y] is multiplied by to eliminate them.
    fn elimination(&self) -> DMatrix<f64> {
        let columns = self.part.ncols();
        let mut matrix = DMatrix::zeros(self.turns + columns, columns);
        for l in 0..columns {
            matrix[(self.turns + l, l)] = 1.0;
            for (i, &turn) in self.told.iter().enumerate() {
                matrix[(turn, l)] = -self.part[(i, l)];
            }
        }
        matrix
    }

    fn eliminate_from(&self, rows: &mut Rows, turns: &[Vec<f64>]) {
        let count = rows.y.len();
        if count == 0 {
            return;
        }
        for (i, &turn) in self.told.iter().enumerate() {
            let columns = rows.w.chunks_exact_mut(count).chain([rows.y.as_mut_slice()]);
            for (l, column) in columns.enumerate() {
                let share = self.part[(i, l)];
                column.iter_mut().zip(&turns[turn]).for_each(|(x, t)| *x -= share * t);
            }
        }
    }
}
